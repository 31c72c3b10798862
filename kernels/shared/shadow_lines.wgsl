// The boundaries of a triangle's shadow on a facet, as lines of the image. Needs `frame`, `facet`, `facing`,
// `double_float`, and the arrays `triangles` and `positions`.
//
// The eye is the origin; r(x, y) = r + x * rx + y * ry is the ray of the sample at offset (x, y) from the pixel centre, the
// facet's plane is n . p = d, q is its point at the pixel centre. A plane through the light and an edge starting at `a` has
// the normal m. Its line in the image is zero where  d * (m . r(x, y)) - (m . a) * (n . r(x, y)), which is linear:
//     (-s * (n . r),  m . X - s * (n . rx),  m . Y - s * (n . ry)),   s = m . (a - q),
//     X = d * rx - q * (n . rx),  Y = d * ry - q * (n . ry).
// Nothing is divided by, and s is small where it matters. The triangle's own plane is such a plane too.

struct Ground {
    normal: vec3<f32>,
    over: vec3<f32>,        // n . r, n . rx, n . ry; the first is negative
    at: vec3<f32>,          // q
    along_x: vec3<f32>,     // X
    along_y: vec3<f32>,     // Y
    own: vec3<u32>,         // vertices of the facet's triangle, rising
    doubt: f32,             // how far rounding may have moved q along its ray, times -n . r
    tilt: f32,              // relative rounding of the normal, in units of TINY
    pixel: u32,
}

const TINY = 5.9604645e-8;        // 2^-24
const LINE_TRUST = 0.001953125;   // pixels; half of the band in which a sample's side counts as open
const ZERO_46 = 3.6e-12;          // 2^-38: what 46-bit arithmetic leaves of an exact zero, relative

fn world_of(v: u32) -> vec3<f32> {
    return vec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]);
}

