// Holes of alpha-tested triangles at places of the light's map.

//@import frame undivided facing alpha roles
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> map_points: array<vec4<f32>>;

// A point of the map from a place there, times its divisor, and that.
fn from_place(p: vec4<f32>, at: vec2<f32>) -> vec3<f32> {
    if p.w > 0.0 { return vec3((p.xy - at) * p.w, p.w); }
    let q = undivided(p, frame.light_low.w);
    return vec3(q.xy - at * q.w, q.w);
}

// Whether an alpha-tested triangle has a hole at a place of the map, or casts nothing.
fn is_hole(given: vec4<u32>, at: vec2<f32>) -> bool {
    if ALPHA == 0u || !is_tested(given.w) { return false; }
    if !casts(given.w) { return true; }
    let a = from_place(map_points[given.x], at);
    let b = from_place(map_points[given.y], at);
    let c = from_place(map_points[given.z], at);
    let shares = vec3(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x);
    let all = shares.x + shares.y + shares.z;
    return all != 0.0 && !is_solid_by(given.w, shares.yz / all);
}
