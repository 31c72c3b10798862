// paraboloid_casters: the nearest caster at the centre of every texel of a paraboloid view (see paraboloid),
// by curved rasterization: the ray of the texel's centre meets the flat triangle, or passes it. `count`
// writes the texels that the box of each triangle's image holds (`curved_rects`) and how many 8 x 8 blocks
// those take (`curved_items`). Seen from the light, triangles are bounded by great circles, whose images are
// circles: the box is that of three arcs. A triangle that the ray away from the view's axis meets, or nearly,
// takes the whole map. `raster` goes through the blocks and raises in `nearest_keys` (complement of the bits
// of the distance over that of depth 1) the texels whose centres see the triangle. Triangles that are no
// casters (FLAG_CULL_BACK) take nothing.

//@import frame dispatch rect work_items front_split facing alpha roles paraboloid mapped_view

const WORKGROUP = 64u;
const SLACK = 0.015625;     // texels
const NEAR_POLE = 0.00001;  // of the longest edge's length from the light, times that

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> curved_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> curved_items: array<u32>;
@group(0) @binding(5) var<storage, read> boxes: array<vec2<u32>>;  // curved_rects
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> nearest_keys: array<atomic<u32>>;

//@import frame_copy

var<private> box_low: vec2<f32>;
var<private> box_high: vec2<f32>;

// Texels for a unit of the paraboloid, across and down.
fn unit_texels() -> vec2<f32> { return vec2(length(frame.map_u.xyz), length(frame.map_v.xyz)); }

// A point away from the light along the view's axes.
fn along_axes(point: vec3<f32>) -> vec3<f32> {
    let rel = from_light(point);
    let texels = unit_texels();
    return vec3(dot(frame.map_u.xyz, rel) / texels.x, dot(frame.map_v.xyz, rel) / texels.y,
        dot(frame.map_w.xyz, rel));
}

fn include(at: vec2<f32>) {
    box_low = min(box_low, at);
    box_high = max(box_high, at);
}

// Place of a direction.
fn include_corner(d: vec3<f32>) { include(d.xy / (length(d) + d.z)); }

// Where the arc from a to b is lowest and highest along x, its circle that of the normal n, m long.
fn include_ends(a: vec3<f32>, b: vec3<f32>, n: vec3<f32>, m: f32) {
    let q = n.x + select(-m, m, n.x >= 0.0);
    let ends = vec2(q / n.z, -(n.y * n.y + n.z * n.z) / (n.z * q));
    let side = n.y / n.z;
    for (var k = 0u; k < 2u; k++) {
        let s = ends[k];
        let d = vec3(2.0 * s, 2.0 * side, 1.0 - s * s - side * side);
        let inside = dot(cross(a, d), n) >= 0.0 && dot(cross(d, b), n) >= 0.0;
        if inside { include(vec2(s, side)); }
    }
}

// False where the light lies on the edge, or nearly.
fn include_edge(a: vec3<f32>, b: vec3<f32>) -> bool {
    let n = cross(a, b - a);
    let m = length(n);
    if m <= NEAR_POLE * length(a) * length(b) { return dot(a, b) > 0.0; }
    include_ends(a, b, n, m);
    // The same along y: the axes change places, and so does the turn.
    let low = box_low;
    let high = box_high;
    box_low = low.yx;
    box_high = high.yx;
    include_ends(b.yxz, a.yxz, n.yxz, m);
    box_low = box_low.yx;
    box_high = box_high.yx;
    return true;
}

fn whole_map() -> vec2<u32> { return pack_rect(Rect(vec2(0u), vec2(frame.map_size - 1u))); }

