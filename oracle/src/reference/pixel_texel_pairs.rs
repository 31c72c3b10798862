//! Which undecided facets touch which texel.

use super::facet_classify::{FacetAtPixel, FacetState, Outline, bounds};
use super::front_layer::{Margin, Split};
use super::view::{MapEnds, centre};
use glam::DVec2;
use rayon::prelude::*;

/// The facets (by their place in the list, rising) that touch each texel of a map. A texel without
/// casters has none; with `skip_front` nor has one whose split depth lies behind the facet by more than the margin. A facet that goes on beyond
/// one of the ends of the map is in every texel there that it touches.
pub fn pairs(
    facets: &[FacetAtPixel],
    splits: &[Split],
    map: MapEnds,
    margin: Margin,
    skip_front: bool,
) -> Vec<Vec<u32>> {
    let pairs = facets.par_iter().enumerate().flat_map_iter(|(f, facet)| {
        let rect = facet.rect.filter(|_| facet.state == FacetState::Undecided).unwrap_or([1, 1, 0, 0]);
        let [x0, y0, x1, y1] = rect;
        let beyond = facet.outline.goes_beyond(map, margin.texels);
        let texels = (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| (x, y)));
        texels.filter_map(move |(x, y)| {
            let texel = y * map.size + x;
            let listed = match splits[texel as usize] {
                Split::Uncovered => false,
                Split::Marked => true,
                Split::At(split) => !skip_front || facet.outline.farthest + margin.depth >= split,
            };
            let listed = listed || (beyond && map.are_at(x, y, map.size));
            let listed = listed && touches(&facet.outline, centre(x, y), 0.5 + margin.texels);
            listed.then_some((texel, f as u32))
        })
    });
    let listed: Vec<(u32, u32)> = pairs.collect();
    let mut texels = vec![Vec::new(); splits.len()];
    listed.into_iter().for_each(|(texel, f)| texels[texel as usize].push(f));
    texels
}

/// The farthest depth of the facets of each texel; `None` where there are none.
pub fn deepest(facets: &[FacetAtPixel], pairs: &[Vec<u32>]) -> Vec<Option<f64>> {
    let depth = |&f: &u32| {
        let outline = &facets[f as usize].outline;
        if outline.in_front { outline.farthest.max(0.0) } else { f64::INFINITY }
    };
    pairs.iter().map(|list| list.iter().map(depth).reduce(f64::max)).collect()
}

/// Whether the outline touches the closed square of half side `reach`: no axis across a side of either parts them.
pub fn touches(outline: &Outline, at: DVec2, reach: f64) -> bool {
    let corners = &outline.corners;
    if corners.len() < 3 || !outline.in_front {
        return true;
    }
    let (low, high) = bounds(corners);
    let (mut left, mut right) = (true, true);
    for (k, &a) in corners.iter().enumerate() {
        let d = corners[(k + 1) % corners.len()] - a;
        let e = d.perp_dot(at - a);
        let slack = reach * (d.x.abs() + d.y.abs());
        left &= e >= -slack;
        right &= e <= slack;
    }
    (left || right) && at.cmpge(low - reach).all() && at.cmple(high + reach).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diamond_touches_what_its_box_does_not_tell() {
        let corners = [[2.0, 0.0], [4.0, 2.0], [2.0, 4.0], [0.0, 2.0]].map(|[x, y]| DVec2::new(x, y)).to_vec();
        let outline =
            Outline { corners, farthest: 1.0, in_front: true, known: true, whole: true, ..Outline::default() };
        let touched = |x, y, reach| touches(&outline, centre(x, y), reach);
        assert!(touched(1, 1, 0.5) && touched(2, 2, 0.5) && touched(0, 1, 0.5));
        assert!(touched(0, 0, 0.5), "its corner lies on the diamond's side");
        assert!(!touched(0, 0, 0.49), "shrunk it does not");
        assert!(!touched(4, 4, 0.5));
    }
}
