//! Triangle meshes.

use super::weld::weld;
use crate::{Error, Result};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Largest coordinate of a mesh: beyond it, squares and the ground under the mesh leave the range of `f32`.
pub const MAX_EXTENT: f64 = 1e18;

/// A triangle soup with shared vertices. Surfaces are two-sided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, world units.
    pub positions: Vec<[f32; 3]>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside where the mesh has an outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A horizontal ground square under a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Ground {
    /// Height: the lowest vertex of the scene.
    pub y: f32,
    /// Half the side of the square: 10 scene radii.
    pub half_width: f32,
    /// Its centre, `[x, z]`.
    pub center: [f32; 2],
}

impl Mesh {
    /// The largest number of triangles a mesh may have.
    pub const MAX_TRIANGLES: usize = 1 << 27;

    /// Checks vertices and indices.
    ///
    /// # Errors
    /// [`Error::Mesh`] naming the first vertex that is not finite, the first index out of range, or the number of
    /// triangles if it is above [`Mesh::MAX_TRIANGLES`].
    pub fn check(&self, name: &str) -> Result<()> {
        if self.triangles.len() > Self::MAX_TRIANGLES {
            return Err(Error::mesh(
                name,
                format!("{} triangles, at most {} may be used", self.triangles.len(), Self::MAX_TRIANGLES),
            ));
        }
        for (i, p) in self.positions.iter().enumerate() {
            if !p.iter().all(|c| c.is_finite()) {
                return Err(Error::mesh(name, format!("vertex {i} ({}, {}, {}) is not finite", p[0], p[1], p[2])));
            }
        }
        let n = self.positions.len();
        for (t, tri) in self.triangles.iter().enumerate() {
            if let Some(v) = tri.iter().find(|&&v| v as usize >= n) {
                return Err(Error::mesh(name, format!("triangle {t} uses vertex {v}, the mesh has {n}")));
            }
        }
        Ok(())
    }

