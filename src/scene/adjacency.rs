//! Which triangles meet at which edge, and which edges are always silhouettes.

use super::coplanar::{Joining, root};
use super::mesh::Mesh;
use super::weld::weld;
use bytemuck::{Pod, Zeroable};

/// Stands for "no second triangle" in [`Edge::t1`].
pub const NO_TRIANGLE: u32 = u32::MAX;

/// An edge of a mesh and the triangles it joins.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
pub struct Edge {
    /// Vertex the edge starts at, in the winding of `t0`: an index into [`Mesh::positions`].
    pub v0: u32,
    /// Vertex it ends at, likewise one that `t0` uses.
    pub v1: u32,
    /// The triangle of lowest index that has the edge.
    pub t0: u32,
    /// The triangle on the other side, which runs through the edge from `v1` to `v0`; or [`NO_TRIANGLE`], and then the
    /// edge counts as a silhouette from everywhere.
    pub t1: u32,
}

impl Edge {
    /// The same edge of a mesh that begins at these vertices and triangles of others.
    pub(crate) fn moved(self, vertex: u32, triangle: u32) -> Self {
        let t1 = if self.t1 == NO_TRIANGLE { NO_TRIANGLE } else { self.t1 + triangle };
        Self { v0: self.v0 + vertex, v1: self.v1 + vertex, t0: self.t0 + triangle, t1 }
    }
}

/// The edges of a mesh.
///
/// Vertices are welded by position (−0 equals +0), so a seam of doubled vertices is no boundary. A triangle that uses
/// one position twice is a line: it is left out, which changes neither the surface nor its shadow. Thin triangles of
/// three distinct positions take part, whatever their area.
#[derive(Clone, Debug, Default)]
pub struct Adjacency {
    /// Each edge once, in ascending order of its lower and then its higher end.
    pub edges: Vec<Edge>,
    /// Whether the mesh bounds solid bodies: it has triangles, every edge joins exactly two that wind consistently,
    /// and every connected part has a positive volume, so faces look outward.
    pub closed: bool,
    /// Whether the edge-connected part of the mesh around each triangle bounds a solid body, seen from outside: every edge of the part
    /// joins exactly two triangles that wind consistently, and its volume is positive. Collapsed
    /// triangles, which are no surface, count as such.
    pub bodies: Vec<bool>,
    /// Number of edges with one triangle.
    pub boundary: u32,
    /// Number of edges with more than two triangles.
    pub non_manifold: u32,
    /// Number of edges whose two triangles run through them in the same direction.
    pub inconsistent: u32,
    /// Number of triangles left out because two of their corners coincide.
    pub collapsed: u32,
    /// Lowest triangle of each triangle's surface: the edge-connected ones that lie in one plane, exactly.
    pub surfaces: Vec<u32>,
}

/// One side of one triangle, in the bucket of the edge's lower end.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The edge's higher end.
    high: u32,
    /// `(triangle * 3 + corner) * 2`, plus 1 if the side runs from the higher to the lower end. Fits for
    /// [`Mesh::MAX_TRIANGLES`].
    code: u32,
}

impl Side {
    fn triangle(self) -> u32 {
        self.code / 6
    }
    fn corner(self) -> usize {
        (self.code / 2 % 3) as usize
    }
    fn runs_down(self) -> bool {
        self.code & 1 == 1
    }
}

impl Adjacency {
    /// The edges of `mesh`. Takes time linear in the number of triangles.
    ///
    /// # Panics
    /// If an index is out of range ([`Mesh::check`]).
    pub fn of(mesh: &Mesh) -> Self {
        Self::but_for(mesh, &[])
    }

    /// As [`Adjacency::of`], where some triangles, which are told by their numbers, hang together with nothing and have no edges.
    ///
    /// # Panics
    /// If a number or an index is out of range.
    pub fn but_for(mesh: &Mesh, alone: &[u32]) -> Self {
        let welded = weld(&mesh.positions, &mesh.triangles);
        let mut adjacency = Self::default();
        let mut left_out = vec![false; mesh.triangles.len()];
        alone.iter().for_each(|&t| left_out[t as usize] = true);
        let (starts, mut sides) =
            sides(mesh, &welded.place, welded.positions.len(), &left_out, &mut adjacency.collapsed);
        adjacency.edges.reserve_exact(sides.len() / 2);
        let mut joining = Joining::new(mesh);
        let mut torn = left_out.clone();
        for bucket in starts.windows(2) {
            let bucket = &mut sides[bucket[0] as usize..bucket[1] as usize];
            bucket.sort_unstable();
            for group in bucket.chunk_by(|a, b| a.high == b.high) {
                if adjacency.push(mesh, group) == NO_TRIANGLE {
                    group.iter().for_each(|side| torn[side.triangle() as usize] = true);
                }
                joining.meet(group.iter().map(|side| side.triangle()));
            }
        }
        adjacency.surfaces = joining.surfaces();
        adjacency.bodies = bodies(mesh, &adjacency.edges, &torn);
        for ((body, corners), alone) in adjacency.bodies.iter_mut().zip(&mesh.triangles).zip(&left_out) {
            *body |= is_line(corners.map(|v| welded.place[v as usize])) && !alone;
        }
        adjacency.closed = !adjacency.edges.is_empty() && adjacency.bodies.iter().all(|body| *body);
        adjacency
    }

