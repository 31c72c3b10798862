//! Candidates: the pairs of facet and triangle that are worth evaluating.
//!
//! - **Reads** both pair lists, facets, light-view vertices.
//! - **Writes** `candidates` (facet, triangle) and, before them, how many were needed and how many tests were made; the
//!   occluded mask of a facet that one triangle covers wholly, which then needs no candidates.
//! - **Guarantee.** Conservative: a triangle that casts on a facet, or cuts it within its pixel, is kept; with
//!   [`Frame::CULL_BACK`](crate::frame::Frame::CULL_BACK), of those that are no casters, what cuts. The order is not
//!   defined, and of a pair that shares several places most but not all repetitions are left out (which is why the count
//!   may differ a little from run to run); what is made of it depends on neither. Nothing is written beyond the capacity.
//! - **Capacity.** As many triangles of a place a dispatch as [`Profile::turns`] of 4096 says; longer lists take more dispatches.
//! - **Cost.** One indirect dispatch, or more. Of tiles one word a test leaves out most; what remains takes one atomic, and once
//!   for each pair about 70 flop and 12 words read.

use super::camera_visibility::Pass;
use super::facet_classify::Facets;
use super::pixel_texel_pairs::{PairLists, PairTiles};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::candidate_pairs as kernel;
use crate::gpu::{Buffer, Groups, Profile, Stage, Uniforms};

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
    round_length: u32,
    uniforms: Uniforms,
}

impl CandidatePairs {
    /// Builds the pipeline for masks of `words` words and pairs that meet at `places`. `alone`: there may be facets whose samples all lie
    /// on their own triangle ([`Frame::CLAMP`](crate::frame::Frame::CLAMP)), on which neighbours that face the light alike cast nothing.
    pub fn new(device: &wgpu::Device, words: u32, places: PairTiles, alone: bool) -> Self {
        let round_length = Profile::of(device).turns(4096);
        let constants = kernel::Constants { words, tile_shift: places.shift(), alone: u32::from(alone), round_length };
        let uniforms = Uniforms::default();
        Self { cull: kernel::CullProgram::new(device, constants), places, round_length, uniforms }
    }

    /// Where pairs meet.
    pub fn places(&self) -> PairTiles {
        self.places
    }

    /// Records all pixel-texel pairs, whose number is in word 0 of the tally, against up to `most` triangles of their place, and what is left
    /// of its dispatch.
    ///
    /// # Errors
    /// [`Error::Config`](crate::Error::Config) if the lists are of other places, [`Error::Gpu`](crate::Error::Gpu) if the device has no memory
    /// for parameters.
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
        most: u32,
    ) -> Result<()> {
        lists.check(self.places)?;
        for index in 0..most.div_ceil(self.round_length).max(1) {
            let step = self.uniforms.get(stage.device, &Pass { index })?;
            let bindings = kernel::Cull {
                frame: frame.as_uniform(),
                step: step.as_uniform(),
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
        }
        Ok(())
    }
}
