// The 128-bit record of a texel of `spsm`, and the sheet it encodes: the triangle's three edges and its
// plane, around the texel's centre, in texels. `slopes` holds of each code the threshold above it, its value
// and a bound.
// ENCODING 0 (Lecocq 2013, section 3.3): x | y << 16 of each vertex over the map; depth << 16 | slope y << 8
// | slope x.
// ENCODING 1: per edge direction << 20 | distance << 8 | a byte of depth; slope y << 16 | slope x. SPLIT 1:
// the upper and the lower half of the map are arrays of their own; at 4096 x 4096 each is as large as a
// binding may be. SPLIT 0: the upper array holds all of it. A record whose last word is EMPTY_WORD holds
// nothing: no slope has that code.

//@import frame cross_sign
//@needs override ENCODING: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> slopes: array<vec4<f32>, 256>;

const EMPTY_WORD = 0xffffffffu;
const FAR_EDGE = 64.0;          // texels: an edge beyond the code's range
// Doubt of the depth of what lies beyond the code's range: it is before nothing
const BEYOND = 1.0e6;
// A conservatively covered centre lies at most half a texel and the margins outside an edge
const NEAREST_EDGE = -0.75;

fn upper_rows() -> u32 { return (frame.map_size + 1u) / 2u; }

struct Sheet {
    edges: array<vec3<f32>, 3>, // inside where dot((x, y, 1), edge) >= 0; |x| + |y| of the normal is 1
    depth: vec3<f32>,           // depth = dot((x, y, 1), depth)
    doubt: vec3<f32>,           // how far that may be off: dot((|x|, |y|, 1), doubt)
    held: bool,
}

// Rounding error of a place in the light view, texels: a thirty-second of the worst case that the frame
// knows, which triangles of ordinary size do not come near; the margin of other methods would keep texels for
// triangles beside them.
fn place_noise() -> f32 {
    return 0.0009765625 + 0.03125 * (frame.map_margin - 0.015625);
}

// Likewise of a depth.
fn depth_noise() -> f32 {
    return 1e-6 + 0.03125 * frame.depth_margin;
}

fn slope_code(slope: f32) -> u32 {
    var code = 0u;
    for (var step = 128u; step > 0u; step >>= 1u) {
        let next = code + step;
        if next < 255u && slopes[next - 1u].x <= slope { code = next; }
    }
    return code;
}

// Slopes in 16 bits: sign, 5 bits of exponent from 2^-20, 10 of mantissa; 0 below, held at the largest above.
fn slope_code_16(slope: f32) -> u32 {
    let bits = bitcast<u32>(slope);
    let size = ((bits & 0x7fffffffu) + 0x1000u) >> 13u;
    let code = clamp(i32(size) - (107 << 10), 0, 0x7ffe);
    return u32(code) | ((bits >> 31u) << 15u);
}

fn slope_of_16(code: u32) -> f32 {
    let size = code & 0x7fffu;
    if size == 0u { return 0.0; }
    return bitcast<f32>(((size + (107u << 10u)) << 13u) | ((code >> 15u) << 31u));
}

fn unorm_code(value: f32, most: f32) -> u32 {
    return u32(floor(clamp(value, 0.0, 1.0) * most + 0.5));
}

// Likewise of a depth: what lies beyond the range, as a ground behind all casters may, has the code after the
// last.
fn depth_code(value: f32, most: f32) -> u32 {
    return u32(min(floor(max(value, 0.0) * most + 0.5), most + 1.0));
}

// Direction of a normal with |x| + |y| = 1 as its place around the diamond, 1024 steps a side.
fn direction_code(n: vec2<f32>) -> u32 {
    let place = select(3.0 + n.x, 1.0 - n.x, n.y >= 0.0);
    return u32(floor(place * 1024.0 + 0.5)) & 4095u;
}

fn direction_of(code: u32) -> vec2<f32> {
    let place = f32(code) * 0.0009765625;
    let x = select(place - 3.0, 1.0 - place, place <= 2.0);
    return vec2(x, (1.0 - abs(x)) * select(-1.0, 1.0, place <= 2.0));
}

fn distance_code(d: f32) -> u32 {
    return u32(floor(clamp((d - NEAREST_EDGE) * 1024.0, 0.0, 4095.0) + 0.5));
}

fn distance_of(code: u32) -> f32 {
    return select(f32(code) * 0.0009765625 + NEAREST_EDGE, FAR_EDGE, code == 4095u);
}

// The edge from a to b, both relative to the centre.
fn edge_of(a: vec2<f32>, b: vec2<f32>, turn: f32) -> vec3<f32> {
    let n = turn * vec2(a.y - b.y, b.x - a.x);
    let size = abs(n.x) + abs(n.y);
    if !(size > 0.0) { return vec3(1.0, 0.0, NEAREST_EDGE); }
    let m = n / size;
    return vec3(m, -dot(m, a));
}

struct Corners { a: vec3<f32>, b: vec3<f32>, c: vec3<f32> }

// Per texel x, per texel y, at the centre; flat where the triangle has no area there.
fn plane_of(t: Corners) -> vec3<f32> {
    let ab = t.b - t.a;
    let ac = t.c - t.a;
    let area = ab.x * ac.y - ab.y * ac.x;
    let slope = vec2(ab.z * ac.y - ac.z * ab.y, ac.z * ab.x - ab.z * ac.x) / area;
    let most = 2048.0 * f32(frame.map_size);
    if !(abs(slope.x) < most && abs(slope.y) < most) { return vec3(0.0, 0.0, min(t.a.z, min(t.b.z, t.c.z))); }
    return vec3(slope, t.a.z - dot(slope, t.a.xy));
}

