// pixel_texel_pairs: lists, place by place, the undecided facets whose light-view outline touches it (Pan
// 2009, section 3.3). A place is a texel, or a tile of 2 x 2 of them. `count` counts; after a scan `emit` and
// `emit_rest` write. The texels of the first `step.index` blocks are kept in `touched` from counting to
// emitting, those of the rest are found anew. Counting writes `place_counts` (pairs of each place) and
// `place_deepest` (one more than the bits of the farthest facet's depth, 0 where there is no pair; after the
// places, one word for each 8 x 8 block of texels, not 0 where any has a pair). Emitting writes `pairs`
// (facet, texel; or facet, tile and one bit for each of its texels that are touched) at `pair_offsets`, never
// beyond the capacity; order inside a place is not defined. Instead of all three, `append` lists the pairs of
// texels as they come: texels in `keys`, facets in `values`, their number in `appended`, to be sorted (the
// paper's way); it writes `place_deepest` as counting does. A texel that a facet touches is in no pair where
// no caster is, nor, without validity masks, where the facet of a caster lies before the split depth; but it
// is where the facet goes on beyond one of the ends of the map (FLAG_ENDS), and it lies there.
//@bindings Pairs: count, emit, emit_rest

//@import frame dispatch pass rect work_items facet facet_outline facing only_receiver front_split block_bits
//@import places append map_ends

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(3) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(4) var<storage, read> splits: array<f32>;
@group(0) @binding(5) var<storage, read_write> place_counts: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> place_deepest: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> pair_offsets: array<u32>;
@group(0) @binding(8) var<storage, read_write> pairs: array<vec2<u32>>;
// Pairs appended; not 0 if more than 2^32
@group(0) @binding(9) var<storage, read_write> appended: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read_write> keys: array<u32>;
@group(0) @binding(11) var<storage, read_write> values: array<u32>;
@group(0) @binding(12) var<storage, read_write> touched: array<vec2<u32>>;

//@import frame_copy

// A facet and a block of texels; beyond the last, NO_TRIANGLE for the facet.
struct Item { facet: u32, block: Rect }

fn item_of(invocation: u32) -> Item {
    let item = work_offsets[frame.first_facet] + invocation;
    let end = frame.first_facet + frame.facet_count;
    if item >= work_offsets[end] { return Item(NO_TRIANGLE, Rect()); }
    let f = slot_of(item, frame.facets_total);
    return Item(f, block_of(undecided[f].rect, item - work_offsets[f]));
}

// The texels of the block, one bit each row by row, where a caster may shadow the facet.
fn texels_of(item: Item) -> vec2<u32> {
    let facet = undecided[item.facet];
    let block = item.block;
    let outline = facet_outline(facet.pixel, part_of(facet.span), facet.plane, facet.limit);
    var reach = 0.5 + frame.map_margin;
    // With validity masks even the facet's own sheet is tested: its triangles may cut samples off.
    var skip_front = (frame.flags & (FLAG_ALL_UNDECIDED | FLAG_VALIDITY)) == 0u;
    if only_receives(facet.triangle) {
        reach = 0.5 + margin_beyond(reach_beyond(facet.pixel, part_of(facet.span), facet.plane, facet.limit));
        skip_front = false;
    }
    let corner = block.low & vec2(~7u);
    let beyond = ends_beyond(facet.box_low, facet.box_high) != 0u;
    var texels = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        for (var x = block.low.x; x <= block.high.x; x++) {
            let split = splits[y * frame.map_size + x];
            let before = (split != MARKED) & skip_front & (facet.farthest + frame.depth_margin < split);
            let at_end = beyond & (ends_at(vec2(x, y), vec2(x, y), frame.map_size) != 0u);
            if ((split == UNCOVERED) | before) & !at_end { continue; }
            if !outline_touches(outline, vec2(f32(x) + 0.5, f32(y) + 0.5), reach) { continue; }
            add_texel(&texels, vec2(x, y) - corner);
        }
    }
    return texels;
}

// Where a pair meets: which place, and what of it, which is what the pair says.
struct Meeting { place: u32, name: u32 }

// Takes the first meeting out of a block's texels, of which there must be one.
fn take_meeting(texels: ptr<function, vec2<u32>>, block: Rect) -> Meeting {
    let corner = block.low & vec2(~7u);
    if TILE_SHIFT == 0u {
        let place = place_index(corner + take_texel(texels));
        return Meeting(place, place);
    }
    let tile = take_tile(texels);
    let place = place_index((corner >> vec2(1u)) + tile.xy);
    return Meeting(place, (place << 4u) | tile.z);
}

// Remembers the farthest facet of a place, and that its block has one.
fn note_depth(block: Rect, place: u32, deepest: u32) {
    if atomicLoad(&place_deepest[place]) < deepest { atomicMax(&place_deepest[place], deepest); }
    let b = block_word(block.low);
    if atomicLoad(&place_deepest[b]) == 0u { atomicOr(&place_deepest[b], 1u); }
}

fn deepest_of(f: u32) -> u32 {
    return bitcast<u32>(max(undecided[f].farthest, 0.0)) + 1u;
}

// `anew`: `emit_rest` is compiled for itself and may round otherwise than `count` did, so it stays within
// what was counted.
fn write_pairs(item: Item, found: vec2<u32>, anew: bool) {
    var texels = found;
    while any(texels != vec2(0u)) {
        let at = take_meeting(&texels, item.block);
        let place = pair_offsets[at.place] + atomicAdd(&place_counts[at.place], 1u);
        if anew && place >= pair_offsets[at.place + 1u] { continue; }
        if place < frame.pixel_texel_capacity { pairs[place] = vec2(item.facet, at.name); }
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
    if item.facet == NO_TRIANGLE { return; }
    let deepest = deepest_of(item.facet);
    var texels = texels_of(item);
    if index < step.index { touched[index] = texels; }
    while any(texels != vec2(0u)) {
        let place = take_meeting(&texels, item.block).place;
        atomicAdd(&place_counts[place], 1u);
        note_depth(item.block, place, deepest);
    }
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
    if item.facet != NO_TRIANGLE { write_pairs(item, touched[index], false); }
}

@compute @workgroup_size(WORKGROUP)
fn emit_rest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = item_of(step.index + flat_invocation(group, groups, WORKGROUP, local));
    if item.facet != NO_TRIANGLE { write_pairs(item, texels_of(item), true); }
}

@compute @workgroup_size(WORKGROUP)
fn append(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = item_of(flat_invocation(group, groups, WORKGROUP, local));
    if item.facet == NO_TRIANGLE { return; }
    let deepest = deepest_of(item.facet);
    var texels = texels_of(item);
    var place = room_for(texels);
    while any(texels != vec2(0u)) {
        let at = take_meeting(&texels, item.block);
        note_depth(item.block, at.place, deepest);
        if place < frame.pixel_texel_capacity {
            keys[place] = at.place;
            values[place] = item.facet;
        }
        place++;
    }
}
