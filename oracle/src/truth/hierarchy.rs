//! The bounding volume hierarchy that lists candidate triangles.
//!
//! Built by `obvhs` (PLOC with reinsertion), of which only the topology is kept. Its own traversal clamps reciprocals
//! and cuts hits off at fixed distances, and its boxes are `f32` areas that overflow and underflow with the scale of a
//! scene; so it is given boxes scaled to the unit cube, and the boxes kept here are computed again from the triangles.

use super::beam::Beam;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;

/// Triangles a leaf may hold.
const LEAF: u32 = 4;
/// Levels that fit the traversal stack without an allocation.
const STACK: usize = 96;

/// Two child boxes and where they lead.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: [Vec3; 2],
    high: [Vec3; 2],
    /// Index of a node, or of the first slot of a leaf.
    child: [u32; 2],
    /// Slots of a leaf, 0 for a node.
    count: [u32; 2],
}

const NOTHING: (Vec3, Vec3) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
const EMPTY: Node = Node { low: [NOTHING.0; 2], high: [NOTHING.1; 2], child: [0; 2], count: [1, 0] };

/// A binary hierarchy over triangles. A *slot* is a place in leaf order.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    nodes: Vec<Node>,
    depth: usize,
    /// Corners of the triangle in each slot.
    pub corners: Vec<[Vec3; 3]>,
    /// Index in the mesh of the triangle in each slot.
    pub triangles: Vec<u32>,
}

/// As `obvhs::bvh2::builder::build_bvh2`, which takes the time as well: a browser has no clock for it.
fn build(boxes: &[Aabb], how: BvhBuildParams) -> Bvh2 {
    let all = (0..boxes.len() as u32).collect();
    let (precision, threshold) = (how.sort_precision, how.search_depth_threshold);
    let mut ploc = PlocBuilder::with_capacity(boxes.len());
    let mut tree = ploc.build(how.ploc_search_distance, boxes, all, precision, threshold);
    let mut optimizer = ReinsertionOptimizer::default();
    let ratio = how.reinsertion_batch_ratio;
    optimizer.run(&mut tree, ratio, None);
    collapse(&mut tree, how.max_prims_per_leaf.clamp(1, 255), how.collapse_traversal_cost);
    optimizer.run(&mut tree, ratio * how.post_collapse_reinsertion_batch_ratio_multiplier, None);
    tree
}

impl Hierarchy {
    /// The hierarchy over `corners`, which must be finite.
    pub fn new(corners: &[[Vec3; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), depth: 1, corners: Vec::new(), triangles: Vec::new() };
        if corners.len() <= LEAF as usize {
            tree.corners = corners.to_vec();
            tree.triangles = (0..corners.len() as u32).collect();
            tree.nodes.push(Node { count: [corners.len() as u32, 0], ..EMPTY });
        } else {
            tree.take_topology(corners);
        }
        tree.refit();
        tree
    }

    fn take_topology(&mut self, corners: &[[Vec3; 3]]) {
        let boxes = unit_boxes(corners);
        let parameters =
            BvhBuildParams { pre_split: false, max_prims_per_leaf: LEAF, ..BvhBuildParams::medium_build() };
        let tree = build(&boxes, parameters);
        // Depth first, so that a node's children lie behind it and refitting can walk backwards.
        let mut open = vec![(0usize, 1usize, None::<(usize, usize)>)];
        while let Some((source, depth, parent)) = open.pop() {
            let here = self.nodes.len();
            if let Some((node, k)) = parent {
                self.nodes[node].child[k] = here as u32;
            }
            self.depth = self.depth.max(depth);
            let root = &tree.nodes[source];
            let mut node = Node { count: [0; 2], ..EMPTY };
            if root.is_leaf() {
                // Only the root can come here as a leaf: all triangles were put into one.
                node.count = [self.fill(&tree, root.first_index, root.prim_count, corners).1, 0];
                self.nodes.push(node);
                continue;
            }
            self.nodes.push(node);
            for k in 0..2 {
                let at = root.first_index as usize + k;
                let child = &tree.nodes[at];
                if child.is_leaf() {
                    let (first, count) = self.fill(&tree, child.first_index, child.prim_count, corners);
                    self.nodes[here].child[k] = first;
                    self.nodes[here].count[k] = count;
                } else {
                    open.push((at, depth + 1, Some((here, k))));
                }
            }
        }
    }

    fn fill(&mut self, tree: &Bvh2, first: u32, count: u32, corners: &[[Vec3; 3]]) -> (u32, u32) {
        let slot = self.triangles.len() as u32;
        for &t in &tree.primitive_indices[first as usize..(first + count) as usize] {
            self.triangles.push(t);
            self.corners.push(corners[t as usize]);
        }
        (slot, count)
    }

