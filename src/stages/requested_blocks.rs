//! Which 8 × 8 blocks of the light's map the facets ask for, so that nothing is made in others: as pages of a resolution-matched
//! shadow map are requested (Lefohn, Sengupta, Owens 2007), but for facets.
//!
//! - **Reads** the facets, triangles, positions.
//! - **Writes** a word that is 0 where all blocks are requested, then a bit a block, in rows of whole words. Cleared memory requests
//!   everything.
//! - **Guarantee.** Bit-equal from run to run. Every block that [`facet_classify`](super::facet_classify) asks of the same facets is
//!   requested, and those within the frame's margin. No block is requested for a facet that faces away from the light, that lies beyond
//!   the view, or that a view before settled or holds.
//! - **Cost.** Two dispatches; a facet's 24 bytes, and a bit a block.

use super::facet_classify::Facet;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::requested_blocks as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct RequestedBlocks {
    begin: kernel::BeginProgram,
    request: kernel::RequestProgram,
}

impl RequestedBlocks {
    /// Builds the pipelines for any frame.
    pub fn new(device: &wgpu::Device) -> Self {
        Self::build(device, kernel::Constants::default())
    }

    /// As [`RequestedBlocks::new`], for frames that set [`Frame::CLAMP`](crate::frame::Frame::CLAMP) as `clamp` says alone, and, without
    /// `receivers`, have no triangles behind those of the casters: less code to run.
    pub fn specialised(device: &wgpu::Device, clamp: bool, receivers: bool) -> Self {
        let (clamped, receivers) = (u32::from(clamp), u32::from(receivers));
        Self::build(device, kernel::Constants { clamped, receivers })
    }

    fn build(device: &wgpu::Device, constants: kernel::Constants) -> Self {
        Self {
            begin: kernel::BeginProgram::new(device, constants),
            request: kernel::RequestProgram::new(device, constants),
        }
    }

    /// Memory for a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn memory(device: &wgpu::Device, size: usize) -> Result<Buffer<u32>> {
        Buffer::storage(device, "requested_blocks.requested", Self::words(size))
    }

    /// Words for a map of `size` texels a side.
    pub fn words(size: usize) -> usize {
        let blocks = size.div_ceil(kernel::BLOCK as usize);
        1 + blocks * blocks.div_ceil(32)
    }

    /// Records the requests of the listed facets, which take `groups`, one invocation each, into `requested`, which is clear. What is
    /// beyond them must have no triangle.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        triangles: &Buffer<[u32; 4]>,
        positions: &Buffer<[f32; 4]>,
        facets: &Buffer<Facet>,
        requested: &Buffer<u32>,
        groups: Groups,
    ) {
        stage.run(&self.begin, kernel::Begin { requested: requested.as_write() }, Groups::Workgroups(1));
        let bindings = kernel::Request {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            positions: positions.as_read(),
            facets: facets.as_write(),
            requested: requested.as_write(),
        };
        stage.run(&self.request, bindings, groups);
    }
}
