//! The lists of a first frame, by the mesh.

use super::{
    AT_PIXEL, AT_PLACE, Capacities, FacetMode, Settings, Undecided, affordable, first, largest_binding, listed_bytes,
    longest_lists,
};
use crate::methods::output::Budget;

/// Most steps of a list of triangles that are guessed: where a dispatch takes one, it runs without triangles, too.
const MOST_STEPS: u32 = 4;

/// As [`first`], with room for what a mesh of `triangles` triangles makes, so that a first frame is likely whole, and the second where
/// it is not: of the built-in scenes at sizes from 96 x 72.
pub fn first_for(settings: &Settings, budget: Budget, triangles: usize) -> Capacities {
    let first = first(settings, budget);
    if budget.start.is_some() {
        return first;
    }
    let pixels = settings.pixels();
    let of_mesh = |each: usize| triangles.saturating_mul(each).min(1 << 22);
    let mut with_mesh = Capacities {
        triangle_pairs: first.triangle_pairs.max(of_mesh(4)),
        candidates: first.candidates.max(of_mesh(8)),
        most_at_place: crowd(triangles, 96, settings.pairs.places().count(settings.map as usize), AT_PLACE),
        ..first
    };
    if settings.facets == FacetMode::All {
        // Triangles smaller than a pixel lie in two to four of them; of what is that fine most pixels show several.
        with_mesh.pixel_triangles = first.pixel_triangles.saturating_add(of_mesh(4));
        with_mesh.complex_pixels = (pixels / 4 + triangles / 4).max(first.complex_pixels).min(pixels);
        with_mesh.facets = first.facets.saturating_add((triangles / 2).min(6 * pixels));
        with_mesh.pixel_pairs = first.pixel_pairs.max(with_mesh.facets);
        with_mesh.most_at_pixel = crowd(triangles, 8, pixels, AT_PIXEL);
    }
    affordable(settings, budget.bytes, with_mesh)
}

/// Triangles over a place, in steps, where of all `triangles` `times` as many lie in one of so many places as in the mean.
fn crowd(triangles: usize, times: usize, places: usize, step: u32) -> u32 {
    let crowd = triangles.saturating_mul(times) / places.max(1);
    (1 + crowd / step as usize).min(MOST_STEPS as usize) as u32 * step
}

/// The pair lists no longer than a binding and the budget hold: what does not fit then takes more bands. Nor those of the camera than a
/// binding holds, where [`first`] does.
pub fn within(limits: &wgpu::Limits, settings: &Settings, budget: Budget, c: Capacities) -> Capacities {
    let binding = largest_binding(limits);
    let [pixel_pairs, triangle_pairs, candidates] = longest_lists(settings, binding).map(|most| most.max(1) as usize);
    let mut within = Capacities {
        pixel_pairs: c.pixel_pairs.min(pixel_pairs),
        triangle_pairs: c.triangle_pairs.min(triangle_pairs),
        candidates: c.candidates.min(candidates),
        ..c
    };
    if settings.facets == FacetMode::All && budget.start.is_none() {
        let least = first(settings, budget);
        let most = |bytes: usize| binding as usize / bytes;
        let of_facet = size_of::<Undecided>().max(12 * settings.samples.words() as usize);
        within.facets = c.facets.min(most(of_facet)).max(least.facets);
        within.pixel_triangles = c.pixel_triangles.min(most(listed_bytes(settings))).max(least.pixel_triangles);
    }
    affordable(settings, budget.bytes, within)
}
