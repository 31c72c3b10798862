//! Occlusion and validity masks: which samples of each undecided facet are occluded, and which do not count (Pan 2009,
//! section 3.4).
//!
//! - **Reads** facets, both pair lists, triangles, positions.
//! - **Writes** the occluded and the invalid mask of each facet, by `atomicOr`; counts evaluations into words 10 and 11 of
//!   `status` and the longest triangle list above one round into word 9.
//! - **Guarantee.** Bit-equal from run to run, whatever the order of the pairs. A sample farther than 1/256 pixel from every
//!   shadow edge is decided as in exact arithmetic: lines that `f32` does not place that well are computed with 46 bits.
//! - **Capacity.** [`ROUND_LENGTH`] triangles of a texel a dispatch; longer lists take more rounds.
//! - **Cost.** One indirect dispatch a round; per evaluation about 60 to 250 flop, per pair one atomic a word that changes.

use super::facet_classify::Facets;
use super::pixel_texel_pairs::PairLists;
use crate::Result;
use crate::gpu::kernels::visibility_masks as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage};

pub use kernel::ROUND_LENGTH;

/// The pipeline for one number of mask words.
#[derive(Debug)]
pub struct VisibilityMasks {
    evaluate: Program,
}

impl VisibilityMasks {
    /// Builds the pipeline for masks of `words` words.
    pub fn new(device: &wgpu::Device, words: u32) -> Self {
        Self { evaluate: Program::new(device, kernel::ENTRY_EVALUATE, &[("WORDS", f64::from(words))]) }
    }

    /// Records one round over all pixel-texel pairs, whose number is in word 0 of `status`.
    ///
    /// # Errors
    /// None that input can cause.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        samples: &wgpu::Buffer,
        triangles: &wgpu::Buffer,
        positions: &wgpu::Buffer,
        facets: &Facets,
        lists: &PairLists,
        args: (&wgpu::Buffer, u64),
        status: &Buffer<u32>,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("samples", samples),
            ("facets", facets.list.raw()),
            ("pairs", lists.pixel_pairs.raw()),
            ("status", status.raw()),
            ("triangle_offsets", lists.triangle_offsets.raw()),
            ("pair_triangles", lists.triangle_pairs.raw()),
            ("triangles", triangles),
            ("positions", positions),
            ("masks", facets.masks.raw()),
        ];
        stage.run(&self.evaluate, &buffers, Groups::Indirect(args.0, args.1))
    }
}
