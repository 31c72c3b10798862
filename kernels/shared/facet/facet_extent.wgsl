// Where a facet lies: its plane, what its pixel sees of it, and the texels that this may touch.

//@import frame rect facet facing vertex facet_box
//@needs override CLAMPED: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read_write> facets: array<Facet>;

// A triangle, its vertices by rising index, and their edges from the first.
struct Shape {
    triangle: u32,
    given: vec4<u32>,  // w: 1 for one of a closed body
    i: vec3<u32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    ab: vec3<f32>,
    ac: vec3<f32>,
}

fn shape_of(t: u32) -> Shape {
    var s: Shape;
    s.triangle = t;
    s.given = triangles[t];
    let i = rising(s.given.xyz);
    s.i = i;
    let a = world_of(i.x);
    let b = world_of(i.y);
    let c = world_of(i.z);
    s.a = to_eye(a);
    s.b = to_eye(b);
    s.c = to_eye(c);
    s.ab = (b - a) * frame.eye.w;
    s.ac = (c - a) * frame.eye.w;
    return s;
}

// Power of two by which the largest component of a vector is at least 1 and less than 2.
fn power_of_two(v: vec3<f32>) -> f32 {
    return bitcast<f32>(0x7f000000u - (bitcast<u32>(largest(v)) & 0x7f800000u));
}

fn is_clamped() -> bool {
    if CLAMPED == 2u { return (frame.flags & FLAG_CLAMP) != 0u; }
    return CLAMPED == 1u;
}

// Part of a facet that a pixel sees.
struct FacetExtent {
    plane: vec4<f32>,
    ray: vec3<f32>,      // to its sample `origin`
    depth: f32,          // of the plane along that
    limit: f32,          // view depth beyond which the plane is not followed
    outline: OutlineBox,
}

// Of a facet of a triangle that turns to the light as told, in a part of its pixel; `merged`: it has samples
// of others.
fn extent_of(f: u32, part: vec4<f32>, shape: Shape, turn: f32, merged: bool) -> FacetExtent {
    let a = shape.a;
    let spread = cross(shape.ab, shape.ac);
    let normal = turn * spread * power_of_two(spread);
    // Below 0 where single precision does not see it.
    let plane = vec4(normal, min(dot(normal, a), -1e-9 * largest(a)));
    let pixel = facets[f].pixel;
    let ray = ray_at(pixel, facets[f].origin);
    let depth = plane.w / dot(normal, ray);
    let far_corner = max(dot(a, frame.forward.xyz),
        max(dot(shape.b, frame.forward.xyz), dot(shape.c, frame.forward.xyz)));
    // One facet is followed well beyond its own triangle, but not to the horizon.
    let clamped = is_clamped();
    let near = clamped && (frame.flags & FLAG_BEYOND) == 0u;
    var reached = far_corner;
    if clamped && merged { reached = max(far_corner, facets[f].limit); }
    let limit = max(reached, depth) * select(4.0, 1.0001, near);
    var outline = facet_box(pixel, part, plane, limit);
    if near && !merged { cut_to_triangle(&outline, a, shape.b, shape.c); }
    return FacetExtent(plane, ray, depth, limit, outline);
}

fn is_merged(f: u32) -> bool {
    return is_clamped() && (facets[f].state == STATE_MERGED || (facets[f].state & WAS_MERGED) != 0u);
}

// The texels that an outline, grown by a margin, may touch: all of them where its place is not known.
fn texels_of(outline: OutlineBox, margin: f32) -> vec2<u32> {
    if !outline.known { return pack_rect(Rect(vec2(0u), vec2(frame.map_size - 1u))); }
    return cells_touched(outline.low - margin, outline.high + margin, vec2(frame.map_size));
}

// Whether an outline that is not in front of the light lies beyond a side of the view.
fn lies_beside(outline: OutlineBox) -> bool {
    return !outline.in_front && outline.beyond != 0u && (frame.flags & FLAG_PERSPECTIVE) != 0u;
}
