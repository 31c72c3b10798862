// Points of `map_points` as they are before division.

// Texel x and y and depth times the divisor, and the divisor; `near` is the light view's nearest distance.
fn undivided(p: vec4<f32>, near: f32) -> vec4<f32> {
    if p.w > 0.0 { return vec4(p.xyz * p.w, p.w); }
    return vec4(p.xyz, p.w + near);
}
