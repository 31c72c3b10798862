// spsm_map, for devices with 64-bit atomics: depth and triangle of a texel are one key, found in one run of
// `raster`.
//@bindings Map: raster, encode

//@import frame dispatch pass keys_64 spsm_raster spsm_encode

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(3) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(4) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> keys: array<atomic<Key>>;
@group(0) @binding(8) var<storage, read_write> upper_records: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read_write> lower_records: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read_write> seen: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let task = task_of(item);
    var left = may_win(task);
    while any(left != vec2(0u)) {
        let at = task.corner + take_texel(&left);
        raise(at.y * frame.map_size + at.x, key_of(least_at(task.shape, vec2<f32>(at) + 0.5)), task.t);
    }
}
