//! One resolution: two halves that show the same moment, and the picture of both.

use crate::half::{Gpu, Half};
use crate::picture::{DrawnMesh, Picture, Shader, Shot};
use crate::truth::Tracing;
use crate::view::{Against, View};
use lab::options::RenderOptions;
use lab::scene::{Camera, Light, Scene};
use oracle::truth::Tracer;
use std::sync::Arc;
use subpixel_shadows::Result;

/// Camera and light of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
}

/// Both halves at one resolution.
pub struct Level {
    /// The left half, and the right one where that is a method and not truth.
    pub halves: Vec<Half>,
    /// The picture of both.
    pub picture: Picture,
    /// The moment of both halves' last frames that were complete.
    pub shown: Option<Moment>,
    /// The last moment that was tried: one that failed is not tried again.
    tried: Option<Moment>,
    /// Seconds from the submission of a moment until it was shown.
    pub seconds: Option<f64>,
    /// Traced truth, where the right half is that.
    pub tracing: Option<Tracing>,
    running: Option<(Moment, f64)>,
    scene: Arc<Scene>,
    left: RenderOptions,
}

impl Level {
    /// Begins to make the passes for pictures of `size` pixels.
    pub fn new(gpu: &Gpu, scene: &Arc<Scene>, view: &View, size: [u32; 2], context: &egui::Context) -> Self {
        let half = |options| Half::new(gpu, scene, options, size, context);
        let mut halves = vec![half(&view.left)];
        if let Against::Method(options) = &view.right {
            halves.push(half(options));
        }
        let picture = Picture::new(&gpu.device, size);
        let (scene, left) = (scene.clone(), view.left.clone());
        Self { halves, picture, shown: None, tried: None, seconds: None, tracing: None, running: None, scene, left }
    }

    /// Whether the picture is of this moment, and nothing of it is still computed.
    pub fn is_of(&self, moment: &Moment) -> bool {
        let traced = self.tracing.as_ref().is_some_and(|tracing| tracing.share() == 1.0);
        self.shown == Some(*moment) && (traced || self.halves.len() > 1)
    }

    /// Whether this moment was tried and has no picture, or none can be made.
    pub fn has_failed(&self, moment: &Moment) -> bool {
        let failed = self.halves.iter().any(|half| half.error.is_some());
        failed && !self.is_busy() && (self.tried == Some(*moment) || self.halves.iter().any(Half::is_refused))
    }

    /// Whether frames run, or passes are made.
    pub fn is_busy(&self) -> bool {
        self.running.is_some() || self.halves.iter().any(|half| half.progress().is_some())
    }

    /// Goes on with what runs, and begins `wanted` where nothing does; `now` is in seconds. Whether something new can be drawn.
    pub fn advance(&mut self, gpu: &Gpu, wanted: &Moment, now: f64) -> bool {
        let unmade = self.halves.iter_mut().filter_map(|half| (!half.is_made()).then_some(())).count();
        if let Some((moment, since)) = self.running {
            let Moment { camera, light } = moment;
            let run = |half: &mut Half| (!half.is_done(gpu, &camera, &light)).then_some(());
            if self.halves.iter_mut().filter_map(run).count() > 0 {
                return false;
            }
            self.running = None;
            self.tried = Some(moment);
            // Of a moment that failed in either half the last picture of both stays.
            if self.halves.iter().any(|half| half.error.is_some()) {
                return false;
            }
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            self.halves.iter_mut().for_each(|half| half.show(&mut encoder));
            gpu.queue.submit([encoder.finish()]);
            self.shown = Some(moment);
            self.seconds = Some(now - since);
            return true;
        }
        if unmade == 0 && self.tried != Some(*wanted) {
            self.halves.iter_mut().for_each(|half| half.begin(gpu, &wanted.camera, &wanted.light));
            self.running = Some((*wanted, now));
        }
        false
    }

    /// Traces some pixels of what is shown. Whether there is something new to draw.
    ///
    /// # Errors
    /// As [`Tracing::advance`].
    pub fn trace(&mut self, gpu: &Gpu, tracer: &Arc<Tracer>, late: impl Fn() -> bool) -> Result<bool> {
        let Some(Moment { camera, light }) = self.shown else { return Ok(false) };
        let size = self.picture.size;
        let points = self.left.points(&light, &self.scene.mesh)?;
        if !self.tracing.as_ref().is_some_and(|tracing| tracing.is_of(&camera, &points, size)) {
            let tracing = Tracing::new((&gpu.device, &gpu.queue), tracer.clone(), (camera, points), size);
            self.tracing = Some(tracing);
        }
        match &mut self.tracing {
            Some(tracing) => tracing.advance(&gpu.queue, late),
            None => Ok(false),
        }
    }

    /// Draws the picture of the moment that is shown.
    ///
    /// # Errors
    /// As [`Picture::draw`].
    pub fn draw(&self, gpu: &Gpu, shader: &Shader, mesh: &DrawnMesh, view: &View, shot: &Shot) -> Result<()> {
        let left = &self.halves[0].shown;
        let right = match (&view.right, &self.tracing) {
            (Against::Truth, Some(tracing)) => &tracing.shown,
            _ => self.halves.get(1).map_or(left, |half| &half.shown),
        };
        self.picture.draw((&gpu.device, &gpu.queue), shader, mesh, [left, right], shot)
    }
}
