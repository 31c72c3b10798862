// warped_casters: the nearest caster at the centre of every texel of a map whose axes are warped (`axes`,
// `borders`; see axis_table), by curved rasterization: triangles stay flat, and texels' centres lie where the
// warp puts them. `count` writes the warped texels whose centres the box of each triangle holds
// (`warped_rects`), a box again since the warp is of either axis by itself, and how many 8 x 8 blocks they
// touch (`warped_items`). `raster` goes through the blocks and raises in `keys` (complement of the bits of
// the depth) the texels whose centres the triangle covers. The sample rule is that of light_layers.

//@import frame dispatch rect work_items flat_caster block_bits hole front_fan axis_table

const WORKGROUP = 64u;
const CUT_GUARD = 0.001953125;  // texels of the map

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> axes: array<u32>;
@group(0) @binding(5) var<storage, read> borders: array<f32>;
@group(0) @binding(6) var<storage, read_write> warped_rects: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> warped_items: array<u32>;
@group(0) @binding(8) var<storage, read> boxes: array<vec2<u32>>;  // warped_rects
@group(0) @binding(9) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(10) var<storage, read_write> keys: array<atomic<u32>>;

//@import frame_copy

// The middle of a warped texel, in texels of the map.
fn centre_of(axis: u32, texel: u32) -> f32 {
    return 0.5 * (border_of(axis, texel) + border_of(axis, texel + 1u));
}

// The warped texels of an axis, from x to y, whose centres lie from `low` to `high`; none where x exceeds y.
fn centres_between(axis: u32, low: f32, high: f32) -> vec2<u32> {
    let side = f32(frame.map_size);
    var found = vec2(0u, frame.map_size - 1u);
    if low > 0.0 {
        found.x = warped_texel(axis, low);
        found.x += select(0u, 1u, centre_of(axis, found.x) < low);
    }
    if high < side {
        found.y = warped_texel(axis, high);
        // The first may be left out: then there is none.
        if centre_of(axis, found.y) > high {
            if found.y == 0u { return vec2(1u, 0u); }
            found.y -= 1u;
        }
    }
    return found;
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let t = flat_invocation(group, groups, WORKGROUP, local);
    if t >= frame.triangle_count { return; }
    warped_rects[t] = EMPTY_RECT;
    warped_items[t] = 0u;
    if is_empty(light_rects[t]) { return; }
    let a = map_points[triangles[t].x];
    let b = map_points[triangles[t].y];
    let c = map_points[triangles[t].z];
    let side = f32(frame.map_size);
    var low = vec2(0.0);
    var high = vec2(side);
    if min(a.w, min(b.w, c.w)) > 0.0 {
        low = min(min(a.xy, b.xy), c.xy);
        high = max(max(a.xy, b.xy), c.xy);
        let slack = CUT_GUARD + 1e-6 * max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
        low -= slack;
        high += slack;
    }
    if any(high < vec2(0.0)) || any(low >= vec2(side)) { return; }
    let across = centres_between(0u, low.x, high.x);
    let down = centres_between(1u, low.y, high.y);
    if across.x > across.y || down.x > down.y { return; }
    let rect = pack_rect(Rect(vec2(across.x, down.x), vec2(across.y, down.y)));
    warped_rects[t] = rect;
    warped_items[t] = block_count(rect);
}

// The part of a span of places along x where edge.x * x + edge.y * row + edge.z >= 0, a little more.
fn cut_places(span: vec2<f32>, edge: vec3<f32>, row: f32) -> vec2<f32> {
    let rest = edge.y * row + edge.z;
    let at = -rest / edge.x;
    // Rounding of the rest moves the place by as much as the edge runs along the row.
    let slack = CUT_GUARD + 2e-6 * (abs(edge.y * row) + abs(edge.z)) / abs(edge.x);
    if edge.x > 0.0 { return vec2(max(span.x, at - slack), span.y); }
    if edge.x < 0.0 { return vec2(span.x, min(span.y, at + slack)); }
    return span;
}

// Puts the depths of a triangle into the texels of a block, whose columns have these centres.
fn cover(f: FlatCaster, block: Rect, columns: ptr<function, array<f32, BLOCK>>, given: vec4<u32>) {
    let corner = block.low & vec2(~7u);
    var left = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = centre_of(1u, y);
        var span = vec2(-BEYOND, BEYOND);
        span = cut_places(cut_places(cut_places(span, f.cut_ab, row), f.cut_bc, row), f.cut_ca, row);
        for (var x = block.low.x; x <= block.high.x; x++) {
            let at = (*columns)[x & 7u];
            if at >= span.x && at <= span.y { add_texel(&left, vec2(x, y) & vec2(7u)); }
        }
    }
    while any(left != vec2(0u)) {
        let cell = take_texel(&left);
        let texel = corner + cell;
        let at = vec2((*columns)[cell.x], centre_of(1u, texel.y));
        let key = key_at(f, at);
        if key == 0u || is_hole(given, at) { continue; }
        let word = texel.y * frame.map_size + texel.x;
        if atomicLoad(&keys[word]) < key { atomicMax(&keys[word], key); }
    }
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
    let t = slot_of(item, frame.triangle_count);
    let block = block_of(boxes[t], item - work_offsets[t]);
    var columns = array<f32, BLOCK>();
    for (var x = block.low.x; x <= block.high.x; x++) { columns[x & 7u] = centre_of(0u, x); }
    let given = triangles[t];
    var i = given.xyz;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let fan = fan_of(map_points[i.x], map_points[i.y], map_points[i.z]);
    let guarded = max(CUT_GUARD, 4e-7 * fan.extent);
    var side_a = fan.side_a;
    var side_b = fan.side_b;
    for (var k = 0u; k < fan.parts; k++) {
        cover(flat_caster(fan.middle, side_a, side_b, guarded), block, &columns, given);
        side_a = side_b;
        side_b = fan.last;
    }
}
