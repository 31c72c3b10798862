// moment_shadows: shadows by the moments of a map's depths, one lookup a pixel in those of its footprint,
// anisotropic: squares as wide as the footprint is across, along it up to MOST_PROBES of them. Of the depths
// there at most the share variance / (variance + (t - mean)^2) lies behind a receiver of depth t behind their
// mean (Chebyshev; Donnelly and Lauritzen 2006), which is taken as lit, less BLEEDING; t is that of the
// receiver's plane at the very place that is looked up. With QUERY_BOTH it is the less of that share of the
// rising and falling exponentials of the depths (Lauritzen and McCool 2008), with QUERY_MEAN the mean of
// rising ones over the receiver's own (Annen et al. 2008). Where the receiver turns less than GRAZING (sine
// of its elevation) to the light, half of it is lit (Oliveira 2009, section 4.2.2). Writes `visibility`.
// QUERY_LAYERS: of the layer of depths that the receiver is in (Lauritzen and McCool 2008, section 4).
// QUERY_WAVES: by the Fourier series of the comparison itself, of TERMS pairs of waves (Annen et al. 2007).
// QUERY_FOUR: at most the share that some depths with these four moments have behind the receiver, or at it
// (Peters and Klein 2015).

//@import frame dispatch facing receiver front_split moments

override BIAS_CONSTANT: f32 = 0.00005;
override BLEEDING: f32 = 0.0;
override GRAZING: f32 = 0.0;
override QUERY: u32 = 0u;
override EXPONENT: f32 = 0.0;  // of the rising exponential; 0 for the depths themselves
const QUERY_DEPTHS = 0u;
const QUERY_MEAN = 1u;
const QUERY_BOTH = 2u;
const QUERY_FOUR = 3u;
const QUERY_LAYERS = 4u;
const QUERY_WAVES = 5u;
override LAYERS: u32 = 0u;
override TERMS: u32 = 0u;
override RINGING: f32 = 1.0;    // the last term is weakened to exp(-RINGING)
override FLATTEST: f32 = 0.001;  // of the fourth moment, what it is above that of two depths at the least
const MOST_PROBES = 16u;
const LONGEST_STEP = 65536.0;  // texels: a plane seen edge-on has no end
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> samples: array<vec4<f32>, 64>;  // for `receiver`; none is asked for
@group(0) @binding(3) var<storage, read> id_keys: array<u32>;
@group(0) @binding(4) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(7) var<storage, read> moments: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> visibility: array<f32>;

// Mean, variance, and with QUERY_FOUR third and fourth central moment.
fn cell_moments(level: u32, cell: vec2<u32>, warp: f32) -> vec4<f32> {
    if level == 0u {
        return vec4(texel_moments(nearest_keys[cell.y * frame.map_size + cell.x], warp), 0.0, 0.0);
    }
    let place = level_start(level) + cell.y * level_side(level) + cell.x;
    if QUERY == QUERY_FOUR { return vec4(moments[place], moments[levels.second + place]); }
    return vec4(moments[place + set_of(warp) * levels.second], 0.0, 0.0);
}

fn joined(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>, shares: vec4<f32>) -> vec4<f32> {
    let means = vec4(a.x, b.x, c.x, d.x);
    let variances = vec4(a.y, b.y, c.y, d.y);
    let low = mixed(means, variances, shares);
    if QUERY != QUERY_FOUR { return vec4(low, 0.0, 0.0); }
    let three = vec4(a.z, b.z, c.z, d.z);
    return vec4(low, mixed_high(means - low.x, variances, three, vec4(a.w, b.w, c.w, d.w), shares));
}

// Between the four cells of a level around a place.
fn bilinear(level: u32, at: vec2<f32>, warp: f32) -> vec4<f32> {
    let last = f32(level_side(level) - 1u);
    let place = clamp(at / f32(1u << level) - 0.5, vec2(0.0), vec2(last));
    let low = vec2<u32>(place);
    let high = min(low + 1u, vec2(level_side(level) - 1u));
    let f = place - floor(place);
    let a = cell_moments(level, low, warp);
    let b = cell_moments(level, vec2(high.x, low.y), warp);
    let c = cell_moments(level, vec2(low.x, high.y), warp);
    let d = cell_moments(level, high, warp);
    let shares = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    return joined(a, b, c, d, shares);
}

