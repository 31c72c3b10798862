// Mean and variance of depths. Needs `front_split` and `splits`.

// Of a texel by itself.
fn texel_moments(key: u32) -> vec2<f32> {
    return vec2(select(depth_of_key(key), splits.far, key == 0u), 0.0);
}

// Of four parts, whose shares add up to 1. Equal means stay what they are, to the bit.
fn mixed(means: vec4<f32>, variances: vec4<f32>, shares: vec4<f32>) -> vec2<f32> {
    let mean = means.x + dot(means - means.x, shares);
    let off = means - mean;
    return vec2(mean, dot(variances + off * off, shares));
}
