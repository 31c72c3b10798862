//! Rays that are followed together: their node tests are one, by intervals, their triangle tests eight at a time.

use glam::{UVec2, Vec3A};
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::node::{CwBvhNode, extract_byte64};
use obvhs::rt_triangle::RtTriangle;

const LANES: usize = 8;

/// Sizes of what rounding may do to boxes and origins, relative to their coordinates.
const ROUNDING: f32 = 4e-7;

/// Eight rays.
#[derive(Clone, Copy)]
struct Block {
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
    begin: [f32; LANES],
    /// Of a ray that looks for nothing: less than any parameter.
    end: [f32; LANES],
    /// Leaf met last; the triangle that is not met.
    slot: [u32; LANES],
    own: [u32; LANES],
}

const NO_RAYS: Block = Block {
    origin: [[0.0; LANES]; 3],
    direction: [[0.0; LANES]; 3],
    begin: [0.0; LANES],
    end: [f32::NEG_INFINITY; LANES],
    slot: [u32::MAX; LANES],
    own: [u32::MAX; LANES],
};

/// Up to 128 rays, and the intervals that hold all of their origins and directions.
pub(super) struct Packet {
    blocks: [Block; 16],
    count: usize,
    low: [Vec3A; 2],
    high: [Vec3A; 2],
    /// The largest end of a ray.
    far: f32,
}

/// A ray of a packet.
#[derive(Clone, Copy)]
pub(super) struct PacketRay {
    pub origin: Vec3A,
    pub direction: Vec3A,
    pub begin: f32,
    pub end: f32,
    /// The triangle that it does not meet; `u32::MAX`: none.
    pub own: u32,
}

impl Default for Packet {
    fn default() -> Self {
        let (low, high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        Self { blocks: [NO_RAYS; 16], count: 0, low: [low; 2], high: [high; 2], far: f32::NEG_INFINITY }
    }
}

impl Packet {
    /// Takes all rays out.
    pub fn clear(&mut self) {
        (self.count, self.far) = (0, f32::NEG_INFINITY);
        (self.low, self.high) = ([Vec3A::INFINITY; 2], [Vec3A::NEG_INFINITY; 2]);
    }

    /// Adds a ray; 128 at most.
    pub fn add(&mut self, ray: PacketRay) {
        let (block, lane) = (&mut self.blocks[self.count / LANES], self.count % LANES);
        if lane == 0 {
            *block = NO_RAYS;
        }
        for axis in 0..3 {
            block.origin[axis][lane] = ray.origin[axis];
            block.direction[axis][lane] = ray.direction[axis];
        }
        (block.begin[lane], block.end[lane], block.own[lane]) = (ray.begin, ray.end, ray.own);
        self.low = [self.low[0].min(ray.origin), self.low[1].min(ray.direction)];
        self.high = [self.high[0].max(ray.origin), self.high[1].max(ray.direction)];
        self.far = self.far.max(ray.end);
        self.count += 1;
    }

    /// The leaf that ray `k` met, and where; `None` if it met none.
    pub fn met(&self, k: usize) -> Option<(u32, f32)> {
        let (block, lane) = (&self.blocks[k / LANES], k % LANES);
        (block.slot[lane] != u32::MAX).then_some((block.slot[lane], block.end[lane]))
    }

