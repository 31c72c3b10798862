//! Welding: vertices at the same place are one vertex.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The vertices of a mesh with those at one position taken together.
pub(crate) struct Welded {
    /// For each vertex its place in the sorted list of distinct positions; [`UNUSED`] if no triangle uses it.
    pub(crate) place: Vec<u32>,
    /// The distinct positions that triangles use, along a curve on which near ones are near each other, −0 as +0.
    pub(crate) positions: Vec<[f32; 3]>,
}

/// Marks a vertex that no triangle uses.
pub(crate) const UNUSED: u32 = u32::MAX;

/// A number that orders as the `f32` total order does, with −0 equal to +0.
fn order(v: f32) -> u32 {
    // Adding +0 turns −0 into +0 and leaves every other value as it is.
    let bits = (v + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// Numbers that order points as a curve through nested cubes does that visits each eighth of one after the other (Morton 1966). Cubes of all sizes have
/// the origin as a corner, so what else there is changes no order.
struct Curve {
    half: f64,
}

impl Curve {
    /// In the cube of a power of two around the origin that holds these points.
    fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let most = points.map(|p| p.abs().max_element()).fold(f64::from(f32::MIN_POSITIVE), f64::max);
        Self { half: (most.log2().floor() + 1.0).exp2() }
    }

    fn place(&self, point: DVec3) -> [u64; 2] {
        let cells = f64::from(u32::MAX) + 1.0;
        // Numbers beyond the last cell are taken down to it.
        let cell = (point + self.half) * (cells / (2.0 * self.half));
        let axes = cell.to_array().map(|c| u64::from(c as u32));
        let interleaved = |bits: fn(u64) -> u64| {
            let [x, y, z] = axes.map(|axis| spread(bits(axis)));
            x << 2 | y << 1 | z
        };
        [interleaved(|axis| axis >> 16), interleaved(|axis| axis & 0xffff)]
    }
}

/// The lowest 16 bits, two free places before each.
fn spread(bits: u64) -> u64 {
    [(16, 0xff0000ff), (8, 0xf00f00f00f), (4, 0xc30c30c30c3), (2, 0x249249249249)]
        .into_iter()
        .fold(bits, |bits, (by, kept)| (bits | bits << by) & kept)
}

/// Takes vertices at bit-equal positions together (−0 equals +0) and sorts them, near ones near each other.
pub(crate) fn weld(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Welded {
    let mut used = vec![false; positions.len()];
    triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let at = |v: usize| Vec3::from(positions[v]).as_dvec3();
    let curve = Curve::around((0..positions.len()).filter(|&v| used[v]).map(at));
    let mut sorted: Vec<([u64; 2], [u32; 3], u32)> = (0..positions.len())
        .into_par_iter()
        .filter(|&v| used[v])
        .map(|v| (curve.place(at(v)), positions[v].map(order), v as u32))
        .collect();
    sorted.par_sort_unstable();

    let mut place = vec![UNUSED; positions.len()];
    let mut distinct: Vec<[f32; 3]> = Vec::new();
    let mut last = None;
    for (_, key, v) in sorted {
        if last != Some(key) {
            distinct.push(positions[v as usize].map(|c| c + 0.0));
            last = Some(key);
        }
        place[v as usize] = distinct.len() as u32 - 1;
    }
    Welded { place, positions: distinct }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bits in [0, 1, 0x8000, 0xffff, 0x1234, 0xaaaa] {
            let want = (0..16).map(|k| (bits >> k & 1) << (3 * k)).sum::<u64>();
            assert_eq!(spread(bits), want, "{bits:x}");
        }
    }

    #[test]
    fn what_else_there_is_changes_no_order() {
        let of = |k: u32| [0, 1, 2].map(|axis| (k * [7919, 104_729, 611_953][axis] % 4001) as f32 / 2000.0 - 1.0);
        let positions: Vec<[f32; 3]> = (0..600).map(of).collect();
        let triangles: Vec<[u32; 3]> = (0..200).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let alone = weld(&positions, &triangles);
        let (mut more, mut others) = (positions.clone(), triangles.clone());
        more.extend([[900.0, 1.0, 0.5], [-3.0, 7000.0, 2.0], [0.1, 0.2, 0.3]]);
        others.push([600, 601, 602]);
        let kept: Vec<[f32; 3]> =
            weld(&more, &others).positions.into_iter().filter(|p| positions.contains(p)).collect();
        assert_eq!(kept, alone.positions);
        // Twice as large it is the same order.
        let twice: Vec<[f32; 3]> = positions.iter().map(|p| p.map(|c| 2.0 * c)).collect();
        assert_eq!(weld(&twice, &triangles).place, alone.place);
        let steps = |list: &[[f32; 3]]| -> f64 {
            list.windows(2).map(|two| (Vec3::from(two[1]) - Vec3::from(two[0])).as_dvec3().length()).sum()
        };
        let mut by_axis = alone.positions.clone();
        by_axis.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert!(steps(&alone.positions) < 0.5 * steps(&by_axis), "near ones are near each other");
    }
}
