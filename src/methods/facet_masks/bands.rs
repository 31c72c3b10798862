//! One band of facets of `facet-masks`: pairs by texel, candidates, masks (Pan 2009, sections 3.3 and 3.4).

use super::FacetMasks;
use super::memory::Arg;
use super::pipelines::PairPipelines;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Recorder};
use crate::methods::prepared::CasterBuffers;
use crate::stages::camera_visibility::Blocks;
use crate::stages::candidate_pairs::tally;
use crate::stages::sorted_pairs::{self, Sorted};
use crate::stages::visibility_masks::EvaluationInputs;
use crate::status::StatusBand;
use crate::status_word;
use std::mem::offset_of;

impl FacetMasks {
    /// The pairs of one band of facets in one view, and their evaluation.
    pub(super) fn record_band(
        &self,
        rec: &mut Recorder,
        with: &PairPipelines,
        casters: &CasterBuffers,
        in_light: Blocks,
        (view, band): (u32, u32),
    ) -> Result<()> {
        let m = &self.memory;
        let places = m.lists.place_counts.len();
        let frame = &m.frames[self.frame_at(view, band)];
        rec.clear(m.lists.place_deepest.raw());
        match &m.unsorted {
            None => self.record_grouped(rec, with, frame, in_light)?,
            Some(unsorted) => self.record_sorted(rec, with, frame, in_light, unsorted)?,
        }
        rec.copy_words(
            m.lists.pixel_offsets.raw(),
            places as u64,
            m.lists.candidates.raw(),
            u64::from(tally::TALLY_PAIRS),
            1,
        );
        rec.clear_words(m.lists.candidates.raw(), u64::from(tally::TALLY_CANDIDATES), 4);
        let (triangles, positions) = (&casters.triangles, &casters.positions);
        {
            let stage = &mut rec.stage("candidate_pairs");
            self.args(stage, Arg::Pairs, &m.lists.candidates)?;
            let args = (m.args.raw(), Arg::Pairs.word());
            let (points, most) = (&m.geometry.map_points, self.capacities.most_at_place);
            with.candidates.record(stage, frame, triangles, points, &m.facets, args, &m.lists, most)?;
        }
        {
            let stage = &mut rec.stage("visibility_masks");
            let casters = EvaluationInputs { samples: &m.samples, table: &m.table, triangles, positions };
            self.args(stage, Arg::Candidates, &m.lists.candidates)?;
            let args = (m.args.raw(), Arg::Candidates.word());
            with.masks.record_evaluate(stage, frame, casters, &m.facets, &m.lists, args);
        }
        {
            let stage = &mut rec.stage("visibility_refine");
            let casters = EvaluationInputs { samples: &m.samples, table: &m.table, triangles, positions };
            self.args(stage, Arg::Doubts, &m.lists.candidates)?;
            let args = (m.args.raw(), Arg::Doubts.word());
            with.masks.record_refine(stage, frame, casters, &m.facets, &m.lists, args);
        }
        if let (Some(counted), Some(counts)) = (&with.counted, &m.counts) {
            let stage = &mut rec.stage("pixel_counts");
            let args = [Arg::Pairs, Arg::Candidates].map(|arg| (m.args.raw(), arg.word()));
            counted.record(stage, frame, &m.facets, &m.lists, args, counts);
        }
        let slot = self.capacities.status_band(view, band) as u64;
        let at = |field: usize| slot + field as u64 / 4;
        rec.copy_words(
            m.lists.pixel_offsets.raw(),
            places as u64,
            m.status.raw(),
            at(offset_of!(StatusBand, pixel_pairs)),
            2,
        );
        rec.copy_words(
            m.lists.triangle_offsets.raw(),
            places as u64,
            m.status.raw(),
            at(offset_of!(StatusBand, triangle_pairs)),
            2,
        );
        rec.copy_words(
            m.lists.candidates.raw(),
            u64::from(tally::TALLY_CANDIDATES),
            m.status.raw(),
            at(offset_of!(StatusBand, candidates)),
            3,
        );
        rec.copy_words(
            m.lists.candidates.raw(),
            u64::from(tally::TALLY_TESTS),
            m.status.raw(),
            status_word!(candidate_tests) as u64,
            2,
        );
        Ok(())
    }