fn curved_rect(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec2<u32> {
    let ab = cross(a, b - a);
    let bc = cross(b, c - b);
    let ca = cross(c, a - c);
    let turn = select(-1.0, 1.0, dot(a, bc) >= 0.0);
    let longest = max(length(a), max(length(b), length(c)));
    // Against the axis; and a corner at the light is everywhere.
    let pole = -turn * vec3(bc.z, ca.z, ab.z);
    if all(pole >= vec3(-NEAR_POLE * longest * longest)) { return whole_map(); }
    if min(length(a), min(length(b), length(c))) <= NEAR_POLE * longest { return whole_map(); }
    box_low = vec2(1e30);
    box_high = vec2(-1e30);
    include_corner(a);
    include_corner(b);
    include_corner(c);
    if !(include_edge(a, b) && include_edge(b, c) && include_edge(c, a)) { return whole_map(); }
    let texels = unit_texels();
    let middle = vec2(frame.map_u.w, frame.map_v.w);
    let low = max(middle + box_low * texels, vec2(-1e6));
    let high = min(middle + box_high * texels, vec2(1e6));
    let slack = SLACK + 1e-5 * max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    return cells_touched(low - slack, high + slack, vec2(frame.map_size));
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
    let i = triangles[t];
    var rect = EMPTY_RECT;
    let last = frame.vertex_count - 1u;
    let a = points[min(i.x, last)];
    let b = points[min(i.y, last)];
    let c = points[min(i.z, last)];
    let none = max(max(i.x, i.y), i.z) > last || i.x == i.y || i.y == i.z || i.z == i.x;
    if !none && a.w * b.w * c.w != 0.0 {
        let side = facing_of(a.xyz, b.xyz, c.xyz, frame.light);
        if !is_culled(frame.flags, i.w, side) {
            rect = curved_rect(along_axes(a.xyz), along_axes(b.xyz), along_axes(c.xyz));
        }
    }
    curved_rects[t] = rect;
    curved_items[t] = block_count(rect);
}

// Whether an alpha-tested triangle has a hole in the direction d, or casts nothing.
fn is_hole_towards(given: vec4<u32>, d: vec3<f32>) -> bool {
    if ALPHA == 0u || !is_tested(given.w) { return false; }
    if !casts(given.w) { return true; }
    let a = along_axes(points[given.x].xyz);
    let b = along_axes(points[given.y].xyz);
    let c = along_axes(points[given.z].xyz);
    let parts = vec3(dot(d, cross(b, c - b)), dot(d, cross(c, a - c)), dot(d, cross(a, b - a)));
    let all = parts.x + parts.y + parts.z;
    let card = Card(points[given.x].xyz, points[given.y].xyz, points[given.z].xyz, mapped_ahead());
    return all != 0.0 && !is_solid_by(given.w, world_shares(parts.yz / all, card));
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
    let given = triangles[t];
    // By rising index: an edge has one value in both of its triangles.
    let i = rising(given.xyz);
    let a = along_axes(points[i.x].xyz);
    let b = along_axes(points[i.y].xyz);
    let c = along_axes(points[i.z].xyz);
    let ab = cross(a, b - a);
    let bc = cross(b, c - b);
    let ac = cross(a, c - a);
    let normal = cross(b - a, c - a);
    let height = dot(normal, a);
    let turn = select(-1.0, 1.0, height > 0.0);
    let farthest = max(length(a), max(length(b), length(c)));
    let scale = 1.0 / unit_texels();
    let middle = vec2(frame.map_u.w, frame.map_v.w);
    for (var y = block.low.y; y <= block.high.y; y++) {
        for (var x = block.low.x; x <= block.high.x; x++) {
            let at = (vec2(f32(x), f32(y)) + 0.5 - middle) * scale;
            let square = dot(at, at);
            let d = vec3(2.0 * at, 1.0 - square);
            let over = turn * dot(normal, d);
            let inside = turn * vec3(dot(bc, d), -dot(ac, d), dot(ab, d));
            if !(over > 0.0) || any(inside < vec3(0.0)) || is_hole_towards(given, d) { continue; }
            // The direction is 1 + square long.
            let apart = min(turn * height / over * (1.0 + square), farthest);
            let key = key_of_depth(apart * frame.map_z.w);
            let texel = y * frame.map_size + x;
            if atomicLoad(&nearest_keys[texel]) < key { atomicMax(&nearest_keys[texel], key); }
        }
    }
}
