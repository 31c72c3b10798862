//! Samples by the texel of the light view they project to, and what becomes of them.

use super::view::MapEnds;
use crate::truth::{FacetInput, FacetResult, FacetTruth};
use glam::DVec2;

/// The texel of each place (texel x, y) of a map, held at its rim; `None` more than a texel outside, but for beyond
/// its ends.
pub fn texels(places: &[DVec2], MapEnds { size, ends }: MapEnds) -> Vec<Option<u32>> {
    let side = f64::from(size);
    let inside = |p: &DVec2| {
        let over = [p.x <= -1.0, p.x >= side + 1.0, p.y <= -1.0, p.y >= side + 1.0];
        !over.iter().zip(ends).any(|(over, end)| *over && !end)
    };
    let texel = |p: DVec2| {
        let cell = p.clamp(DVec2::ZERO, DVec2::splat(side - 1.0));
        cell.y as u32 * size + cell.x as u32
    };
    places.iter().map(|p| inside(p).then(|| texel(*p))).collect()
}

/// The masks of facets (pixel, triangle, coverage), each sample against every triangle: bins only say where to look.
///
/// # Errors
/// As [`FacetTruth::judge`].
pub fn masks(truth: &FacetTruth, facets: &[FacetInput]) -> subpixel_shadows::Result<Vec<FacetResult>> {
    truth.judge(facets, None)
}
