// Mean and variance of the depths of squares of texels, level above level: level 0 are the texels, a cell of
// level k is a square of 2^k of them a side, cut at the map's border.

//@import frame front_split
//@needs var<uniform> frame: Frame;
//@needs override LAYERS: u32;
//@needs override TERMS: u32;

const LAP = 0.25;
const QUARTER_TURN = 1.5707963;
const WAVE_MARGIN = 1.1;

struct MapLevels {
    far: f32,      // depth where there is no caster: well beyond that of anything
    count: u32,    // levels above the texels
    // Moments of a set: mean and variance of a warp or layer, third and fourth moments, or means of a wave
    second: u32,
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

// Measure that moments are of: a depth itself, or its exponential, with a warp above 0 the rising one, at
// most 1, below 0 the falling one, turned over, so that it grows with depth too. With LAYERS the place of
// the depth between the ends of a layer, of which `warp` is the number: even parts of the depths of
// casters, which reach LAP of their thickness into the next; the first and the last have no end.
fn measure(depth: f32, warp: f32) -> f32 {
    if LAYERS > 0u {
        let place = depth * f32(LAYERS) - warp;
        let low = select(-LAP, -1e30, warp == 0.0);
        return clamp(place, low, select(1.0 + LAP, 1e30, warp == f32(LAYERS) - 1.0));
    }
    let share = depth / levels.far;
    if warp > 0.0 { return exp(warp * (share - 1.0)); }
    return select(-exp(warp * share), depth, warp == 0.0);
}

// Sine and cosine of term `term` of the step's Fourier series (Annen et al. 2007): of odd halves of a turn
// over WAVE_MARGIN times the depths of all that is there, beyond which the series would turn back. Within
// 4e-7, by Taylor's series about the nearest quarter turn: WGSL leaves its own to 5e-4.
fn wave(depth: f32, term: f32) -> vec2<f32> {
    let turns = (term + 0.5) * min(depth / (WAVE_MARGIN * (levels.far - 1.0)), 1.0);
    let quarter = round(4.0 * turns);
    let angle = QUARTER_TURN * (4.0 * turns - quarter);
    let square = angle * angle;
    let sine = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)));
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    let place = u32(quarter) % 4u;
    let turned = select(vec2(sine, cosine), vec2(cosine, -sine), place % 2u == 1u);
    return select(turned, -turned, place >= 2u);
}

// Of a texel by itself: its measure and no variance, or with TERMS its wave of number `warp`.
fn texel_moments(key: u32, warp: f32) -> vec2<f32> {
    let depth = select(depth_of_key(key), levels.far, key == 0u);
    if TERMS > 0u { return wave(depth, warp); }
    return vec2(measure(depth, warp), 0.0);
}

// The set of moments of a warp, behind the first.
fn set_of(warp: f32) -> u32 {
    return select(select(0u, 1u, warp < 0.0), u32(warp), LAYERS > 0u || TERMS > 0u);
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

// Of four parts, whose shares add up to 1. Equal means stay what they are, to the bit. With TERMS both are
// means.
fn mixed(means: vec4<f32>, variances: vec4<f32>, shares: vec4<f32>) -> vec2<f32> {
    let mean = means.x + dot(means - means.x, shares);
    let off = means - mean;
    return vec2(mean, dot(variances + select(off * off, vec4(0.0), TERMS > 0u), shares));
}
