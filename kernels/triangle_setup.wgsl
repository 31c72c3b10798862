// triangle_setup: what each triangle is to the light and where it lies in both views. `setup_camera` reads
// `triangles` and `points` and writes `camera_rects` (pixels that a triangle may touch) and how many 8 x 8
// blocks those take (`camera_items`; 0 where the triangle has no work in that view). With FLAG_CLAMP the
// pixels whose squares it may touch count, else those whose centres it may cover. Rectangles are
// conservative; a triangle that crosses the camera's near plane is clipped for its rectangle. With
// FLAG_BACKS_HIDDEN one of a closed body that surely faces away from the eye takes no pixels, nor does one
// that its role leaves unseen. `setup_light`
// reads `map_points` besides and writes `facing` (FRONT, BACK, UNSURE or DROPPED), `light_rects` and
// `light_items` likewise, of texels: those that are `requested`, where that says so. A triangle that is not
// surely in front of the light takes the whole map, one surely behind it nothing. One that goes on beyond
// one of the ends of the map (FLAG_ENDS) takes the whole map, too. Both take the triangles of `kept_clusters`
// and write items by slot; of others nothing is written.

//@import frame dispatch rect facing view_sides map_ends requested_part roles clusters

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;  // w: 1 of a closed body, more: tested
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> facing: array<u32>;
@group(0) @binding(5) var<storage, read_write> camera_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> light_rects: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> camera_items: array<u32>;
@group(0) @binding(8) var<storage, read_write> light_items: array<u32>;
@group(0) @binding(9) var<storage, read> requested: array<u32>;
@group(0) @binding(10) var<storage, read> kept_clusters: array<u32>;

//@import frame_copy

var<private> box_low: vec2<f32>;
var<private> box_high: vec2<f32>;

fn include_on_screen(p: vec3<f32>, depth: f32) {
    let at = vec2(dot(p, frame.pixel_x.xyz), dot(p, frame.pixel_y.xyz)) / depth
        + vec2(frame.pixel_x.w, frame.pixel_y.w);
    box_low = min(box_low, at);
    box_high = max(box_high, at);
}

// The part of edge a-b in front of the near plane.
fn include_edge(a: vec3<f32>, b: vec3<f32>, da: f32, db: f32, near: f32) {
    if da >= near { include_on_screen(a, da); }
    if (da >= near) != (db >= near) {
        include_on_screen(mix(a, b, (near - da) / (db - da)), near);
    }
}

// The pixels of the strip of rows at hand that a box of the image touches.
fn pixels_touched(low: vec2<f32>, high: vec2<f32>) -> vec2<u32> {
    let cells = cells_touched(low, high, frame.image_size + vec2(0u, frame.first_row));
    if is_empty(cells) { return cells; }
    let r = unpack_rect(cells);
    if r.high.y < frame.first_row { return EMPTY_RECT; }
    let first = vec2(0u, frame.first_row);
    return pack_rect(Rect(max(r.low, first) - first, r.high - first));
}

