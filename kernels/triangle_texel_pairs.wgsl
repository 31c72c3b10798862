// triangle_texel_pairs: lists, place by place, the casters that touch a place with pixel-texel pairs (Pan
// 2009, section 3.3). A place is a texel, or a tile of 2 x 2 of them. `count` counts into `place_counts`;
// after a scan `emit` and `emit_rest` write the triangles to `pair_triangles` at `pair_offsets`, never beyond
// the capacity; order inside a place is not defined. Of a tile a word goes before the triangle: the cells of
// the tile that it may touch (tile_cells), and from bit 16 on its least depth there. The places of the first
// `step.index` blocks are kept in `touched` from counting to emitting, those of the rest are found anew.
// Instead of all three, `append` lists the pairs of texels as they come: texels in `keys`, triangles in
// `values`, their number in `appended`, to be sorted (the paper's way). A caster that lies behind the
// farthest facet of the place makes no pair. One that goes on beyond one of the ends of the map (FLAG_ENDS)
// makes one with every place there.
//@bindings Pairs: count, emit, emit_rest

//@import frame dispatch pass work_items cover_cells places tile_cells append map_ends

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> place_deepest: array<u32>;
@group(0) @binding(7) var<storage, read_write> place_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> pair_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> pair_triangles: array<u32>;
// Pairs appended; not 0 if more than 2^32
@group(0) @binding(10) var<storage, read_write> appended: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> keys: array<u32>;
@group(0) @binding(12) var<storage, read_write> values: array<u32>;
@group(0) @binding(13) var<storage, read_write> touched: array<vec2<u32>>;

//@import frame_copy

// A caster and a block of texels; beyond the last, NO_TRIANGLE for the caster.
struct Item { triangle: u32, block: Rect }

fn item_of(item: u32) -> Item {
    if item >= work_offsets[frame.triangle_count] { return Item(NO_TRIANGLE, Rect()); }
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    return Item(t, block_of(light_rects[t], item - work_offsets[slot]));
}

// The places of the block, in places.
fn places_of(block: Rect) -> Rect {
    return Rect(block.low >> vec2(TILE_SHIFT), block.high >> vec2(TILE_SHIFT));
}

// The triangle as places are asked for it, which are units of length.
fn cover_of(t: u32) -> Cover {
    let i = triangles[t];
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    if TILE_SHIFT == 0u { return cover_triangle(a, b, c); }
    let half = vec4(0.5, 0.5, 1.0, 1.0);
    return cover_triangle_by(half * a, half * b, half * c, 0.5 * frame.map_margin);
}

// No depth of the triangle in the place is less.
fn nearest_in(shape: Cover, at: vec2<u32>) -> f32 {
    return select(-3.0e38, depth_range(shape, vec2<f32>(at) + 0.5).x - frame.depth_margin, shape.in_front);
}

fn goes_beyond(t: u32) -> bool {
    let i = triangles[t];
    return ends_of_triangle(map_points[i.x], map_points[i.y], map_points[i.z]) != 0u;
}
fn is_at_end(place: vec2<u32>) -> bool { return ends_at(place, place, places_across()) != 0u; }

// The places of a block at the ends of the map, as bits.
fn places_at_end(places: Rect) -> vec2<u32> {
    var found = vec2(0u);
    for (var y = places.low.y; y <= places.high.y; y++) {
        for (var x = places.low.x; x <= places.high.x; x++) {
            if is_at_end(vec2(x, y)) { add_texel(&found, vec2(x, y) & vec2(7u)); }
        }
    }
    return found;
}

// The places of the block that make a pair with triangle `t`, one bit each, row by row of the 8 x 8 places
// they lie in.
fn shared_places(t: u32, block: Rect) -> vec2<u32> {
    var found = vec2(0u);
    if place_deepest[block_word(block.low)] == 0u { return found; }
    let shape = cover_of(t);
    let places = places_of(block);
    let corner = places.low & vec2(~7u);
    var left = cover_cells(shape, places, 0xffu);
    let beyond = goes_beyond(t);  // Few do: a loop that the others do not enter.
    for (var some = beyond && ends_at(places.low, places.high, places_across()) != 0u; some; some = false) {
        left |= places_at_end(places);
    }
    while any(left != vec2(0u)) {
        let at = take_texel(&left);
        let place = corner + at;
        let deepest = place_deepest[place_index(place)];
        let there = covers(shape, vec2<f32>(place) + 0.5)
            && nearest_in(shape, place) <= bitcast<f32>(deepest - 1u);
        if deepest == 0u || !(there || (beyond && is_at_end(place))) { continue; }
        add_texel(&found, at);
    }
    return found;
}

