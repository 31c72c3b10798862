// instance_positions: places the vertices of instances by their transforms.
// Reads `sources` (two words a place: vertex of the meshes, instance), `vertices` (of all meshes, 16 bytes
// each) and `transforms`: from word `offset` on 12 words an instance, three rows of a matrix whose fourth
// column is added. Writes `positions` (16 bytes a place, three words of them, -0 as +0), by a homography if
// there is one. Counts into `faults` the places that lie outside the box or are no number, which are moved
// into it.

//@import dispatch within_box homography

const WORKGROUP = 64u;
const FAULT_OUTSIDE = 0u;

struct InstancePositionsParams {
    box_low: vec3<f32>,
    count: u32,
    box_high: vec3<f32>,
    offset: u32,
    homography: Homography,
}

@group(0) @binding(0) var<uniform> params: InstancePositionsParams;
@group(0) @binding(1) var<storage, read> sources: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> transforms: array<u32>;
@group(0) @binding(4) var<storage, read_write> positions: array<vec3<f32>>;
@group(0) @binding(5) var<storage, read_write> faults: array<atomic<u32>>;

fn row(at: u32) -> vec4<f32> {
    let bits = vec4(transforms[at], transforms[at + 1u], transforms[at + 2u], transforms[at + 3u]);
    return bitcast<vec4<f32>>(bits);
}

@compute @workgroup_size(WORKGROUP)
fn transform(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let place = flat_invocation(group, groups, WORKGROUP, local);
    if place >= params.count { return; }
    let source = sources[place];
    let p = vec4(vertices[source.x].xyz, 1.0);
    let first = params.offset + 12u * source.y;
    let turned = vec3(dot(row(first), p), dot(row(first + 4u), p), dot(row(first + 8u), p));
    let moved = bitcast<vec3<u32>>(mapped(params.homography, turned));
    var outside = false;
    for (var k = 0u; k < 3u; k++) {
        let bits = select(moved[k], 0u, moved[k] == 0x80000000u);
        let kept = within(bits, params.box_low[k], params.box_high[k]);
        outside = outside || bitcast<u32>(kept) != bits;
        positions[place][k] = kept;
    }
    if outside { atomicAdd(&faults[FAULT_OUTSIDE], 1u); }
}
