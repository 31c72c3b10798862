//! One resolution: two halves that show the same moment, and the picture of both.

use crate::beside::{Rays, TracedView};
use crate::half::{Gpu, Half};
use crate::overlay::Overlay;
use crate::picture::{DrawnMesh, Picture, Shader, Shot, Shown};
use crate::truth::Tracing;
use crate::view::{Against, View};
use lab::options::RenderOptions;
use lab::scene::{Camera, Light};
use subpixel_shadows::ShadowPass;
use subpixel_shadows::pass::UploadedCasters;

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
    /// The moment of the halves' last frames that were complete.
    pub shown: Option<Moment>,
    /// Halves that have such a frame, from the left.
    pub halves_shown: usize,
    /// Seconds from the submission of a moment until it was shown.
    pub seconds: Option<f64>,
    /// Traced truth, where the right half is that.
    pub tracing: Option<Tracing>,
    /// The moment that it is of.
    traced: Option<Moment>,
    /// Whether the overlay needs counts of pixels.
    pub counted: bool,
    /// The moment whose frames run, since when, and of how many halves from the left.
    running: Option<(Moment, f64, usize)>,
    casters: UploadedCasters,
    left: RenderOptions,
}

impl Level {
    /// Begins to make the passes for pictures of `size` pixels.
    pub fn new(gpu: &Gpu, casters: &UploadedCasters, view: &View, size: [u32; 2]) -> Self {
        let half = |options: &RenderOptions| {
            let counted = view.overlay.counted().is_some() && Overlay::Classes.is_of(options.method);
            // Pictures show counts by one binding.
            let fits =
                gpu.device.limits().max_storage_buffer_binding_size >= u64::from(size[0]) * u64::from(size[1]) * 16;
            Half::new(gpu, casters, options, size, counted && fits)
        };
        let mut halves = vec![half(&view.left)];
        if let Against::Method(options) = &view.right {
            halves.push(half(options));
        }
        let picture = Picture::new(&gpu.device, size);
        let (casters, left) = (casters.clone(), view.left.clone());
        Self {
            halves,
            picture,
            shown: None,
            halves_shown: 0,
            seconds: None,
            tracing: None,
            traced: None,
            counted: view.overlay.counted().is_some(),
            running: None,
            casters,
            left,
        }
    }

    /// Whether the picture is of this moment, and nothing of it is still computed.
    pub fn is_of(&self, moment: &Moment) -> bool {
        let traced = self.tracing.as_ref().is_some_and(|tracing| tracing.share() == 1.0);
        self.shown == Some(*moment)
            && !self.halves.iter().any(|half| half.wants(moment))
            && (traced || self.halves.len() > 1)
    }

    /// Whether this moment was tried and has no picture, or none can be made.
    pub fn has_failed(&self, moment: &Moment) -> bool {
        let failed = self.halves.iter().any(|half| half.error.is_some());
        // Halves left of one that is refused are shown alone.
        let refused = self.halves.iter().position(Half::is_refused).unwrap_or(self.halves.len());
        failed && !self.is_busy() && self.halves[..refused].iter().all(|half| !half.wants(moment))
    }

    /// Whether frames run, or passes are made.
    pub fn is_busy(&self) -> bool {
        self.running.is_some() || self.halves.iter().any(|half| half.progress().is_some())
    }

    /// A pass of it that is made.
    pub fn pass(&self) -> Option<&ShadowPass> {
        self.halves.iter().find_map(Half::pass)
    }

    /// Takes over passes that are made: of how many halves from the left there is one.
    fn make(&mut self, gpu: &Gpu) -> usize {
        let mut made = 0;
        for (k, half) in self.halves.iter_mut().enumerate() {
            let before = half.pass().is_some();
            if half.is_made() && made == k {
                made += 1;
            }
            if cfg!(target_family = "wasm") {
                // A page makes one pass in a task, and draws itself in between.
                if half.pass().is_some() != before {
                    gpu.context.request_repaint();
                    break;
                }
                // Pipelines of both are asked for once: the next half's when all of this one's are.
                if half.progress().is_some_and(|[_, of]| of == 0) {
                    break;
                }
            }
        }
        made
    }

