// The tree of casters: eight children a node, their boxes in 8 bits (Ylitie, Karras, Laine 2017), in the unit
// cube. A node is five vectors as `obvhs` lays them out: corner, three exponents and the mask of inner
// children; first child, first triangle, a byte for each child; then the low and high planes of the children
// along x, y and z.

//@import facing
//@needs var<uniform> tree: TreePlace;
//@needs var<storage, read> nodes: array<vec4<u32>>;

struct TreePlace {
    place: vec4<f32>,  // a point p of the frame is p * place.w + place.xyz in the cube
    slack: f32,        // what rounding may move a point by there
    node_count: u32,
    pad_0: u32,
    pad_1: u32,
}

const STACK = 24u;         // levels of a tree at most
// Nodes and triangles that one walk looks at: software adapters stop loops soon after
const MOST_STEPS = 60000u;
const INNER = 0xff000000u; // the part of a group that stands for nodes

// A ray, as boxes are tested against it.
struct Walk {
    start: vec3<f32>,
    inverse: vec3<f32>,
    margin: vec3<f32>,  // slack, measured along the ray, for each axis
    end: f32,
    octant: u32,        // 7 less the octant the ray points to: children are met from near to far
}

// The segment from a point of the frame along `to`, where it ends unless it is `endless`, and what lies
// within `slack` of it (in the cube, along each axis).
fn walk_of(point: vec3<f32>, to: vec3<f32>, endless: bool, slack: f32) -> Walk {
    let longest = largest(to);
    // A component of nothing is made one of next to nothing, which moves the ray by less than the slack.
    let d = to / longest;
    let least = vec3(1e-8);
    let direction = select(d, select(least, -least, d < vec3(0.0)), abs(d) < least);
    var w: Walk;
    w.start = point * tree.place.w + tree.place.xyz;
    w.inverse = 1.0 / direction;
    w.margin = slack * abs(w.inverse);
    w.end = select(longest * tree.place.w * 1.0001 + slack, 3.0e38, endless);
    let forward = direction >= vec3(0.0);
    w.octant = select(0u, 4u, forward.x) | select(0u, 2u, forward.y) | select(0u, 1u, forward.z);
    return w;
}

fn bytes_of(word: u32) -> vec4<f32> {
    return vec4<f32>((vec4(word) >> vec4(0u, 8u, 16u, 24u)) & vec4(255u));
}

// Sizes of a node's steps along the axes.
fn steps_of(n: vec4<u32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(((n.www >> vec3(0u, 8u, 16u)) & vec3(255u)) << vec3(23u));
}

// Where children show in a group: inner ones in its highest byte, by the order to be met in; triangles in the
// lower bits.
fn group_bits(kinds: u32, octant: u32, hit: vec4<bool>) -> u32 {
    let inner = (kinds & (kinds << 1u)) & 0x10101010u;
    let place = (kinds ^ ((octant * 0x01010101u) & ((inner >> 4u) * 0xffu))) & 0x1f1f1f1fu;
    let each = vec4(0u, 8u, 16u, 24u);
    let bits = (((vec4(kinds) >> each) & vec4(255u)) >> vec4(5u)) << ((vec4(place) >> each) & vec4(31u));
    let kept = select(vec4(0u), bits, hit);
    return kept.x | kept.y | kept.z | kept.w;
}

// The group of four children's bits that a ray meets; planes nearer and farther along the ray are given for
// each axis.
fn met_four(
    kinds: u32,
    octant: u32,
    near: vec3<u32>,
    far: vec3<u32>,
    step: vec3<f32>,
    low: vec3<f32>,
    high: vec3<f32>,
    end: f32,
) -> u32 {
    let x0 = bytes_of(near.x) * step.x + low.x;
    let y0 = bytes_of(near.y) * step.y + low.y;
    let z0 = bytes_of(near.z) * step.z + low.z;
    let x1 = bytes_of(far.x) * step.x + high.x;
    let y1 = bytes_of(far.y) * step.y + high.y;
    let z1 = bytes_of(far.z) * step.z + high.z;
    let enter = max(max(x0, y0), max(z0, vec4(0.0)));
    let leave = min(min(x1, y1), min(z1, vec4(end)));
    return group_bits(kinds, octant, enter <= leave);
}

// Parts of a node that a ray meets: first child and group of nodes, first triangle and group of triangles.
fn met_by(w: Walk, at: u32) -> vec4<u32> {
    let n0 = nodes[5u * at];
    let n1 = nodes[5u * at + 1u];
    let nx = nodes[5u * at + 2u];
    let ny = nodes[5u * at + 3u];
    let nz = nodes[5u * at + 4u];
    let step = steps_of(n0) * w.inverse;
    let corner = (bitcast<vec3<f32>>(n0.xyz) - w.start) * w.inverse;
    // The nearer planes are the low ones along an axis on which the ray goes forward.
    let x = select(nx.zwxy, nx, (w.octant & 4u) != 0u);
    let y = select(ny.zwxy, ny, (w.octant & 2u) != 0u);
    let z = select(nz.zwxy, nz, (w.octant & 1u) != 0u);
    let low = corner - w.margin;
    let high = corner + w.margin;
    let met = met_four(n1.z, w.octant, vec3(x.x, y.x, z.x), vec3(x.z, y.z, z.z), step, low, high, w.end)
        | met_four(n1.w, w.octant, vec3(x.y, y.y, z.y), vec3(x.w, y.w, z.w), step, low, high, w.end);
    return vec4(n1.x, (met & INNER) | (n0.w >> 24u), n1.y, met & ~INNER);
}

// The node of a group that comes next.
fn next_node(group: vec2<u32>, octant: u32) -> u32 {
    let slot = (firstLeadingBit(group.y) - 24u) ^ octant;
    return group.x + countOneBits(group.y & 0xffu & ~(0xffffffffu << slot));
}

fn without_next(bits: u32) -> u32 {
    return bits & ~(1u << firstLeadingBit(bits));
}
