// The boundaries of a triangle's shadow on a facet, as lines of the image.
//
// The eye is the origin; r(x, y) = r + x * rx + y * ry is the ray of the sample at offset (x, y) from the
// pixel centre, the facet's plane is n . p = d, q is its point at one of its samples, from which offsets
// count until the line is done. A plane through the light and an edge starting at `a` has the normal m. Its
// line in the image is zero where d * (m . r(x, y)) - (m . a) * (n . r(x, y)), which is linear:
//     (-s * (n . r),  m . X - s * (n . rx),  m . Y - s * (n . ry)),   s = m . (a - q),
// X = d * rx - q * (n . rx), Y = d * ry - q * (n . ry). Nothing is divided by, and s is small where it
// matters. The triangle's own plane is such a plane too. An edge is evaluated from its lower vertex index, so
// that the two triangles at it see one line from its two sides.

//@import frame facet facing pixel_ray
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> undecided: array<Undecided>;
//@needs var<storage, read> triangles: array<vec4<u32>>;

struct Ground {
    normal: vec3<f32>,
    over: vec3<f32>,        // n . r, n . rx, n . ry; the first is negative
    at: vec3<f32>,          // q
    along_x: vec3<f32>,     // X
    along_y: vec3<f32>,     // Y
    own: vec3<u32>,         // vertices of the facet's triangle, rising
    doubt: f32,             // how far rounding may have moved q along its ray, times -n . r
    tilts: vec3<f32>,       // rounding of the normal, in units of TINY
    pixel: u32,
    origin: vec2<f32>,      // offset of the sample that q belongs to
    alone: bool,            // its samples all lie on its own triangle
    turn: f32,              // 1 if that, in the order of `own`, turns to the light, -1 if it turns away
}

// Four half-planes as matrices: column k holds what line k is at the centre, per pixel right, per pixel down.
struct Lines {
    centre: vec4<f32>,
    right: vec4<f32>,
    down: vec4<f32>,
}

const TINY = 5.9604645e-8;        // 2^-24
const LINE_TRUST = 0.001953125;   // pixels; half of the band in which a sample's side counts as open
// Pixels across and down; above half a step of a rasterizer's grid, by which it may have moved an edge
const CREASE = 0.0025;

const OPEN = -3.0e38;

fn ground_of(k: u32) -> Ground {
    let f = undecided[k];
    var g: Ground;
    g.own = rising(triangles[f.triangle].xyz);
    g.pixel = f.pixel;
    g.origin = f.origin;
    g.normal = f.plane.xyz;
    g.over = vec3(dot(g.normal, ray_at(f.pixel, f.origin)), dot(g.normal, frame.ray_x.xyz),
        dot(g.normal, frame.ray_y.xyz));
    g.at = f.at;
    g.along_x = f.plane.w * frame.ray_x.xyz - g.at * g.over.y;
    g.along_y = f.plane.w * frame.ray_y.xyz - g.at * g.over.z;
    g.tilts = f.tilt * unpack4x8unorm(f.tilts).xyz;
    g.doubt = f.doubt;
    g.alone = (f.tilts & FACET_ALONE) != 0u;
    g.turn = facet_turn(f.tilts);
    return g;
}

fn is_own(v: u32, own: vec3<u32>) -> bool {
    return any(vec3(v) == own);
}

fn owned_by(i: vec3<u32>, own: vec3<u32>) -> vec3<bool> {
    return vec3(is_own(i.x, own), is_own(i.y, own), is_own(i.z, own));
}

// Whether a triangle shares an edge with the facet's own, and seen from the light the two lie on its two
// sides: then it casts nothing on that. `i`: its vertices, rising, `owned` those that are the facet's own,
// `turn`: 1 if in this order it turns to the light, -1 if it turns away.
fn is_beside(g: Ground, i: vec3<u32>, owned: vec3<bool>, turn: f32) -> bool {
    let shared_vertices = dot(select(vec3(0.0), vec3(1.0), owned), vec3(1.0));
    // The order of a shared edge's ends and the third vertex is that of rising index, unless the third is
    // between them.
    let theirs = select(-turn, turn, owned.y);
    let ours = select(-g.turn, g.turn, any(vec3(g.own.y) == i));
    return (shared_vertices == 2.0) & (theirs * ours < 0.0);
}

