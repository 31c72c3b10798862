//! Vertices in the frame's eye-relative, scaled space and in the light view.
//!
//! - **Reads** positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
//! - **Writes** `points` (xyz; w is 1 where finite, else 0) and `map_points` (texel x, texel y, depth, divisor; for a
//!   vertex that is not surely in front of the light the first three undivided, and how much the divisor is less than it would have
//!   to be, which is not above 0).
//! - **Guarantee.** `points` is the correctly rounded difference to the eye, times a power of two.
//! - **Cost.** One dispatch; 48 bytes a vertex.

use crate::frame::Frame;
use crate::gpu::kernels::vertex_project as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct VertexProject {
    project: kernel::ProjectProgram,
}

impl VertexProject {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { project: kernel::ProjectProgram::new(device, ()) }
    }

    /// Records the projection of `count` vertices.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        positions: &Buffer<[f32; 4]>,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        count: usize,
    ) {
        let bindings = kernel::Project {
            frame: frame.as_uniform(),
            positions: positions.as_read(),
            points: points.as_write(),
            map_points: map_points.as_write(),
        };
        stage.run(&self.project, bindings, Groups::Items(count as u64));
    }
}
