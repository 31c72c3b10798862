//! Which triangles of a facet's texels may cast on it or cut it.

use super::facet_classify::FacetAtPixel;
use super::front_layer::Margin;
use super::triangle_setup::{Reach, Triangle};
use rayon::prelude::*;

/// For each facet the triangles (rising, each once) that share a texel with it, touch the box of its outline and have a
/// corner over its plane, but for rounding of `margin`. The facet's own triangle is none of them.
pub fn candidates(
    facets: &[FacetAtPixel],
    triangles: &[Triangle],
    pixel_pairs: &[Vec<u32>],
    triangle_pairs: &[Vec<u32>],
    margin: Margin,
) -> Vec<Vec<u32>> {
    let mut texels: Vec<Vec<u32>> = vec![Vec::new(); facets.len()];
    for (texel, list) in pixel_pairs.iter().enumerate() {
        list.iter().for_each(|&f| texels[f as usize].push(texel as u32));
    }
    let of = |(f, texels): (usize, &Vec<u32>)| {
        let mut all: Vec<u32> = texels.iter().flat_map(|&t| &triangle_pairs[t as usize]).copied().collect();
        all.sort_unstable();
        all.dedup();
        all.retain(|&t| Some(t) != facets[f].triangle && matters(&facets[f], &triangles[t as usize], margin));
        all
    };
    texels.par_iter().enumerate().map(of).collect()
}

/// Whether a triangle may cast on a facet or cut it.
pub fn matters(facet: &FacetAtPixel, triangle: &Triangle, margin: Margin) -> bool {
    let Some(corners) = triangle.corners else { return false };
    let normal = facet.plane.truncate();
    let over = corners.map(|p| normal.dot(p) - facet.plane.w);
    let noise = corners.map(|p| margin.depth * normal.length() * (p.length() + 1.0));
    if over.iter().zip(noise).all(|(&o, n)| o < -n) {
        return false;
    }
    match triangle.map {
        Reach::Nowhere => false,
        Reach::Everywhere | Reach::Cut(_) => true,
        Reach::Flat(flat) => {
            let (low, high) = facet.outline.bounds(1.0);
            let (lo, hi) = flat.bounds();
            let apart = lo.cmpgt(high + margin.texels).any() || hi.cmplt(low - margin.texels).any();
            !apart && (!facet.outline.in_front || flat.depths().0 <= facet.outline.farthest + margin.depth)
        }
    }
}
