// Parts of a surface within the reach of a light: of its range, and of its cone.

//@import frame facet facing vertex pixel_ray light_part
//@needs var<uniform> frame: Frame;
//@needs var<uniform> part: LightPart;
//@needs var<uniform> samples: array<vec4<f32>, 64>;
//@needs var<storage, read> triangles: array<vec4<u32>>;

// A triangle's plane: dot(normal, point) = height.
struct Plane {
    normal: vec3<f32>,
    height: f32,
}

fn plane_of(t: u32) -> Plane {
    let i = rising(triangles[t].xyz);
    let normal = cross(edge_of(i.x, i.y), edge_of(i.x, i.z));
    return Plane(normal, dot(normal, point_of(i.x)));
}

// How far within reach a point is, below 0 outside: it changes by at most twice the way between two points.
fn within_by(p: vec3<f32>) -> f32 {
    let away = p - frame.light.xyz;
    let far = length(away);
    return min(min(part.range * frame.eye.w, 1e30) - far, dot(away, part.axis) - part.cosine * far);
}

// Whether the plane is met ahead by a ray, within reach.
fn reaches(plane: Plane, ray: vec3<f32>) -> bool {
    let t = plane.height / dot(plane.normal, ray);
    return t > 0.0 && within_by(ray * t) >= 0.0;
}

const REACH_NONE = 0u;
const REACH_SOME = 1u;
const REACH_ALL = 2u;

// How much of a pixel's square in the plane is surely within reach.
fn reach_of(plane: Plane, pixel: u32) -> u32 {
    let ray = pixel_ray(pixel);
    let t = plane.height / dot(plane.normal, ray);
    let middle = ray * t;
    var radius = 0.0;
    var ahead = t > 0.0;
    for (var k = 0u; k < 4u; k++) {
        let corner = ray_at(pixel, vec2(f32(k & 1u), f32(k >> 1u)) * (2.0 * PIXEL_REACH) - PIXEL_REACH);
        let to = plane.height / dot(plane.normal, corner);
        ahead = ahead && to > 0.0;
        radius = max(radius, distance(corner * to, middle));
    }
    if !ahead { return REACH_SOME; }
    let within = within_by(middle);
    if within > 2.5 * radius { return REACH_ALL; }
    return select(REACH_SOME, REACH_NONE, within < -2.5 * radius);
}

// The bits of a word's samples that meet the plane within reach.
fn reached_in(plane: Plane, pixel: u32, word: u32, bits: u32) -> u32 {
    var reached = 0u;
    for (var left = bits; left != 0u; left &= left - 1u) {
        let k = firstTrailingBit(left);
        let two = samples[(word << 4u) + (k >> 1u)];
        let offset = select(two.xy, two.zw, (k & 1u) != 0u);
        reached |= select(0u, 1u << k, reaches(plane, ray_at(pixel, offset)));
    }
    return reached;
}
