//! Temporal reprojection of a method of maps (Scherzer, Jeschke, Wimmer 2007; Scherzer 2011, section 4.6): what it keeps from frame to frame, and
//! how the light's texels lie otherwise in each.

use crate::gpu::{Buffer, Recorder, Uploads};
use crate::light_view::LightView;
use crate::scene::{Light, PixelRays};
use crate::stages::PrimaryHits;
use crate::stages::history::{FrameBefore, History, HistoryBuffers};
use crate::stages::pixel_views::LightViews;
use crate::{Error, Result, frame::Frame};

/// Options of temporal reprojection. Of a light and casters that stand, seen by any camera, visibility converges; where they move, it is late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HistorySettings {
    /// Frames that a [`Renderer`](crate::render::Renderer) makes of one picture, from nothing, 1 to [`HistorySettings::MOST_FRAMES`]; 0: one, and each goes on from
    /// the one before, as in a [`ShadowPass`](crate::ShadowPass).
    pub frames: u32,
    /// Power of the confidence that a frame's visibility is weighted by, 1 to [`HistorySettings::MOST_POWER`]: the higher, the nearer to the centre of its
    /// texel a lookup must lie to count, and the more frames it takes.
    pub power: u32,
}

impl Default for HistorySettings {
    fn default() -> Self {
        Self { frames: 0, power: Self::POWER }
    }
}

impl HistorySettings {
    /// Most frames of one picture.
    pub const MOST_FRAMES: u32 = 1024;
    /// The highest power.
    pub const MOST_POWER: u32 = 64;
    /// The power where none is told.
    pub const POWER: u32 = 8;

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let Self { frames, power } = *self;
        let (most, highest) = (Self::MOST_FRAMES, Self::MOST_POWER);
        if frames > most {
            return Err(Error::Config(format!("a history of {frames} frames; up to {most} are possible")));
        }
        if !(1..=highest).contains(&power) {
            return Err(Error::Config(format!("confidence to the power of {power}; 1 to {highest} are possible")));
        }
        Ok(())
    }
}

/// Pipeline and memory, and the frame before.
#[derive(Debug)]
pub struct MethodHistory {
    stage: History,
    with: HistoryBuffers,
    last: Option<(PixelRays, f64, Light)>,
    frames: u32,
}

impl MethodHistory {
    /// Pipeline and memory for an image of `pixels` pixels; a method asks up to `reach` texels around what a pixel touches.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, reach: f32, settings: HistorySettings, pixels: usize) -> Result<Self> {
        Ok(Self {
            stage: History::new(device, reach, settings.power),
            with: HistoryBuffers::new(device, pixels)?,
            last: None,
            frames: 0,
        })
    }

    /// Forgets all frames.
    pub fn forget(&mut self) {
        (self.last, self.frames) = (None, 0);
    }

    /// The views as they lie in the next frame: the first in the middle, all others anywhere within a texel, evenly (the additive recurrence of
    /// the plastic number).
    pub fn jittered(&self, views: &[LightView]) -> Vec<LightView> {
        let place = |step: f64| (0.5 + f64::from(self.frames) * step).fract() - 0.5;
        let off = [place(0.754_877_666_246_692_7), place(0.569_840_290_998_053_2)];
        views.iter().map(|view| view.jittered(off)).collect()
    }

    /// Adds what changes with the frame, which is then the last: its rays with the scale of its points, its light, and the light's views, whose rows take such
    /// points.
    pub fn upload(
        &mut self,
        uploads: &mut Uploads,
        (rays, scale): (PixelRays, f64),
        light: &Light,
        views: &[LightView],
    ) {
        let last = self.last.as_ref().filter(|(_, _, of)| of == light);
        let before = last.map(|(before, of, _)| FrameBefore::new((&rays, scale), (before, *of)));
        uploads.write(&self.with.before, &[before.unwrap_or_default()]);
        uploads.write(&self.with.views, &[LightViews::new(views)]);
        self.last = Some((rays, scale, *light));
        self.frames += 1;
    }

    /// Records what becomes of the visibility of a frame, and that it is kept.
    pub fn record(&self, rec: &mut Recorder, frame: &Buffer<Frame>, seen: PrimaryHits, visibility: &Buffer<f32>) {
        self.stage.record(&mut rec.stage("history"), frame, seen, &self.with, visibility);
        self.stage.record_turn(rec, &self.with);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_checked() {
        assert!(HistorySettings::default().check().is_ok());
        for (frames, power) in [(1025, 8), (1, 0), (1, 65)] {
            assert!(HistorySettings { frames, power }.check().is_err(), "{frames} {power}");
        }
    }
}
