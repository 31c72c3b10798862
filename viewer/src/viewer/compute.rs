//! Both resolutions: frames that run, and pictures that are drawn of them.

use super::{DRAWN, HISTORY, REST, SLOW, UPLOADED, Viewer};
use crate::level::Level;
use crate::picture::Shot;
use crate::view::Against;
use std::time::Duration;
use subpixel_shadows::wgpu;

impl Viewer {
    /// Goes on with what is computed, and draws what has come.
    pub(super) fn compute(&mut self, size: [u32; 2], now: f64) {
        // Wakes the callbacks of frames that have run.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        if self.size_at.1 != size {
            self.size_at = (now, size);
        }
        // Another overlay makes anew all that it needs, but for what was traced.
        let mut traced = None;
        if self.full.as_ref().is_some_and(|level| level.counted != self.view.overlay.counted().is_some()) {
            traced = self.full.take().and_then(|level| level.tracing);
            self.forget_levels();
        }
        let grown = self.full.as_ref().is_none_or(|level| level.picture.size != size);
        // A window that is being dragged is not followed step by step.
        if grown && (self.full.is_none() || now - self.size_at.0 > REST) {
            let mut full = Level::new(&self.gpu, self.upload.casters(), &self.view, size);
            full.keep_traced(traced);
            self.full = Some(full);
            self.rough = None;
            self.of_rough = false;
        } else if grown {
            self.context.request_repaint_after(Duration::from_secs_f64(REST));
        }
        if !self.upload.advance(UPLOADED) {
            self.context.request_repaint();
            return;
        }
        let Some(full) = &mut self.full else { return };
        let seconds = full.seconds.unwrap_or(0.0);
        let moves = now - self.moved_at < REST && seconds > SLOW;
        if moves && self.rough.is_none() {
            let factor = (seconds / SLOW).sqrt().ceil().min(6.0) as u32;
            let less = full.picture.size.map(|side| (side / factor).max(8));
            self.rough = Some(Level::new(&self.gpu, self.upload.casters(), &self.view, less));
        }
        let mut new = match &mut self.rough {
            Some(rough) if moves => rough.advance(&self.gpu, &self.moment, now),
            _ => full.advance(&self.gpu, &self.moment, now),
        };
        if new {
            self.of_rough = moves && self.rough.is_some();
            // Times and memory were written before.
            self.context.request_repaint();
            let seconds = if self.of_rough { &self.rough } else { &self.full }.as_ref().and_then(|level| level.seconds);
            self.history.extend(seconds);
            if self.history.len() > HISTORY {
                self.history.pop_front();
            }
        }
        self.untold |= !self.of_rough && self.trace(now);
        // Drawing takes time from tracing on a software adapter.
        let whole = self.full.as_ref().and_then(|level| level.tracing.as_ref()).is_some_and(|t| t.share() == 1.0);
        if self.untold && (whole || now - self.told_at > DRAWN) {
            (self.untold, self.told_at, new) = (false, now, true);
        }
        let level = if self.of_rough { &self.rough } else { &self.full };
        let Some((level, shown)) = level.as_ref().and_then(|level| Some((level, level.shown?))) else { return };
        let shot = Shot { camera: shown.camera, light: shown.light, wipe: self.view.wipe, overlay: self.view.overlay };
        if !new && self.drawn == Some(shot) {
            return;
        }
        if let Err(error) = level.draw(&self.gpu, &self.shader, &self.mesh, &self.view, &shot) {
            self.message = Some(error.to_string());
            return;
        }
        self.drawn = Some(shot);
        let (view, filter) = (level.picture.encoded(), wgpu::FilterMode::Nearest);
        let mut renderer = self.render.renderer.write();
        match self.texture {
            Some(id) => renderer.update_egui_texture_from_wgpu_texture(&self.gpu.device, &view, filter, id),
            None => self.texture = Some(renderer.register_native_texture(&self.gpu.device, &view, filter)),
        }
    }

    /// Has pixels traced, where the right half is truth and nothing moves. Whether there is something new.
    pub(super) fn trace(&mut self, now: f64) -> bool {
        let rests = now - self.moved_at >= REST;
        let Some(full) = self.full.as_mut().filter(|level| rests && level.shown == Some(self.moment)) else {
            return false;
        };
        if !matches!(self.view.right, Against::Truth) {
            return false;
        }
        let traced = full.trace(&self.gpu, &self.rays);
        traced.unwrap_or_else(|error| {
            self.message = Some(error);
            false
        })
    }
}
