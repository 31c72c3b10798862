//! The tree of casters that rays walk on the GPU: eight boxes of 8 bits a node (Ylitie, Karras, Laine, *Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, HPG 2017), built by `obvhs` (PLOC with reinsertion).
//!
//! Large triangles are split between several boxes (Ernst and Greiner, *Early Split Clipping for Bounding Volume
//! Hierarchies*, RT 2007), so one may be in several leaves. Boxes lie in the unit cube, so nothing depends on the size or the
//! place of a scene; each is padded by 2^-20 of the cube, far above what building and compression round. The same mesh gives
//! the same tree.

use crate::gpu::kernels::shadow_rays::TESTED;
use crate::scene::{AlphaTested, Mesh};
use crate::stages::shadow_rays::TreePlace;
use crate::{Error, Result};
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;

/// Length by which every box is grown.
const PAD: f32 = 1.0 / (1u32 << 20) as f32;
/// Triangles a leaf may hold.
const LEAF: u32 = 1;

/// A tree in the words of the kernels.
#[derive(Clone, Debug, Default)]
pub struct CasterTree {
    /// Nodes, five vectors each, as [`obvhs::cwbvh::node::CwBvhNode`] lays them out.
    pub nodes: Vec<[[u32; 4]; 5]>,
    /// Triangles in the order of the leaves: a vertex, the two edges from it (world units), and in the fourth words the bits
    /// of the three vertex indices; of an alpha-tested one, in place of the first, its number and the highest bit.
    pub triangles: Vec<[[f32; 4]; 3]>,
    /// Lowest corner of the cube, world units.
    low: DVec3,
    /// World units to the cube.
    scale: f64,
}

impl CasterTree {
    /// Levels of a tree at most, which bounds a walk's stack.
    pub const DEPTH: usize = 24;

    /// The tree over the triangles of `mesh`, none of which has holes. Those that are no triangles (an index out of range, a vertex that is not
    /// finite) are left out.
    ///
    /// # Errors
    /// [`Error::Limit`] if the tree is deeper than [`CasterTree::DEPTH`].
    pub fn new(mesh: &Mesh) -> Result<Self> {
        Self::with_alpha(mesh, &AlphaTested::default())
    }

    /// As [`CasterTree::new`], where some triangles are alpha-tested.
    ///
    /// # Errors
    /// As [`CasterTree::new`].
    pub fn with_alpha(mesh: &Mesh, alpha: &AlphaTested) -> Result<Self> {
        let mut named = mesh.triangles.clone();
        for of in &alpha.triangles {
            if let Some(corners) = named.get_mut(of.triangle as usize) {
                corners[0] = of.triangle | TESTED;
            }
        }
        let corners = |t: &[u32; 3]| -> Option<[Vec3; 3]> {
            let found = t.map(|v| mesh.positions.get(v as usize).map(|p| Vec3::from(*p)));
            let [Some(a), Some(b), Some(c)] = found else { return None };
            [a, b, c].iter().all(|p| p.is_finite()).then_some([a, b, c])
        };
        let casters: Vec<([u32; 3], [Vec3; 3])> =
            mesh.triangles.iter().zip(named).filter_map(|(t, named)| corners(t).map(|c| (named, c))).collect();
        if casters.is_empty() {
            return Ok(Self { scale: 1.0, ..Self::default() });
        }
        let each = || casters.iter().flat_map(|(_, c)| c).map(|p| p.as_dvec3());
        let low = each().fold(DVec3::INFINITY, DVec3::min);
        let size = (each().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_element();
        let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
        let unit: Vec<Triangle> = casters
            .iter()
            .map(|(_, c)| {
                let [v0, v1, v2] = c.map(|p| Vec3A::from(((p.as_dvec3() - low) * scale).as_vec3()));
                Triangle { v0, v1, v2 }
            })
            .collect();
        let (boxes, owners) = split_boxes(&unit);
        let parameters = BvhBuildParams::slow_build();
        let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
            parameters.ploc_search_distance,
            &boxes,
            (0..boxes.len() as u32).collect(),
            parameters.sort_precision,
            parameters.search_depth_threshold,
        );
        ReinsertionOptimizer::default().run(&mut binary, parameters.reinsertion_batch_ratio, None);
        let mut tree = bvh2_to_cwbvh(&binary, LEAF, true, false);
        if depth(&tree) > Self::DEPTH {
            // Many equal boxes make a list of a tree that is built by merging neighbours.
            tree = bvh2_to_cwbvh(&balanced(&boxes), LEAF, true, false);
        }
        let needed = depth(&tree);
        if needed > Self::DEPTH {
            let what = "levels of the tree of casters".to_owned();
            return Err(Error::Limit { what, needed: needed as u64, limit: Self::DEPTH as u64 });
        }
        let triangles = tree.primitive_indices.iter().map(|&k| {
            let ([i, j, k], [a, b, c]) = casters[owners[k as usize] as usize];
            let edge = |to: Vec3| (to.as_dvec3() - a.as_dvec3()).as_vec3();
            [(a, i), (edge(b), j), (edge(c), k)].map(|(v, index)| v.extend(f32::from_bits(index)).into())
        });
        Ok(Self {
            triangles: triangles.collect(),
            nodes: tree.nodes.iter().map(|n| bytemuck::cast(*n)).collect(),
            low,
            scale,
        })
    }

