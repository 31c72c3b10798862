// Triangles that a light-view map keeps, and which of them lie beside a receiver's own.

//@import frame facing receiver
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> points: array<vec4<f32>>;
//@needs var<storage, read> triangle_keys: array<u32>;

// A triangle, its corners by rising index.
struct Corners {
    i: vec3<u32>,
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
}

fn corners_of(t: u32) -> Corners {
    let i = rising(triangles[t].xyz);
    return Corners(i, points[i.x].xyz, points[i.y].xyz, points[i.z].xyz);
}

// The receiver's own triangle, and whether in that order it runs around its normal.
struct Own {
    t: u32,
    i: vec3<u32>,
    turns: bool,
}

fn own_of(r: Receiver, t: u32) -> Own {
    let c = corners_of(t);
    return Own(t, c.i, dot(cross(c.b - c.a, c.c - c.a), r.normal) > 0.0);
}

fn to_light(p: vec3<f32>) -> vec3<f32> { return frame.light.xyz - frame.light.w * p; }

// Whether a triangle shares an edge with the receiver's, and the two lie on its two sides.
fn is_beside(own: Own, c: Corners) -> bool {
    let shares = vec3(any(vec3(c.i.x) == own.i), any(vec3(c.i.y) == own.i), any(vec3(c.i.z) == own.i));
    let two = dot(select(vec3(0u), vec3(1u), shares), vec3(1u)) == 2u;
    let turns = dot(cross(c.b - c.a, c.c - c.a), to_light(c.a)) > 0.0;
    // The order of a shared edge's ends and the third corner is that of rising index, unless that is between.
    return two && (turns == shares.y) != (own.turns == any(vec3(own.i.y) == c.i));
}

// The triangle of a texel; frame.triangle_count: none.
fn kept_in(texel: vec2<i32>) -> u32 {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return frame.triangle_count; }
    return min(~triangle_keys[u32(texel.y * side + texel.x)], frame.triangle_count);
}
