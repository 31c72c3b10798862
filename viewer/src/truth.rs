//! Traced truth, in slices between the frames of the window.

use crate::picture::{extent, visibility};
use lab::scene::{Camera, Light, Scene};
use oracle::truth::{SceneTruth, Tracer};
use rayon::prelude::*;
use std::sync::Arc;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Result, wgpu};

/// Pixels that are traced before the clock is looked at: a page has one thread, and must stay alive.
const RUN: u32 = if cfg!(target_family = "wasm") { 2 } else { 32 };

/// Visibility by 1024 rays a pixel to each point of the light, from the top.
pub struct Tracing {
    tracer: Arc<Tracer>,
    camera: Camera,
    points: Vec<Light>,
    size: [u32; 2],
    done: u32,
    /// Visibility of the pixels that are traced, below 0 elsewhere.
    pub shown: wgpu::Texture,
}

/// The tracer of a scene.
///
/// # Errors
/// As [`Tracer::new`].
pub fn tracer(scene: &Scene) -> Result<Arc<Tracer>> {
    Tracer::with_alpha(&scene.mesh, &scene.alpha).map(Arc::new)
}

impl Tracing {
    /// Begins with no pixel.
    pub fn new(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        tracer: Arc<Tracer>,
        (camera, points): (Camera, Vec<Light>),
        size: [u32; 2],
    ) -> Self {
        let tracing = Self { tracer, camera, points, size, done: 0, shown: visibility(device, size) };
        let [width, height] = size;
        tracing.write(queue, [0; 2], size, &vec![-1.0; width as usize * height as usize]);
        tracing
    }

    /// Whether it is of this view.
    pub fn is_of(&self, camera: &Camera, points: &[Light], size: [u32; 2]) -> bool {
        self.camera == *camera && self.points == points && self.size == size
    }

    /// Its width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Share of the pixels that are traced.
    pub fn share(&self) -> f32 {
        let [width, height] = self.size;
        self.done as f32 / (width * height).max(1) as f32
    }

    /// Traces pixels until `late` says so, a run of them at the least. Whether there were any left.
    ///
    /// # Errors
    /// As [`SceneTruth::new`].
    pub fn advance(&mut self, queue: &wgpu::Queue, late: impl Fn() -> bool) -> Result<bool> {
        let [width, height] = self.size;
        let all = width * height;
        if self.done == all {
            return Ok(false);
        }
        let one = Samples::new(Pattern::LowDiscrepancy, 1)?;
        let truth = |light| SceneTruth::new(&self.tracer, &self.camera, light, &one, width, height);
        let truths = self.points.iter().map(truth).collect::<Result<Vec<_>>>()?;
        let (share, run) = (1.0 / truths.len() as f32, (RUN / truths.len() as u32).max(1));
        let visible = |pixel| truths.iter().map(|truth| truth.converged_pixel(pixel).0 * share).sum();
        while self.done < all {
            let first = self.done;
            let end = all.min(first + run).min((first / width + 1) * width);
            let run: Vec<f32> = (first..end).into_par_iter().map(visible).collect();
            self.write(queue, [first % width, first / width], [end - first, 1], &run);
            self.done = end;
            if late() {
                break;
            }
        }
        Ok(true)
    }

    fn write(&self, queue: &wgpu::Queue, [x, y]: [u32; 2], size: [u32; 2], values: &[f32]) {
        let origin = wgpu::Origin3d { x, y, z: 0 };
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..self.shown.as_image_copy() },
            bytemuck::cast_slice(values),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size[0]), rows_per_image: None },
            extent(size),
        );
    }
}
