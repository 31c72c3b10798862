//! Between which view depths the pixels of an image see triangles.
//!
//! - **Reads** the triangle at each pixel centre, triangles and points of [`vertex_project`](super::vertex_project).
//! - **Changes** `status`: [`StatusHead::nearest_key`](crate::status::StatusHead::nearest_key) and
//!   [`farthest_depth`](crate::status::StatusHead::farthest_depth), 0 before; [`Status::depths`](crate::status::Status::depths) reads them.
//! - **Guarantee.** Bit-equal from run to run. A depth lies between those of the triangle's corners, and carries the rounding of single
//!   precision.
//! - **Cost.** One dispatch; 4 bytes a pixel and 60 a triangle seen, at most two atomics a workgroup of 64 pixels.
//! - **Source.** Lauritzen, Salvi, Lefohn 2010, "Sample Distribution Shadow Maps"; Scherzer 2011, section 4.3.1.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::seen_depths as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct SeenDepths {
    gather: kernel::GatherProgram,
}

impl SeenDepths {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { gather: kernel::GatherProgram::new(device, ()) }
    }

    /// Records it for an image of `pixels` pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        status: &Buffer<u32>,
        pixels: u64,
    ) {
        let bindings = kernel::Gather {
            frame: frame.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            status: status.as_write().cast(),
        };
        stage.run(&self.gather, bindings, Groups::Workgroups(pixels.div_ceil(u64::from(kernel::WORKGROUP))));
    }
}
