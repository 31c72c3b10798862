// camera_visibility_64: camera_visibility on devices with 64-bit atomics: depth and triangle are one key, so that one run is enough.

//@import frame
//@import dispatch
//@import camera_raster

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys: array<atomic<u64>>;
@group(0) @binding(7) var<storage, read_write> id_keys: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let seen = seen_in(item);
    for (var y = seen.block.low.y; y <= seen.block.high.y; y++) {
        let cells = pixels_of_row(seen, y);
        for (var x = cells.x; x <= cells.y; x++) {
            let key = key_at(seen, x, y);
            let pixel = y * frame.image_size.x + x;
            let whole = (u64(key) << 32u) | u64(~seen.t);
            if key != 0u && atomicLoad(&keys[pixel]) < whole { atomicMax(&keys[pixel], whole); }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn take(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel < arrayLength(&id_keys) { id_keys[pixel] = u32(atomicLoad(&keys[pixel])); }
}
