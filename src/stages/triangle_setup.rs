//! Side of the light, and places in the camera view and the light view, of each triangle.
//!
//! - **Reads** triangles (three vertex indices each, and 1 for one of a closed body), projected vertices.
//! - **Writes** per triangle: facing ([`FRONT`] …), the rectangle of pixels and of texels it may touch (packed corners, both
//!   included, `x | y << 16`; empty if the first x exceeds the second), and how many 8 × 8 blocks each takes.
//!   With [`Frame::CULL_BACK`](crate::frame::Frame::CULL_BACK), and no validity masks, what surely turns away of closed bodies has no texels.
//!   Of texels, the least rectangle of those requested ([`requested_blocks`](super::requested_blocks)), or a larger one.
//! - **Guarantee.** Rectangles are conservative; facing is `UNSURE` within the rounding bound.
//!   Of triangles that it does not take (of clusters that are [not kept](super::cluster_culling)) nothing is written.
//! - **Cost.** A dispatch for either view; about 45 bytes a triangle each.

use super::cluster_culling::{ClusterParams, Elements};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::triangle_setup as kernel;
use crate::gpu::{Buffer, Stage, Uniforms};

pub use kernel::{BACK, DROPPED, FRONT, UNSURE};

/// The pipelines.
#[derive(Debug)]
pub struct TriangleSetup {
    camera: kernel::SetupCameraProgram,
    light: kernel::SetupLightProgram,
    uniforms: Uniforms,
}

/// Outputs of the stage: one element a triangle, of those that it takes. Counts of blocks have the place of the triangle among them.
#[derive(Debug)]
pub struct TriangleFacts {
    /// [`FRONT`], [`BACK`], [`UNSURE`] or [`DROPPED`].
    pub facing: Buffer<u32>,
    /// Pixels it may cover.
    pub camera_rects: Buffer<[u32; 2]>,
    /// Texels it may touch.
    pub light_rects: Buffer<[u32; 2]>,
    /// Blocks of the first rectangle.
    pub camera_items: Buffer<u32>,
    /// Blocks of the second.
    pub light_items: Buffer<u32>,
}

impl TriangleFacts {
    /// Memory for `count` triangles.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, count: usize) -> Result<Self> {
        Ok(Self {
            facing: Buffer::storage(device, "triangle_setup.facing", count)?,
            camera_rects: Buffer::storage(device, "triangle_setup.camera_rects", count)?,
            light_rects: Buffer::storage(device, "triangle_setup.light_rects", count)?,
            camera_items: Buffer::storage(device, "triangle_setup.camera_items", count)?,
            light_items: Buffer::storage(device, "triangle_setup.light_items", count)?,
        })
    }
}

impl TriangleSetup {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            camera: kernel::SetupCameraProgram::new(device, ()),
            light: kernel::SetupLightProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the setup of triangles in the camera's view.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera<'a>(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        triangles: &Buffer<[u32; 4]>,
        points: &Buffer<[f32; 4]>,
        facts: &TriangleFacts,
        of: impl Into<Elements<'a>>,
    ) -> Result<()> {
        let (of, all) = (of.into(), self.uniforms.get(stage.device, &ClusterParams::ALL)?);
        let bindings = kernel::SetupCamera {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            points: points.as_read(),
            camera_rects: facts.camera_rects.as_write(),
            camera_items: facts.camera_items.as_write(),
            kept_clusters: of.list(&all),
        };
        stage.run(&self.camera, bindings, of.groups());
        Ok(())
    }

    /// Records the setup of triangles in the light's view, of the blocks that are `requested`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_light<'a>(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        triangles: &Buffer<[u32; 4]>,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        requested: &Buffer<u32>,
        facts: &TriangleFacts,
        of: impl Into<Elements<'a>>,
    ) -> Result<()> {
        let (of, all) = (of.into(), self.uniforms.get(stage.device, &ClusterParams::ALL)?);
        let bindings = kernel::SetupLight {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            points: points.as_read(),
            map_points: map_points.as_read(),
            requested: requested.as_read(),
            facing: facts.facing.as_write(),
            light_rects: facts.light_rects.as_write(),
            light_items: facts.light_items.as_write(),
            kept_clusters: of.list(&all),
        };
        stage.run(&self.light, bindings, of.groups());
        Ok(())
    }
}
