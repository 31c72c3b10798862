//! Pixel-texel pairs: texel by texel, the undecided facets whose light-view outline touches it (Pan 2009, section 3.3).
//!
//! - **Reads** facets, the scan of their blocks, the split depths.
//! - **Writes** on counting `texel_counts` and `texel_deepest`, on emitting `pairs` (facet, texel) grouped by texel; or all at
//!   once `texel_deepest` and the pairs as they come, for [`SortedPairs`](super::SortedPairs).
//! - **Guarantee.** Conservative: every texel in which a caster may shadow the facet makes a pair. Nothing is written beyond
//!   the capacity. The order inside a texel is not defined; what is made of it does not depend on it.
//! - **Cost.** One indirect dispatch to count, two to emit; one invocation looks at up to 64 texels, once, as long as
//!   [`PairLists::touched`] has room for what it found.

use super::camera_visibility::Pass;
use super::facet_classify::Facets;
use super::sorted_pairs;
use crate::Result;
use crate::gpu::kernels::{candidate_pairs::SEEN, pixel_texel_pairs as kernel};
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};

/// The pipeline.
#[derive(Debug)]
pub struct PixelTexelPairs {
    count: Program,
    emit: Program,
    emit_rest: Program,
    append: Program,
    uniforms: Uniforms,
}

/// Lists of pairs by texel.
#[derive(Debug)]
pub struct PairLists {
    /// Pairs of each texel; 0 before each of the four runs.
    pub texel_counts: Buffer<u32>,
    /// Farthest facet of each texel (bits of depth plus 1), then one word for each 8 × 8 block of texels.
    pub texel_deepest: Buffer<u32>,
    /// Scan of the pixel-texel pairs of each texel, their number, and the overflow flag.
    pub pixel_offsets: Buffer<u32>,
    /// Scan of the triangle-texel pairs of each texel, their number, and the overflow flag.
    pub triangle_offsets: Buffer<u32>,
    /// Pixel-texel pairs: facet, texel.
    pub pixel_pairs: Buffer<[u32; 2]>,
    /// Triangle-texel pairs: triangle.
    pub triangle_pairs: Buffer<u32>,
    /// Texels that a block of a facet or caster makes pairs in, one bit each, from counting to emitting; what finds no room
    /// is found twice.
    pub touched: Buffer<[u32; 2]>,
    /// Counters of the band at work and pairs listed lately (see `kernels/shared/candidates.wgsl`), then facet and triangle
    /// of each pair worth evaluating.
    pub candidates: Buffer<u32>,
    /// Candidates to be evaluated again with 46 bits.
    pub doubts: Buffer<u32>,
}

/// Words before the list of candidates.
pub const TALLY_WORDS: usize = 16 + SEEN as usize;

impl PairLists {
    /// Memory for a map of `size` texels a side and this many pairs.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        size: usize,
        pixel_pairs: usize,
        triangle_pairs: usize,
        candidates: usize,
    ) -> Result<Self> {
        let (texels, blocks) = (size * size, size.div_ceil(kernel::BLOCK as usize).pow(2));
        Ok(Self {
            texel_counts: Buffer::storage(device, "pairs.texel_counts", texels)?,
            texel_deepest: Buffer::storage(device, "pairs.texel_deepest", texels + blocks)?,
            pixel_offsets: Buffer::storage(device, "pairs.pixel_offsets", texels + 2)?,
            triangle_offsets: Buffer::storage(device, "pairs.triangle_offsets", texels + 2)?,
            pixel_pairs: Buffer::storage(device, "pairs.pixel_pairs", pixel_pairs)?,
            triangle_pairs: Buffer::storage(device, "pairs.triangle_pairs", triangle_pairs)?,
            // A block makes several pairs as a rule.
            touched: Buffer::storage(device, "pairs.touched", (pixel_pairs + triangle_pairs) / 4)?,
            candidates: Buffer::storage(device, "pairs.candidates", TALLY_WORDS + 2 * candidates)?,
            doubts: Buffer::storage(device, "pairs.doubts", candidates)?,
        })
    }
}

impl PixelTexelPairs {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            count: Program::new(device, kernel::ENTRY_COUNT, &[]),
            emit: Program::new(device, kernel::ENTRY_EMIT, &[]),
            emit_rest: Program::new(device, kernel::ENTRY_EMIT_REST, &[]),
            append: Program::new(device, kernel::ENTRY_APPEND, &[]),
            uniforms: Uniforms::default(),
        }
    }

    /// Records run `index`: 0 counts, 1 emits.
    ///
    /// # Errors
    /// None that input can cause.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        index: u32,
        frame: &wgpu::Buffer,
        facets: &Facets,
        offsets: &Buffer<u32>,
        args: (&wgpu::Buffer, u64),
        splits: &Buffer<f32>,
        lists: &PairLists,
    ) -> Result<()> {
        let kept = self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 });
        let buffers = [
            ("frame", frame),
            ("step", &kept),
            ("facets", facets.list.raw()),
            ("work_offsets", offsets.raw()),
            ("splits", splits.raw()),
            ("texel_counts", lists.texel_counts.raw()),
            ("texel_deepest", lists.texel_deepest.raw()),
            ("pair_offsets", lists.pixel_offsets.raw()),
            ("pairs", lists.pixel_pairs.raw()),
            ("touched", lists.touched.raw()),
        ];
        let programs = if index == 0 { vec![&self.count] } else { vec![&self.emit, &self.emit_rest] };
        programs.into_iter().try_for_each(|program| stage.run(program, &buffers, Groups::Indirect(args.0, args.1)))
    }

    /// Records the listing of pairs as they come, to be sorted; the capacity of `frame` may not be above that of `to`.
    ///
    /// # Errors
    /// None that input can cause.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_append(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        facets: &Facets,
        offsets: &Buffer<u32>,
        args: (&wgpu::Buffer, u64),
        splits: &Buffer<f32>,
        lists: &PairLists,
        to: &sorted_pairs::Scratch,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("facets", facets.list.raw()),
            ("work_offsets", offsets.raw()),
            ("splits", splits.raw()),
            ("texel_deepest", lists.texel_deepest.raw()),
            ("appended", to.appended.raw()),
            ("keys", to.keys.raw()),
            ("values", to.values.raw()),
        ];
        stage.run(&self.append, &buffers, Groups::Indirect(args.0, args.1))
    }
}
