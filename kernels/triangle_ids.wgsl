// triangle_ids: the triangle at every pixel centre, from a texture of the application's.
// Reads `ids` (r32uint, a texel a pixel: a triangle as the application counts them, from `first`; `none`
// where it drew none) and `numbers` (the casters' number of each triangle of the application). Writes
// `id_keys` (complement of the casters' triangle, 0 where there is none), and counts into `faults` the texels
// that name no triangle, which count as none (of a strip of rows in those that are its own).

//@import frame dispatch divide strip

const WORKGROUP = 64u;
const FAULT_UNKNOWN = 2u;

struct TriangleIdsParams {
    first: u32,
    none: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> params: TriangleIdsParams;
@group(0) @binding(2) var ids: texture_2d<u32>;
@group(0) @binding(3) var<storage, read> numbers: array<u32>;
@group(0) @binding(4) var<storage, read_write> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> faults: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn take(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = place_in_strip(pixel);
    let id = textureLoad(ids, given_texel(at), 0).x;
    var key = 0u;
    if id != params.none {
        let given = id - params.first;
        if id >= params.first && given < frame.triangle_count {
            key = ~numbers[given];
        } else if is_own(at.y) {
            atomicAdd(&faults[FAULT_UNKNOWN], 1u);
        }
    }
    id_keys[pixel] = key;
}