// A line of the image that bounds a triangle's shadow, moved within CREASE so that the pixel centre is not
// inside.
fn beyond_centre(line: vec3<f32>, is_moved: bool) -> vec3<f32> {
    let near = (line.x >= 0.0) & (line.x <= CREASE * (abs(line.y) + abs(line.z)));
    return vec3(select(line.x, -1e-37, is_moved & near), line.yz);
}

// Height of a point over the facet towards the light: exactly 0 for the facet's own vertices, OPEN where
// rounding leaves its sign open.
fn height_of(g: Ground, shared_vertex: bool, p: vec3<f32>) -> f32 {
    if shared_vertex { return 0.0; }
    let d = p - g.at;
    let h = dot(g.normal, d);
    let bound = TINY * (dot(g.tilts, abs(d)) + 4.0 * (largest(d) + largest(p) + largest(g.at))) + g.doubt;
    return select(OPEN, h, abs(h) > bound);
}

// The line of the plane through `a` with normal `m`, and in w how far rounding may have moved it within the
// pixel; `size` bounds the products that made m, `noise` what the roundings of its factors made of it.
fn line_of(g: Ground, m: vec3<f32>, size: f32, noise: f32, a: vec3<f32>) -> vec4<f32> {
    let s = dot(m, a - g.at);
    let far = largest(a - g.at);
    let error = abs(g.over.x) * (2.0 * TINY * size * (far + largest(a) + largest(g.at)) + noise * far)
        + size * g.doubt;
    let slope = vec2(dot(m, g.along_x) - s * g.over.y, dot(m, g.along_y) - s * g.over.z);
    return vec4(-s * g.over.x - dot(slope, g.origin), slope, error);
}

// Of the edge `e` from `a`.
fn edge_line(g: Ground, a: vec3<f32>, e: vec3<f32>) -> vec4<f32> {
    let l = frame.light.xyz - frame.light.w * a;
    // The point of the light and `a` carry roundings of their own.
    let noise = 4.0 * TINY * largest(e) * (largest(frame.light.xyz) + frame.light.w * largest(a));
    return line_of(g, cross(e, l), 2.0 * largest(e) * largest(l), noise, a);
}

// Of the triangle whose edges from `a` are `ab` and `ac`.
fn own_line(g: Ground, a: vec3<f32>, ab: vec3<f32>, ac: vec3<f32>) -> vec4<f32> {
    return line_of(g, cross(ab, ac), 2.0 * largest(ab) * largest(ac), 0.0, a);
}

// Where edge a-b crosses the facet's plane, heights ha and hb being on different sides.
fn crossing(a: vec3<f32>, b: vec3<f32>, ha: f32, hb: f32) -> vec3<f32> {
    return a + (b - a) * (ha / (ha - hb));
}

struct Segment {
    start: vec3<f32>,
    end: vec3<f32>,
}

// Where a triangle whose corners have heights `h`, not all on one side, crosses the facet's plane.
fn crossings(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>) -> Segment {
    let up = h > vec3(0.0);
    // Two of the three edges cross: the one corner that is alone on its side has both.
    if up.x == up.y { return Segment(crossing(c, a, h.z, h.x), crossing(c, b, h.z, h.y)); }
    if up.x == up.z { return Segment(crossing(b, a, h.y, h.x), crossing(b, c, h.y, h.z)); }
    return Segment(crossing(a, b, h.x, h.y), crossing(a, c, h.x, h.z));
}

// Whether the segment in which a triangle crosses the facet's plane touches the pixel's square; `line` is its
// line. What lies nearer than the near plane, or behind the eye, is cut off.
fn meets_pixel(line: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>, pixel: u32) -> bool {
    if abs(line.x) > 0.5 * (abs(line.y) + abs(line.z)) { return false; }
    let ends = crossings(a, b, c, h);
    var p = ends.start;
    var q = ends.end;
    let near = frame.forward.w;
    let dp = dot(p, frame.forward.xyz);
    let dq = dot(q, frame.forward.xyz);
    if dp < near && dq < near { return false; }
    if dp < near { p += (q - p) * ((near - dp) / (dq - dp)); }
    if dq < near { q += (p - q) * ((near - dq) / (dp - dq)); }
    let at = vec2(dot(p, frame.pixel_x.xyz), dot(p, frame.pixel_y.xyz)) / max(dp, near);
    let to = vec2(dot(q, frame.pixel_x.xyz), dot(q, frame.pixel_y.xyz)) / max(dq, near);
    let corner = pixel_corner(pixel) - vec2(frame.pixel_x.w, frame.pixel_y.w);
    return all(max(at, to) >= corner) && all(min(at, to) <= corner + 1.0);
}