    fn refit(&mut self) {
        for at in (0..self.nodes.len()).rev() {
            let mut node = self.nodes[at];
            for k in 0..2 {
                let (first, count) = (node.child[k] as usize, node.count[k] as usize);
                let (low, high) = if count > 0 {
                    self.corners[first..first + count].iter().map(padded_box).fold(NOTHING, join)
                } else if first > at {
                    let child = &self.nodes[first];
                    join((child.low[0], child.high[0]), (child.low[1], child.high[1]))
                } else {
                    NOTHING
                };
                (node.low[k], node.high[k]) = (low, high);
            }
            self.nodes[at] = node;
        }
    }

    /// Calls `visit(slot, end)` for each slot whose box the beam enters before its end, roughly from near to far;
    /// `visit` returns the new end of the beam, and a negative one stops the walk.
    pub fn walk(&self, beam: &Beam, mut visit: impl FnMut(usize, f64) -> f64) {
        let mut beam = *beam;
        let mut small = [(0u32, 0.0f64); STACK];
        let mut large = Vec::new();
        let stack: &mut [(u32, f64)] = if self.depth <= STACK {
            &mut small
        } else {
            large.resize(self.depth, (0, 0.0));
            &mut large
        };
        let mut held = 0;
        let mut at = 0u32;
        loop {
            let node = &self.nodes[at as usize];
            let next = [0, 1].map(|k| beam.enters(node.low[k].as_dvec3(), node.high[k].as_dvec3()));
            let order = if next[1] < next[0] { [1, 0] } else { [0, 1] };
            let mut nearer = None;
            for k in order {
                let Some(t) = next[k] else { continue };
                if node.count[k] > 0 {
                    if t > beam.end {
                        continue;
                    }
                    let first = node.child[k] as usize;
                    for slot in first..first + node.count[k] as usize {
                        beam.end = visit(slot, beam.end);
                        if beam.end < 0.0 {
                            return;
                        }
                    }
                } else if nearer.is_none() {
                    nearer = Some((node.child[k], t));
                } else {
                    stack[held] = (node.child[k], t);
                    held += 1;
                }
            }
            loop {
                let (child, t) = match nearer.take() {
                    Some(child) => child,
                    None if held == 0 => return,
                    None => {
                        held -= 1;
                        stack[held]
                    }
                };
                if t <= beam.end {
                    at = child;
                    break;
                }
            }
        }
    }
}

fn join(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The box of a triangle, padded by 2^-20 of its extent and one step of `f32`.
fn padded_box(corners: &[Vec3; 3]) -> (Vec3, Vec3) {
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    let pad = (high - low).max_element() * (1.0 / (1u32 << 20) as f32);
    (low.map(|c| (c - pad).next_down()), high.map(|c| (c + pad).next_up()))
}

/// Boxes of the triangles, moved and scaled into the unit cube.
fn unit_boxes(corners: &[[Vec3; 3]]) -> Vec<Aabb> {
    let each = || corners.iter().flatten().map(|c| c.as_dvec3());
    let low = each().fold(DVec3::INFINITY, DVec3::min);
    let size = (each().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_element();
    let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
    let place = |p: Vec3| Vec3A::from(((p.as_dvec3() - low) * scale).as_vec3());
    corners
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(place);
            Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_every_triangle_once_at_every_scale() {
        for scale in [1e-30f32, 1.0, 1e30] {
            let corners: Vec<[Vec3; 3]> = (0..1000)
                .map(|k| {
                    let p = Vec3::new((k % 10) as f32, (k / 10 % 10) as f32, (k / 100) as f32);
                    [p, p + Vec3::X, p + Vec3::Y].map(|p| p * scale)
                })
                .collect();
            let tree = Hierarchy::new(&corners);
            let mut seen: Vec<u32> = Vec::new();
            let far = f64::from(scale) * 20.0;
            let everything = Beam::pencil(DVec3::splat(-far), DVec3::splat(-1.0), DVec3::splat(1.0), 0.0, 1e300);
            tree.walk(&everything, |slot, end| {
                assert_eq!(tree.corners[slot], corners[tree.triangles[slot] as usize]);
                seen.push(tree.triangles[slot]);
                end
            });
            seen.sort_unstable();
            assert_eq!(seen, (0..1000).collect::<Vec<_>>(), "scale {scale}");
        }
    }

    #[test]
    fn small_and_equal_sets_work() {
        let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for n in [0usize, 1, 2, 4, 5, 17, 3000] {
            let tree = Hierarchy::new(&vec![one; n]);
            let mut seen = 0;
            tree.walk(&Beam::ray(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z, 0.0, 2.0), |_, end| {
                seen += 1;
                end
            });
            assert_eq!(seen, n);
        }
    }
}
