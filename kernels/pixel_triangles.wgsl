// pixel_triangles: lists, pixel by pixel, the triangles that some sample in the pixel's square may see.
// Over blocks of 8 x 8 pixels: `cover` finds the nearest "farthest depth over the square" of the triangles
// that surely cover the whole square (`cover_keys`, complement of its bits, 0 without one); `cover_blocks`
// writes behind those of pixels the farthest of each block, behind which a triangle is passed over; `count`
// counts the triangles that touch the square no farther than that (`pixel_counts`), and keeps the complement
// of the first that it comes by (`id_keys`); `judge` runs before the counts are scanned. A pixel with one
// triangle, which covers it, is single, and `id_keys` tells which; a pixel without any is empty; the others
// are complex: marked in `complex_flags`, and listed. It writes `facet_counts` (1 for single pixels, else 0),
// takes the counts of single pixels down to 0 and keeps the longest list in `status`. `emit` and `emit_rest`
// write the triangles of complex pixels to `pixel_list` at `pixel_offsets`, never beyond the capacity, and
// take the counts down to 0 again; order inside a pixel is not defined. The pixels of the first `step.index`
// blocks are kept in `touched` from counting to emitting, those of the rest are found anew. All tests are
// conservative: margins are far above the rounding of what they are made of.
//@bindings Raster: cover, count, emit, emit_rest

//@import frame dispatch status pass rect work_items facing eye_edges block_bits over_square pixel_pair

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> cover_keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> pixel_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> pixel_list: array<PixelPair>;
@group(0) @binding(10) var<storage, read_write> complex_flags: array<u32>;
@group(0) @binding(11) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(12) var<storage, read_write> status: Status;
@group(0) @binding(13) var<storage, read_write> touched: array<vec2<u32>>;
@group(0) @binding(14) var<storage, read_write> id_keys: array<u32>;

// A triangle and a block of pixels; beyond the last, NO_TRIANGLE for the triangle.
struct Item { triangle: u32, block: Rect }

fn item_of(item: u32) -> Item {
    if item >= work_offsets[frame.triangle_count] { return Item(NO_TRIANGLE, Rect()); }
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    return Item(t, block_of(camera_rects[t], item - work_offsets[slot]));
}

// The depth behind a key; infinite for 0.
fn depth_of(key: u32) -> f32 {
    return bitcast<f32>(min(~key, FAR));
}

// Where the key of a block stands.
fn block_key(block: u32) -> u32 {
    return frame.image_size.x * frame.image_size.y + block;
}

fn blocks_across() -> u32 {
    return (frame.image_size.x + BLOCK - 1u) >> BLOCK_SHIFT;
}

// The pixels of the block, one bit each row by row, in which the triangle is listed.
fn pixels_of(item: Item) -> vec2<u32> {
    let s = seen_triangle(item.triangle);
    var found = vec2(0u);
    let cell = item.block.low >> vec2(BLOCK_SHIFT);
    let hidden = depth_of(atomicLoad(&cover_keys[block_key(cell.y * blocks_across() + cell.x)]));
    if s.nearest - 2e-6 * abs(s.nearest) > hidden { return found; }
    for (var y = item.block.low.y; y <= item.block.high.y; y++) {
        for (var x = item.block.low.x; x <= item.block.high.x; x++) {
            let over = over_square(s, x, y);
            if !over.touches { continue; }
            let cover = depth_of(atomicLoad(&cover_keys[y * frame.image_size.x + x]));
            if !(over.nearest > cover) { add_texel(&found, vec2(x, y) - item.block.low); }
        }
    }
    return found;
}

// `anew`: `emit_rest` is compiled for itself and may round otherwise than `count` did, so it stays within
// what was counted.
fn write_triangle(item: Item, found: vec2<u32>, anew: bool) {
    var pixels = found;
    while any(pixels != vec2(0u)) {
        let at = item.block.low + take_texel(&pixels);
        let pixel = at.y * frame.image_size.x + at.x;
        let first = pixel_offsets[pixel];
        let end = pixel_offsets[pixel + 1u];
        if first == end { continue; }
        let place = first + atomicSub(&pixel_counts[pixel], 1u) - 1u;
        if anew && (place < first || place >= end) { continue; }
        if place < frame.pixel_triangle_capacity { pixel_list[place] = PixelPair(item.triangle, pixel); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn cover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = item_of(flat_invocation(group, groups, WORKGROUP, local));
    // A triangle with holes covers no pixel.
    if item.triangle == NO_TRIANGLE || is_tested(triangles[item.triangle].w) { return; }
    let s = seen_triangle(item.triangle);
    if s.turn == 0.0 { return; }
    for (var y = item.block.low.y; y <= item.block.high.y; y++) {
        for (var x = item.block.low.x; x <= item.block.high.x; x++) {
            let over = over_square(s, x, y);
            if over.touches && over.covers {
                atomicMax(&cover_keys[y * frame.image_size.x + x], ~bitcast<u32>(over.farthest));
            }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn cover_blocks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block = flat_invocation(group, groups, WORKGROUP, local);
    let place = divided(block, blocks_across());
    let first = vec2(place.y, place.x) << vec2(BLOCK_SHIFT);
    if first.y >= frame.image_size.y { return; }
    let end = min(first + BLOCK, frame.image_size);
    var key = 0xffffffffu;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            key = min(key, atomicLoad(&cover_keys[y * frame.image_size.x + x]));
        }
    }
    atomicStore(&cover_keys[block_key(block)], key);
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let item = item_of(index);
    if item.triangle == NO_TRIANGLE { return; }
    var pixels = pixels_of(item);
    if index < step.index { touched[index] = pixels; }
    while any(pixels != vec2(0u)) {
        let at = item.block.low + take_texel(&pixels);
        let pixel = at.y * frame.image_size.x + at.x;
        if atomicAdd(&pixel_counts[pixel], 1u) == 0u { id_keys[pixel] = ~item.triangle; }
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    if index >= step.index { return; }
    let item = item_of(index);
    if item.triangle != NO_TRIANGLE { write_triangle(item, touched[index], false); }
}

@compute @workgroup_size(WORKGROUP)
fn emit_rest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = item_of(step.index + flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle != NO_TRIANGLE { write_triangle(item, pixels_of(item), true); }
}

@compute @workgroup_size(WORKGROUP)
fn judge(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let count = atomicLoad(&pixel_counts[pixel]);
    // The triangle that covers is always counted, so one triangle and a key mean that it is the one.
    let single = count == 1u && atomicLoad(&cover_keys[pixel]) != 0u;
    let many = count != 0u && !single;
    complex_flags[pixel] = select(0u, 1u, many);
    facet_counts[pixel] = select(0u, 1u, single);
    if single { atomicStore(&pixel_counts[pixel], 0u); }
    if many && atomicLoad(&status.head.longest_pixel) < count {
        atomicMax(&status.head.longest_pixel, count);
    }
}
