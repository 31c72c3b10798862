// camera_visibility: the nearest triangle at every pixel centre, by compute rasterization of 8 x 8 blocks.
// `raster` raises the keys, with atomics of 32 bits in two runs: pass 0 finds the depth, pass 1 the lowest triangle index at that
// depth. `take` copies it.
// Reads the blocks of each triangle (`work_offsets`, `camera_rects`). Writes `keys` (of a pixel complement of the triangle, and
// complement of the bits of the view depth; 0 where nothing is seen), which must be 0 before, and the first as `id_keys`.

//@import frame
//@import dispatch
//@import pass
//@import keys
//@import camera_raster

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys: array<atomic<Key>>;
@group(0) @binding(7) var<storage, read_write> id_keys: array<u32>;

//@import frame_copy

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let seen = seen_in(item);
    for (var y = seen.block.low.y; y <= seen.block.high.y; y++) {
        let cells = pixels_of_row(seen, y);
        for (var x = cells.x; x <= cells.y; x++) {
            let pixel = y * frame.image_size.x + x;
            let key = key_at(seen, x, y);
            if key != 0u && held_depth(pixel) <= key { raise(pixel, key, seen.t, step.index != 0u); }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn take(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel < arrayLength(&id_keys) { id_keys[pixel] = held_triangle(pixel); }
}
