// light_layers: the nearest and the second nearest caster at every texel centre, seen from the light.
// Of the depths that come to a texel the largest key stays in `nearest_keys`, and each that is beaten, or
// that is put out by a larger one, goes on to `second_keys`: all but one of the largest are seen there, in
// whatever order they come. Where two casters are equally near, both hold the same key. Marks in `mask` every
// texel of which an edge passes within CENTRE_GUARD of the centre. Triangles that are no casters
// (FLAG_CULL_BACK) are left out. Of those that are not wholly in front of the light `raster_cut` takes what
// they surely cover, without marks: front_layer marks what else they touch. `raster_nearest` takes the part
// that is in front: there marks need not make up for them. Alpha-tested ones, behind
// which not all is in shadow, it takes where they are solid at a centre; for two layers they are none. Writes
// `nearest_keys`, `second_keys` (complement of the bits of the depth; 0 where there is none), `mask` (one bit
// a texel, rows padded to 32). Depths are conservative nowhere: front_layer checks what is built on them.
// Without MARKS they are for shadow maps: `raster_nearest` keeps no depth twice, or with NEAREST_TRIANGLE the
// complement of the triangle of the nearest depth in `second_keys`. That takes two runs, those keys 0 before
// each: in the second all depths are known.
//@bindings Blocks: raster, raster_cut, raster_nearest

//@import frame dispatch rect work_items front_split span block_bits facing alpha hole
//@import front_fan cover_cells

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

override LAYERS: u32 = 2u;  // 1: the nearest alone
const NEAREST_TRIANGLE = 3u; // LAYERS: the nearest and its triangle, the lowest of several
override MARKS: u32 = 1u;   // 0: no marks, alpha-tested casters where they are solid, equal depths once

fn mark(x: u32, y: u32) {
    let word = y * ((frame.map_size + 31u) / 32u) + x / 32u;
    atomicOr(&mask[word], 1u << (x % 32u));
}

// Puts a depth of triangle `t` into a texel.
fn put(cell: vec2<u32>, key: u32, t: u32) {
    let texel = cell.y * frame.map_size + cell.x;
    var beaten = key;
    var other = atomicLoad(&nearest_keys[texel]);
    if other < key {
        other = atomicMax(&nearest_keys[texel], key);
        beaten = min(other, key);
    }
    if LAYERS == NEAREST_TRIANGLE {
        if other <= key { atomicMax(&second_keys[texel], ~t); }
        return;
    }
    // Of marked layers the same depth twice is a tie that front_layer must see; else it is one surface.
    if LAYERS == 1u || (MARKS == 0u && other == key) { return; }
    if atomicLoad(&second_keys[texel]) < beaten { atomicMax(&second_keys[texel], beaten); }
}

// Puts the depths of a triangle into the texels of a block; `guarded`: texels by which its edges may be off;
// `given`: the whole triangle `t`, of which it may be a part.
fn cover(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, block: Rect, guarded: f32, given: vec4<u32>, t: u32) {
    let ab = b.xy - a.xy;
    let bc = c.xy - b.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let nearest = min(a.z, min(b.z, c.z));
    let farthest = max(a.z, max(b.z, c.z));
    let guard = guarded * vec3(abs(ab.x) + abs(ab.y), abs(bc.x) + abs(bc.y), abs(ac.x) + abs(ac.y));
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
        let cut = cut_span(cut_span(cut_span(span_of(block.low.x, block.high.x), cut_ab, row), cut_bc, row),
            cut_ca, row);
        add_cells(&left, y, cells_of(cut, block.low.x, block.high.x));
    }
    while any(left != vec2(0u)) {
        let cell = corner + take_texel(&left);
        let at = vec2<f32>(cell) + 0.5;
        let pa = at - a.xy;
        let pb = at - b.xy;
        let v = turn * vec3(ab.x * pa.y - ab.y * pa.x, bc.x * pb.y - bc.y * pb.x, ac.y * pa.x - ac.x * pa.y);
        if any(v < -guard) { continue; }
        if MARKS != 0u && any(v <= guard) { mark(cell.x, cell.y); }
        if any(v < vec3(0.0)) || is_hole(given, at) { continue; }
        var depth = a.z;
        if area != 0.0 {
            depth = clamp(a.z + ((b.z - a.z) * v.z + (c.z - a.z) * v.x) / abs(area), nearest, farthest);
        }
        put(cell, key_of_depth(depth), t);
    }
}

// A block of a caster; none: `some` is false.
struct Task {
    some: bool,
    t: u32,
    given: vec4<u32>,
    block: Rect,
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
}

fn task_of(item: u32) -> Task {
    var task: Task;
    if item >= work_offsets[frame.triangle_count] { return task; }
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    let given = triangles[t];
    if is_culled(frame.flags, given.w, facing[t]) || (MARKS != 0u && is_tested(given.w)) { return task; }
    // Vertices in order of index, so that an edge has one value in both of its triangles.
    var i = given.xyz;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let block = block_of(light_rects[t], item - work_offsets[slot]);
    return Task(true, t, given, block, map_points[i.x], map_points[i.y], map_points[i.z]);
}

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let task = task_of(flat_invocation(group, groups, WORKGROUP, local));
    if !task.some || min(task.a.w, min(task.b.w, task.c.w)) <= 0.0 { return; }
    cover(task.a, task.b, task.c, task.block, CENTRE_GUARD, task.given, task.t);
}

@compute @workgroup_size(WORKGROUP)
fn raster_cut(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    if (frame.flags & FLAG_PERSPECTIVE) == 0u { return; }
    let task = task_of(flat_invocation(group, groups, WORKGROUP, local));
    if !task.some || min(task.a.w, min(task.b.w, task.c.w)) > 0.0 { return; }
    let shape = cover_triangle(task.a, task.b, task.c);
    let corner = task.block.low & vec2(~7u);
    var left = cover_cells(shape, task.block, 0xffu);
    while any(left != vec2(0u)) {
        let cell = corner + take_texel(&left);
        let centre = vec2<f32>(cell) + 0.5;
        if shape.cut && holds(shape, centre, 0.75) {
            put(cell, key_of_depth(dot(shape.depth, vec3(centre, 1.0))), task.t);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn raster_nearest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let task = task_of(flat_invocation(group, groups, WORKGROUP, local));
    if !task.some { return; }
    let fan = fan_of(task.a, task.b, task.c);
    let guarded = max(CENTRE_GUARD, 4e-7 * fan.extent);
    var side_a = fan.side_a;
    var side_b = fan.side_b;
    for (var k = 0u; k < fan.parts; k++) {
        cover(fan.middle, side_a, side_b, task.block, guarded, task.given, task.t);
        side_a = side_b;
        side_b = fan.last;
    }
}