    /// Tests the triangle of a leaf: of each ray, the nearest stays; if `any` meets the rays that meet it look for nothing more.
    pub fn test(&mut self, leaf: &RtTriangle, slot: u32, triangle: u32, any: bool) {
        let mut met = false;
        for block in &mut self.blocks[..self.count.div_ceil(LANES)] {
            met |= block.test(leaf, slot, triangle, any);
        }
        if met {
            let ends = self.blocks[..self.count.div_ceil(LANES)].iter().flat_map(|block| block.end);
            self.far = ends.fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// Follows the rays through the tree.
    pub fn follow(&mut self, tree: &CwBvh, leaves: &[RtTriangle], triangles: &[u32], any: bool) {
        let slack = ROUNDING * (self.low[0].abs().max(self.high[0].abs()).max_element() + 2.0 * super::HALF as f32);
        let bounds =
            Bounds { origins: [self.low[0] - slack, self.high[0] + slack], speeds: [self.low[1], self.high[1]] };
        let mut state = tree.new_traversal((self.low[1] + self.high[1]) * 0.5);
        let mut node;
        obvhs::traverse!(tree, node, state, bounds.children(node, state.oct_inv4, self.far), {
            let slot = state.primitive_id;
            self.test(&leaves[slot as usize], slot, triangles[slot as usize], any);
        });
    }
}

impl Block {
    /// Moeller and Trumbore (1997) as `obvhs` has it, for eight rays; whether one of them meets the triangle.
    fn test(&mut self, leaf: &RtTriangle, slot: u32, triangle: u32, any: bool) -> bool {
        let [v0, e1, e2, ng] = [leaf.v0, leaf.e1, leaf.e2, leaf.ng].map(|v| v.to_array());
        let mut met = [0u32; LANES];
        let mut at = [0.0f32; LANES];
        for k in 0..LANES {
            let d = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];
            let c = [v0[0] - self.origin[0][k], v0[1] - self.origin[1][k], v0[2] - self.origin[2][k]];
            let r = [d[1] * c[2] - d[2] * c[1], d[2] * c[0] - d[0] * c[2], d[0] * c[1] - d[1] * c[0]];
            let inverse = 1.0 / (ng[0] * d[0] + ng[1] * d[1] + ng[2] * d[2]);
            let u = (r[0] * e2[0] + r[1] * e2[1] + r[2] * e2[2]) * inverse;
            let v = (r[0] * e1[0] + r[1] * e1[1] + r[2] * e1[2]) * inverse;
            let t = (ng[0] * c[0] + ng[1] * c[1] + ng[2] * c[2]) * inverse;
            let inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0);
            let yes = inside & (t >= self.begin[k]) & (t <= self.end[k]) & (self.own[k] != triangle);
            met[k] = u32::from(yes);
            at[k] = t;
        }
        if met.iter().fold(0, |a, b| a | b) == 0 {
            return false;
        }
        for k in 0..LANES {
            if met[k] != 0 {
                self.end[k] = if any { f32::NEG_INFINITY } else { at[k] };
                self.slot[k] = slot;
            }
        }
        true
    }
}

/// Lowest and highest origin and direction of the rays of a packet.
struct Bounds {
    origins: [Vec3A; 2],
    speeds: [Vec3A; 2],
}

impl Bounds {
    /// The children of a node that rays may meet before `far`, as the walk of `obvhs` takes them.
    fn children(&self, node: &CwBvhNode, octant: u32, far: f32) -> u32 {
        let (extent, place) = (node.compute_extent(), Vec3A::from(node.p));
        let sides = [
            (&node.child_min_x, &node.child_max_x),
            (&node.child_min_y, &node.child_max_y),
            (&node.child_min_z, &node.child_max_z),
        ];
        let (mut enter, mut leave) = ([0.0f32; 8], [far; 8]);
        for (axis, (lows, highs)) in sides.into_iter().enumerate() {
            let (least, most) = (self.speeds[0][axis], self.speeds[1][axis]);
            if least <= 0.0 && most >= 0.0 {
                continue;
            }
            let ahead = least > 0.0;
            // Of the sizes of the speeds, the inverses of the largest and the least.
            let (quick, slow) = if ahead { (1.0 / most, 1.0 / least) } else { (-1.0 / least, -1.0 / most) };
            let (low, high) = (self.origins[0][axis], self.origins[1][axis]);
            for k in 0..8 {
                let from = f32::from(lows[k]) * extent[axis] + place[axis];
                let to = f32::from(highs[k]) * extent[axis] + place[axis];
                let (near, end) = if ahead { (from - high, to - low) } else { (low - to, high - from) };
                enter[k] = enter[k].max(near * if near >= 0.0 { quick } else { slow });
                leave[k] = leave[k].min(end * if end >= 0.0 { slow } else { quick });
            }
        }
        let (bits, index) = node.get_child_and_index_bits(octant);
        (0..8).filter(|&k| enter[k] <= leave[k]).fold(0, |hits, k| {
            // The largest shift is 31: 24 and a place among eight.
            hits | extract_byte64(bits, k) << extract_byte64(index, k)
        })
    }
}