    /// Number of edges that count as silhouettes from everywhere.
    pub fn silhouettes_from_everywhere(&self) -> u32 {
        self.boundary + self.non_manifold + self.inconsistent
    }

    /// Adds the edge of a group of sides, and returns its second triangle.
    fn push(&mut self, mesh: &Mesh, group: &[Side]) -> u32 {
        let first = group[0];
        let t1 = match group {
            [_] => {
                self.boundary += 1;
                NO_TRIANGLE
            }
            [a, b] if a.runs_down() != b.runs_down() => b.triangle(),
            [_, _] => {
                self.inconsistent += 1;
                NO_TRIANGLE
            }
            _ => {
                self.non_manifold += 1;
                NO_TRIANGLE
            }
        };
        let corners = mesh.triangles[first.triangle() as usize];
        let (v0, v1) = (corners[first.corner()], corners[(first.corner() + 1) % 3]);
        self.edges.push(Edge { v0, v1, t0: first.triangle(), t1 });
        t1
    }
}

/// Whether a triangle uses one vertex twice.
fn is_line(w: [u32; 3]) -> bool {
    w[0] == w[1] || w[1] == w[2] || w[2] == w[0]
}

/// All sides of all triangles but those that are left out, grouped by their lower end: where each group starts, and the sides.
fn sides(mesh: &Mesh, place: &[u32], places: usize, left_out: &[bool], collapsed: &mut u32) -> (Vec<u32>, Vec<Side>) {
    let welded = |tri: &[u32; 3]| tri.map(|v| place[v as usize]);
    let lows = |w: [u32; 3]| [w[0].min(w[1]), w[1].min(w[2]), w[2].min(w[0])];

    // starts[low + 2] first counts; after the scan starts[low + 1] is where the next side of `low` goes, and once all
    // are placed, where the next group starts.
    let mut starts = vec![0u32; places + 2];
    for (w, _) in mesh.triangles.iter().map(welded).zip(left_out).filter(|(_, out)| !**out) {
        if is_line(w) {
            *collapsed += 1;
        } else {
            lows(w).iter().for_each(|&low| starts[low as usize + 2] += 1);
        }
    }
    for i in 2..starts.len() {
        starts[i] += starts[i - 1];
    }
    let total = starts.last().map_or(0, |&n| n as usize);
    let mut sides = vec![Side { high: 0, code: 0 }; total];
    for (t, w) in mesh.triangles.iter().map(welded).enumerate().filter(|(t, w)| !is_line(*w) && !left_out[*t]) {
        for corner in 0..3 {
            let (from, to) = (w[corner], w[(corner + 1) % 3]);
            let next = &mut starts[from.min(to) as usize + 1];
            let code = (t as u32 * 3 + corner as u32) * 2 + u32::from(from > to);
            sides[*next as usize] = Side { high: from.max(to), code };
            *next += 1;
        }
    }
    starts.truncate(places + 1);
    (starts, sides)
}

