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

// View depth of a point of the map.
fn view_depth_of(p: vec4<f32>) -> f32 {
    let q = undivided(p, frame.light_low.w);
    let across = frame.back_u.xyz * q.x + frame.back_v.xyz * q.y;
    return dot(across + frame.back_z.xyz * q.z + frame.back_w.xyz * q.w, frame.forward.xyz);
}

// Whether an alpha-tested triangle has a hole at a place of the map, or casts nothing.
fn is_hole(given: vec4<u32>, at: vec2<f32>) -> bool {
    if ALPHA == 0u || !is_tested(given.w) { return false; }
    if !casts(given.w) { return true; }
    let a = from_place(map_points[given.x], at);
    let b = from_place(map_points[given.y], at);
    let c = from_place(map_points[given.z], at);
    let parts = vec3(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x);
    let all = parts.x + parts.y + parts.z;
    if all == 0.0 { return false; }
    var shares = parts.yz / all;
    if (frame.flags & FLAG_MAPPED) != 0u {
        shares = shares_by_depths(shares, vec3(view_depth_of(map_points[given.x]),
            view_depth_of(map_points[given.y]), view_depth_of(map_points[given.z])));
    }
    return !is_solid_by(given.w, shares);
}
