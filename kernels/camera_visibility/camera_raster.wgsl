// A caster's triangle in a block of pixels. Edge functions go through the eye, so nothing is clipped and
// nothing divided; each edge is evaluated from its lower vertex index, so both triangles at it get the same
// value, and a centre on it belongs to both.

//@import frame facing near_distance rect work_items span
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> points: array<vec4<f32>>;
//@needs var<storage, read> camera_rects: array<vec2<u32>>;
//@needs var<storage, read> work_offsets: array<u32>;

// Edge function through the eye as (at the corner ray, per pixel right, per pixel down).
fn edge(i: u32, j: u32) -> vec3<f32> {
    let low = min(i, j);
    let p = points[low].xyz;
    let m = cross(p, points[max(i, j)].xyz - p) * select(-1.0, 1.0, i == low);
    return vec3(dot(m, frame.ray_corner.xyz), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
}

struct Seen {
    t: u32,
    block: Rect,
    edges: array<vec3<f32>, 3>,
    normal: vec3<f32>,      // at the corner ray, per pixel right, per pixel down
    distance: f32,
    lean: f32,              // rounding of the depth at a ray of 1, times what the normal is along it
    nearest: f32,
    farthest: f32,
    known: bool,            // which sign is inside; a triangle edge-on to the eye is looked at cell by cell
    beyond: bool,           // all corners surely lie beyond the near distance
}

fn seen_in(item: u32) -> Seen {
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    return seen_of(t, block_of(camera_rects[t], item - work_offsets[slot]));
}

fn seen_of(t: u32, block: Rect) -> Seen {
    var s: Seen;
    s.t = t;
    s.block = block;
    let i = triangles[s.t].xyz;
    s.edges = array(edge(i.x, i.y), edge(i.y, i.z), edge(i.z, i.x));
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    let normal = cross(b - a, c - a);
    s.distance = dot(normal, a);
    // A sliver's normal is mostly rounding, and then on which side of its plane the eye is.
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 3e-6 * largest(b - a) * largest(c - a) * reach;
    s.lean = doubt * frame.ray_corner.w;
    s.normal = vec3(dot(normal, frame.ray_corner.xyz), dot(normal, frame.ray_x.xyz),
        dot(normal, frame.ray_y.xyz));
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    let nearest = min(depths.x, min(depths.y, depths.z));
    s.nearest = max(nearest, frame.forward.w);
    let n = frame.near_plane;
    let through = vec3(dot(a, n.xyz), dot(b, n.xyz), dot(c, n.xyz)) + n.w * depths;
    s.beyond = nearest > frame.forward.w + 1e-6 * reach
        && min(through.x, min(through.y, through.z)) > 1.0 + 3e-6 * reach * largest(n.xyz);
    s.farthest = max(depths.x, max(depths.y, depths.z));
    s.known = abs(s.distance) > max(doubt, 1e-5 * length(normal) * s.farthest);
    return s;
}

// First and last pixel of row `y` where it may be.
fn pixels_of_row(s: Seen, y: u32) -> vec2<u32> {
    let row = f32(frame.first_row + y) + 0.5;
    let turn = sign(s.distance);
    var cut = span_of(s.block.low.x, s.block.high.x);
    if s.known {
        cut = cut_span(cut_span(cut_span(cut, turn * s.edges[0].yzx, row), turn * s.edges[1].yzx, row),
            turn * s.edges[2].yzx, row);
    }
    return cells_of(cut, s.block.low.x, s.block.high.x);
}

// A pixel's centre as (1, x, y) from the corner of the image.
fn centre_at(x: u32, y: u32) -> vec3<f32> {
    return vec3(1.0, f32(x) + 0.5, f32(frame.first_row + y) + 0.5);
}

fn covers_centre(s: Seen, at: vec3<f32>) -> bool {
    let v = vec3(dot(s.edges[0], at), dot(s.edges[1], at), dot(s.edges[2], at));
    return all(v >= vec3(0.0)) || all(v <= vec3(0.0));
}

// How near the triangle may be at a pixel's centre that it covers, and how far: keys that fall with depth, 0
// where it is not seen there. The third is 1 where it may lie nearer than the near distance, else 0.
fn keys_at(s: Seen, at: vec3<f32>) -> vec3<u32> {
    let over = dot(s.normal, at);
    let depth = s.distance / over;
    let lean = s.lean / abs(over);
    let near = near_along(frame.ray_corner.xyz + at.y * frame.ray_x.xyz + at.z * frame.ray_y.xyz);
    if !(abs(over) > 0.0) || !(s.beyond || depth + lean >= near) { return vec3(0u); }
    // A sliver's plane is poorly known; its depth lies between its corners'.
    let held = clamp(depth, s.nearest, s.farthest);
    let doubt = 1e-6 * held + min(lean, s.farthest - s.nearest);
    let keys = ~bitcast<vec2<u32>>(vec2(max(held - doubt, 0.0), held + doubt));
    if !s.beyond && depth - lean < near && lean > 1e-6 * near { return vec3(keys, 1u); }
    return select(vec3(0u), vec3(keys, 0u), s.beyond || depth >= near);
}
