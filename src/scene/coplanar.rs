//! Which neighbouring triangles lie in one plane, exactly.

use super::mesh::Mesh;
use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Triangles at one edge that are compared with each other; of more, only those next to each other in order.
const COMPARED: usize = 8;

/// Triangles joined to surfaces while the edges of their mesh go by.
pub(super) struct Joining<'a> {
    mesh: &'a Mesh,
    parent: Vec<u32>,
}

impl<'a> Joining<'a> {
    /// Every triangle is a surface of its own.
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, parent: (0..mesh.triangles.len() as u32).collect() }
    }

    /// Joins those of the triangles at one edge that lie in one plane.
    pub(super) fn meet(&mut self, at_edge: impl Iterator<Item = u32> + Clone) {
        for (k, t) in at_edge.clone().enumerate().skip(1) {
            for other in at_edge.clone().take(k).skip(k.saturating_sub(COMPARED)) {
                let (a, b) = (root(&mut self.parent, other), root(&mut self.parent, t));
                if a != b && in_one_plane(self.mesh.corners(other as usize), self.mesh.corners(t as usize)) {
                    // The lower index is the root, so the roots do not depend on the order of the edges.
                    self.parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
    }

    /// Lowest triangle of each triangle's surface.
    pub(super) fn surfaces(mut self) -> Vec<u32> {
        (0..self.parent.len() as u32).map(|t| root(&mut self.parent, t)).collect()
    }
}

/// The root of `t`, halving the path to it.
pub(super) fn root(parent: &mut [u32], mut t: u32) -> u32 {
    while parent[t as usize] != t {
        parent[t as usize] = parent[parent[t as usize] as usize];
        t = parent[t as usize];
    }
    t
}

/// Whether both triangles have an area and all six corners lie in one plane: decided without rounding.
fn in_one_plane(first: [DVec3; 3], second: [DVec3; 3]) -> bool {
    let [a, b, c] = first.map(coord);
    let flat = second.iter().filter(|p| !first.contains(p)).all(|&p| orient3d(a, b, c, coord(p)) == 0.0);
    flat && has_area(first) && has_area(second)
}

/// Whether the corners do not lie on one line. Exact.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let spans = |x: usize, y: usize| {
        let [a, b, c] = [a, b, c].map(|p| Coord { x: p[x], y: p[y] });
        orient2d(a, b, c) != 0.0
    };
    spans(0, 1) || spans(1, 2) || spans(2, 0)
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

#[cfg(test)]
mod tests {
    use crate::scene::{Adjacency, Mesh};

    /// Surfaces of triangles between corners.
    fn surfaces(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<u32> {
        Adjacency::of(&Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() }).surfaces
    }

    #[test]
    fn faces_of_a_box_are_surfaces() {
        let positions: Vec<[f32; 3]> = (0..8u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f32::from)).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<_> =
            quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        assert_eq!(surfaces(&positions, &triangles), [0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10]);
        // Sheared, without rounding, its faces are parallelograms, and none is upright.
        let sheared: Vec<_> =
            positions.iter().map(|p| [p[0] + 0.25 * p[2], p[1] + 0.25 * p[0], p[2] + 0.5 * p[1]]).collect();
        assert_eq!(surfaces(&sheared, &triangles), [0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10]);
    }

    #[test]
    fn one_bit_off_the_plane_is_another_surface() {
        let mut positions = vec![[0.0, 0.0, 0.25], [1.0, 0.0, 0.25], [1.0, 1.0, 0.25], [0.0, 1.0, 0.25]];
        let triangles = [[0, 1, 2], [0, 2, 3]];
        assert_eq!(surfaces(&positions, &triangles), [0, 0]);
        positions[3][2] = f32::from_bits(positions[3][2].to_bits() + 1);
        assert_eq!(surfaces(&positions, &triangles), [0, 1]);
    }

    #[test]
    fn a_plane_without_common_edges_is_several_surfaces() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]];
        assert_eq!(surfaces(&positions, &[[0, 1, 2], [3, 4, 5]]), [0, 1]);
        // Nor does a corner join them.
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        assert_eq!(surfaces(&positions, &[[0, 1, 2], [0, 3, 4]]), [0, 1]);
    }

    #[test]
    fn triangles_without_area_join_nothing() {
        // A roof with a triangle of three corners on the ridge's line between its two sides.
        let positions = [[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
        assert_eq!(surfaces(&positions, &[[0, 1, 3], [0, 1, 2], [1, 0, 4], [1, 2, 4]]), [0, 1, 2, 2]);
    }

    #[test]
    fn doubled_and_folded_triangles_are_one_surface() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(surfaces(&positions, &[[0, 1, 2], [0, 1, 2], [1, 2, 3], [2, 1, 3]]), [0, 0, 0, 0]);
        assert_eq!(surfaces(&positions, &[[0, 1, 2], [0, 1, 3]]), [0, 0], "both on one side of the edge");
    }

    #[test]
    fn many_triangles_at_one_edge_are_compared_with_their_neighbours() {
        // Spokes around one edge, each in a plane of its own but the last, which goes on in that of the one before.
        let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
        positions.extend((0..40u8).map(|k| [f32::from(k) - 20.0, 1.0, 0.0]));
        positions.push([38.0, 2.0, 0.0]);
        let triangles: Vec<_> = (0..41).map(|k| [0, 1, k + 2]).collect();
        let wanted: Vec<u32> = (0..41).map(|t| if t == 40 { 39 } else { t }).collect();
        assert_eq!(surfaces(&positions, &triangles), wanted);
    }
}
