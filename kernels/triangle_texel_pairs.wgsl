// triangle_texel_pairs: lists, texel by texel, the casters that touch a texel with pixel-texel pairs (Pan 2009, section
// 3.3). `count` counts into `texel_counts`; after a scan `emit` and `emit_rest` write the triangles to `pair_triangles` at
// `pair_offsets`, never beyond the capacity; order inside a texel is not defined. The texels of the first `step.index` blocks
// are kept in `touched` from counting to emitting, those of the rest are found anew.
// Instead of all three, `append` lists the pairs as they come: texels in `keys`, triangles in `values`, their number in
// `appended`, to be sorted (the paper's way).
// A caster that lies behind the farthest facet of the texel makes no pair.

//@import frame
//@import dispatch
//@import pass
//@import work_items
//@import cover_cells
//@import append

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> texel_deepest: array<u32>;
@group(0) @binding(7) var<storage, read_write> texel_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> pair_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> pair_triangles: array<u32>;
@group(0) @binding(10) var<storage, read_write> appended: array<atomic<u32>>;  // pairs appended; not 0 if more than 2^32
@group(0) @binding(11) var<storage, read_write> keys: array<u32>;
@group(0) @binding(12) var<storage, read_write> values: array<u32>;
@group(0) @binding(13) var<storage, read_write> touched: array<vec2<u32>>;

// A caster and a block of texels; beyond the last, NO_TRIANGLE for the caster.
struct Item { triangle: u32, block: Rect }

fn item_of(item: u32) -> Item {
    if item >= work_offsets[frame.triangle_count] { return Item(NO_TRIANGLE, Rect()); }
    let t = owner_of(item, frame.triangle_count);
    return Item(t, block_of(light_rects[t], item - work_offsets[t]));
}

// The texels of the block, one bit each row by row, that make a pair with triangle `t`.
fn texels_of(t: u32, block: Rect) -> vec2<u32> {
    var texels = vec2(0u);
    let across = (frame.map_size + BLOCK - 1u) / BLOCK;
    let b = (block.low.y >> BLOCK_SHIFT) * across + (block.low.x >> BLOCK_SHIFT);
    if texel_deepest[frame.map_size * frame.map_size + b] == 0u { return texels; }
    let shape = cover_triangle(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]]);
    let corner = block.low & vec2(~7u);
    var left = cover_cells(shape, block, 0xffu);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let cell = corner + place;
        let deepest = texel_deepest[cell.y * frame.map_size + cell.x];
        let centre = vec2<f32>(cell) + 0.5;
        if deepest == 0u || !covers(shape, centre) { continue; }
        if shape.in_front && depth_range(shape, centre).x - frame.depth_margin > bitcast<f32>(deepest - 1u) { continue; }
        add_texel(&texels, place);
    }
    return texels;
}

// `anew`: `emit_rest` is compiled for itself and may round otherwise than `count` did, so it stays within what was counted.
fn write_pairs(item: Item, found: vec2<u32>, anew: bool) {
    var texels = found;
    while any(texels != vec2(0u)) {
        let at = (item.block.low & vec2(~7u)) + take_texel(&texels);
        let texel = at.y * frame.map_size + at.x;
        let place = pair_offsets[texel] + atomicAdd(&texel_counts[texel], 1u);
        if anew && place >= pair_offsets[texel + 1u] { continue; }
        if place < frame.triangle_texel_capacity { pair_triangles[place] = item.triangle; }
    }
}

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let item = item_of(index);
    if item.triangle == NO_TRIANGLE { return; }
    var texels = texels_of(item.triangle, item.block);
    if index < step.index { touched[index] = texels; }
    while any(texels != vec2(0u)) {
        let at = (item.block.low & vec2(~7u)) + take_texel(&texels);
        atomicAdd(&texel_counts[at.y * frame.map_size + at.x], 1u);
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    if index >= step.index { return; }
    let item = item_of(index);
    if item.triangle != NO_TRIANGLE { write_pairs(item, touched[index], false); }
}

@compute @workgroup_size(WORKGROUP)
fn emit_rest(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = item_of(step.index + flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle != NO_TRIANGLE { write_pairs(item, texels_of(item.triangle, item.block), true); }
}

@compute @workgroup_size(WORKGROUP)
fn append(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = item_of(flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle == NO_TRIANGLE { return; }
    var texels = texels_of(item.triangle, item.block);
    var place = room_for(texels);
    while any(texels != vec2(0u)) {
        let at = (item.block.low & vec2(~7u)) + take_texel(&texels);
        if place < frame.triangle_texel_capacity {
            keys[place] = at.y * frame.map_size + at.x;
            values[place] = item.triangle;
        }
        place++;
    }
}
