//! The silhouette mask map: which texels hold silhouette edges (Pan 2009, section 3.2).
//!
//! - **Reads** edges with their two triangles, facing of each triangle, light-view vertices, the light layers.
//! - **Writes** `edge_rects` and `edge_items` (texels an edge may touch and their 8 × 8 blocks; 0 for an edge that is no
//!   silhouette), then marks in the layers' `mask`.
//! - **Guarantee.** Conservative: no silhouette before a texel's split depth is left out. An edge with one triangle, with
//!   more than two, with triangles wound against each other or edge-on to the light is a silhouette.
//! - **Cost.** One dispatch over edges, one indirect dispatch over blocks.

use super::light_layers::Layers;
use crate::Result;
use crate::gpu::kernels::silhouette_mask as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct SilhouetteMask {
    classify: Program,
    raster: Program,
}

impl SilhouetteMask {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            classify: Program::new(device, kernel::ENTRY_CLASSIFY, &[]),
            raster: Program::new(device, kernel::ENTRY_RASTER, &[]),
        }
    }

    /// Records which of `count` edges are silhouettes; adds their number to word 8 of `status`.
    ///
    /// # Errors
    /// None that input can cause.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_classify(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        edges: &wgpu::Buffer,
        facing: &Buffer<u32>,
        map_points: &Buffer<[f32; 4]>,
        edge_rects: &Buffer<[u32; 2]>,
        edge_items: &Buffer<u32>,
        status: &Buffer<u32>,
        count: usize,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("edges", edges),
            ("facing", facing.raw()),
            ("map_points", map_points.raw()),
            ("edge_rects", edge_rects.raw()),
            ("edge_items", edge_items.raw()),
            ("status", status.raw()),
        ];
        stage.run(&self.classify, &buffers, Groups::Items(count as u64))
    }

    /// Records the marking of the texels they touch.
    ///
    /// # Errors
    /// None that input can cause.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_raster(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        edges: &wgpu::Buffer,
        map_points: &Buffer<[f32; 4]>,
        edge_rects: &Buffer<[u32; 2]>,
        offsets: &Buffer<u32>,
        args: (&wgpu::Buffer, u64),
        layers: &Layers,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("edges", edges),
            ("map_points", map_points.raw()),
            ("edge_rects", edge_rects.raw()),
            ("work_offsets", offsets.raw()),
            ("nearest_keys", layers.nearest_keys.raw()),
            ("second_keys", layers.second_keys.raw()),
            ("mask", layers.mask.raw()),
        ];
        stage.run(&self.raster, &buffers, Groups::Indirect(args.0, args.1))
    }
}
