//! Traced truth, in slices between the frames of the window.

use crate::picture::visibility;
use lab::scene::{Camera, Light, Scene};
use oracle::truth::{SceneTruth, Tracer};
use rayon::prelude::*;
use std::sync::Arc;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Result, wgpu};

/// Visibility by 1024 rays a pixel, row by row.
pub struct Tracing {
    tracer: Arc<Tracer>,
    camera: Camera,
    light: Light,
    size: [u32; 2],
    rows: u32,
    /// Visibility of the rows that are traced, below 0 elsewhere.
    pub shown: wgpu::Texture,
}

/// The tracer of a scene.
///
/// # Errors
/// As [`Tracer::new`].
pub fn tracer(scene: &Scene) -> Result<Arc<Tracer>> {
    Tracer::new(&scene.mesh).map(Arc::new)
}

impl Tracing {
    /// Begins with no row.
    pub fn new(
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        tracer: Arc<Tracer>,
        (camera, light): (Camera, Light),
        size: [u32; 2],
    ) -> Self {
        let tracing = Self { tracer, camera, light, size, rows: 0, shown: visibility(device, size) };
        let [width, height] = size;
        tracing.write(queue, 0, &vec![-1.0; width as usize * height as usize]);
        tracing
    }

    /// Whether it is of this view.
    pub fn is_of(&self, camera: &Camera, light: &Light, size: [u32; 2]) -> bool {
        self.camera == *camera && self.light == *light && self.size == size
    }

    /// Share of the rows that are traced.
    pub fn share(&self) -> f32 {
        self.rows as f32 / self.size[1].max(1) as f32
    }

    /// Traces rows until `late` says so, at least one. Whether there were any left.
    ///
    /// # Errors
    /// As [`SceneTruth::new`].
    pub fn advance(&mut self, queue: &wgpu::Queue, late: impl Fn() -> bool) -> Result<bool> {
        let [width, height] = self.size;
        if self.rows == height {
            return Ok(false);
        }
        let one = Samples::new(Pattern::LowDiscrepancy, 1)?;
        let truth = SceneTruth::new(&self.tracer, &self.camera, &self.light, &one, width, height)?;
        while self.rows < height {
            let first = self.rows * width;
            let row: Vec<f32> =
                (first..first + width).into_par_iter().map(|pixel| truth.converged_pixel(pixel).0).collect();
            self.write(queue, self.rows, &row);
            self.rows += 1;
            if late() {
                break;
            }
        }
        Ok(true)
    }

    fn write(&self, queue: &wgpu::Queue, first: u32, values: &[f32]) {
        let [width, _] = self.size;
        let rows = values.len() as u32 / width;
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y: first, z: 0 },
                ..self.shown.as_image_copy()
            },
            bytemuck::cast_slice(values),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            wgpu::Extent3d { width, height: rows, depth_or_array_layers: 1 },
        );
    }
}
