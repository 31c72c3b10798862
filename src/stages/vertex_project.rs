//! Vertices in the frame's eye-relative, scaled space and in the light view.
//!
//! - **Reads** positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
//! - **Writes** `points` (xyz; w is 1 where finite, else 0) and `map_points` (texel x, texel y, depth, divisor; for a
//!   vertex that is not surely in front of the light the first three undivided, and how much the divisor is less than it would have
//!   to be, which is not above 0).
//! - **Guarantee.** `points` is the correctly rounded difference to the eye, times a power of two.
//! - **Cost.** A dispatch for either; 32 bytes a vertex each.

use super::cluster_culling::{ClusterParams, Elements};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::vertex_project as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};

/// The pipelines.
#[derive(Debug)]
pub struct VertexProject {
    place: kernel::PlaceProgram,
    project: kernel::ProjectProgram,
    uniforms: Uniforms,
}

impl VertexProject {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            place: kernel::PlaceProgram::new(device, ()),
            project: kernel::ProjectProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
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

    /// Records `map_points` of vertices, by their `points`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_project<'a>(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        of: impl Into<Elements<'a>>,
    ) -> Result<()> {
        let (of, all) = (of.into(), self.uniforms.get(stage.device, &ClusterParams::ALL)?);
        let bindings = kernel::Project {
            frame: frame.as_uniform(),
            points: points.as_write(),
            map_points: map_points.as_write(),
            kept_clusters: of.list(&all),
        };
        stage.run(&self.project, bindings, of.groups());
        Ok(())
    }
}