// The cells of a tile that the triangle may touch. Its edges are those of tiles, a cell's centre three
// eighths from them.
fn cells_in(s: Cover, tile: vec2<u32>) -> u32 {
    if !s.in_front { return 0xffffu; }
    let boxed = box_cells(tile, s.low + 0.5, s.high - 0.5);
    if s.thin { return boxed; }
    let x = vec3(s.edges[0].x, s.edges[1].x, s.edges[2].x);
    let y = vec3(s.edges[0].y, s.edges[1].y, s.edges[2].y);
    let at = vec3(vec2<f32>(tile) + 0.125, 1.0);
    let first = vec3(dot(s.edges[0], at), dot(s.edges[1], at), dot(s.edges[2], at))
        - 0.375 * (abs(x) + abs(y));
    var cells = 0u;
    for (var row = 0u; row < 4u; row++) {
        let e0 = first + (0.25 * f32(row)) * y;
        let e1 = e0 + 0.25 * x;
        let e2 = e0 + 0.5 * x;
        let e3 = e0 + 0.75 * x;
        let inside = vec4(
            min(e0.x, min(e0.y, e0.z)), min(e1.x, min(e1.y, e1.z)), min(e2.x, min(e2.y, e2.z)),
            min(e3.x, min(e3.y, e3.z)));
        let bits = select(vec4(0u), vec4(1u, 2u, 4u, 8u), inside >= vec4(0.0));
        cells |= (bits.x | bits.y | bits.z | bits.w) << (4u * row);
    }
    return cells & boxed;
}

// `anew`: `emit_rest` is compiled for itself and may round otherwise than `count` did, so it stays within
// what was counted.
fn write_pairs(item: Item, found: vec2<u32>, anew: bool) {
    var left = found;
    if all(left == vec2(0u)) { return; }
    let corner = places_of(item.block).low & vec2(~7u);
    var shape: Cover;
    if TILE_SHIFT != 0u { shape = cover_of(item.triangle); }
    let beyond = goes_beyond(item.triangle);
    while any(left != vec2(0u)) {
        let at = corner + take_texel(&left);
        let k = place_index(at);
        let place = pair_offsets[k] + atomicAdd(&place_counts[k], 1u);
        if anew && place >= pair_offsets[k + 1u] { continue; }
        if place >= frame.triangle_texel_capacity { continue; }
        if TILE_SHIFT == 0u {
            pair_triangles[place] = item.triangle;
        } else {
            let told = cells_in(shape, at) | (depth_code(nearest_in(shape, at)) << 16u);
            pair_triangles[2u * place] = select(told, 0xffffu, beyond && is_at_end(at));
            pair_triangles[2u * place + 1u] = item.triangle;
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let item = item_of(index);
    if item.triangle == NO_TRIANGLE { return; }
    var found = shared_places(item.triangle, item.block);
    if index < step.index { touched[index] = found; }
    let corner = places_of(item.block).low & vec2(~7u);
    while any(found != vec2(0u)) { atomicAdd(&place_counts[place_index(corner + take_texel(&found))], 1u); }
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let index = flat_invocation(group, groups, WORKGROUP, local);
    if index >= step.index { return; }
    let item = item_of(index);
    if item.triangle != NO_TRIANGLE { write_pairs(item, touched[index], false); }
}

@compute @workgroup_size(WORKGROUP)
fn emit_rest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = item_of(step.index + flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle != NO_TRIANGLE { write_pairs(item, shared_places(item.triangle, item.block), true); }
}

@compute @workgroup_size(WORKGROUP)
fn append(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = item_of(flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle == NO_TRIANGLE { return; }
    var found = shared_places(item.triangle, item.block);
    var place = room_for(found);
    let corner = places_of(item.block).low & vec2(~7u);
    while any(found != vec2(0u)) {
        let at = corner + take_texel(&found);
        if place < frame.triangle_texel_capacity {
            keys[place] = place_index(at);
            values[place] = item.triangle;
        }
        place++;
    }
}