    /// Goes on with what runs, and begins `wanted` where nothing does, of the halves that are made; `now` is in seconds. The casters are uploaded. Whether
    /// something new can be drawn.
    pub fn advance(&mut self, gpu: &Gpu, wanted: &Moment, now: f64) -> bool {
        let (made, all) = (self.make(gpu), self.halves.len());
        if let Some((moment, since, running)) = self.running {
            let halves = &mut self.halves[..running];
            let run = |half: &mut Half| (!half.is_done(gpu, &moment)).then_some(());
            if halves.iter_mut().filter_map(run).count() > 0 {
                return false;
            }
            self.running = None;
            // Of a moment that failed in either half the last picture of both stays.
            if halves.iter().any(|half| half.error.is_some()) {
                return false;
            }
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            halves.iter_mut().for_each(|half| half.show(&mut encoder));
            gpu.queue.submit([encoder.finish()]);
            (self.shown, self.halves_shown) = (Some(moment), running);
            self.seconds = (running == all).then_some(now - since);
            return true;
        }
        let mut wanting = self.halves[..made].iter_mut().filter(|half| half.wants(wanted)).peekable();
        if wanting.peek().is_some() {
            wanting.for_each(|half| half.begin(gpu, wanted));
            self.running = Some((*wanted, now, made));
        }
        false
    }

    /// Takes over what another level of the same size has traced.
    pub fn keep_traced(&mut self, tracing: Option<Tracing>) {
        self.tracing = tracing.filter(|tracing| tracing.size() == self.picture.size);
    }

    /// Has what is shown traced beside the window. Whether there is something new to draw.
    ///
    /// # Errors
    /// One line: why nothing can be traced.
    pub fn trace(&mut self, gpu: &Gpu, rays: &Rays) -> Result<bool, String> {
        let Some(Moment { camera, light }) = self.shown else { return Ok(false) };
        let points = self.left.points(&light, self.casters.mesh()).map_err(|e| e.to_string())?;
        let view = TracedView { camera, points, size: self.picture.size };
        if !self.tracing.as_ref().is_some_and(|tracing| tracing.is_of(&view)) {
            self.tracing = Some(Tracing::new((&gpu.device, &gpu.queue), rays.clone(), view));
        }
        let known = std::mem::replace(&mut self.traced, self.shown) == self.shown;
        match &mut self.tracing {
            Some(tracing) => Ok(tracing.advance(&gpu.queue, &gpu.context)? || !known),
            None => Ok(false),
        }
    }

    /// Draws the picture of the moment that is shown.
    ///
    /// # Errors
    /// As [`Picture::draw`].
    pub fn draw<'a>(
        &'a self,
        gpu: &Gpu,
        shader: &Shader,
        mesh: &DrawnMesh,
        view: &View,
        shot: &Shot,
    ) -> subpixel_shadows::Result<()> {
        let of = |options: &RenderOptions, half: &'a Half| {
            let shown = half.as_shown();
            Shown { counts: shown.counts.filter(|_| shot.overlay.is_of(options.method)), ..shown }
        };
        let left = of(&view.left, &self.halves[0]);
        let right = match (&view.right, &self.tracing) {
            // Of another moment it is none.
            (Against::Truth, Some(tracing)) if self.traced == self.shown => {
                Shown { visibility: &tracing.shown, counts: None }
            }
            (Against::Truth, _) => Shown { counts: None, ..left },
            (Against::Method(options), _) => self.halves.get(1).map_or(left, |half| of(options, half)),
        };
        self.picture.draw((&gpu.device, &gpu.queue), shader, mesh, [left, right], shot)
    }
}
