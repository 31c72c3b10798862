//! Boxes around ever smaller groups of a mesh's triangles, for questions that few of its triangles decide: how far it reaches along
//! some direction, what of it lies before or behind something. Best first (Hjaltason and Samet 1999), so that what is not better than the
//! best so far is never visited.
//!
//! Groups are runs of a Morton order (Lauterbach et al. 2009): no tree is deeper than the logarithm of the count, however the
//! triangles lie. Built from the same mesh it is the same.

mod bytes;

use super::Mesh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Triangles a box of the lowest level holds.
const LEAF: usize = 16;

/// Boxes of a level that one of the next holds.
const FAN: usize = 8;

/// A box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const NONE: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    fn of(mesh: &Mesh, t: u32) -> Self {
        let [a, b, c] = mesh.triangles[t as usize].map(|v| Vec3::from(mesh.positions[v as usize]));
        Self { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    fn join(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.max(o.high) }
    }

    /// The middle.
    pub fn middle(&self) -> DVec3 {
        (self.low.as_dvec3() + self.high.as_dvec3()) * 0.5
    }

    /// Half the diagonal.
    pub fn radius(&self) -> f64 {
        (self.high.as_dvec3() - self.low.as_dvec3()).length() * 0.5
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        let (low, high) = (self.low.as_dvec3(), self.high.as_dvec3());
        std::array::from_fn(|k| {
            DVec3::new([low.x, high.x][k & 1], [low.y, high.y][(k >> 1) & 1], [low.z, high.z][k >> 2])
        })
    }

    /// The greatest `axis · p` of its points.
    pub fn reach(&self, axis: DVec3) -> f64 {
        let (low, high) = (axis * self.low.as_dvec3(), axis * self.high.as_dvec3());
        low.max(high).element_sum()
    }

    /// Whether a ray along x from `at` meets it, grown by `slack`.
    fn is_met(&self, at: DVec3, slack: f64) -> bool {
        let (low, high) = (self.low.as_dvec3() - slack, self.high.as_dvec3() + slack);
        at.x <= high.x && low.y <= at.y && at.y <= high.y && low.z <= at.z && at.z <= high.z
    }

    /// Whether `at` lies in it, grown by `slack`.
    fn is_near(&self, at: DVec3, slack: f64) -> bool {
        self.is_met(at, slack) && f64::from(self.low.x) - slack <= at.x
    }
}

/// Which triangles are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// All but the [largest](MeshTree::large).
    Small,
    /// All.
    All,
}

/// The tree of a mesh, without its vertices. Of a mesh of which all indices are in range.
#[derive(Clone, Debug, Default)]
pub struct MeshTree {
    small: Part,
    large: Part,
}

/// A tree of some of the triangles.
#[derive(Clone, Debug, Default)]
struct Part {
    order: Vec<u32>,
    /// From the lowest level to the one with a single box.
    levels: Vec<Vec<Bounds>>,
}

/// A box that is still to be looked into.
struct Open {
    above: f64,
    of_large: bool,
    level: usize,
    at: usize,
}

impl Open {
    /// Smaller boxes first among those that promise the same.
    fn key(&self) -> (Reverse<usize>, bool, usize) {
        (Reverse(self.level), self.of_large, self.at)
    }
}

impl Ord for Open {
    fn cmp(&self, o: &Self) -> std::cmp::Ordering {
        self.above.total_cmp(&o.above).then(self.key().cmp(&o.key()))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, o: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(o))
    }
}

impl PartialEq for Open {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o).is_eq()
    }
}

impl Eq for Open {}

impl MeshTree {
    /// How many triangles count as large: those with the longest edges.
    pub const LARGE: usize = 64;

