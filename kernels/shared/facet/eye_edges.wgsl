// Edges of a triangle seen from the eye. An edge is evaluated from its lower vertex index, so that both
// triangles at it get one value with two signs.

//@import frame facing
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> points: array<vec4<f32>>;

// Three vertices, each loaded once: functions of edges and planes are told them.
struct Corners {
    i: vec3<u32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
}

fn corners_at(i: vec3<u32>) -> Corners {
    return Corners(i, points[i.x].xyz, points[i.y].xyz, points[i.z].xyz);
}

// Edge function of the vertices `i` at `a` and `j` at `b` at `ray`, per pixel right, per pixel down, and how
// far it may be off anywhere near.
fn eye_edge(i: u32, j: u32, a: vec3<f32>, b: vec3<f32>, ray: vec3<f32>) -> vec4<f32> {
    let p = select(b, a, i <= j);
    let along = select(a, b, i <= j) - p;
    let m = cross(p, along) * select(-1.0, 1.0, i <= j);
    let v = vec3(dot(m, ray), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
    return vec4(v, 0.0078125 * (abs(v.y) + abs(v.z)) + 2e-6 * largest(p) * largest(along) * largest(ray));
}

// From the eye's ray to a corner at the corner's depth (xyz), and that depth (w). Small near the corner, and
// the same for all triangles around it.
fn from_ray(p: vec3<f32>, ray: vec3<f32>) -> vec4<f32> {
    let depth = dot(p, frame.forward.xyz);
    return vec4(p - depth * ray, depth);
}

// As `eye_edge` the function at a ray, from the end that is nearer to it: around a vertex all edges agree on
// where the ray is.
fn eye_edge_near(i: u32, j: u32, a: vec3<f32>, b: vec3<f32>, ray: vec3<f32>) -> f32 {
    let p = select(b, a, i <= j);
    let q = select(a, b, i <= j);
    let from_p = from_ray(p, ray).xyz;
    let from_q = from_ray(q, ray).xyz;
    let d = select(from_p, from_q, dot(from_q, from_q) < dot(from_p, from_p));
    let v = dot(cross(d, q - p), ray);
    return select(-v, v, i <= j);
}

// View depth of a triangle's plane at a ray, between the depths of its corners, and by how much rounding may
// have moved it; -1 where it is edge-on. Corners are taken in the order of their indices, so triangles of the
// same corners have the same depth.
fn eye_depth(given: Corners, ray: vec3<f32>) -> vec2<f32> {
    var t = given;
    if t.i.x > t.i.y { t = Corners(t.i.yxz, t.b, t.a, t.c); }
    if t.i.y > t.i.z { t = Corners(t.i.xzy, t.a, t.c, t.b); }
    if t.i.x > t.i.y { t = Corners(t.i.yxz, t.b, t.a, t.c); }
    let ab = t.b - t.a;
    let ac = t.c - t.a;
    let normal = cross(ab, ac);
    let over = dot(normal, ray);
    let a = from_ray(t.a, ray);
    let b = from_ray(t.b, ray);
    let c = from_ray(t.c, ray);
    var d = a;
    if dot(b.xyz, b.xyz) < dot(d.xyz, d.xyz) { d = b; }
    if dot(c.xyz, c.xyz) < dot(d.xyz, d.xyz) { d = c; }
    let ahead = dot(normal, d.xyz) / over;
    let depth = d.w + ahead;
    let nearest = min(a.w, min(b.w, c.w));
    let farthest = max(a.w, max(b.w, c.w));
    // The normal's rounding, in what is made of it; that of corners and rays moves the plane along it.
    // Corners bound it.
    let reach = max(largest(t.a), max(largest(t.b), largest(t.c)));
    let sides = 1e-6 * largest(ab) * largest(ac);
    let off = sides * largest(ray);
    let moved = sides * largest(d.xyz) + 1e-6 * reach * largest(normal) * largest(ray) + abs(ahead) * off;
    let known = abs(over) > 2.0 * off;
    let doubt = select(farthest - nearest, min(2.0 * moved / abs(over), farthest - nearest), known);
    return select(vec2(-1.0, 0.0), vec2(clamp(depth, nearest, farthest), doubt), abs(over) > 0.0);
}

// 2^-20: relative difference of depths, besides their doubts, that single precision is not asked about
const TOUCHING = 9.5367432e-7;

// Whether single precision leaves open if a depth, with its doubt, lies beyond the near distance of its ray.
fn is_near_open(depth: vec2<f32>, near: f32) -> bool {
    return depth.x - depth.y < near && depth.y > TOUCHING * near;
}

// Whether a triangle is where the ray is, its edges included.
fn covers_ray(u: Corners, ray: vec3<f32>) -> bool {
    let i = u.i;
    let v = vec3(eye_edge_near(i.x, i.y, u.a, u.b, ray), eye_edge_near(i.y, i.z, u.b, u.c, ray),
        eye_edge_near(i.z, i.x, u.c, u.a, ray));
    return all(v >= vec3(0.0)) || all(v <= vec3(0.0));
}