    /// The same surface in four times as many triangles: each split at the middles of its edges. Middles are rounded to
    /// `f32`, the same for both triangles at an edge, so what is closed stays closed.
    ///
    /// # Panics
    /// If an index is out of range ([`Mesh::check`]).
    pub fn split_in_four(&self) -> Self {
        let mut positions = self.positions.clone();
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let [p, q] = [a.min(b), a.max(b)].map(|v| Vec3::from_array(self.positions[v as usize]));
                positions.push((p * 0.5 + q * 0.5).to_array());
                positions.len() as u32 - 1
            })
        };
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self { positions, triangles }
    }

    /// Lowest and highest corner of the vertices that triangles use; `None` without any. Indices out of range ([`Mesh::check`])
    /// are left out.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut vertices = self
            .triangles
            .iter()
            .flatten()
            .filter_map(|&v| self.positions.get(v as usize))
            .map(|&p| Vec3::from(p).as_dvec3());
        let first = vertices.next()?;
        Some(vertices.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }

    /// The three corners of triangle `t`, in `f64`.
    ///
    /// # Panics
    /// If there is no such triangle, or an index of it is out of range ([`Mesh::check`]).
    #[inline]
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| Vec3::from(self.positions[v as usize]).as_dvec3())
    }

    /// The same surface in one canonical form, and for each of its triangles the triangle of this mesh it was.
    ///
    /// The form does not depend on the order of the triangles, on which corner each starts with, or on the numbering
    /// of the vertices: vertices are welded by position (−0 becomes +0), those that no triangle uses are dropped, and
    /// the rest are sorted along a curve that visits each eighth of their cube after the other (Morton 1966), so that near
    /// ones have near numbers; each triangle starts with its smallest vertex, winding kept; triangles are sorted. Exact
    /// duplicates are kept, and among them the earlier comes first.
    ///
    /// # Panics
    /// If an index is out of range ([`Mesh::check`]).
    pub fn canonical(&self) -> (Self, Vec<u32>) {
        let welded = weld(&self.positions, &self.triangles);
        let mut order: Vec<([u32; 3], u32)> = self
            .triangles
            .par_iter()
            .enumerate()
            .map(|(t, tri)| {
                let [a, b, c] = tri.map(|v| welded.place[v as usize]);
                ([a, b, c].min([b, c, a]).min([c, a, b]), t as u32)
            })
            .collect();
        order.par_sort_unstable();
        let (triangles, from) = order.into_iter().unzip();
        (Self { positions: welded.positions, triangles }, from)
    }

    /// The ground that fits under this mesh: at the lowest vertex, centred, 10 scene radii half-width.
    pub fn ground_below(&self) -> Option<Ground> {
        let (lo, hi) = self.bounds()?;
        let radius = (hi - lo).length() * 0.5;
        let centre = (lo + hi) * 0.5;
        Some(Ground { y: lo.y as f32, half_width: (10.0 * radius) as f32, center: [centre.x as f32, centre.z as f32] })
    }

    /// Appends the two triangles of `ground`, facing up.
    pub fn add_ground(&mut self, ground: &Ground) {
        let base = self.positions.len() as u32;
        let ([cx, cz], h, y) = (ground.center, ground.half_width, ground.y);
        self.positions.extend([[cx - h, y, cz - h], [cx + h, y, cz - h], [cx + h, y, cz + h], [cx - h, y, cz + h]]);
        self.triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> Mesh {
        let positions =
            (0..64u16).map(|i| [f32::from(i % 8) - 3.0, f32::from(i * 37 % 11), f32::from(i / 8)]).collect();
        let mut triangles: Vec<[u32; 3]> =
            (0..56u32).filter(|i| i % 8 != 7).flat_map(|i| [[i, i + 1, i + 9], [i, i + 9, i + 8]]).collect();
        // Exact duplicates and a collapsed triangle belong to it.
        triangles.extend([triangles[5], triangles[5], [9, 9, 4]]);
        Mesh { positions, triangles }
    }

    fn next(state: &mut u64) -> usize {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as usize
    }

    /// The same surface with triangles shuffled and rotated, vertices renumbered, some doubled, zeros negated.
    fn disguised(mesh: &Mesh, seed: u64) -> Mesh {
        let mut state = seed;
        let n = mesh.positions.len();
        let mut number: Vec<usize> = (0..2 * n).collect();
        (1..2 * n).rev().for_each(|i| number.swap(i, next(&mut state) % (i + 1)));
        let mut positions = vec![[f32::MAX; 3]; 2 * n];
        for (i, &to) in number.iter().enumerate() {
            let sign = next(&mut state) & 1 == 1;
            positions[to] = mesh.positions[i % n].map(|c| if c == 0.0 && sign { -0.0 } else { c });
        }
        let mut triangles = mesh.triangles.clone();
        (1..triangles.len()).rev().for_each(|i| triangles.swap(i, next(&mut state) % (i + 1)));
        for tri in &mut triangles {
            tri.rotate_left(next(&mut state) % 3);
            *tri = tri.map(|v| number[v as usize + n * (next(&mut state) & 1)] as u32);
        }
        Mesh { positions, triangles }
    }

    fn bits(mesh: &Mesh) -> (Vec<[u32; 3]>, &[[u32; 3]]) {
        (mesh.positions.iter().map(|p| p.map(f32::to_bits)).collect(), &mesh.triangles)
    }

    #[test]
    fn bounds_are_of_the_vertices_there_are() {
        let mesh = Mesh { positions: vec![[1.0, 2.0, 3.0], [5.0, 0.0, 3.0]], triangles: vec![[0, 1, 9]] };
        assert_eq!(mesh.bounds(), Some((DVec3::new(1.0, 0.0, 3.0), DVec3::new(5.0, 2.0, 3.0))));
        let nowhere = Mesh { positions: Vec::new(), triangles: vec![[7, 8, 9]] };
        assert!(nowhere.bounds().is_none() && nowhere.ground_below().is_none());
    }

    #[test]
    fn splitting_keeps_the_surface_closed_and_its_area() {
        let area = |m: &Mesh| -> f64 {
            let of = |t| {
                let [a, b, c] = m.corners(t);
                (b - a).cross(c - a).length() / 2.0
            };
            (0..m.triangles.len()).map(of).sum()
        };
        let body = crate::test_scenes::builtin("spheres").mesh;
        let split = body.split_in_four();
        assert_eq!(split.triangles.len(), 4 * body.triangles.len());
        assert!((area(&split) / area(&body) - 1.0).abs() < 1e-5);
        let edges = |m: &Mesh| {
            let all = m.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            all.map(|[a, b]| [a.min(b), a.max(b)]).collect::<std::collections::BTreeSet<_>>().len()
        };
        assert_eq!(split.positions.len(), body.positions.len() + edges(&body), "a middle for each edge");
        let moved = Mesh { positions: split.positions.iter().map(|p| p.map(|c| c * 1.1)).collect(), ..split.clone() };
        assert!((area(&moved) / area(&body) - 1.0).abs() > 1e-5);
    }

    #[test]
    fn the_canonical_form_does_not_depend_on_order_rotation_or_numbering() {
        let mesh = sheet();
        let (canonical, from) = mesh.canonical();
        for (t, &was) in from.iter().enumerate() {
            let mut corners = mesh.corners(was as usize);
            assert!((0..3).any(|_| {
                corners.rotate_left(1);
                corners == canonical.corners(t)
            }));
        }
        for seed in 1..50 {
            let (other, from) = disguised(&mesh, seed).canonical();
            assert_eq!(bits(&canonical), bits(&other), "seed {seed}");
            let mut seen = from.clone();
            seen.sort_unstable();
            assert!(seen.iter().copied().eq(0..mesh.triangles.len() as u32));
        }
        assert_eq!(bits(&canonical.canonical().0), bits(&canonical));
    }

    #[test]
    fn the_canonical_form_shows_every_change() {
        let mesh = sheet();
        let canonical = mesh.canonical().0;
        let mut moved = mesh.clone();
        moved.positions[20][1] = moved.positions[20][1].next_up();
        assert_ne!(canonical, moved.canonical().0);
        let mut flipped = mesh.clone();
        flipped.triangles[7].reverse();
        assert_ne!(canonical, flipped.canonical().0);
        let mut fewer = mesh.clone();
        fewer.triangles.pop();
        assert_ne!(canonical, fewer.canonical().0);
    }
}
