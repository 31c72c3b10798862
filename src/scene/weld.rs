//! Welding: vertices at the same place are one vertex.

use rayon::prelude::*;

/// The vertices of a mesh with those at one position taken together.
pub(crate) struct Welded {
    /// For each vertex its place in the sorted list of distinct positions; [`UNUSED`] if no triangle uses it.
    pub(crate) place: Vec<u32>,
    /// The distinct positions that triangles use, in ascending order, −0 as +0.
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

/// Takes vertices at bit-equal positions together (−0 equals +0) and sorts them.
pub(crate) fn weld(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Welded {
    let mut used = vec![false; positions.len()];
    triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut sorted: Vec<([u32; 3], u32)> = (0..positions.len())
        .into_par_iter()
        .filter(|&v| used[v])
        .map(|v| (positions[v].map(order), v as u32))
        .collect();
    sorted.par_sort_unstable();

    let mut place = vec![UNUSED; positions.len()];
    let mut distinct: Vec<[f32; 3]> = Vec::new();
    let mut last = None;
    for (key, v) in sorted {
        if last != Some(key) {
            distinct.push(positions[v as usize].map(|c| c + 0.0));
            last = Some(key);
        }
        place[v as usize] = distinct.len() as u32 - 1;
    }
    Welded { place, positions: distinct }
}
