// A triangle of which a part lies behind the light's nearest distance: the lines of its edges and its plane
// over the map, found without division (Olano and Greer 1997), so that they hold for the part in front.

//@import frame undivided
//@needs var<uniform> frame: Frame;

struct CutShape {
    edges: array<vec3<f32>, 3>, // inside where dot((x, y, 1), edge) >= 0
    depth: vec3<f32>,           // depth = dot((x, y, 1), depth)
    nearest: f32,
    farthest: f32,
}

// Takes the part of an edge in front into a range of depths.
fn with_edge(range: vec2<f32>, a: vec4<f32>, b: vec4<f32>) -> vec2<f32> {
    var found = range;
    if a.w > 0.0 { found = vec2(min(found.x, a.z), max(found.y, a.z)); }
    if (a.w > 0.0) != (b.w > 0.0) {
        let near = frame.light_low.w;
        let p = undivided(a, near).zw;
        let q = undivided(b, near).zw;
        let at = mix(p.x, q.x, clamp((p.y - near) / (p.y - q.y), 0.0, 1.0)) / near;
        found = vec2(min(found.x, at), max(found.y, at));
    }
    return found;
}

// Of a triangle whose cover knows its edges.
fn cut_shape(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> CutShape {
    let near = frame.light_low.w;
    let whole = array(undivided(a, near), undivided(b, near), undivided(c, near));
    let p = whole[0].xyw;
    let q = whole[1].xyw;
    let r = whole[2].xyw;
    let det = dot(p, cross(q, r));
    let turn = select(-1.0, 1.0, det > 0.0);
    var s: CutShape;
    s.edges = array(turn * cross(p, q), turn * cross(q, r), turn * cross(r, p));
    let z = vec3(whole[0].z, whole[1].z, whole[2].z);
    s.depth = (z.x * cross(q, r) + z.y * cross(r, p) + z.z * cross(p, q)) / det;
    let range = with_edge(with_edge(with_edge(vec2(3.0e38, -3.0e38), a, b), b, c), c, a);
    s.nearest = range.x;
    s.farthest = range.y;
    return s;
}
