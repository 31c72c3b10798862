// Receiver of a pixel, for methods of one receiver a pixel: the plane of the triangle at its centre, and its
// place in the light view.

//@import frame facing from_lamp pixel_ray roles paraboloid
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples: array<vec4<f32>, 64>;
//@needs var<storage, read> id_keys: array<u32>;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> points: array<vec4<f32>>;

const SEEN_NONE = 0u;
const SEEN_DARK = 1u;   // faces away from the light, or is edge-on to it
const SEEN_OPEN = 2u;

struct Receiver {
    seen: u32,
    normal: vec3<f32>,  // towards the light
    height: f32,        // dot(normal, point) on the plane
    at: vec3<f32>,      // a point of it
    slope: vec2<f32>,   // depth per texel to the right and down; of a paraboloid view at the pixel's middle
    far: f32,           // depth of the triangle's farthest corner
    sides: array<vec3<f32>, 3>, // planes through the eye and its edges
}

fn depth_of(p: vec3<f32>) -> f32 {
    if is_paraboloid() { return paraboloid_depth(from_light(p)); }
    let q = from_lamp(p);
    let z = dot(frame.map_z, q);
    if (frame.flags & FLAG_PERSPECTIVE) == 0u { return z; }
    let w = dot(frame.map_w, q);
    return select(3.0e38, z / w, w > frame.light_low.w);
}

fn receiver_of(pixel: u32) -> Receiver {
    var r: Receiver;
    let t = ~id_keys[pixel];
    if t >= frame.triangle_count { return r; }
    let given = triangles[t].xyz;
    if !receives_any(triangles[t].w) { return r; }
    var i = given;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    var normal = cross(b - a, c - a);
    // A power of two: about 1
    normal *= bitcast<f32>(0x7f000000u - (bitcast<u32>(largest(normal)) & 0x7f800000u));
    let to_light = frame.light.xyz - frame.light.w * a;
    let side = dot(normal, to_light);
    r.seen = SEEN_DARK;
    if !(abs(side) > 9.5367e-7 * length(normal) * length(to_light)) { return r; }
    if (frame.flags & FLAG_CLOSED) != 0u && (side < 0.0) != is_reversed(given, i) { return r; }
    r.normal = normal * sign(side);
    r.height = dot(r.normal, a);
    r.at = a;
    r.sides = array(cross(a, b - a), cross(b, c - b), cross(c, a - c));
    if r.height >= 0.0 { return r; }
    r.seen = SEEN_OPEN;
    r.far = max(depth_of(a), max(depth_of(b), depth_of(c)));
    let p = vec4(r.normal, -r.height);
    var s = -vec2(dot(p, frame.back_u), dot(p, frame.back_v)) / dot(p, frame.back_z);
    if is_paraboloid() { s = paraboloid_slope(r.normal, from_light(plane_point(r, pixel_ray(pixel)).xyz)); }
    // Steeper than all depth within a texel: nothing more is told by it.
    r.slope = clamp(s, vec2(-1000.0), vec2(1000.0));
    if !(abs(s.x) < 3.0e38 && abs(s.y) < 3.0e38) { r.slope = vec2(0.0); }
    return r;
}

// Where a ray meets the plane; w is 0 where it misses it.
fn plane_point(r: Receiver, ray: vec3<f32>) -> vec4<f32> {
    let over = dot(r.normal, ray);
    let depth = r.height / over;
    let raw = ray * depth;
    // Back onto the plane, from which rounding moved it.
    return vec4(raw - ray * (dot(r.normal, raw - r.at) / over), select(0.0, 1.0, depth > 0.0));
}

// The place of such a point in the light view (texel x, y, depth); w is 0 where there is none, or it is not
// in front of the light.
fn place_at(point: vec4<f32>) -> vec4<f32> {
    if is_paraboloid() {
        let rel = from_light(point.xyz);
        let at = paraboloid_texel(frame.map_u, frame.map_v, frame.map_w, rel);
        let seen = point.w != 0.0 && at.z > 0.0 && abs(at.x) < 3.0e38 && abs(at.y) < 3.0e38;
        return vec4(at.xy, paraboloid_depth(rel), select(0.0, 1.0, seen));
    }
    let p = from_lamp(point.xyz);
    var uvz = vec3(dot(frame.map_u, p), dot(frame.map_v, p), dot(frame.map_z, p));
    var front = point.w != 0.0;
    if (frame.flags & FLAG_PERSPECTIVE) != 0u {
        let w = dot(frame.map_w, p);
        front = front && w > frame.light_low.w;
        uvz /= w;
    }
    return vec4(uvz, select(0.0, 1.0, front && abs(uvz.x) < 3.0e38 && abs(uvz.y) < 3.0e38));
}

// A sample's place in the light view, see place_at.
fn place_of(r: Receiver, ray: vec3<f32>) -> vec4<f32> {
    return place_at(plane_point(r, ray));
}

// Whether a ray meets the triangle itself: beside it the plane need not be what the pixel shows.
fn meets_triangle(r: Receiver, ray: vec3<f32>) -> bool {
    let v = vec3(dot(r.sides[0], ray), dot(r.sides[1], ray), dot(r.sides[2], ray));
    return all(v >= vec3(0.0)) || all(v <= vec3(0.0));
}

// Change of the receiver's depth from a place to another.
fn rise_to(r: Receiver, at: vec3<f32>, place: vec2<f32>) -> f32 {
    let even = dot(r.slope, place - at.xy);
    if !is_paraboloid() { return even; }
    let depth = paraboloid_plane(r.normal, from_light(r.at), place);
    return select(even, depth - at.z, depth > 0.0);
}

// Depth of the receiver around a texel's centre: per x, per y, at it.
fn receiver_around(r: Receiver, at: vec4<f32>, centre: vec2<f32>) -> vec3<f32> {
    return vec3(r.slope, at.z + dot(r.slope, centre - at.xy));
}

fn middle_of(texel: vec2<i32>) -> vec2<f32> { return vec2<f32>(texel) + 0.5; }

fn sample_ray(pixel: u32, k: u32) -> vec3<f32> {
    let pair = samples[k >> 1u];
    return ray_at(pixel, select(pair.xy, pair.zw, (k & 1u) == 1u));
}

fn sample_place(r: Receiver, pixel: u32, k: u32) -> vec4<f32> {
    return place_of(r, sample_ray(pixel, k));
}

// The texel of a place, held near the map.
fn texel_of(at: vec4<f32>) -> vec2<i32> {
    return vec2<i32>(clamp(floor(at.xy), vec2(-9.0), vec2(65536.0)));
}