    /// The pairs of one band, counted, scanned and written to their places.
    fn record_grouped(
        &self,
        rec: &mut Recorder,
        with: &PairPipelines,
        frame: &Buffer<Frame>,
        in_light: Blocks,
    ) -> Result<()> {
        let m = &self.memory;
        let places = m.lists.place_counts.len();
        let args = [Arg::Facets, Arg::FacetsAgain].map(|arg| (m.args.raw(), arg.word()));
        for run in 0..2 {
            rec.clear(m.lists.place_counts.raw());
            let stage = &mut rec.stage("pixel_texel_pairs");
            let splits = &m.maps.layers.splits;
            let offsets = &m.facet_offsets;
            if run == 1 {
                self.args(stage, Arg::FacetsAgain, offsets)?;
            }
            with.pixel_pairs.record(stage, run, frame, &m.facets, offsets, args, splits, &m.lists)?;
            if run == 0 {
                self.scan(stage, &m.lists.place_counts, &m.lists.pixel_offsets, places)?;
            }
        }
        for run in 0..2 {
            rec.clear(m.lists.place_counts.raw());
            let stage = &mut rec.stage("triangle_texel_pairs");
            if run == 1 {
                self.args(stage, Arg::CastersAgain, in_light.offsets)?;
            }
            let rest = (m.args.raw(), Arg::CastersAgain.word());
            with.triangle_pairs.record(stage, run, frame, in_light, rest, &m.lists)?;
            if run == 0 {
                self.scan(stage, &m.lists.place_counts, &m.lists.triangle_offsets, places)?;
            }
        }
        Ok(())
    }

    /// The pairs of one band, listed as they come and sorted.
    fn record_sorted(
        &self,
        rec: &mut Recorder,
        with: &PairPipelines,
        frame: &Buffer<Frame>,
        in_light: Blocks,
        [of_pixels, of_triangles]: &[sorted_pairs::SortedPairsScratch; 2],
    ) -> Result<()> {
        let m = &self.memory;
        let Some(sorted) = &with.sorted else { return Ok(()) };
        let (counts, args) = (&m.lists.place_counts, (m.args.raw(), Arg::Facets.word()));
        let (places, splits) = (counts.len(), &m.maps.layers.splits);
        let counted = |rec: &mut Recorder, from: &sorted_pairs::SortedPairsScratch, offsets: &Buffer<u32>| {
            // Of pairs beyond the capacity it is known only that they are there.
            rec.copy_words(from.appended.raw(), 0, offsets.raw(), places as u64, 2);
        };
        for list in [of_pixels, of_triangles] {
            rec.clear(list.appended.raw());
        }
        rec.clear(counts.raw());
        {
            let stage = &mut rec.stage("pixel_texel_pairs");
            let offsets = &m.facet_offsets;
            with.pixel_pairs.record_append(stage, frame, &m.facets, offsets, args, splits, &m.lists, of_pixels)?;
            sorted.record(stage, of_pixels, Sorted::Pairs(&m.lists.pixel_pairs), counts)?;
            self.scan(stage, counts, &m.lists.pixel_offsets, places)?;
        }
        counted(rec, of_pixels, &m.lists.pixel_offsets);
        rec.clear(counts.raw());
        {
            let stage = &mut rec.stage("triangle_texel_pairs");
            with.triangle_pairs.record_append(stage, frame, in_light, &m.lists, of_triangles)?;
            sorted.record(stage, of_triangles, Sorted::Items(&m.lists.triangle_pairs), counts)?;
            self.scan(stage, counts, &m.lists.triangle_offsets, places)?;
        }
        counted(rec, of_triangles, &m.lists.triangle_offsets);
        Ok(())
    }
}
