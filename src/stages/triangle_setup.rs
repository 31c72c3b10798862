//! Side of the light, and places in the camera view and the light view, of each triangle.
//!
//! - **Reads** triangles (three vertex indices each, and 1 for one of a closed body), projected vertices.
//! - **Writes** per triangle: facing ([`FRONT`] …), the rectangle of pixels and of texels it may touch (packed corners, both
//!   included, `x | y << 16`; empty if the first x exceeds the second), and how many 8 × 8 blocks each takes.
//!   With [`Frame::CULL_BACK`](crate::frame::Frame::CULL_BACK), and no validity masks, what surely turns away of closed bodies has no texels.
//! - **Guarantee.** Rectangles are conservative; facing is `UNSURE` within the rounding bound.
//! - **Cost.** One dispatch; about 70 bytes a triangle.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::triangle_setup as kernel;
use crate::gpu::{Buffer, Groups, Stage};

pub use kernel::{BACK, DROPPED, FRONT, UNSURE};

/// The pipeline.
#[derive(Debug)]
pub struct TriangleSetup {
    setup: kernel::SetupProgram,
}

/// Outputs of the stage: one element a triangle.
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
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { setup: kernel::SetupProgram::new(device, ()) }
    }

    /// Records the setup of `count` triangles.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        triangles: &Buffer<[u32; 4]>,
        points: &Buffer<[f32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        facts: &TriangleFacts,
        count: usize,
    ) {
        let bindings = kernel::Setup {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            points: points.as_read(),
            map_points: map_points.as_read(),
            facing: facts.facing.as_write(),
            camera_rects: facts.camera_rects.as_write(),
            light_rects: facts.light_rects.as_write(),
            camera_items: facts.camera_items.as_write(),
            light_items: facts.light_items.as_write(),
        };
        stage.run(&self.setup, bindings, Groups::Items(count as u64));
    }
}
