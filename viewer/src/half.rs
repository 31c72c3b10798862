//! A half of the picture: one method's pass, made in the background, and the last of its frames that was complete.

use crate::level::Moment;
use crate::making::{Making, Wanted};
use crate::picture::{Shown, counts, extent, unknown_visibility, visibility};
use lab::options::PartitionBy;
use lab::options::RenderOptions;
use std::time::Duration;
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::pass::{FrameStatus, Inputs, Target, UploadedCasters};
use subpixel_shadows::scene::AreaLight;
use subpixel_shadows::{ShadowPass, wgpu};

/// Device, queue and pipelines of all frames.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Pipelines that all passes share.
    pub programs: KeptPrograms,
    /// The window.
    pub context: egui::Context,
}

impl Gpu {
    /// Wakes a page when all that was submitted is done; a window looks by itself.
    fn wake_when_done(&self) {
        if cfg!(target_family = "wasm") {
            let context = self.context.clone();
            // Status words are read back a moment later.
            self.queue.on_submitted_work_done(move || context.request_repaint_after(Duration::from_millis(8)));
        }
    }
}

enum Pass {
    Making(Box<Making>),
    Made(Box<ShadowPass>),
    Refused,
}

/// One method's pass and its pictures.
pub struct Half {
    pass: Pass,
    work: wgpu::Texture,
    /// Visibility of the last frame that was complete, below 0 before there is one.
    pub shown: wgpu::Texture,
    /// Counts of the frame that runs, and of the last one that was complete.
    counts: Option<[wgpu::Buffer; 2]>,
    size: [u32; 2],
    /// Status of the last frame that was complete.
    pub status: Option<FrameStatus>,
    /// Bytes of all buffers of the pass.
    pub bytes: u64,
    /// Radius and points of the light.
    area: (f64, u32),
    /// Frames of one moment that make its picture, more than one where frames keep a history.
    frames: u32,
    /// The moment of the last frame that was begun, and how many were of it.
    begun: Option<(Moment, u32)>,
    /// The numbers of the first and the last frame that run, a frame a point of the light.
    waits_for: Option<[u64; 2]>,
    /// Whether one of them was not complete.
    lacks: bool,
    tries: u32,
    /// Why there is no picture.
    pub error: Option<String>,
}

/// Frames that are tried until one is complete.
const TRIES: u32 = 10;

impl Half {
    /// Begins to make a pass of the options' method for pictures of `size` pixels; `counted`: which counts their pixels.
    pub fn new(gpu: &Gpu, casters: &UploadedCasters, options: &RenderOptions, size: [u32; 2], counted: bool) -> Self {
        let counts = counted.then(|| [counts(&gpu.device, size), counts(&gpu.device, size)]);
        let options = RenderOptions { size, ..options.clone() };
        let area = (options.light_radius, options.light_points);
        let keeps = options.method.takes("history");
        let frames = options.settings().ok().and_then(|s| s.history).filter(|_| keeps).map_or(1, |h| h.frames.max(1));
        // The first tells the depths by which the next is cut.
        let sees = options.method.takes("partition") && options.partition == PartitionBy::SeenDepths;
        let frames = if sees { frames.max(2) } else { frames };
        let wanted = Wanted { options, counted, casters: casters.clone() };
        let making = Making::new(gpu, wanted);
        let (work, shown) = (visibility(&gpu.device, size), unknown_visibility((&gpu.device, &gpu.queue), size));
        Self {
            pass: Pass::Making(Box::new(making)),
            work,
            shown,
            counts,
            size,
            status: None,
            bytes: 0,
            area,
            frames,
            begun: None,
            waits_for: None,
            lacks: false,
            tries: 0,
            error: None,
        }
    }

    /// Pipelines that are compiled, and of how many, while the pass is made.
    pub fn progress(&self) -> Option<[usize; 2]> {
        match &self.pass {
            Pass::Making(making) => Some(making.progress()),
            _ => None,
        }
    }

    /// The pass, if it is made.
    pub fn pass(&self) -> Option<&ShadowPass> {
        if let Pass::Made(pass) = &self.pass { Some(pass) } else { None }
    }

