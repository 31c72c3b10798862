// caster_positions: takes the positions of the casters from a vertex buffer that the application rewrites.
// Reads `vertices` (position i in three words from word `offset + i * stride`) and `places` (two words a
// vertex: its place among the casters' vertices, NO_PLACE where no triangle uses it; and the vertex which
// that place takes its position from). Writes `positions` (16 bytes a place, three words of them, -0 as +0),
// by a homography if there is one. Counts into `faults` the places that lie outside the box or are no number,
// which are moved into it, and the vertices that are not where the vertex of their place is.

//@import dispatch finite within_box homography

const WORKGROUP = 64u;
const NO_PLACE = 0xffffffffu;
const FAULT_OUTSIDE = 0u;
const FAULT_PARTED = 1u;

struct CasterPositionsParams {
    box_low: vec3<f32>,
    count: u32,
    box_high: vec3<f32>,
    offset: u32,
    stride: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    homography: Homography,
}

@group(0) @binding(0) var<uniform> params: CasterPositionsParams;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> places: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec3<f32>>;
@group(0) @binding(4) var<storage, read_write> faults: array<atomic<u32>>;

fn word(at: u32) -> u32 {
    let bits = vertices[at];
    return select(bits, 0u, bits == 0x80000000u);
}

// Bits of a position, so that two that are no numbers compare as well.
fn taken(v: u32) -> vec3<u32> {
    let at = params.offset + v * params.stride;
    return vec3(word(at), word(at + 1u), word(at + 2u));
}

@compute @workgroup_size(WORKGROUP)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let v = flat_invocation(group, groups, WORKGROUP, local);
    if v >= params.count { return; }
    let place = places[v].x;
    if place == NO_PLACE { return; }
    let bits = taken(v);
    if any(bits != taken(places[v].y)) { atomicAdd(&faults[FAULT_PARTED], 1u); }
    if places[v].y != v { return; }
    let p = mapped(params.homography, bitcast<vec3<f32>>(bits));
    let moved = bitcast<vec3<u32>>(p);
    for (var k = 0u; k < 3u; k++) {
        let bits = select(moved[k], 0u, moved[k] == 0x80000000u);
        positions[place][k] = within(bits, params.box_low[k], params.box_high[k]);
    }
    if !(all_finite(p) && all(p >= params.box_low) && all(p <= params.box_high)) {
        atomicAdd(&faults[FAULT_OUTSIDE], 1u);
    }
}