    /// The tree of `mesh`.
    ///
    /// # Panics
    /// If an index is out of range ([`Mesh::check`]).
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(mesh, |_| true)
    }

    /// Likewise of those triangles alone for which `is_in` holds.
    pub fn of(mesh: &Mesh, is_in: impl Fn(u32) -> bool + Sync) -> Self {
        let longest = |t: u32| {
            let [a, b, c] = corners(mesh, t);
            (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared())
        };
        let all = 0..mesh.triangles.len() as u32;
        let mut by_size: Vec<(f64, u32)> = all.into_par_iter().filter(|&t| is_in(t)).map(|t| (longest(t), t)).collect();
        let count = by_size.len();
        let large = count.min(Self::LARGE);
        if large < count {
            by_size.select_nth_unstable_by(large, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        }
        let part = |some: &[(f64, u32)]| Part::new(mesh, some.iter().map(|&(_, t)| t).collect());
        Self { small: part(&by_size[large..]), large: part(&by_size[..large]) }
    }

    /// The triangles with the longest edges, [`MeshTree::LARGE`] of them where there are that many.
    pub fn large(&self) -> &[u32] {
        &self.large.order
    }

    /// Whether no triangle is asked.
    pub fn is_empty(&self, which: Which) -> bool {
        self.small.order.is_empty() && (which == Which::Small || self.large.order.is_empty())
    }

    /// Lowest and highest corner of what the triangles take; `None` without triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let all =
            self.parts(Which::All).filter_map(|(_, part)| part.levels.last()?.first().copied()).reduce(Bounds::join)?;
        Some((all.low.as_dvec3(), all.high.as_dvec3()))
    }

    fn parts(&self, which: Which) -> impl Iterator<Item = (bool, &Part)> {
        let large = (which == Which::All).then_some((true, &self.large));
        std::iter::once((false, &self.small)).chain(large).filter(|(_, part)| !part.order.is_empty())
    }

    /// The triangle of the greatest value, and that; `None` if there is none above negative infinity. `above`: what the value of no
    /// triangle in a box exceeds.
    pub fn greatest(
        &self,
        mesh: &Mesh,
        which: Which,
        above: impl Fn(&Bounds) -> f64,
        value: impl Fn([DVec3; 3]) -> f64,
    ) -> Option<(f64, u32)> {
        let mut best: Option<(f64, u32)> = None;
        let mut open: BinaryHeap<Open> = self
            .parts(which)
            .map(|(of_large, part)| {
                let level = part.levels.len() - 1;
                Open { above: above(&part.levels[level][0]), of_large, level, at: 0 }
            })
            .collect();
        while let Some(Open { above: most, of_large, level, at }) = open.pop() {
            if most <= best.map_or(f64::NEG_INFINITY, |(value, _)| value) {
                break;
            }
            let part = if of_large { &self.large } else { &self.small };
            if level == 0 {
                for &t in part.leaf(at) {
                    let so_far = best.map_or(f64::NEG_INFINITY, |(value, _)| value);
                    if above(&Bounds::of(mesh, t)) <= so_far {
                        continue;
                    }
                    let found = value(corners(mesh, t));
                    if found > so_far {
                        best = Some((found, t));
                    }
                }
            } else {
                for (at, bounds) in part.levels[level - 1].iter().enumerate().skip(FAN * at).take(FAN) {
                    let most = above(bounds);
                    if most > best.map_or(f64::NEG_INFINITY, |(value, _)| value) {
                        open.push(Open { above: most, of_large, level: level - 1, at });
                    }
                }
            }
        }
        best
    }

    /// Goes through all triangles, large ones first, in boxes that `enter`, which is also told how many triangles a box holds, says
    /// yes to; stops where `each` says no.
    pub fn visit(
        &self,
        mesh: &Mesh,
        mut enter: impl FnMut(&Bounds, usize) -> bool,
        mut each: impl FnMut(u32, [DVec3; 3]) -> bool,
    ) {
        for part in [&self.large, &self.small].into_iter().filter(|part| !part.order.is_empty()) {
            let mut open = vec![(part.levels.len() - 1, 0)];
            while let Some((level, at)) = open.pop() {
                let all = LEAF * FAN.pow(level as u32);
                if !enter(&part.levels[level][at], part.order.len().min(all * (at + 1)) - all * at) {
                    continue;
                }
                if level == 0 {
                    for &t in part.leaf(at) {
                        if !each(t, corners(mesh, t)) {
                            return;
                        }
                    }
                } else {
                    let end = part.levels[level - 1].len().min(FAN * (at + 1));
                    open.extend((FAN * at..end).rev().map(|at| (level - 1, at)));
                }
            }
        }
    }

    /// How often the triangles that `counts` names run around a point, which is 0 outside of closed bodies that are turned outward:
    /// crossings of a ray along x, each by its direction. `None` if one of them is within `slack` of the point, or, in its plane, next
    /// to it.
    ///
    /// Whether the ray passes a triangle follows from on which side of each edge it passes, which two triangles at an edge are told
    /// alike, so that nothing is counted twice, and there is no gap between two (Hormann and Agathos 2001).
    pub fn winding(&self, mesh: &Mesh, at: DVec3, slack: f64, counts: impl Fn(u32) -> bool) -> Option<i64> {
        let mut around = Some(0i64);
        let enter = |b: &Bounds, _| b.is_met(at, slack);
        let each = |t: u32, [a, b, c]: [DVec3; 3]| {
            if !counts(t) {
                return true;
            }
            let bounds = Bounds::of(mesh, t);
            let normal = (b - a).cross(c - a);
            let off = normal.dot(a - at);
            if off.abs() <= slack * normal.length() && bounds.is_near(at, slack) {
                around = None;
                return false;
            }
            let turns = crossing(at, a, b) + crossing(at, b, c) + crossing(at, c, a);
            // It runs around the ray as its normal points.
            let ahead = f64::from(bounds.low.x) > at.x || (f64::from(bounds.high.x) > at.x && off * turns as f64 > 0.0);
            around = around.map(|n| n + if ahead { turns } else { 0 });
            true
        };
        self.visit(mesh, enter, each);
        around
    }
}

