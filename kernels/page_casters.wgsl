// page_casters: the nearest caster at every texel centre of the pages that are made. `count` writes the
// box of each triangle (`page_rects`, in halves of the finest level's texels) and how many 8 x 8 blocks of
// made pages it takes over all levels (`page_items`): of each page as many as its box takes at most of
// one. `raster` goes through these blocks: of its triangle's levels, pages and blocks in them it finds its
// own, the page by the summed-area table of the pages that are made, and raises in `pages` the keys
// (complement of the bits of the depth) of the texels whose centres the triangle covers. The sample rule
// is that of light_layers, the texels those of a map of as many texels as the level has.

//@import frame dispatch rect work_items flat_caster span block_bits hole front_fan page_tree summed_area

const WORKGROUP = 64u;
const CUT_GUARD = 0.001953125;  // texels

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> masks: array<u32>;
@group(0) @binding(5) var<storage, read> sat: array<u32>;
@group(0) @binding(6) var<storage, read_write> page_rects: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> page_items: array<u32>;
@group(0) @binding(8) var<storage, read> boxes: array<vec2<u32>>;  // page_rects
@group(0) @binding(9) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(10) var<storage, read> table: array<u32>;
@group(0) @binding(11) var<storage, read_write> pages: array<atomic<u32>>;

//@import frame_copy

override BUDGET: u32 = 64u;

// The smallest page that holds all of a box: its level and node.
fn page_around(box: Rect) -> vec2<u32> {
    let low = box.low >> vec2(PAGE_SHIFT + 1u);
    let high = box.high >> vec2(PAGE_SHIFT + 1u);
    let apart = firstLeadingBit((low.x ^ high.x) | (low.y ^ high.y)) + 1u;
    let level = PAGE_LAST - apart;
    return vec2(level, node_of(level, low >> vec2(apart)));
}

// The part of a triangle on a level: its texels, the pages of them that are made, blocks of one at most.
struct Part {
    texels: Rect,
    pages: u32,
    across: vec2<u32>,
}

fn pages_in(level: u32, low: vec2<u32>, high: vec2<u32>) -> u32 {
    let corner = tree_corner(level);
    return rect_sum(vec2(tree_width(), finest_side()), corner + low, corner + high);
}

// `whole`: a level no finer than that of one page around the box.
fn part_of(box: Rect, level: u32, whole: bool) -> Part {
    let shift = vec2(PAGE_LAST + 1u - level);
    let half = vec2(1u << (shift.x - 1u));
    var part: Part;
    if any(box.high + 1u < half) { return part; }
    // Texels whose centres lie in the box.
    part.texels = Rect((box.low + half - 1u) >> shift, (box.high + 1u - half) >> shift);
    if any(part.texels.low > part.texels.high) { return part; }
    let blocks = (part.texels.high >> vec2(BLOCK_SHIFT)) - (part.texels.low >> vec2(BLOCK_SHIFT)) + 1u;
    part.across = min(blocks, vec2(PAGE / BLOCK));
    part.pages = 1u;
    if !whole {
        let page = vec2(PAGE_SHIFT);
        part.pages = pages_in(level, part.texels.low >> page, part.texels.high >> page);
    }
    return part;
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
    page_rects[t] = EMPTY_RECT;
    page_items[t] = 0u;
    if is_empty(light_rects[t]) { return; }
    let a = map_points[triangles[t].x];
    let b = map_points[triangles[t].y];
    let c = map_points[triangles[t].z];
    let side = f32(frame.map_size);
    var low = vec2(0.0);
    var high = vec2(side);
    let scale = 2.0 * scale_of(PAGE_LAST);
    if min(a.w, min(b.w, c.w)) > 0.0 {
        low = min(min(a.xy, b.xy), c.xy);
        high = max(max(a.xy, b.xy), c.xy);
        let slack = 0.03125 / scale + 1e-6 * max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
        low -= slack;
        high += slack;
    }
    if any(high < vec2(0.0)) || any(low >= vec2(side)) { return; }
    let end = vec2(ceil(side * scale) - 1.0);
    let none = vec2(0.0);
    let box = Rect(vec2<u32>(clamp(low * scale, none, end)), vec2<u32>(clamp(high * scale, none, end)));
    let around = page_around(box);
    var levels = masks[around.y];
    var items = 0u;
    while levels != 0u {
        let level = firstTrailingBit(levels);
        levels &= levels - 1u;
        let part = part_of(box, level, level <= around.x);
        items += part.pages * part.across.x * part.across.y;
    }
    page_rects[t] = pack_rect(box);
    page_items[t] = items;
}

