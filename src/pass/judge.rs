//! How a finished frame came out, by its counters.

use super::status::{Faults, Finished, FrameStatus, Label};
use super::{ShadowPass, list_sizing};
use crate::methods::facet_masks::{Capacities, MapSource};
use crate::methods::list_sizing::Needs;
use crate::methods::output::{Counts, ListUse};
use crate::status::Status;

/// Stamp that the last stage of a frame writes into its counters: never 0, and different for each of some billion frames.
pub fn stamp_of(frame: u64) -> u32 {
    (frame % u64::from(u32::MAX)) as u32 + 1
}

/// The range of depths that holds both.
pub(crate) fn depths_of_both(one: Option<[f32; 2]>, other: Option<[f32; 2]>) -> Option<[f32; 2]> {
    match (one, other) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        (one, other) => one.or(other),
    }
}

impl ShadowPass {
    /// Takes in what is known by now.
    pub(super) fn collect(&mut self) {
        for finished in self.in_flight.finished(self.timer.as_ref()) {
            let needed = finished.read.as_ref().map_or(0, |(.., needed)| *needed);
            let room = finished.label.listed;
            let mut status = self.judge(finished);
            if let Some(room) = room.filter(|_| status.error.is_none()) {
                let (needed, capacity) = (u64::from(needed), u64::from(room));
                status.light_lists = Some(ListUse { name: "light_lists", needed, capacity, runs: 1 });
                status.overflowed |= needed > capacity;
                status.complete &= needed <= capacity;
            }
            if self.known.len() == Self::KEPT {
                self.known.pop_front();
            }
            self.known.push_back(status);
        }
    }

    fn judge(&mut self, finished: Finished) -> FrameStatus {
        let Finished { label: Label { frame, generation, capacities, strips, dispatches, maps, edits, .. }, read } =
            finished;
        let mut status = FrameStatus {
            frame,
            complete: false,
            overflowed: false,
            faults: Faults::default(),
            error: None,
            dispatches,
            maps_kept: maps.source == MapSource::Kept,
            depths: None,
            counts: Counts::default(),
            lists: Vec::new(),
            light_lists: None,
            stages: Vec::new(),
        };
        let words;
        (words, status.faults, status.stages) = match read {
            Ok((words, faults, stages, _)) => (words, faults, stages),
            Err(error) => {
                status.error = Some(error.to_string());
                self.failure = Some(error);
                return status;
            }
        };
        let strips: Vec<_> = words.chunks_exact(words.len() / strips.max(1) as usize).map(Status::of).collect();
        // The staging buffer of commands that did not run holds zeros, or the counters of an earlier frame.
        if strips.iter().any(|strip| strip.head.finished != stamp_of(frame)) {
            let text = format!("frame {frame} was submitted, and did not run to its end: its commands were refused");
            return FrameStatus { error: Some(text), faults: Faults::default(), stages: Vec::new(), ..status };
        }
        let same = generation == self.generation;
        if let Some(parts) = &mut self.casters.parts {
            parts.have_run(edits);
        }
        if strips.iter().any(|strip| strip.head.maps != maps.number) {
            let text = format!(
                "frame {frame} found the light maps of another: frames ran in another order than they were recorded in"
            );
            return FrameStatus { error: Some(text), ..status };
        }
        if same {
            self.kept_maps.have_run(maps);
        }
        let (facets, limits, budget) = (self.settings.facets, self.maker.device.limits(), self.maker.budget.bytes);
        // What the lists must hold is what the largest strip needs of each.
        let mut needs = Needs::default();
        for strip in &strips {
            status.depths = depths_of_both(status.depths, strip.depths());
            status.counts = status.counts.with_rows(list_sizing::counts(strip));
            needs = needs.or(Needs::of(strip));
        }
        if self.image.method.is_fixed() {
            return self.judge_fixed(status, &words, same);
        }
        status.lists = list_sizing::lists(&needs, capacities, facets, 1);
        let triangles = self.casters.buffers.triangles.len();
        let reach = |wanted| list_sizing::in_reach(&needs, capacities, wanted, &self.settings, budget, triangles);
        let wanted = list_sizing::wanted(&needs, capacities, &self.settings, &limits, budget);
        match wanted.and_then(|wanted| wanted.map(reach).transpose()) {
            Ok(wanted) => status.overflowed = wanted.is_some(),
            Err(error) => {
                (status.overflowed, status.error) = (true, Some(error.to_string()));
                self.failure = Some(error);
            }
        }
        // A frame with other lists than those in use says nothing of these, and one for which there are none is not waited for.
        let in_use = self.image.method.capacities();
        let same = same && in_use == (Capacities { views: in_use.views, ..capacities });
        if same && status.error.is_none() {
            self.wanted =
                self.together.wanted(needs, capacities, &self.settings, &limits, (budget, triangles)).or(self.wanted);
        }
        status.complete = !status.overflowed && status.faults == Faults::default();
        status
    }

    /// The status of a frame of a method without lists, given its counters.
    #[cfg(feature = "baselines")]
    fn judge_fixed(&mut self, mut status: FrameStatus, words: &[u32], same: bool) -> FrameStatus {
        if status.counts.facets == 0 {
            status.counts.facets = self.settings.pixels() as u64;
        }
        // Frames of other memory say nothing of this one.
        let ledger = self.ledger.clone();
        match if same { ledger.within(|| self.image.method.outcome(words)) } else { Ok(Default::default()) } {
            Ok(outcome) => {
                status.overflowed = outcome.left_out;
                if outcome.left_out {
                    // They hold the buffers that larger ones have replaced.
                    self.bind_groups.forget();
                }
                [status.counts.visibility_evaluations, status.counts.refined_evaluations] = outcome.evaluations;
            }
            Err(error) => {
                status.error = Some(error.to_string());
                self.failure = Some(error);
            }
        }
        status.complete = !status.overflowed && status.error.is_none() && status.faults == Faults::default();
        status
    }

    #[cfg(not(feature = "baselines"))]
    fn judge_fixed(&mut self, status: FrameStatus, _: &[u32], _: bool) -> FrameStatus {
        status
    }
}