/// Whether the edge from `p` to `q`, seen along x, crosses the half line from `at` along y: 1 or -1 by its direction.
fn crossing(at: DVec3, p: DVec3, q: DVec3) -> i64 {
    if (p.z <= at.z) == (q.z <= at.z) {
        return 0;
    }
    // From the lower end, so that either direction is decided alike.
    let up = p.z <= at.z;
    let (low, high) = if up { (p, q) } else { (q, p) };
    let side = (high.y - low.y) * (at.z - low.z) - (high.z - low.z) * (at.y - low.y);
    if side <= 0.0 {
        return 0;
    }
    if up { 1 } else { -1 }
}

fn corners(mesh: &Mesh, t: u32) -> [DVec3; 3] {
    mesh.corners(t as usize)
}

impl Part {
    fn new(mesh: &Mesh, mut order: Vec<u32>) -> Self {
        if order.is_empty() {
            return Self::default();
        }
        let bounds = |t: u32| Bounds::of(mesh, t);
        let all = order.par_iter().map(|&t| bounds(t)).reduce(|| Bounds::NONE, Bounds::join);
        let (low, extent) = (all.low.as_dvec3(), (all.high.as_dvec3() - all.low.as_dvec3()).max_element());
        let scale = if extent > 0.0 { 1023.0 / extent } else { 0.0 };
        order.par_sort_by_cached_key(|&t| (morton((bounds(t).middle() - low) * scale), t));
        let mut levels: Vec<Vec<Bounds>> = vec![
            order
                .par_chunks(LEAF)
                .map(|leaf| leaf.iter().map(|&t| bounds(t)).fold(Bounds::NONE, Bounds::join))
                .collect(),
        ];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            levels.push(below.chunks(FAN).map(|part| part.iter().copied().fold(Bounds::NONE, Bounds::join)).collect());
        }
        Self { order, levels }
    }

    fn leaf(&self, at: usize) -> &[u32] {
        &self.order[LEAF * at..self.order.len().min(LEAF * (at + 1))]
    }
}

