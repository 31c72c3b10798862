//! Vertices in the frame's eye-relative, scaled space and in the light view.
//!
//! - **Reads** positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
//! - **Writes** `points` (xyz; w is 1 where finite, else 0) and `map_points` (texel x, texel y, depth, divisor; for a
//!   vertex that is not surely in front of the light the first three undivided, and how much the divisor is less than it would have
//!   to be, which is not above 0).
//! - **Guarantee.** `points` is the correctly rounded difference to the eye, times a power of two.
//! - **Cost.** One dispatch; 48 bytes a vertex.

use crate::Result;
use crate::gpu::kernels::vertex_project as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct VertexProject {
    project: Program,
}

impl VertexProject {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { project: Program::new(device, kernel::ENTRY_PROJECT, &[]) }
    }

    /// Records the projection of `count` vertices.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        positions: &wgpu::Buffer,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        count: usize,
    ) -> Result<()> {
        let buffers =
            [("frame", frame), ("positions", positions), ("points", points.raw()), ("map_points", map_points.raw())];
        stage.run(&self.project, &buffers, Groups::Items(count as u64))
    }
}