fn camera_rect(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec2<u32> {
    box_low = vec2(1e30);
    box_high = vec2(-1e30);
    let near = frame.forward.w;
    let da = dot(a, frame.forward.xyz);
    let db = dot(b, frame.forward.xyz);
    let dc = dot(c, frame.forward.xyz);
    include_edge(a, b, da, db, near);
    include_edge(b, c, db, dc, near);
    include_edge(c, a, dc, da, near);
    if box_low.x > box_high.x { return EMPTY_RECT; }
    // The middle of an image may lie far from where the view direction meets its plane.
    let shift = max(abs(frame.pixel_x.w), abs(frame.pixel_y.w));
    let reach = max(max(abs(box_low.x), abs(box_low.y)), max(abs(box_high.x), abs(box_high.y)));
    let slack = 0.015625 + 1e-6 * max(reach, shift);
    if (frame.flags & FLAG_CLAMP) != 0u { return pixels_touched(box_low - slack, box_high + slack); }
    // A pixel can be covered only if its centre is in the box.
    let low = ceil(box_low - 0.5 - slack);
    let high = floor(box_high - 0.5 + slack);
    if any(low > high) { return EMPTY_RECT; }
    return pixels_touched(low, high);
}

// Of a triangle whose corners are a, b, c in the light's view, and p, q, r seen from the eye.
fn light_rect(
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    p: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
) -> vec2<u32> {
    let whole = pack_rect(Rect(vec2(0u), vec2(frame.map_size - 1u)));
    let low = min(min(a.xy, b.xy), c.xy);
    let high = max(max(a.xy, b.xy), c.xy);
    let slack = frame.map_margin + 4e-6 * max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let touched = cells_touched(low - slack, high + slack, vec2(frame.map_size));
    var rect = select(touched, whole, ends_beyond(low, high) != 0u);
    let nearest = min(a.w, min(b.w, c.w));
    let farthest = max(a.w, max(b.w, c.w));
    if farthest < -2.0 * frame.light_low.w { rect = EMPTY_RECT; }
    // In most views few reach behind the light: a loop that the others do not enter.
    for (var cut = nearest <= 0.0 && farthest >= -2.0 * frame.light_low.w; cut; cut = false) {
        rect = whole;
        if (frame.flags & FLAG_PERSPECTIVE) == 0u || ends_of_triangle(a, b, c) != 0u { continue; }
        if (sides_beyond(p) & sides_beyond(q) & sides_beyond(r)) != 0u { rect = EMPTY_RECT; }
    }
    return rect;
}

// Corners of a triangle; `none` where they are no good.
struct Corners { a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, none: bool }

fn corners_of(i: vec3<u32>) -> Corners {
    let bad = max(max(i.x, i.y), i.z) >= frame.vertex_count || i.x == i.y || i.y == i.z || i.z == i.x;
    let a = points[min(i.x, frame.vertex_count - 1u)];
    let b = points[min(i.y, frame.vertex_count - 1u)];
    let c = points[min(i.z, frame.vertex_count - 1u)];
    return Corners(a, b, c, bad || a.w * b.w * c.w == 0.0);
}

@compute @workgroup_size(WORKGROUP)
fn setup_camera(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let member = member_of(PART_TRIANGLES, flat_group(group, groups), local);
    let t = member.number;
    if t >= frame.triangle_count { return; }
    let i = triangles[t];
    let corners = corners_of(i.xyz);
    let a = corners.a;
    let b = corners.b;
    let c = corners.c;
    var rect = EMPTY_RECT;
    if !corners.none && is_seen(i.w) { rect = camera_rect(a.xyz, b.xyz, c.xyz); }
    let eye = vec4(0.0, 0.0, 0.0, 1.0);
    let may_hide = (frame.flags & FLAG_BACKS_HIDDEN) != 0u && i.w == 1u;
    if may_hide && facing_of(a.xyz, b.xyz, c.xyz, eye) == BACK { rect = EMPTY_RECT; }
    camera_rects[t] = rect;
    camera_items[member.slot] = block_count(rect);
}

@compute @workgroup_size(WORKGROUP)
fn setup_light(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let member = member_of(PART_TRIANGLES, flat_group(group, groups), local);
    let t = member.number;
    if t >= frame.triangle_count { return; }
    let i = triangles[t];
    let corners = corners_of(i.xyz);
    let a = corners.a.xyz;
    let b = corners.b.xyz;
    let c = corners.c.xyz;
    var side = DROPPED;
    var rect = EMPTY_RECT;
    if !corners.none {
        side = facing_of(a, b, c, frame.light);
        rect = light_rect(map_points[i.x], map_points[i.y], map_points[i.z], a, b, c);
        // With validity masks it may cut a facet.
        if is_culled(frame.flags, i.w, side) & ((frame.flags & FLAG_VALIDITY) == 0u) { rect = EMPTY_RECT; }
        rect = requested_part(rect);
    }
    facing[t] = side;
    light_rects[t] = rect;
    light_items[member.slot] = block_count(rect);
}
