// split_maps: the nearest caster at every texel centre of the maps of several slices of what the camera sees.
// `measure`: of each triangle (item view * triangles + triangle) the rectangle of texels whose centres it may
// cover, and how many 8 x 8 blocks that takes; none of a triangle without work in the whole view
// (`light_rects`), or that is not surely in front of the light. The part before the map's side next to the
// eye is clipped off. `raster`: the blocks. Edges are lines through vertices in homogeneous coordinates
// relative to the block, so nothing is divided but the depth, and an edge has one value in both of its
// triangles. The depth is that of the whole view. Writes `map_keys`, view after view (complement of the bits
// of the depth; 0 where there is none).

//@import frame split_views dispatch rect work_items front_split span block_bits

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> split_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> split_items: array<u32>;
@group(0) @binding(7) var<storage, read> rects: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> map_keys: array<atomic<u32>>;

var<private> box_low: vec2<f32>;
var<private> box_high: vec2<f32>;

fn include(q: vec3<f32>) {
    box_low = min(box_low, q.xy / q.z);
    box_high = max(box_high, q.xy / q.z);
}

// The part of an edge that is not clipped off: where `ca` and `cb` are not below 0.
fn include_edge(a: vec3<f32>, b: vec3<f32>, ca: f32, cb: f32) {
    if ca >= 0.0 { include(a); }
    if (ca >= 0.0) != (cb >= 0.0) { include(mix(a, b, ca / (ca - cb))); }
}

fn rect_of(view: u32, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> vec2<u32> {
    let w = vec3(whole_divisor(a), whole_divisor(b), whole_divisor(c));
    if (frame.flags & FLAG_PERSPECTIVE) != 0u && min(w.x, min(w.y, w.z)) <= frame.light_low.w { return EMPTY_RECT; }
    let qa = in_split(view, a);
    let qb = in_split(view, b);
    let qc = in_split(view, c);
    let kept = vec3(qa.z, qb.z, qc.z) - 0.5 * w;
    box_low = vec2(1e30);
    box_high = vec2(-1e30);
    include_edge(qa, qb, kept.x, kept.y);
    include_edge(qb, qc, kept.y, kept.z);
    include_edge(qc, qa, kept.z, kept.x);
    if box_low.x > box_high.x { return EMPTY_RECT; }
    let slack = 0.015625 + 1e-6 * max(max(abs(box_low.x), abs(box_low.y)), max(abs(box_high.x), abs(box_high.y)));
    let low = ceil(box_low - 0.5 - slack);
    let high = floor(box_high - 0.5 + slack);
    if any(low > high) { return EMPTY_RECT; }
    return cells_touched(low, high, vec2(frame.map_size));
}

@compute @workgroup_size(WORKGROUP)
fn measure(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= frame.triangle_count * splits.count { return; }
    let view = item / frame.triangle_count;
    let t = item - view * frame.triangle_count;
    var found = EMPTY_RECT;
    if !is_empty(light_rects[t]) {
        let i = triangles[t];
        found = rect_of(view, points[i.x], points[i.y], points[i.z]);
    }
    split_rects[item] = found;
    split_items[item] = block_count(found);
}

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let owners = frame.triangle_count * splits.count;
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[owners] { return; }
    let owner = owner_of(item, owners);
    let view = owner / frame.triangle_count;
    let block = block_of(rects[owner], item - work_offsets[owner]);
    let corner = block.low & vec2(~7u);
    // Vertices in order of index, so that an edge has one value in both of its triangles.
    var i = triangles[owner - view * frame.triangle_count];
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let a = points[i.x];
    let b = points[i.y];
    let c = points[i.z];
    let shift = vec2<f32>(corner);
    var qa = in_split(view, a);
    var qb = in_split(view, b);
    var qc = in_split(view, c);
    qa = vec3(qa.xy - shift * qa.z, qa.z);
    qb = vec3(qb.xy - shift * qb.z, qb.z);
    qc = vec3(qc.xy - shift * qc.z, qc.z);
    let opposite_a = cross(qb, qc);
    let turn = select(-1.0, 1.0, dot(qa, opposite_a) > 0.0);
    let ea = turn * opposite_a;
    let eb = -turn * cross(qa, qc);
    let ec = turn * cross(qa, qb);
    let z = vec3(dot(frame.map_z, a), dot(frame.map_z, b), dot(frame.map_z, c));
    let w = vec3(whole_divisor(a), whole_divisor(b), whole_divisor(c));
    let depths = z / w;
    let nearest = min(depths.x, min(depths.y, depths.z));
    let farthest = max(depths.x, max(depths.y, depths.z));
    // Cells where the triangle may be; then they alone, one after another.
    let low = block.low - corner;
    let high = block.high - corner;
    var left = vec2(0u);
    for (var y = low.y; y <= high.y; y++) {
        let row = f32(y) + 0.5;
        let cut = cut_span(cut_span(cut_span(span_of(low.x, high.x), ea, row), eb, row), ec, row);
        add_cells(&left, y, cells_of(cut, low.x, high.x));
    }
    let first = view * frame.map_size * frame.map_size;
    while any(left != vec2(0u)) {
        let cell = take_texel(&left);
        let at = vec3(vec2<f32>(cell) + 0.5, 1.0);
        let share = vec3(dot(ea, at), dot(eb, at), dot(ec, at));
        if any(share < vec3(0.0)) { continue; }
        let over = dot(share, w);
        var depth = nearest;
        if over > 0.0 { depth = clamp(dot(share, z) / over, nearest, farthest); }
        let key = key_of_depth(depth);
        let texel = first + (corner.y + cell.y) * frame.map_size + corner.x + cell.x;
        if atomicLoad(&map_keys[texel]) < key { atomicMax(&map_keys[texel], key); }
    }
}