    /// Takes over the pass if it is made; whether frames can be recorded.
    pub fn is_made(&mut self) -> bool {
        if let Pass::Making(making) = &mut self.pass {
            match making.take() {
                Some(Ok(pass)) => self.pass = Pass::Made(Box::new(pass)),
                Some(Err(error)) => {
                    self.pass = Pass::Refused;
                    self.error = Some(error.to_string());
                }
                None => {}
            }
        }
        matches!(self.pass, Pass::Made(_))
    }

    /// Whether no pass could be made.
    pub fn is_refused(&self) -> bool {
        matches!(self.pass, Pass::Refused)
    }

    /// Whether its picture of this moment lacks frames. A moment that failed is not tried again.
    pub fn wants(&self, moment: &Moment) -> bool {
        let begun = self.begun.filter(|(of, _)| of == moment);
        begun.is_none_or(|(_, frames)| frames < self.frames && self.error.is_none())
    }

    /// Records a frame and submits it.
    pub fn begin(&mut self, gpu: &Gpu, moment: &Moment) {
        let before = self.begun.filter(|(of, _)| of == moment).map_or(0, |(_, frames)| frames);
        self.begun = Some((*moment, before + 1));
        self.tries = 0;
        self.submit(gpu, moment);
    }

    fn submit(&mut self, gpu: &Gpu, Moment { camera, light }: &Moment) {
        let Pass::Made(pass) = &mut self.pass else { return };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let counts = self.counts.as_ref().map(|[work, _]| work);
        let depths = self.status.as_ref().and_then(|status| status.depths);
        let inputs = Inputs { depths, ..Inputs::new(camera, light) };
        let target = Target { counts, ..Target::texture(&self.work) };
        let recorded = match self.area {
            (0.0, _) => pass.record(&mut encoder, &inputs, &target).map(|frame| [frame; 2]),
            (radius, points) => {
                let light = AreaLight { light: *light, radius, points };
                pass.record_area(&mut encoder, &inputs, &light, &target).map(|f| [f[0], f[f.len() - 1]])
            }
        };
        match recorded {
            Ok(frames) => {
                gpu.queue.submit([encoder.finish()]);
                gpu.wake_when_done();
                (self.waits_for, self.lacks) = (Some(frames), false);
                self.error = None;
            }
            // Another camera or light may do.
            Err(error) => {
                self.waits_for = None;
                self.error = Some(error.to_string());
            }
        }
    }

    /// Looks whether the frame has run, and begins it again if a list was too short. Whether there is nothing to wait for.
    pub fn is_done(&mut self, gpu: &Gpu, moment: &Moment) -> bool {
        let Pass::Made(pass) = &mut self.pass else { return true };
        let Some([first, last]) = self.waits_for else { return true };
        while let Some(status) = pass.status() {
            self.lacks |= status.frame >= first && !status.complete;
            if status.frame != last && status.error.is_none() {
                continue;
            }
            self.waits_for = None;
            if !self.lacks {
                self.bytes = pass.memory().iter().map(|buffer| buffer.bytes).sum();
                self.status = Some(status);
                return true;
            }
            self.tries += 1;
            if let Some(error) = status.error.or((self.tries > TRIES).then(|| "no frame came out whole".to_owned())) {
                self.error = Some(error);
                return true;
            }
            self.submit(gpu, moment);
            return self.waits_for.is_none();
        }
        false
    }

    /// Shows the frame that has run, which must be complete.
    pub fn show(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_texture_to_texture(self.work.as_image_copy(), self.shown.as_image_copy(), extent(self.size));
        if let Some([work, shown]) = &self.counts {
            encoder.copy_buffer_to_buffer(work, 0, shown, 0, shown.size());
        }
    }

    /// The last frame that was complete, as the picture reads it.
    pub fn as_shown(&self) -> Shown<'_> {
        Shown { visibility: &self.shown, counts: self.counts.as_ref().map(|[_, shown]| shown) }
    }
}
