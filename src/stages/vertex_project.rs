//! Vertices in the frame's eye-relative, scaled space and in the light view.
//!
//! - **Reads** positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
//! - **Writes** `points` (xyz; w is 1 where finite, else 0) and `map_points` (texel x, texel y, depth, divisor; for a
//!   vertex that is not surely in front of the light the first three undivided, and how much the divisor is less than it would have
//!   to be, which is not above 0).
//! - **Guarantee.** `points` is the correctly rounded difference to the eye, times a power of two.
//! - **Cost.** A dispatch for either; 32 bytes a vertex each.

use crate::frame::Frame;
use crate::gpu::kernels::vertex_project as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct VertexProject {
    place: kernel::PlaceProgram,
    project: kernel::ProjectProgram,
}

impl VertexProject {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { place: kernel::PlaceProgram::new(device, ()), project: kernel::ProjectProgram::new(device, ()) }
    }

    /// Records `points` of all vertices.
    pub fn record_place(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        positions: &Buffer<[f32; 4]>,
        points: &Buffer<[f32; 4]>,
    ) {
        let bindings =
            kernel::Place { frame: frame.as_uniform(), positions: positions.as_read(), points: points.as_write() };
        stage.run(&self.place, bindings, Groups::Items(positions.len() as u64));
    }

    /// Records `map_points` of `count` vertices, by their `points`.
    pub fn record_project(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        count: usize,
    ) {
        let bindings =
            kernel::Project { frame: frame.as_uniform(), points: points.as_write(), map_points: map_points.as_write() };
        stage.run(&self.project, bindings, Groups::Items(count as u64));
    }
}
