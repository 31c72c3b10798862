// silhouette_points: a point on a silhouette edge in each cell that one crosses (Sen, Cammarano, Hanrahan
// 2003). Cells are those of the dual grid, whose corners are the centres of texels: one more a side than
// texels, the first half a texel before the map. `raster` takes the edges that silhouette_mask found, by
// blocks of texels, in two runs, `point_keys` 0 before each: the first finds the least depth of any edge in
// a cell, the second its point. An edge counts where it is not farther from the light than what lies at all
// four corners. The point is an end of the edge that lies in the cell, else the middle of where the edge
// crosses the cell's diagonals. Writes `edge_keys` (complement of the bits of the point's depth) and
// `point_keys` (x | y << 16 in the cell, 1 to 65535 across; 0: no edge). Of points of one depth the largest
// key stays.

//@import frame dispatch edge rect work_items front_split

const WORKGROUP = 64u;
const STEPS = 65534.0;  // across a cell

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> edges: array<Edge>;
@group(0) @binding(2) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> edge_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> edge_keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> point_keys: array<atomic<u32>>;

// Shares of the way along which a coordinate, that begins at `start` and changes by `change`, is within half
// a cell of a middle; none where the first is above the second.
fn part_within(start: f32, change: f32, middle: f32) -> vec2<f32> {
    let ends = vec2(middle - 0.5, middle + 0.5) - start;
    if change == 0.0 { return select(vec2(2.0, -1.0), vec2(0.0, 1.0), ends.x <= 0.0 && ends.y >= 0.0); }
    let at = ends / change;
    return vec2(max(min(at.x, at.y), 0.0), min(max(at.x, at.y), 1.0));
}

// Depth at a texel's centre; beyond everything where nothing is.
fn depth_at(texel: vec2<i32>) -> f32 {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return BEYOND; }
    let key = nearest_keys[u32(texel.y * side + texel.x)];
    return select(depth_of_key(key), BEYOND, key == 0u);
}

fn is_hidden(cell: vec2<i32>, depth: f32) -> bool {
    let low = max(depth_at(cell - 1), depth_at(cell - vec2(0, 1)));
    let high = max(depth_at(cell - vec2(1, 0)), depth_at(cell));
    return depth - frame.depth_margin > max(low, high);
}

// Where along an edge, in the part of it in a cell, it crosses the two diagonals on average; `start` is
// relative to the cell's middle.
fn at_diagonals(start: vec2<f32>, change: vec2<f32>, part: vec2<f32>) -> f32 {
    let at = -vec2(start.x - start.y, start.x + start.y) / vec2(change.x - change.y, change.x + change.y);
    let meets = (at >= vec2(part.x)) & (at <= vec2(part.y));
    if all(meets) { return 0.5 * (at.x + at.y); }
    if meets.x { return at.x; }
    return select(0.5 * (part.x + part.y), at.y, meets.y);
}

fn put(cell: vec2<u32>, a: vec3<f32>, b: vec3<f32>) {
    let middle = vec2<f32>(cell);
    let change = b.xy - a.xy;
    let by_x = part_within(a.x, change.x, middle.x);
    let by_y = part_within(a.y, change.y, middle.y);
    let part = vec2(max(by_x.x, by_y.x), min(by_x.y, by_y.y));
    if part.x > part.y { return; }
    var at = at_diagonals(a.xy - middle, change, part);
    if all(abs(b.xy - middle) <= vec2(0.5)) { at = 1.0; }
    if all(abs(a.xy - middle) <= vec2(0.5)) { at = 0.0; }
    let depth = mix(a.z, b.z, at);
    if is_hidden(vec2<i32>(cell), depth) { return; }
    let place = clamp(mix(a.xy, b.xy, at) - middle + 0.5, vec2(0.0), vec2(1.0));
    let steps = vec2<u32>(round(STEPS * place)) + 1u;
    let index = cell.y * (frame.map_size + 1u) + cell.x;
    let key = key_of_depth(depth);
    if atomicMax(&edge_keys[index], key) <= key { atomicMax(&point_keys[index], steps.x | (steps.y << 16u)); }
}

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.edge_count] { return; }
    let slot = slot_of(item, frame.edge_count);
    let k = owner_in(slot, frame.edge_count);
    let packed = edge_rects[k];
    let block = block_of(packed, item - work_offsets[slot]);
    let a = map_points[edges[k].v0].xyz;
    let b = map_points[edges[k].v1].xyz;
    // Cells begin half a texel before their texels: the last texels of the rectangle have one more.
    let last = block.high + select(vec2(0u), vec2(1u), block.high == unpack_rect(packed).high);
    for (var y = block.low.y; y <= last.y; y++) {
        let part = part_within(a.y, b.y - a.y, f32(y));
        let ends = clamp(a.x + (b.x - a.x) * part + 0.5, vec2(f32(block.low.x)), vec2(f32(last.x) + 0.5));
        // One more to either side: `put` tells of each cell by itself.
        let first = max(u32(min(ends.x, ends.y)), block.low.x + 1u) - 1u;
        let end = min(u32(max(ends.x, ends.y)) + 1u, last.x);
        if part.x > part.y { continue; }
        for (var x = first; x <= end; x++) { put(vec2(x, y), a, b); }
    }
}
