//! Pixel-texel pairs: texel by texel, the undecided facets whose light-view outline touches it (Pan 2009, section 3.3). Where
//! pairs meet by tiles of 2 × 2 texels ([`PairTiles::Tiles`]), those texels of a tile are one pair.
//!
//! - **Reads** facets, the scan of their blocks, the split depths.
//! - **Writes** on counting `place_counts` and `place_deepest`, on emitting `pixel_pairs` grouped by place; or all at once
//!   `place_deepest` and the pairs as they come, for [`SortedPairs`](super::SortedPairs).
//! - **Guarantee.** Conservative: every texel in which a caster may shadow the facet is in a pair. Nothing is written beyond
//!   the capacity. The order inside a place is not defined; what is made of it does not depend on it.
//! - **Cost.** One indirect dispatch to count, two to emit; one invocation looks at up to 64 texels, once, as long as
//!   [`PairLists::touched`] has room for what it found.

use super::camera_visibility::Pass;
use super::facet_classify::Facets;
use super::sorted_pairs;
use crate::frame::Frame;
use crate::gpu::kernels::{candidate_pairs::SEEN, pixel_texel_pairs as kernel};
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Error, Result};

/// The pipeline.
#[derive(Debug)]
pub struct PixelTexelPairs {
    count: kernel::CountProgram,
    emit: kernel::EmitProgram,
    emit_rest: kernel::EmitRestProgram,
    append: kernel::AppendProgram,
    uniforms: Uniforms,
    places: PairTiles,
}

/// Where pairs meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PairTiles {
    /// At texels of the map (Pan 2009).
    Texels,
    /// At tiles of 2 × 2 texels. A pair says which part of the tile it is about, so that most pairs that share a tile and
    /// nothing in it are told by one word.
    #[default]
    Tiles,
}

impl PairTiles {
    /// How many there are in a map of `size` texels a side.
    pub fn count(self, size: usize) -> usize {
        size.div_ceil(1 << self.shift()).pow(2)
    }

    /// Words of a triangle-texel pair.
    pub fn words(self) -> usize {
        match self {
            Self::Texels => 1,
            Self::Tiles => 2,
        }
    }

    /// Texels a side of one, as a power of two.
    pub(super) fn shift(self) -> u32 {
        match self {
            Self::Texels => 0,
            Self::Tiles => 1,
        }
    }
}

/// Lists of pairs by place.
#[derive(Debug)]
pub struct PairLists {
    /// Where they meet.
    pub places: PairTiles,
    /// Pairs of each place; 0 before each of the four runs.
    pub place_counts: Buffer<u32>,
    /// Farthest facet of each place (bits of depth plus 1), then one word for each 8 × 8 block of texels.
    pub place_deepest: Buffer<u32>,
    /// Scan of the pixel-texel pairs of each place, their number, and the overflow flag.
    pub pixel_offsets: Buffer<u32>,
    /// Scan of the triangle-texel pairs of each place, their number, and the overflow flag.
    pub triangle_offsets: Buffer<u32>,
    /// Pixel-texel pairs: facet, and texel; or tile × 16 and one bit for each of its texels, row by row.
    pub pixel_pairs: Buffer<[u32; 2]>,
    /// Triangle-texel pairs: triangle; of tiles before it a word of the 4 × 4 cells, half a texel a side, that the triangle may
    /// touch (bits 0 to 15, row by row) and the upper half of the bits of its least depth there (16 to 31, rounded down).
    pub triangle_pairs: Buffer<u32>,
    /// Places that a block of a facet (of it always texels) or caster makes pairs in, one bit each, from counting to emitting;
    /// what finds no room is found twice.
    pub touched: Buffer<[u32; 2]>,
    /// Counters of the band at work and pairs listed lately (see `kernels/shared/raster/candidates.wgsl`), then facet and triangle
    /// of each pair worth evaluating.
    pub candidates: Buffer<u32>,
    /// Candidates to be evaluated again with 46 bits.
    pub doubts: Buffer<u32>,
    /// Other candidates that may cut the facet within its pixel; none without [`Frame::VALIDITY`].
    pub cuts: Buffer<u32>,
}

/// Words before the list of candidates.
pub const TALLY_WORDS: usize = TALLY_COUNTERS + SEEN as usize;
/// Counters at their beginning.
pub const TALLY_COUNTERS: usize = 16;

