//! Boxes around clusters, made once for a mesh that stands.

use super::{CLUSTER, ClusterBox};
use crate::scene::{Edge, Mesh};
use rayon::prelude::*;

impl ClusterBox {
    const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    fn with(self, other: Self) -> Self {
        let each = |of: fn(f32, f32) -> f32, a: [f32; 4], b: [f32; 4]| std::array::from_fn(|k| of(a[k], b[k]));
        Self { low: each(f32::min, self.low, other.low), high: each(f32::max, self.high, other.high) }
    }

    fn around(points: impl Iterator<Item = [f32; 3]>) -> Self {
        points.map(|[x, y, z]| [x, y, z, 0.0]).fold(Self::EMPTY, |all, p| all.with(Self { low: p, high: p }))
    }
}

/// The boxes of all clusters of a mesh: those of triangles, then of edges, then of vertices, which hold those of all clusters that use one.
///
/// # Panics
/// If an index is out of range ([`Mesh::check`]).
pub fn cluster_boxes(mesh: &Mesh, edges: &[Edge]) -> Vec<ClusterBox> {
    let at = |&v: &u32| mesh.positions[v as usize];
    let of_triangles = mesh.triangles.par_chunks(CLUSTER).map(|part| ClusterBox::around(part.iter().flatten().map(at)));
    let of_edges = edges.par_chunks(CLUSTER).map(|part| {
        // One that holds no edge is not looked up.
        let ends = part.iter().filter(|e| e.v0 != e.v1).flat_map(|e| [e.v0, e.v1]);
        ClusterBox::around(ends.map(|v| at(&v)))
    });
    let mut boxes: Vec<ClusterBox> = of_triangles.chain(of_edges).collect();
    let first_edges = mesh.triangles.len().div_ceil(CLUSTER);
    let mut of_vertices = vec![ClusterBox::EMPTY; mesh.positions.len().div_ceil(CLUSTER)];
    let mut uses = |v: u32, cluster: usize| {
        let of = &mut of_vertices[v as usize / CLUSTER];
        *of = of.with(boxes[cluster]);
    };
    for (t, corners) in mesh.triangles.iter().enumerate() {
        corners.iter().for_each(|&v| uses(v, t / CLUSTER));
    }
    for (k, edge) in edges.iter().enumerate().filter(|(_, e)| e.v0 != e.v1) {
        [edge.v0, edge.v1].into_iter().for_each(|v| uses(v, first_edges + k / CLUSTER));
    }
    boxes.append(&mut of_vertices);
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::Prepared;
    use crate::test_scenes::builtin;

    #[test]
    fn boxes_are_the_least_that_hold_their_elements() {
        let prepared = Prepared::new(&builtin("knot").mesh).unwrap();
        let (mesh, edges) = (prepared.mesh(), &prepared.edges);
        let boxes = cluster_boxes(mesh, edges);
        let counts = [mesh.triangles.len(), edges.len(), mesh.positions.len()].map(|n| n.div_ceil(CLUSTER));
        assert_eq!(boxes.len(), counts.iter().sum::<usize>());
        let around = |vertices: &[u32]| ClusterBox::around(vertices.iter().map(|&v| mesh.positions[v as usize]));
        let (of_triangles, rest) = boxes.split_at(counts[0]);
        let (of_edges, of_vertices) = rest.split_at(counts[1]);
        for (of, triangles) in of_triangles.iter().zip(mesh.triangles.chunks(CLUSTER)) {
            assert_eq!(*of, around(triangles.as_flattened()));
        }
        for (of, edges) in of_edges.iter().zip(edges.chunks(CLUSTER)) {
            assert_eq!(*of, around(&edges.iter().flat_map(|e| [e.v0, e.v1]).collect::<Vec<_>>()));
        }
        for (c, of) in of_vertices.iter().enumerate() {
            let uses = |v: &u32| *v as usize / CLUSTER == c;
            let by_triangles = (0..mesh.triangles.len()).filter(|&t| mesh.triangles[t].iter().any(uses));
            let by_edges = (0..edges.len()).filter(|&k| uses(&edges[k].v0) || uses(&edges[k].v1));
            let users = by_triangles.map(|t| of_triangles[t / CLUSTER]).chain(by_edges.map(|k| of_edges[k / CLUSTER]));
            assert_eq!(*of, users.fold(ClusterBox::EMPTY, ClusterBox::with), "vertices {c}");
        }
        // Elements with numbers in a row lie near each other.
        let extent = |of: &ClusterBox| (0..3).map(|k| of.high[k] - of.low[k]).fold(0.0, f32::max);
        let whole = extent(&boxes.iter().copied().fold(ClusterBox::EMPTY, ClusterBox::with));
        let small = boxes.iter().filter(|of| extent(of) < 0.25 * whole).count();
        assert!(small * 10 > 9 * boxes.len(), "{small} of {}", boxes.len());
    }
}