// A line over the map as an edge around a texel's centre.
fn line_around(line: vec3<f32>, centre: vec2<f32>) -> vec3<f32> {
    let size = abs(line.x) + abs(line.y);
    if !(size > 0.0) { return vec3(1.0, 0.0, NEAREST_EDGE); }
    return vec3(line.xy, dot(line, vec3(centre, 1.0))) / size;
}

// Edges and plane are relative to the texel's centre.
fn encode_lines(edges: array<vec3<f32>, 3>, plane: vec3<f32>) -> vec4<u32> {
    let steep = plane.xy * f32(frame.map_size);
    // 24 bits over depths from -1 to 2: the centre may lie outside a steep triangle.
    let depth = depth_code((plane.z + 1.0) / 3.0, 16777214.0);
    return vec4(
        (direction_code(edges[0].xy) << 20u) | (distance_code(edges[0].z) << 8u) | (depth >> 16u),
        (direction_code(edges[1].xy) << 20u) | (distance_code(edges[1].z) << 8u) | ((depth >> 8u) & 255u),
        (direction_code(edges[2].xy) << 20u) | (distance_code(edges[2].z) << 8u) | (depth & 255u),
        (slope_code_16(steep.y) << 16u) | slope_code_16(steep.x));
}

// Corners are relative to the texel's centre, which is `centre` in the map.
fn encode_record(t: Corners, centre: vec2<f32>) -> vec4<u32> {
    let plane = plane_of(t);
    let steep = plane.xy * f32(frame.map_size);
    if ENCODING == 0u {
        let side = f32(frame.map_size);
        let a = (t.a.xy + centre) / side;
        let b = (t.b.xy + centre) / side;
        let c = (t.c.xy + centre) / side;
        return vec4(
            unorm_code(a.x, 65535.0) | (unorm_code(a.y, 65535.0) << 16u),
            unorm_code(b.x, 65535.0) | (unorm_code(b.y, 65535.0) << 16u),
            unorm_code(c.x, 65535.0) | (unorm_code(c.y, 65535.0) << 16u),
            (depth_code(plane.z, 65534.0) << 16u) | (slope_code(steep.y) << 8u) | slope_code(steep.x));
    }
    let ab = t.b.xy - t.a.xy;
    let ac = t.c.xy - t.a.xy;
    let turn = select(-1.0, 1.0, ab.x * ac.y - ab.y * ac.x > 0.0);
    return encode_lines(
        array(edge_of(t.a.xy, t.b.xy, turn), edge_of(t.b.xy, t.c.xy, turn), edge_of(t.c.xy, t.a.xy, turn)),
        plane);
}

// A coded vertex of ENCODING 0.
fn code_of(word: u32) -> vec2<i32> {
    return vec2(i32(word & 0xffffu), i32(word >> 16u));
}

// From the texel's centre to it, in units of 1 / 131070 texel: a whole number, below 2^30.
fn steps_to(code: vec2<i32>, centre: vec2<f32>) -> vec2<i32> {
    return code * (2 * i32(frame.map_size)) - vec2<i32>(2.0 * centre) * 65535;
}

// The edge between two coded vertices. Which side of it the texel's centre lies on is exact.
fn coded_edge(a: vec2<i32>, b: vec2<i32>, turn: i32) -> vec3<f32> {
    var e = edge_of(vec2<f32>(a) / 131070.0, vec2<f32>(b) / 131070.0, f32(turn));
    if any(a != b) { e.z = f32(turn * cross_sign(a, b)) * max(abs(e.z), 1e-12); }
    return e;
}

fn decode_edge(word: u32) -> vec3<f32> {
    return vec3(direction_of(word >> 20u), distance_of((word >> 8u) & 4095u));
}

fn decode_record(r: vec4<u32>, centre: vec2<f32>) -> Sheet {
    var s: Sheet;
    s.held = r.w != EMPTY_WORD;
    let per_texel = 1.0 / f32(frame.map_size);
    if ENCODING == 0u {
        let p = code_of(r.x);
        let q = code_of(r.y);
        let t = code_of(r.z);
        let area = cross_sign(q - p, t - p);
        let turn = select(-1, 1, area > 0);
        let a = steps_to(p, centre);
        let b = steps_to(q, centre);
        let c = steps_to(t, centre);
        s.edges = array(coded_edge(a, b, turn), coded_edge(b, c, turn), coded_edge(c, a, turn));
        if area == 0 { s.edges[0] = vec3(1.0, 0.0, -FAR_EDGE); }
        let x = slopes[r.w & 255u];
        let y = slopes[(r.w >> 8u) & 255u];
        s.depth = vec3(x.y * per_texel, y.y * per_texel, f32(r.w >> 16u) / 65534.0);
        s.doubt = vec3(x.z * per_texel, y.z * per_texel, select(7.7e-6, BEYOND, (r.w >> 16u) == 65535u));
        return s;
    }
    s.edges = array(decode_edge(r.x), decode_edge(r.y), decode_edge(r.z));
    let depth = ((r.x & 255u) << 16u) | ((r.y & 255u) << 8u) | (r.z & 255u);
    let slope = vec2(slope_of_16(r.w & 0xffffu), slope_of_16(r.w >> 16u)) * per_texel;
    s.depth = vec3(slope, f32(depth) * (3.0 / 16777214.0) - 1.0);
    // Half a step of the mantissa, half of the depth's, and what f32 leaves of it.
    s.doubt = vec3(abs(slope) * 0.00048828125 + 9.5e-7 * per_texel, select(4e-7, BEYOND, depth == 16777215u));
    return s;
}
