// light_layers: the nearest and the second nearest caster at every texel centre, seen from the light.
// Of the depths that come to a texel the largest key stays in `nearest_keys`, and each that is beaten, or
// that is put out by a larger one, goes on to `second_keys`: all but one of the largest are seen there, in
// whatever order they come. Where two casters are equally near, both hold the same key. Marks in `mask` every
// texel of which an edge passes within CENTRE_GUARD of the centre. Triangles that are no casters
// (FLAG_CULL_BACK) are left out. Writes `nearest_keys`, `second_keys` (complement of the bits of the depth; 0
// where there is none), `mask` (one bit a texel, rows padded to 32). Depths are conservative nowhere:
// front_layer checks what is built on them.

//@import frame dispatch rect work_items front_split span block_bits facing

const WORKGROUP = 64u;
const CENTRE_GUARD = 0.001953125;  // texels; far above the rounding of an edge function

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(5) var<storage, read_write> nearest_keys: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> second_keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> mask: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> facing: array<u32>;

//@import frame_copy

override BOTH: u32 = 1u;  // 0: the nearest alone, and no marks

fn mark(x: u32, y: u32) {
    let word = y * ((frame.map_size + 31u) / 32u) + x / 32u;
    atomicOr(&mask[word], 1u << (x % 32u));
}

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[t]);
    // Vertices in order of index, so that an edge has one value in both of its triangles.
    let given = triangles[t];
    if is_culled(given.w, facing[t]) { return; }
    var i = given.xyz;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    if a.w <= 0.0 || b.w <= 0.0 || c.w <= 0.0 { return; }  // front_layer marks every texel of it
    let ab = b.xy - a.xy;
    let bc = c.xy - b.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let nearest = min(a.z, min(b.z, c.z));
    let farthest = max(a.z, max(b.z, c.z));
    let guard = CENTRE_GUARD * vec3(abs(ab.x) + abs(ab.y), abs(bc.x) + abs(bc.y), abs(ac.x) + abs(ac.y));
    let turn = select(-1.0, 1.0, area > 0.0);
    // The edges again, grown by the guard, to cut rows by.
    let cut_ab = vec3(turn * vec2(-ab.y, ab.x), turn * (ab.y * a.x - ab.x * a.y) + guard.x);
    let cut_bc = vec3(turn * vec2(-bc.y, bc.x), turn * (bc.y * b.x - bc.x * b.y) + guard.y);
    let cut_ca = vec3(turn * vec2(ac.y, -ac.x), turn * (ac.x * a.y - ac.y * a.x) + guard.z);
    // Cells where the triangle may be; then they alone, one after another: lanes of a vector wait for the
    // fullest block, not for the fullest of each row.
    let corner = block.low & vec2(~7u);
    var left = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        let cut = cut_span(cut_span(cut_span(span_of(block.low.x, block.high.x), cut_ab, row), cut_bc, row), cut_ca, row);
        add_cells(&left, y, cells_of(cut, block.low.x, block.high.x));
    }
    while any(left != vec2(0u)) {
        let cell = corner + take_texel(&left);
        let at = vec2<f32>(cell) + 0.5;
        let pa = at - a.xy;
        let pb = at - b.xy;
        let v = turn * vec3(ab.x * pa.y - ab.y * pa.x, bc.x * pb.y - bc.y * pb.x, ac.y * pa.x - ac.x * pa.y);
        if any(v < -guard) { continue; }
        if BOTH != 0u && any(v <= guard) { mark(cell.x, cell.y); }
        if any(v < vec3(0.0)) { continue; }
        var depth = a.z;
        if area != 0.0 {
            depth = clamp(a.z + ((b.z - a.z) * v.z + (c.z - a.z) * v.x) / abs(area), nearest, farthest);
        }
        let key = key_of_depth(depth);
        let texel = cell.y * frame.map_size + cell.x;
        var beaten = key;
        if atomicLoad(&nearest_keys[texel]) < key { beaten = min(atomicMax(&nearest_keys[texel], key), key); }
        if BOTH != 0u && atomicLoad(&second_keys[texel]) < beaten { atomicMax(&second_keys[texel], beaten); }
    }
}