    /// Where the tree lies for an eye (world units) and the scale of a frame.
    pub fn place(&self, eye: DVec3, frame_scale: f64) -> TreePlace {
        let offset = (eye - self.low) * self.scale;
        let slack = 4e-6 + 2e-6 * offset.abs().max_element();
        TreePlace {
            place: offset.extend(self.scale / frame_scale).as_vec4().into(),
            slack: slack as f32,
            node_count: self.nodes.len() as u32,
            ..TreePlace::default()
        }
    }

    /// The boxes of a node's children in the cube, each with what it leads to: a node, or the first of so many triangles.
    #[cfg(test)]
    fn children(&self, at: usize) -> Vec<(DVec3, DVec3, Child)> {
        let node = &self.nodes[at];
        let byte = |word: usize, k: usize| node[word / 4][word % 4] >> (8 * k) & 255;
        let mut found = Vec::new();
        let mut inner = 0;
        for k in 0..8 {
            let meta = byte(6 + k / 4, k % 4);
            if meta == 0 {
                continue;
            }
            let corner = |first: usize| {
                let axis = |n: usize| {
                    let step = f32::from_bits(byte(3, n) << 23);
                    f64::from(f32::from_bits(node[0][n]))
                        + f64::from(step) * f64::from(byte(first + 4 * n + k / 4, k % 4))
                };
                DVec3::new(axis(0), axis(1), axis(2))
            };
            let child = if meta & 0x18 == 0x18 {
                inner += 1;
                Child::Node(node[1][0] as usize + inner - 1)
            } else {
                Child::Leaf(node[1][1] + (meta & 31), (meta >> 5).count_ones())
            };
            found.push((corner(8), corner(10), child));
        }
        found
    }
}

/// Boxes that together hold the triangles of the unit cube, and which each is of.
fn split_boxes(triangles: &[Triangle]) -> (Vec<Aabb>, Vec<u32>) {
    let mut boxes: Vec<Aabb> = triangles.iter().map(Triangle::aabb).collect();
    let mut owners: Vec<u32> = (0..triangles.len() as u32).collect();
    let areas = || boxes.iter().map(Aabb::half_area);
    let (mean, largest) = (areas().sum::<f32>() / boxes.len() as f32, areas().fold(0.0, f32::max));
    split_aabbs_preset(&mut boxes, &mut owners, triangles, mean, largest);
    if let ([only], [owner]) = (&boxes[..], &owners[..]) {
        // The builder expects more than one leaf.
        (boxes, owners) = (vec![*only; 2], vec![*owner; 2]);
    }
    for b in &mut boxes {
        (b.min, b.max) = (b.min - PAD, b.max + PAD);
    }
    (boxes, owners)
}

/// Levels of a tree.
fn depth(tree: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0, 1)];
    while let Some((at, depth)) = open.pop() {
        deepest = deepest.max(depth);
        let node = &tree.nodes[at as usize];
        open.extend((0..node.imask.count_ones()).map(|k| (node.child_base_idx + k, depth + 1)));
    }
    deepest
}

