//! Definition of taking positions from an application's vertices.

use super::instance_positions::mapped;
use subpixel_shadows::scene::Homography;

/// Place of a vertex that no triangle uses.
pub const NO_PLACE: u32 = u32::MAX;

/// Positions that were taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// A position a place; 0 where no vertex has that place.
    pub positions: Vec<[f32; 3]>,
    /// Places outside the box, or without a number.
    pub outside: u32,
    /// Vertices that are not where the vertex of their place is.
    pub parted: u32,
}

/// Takes `count` places from `vertices`. `places` says of each vertex its place, and the vertex which that place takes its
/// position from; positions are mapped, and end up in the box from `low` to `high`.
pub fn gather(
    vertices: &[[f32; 3]],
    places: &[[u32; 2]],
    count: usize,
    ([low, high], homography): ([[f32; 3]; 2], &Homography),
) -> Gathered {
    let bits = |v: usize| vertices[v].map(|c| if c == 0.0 { 0 } else { c.to_bits() });
    let mut out = Gathered { positions: vec![[0.0; 3]; count], ..Gathered::default() };
    for (v, &[place, source]) in places.iter().enumerate().filter(|(_, p)| p[0] != NO_PLACE) {
        out.parted += u32::from(bits(v) != bits(source as usize));
        if source as usize == v {
            let given = mapped(homography, bits(v).map(|b| f64::from(f32::from_bits(b)))).map(|c| c as f32);
            let inside = |k: usize| if given[k].is_finite() { given[k].clamp(low[k], high[k]) } else { low[k] };
            let kept = [0, 1, 2].map(inside);
            out.outside += u32::from(kept != given);
            out.positions[place as usize] = kept;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_checks_and_keeps_in_the_box() {
        let vertices = [[1.0, 2.0, 3.0], [-0.0, 0.0, 9.0], [1.0, 2.0, 3.5], [f32::NAN, 1.0, 1.0], [7.0; 3]];
        let places = [[1, 0], [0, 1], [1, 0], [2, 3], [NO_PLACE, 0]];
        let got = gather(&vertices, &places, 3, ([[-1.0; 3], [5.0; 3]], &Homography::default()));
        assert_eq!(got.positions, [[0.0, 0.0, 5.0], [1.0, 2.0, 3.0], [-1.0, 1.0, 1.0]]);
        assert_eq!((got.outside, got.parted), (2, 1));
    }
}