/// The bits of three numbers below 1024 by turns.
fn morton(p: DVec3) -> u32 {
    let spread = |x: f64| (0..10).fold(0u32, |sum, k| sum | ((x as u32 >> k & 1) << (3 * k)));
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Meshes of every kind: many small triangles, few large, some without area, all in one place.
    fn meshes() -> Vec<Mesh> {
        let mut meshes: Vec<Mesh> =
            ["knot", "plant", "cage"].into_iter().map(|name| crate::test_scenes::builtin(name).mesh).collect();
        let ground = meshes[1].ground_below().unwrap();
        meshes[1].add_ground(&ground);
        meshes.push(Mesh { positions: vec![[1.0, 2.0, 3.0]], triangles: vec![[0, 0, 0]; 500] });
        meshes.push(Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]] });
        meshes
    }

    fn directions() -> Vec<DVec3> {
        (0..40).map(|k| DVec3::new((k as f64).sin(), (k as f64 * 2.3).cos(), (k as f64 * 0.7).sin())).collect()
    }

    #[test]
    fn the_farthest_is_found_and_few_are_looked_at() {
        for mesh in meshes() {
            let tree = MeshTree::new(&mesh);
            let mut order = [tree.small.order.clone(), tree.large.order.clone()].concat();
            assert_eq!(tree.large().len(), mesh.triangles.len().min(64));
            order.sort_unstable();
            assert!((0..mesh.triangles.len() as u32).eq(order), "each triangle once");
            for (which, axis) in directions().into_iter().flat_map(|axis| [(Which::Small, axis), (Which::All, axis)]) {
                let value = |c: [DVec3; 3]| c.map(|p| p.dot(axis)).into_iter().fold(f64::NEG_INFINITY, f64::max);
                let looked = std::cell::Cell::new(0);
                let counted = |c| {
                    looked.set(looked.get() + 1);
                    value(c)
                };
                let found = tree.greatest(&mesh, which, |b| b.reach(axis), counted);
                let large = |t: &u32| which == Which::Small && tree.large().contains(t);
                let asked = (0..mesh.triangles.len() as u32).filter(|t| !large(t)).map(|t| value(corners(&mesh, t)));
                let wanted = asked.fold(f64::NEG_INFINITY, f64::max);
                assert_eq!(found.map_or(f64::NEG_INFINITY, |(v, _)| v), wanted, "{axis}");
                assert_eq!(found.is_none(), tree.is_empty(which));
                let most = mesh.triangles.len() / 20;
                assert!(mesh.triangles.len() < 1000 || looked.get() <= most, "{} of {most}", looked.get());
            }
        }
    }

    #[test]
    fn triangles_are_visited_by_their_boxes() {
        for mesh in meshes() {
            let tree = MeshTree::new(&mesh);
            for axis in directions() {
                let value = |c: [DVec3; 3]| c.map(|p| p.dot(axis)).into_iter().fold(f64::NEG_INFINITY, f64::max);
                let limit = tree.greatest(&mesh, Which::All, |b| b.reach(axis), value).unwrap().0 - 0.2;
                let (mut met, mut counted) = (0, 0);
                let enter = |b: &Bounds, count: usize| {
                    if b.reach(axis) <= limit {
                        counted += count;
                    }
                    b.reach(axis) > limit
                };
                let mut out = 0;
                tree.visit(&mesh, enter, |_, c| {
                    met += usize::from(value(c) > limit);
                    out += 1;
                    true
                });
                let wanted = (0..mesh.triangles.len() as u32).filter(|&t| value(corners(&mesh, t)) > limit).count();
                assert_eq!((met, out + counted), (wanted, mesh.triangles.len()));
                let mut first = 0;
                tree.visit(
                    &mesh,
                    |_, _| true,
                    |_, _| {
                        first += 1;
                        first < 5
                    },
                );
                assert_eq!(first, mesh.triangles.len().min(5));
            }
        }
    }

    /// Half the solid angles of the triangles from a point, over 2 pi (van Oosterom and Strackee 1983).
    fn winding_by_angles(mesh: &Mesh, at: DVec3) -> f64 {
        let angle = |t: usize| {
            let [a, b, c] = mesh.corners(t).map(|p| p - at);
            let [u, v, w] = [a, b, c].map(DVec3::length);
            a.dot(b.cross(c)).atan2(u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v)
        };
        (0..mesh.triangles.len()).map(angle).sum::<f64>() / std::f64::consts::TAU
    }

    #[test]
    fn a_point_is_wound_around_as_its_solid_angles_say() {
        let mesh = crate::test_scenes::builtin("knot").mesh;
        let tree = MeshTree::new(&mesh);
        let (low, high) = mesh.bounds().unwrap();
        let mut inside = 0;
        let middle = |t: usize| mesh.corners(t).iter().sum::<DVec3>() / 3.0;
        let inward = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            -(b - a).cross(c - a).normalize()
        };
        let places = directions().into_iter().map(|d| low + (high - low) * (d * 0.5 + 0.5));
        // Also from within, and straight at vertices and edges.
        let beneath = (0..40).map(|k| middle(997 * k) + inward(997 * k) * 0.03);
        let beside = (0..20).map(|k| mesh.corners(1013 * k)[0] + DVec3::new(-0.01 - 0.02 * k as f64, 0.0, 0.0));
        for at in places.chain(beneath).chain(beside) {
            let angles = winding_by_angles(&mesh, at);
            let found = tree.winding(&mesh, at, 0.0, |_| true);
            assert_eq!(found, Some(angles.round() as i64), "{at}: {angles}");
            inside += usize::from(found != Some(0));
            assert_eq!(tree.winding(&mesh, at, 0.0, |_| false), Some(0));
        }
        assert!((20..90).contains(&inside), "{inside} points inside");
        // On the surface.
        for t in (0..mesh.triangles.len()).step_by(5003) {
            assert_eq!(tree.winding(&mesh, middle(t), 1e-6, |_| true), None);
        }
        // Through the vertices and edges of a grid of cubes' faces.
        let mut cube = Mesh::default();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0.0f32), (axis, 2.0)]) {
            let at = |u: u32, v: u32| {
                let mut p = [side; 3];
                p[(axis + 1) % 3] = u as f32;
                p[(axis + 2) % 3] = v as f32;
                p
            };
            for (u, v) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let n = cube.positions.len() as u32;
                cube.positions.extend([at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)]);
                let faces = [[n, n + 1, n + 2], [n, n + 2, n + 3]];
                cube.triangles.extend(if side > 0.0 { faces } else { faces.map(|[a, b, c]| [a, c, b]) });
            }
        }
        let tree = MeshTree::new(&cube);
        for k in 0..5 * 5 * 5 {
            let at = DVec3::new(f64::from(k % 5), f64::from(k / 5 % 5), f64::from(k / 25)) * 0.5
                - DVec3::new(0.25, 0.0, 0.0);
            let [y, z] = [at.y, at.z].map(|v| if v == 0.0 || v == 2.0 { None } else { Some(v > 0.0 && v < 2.0) });
            let x = at.x > 0.0 && at.x < 2.0;
            if let (Some(y), Some(z)) = (y, z) {
                assert_eq!(tree.winding(&cube, at, 1e-9, |_| true), Some(i64::from(x && y && z)), "{at}");
            }
        }
    }
}