/// The tree that halves the boxes along their longest extent, by their middles.
fn balanced(boxes: &[Aabb]) -> Bvh2 {
    let around = |part: &[u32]| {
        let all = part.iter().map(|&k| &boxes[k as usize]);
        all.fold(Aabb::empty(), |sum, b| Aabb { min: sum.min.min(b.min), max: sum.max.max(b.max) })
    };
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![(0, 0..boxes.len())];
    while let Some((at, range)) = open.pop() {
        let part = &mut order[range.clone()];
        let whole = around(part);
        if part.len() == 1 {
            nodes[at] = Bvh2Node::new(whole, 1, range.start as u32);
            continue;
        }
        let extent = whole.max - whole.min;
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let middle = |k: u32| boxes[k as usize].min[axis] + boxes[k as usize].max[axis];
        part.sort_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
        let half = range.start + part.len() / 2;
        nodes[at] = Bvh2Node::new(whole, 0, nodes.len() as u32);
        open.extend([(nodes.len(), range.start..half), (nodes.len() + 1, half..range.end)]);
        nodes.extend([Bvh2Node::default(); 2]);
    }
    let mut tree = Bvh2::default();
    (tree.nodes, tree.primitive_indices, tree.children_are_ordered_after_parents) = (nodes, order, true);
    tree
}

#[cfg(test)]
enum Child {
    Node(usize),
    Leaf(u32, u32),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::builtin;
    use std::collections::HashMap;

    /// Every point of every triangle lies in all boxes on the way to some leaf of it.
    fn check(mesh: &Mesh) -> CasterTree {
        let tree = CasterTree::new(mesh).unwrap();
        let mut leaves: HashMap<[u32; 3], Vec<(DVec3, DVec3)>> = HashMap::new();
        let everything = (DVec3::splat(-1.0), DVec3::splat(2.0));
        let mut open = vec![(0usize, everything)];
        while let Some((at, (above_low, above_high))) = open.pop() {
            for (low, high, child) in tree.children(at) {
                let within = (low.max(above_low), high.min(above_high));
                match child {
                    Child::Node(next) => open.push((next, within)),
                    Child::Leaf(first, count) => {
                        for t in &tree.triangles[first as usize..(first + count) as usize] {
                            leaves.entry(t.map(|v| v[3].to_bits())).or_default().push(within);
                        }
                    }
                }
            }
        }
        for t in &mesh.triangles {
            let boxes = &leaves[t];
            let [a, b, c] = t.map(|v| (Vec3::from(mesh.positions[v as usize]).as_dvec3() - tree.low) * tree.scale);
            for k in 0..45 {
                let (u, v) = (f64::from(k % 9) / 8.0, f64::from(k / 9) / 4.0);
                let p = a + (b - a) * u * (1.0 - v) + (c - a) * v;
                assert!(boxes.iter().any(|(l, h)| p.cmpge(*l).all() && p.cmple(*h).all()), "{t:?}: {p}");
            }
        }
        tree
    }

    #[test]
    fn boxes_hold_what_is_in_them() {
        for name in ["windmill", "knot", "plane", "bicycle"] {
            let mesh = builtin(name).mesh;
            let leaves = check(&mesh).triangles.len();
            assert!((mesh.triangles.len()..3 * mesh.triangles.len()).contains(&leaves), "{name}: {leaves} leaves");
        }
    }

    #[test]
    fn any_number_at_any_scale() {
        for scale in [1e-20f32, 1.0, 1e20] {
            for n in [1u32, 2, 3, 4, 5, 9, 100] {
                let at = |v: u32| [(v * 7 % 11) as f32, (v * 5 % 13) as f32, (v * 3 % 17) as f32].map(|c| c * scale);
                let mesh = Mesh {
                    positions: (0..3 * n).map(at).collect(),
                    triangles: (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
                };
                assert!(check(&mesh).triangles.len() >= n as usize);
            }
        }
        let one = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        check(&Mesh { positions: one.to_vec(), triangles: vec![[0, 1, 2]; 500] });
        assert!(CasterTree::new(&Mesh::default()).unwrap().nodes.is_empty());
        let none = Mesh { positions: vec![[f32::NAN; 3]; 3], triangles: vec![[0, 1, 2], [0, 1, 9]] };
        assert!(CasterTree::new(&none).unwrap().nodes.is_empty());
    }
}
