//! Candidates: the pairs of facet and triangle that are worth evaluating.
//!
//! - **Reads** both pair lists, facets, light-view vertices.
//! - **Writes** `candidates` (facet, triangle) and, before them, how many were needed and how many tests were made; the
//!   occluded mask of a facet that one triangle covers wholly, which then needs no candidates.
//! - **Guarantee.** Conservative: a triangle that casts on a facet, or cuts it within its pixel, is kept; with
//!   [`Frame::CULL_BACK`](crate::frame::Frame::CULL_BACK), of those that are no casters, what cuts. The order is not
//!   defined, and of a pair that shares several places most but not all repetitions are left out (which is why the count
//!   may differ a little from run to run); what is made of it depends on neither. Nothing is written beyond the capacity.
//! - **Capacity.** [`ROUND_LENGTH`] triangles of a place a dispatch; longer lists take more rounds.
//! - **Cost.** One indirect dispatch a round. Of tiles one word a test leaves out most; what remains takes one atomic, and once
//!   for each pair about 70 flop and 12 words read.

use super::facet_classify::Facets;
use super::pixel_texel_pairs::{PairLists, PairTiles};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::candidate_pairs as kernel;
use crate::gpu::{Buffer, Groups, Stage};

pub use kernel::ROUND_LENGTH;

/// Words of the tally.
pub mod tally {
    pub use crate::gpu::kernels::candidate_pairs::{
        TALLY_CANDIDATES, TALLY_DOUBTS, TALLY_LONGEST, TALLY_PAIRS, TALLY_TESTS,
    };
}

/// The pipeline.
#[derive(Debug)]
pub struct CandidatePairs {
    cull: kernel::CullProgram,
    places: PairTiles,
}

impl CandidatePairs {
    /// Builds the pipeline for masks of `words` words and pairs that meet at `places`. `alone`: there may be facets whose samples all lie
    /// on their own triangle ([`Frame::CLAMP`](crate::frame::Frame::CLAMP)), on which neighbours that face the light alike cast nothing.
    pub fn new(device: &wgpu::Device, words: u32, places: PairTiles, alone: bool) -> Self {
        let constants = kernel::Constants { words, tile_shift: places.shift(), alone: u32::from(alone) };
        Self { cull: kernel::CullProgram::new(device, constants), places }
    }

    /// Where pairs meet.
    pub fn places(&self) -> PairTiles {
        self.places
    }

    /// Records one round over all pixel-texel pairs, whose number is in word 0 of the tally.
    ///
    /// # Errors
    /// [`Error::Config`](crate::Error::Config) if the lists are of other places.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        triangles: &Buffer<[u32; 4]>,
        map_points: &Buffer<[f32; 4]>,
        facets: &Facets,
        args: (&wgpu::Buffer, u64),
        lists: &PairLists,
    ) -> Result<()> {
        lists.check(self.places)?;
        let bindings = kernel::Cull {
            frame: frame.as_uniform(),
            undecided: facets.undecided.as_read(),
            pairs: lists.pixel_pairs.as_read(),
            triangle_offsets: lists.triangle_offsets.as_read(),
            pair_triangles: lists.triangle_pairs.as_read(),
            triangles: triangles.as_read(),
            map_points: map_points.as_read(),
            candidates: lists.candidates.as_write(),
            masks: facets.masks.as_write(),
        };
        stage.run(&self.cull, bindings, Groups::Indirect(args.0, args.1));
        Ok(())
    }
}
