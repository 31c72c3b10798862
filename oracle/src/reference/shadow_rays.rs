//! Shadow rays, one by one: each sample of a facet against every triangle.

use crate::truth::{FacetInput, FacetResult, FacetTruth};

/// The masks of facets (pixel, triangle, coverage) whose samples are followed to the light: occluded and, unless `truth` leaves
/// it out, valid samples, with those of which either is ambiguous.
///
/// # Errors
/// As [`FacetTruth::judge`].
pub fn masks(truth: &FacetTruth, facets: &[FacetInput]) -> subpixel_shadows::Result<Vec<FacetResult>> {
    truth.judge(facets, None)
}
