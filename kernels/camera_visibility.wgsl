// camera_visibility: the nearest triangle at every pixel centre, by compute rasterization of 8 x 8 blocks.
// Two runs of the same entry point: pass 0 finds the depth, pass 1 the lowest triangle index at that depth.
// Reads the blocks of each triangle (`work_offsets`, `camera_rects`). Writes `depth_keys` (complement of the bits of the
// view depth; 0 where nothing is seen) and `id_keys` (complement of the triangle; 0 where nothing is seen).
// Edge functions go through the eye, so nothing is clipped and nothing divided; each edge is evaluated from its lower
// vertex index, so both triangles at it get the same value, and a centre on it belongs to both.

//@import frame
//@import dispatch
//@import pass
//@import rect
//@import work_items
//@import span

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> depth_keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> id_keys: array<atomic<u32>>;

// Edge function through the eye as (at the corner ray, per pixel right, per pixel down).
fn edge(i: u32, j: u32) -> vec3<f32> {
    let low = min(i, j);
    let p = points[low].xyz;
    let m = cross(p, points[max(i, j)].xyz - p) * select(-1.0, 1.0, i == low);
    return vec3(dot(m, frame.ray_corner.xyz), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
}

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(camera_rects[t], item - work_offsets[t]);
    let i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
    let e0 = edge(i.x, i.y);
    let e1 = edge(i.y, i.z);
    let e2 = edge(i.z, i.x);
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    let normal = cross(b - a, c - a);
    let distance = dot(normal, a);
    let n = vec3(dot(normal, frame.ray_corner.xyz), dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz));
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    let nearest = max(min(depths.x, min(depths.y, depths.z)), frame.forward.w);
    let farthest = max(depths.x, max(depths.y, depths.z));
    // Which sign is inside; a triangle edge-on to the eye is looked at cell by cell.
    let turn = sign(distance);
    let known = abs(distance) > 1e-5 * length(normal) * farthest;
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(frame.first_row + y) + 0.5;
        var cut = span_of(block.low.x, block.high.x);
        if known {
            cut = cut_span(cut_span(cut_span(cut, turn * e0.yzx, row), turn * e1.yzx, row), turn * e2.yzx, row);
        }
        let cells = cells_of(cut, block.low.x, block.high.x);
        for (var x = cells.x; x <= cells.y; x++) {
            let at = vec3(1.0, f32(x) + 0.5, row);
            let v = vec3(dot(e0, at), dot(e1, at), dot(e2, at));
            if !(all(v >= vec3(0.0)) || all(v <= vec3(0.0))) { continue; }
            let raw = distance / dot(n, at);
            if !(raw >= frame.forward.w) { continue; }
            // A sliver's plane is poorly known; its depth lies between its corners'.
            let depth = clamp(raw, nearest, farthest);
            let key = ~bitcast<u32>(depth);
            let pixel = y * frame.image_size.x + x;
            if step.index == 0u {
                if atomicLoad(&depth_keys[pixel]) < key { atomicMax(&depth_keys[pixel], key); }
            } else if atomicLoad(&depth_keys[pixel]) == key {
                atomicMax(&id_keys[pixel], ~t);
            }
        }
    }
}