/// Whether the edge-connected part of each triangle has no triangle that is `torn` (one of its edges does not join exactly
/// two that wind consistently), and a positive volume.
fn bodies(mesh: &Mesh, edges: &[Edge], torn: &[bool]) -> Vec<bool> {
    let mut parent: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    for edge in edges.iter().filter(|edge| edge.t1 != NO_TRIANGLE) {
        let (a, b) = (root(&mut parent, edge.t0), root(&mut parent, edge.t1));
        // The lower index is the root, so the roots do not depend on the order of the edges.
        parent[a.max(b) as usize] = a.min(b);
    }
    // Signed volume and its size without cancellation, of six times the tetrahedra from the part's first corner.
    let mut volumes = vec![[0.0f64; 2]; mesh.triangles.len()];
    let mut whole = vec![true; mesh.triangles.len()];
    for (t, torn) in torn.iter().enumerate() {
        let part = root(&mut parent, t as u32) as usize;
        let origin = mesh.corners(part)[0];
        let [a, b, c] = mesh.corners(t).map(|p| p - origin);
        let volume = a.dot(b.cross(c));
        volumes[part][0] += volume;
        volumes[part][1] += volume.abs();
        whole[part] &= !torn;
    }
    let is_body = |part: usize| whole[part] && volumes[part][0] > 1e-12 * volumes[part][1];
    (0..mesh.triangles.len()).map(|t| is_body(root(&mut parent, t as u32) as usize)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Mesh {
        let positions = (0..8u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f32::from)).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        Mesh { positions, triangles }
    }

    #[test]
    fn a_cube_is_closed_and_every_edge_joins_its_triangles() {
        let mesh = cube();
        let adjacency = Adjacency::of(&mesh);
        assert!(adjacency.closed);
        assert_eq!(adjacency.edges.len(), 18);
        for e in &adjacency.edges {
            let runs = |t: u32, from: u32, to: u32| {
                let c = mesh.triangles[t as usize];
                (0..3).any(|k| c[k] == from && c[(k + 1) % 3] == to)
            };
            assert!(e.t0 < e.t1 && runs(e.t0, e.v0, e.v1) && runs(e.t1, e.v1, e.v0), "{e:?}");
        }
    }

    #[test]
    fn an_open_mesh_has_boundary_edges() {
        let mut mesh = cube();
        mesh.triangles.pop();
        let adjacency = Adjacency::of(&mesh);
        assert!(!adjacency.closed);
        assert_eq!((adjacency.edges.len(), adjacency.boundary), (18, 3));
        assert_eq!(adjacency.edges.iter().filter(|e| e.t1 == NO_TRIANGLE).count(), 3);
    }

    #[test]
    fn a_flipped_triangle_makes_its_edges_inconsistent() {
        let mut mesh = cube();
        mesh.triangles[0].reverse();
        let adjacency = Adjacency::of(&mesh);
        assert_eq!((adjacency.inconsistent, adjacency.closed), (3, false));
    }

    #[test]
    fn an_edge_of_three_triangles_is_one_silhouette() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        };
        let adjacency = Adjacency::of(&mesh);
        assert_eq!((adjacency.edges.len(), adjacency.non_manifold, adjacency.boundary), (7, 1, 6));
        assert_eq!(adjacency.edges.iter().filter(|e| (e.v0, e.v1) == (0, 1)).count(), 1);
    }

    #[test]
    fn a_doubled_mesh_is_not_closed() {
        let mut mesh = cube();
        mesh.triangles.extend_from_within(..);
        let adjacency = Adjacency::of(&mesh);
        assert_eq!((adjacency.edges.len(), adjacency.non_manifold, adjacency.closed), (18, 18, false));
    }

    #[test]
    fn an_inward_wound_mesh_is_not_closed_nor_is_one_inward_part() {
        let mut inward = cube();
        inward.triangles.iter_mut().for_each(|t| t.reverse());
        assert!(!Adjacency::of(&inward).closed);
        let mut both = cube();
        both.positions.extend(inward.positions.iter().map(|p| [p[0] + 5.0, p[1], p[2]]));
        both.triangles.extend(inward.triangles.iter().map(|t| t.map(|v| v + 8)));
        let adjacency = Adjacency::of(&both);
        assert_eq!((adjacency.silhouettes_from_everywhere(), adjacency.closed), (0, false));
        assert_eq!(adjacency.bodies, [[true; 12], [false; 12]].concat());
    }

    #[test]
    fn bodies_are_bodies_whatever_stands_beside_them() {
        let part = cube();
        let mut mesh = cube();
        // Beside a whole cube: a torn one, a single triangle, one with a fin on an edge, one with a triangle turned around.
        let torn = &part.triangles[..11];
        let fin = [&part.triangles[..], &[[0, 1, 8]]].concat();
        let mut turned = part.triangles.clone();
        turned[7].reverse();
        let parts: [&[[u32; 3]]; 4] = [torn, &[[0, 1, 2]], &fin, &turned];
        for (k, triangles) in (1u8..).zip(parts) {
            let base = mesh.positions.len() as u32;
            let corners = part.positions.iter().chain(&[[0.5, -1.0, -1.0]]);
            mesh.positions.extend(corners.map(|p| [p[0] + 5.0 * f32::from(k), p[1], p[2]]));
            mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + base)));
        }
        // A cube that touches the first along an edge: the four triangles there are no one's.
        let adjacency = Adjacency::of(&mesh);
        let others = mesh.triangles.len() - 12;
        assert_eq!(adjacency.bodies, [vec![true; 12], vec![false; others]].concat());
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions.iter().map(|p| [p[0] - 1.0, p[1] - 1.0, p[2]]));
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + base)));
        assert!(Adjacency::of(&mesh).bodies.iter().all(|body| !body));
    }

    #[test]
    fn a_sheet_of_two_sides_bounds_no_volume() {
        let mesh = Mesh {
            positions: vec![[0.1, 0.7, 0.3], [1.3, 0.2, 0.9], [0.4, 1.1, 0.6]],
            triangles: vec![[0, 1, 2], [2, 1, 0]],
        };
        let adjacency = Adjacency::of(&mesh);
        assert_eq!((adjacency.edges.len(), adjacency.silhouettes_from_everywhere(), adjacency.closed), (3, 0, false));
    }

    #[test]
    fn vertices_are_welded_by_position_and_minus_zero_is_zero() {
        let mesh = cube();
        let soup = Mesh {
            positions: mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect(),
            triangles: (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        };
        assert!(Adjacency::of(&soup).closed);
        let mut signed = soup;
        for p in signed.positions.iter_mut().step_by(2) {
            *p = p.map(|c| if c == 0.0 { -0.0 } else { c });
        }
        assert!(Adjacency::of(&signed).closed);
    }

    #[test]
    fn collapsed_triangles_change_nothing() {
        let mut mesh = cube();
        mesh.positions.push(mesh.positions[0]);
        mesh.triangles.extend([[0, 8, 1], [3, 3, 3]]);
        let adjacency = Adjacency::of(&mesh);
        assert_eq!((adjacency.edges.len(), adjacency.collapsed, adjacency.closed), (18, 2, true));
    }

    /// Small soups against a count by the definition: every kind of edge occurs in them.
    #[test]
    fn edges_agree_with_their_definition() {
        use std::collections::BTreeMap;
        let mut state = 1u64;
        let mut next = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        let mut kinds = [0u32; 4];
        for _ in 0..500 {
            let n = 3 + next(6);
            // Vertex v lies where vertex v % n does.
            let positions =
                (0..2 * n).map(|v| [(v % n) as f32, ((v % n) * 5 % 7) as f32, (v % n / 3) as f32]).collect();
            let triangles: Vec<[u32; 3]> = (0..1 + next(8)).map(|_| [0; 3].map(|_| next(2 * n) as u32)).collect();
            let mut expected: BTreeMap<(u64, u64), Vec<(usize, bool)>> = BTreeMap::new();
            for (t, tri) in triangles.iter().enumerate() {
                let w = tri.map(|v| u64::from(v) % n);
                if w[0] == w[1] || w[1] == w[2] || w[2] == w[0] {
                    continue;
                }
                for (from, to) in [(w[0], w[1]), (w[1], w[2]), (w[2], w[0])] {
                    expected.entry((from.min(to), from.max(to))).or_default().push((t, from < to));
                }
            }
            let adjacency = Adjacency::of(&Mesh { positions, triangles });
            assert_eq!(adjacency.edges.len(), expected.len());
            for e in &adjacency.edges {
                let (from, to) = (u64::from(e.v0) % n, u64::from(e.v1) % n);
                let sides = &expected[&(from.min(to), from.max(to))];
                assert_eq!(sides[0], (e.t0 as usize, from < to));
                let (kind, other) = match sides[..] {
                    [_] => (0, NO_TRIANGLE),
                    [(_, a), (t, b)] if a != b => (1, t as u32),
                    [_, _] => (2, NO_TRIANGLE),
                    _ => (3, NO_TRIANGLE),
                };
                kinds[kind] += 1;
                assert_eq!(e.t1, other);
            }
        }
        assert!(kinds.iter().all(|&k| k > 100), "{kinds:?}");
    }

    /// A cube one of whose triangles is left out is as one without it, but that the numbers stay.
    #[test]
    fn triangles_that_are_left_out_hang_together_with_nothing() {
        let mesh = cube();
        let adjacency = Adjacency::but_for(&mesh, &[11]);
        let mut open = cube();
        open.triangles.pop();
        assert_eq!(adjacency.edges, Adjacency::of(&open).edges);
        assert_eq!(adjacency.bodies, [false; 12]);
        assert_eq!(adjacency.surfaces[11], 11, "it lies in a plane with triangle 10");
        assert_eq!(Adjacency::of(&mesh).surfaces[11], 10);
        assert!(adjacency.edges.iter().all(|e| e.t0 != 11 && e.t1 != 11));
    }

    #[test]
    fn a_mesh_without_triangles_has_no_edges() {
        let adjacency = Adjacency::of(&Mesh { positions: vec![[0.0; 3]], triangles: vec![] });
        assert!(adjacency.edges.is_empty() && !adjacency.closed);
    }
}