// Of a square of 2^level texels a side around a place: between two levels.
fn trilinear(level: f32, at: vec2<f32>, warp: f32) -> vec4<f32> {
    let low = u32(level);
    let fine = bilinear(low, at, warp);
    let f = level - f32(low);
    if f == 0.0 { return fine; }
    let coarse = bilinear(min(low + 1u, levels.count), at, warp);
    return joined(fine, coarse, fine, fine, vec4(1.0 - f, f, 0.0, 0.0));
}

// Share of light in a square of 2^level texels a side around a place `wanted`, of a receiver that is at `at`
// (texel x, y, depth).
fn lit_share(r: Receiver, at: vec3<f32>, wanted: vec2<f32>, level: f32) -> f32 {
    // Where cells of the level above are whole all around; the middle of the map where none is whole.
    let cell = min(exp2(ceil(level)), f32(frame.map_size));
    let last = (floor(f32(frame.map_size) / cell) - 0.5) * cell;
    let place = clamp(wanted, vec2(0.5 * cell), vec2(last));
    let depth = at.z + dot(r.slope, place - at.xy) - BIAS_CONSTANT;
    if QUERY == QUERY_WAVES {
        let share = share_of_waves(level, place, depth);
        return select(max(share - BLEEDING, 0.0) / (1.0 - BLEEDING), 1.0, share == 1.0);
    }
    var warp = EXPONENT;
    var other = -EXPONENT;
    var weight = 0.0;
    if QUERY == QUERY_LAYERS {
        // The layer that the receiver is in, and near its end the next, half of each at the end itself.
        let deep = depth * f32(LAYERS);
        let last = max(f32(LAYERS), 1.0) - 1.0;
        warp = clamp(floor(deep), 0.0, last);
        let inside = deep - warp;
        other = clamp(warp + select(-1.0, 1.0, inside > 0.5), 0.0, last);
        weight = clamp(0.5 - min(abs(inside), abs(1.0 - inside)) * (0.5 / LAP), 0.0, 0.5);
        if inside < 0.0 || inside > 1.0 { weight = 0.0; }
    }
    var share = share_of(trilinear(level, place, warp), measure(depth, warp));
    if (QUERY == QUERY_BOTH && share > 0.0) || weight > 0.0 {
        let second = share_of(trilinear(level, place, other), measure(depth, other));
        share = select(min(share, second), mix(share, second, weight), QUERY == QUERY_LAYERS);
    }
    return select(max(share - BLEEDING, 0.0) / (1.0 - BLEEDING), 1.0, share == 1.0);
}

// Mean of the step between depths and the receiver's, 0 before it, 1 behind, a half at it: its series, the
// later terms the weaker, so that it does not ring. Twice that, as much as 1: the receiver is a depth, too.
fn share_of_waves(level: f32, at: vec2<f32>, depth: f32) -> f32 {
    var sum = 0.0;
    for (var term = 0u; term < TERMS; term++) {
        let k = f32(term);
        let found = trilinear(level, at, k);
        let own = wave(depth, k);
        let place = (k + 1.0) / f32(max(TERMS, 1u));
        let faded = exp(-RINGING * place * place);
        sum += faded / ((k + 0.5) * 4.0 * QUARTER_TURN) * (own.y * found.x - own.x * found.y);
    }
    return clamp(1.0 + 4.0 * sum, 0.0, 1.0);
}

// Of measures with these moments, the share that is not less than the receiver's `own`, as far as they tell.
fn share_of(found: vec4<f32>, own: f32) -> f32 {
    let off = own - found.x;
    // Also of four: what bounds more would shadow a slope by its own depths within the footprint.
    if off <= 0.0 { return 1.0; }
    if QUERY == QUERY_MEAN { return found.x / own; }
    if QUERY == QUERY_FOUR { return share_of_four(found.yzw, off); }
    return found.y / (found.y + off * off);
}

