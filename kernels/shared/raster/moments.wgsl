// Mean and variance of the depths of squares of texels, level above level: level 0 are the texels, a cell of
// level k is a square of 2^k of them a side, cut at the map's border.

//@import frame front_split
//@needs var<uniform> frame: Frame;

struct MapLevels {
    far: f32,      // depth where there is no caster: well beyond that of anything
    count: u32,    // levels above the texels
    second: u32,   // where the falling exponential's begin, or third and fourth moments, behind the others
    pad: u32,
    starts: array<vec4<u32>, 4>,  // where each begins among the moments
}

@group(0) @binding(1) var<uniform> levels: MapLevels;

// Cells a side of a level.
fn level_side(level: u32) -> u32 {
    return ((frame.map_size - 1u) >> level) + 1u;
}

fn level_start(level: u32) -> u32 {
    return levels.starts[level >> 2u][level & 3u];
}

// Measure that moments are of: a depth itself, or its exponential, with an exponent above 0 the rising one,
// at most 1, below 0 the falling one, turned over, so that it grows with depth too.
fn measure(depth: f32, exponent: f32) -> f32 {
    let share = depth / levels.far;
    if exponent > 0.0 { return exp(exponent * (share - 1.0)); }
    return select(-exp(exponent * share), depth, exponent == 0.0);
}

// Of a texel by itself.
fn texel_moments(key: u32, exponent: f32) -> vec2<f32> {
    return vec2(measure(select(depth_of_key(key), levels.far, key == 0u), exponent), 0.0);
}

// Third and fourth central moments of four parts, `offs` of their means from the mean of all.
fn mixed_high(
    offs: vec4<f32>,
    two: vec4<f32>,
    three: vec4<f32>,
    four: vec4<f32>,
    shares: vec4<f32>,
) -> vec2<f32> {
    let squares = offs * offs;
    let third = three + offs * (3.0 * two + squares);
    let fourth = four + 4.0 * offs * three + squares * (6.0 * two + squares);
    return vec2(dot(third, shares), dot(fourth, shares));
}

// Of four parts, whose shares add up to 1. Equal means stay what they are, to the bit.
fn mixed(means: vec4<f32>, variances: vec4<f32>, shares: vec4<f32>) -> vec2<f32> {
    let mean = means.x + dot(means - means.x, shares);
    let off = means - mean;
    return vec2(mean, dot(variances + off * off, shares));
}