fn point_of(v: u32) -> vec3<f32> {
    return ((world_of(v) - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
}

// The same with all bits: a difference of two f32 is the sum of two f32.
fn full_point_of(v: u32) -> Df3 {
    let w = world_of(v);
    let s = frame.eye.w;
    let x = df_sub(two_sum(w.x, -frame.eye.x), vec2(frame.eye_low.x, 0.0)) * s;
    let y = df_sub(two_sum(w.y, -frame.eye.y), vec2(frame.eye_low.y, 0.0)) * s;
    let z = df_sub(two_sum(w.z, -frame.eye.z), vec2(frame.eye_low.z, 0.0)) * s;
    return Df3(x, y, z);
}

fn full_to_light(a: Df3) -> Df3 {
    let l = Df3(vec2(frame.light.x, frame.light_low.x), vec2(frame.light.y, frame.light_low.y), vec2(frame.light.z, frame.light_low.z));
    if frame.light.w == 0.0 { return l; }
    return df3_sub(l, a);
}

fn ground_of(f: Facet) -> Ground {
    var g: Ground;
    let t = f.triangle;
    var i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    g.own = i;
    g.pixel = f.pixel;
    g.normal = f.plane.xyz;
    let ray = pixel_ray(f.pixel);
    g.over = vec3(dot(g.normal, ray), dot(g.normal, frame.ray_x.xyz), dot(g.normal, frame.ray_y.xyz));
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    let q = ray * (f.plane.w / g.over.x);
    g.at = q - ray * (dot(g.normal, q - a) / g.over.x);  // one Newton step takes out the rounding of the quotient
    g.along_x = f.plane.w * frame.ray_x.xyz - g.at * g.over.y;
    g.along_y = f.plane.w * frame.ray_y.xyz - g.at * g.over.z;
    let spread = cross(b - a, c - a);
    g.tilt = 2.0 * largest(b - a) * largest(c - a) / largest(spread);
    g.doubt = TINY * (3.0 * largest(g.at) + g.tilt * largest(g.at - a));
    return g;
}

fn full_normal(i: vec3<u32>) -> Df3 {
    let a = full_point_of(i.x);
    return df3_cross(df3_sub(full_point_of(i.y), a), df3_sub(full_point_of(i.z), a));
}

// Height of a vertex over the facet towards the light; exactly 0 on the plane.
fn height_of(g: Ground, v: u32, p: vec3<f32>) -> f32 {
    if any(vec3(v) == g.own) { return 0.0; }
    let d = p - g.at;
    let h = dot(g.normal, d);
    let bound = TINY * ((g.tilt + 4.0) * largest(d) + 4.0 * (largest(p) + largest(g.at)));
    if abs(h) > bound { return h; }
    return full_height_of(g, v);
}

fn full_height_of(g: Ground, v: u32) -> f32 {
    let n = full_normal(g.own);
    let d = df3_sub(full_point_of(v), full_point_of(g.own.x));
    let h = df3_dot(n, d).x;
    if abs(h) <= ZERO_46 * df3_size(n) * df3_size(d) { return 0.0; }
    return h * sign(dot(g.normal, vec3(n.x.x, n.y.x, n.z.x)));
}

// 1 if the triangle in this order of its vertices faces the light, -1 if it faces away, 0 if it is edge-on.
fn turn_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, i: vec3<u32>) -> f32 {
    let side = facing_of(a, b, c, frame.light);
    if side == FRONT { return 1.0; }
    if side == BACK { return -1.0; }
    let n = full_normal(i);
    let l = full_to_light(full_point_of(i.x));
    let s = df3_dot(n, l).x;
    if abs(s) <= ZERO_46 * df3_size(n) * df3_size(l) { return 0.0; }
    return sign(s);
}

// The line of the plane through `a` with normal `m`; `size` bounds what m's products were.
fn line_of(g: Ground, m: vec3<f32>, a: vec3<f32>) -> vec3<f32> {
    let s = dot(m, a - g.at);
    return vec3(-s * g.over.x, dot(m, g.along_x) - s * g.over.y, dot(m, g.along_y) - s * g.over.z);
}

// Whether rounding may have moved a line that crosses the pixel by more than LINE_TRUST.
fn is_doubtful(g: Ground, line: vec3<f32>, size: f32, a: vec3<f32>) -> bool {
    let slope = abs(line.y) + abs(line.z);
    let error = size * (2.0 * TINY * abs(g.over.x) * (largest(a - g.at) + largest(a) + largest(g.at)) + g.doubt);
    return error > LINE_TRUST * slope && abs(line.x) <= 0.501 * slope + error;
}

fn edge_line(g: Ground, a: vec3<f32>, b: vec3<f32>, i: vec2<u32>) -> vec3<f32> {
    let e = b - a;
    let l = frame.light.xyz - frame.light.w * a;
    let line = line_of(g, cross(e, l), a);
    if !is_doubtful(g, line, 2.0 * largest(e) * largest(l), a) { return line; }
    let p = full_point_of(i.x);
    return full_line(g, df3_cross(df3_sub(full_point_of(i.y), p), full_to_light(p)), p);
}

fn own_line(g: Ground, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, i: vec3<u32>) -> vec3<f32> {
    let line = line_of(g, cross(b - a, c - a), a);
    if !is_doubtful(g, line, 2.0 * largest(b - a) * largest(c - a), a) { return line; }
    return full_line(g, full_normal(i), full_point_of(i.x));
}

fn full_line(g: Ground, m: Df3, a: Df3) -> vec3<f32> {
    let n = full_normal(g.own);
    let d = df3_dot(n, full_point_of(g.own.x));
    let e = df3_dot(m, a);
    // Oriented as g.normal, which may be opposite.
    let turn = sign(dot(g.normal, vec3(n.x.x, n.y.x, n.z.x)));
    return turn * vec3(
        full_value(n, d, m, e, pixel_ray(g.pixel)),
        full_value(n, d, m, e, frame.ray_x.xyz),
        full_value(n, d, m, e, frame.ray_y.xyz));
}

fn full_value(n: Df3, d: vec2<f32>, m: Df3, e: vec2<f32>, ray: vec3<f32>) -> f32 {
    let r = df3_of(ray);
    return df_sub(df_mul(d, df3_dot(m, r)), df_mul(e, df3_dot(n, r))).x;
}

// Whether the segment in which a triangle crosses the facet's plane touches the pixel's square; `line` is its line.
fn meets_pixel(line: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>, pixel: u32) -> bool {
    if abs(line.x) > 0.5 * (abs(line.y) + abs(line.z)) { return false; }
    var low = vec2(3.0e38);
    var high = vec2(-3.0e38);
    var p = array<vec3<f32>, 3>(a, b, c);
    var s = array<f32, 3>(h.x, h.y, h.z);
    for (var k = 0u; k < 3u; k++) {
        let j = (k + 1u) % 3u;
        if (s[k] > 0.0) == (s[j] > 0.0) { continue; }
        let at = p[k] + (p[j] - p[k]) * (s[k] / (s[k] - s[j]));
        let depth = dot(at, frame.forward.xyz);
        if depth <= 0.0 { return true; }
        let xy = vec2(dot(at, frame.pixel_x.xyz), dot(at, frame.pixel_y.xyz)) / depth + vec2(frame.pixel_x.w, frame.pixel_y.w);
        low = min(low, xy);
        high = max(high, xy);
    }
    let corner = vec2(f32(pixel % frame.image_size.x), f32(pixel / frame.image_size.x));
    return all(high >= corner) && all(low <= corner + 1.0);
}
