//! The silhouette mask map: which texels hold silhouette edges (Pan 2009, section 3.2).
//!
//! - **Reads** edges with their two triangles, facing of each triangle, light-view vertices, the light layers, and which blocks of texels
//!   are [requested](super::requested_blocks).
//! - **Writes** `edge_rects` and `edge_items` (texels an edge may touch and their 8 × 8 blocks; 0 for an edge that is no
//!   silhouette), then marks in the layers' `mask`.
//! - **Guarantee.** Conservative: no silhouette before a texel's split depth is left out. An edge with one triangle, with
//!   more than two, with triangles wound against each other or edge-on to the light is a silhouette. An element with one vertex
//!   twice holds no edge.
//! - **Cost.** One dispatch over edges, one indirect dispatch over blocks.

use super::cluster_culling::{ClusterParams, Elements};
use super::light_layers::Layers;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::silhouette_mask as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::scene::Edge;

/// The pipelines.
#[derive(Debug)]
pub struct SilhouetteMask {
    classify: kernel::ClassifyProgram,
    raster: kernel::RasterProgram,
    uniforms: Uniforms,
}

impl SilhouetteMask {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            classify: kernel::ClassifyProgram::new(device, ()),
            raster: kernel::RasterProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Records which edges are silhouettes; adds their number to the silhouette edges of `status`, of a list of clusters
    /// that of those with texels.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_classify<'a>(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        edges: &Buffer<Edge>,
        facing: &Buffer<u32>,
        map_points: &Buffer<[f32; 4]>,
        requested: &Buffer<u32>,
        edge_rects: &Buffer<[u32; 2]>,
        edge_items: &Buffer<u32>,
        status: &Buffer<u32>,
        of: impl Into<Elements<'a>>,
    ) -> Result<()> {
        let (of, all) = (of.into(), self.uniforms.get(stage.device, &ClusterParams::ALL)?);
        let bindings = kernel::Classify {
            frame: frame.as_uniform(),
            edges: edges.as_read(),
            facing: facing.as_read(),
            map_points: map_points.as_read(),
            requested: requested.as_read(),
            edge_rects: edge_rects.as_write(),
            edge_items: edge_items.as_write(),
            status: status.as_write(),
            kept_clusters: of.list(&all),
        };
        stage.run(&self.classify, bindings, of.groups());
        Ok(())
    }

    /// Records the marking of the texels they touch.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_raster(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        edges: &Buffer<Edge>,
        map_points: &Buffer<[f32; 4]>,
        edge_rects: &Buffer<[u32; 2]>,
        offsets: &Buffer<u32>,
        args: (&wgpu::Buffer, u64),
        layers: &Layers,
    ) {
        let bindings = kernel::Raster {
            frame: frame.as_uniform(),
            edges: edges.as_read(),
            map_points: map_points.as_read(),
            edge_rects: edge_rects.as_write(),
            work_offsets: offsets.as_read(),
            nearest_keys: layers.nearest_keys.as_read(),
            second_keys: layers.second_keys.as_read(),
            mask: layers.mask.as_write(),
        };
        stage.run(&self.raster, bindings, Groups::Indirect(args.0, args.1));
    }
}
