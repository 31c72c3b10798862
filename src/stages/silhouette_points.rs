//! A point of the silhouette in each cell that it crosses: Shadow Silhouette Maps (Sen, Cammarano, Hanrahan 2003).
//!
//! - **Reads** edges, light-view vertices, the rectangles of silhouette edges and the scan of their blocks
//!   ([`SilhouetteMask::record_classify`](super::silhouette_mask::SilhouetteMask::record_classify)), the nearest depth at each texel centre.
//! - **Writes** of each cell of the dual grid, one more a side than texels, `edge_keys` (complement of the bits of the point's depth) and
//!   `point_keys` (its place in the cell; 0 where no edge is).
//! - **Guarantee.** Bit-equal from run to run: of the edges that are not behind all four corners of a cell the nearest to the light.
//! - **Cost.** Two indirect dispatches; one invocation looks at up to 9 x 9 cells.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::silhouette_points as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::scene::Edge;

/// The pipeline.
#[derive(Debug)]
pub struct SilhouettePoints {
    raster: kernel::RasterProgram,
}

/// Silhouette edges as the stage takes them.
#[derive(Clone, Copy, Debug)]
pub struct EdgeBlocks<'a> {
    /// The edges.
    pub edges: &'a Buffer<Edge>,
    /// Light-view vertices.
    pub points: &'a Buffer<[f32; 4]>,
    /// Texels of each edge.
    pub rects: &'a Buffer<[u32; 2]>,
    /// Exclusive scan of their blocks, and their number after the last.
    pub offsets: &'a Buffer<u32>,
    /// Arguments of a dispatch over all blocks: buffer and word.
    pub args: (&'a wgpu::Buffer, u64),
}

/// State of every cell.
#[derive(Debug)]
pub struct SilhouetteCells {
    /// Key of the point's depth.
    pub edge_keys: Buffer<u32>,
    /// Place of the point.
    pub point_keys: Buffer<u32>,
}

impl SilhouetteCells {
    /// Memory for the cells of a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: usize) -> Result<Self> {
        let cells = (size + 1) * (size + 1);
        Ok(Self {
            edge_keys: Buffer::storage(device, "silhouette_points.edge_keys", cells)?,
            point_keys: Buffer::storage(device, "silhouette_points.point_keys", cells)?,
        })
    }

    /// Place of a point in its cell, across and down, 0 to 1; `None`: there is none.
    pub fn place(key: u32) -> Option<[f64; 2]> {
        let part = |steps: u32| (f64::from(steps) - 1.0) / 65534.0;
        (key != 0).then(|| [part(key & 0xffff), part(key >> 16)])
    }
}

impl SilhouettePoints {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { raster: kernel::RasterProgram::new(device, ()) }
    }

    /// Records one of two runs. All keys must be 0 before the first, and [`SilhouetteCells::point_keys`] before the second.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: EdgeBlocks,
        nearest_keys: &Buffer<u32>,
        cells: &SilhouetteCells,
    ) {
        let bindings = kernel::Raster {
            frame: frame.as_uniform(),
            edges: blocks.edges.as_read(),
            map_points: blocks.points.as_read(),
            edge_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            nearest_keys: nearest_keys.as_read(),
            edge_keys: cells.edge_keys.as_write(),
            point_keys: cells.point_keys.as_write(),
        };
        stage.run(&self.raster, bindings, Groups::Indirect(blocks.args.0, blocks.args.1));
    }
}
