// Points of `map_points` as they are before division. Needs `frame`.

// Texel x and y and depth times the divisor, and the divisor.
fn undivided(p: vec4<f32>) -> vec4<f32> {
    if p.w > 0.0 { return vec4(p.xyz * p.w, p.w); }
    return vec4(p.xyz, p.w + frame.light_low.w);
}
