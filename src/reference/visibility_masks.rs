//! Which samples of each facet are occluded, and which do not count.
//!
//! The predicate is that of [`crate::truth::predicate`], and what a facet's samples, shadows and validity lines are is
//! written once in [`crate::truth::facet_truth`]; here it looks at the listed triangles alone.

use super::facet_classify::Facet;
use crate::truth::{FacetInput, FacetResult, FacetTruth, Progress, split_mask};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Judges each facet against its candidates, in parallel; facets without candidates keep `None`. Progress counts facets.
pub fn masks(
    truth: &FacetTruth,
    facets: &[Facet],
    candidates: &[Vec<u32>],
    progress: Progress,
) -> Vec<Option<FacetResult>> {
    let done = AtomicUsize::new(0);
    let judge = |(k, part): (usize, &[Facet])| -> Vec<Option<FacetResult>> {
        let lists = &candidates[k * PART..];
        let results = part.iter().zip(lists).map(|(facet, list)| {
            let triangle = facet.triangle?;
            let input = FacetInput { pixel: facet.pixel, triangle, coverage: split_mask(facet.coverage) };
            (!list.is_empty()).then(|| truth.judge_among(&input, list))
        });
        let results = results.collect();
        let count = done.fetch_add(part.len(), Ordering::Relaxed) + part.len();
        if let Some(report) = progress {
            report(count, facets.len());
        }
        results
    };
    facets.par_chunks(PART).enumerate().flat_map_iter(judge).collect()
}

/// Facets a task.
const PART: usize = 512;