// The `index`th of the pages of a level from `low` to `high` that are made: row by row.
fn nth_page(level: u32, low: vec2<u32>, high: vec2<u32>, index: u32) -> vec2<u32> {
    var row = low.y;
    var end = high.y;
    while row < end {
        let middle = (row + end) >> 1u;
        if pages_in(level, low, vec2(high.x, middle)) <= index { row = middle + 1u; } else { end = middle; }
    }
    var before = 0u;
    if row > low.y { before = pages_in(level, low, vec2(high.x, row - 1u)); }
    var column = low.x;
    end = high.x;
    while column < end {
        let middle = (column + end) >> 1u;
        let until = before + pages_in(level, vec2(low.x, row), vec2(middle, row));
        if until <= index { column = middle + 1u; } else { end = middle; }
    }
    return vec2(column, row);
}

// Puts the depths of a triangle into the texels of a block of a level, whose page begins at word `first`.
fn cover(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, block: Rect, guarded: f32, given: vec4<u32>,
         to_map: f32, first: u32) {
    let f = flat_caster(a, b, c, guarded);
    let corner = block.low & vec2(~7u);
    var left = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        let cut = cut_span(cut_span(cut_span(span_of(block.low.x, block.high.x), f.cut_ab, row), f.cut_bc,
            row), f.cut_ca, row);
        add_cells(&left, y, cells_of(cut, block.low.x, block.high.x));
    }
    while any(left != vec2(0u)) {
        let cell = corner + take_texel(&left);
        let at = vec2<f32>(cell) + 0.5;
        let key = key_at(f, at);
        if key == 0u || is_hole(given, at * to_map) { continue; }
        let texel = first + (cell.y % PAGE) * PAGE + cell.x % PAGE;
        if atomicLoad(&pages[texel]) < key { atomicMax(&pages[texel], key); }
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
    let box = unpack_rect(boxes[t]);
    let around = page_around(box);
    var levels = masks[around.y];
    var index = item - work_offsets[t];
    var level = 0u;
    var part: Part;
    while levels != 0u {
        level = firstTrailingBit(levels);
        levels &= levels - 1u;
        part = part_of(box, level, level <= around.x);
        let items = part.pages * part.across.x * part.across.y;
        if index < items { break; }
        index -= items;
    }
    let of_page = divided(index, part.across.x * part.across.y);
    var page = part.texels.low >> vec2(PAGE_SHIFT);
    if level > around.x { page = nth_page(level, page, part.texels.high >> vec2(PAGE_SHIFT), of_page.x); }
    let begin = max(part.texels.low, page * PAGE) >> vec2(BLOCK_SHIFT);
    let end = min(part.texels.high, page * PAGE + PAGE - 1u);
    let corner = (begin + divided(of_page.y, part.across.x).yx) << vec2(BLOCK_SHIFT);
    let number = table[node_of(level, page)];
    // Of a page that holds less of the box than another some blocks are not there.
    if any(corner > end) || number >= BUDGET { return; }
    let block = Rect(max(part.texels.low, corner), min(end, corner + BLOCK - 1u));
    let given = triangles[t];
    var i = given.xyz;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let scale = scale_of(level);
    let texels = vec4(scale, scale, 1.0, 1.0);
    let fan = fan_of(texels * map_points[i.x], texels * map_points[i.y], texels * map_points[i.z]);
    let guarded = max(CUT_GUARD, 4e-7 * fan.extent);
    var side_a = fan.side_a;
    var side_b = fan.side_b;
    for (var k = 0u; k < fan.parts; k++) {
        cover(fan.middle, side_a, side_b, block, guarded, given, 1.0 / scale, number * PAGE_TEXELS);
        side_a = side_b;
        side_b = fan.last;
    }
}