// The same by variance, third and fourth central moment, `off` behind the mean. Of the three depths that have
// these moments and of which the receiver's is one, those at it and behind it; the others are the roots of
// the kernel polynomial, in deviations from the mean, and its inverse the share of each (Christoffel).
fn share_of_four(m: vec3<f32>, off: f32) -> f32 {
    if m.x < 1e-16 { return 0.0; }
    let deviation = sqrt(m.x);
    let z = off / deviation;
    let skew = m.y / (m.x * deviation);
    let flat = max(m.z / (m.x * m.x) - 1.0 - skew * skew, FLATTEST * (1.0 + skew * skew));
    let own = z * z - skew * z - 1.0;
    var lit = 1.0 / (1.0 + z * z + own * own / flat);
    let a = own / flat;
    let b = z - skew * a;
    let c = 1.0 - a;
    let q = -0.5 * (b + select(-1.0, 1.0, b >= 0.0) * sqrt(max(b * b - 4.0 * a * c, 0.0)));
    let roots = vec2(select(z, q / a, abs(a) > 1e-9), select(z, c / q, abs(q) > 1e-9));
    for (var k = 0u; k < 2u; k++) {
        let x = roots[k];
        let p = x * x - skew * x - 1.0;
        if x > z { lit += 1.0 / (1.0 + x * x + p * p / flat); }
    }
    return min(lit, 1.0);
}

// Change of the place of the receiver's point `p`, texel `at`, for a change of the ray by a pixel.
fn step_of(r: Receiver, ray: vec3<f32>, step: vec3<f32>, p: vec3<f32>, at: vec2<f32>) -> vec2<f32> {
    let over = dot(r.normal, ray);
    let change = (step - ray * (dot(r.normal, step) / over)) * (r.height / over);
    let across = vec2(dot(frame.map_u.xyz, change), dot(frame.map_v.xyz, change));
    var moved = (across - at * dot(frame.map_w.xyz, change)) / dot(frame.map_w, from_lamp(p));
    if is_paraboloid() { moved = paraboloid_step(from_light(p), change); }
    return clamp(moved, vec2(-LONGEST_STEP), vec2(LONGEST_STEP));
}

fn filtered(r: Receiver, ray: vec3<f32>) -> f32 {
    let p = plane_point(r, ray);
    let at = place_at(p);
    if at.w == 0.0 || any(at.xy < vec2(0.0)) || any(at.xy >= vec2(f32(frame.map_size))) { return 1.0; }
    let x = step_of(r, ray, frame.ray_x.xyz, p.xyz, at.xy);
    let y = step_of(r, ray, frame.ray_y.xyz, p.xyz, at.xy);
    // Axes of the ellipse that the pixel's circle is there.
    let a = x.x * x.x + y.x * y.x;
    let b = x.x * x.y + y.x * y.y;
    let c = x.y * x.y + y.y * y.y;
    let root = sqrt(0.25 * (a - c) * (a - c) + b * b);
    let long = sqrt(max(0.5 * (a + c) + root, 1e-12));
    let short = abs(x.x * y.y - x.y * y.x) / long;
    var along = select(vec2(b, 0.5 * (c - a) + root), vec2(0.5 * (a - c) + root, b), a >= c);
    along *= long * inverseSqrt(max(dot(along, along), 1e-30));
    let probes = u32(clamp(ceil(long / max(short, 1.0)), 1.0, f32(MOST_PROBES)));
    let level = clamp(log2(max(max(short, long / f32(probes)), 1.0)), 0.0, f32(levels.count));
    var sum = 0.0;
    for (var k = 0u; k < probes; k++) {
        sum += lit_share(r, at.xyz, at.xy + along * ((f32(k) + 0.5) / f32(probes) - 0.5), level);
    }
    return sum / f32(probes);
}

@compute @workgroup_size(WORKGROUP)
fn filter_moments(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    var share = select(0.0, 1.0, r.seen == SEEN_NONE);
    if r.seen == SEEN_OPEN {
        let to_light = frame.light.xyz - frame.light.w * r.at;
        let grazes = dot(r.normal, to_light) < GRAZING * length(r.normal) * length(to_light);
        if grazes { share = 0.5; } else { share = filtered(r, pixel_ray(pixel)); }
    }
    visibility[pixel] = share;
}
