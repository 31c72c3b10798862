// silhouette_mask: finds the silhouette edges and marks the texels they touch (Pan 2009, section 3.2).
// `classify` decides for every edge whether it is a silhouette: its two triangles do not face the light
// alike, or one of them is missing, unsure, or not known to be its only neighbour; an element with one
// vertex twice holds no edge. Takes the edges of `kept_clusters`; writes `edge_rects`, `edge_items` (8 x 8
// blocks to mark, of those that are `requested`; 0 where the edge is none), the latter by slot. `raster`
// marks in `mask` every texel an edge touches (conservatively), unless the edge lies there behind the
// texel's split depth: then it is hidden by what is in front, or front_layer marks the texel anyway.

//@import frame dispatch status edge rect work_items front_split facing span mask_rows requested_part clusters

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> edges: array<Edge>;
@group(0) @binding(2) var<storage, read> facing: array<u32>;
@group(0) @binding(3) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> edge_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> edge_items: array<u32>;
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(7) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(8) var<storage, read> second_keys: array<u32>;
@group(0) @binding(9) var<storage, read_write> mask: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read_write> status: Status;
@group(0) @binding(11) var<storage, read> requested: array<u32>;
@group(0) @binding(12) var<storage, read> kept_clusters: array<u32>;

fn is_silhouette(e: Edge) -> bool {
    if e.v0 == e.v1 { return false; }
    if e.t1 == NO_TRIANGLE { return true; }
    let first = facing[e.t0];
    let second = facing[e.t1];
    if first == DROPPED || second == DROPPED { return true; }
    return first == UNSURE || second == UNSURE || first != second;
}

@compute @workgroup_size(WORKGROUP)
fn classify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let member = member_of(PART_EDGES, flat_group(group, groups), local);
    let k = member.number;
    if k >= frame.edge_count { return; }
    let e = edges[k];
    var rect = EMPTY_RECT;
    if is_silhouette(e) {
        let a = map_points[e.v0];
        let b = map_points[e.v1];
        // An edge that reaches behind the light belongs to triangles whose every texel front_layer marks.
        if a.w > 0.0 && b.w > 0.0 {
            let low = min(a.xy, b.xy);
            let high = max(a.xy, b.xy);
            let slack = frame.map_margin
                + 4e-6 * max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
            rect = requested_part(cells_touched(low - slack, high + slack, vec2(frame.map_size)));
        }
        // The same in every view; where clusters are left out, those that touch something in each view.
        let culled = kept_clusters[0] != ALL_CLUSTERS;
        let first_view = (frame.flags & FLAG_FURTHER_VIEW) == 0u;
        if select(first_view, !is_empty(rect), culled) { atomicAdd(&status.head.silhouette_edges, 1u); }
    }
    edge_rects[k] = rect;
    edge_items[member.slot] = block_count(rect);
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
    let block = block_of(edge_rects[k], item - work_offsets[slot]);
    let a = map_points[edges[k].v0];
    let b = map_points[edges[k].v1];
    let d = b.xy - a.xy;
    let extent = max(max(abs(a.x), abs(a.y)), max(abs(b.x), abs(b.y)));
    let reach = 0.5 + frame.map_margin + 4e-6 * extent;
    let width = reach * (abs(d.x) + abs(d.y));
    // Where along the edge it crosses a texel, by its longer axis.
    let by_x = abs(d.x) >= abs(d.y);
    let start = select(a.y, a.x, by_x);
    let length = select(d.y, d.x, by_x);
    // Cells between the two lines beside the edge.
    let line = vec3(-d.y, d.x, d.y * a.x - d.x * a.y);
    let corner = block.low & vec2(~7u);
    var left = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        let wide = vec3(0.0, 0.0, width);
        let cut = cut_span(cut_span(span_of(block.low.x, block.high.x), line + wide, row), wide - line, row);
        add_cells(&left, y, cells_of(cut, block.low.x, block.high.x));
    }
    var marks = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let cell = corner + place;
        let centre = vec2<f32>(cell) + 0.5;
        let p = centre - a.xy;
        if abs(d.x * p.y - d.y * p.x) > width { continue; }
        let texel = cell.y * frame.map_size + cell.x;
        let first = nearest_keys[texel];
        if first != 0u {
            var at = vec2(0.0, 1.0);
            if abs(length) > 1e-3 {
                let middle = select(centre.y, centre.x, by_x) - start;
                at = clamp(vec2(middle - reach, middle + reach) / length, vec2(0.0), vec2(1.0));
            }
            let z = a.z + (b.z - a.z) * at;
            if min(z.x, z.y) - frame.depth_margin > split_depth(first, second_keys[texel]) { continue; }
        }
        add_texel(&marks, place);
    }
    mark_rows(corner, marks);
}
