//! The nearest caster at every texel centre of a map that a slice of the view has, found in the whole light view.

use super::triangle_setup::Triangle;
use super::view::{Flat, centre};
use crate::light_view::SplitView;
use glam::DVec2;
use rayon::prelude::*;

/// Between what depths the nearest caster at a texel lies; `None` for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Depths {
    /// The least that a place near the texel's centre has.
    pub least: Option<f64>,
    /// The nearest of the casters that hold all places near it, where those are farthest.
    pub greatest: Option<f64>,
}

/// Depths at each of `size` × `size` texels, row by row, where a place may be `reach` texels off and a depth `margin`. With neither
/// off, the two are equal: the depth at the centre. Of a place that may lie beyond the horizon of the map nothing is told. Triangles that are not in front of the light cast nothing.
pub fn depths(triangles: &[Triangle], split: &SplitView, size: u32, reach: f64, margin: f64) -> Vec<Depths> {
    let figures: Vec<Flat> = triangles.iter().filter_map(Triangle::flat).collect();
    let back = split.warp.inverse();
    let whole = |p: DVec2| {
        let q = back * p.extend(1.0);
        q.truncate() / q.z
    };
    let texel = |k: u32| {
        let at = centre(k % size, k / size);
        let place = whole(at);
        if [-reach, reach].iter().any(|&r| (back * (at + r).extend(1.0)).z <= 0.0) {
            return Depths { least: Some(f64::NEG_INFINITY), greatest: None };
        }
        let off = [[-reach, -reach], [reach, -reach], [-reach, reach], [reach, reach]];
        let off = off.map(|o| (whole(at + DVec2::from(o)) - place).abs().max_element());
        let off = off.into_iter().fold(0.0, f64::max);
        let mut found = Depths::default();
        for flat in &figures {
            let (lo, hi) = flat.bounds();
            if (lo - off).cmpgt(place).any() || (hi + off).cmplt(place).any() || !flat.touches(place, off) {
                continue;
            }
            let (least, greatest) = flat.depth_range(place, off, margin);
            found.least = Some(found.least.map_or(least, |d: f64| d.min(least)));
            if flat.slope.is_some() && flat.inside(place).iter().all(|&e| e >= off) {
                found.greatest = Some(found.greatest.map_or(greatest, |d: f64| d.min(greatest)));
            }
        }
        found
    };
    (0..size * size).into_par_iter().map(texel).collect()
}
