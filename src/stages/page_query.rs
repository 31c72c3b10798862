//! Shadows by depth comparison with pages of a quadtree, each pixel on a level of its own.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets; the level of each pixel and the table of
//!   [`page_requests`](super::page_requests), the pages of [`page_casters`](super::page_casters).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Every sample finds a page: the one of its level, or the next coarser that is made. Nothing is
//!   settled early and nothing is exact: the bias decides.
//! - **Cost.** One dispatch over pixels; per sample two words of the table and a texel.

use super::PrimaryHits;
use super::page_casters::PageTexels;
use super::page_requests::{PageNodes, PageTree};
use crate::frame::Frame;
use crate::gpu::kernels::page_query as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct PageQuery {
    compare: kernel::CompareProgram,
}

impl PageQuery {
    /// Builds the pipeline for a tree and a bias: constant, and times the steeper slope of the receiver per texel of the page.
    pub fn new(device: &wgpu::Device, tree: PageTree, [bias_constant, bias_slope]: [f32; 2]) -> Self {
        let PageTree { base: page_base, last: page_last } = tree;
        let constants = kernel::Constants { paraboloids: 0, bias_constant, bias_slope, page_base, page_last };
        Self { compare: kernel::CompareProgram::new(device, constants) }
    }

    /// Records the comparison of every pixel.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        (nodes, texels): (&PageNodes, &PageTexels),
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            levels: nodes.levels.as_read(),
            table: nodes.table.as_read(),
            pages: texels.keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