impl PairLists {
    /// Memory for a map of `size` texels a side and this many pairs, which meet at `places`. `validity`: frames may set
    /// [`Frame::VALIDITY`].
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        size: usize,
        places: PairTiles,
        pixel_pairs: usize,
        triangle_pairs: usize,
        candidates: usize,
        validity: bool,
    ) -> Result<Self> {
        let (count, blocks) = (places.count(size), size.div_ceil(kernel::BLOCK as usize).pow(2));
        Ok(Self {
            places,
            place_counts: Buffer::storage(device, "pairs.place_counts", count)?,
            place_deepest: Buffer::storage(device, "pairs.place_deepest", count + blocks)?,
            pixel_offsets: Buffer::storage(device, "pairs.pixel_offsets", count + 2)?,
            triangle_offsets: Buffer::storage(device, "pairs.triangle_offsets", count + 2)?,
            pixel_pairs: Buffer::storage(device, "pairs.pixel_pairs", pixel_pairs)?,
            triangle_pairs: Buffer::storage(device, "pairs.triangle_pairs", places.words() * triangle_pairs)?,
            touched: Buffer::storage(device, "pairs.touched", Self::touched_words(pixel_pairs, triangle_pairs))?,
            candidates: Buffer::storage(device, "pairs.candidates", TALLY_WORDS + 2 * candidates)?,
            doubts: Buffer::storage(device, "pairs.doubts", candidates)?,
            cuts: Buffer::storage(device, "pairs.cuts", if validity { candidates } else { 0 })?,
        })
    }

    /// Blocks that [`PairLists::touched`] has room for: one makes several pairs as a rule.
    pub(crate) fn touched_words(pixel_pairs: usize, triangle_pairs: usize) -> usize {
        (pixel_pairs + triangle_pairs) / 4
    }

    /// Checks that a stage made for `places` may use them.
    pub(super) fn check(&self, places: PairTiles) -> Result<()> {
        if self.places == places {
            return Ok(());
        }
        Err(Error::Config(format!("pairs of {:?} in a stage made for {places:?}", self.places)))
    }
}

impl PixelTexelPairs {
    /// Builds the pipeline for pairs that meet at `places`.
    pub fn new(device: &wgpu::Device, places: PairTiles) -> Self {
        let constants = kernel::Constants { tile_shift: places.shift() };
        Self {
            count: kernel::CountProgram::new(device, constants),
            emit: kernel::EmitProgram::new(device, constants),
            emit_rest: kernel::EmitRestProgram::new(device, constants),
            append: kernel::AppendProgram::new(device, kernel::Constants::default()),
            uniforms: Uniforms::default(),
            places,
        }
    }

    /// Where pairs meet.
    pub fn places(&self) -> PairTiles {
        self.places
    }

    /// Records run `index`: 0 counts, 1 emits. `args`: for all blocks of the facets; `rest`: for those that find no room in
    /// [`PairLists::touched`].
    ///
    /// # Errors
    /// [`Error::Config`] if the lists are of other places.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        index: u32,
        frame: &Buffer<Frame>,
        facets: &Facets,
        offsets: &Buffer<u32>,
        [args, rest]: [(&wgpu::Buffer, u64); 2],
        splits: &Buffer<f32>,
        lists: &PairLists,
    ) -> Result<()> {
        lists.check(self.places)?;
        let kept = self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 })?;
        let bindings = kernel::Pairs {
            frame: frame.as_uniform(),
            step: kept.as_uniform(),
            undecided: facets.undecided.as_read(),
            work_offsets: offsets.as_read(),
            splits: splits.as_read(),
            place_counts: lists.place_counts.as_write(),
            place_deepest: lists.place_deepest.as_write(),
            pair_offsets: lists.pixel_offsets.as_read(),
            pairs: lists.pixel_pairs.as_write(),
            touched: lists.touched.as_write(),
        };
        if index == 0 {
            stage.run(&self.count, bindings, Groups::Indirect(args.0, args.1));
            return Ok(());
        }
        stage.run(&self.emit, bindings, Groups::Indirect(args.0, args.1));
        stage.run(&self.emit_rest, bindings, Groups::Indirect(rest.0, rest.1));
        Ok(())
    }

    /// Records the listing of pairs as they come, texel by texel, to be sorted; the capacity of `frame` may not be above that
    /// of `to`.
    ///
    /// # Errors
    /// [`Error::Config`] if the lists are of tiles.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_append(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        facets: &Facets,
        offsets: &Buffer<u32>,
        args: (&wgpu::Buffer, u64),
        splits: &Buffer<f32>,
        lists: &PairLists,
        to: &sorted_pairs::SortedPairsScratch,
    ) -> Result<()> {
        lists.check(PairTiles::Texels)?;
        let bindings = kernel::Append {
            frame: frame.as_uniform(),
            undecided: facets.undecided.as_read(),
            work_offsets: offsets.as_read(),
            splits: splits.as_read(),
            place_deepest: lists.place_deepest.as_write(),
            appended: to.appended.as_write(),
            keys: to.keys.as_write(),
            values: to.values.as_write(),
        };
        stage.run(&self.append, bindings, Groups::Indirect(args.0, args.1));
        Ok(())
    }
}
