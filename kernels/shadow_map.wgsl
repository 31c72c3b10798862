// shadow_map: shadows by depth comparison with a light-view map of nearest depths (Williams 1978), and
// with percentage-closer filtering (Reeves, Salesin, Cook 1987) of KERNEL x KERNEL texels: the mean of
// bilinear 2 x 2 lookups at whole texels, so that a tap's weight along an axis is (1 - f, 1, ..., 1, f) /
// (KERNEL - 1). KERNEL 1 is the nearest texel. With TAPS it is the mean of so many texels, those at the
// places of a disc around the sample (`disc`, texels), which with TURNED each pixel has at an angle of its
// own. A tap is lit where its depth is not less than the receiver's less the bias: BIAS_CONSTANT and
// BIAS_SLOPE times the steeper of the receiver's two slopes per texel. With RECEIVER_PLANE or TAPS the
// receiver's depth is taken at the tap. Writes `visibility`: the mean over the samples whose rays meet the
// receiver.

//@import frame dispatch facing receiver

override KERNEL: u32 = 1u;
override BIAS_CONSTANT: f32 = 0.00002;
override BIAS_SLOPE: f32 = 1.0;
override RECEIVER_PLANE: u32 = 0u;
override TAPS: u32 = 0u;    // 0: the square of KERNEL
override TURNED: u32 = 0u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<uniform> disc: array<vec4<f32>, 32>;  // two taps each, texels from the sample
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;

// 1 where nothing lies before `depth` in a texel.
fn lit_at(texel: vec2<i32>, depth: f32) -> f32 {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return 1.0; }
    let key = nearest_keys[u32(texel.y * side + texel.x)];
    return select(0.0, 1.0, key == 0u || bitcast<f32>(~key) >= depth);
}

// Cosine and sine of the pixel's angle, by its place in the image: up to an eighth of a turn by the tangent
// of half of it, and that mirrored into the others.
fn turn_of(pixel: u32) -> vec2<f32> {
    let place = vec2<u32>(pixel_corner(pixel));
    var h = (place.x * 0x9e3779b1u) ^ (place.y * 0x85ebca77u);
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    h ^= h >> 15u;
    let t = 0.41421357 * (f32(h >> 8u) / 16777216.0);
    var turn = vec2(1.0 - t * t, 2.0 * t) / (1.0 + t * t);
    turn = select(turn, turn.yx, (h & 1u) != 0u);
    return select(turn, -turn, vec2((h & 2u) != 0u, (h & 4u) != 0u));
}

fn lit_share_of_disc(r: Receiver, at: vec3<f32>, depth: f32, turn: vec2<f32>) -> f32 {
    var lit_taps = 0.0;
    for (var k = 0u; k < TAPS; k++) {
        let pair = disc[k >> 1u];
        let tap = select(pair.xy, pair.zw, (k & 1u) == 1u);
        let place = at.xy + turn.x * tap + turn.y * vec2(-tap.y, tap.x);
        let texel = vec2<i32>(floor(clamp(place, vec2(-16.0), vec2(65536.0))));
        lit_taps += lit_at(texel, depth + rise_to(r, at, middle_of(texel)));
    }
    return lit_taps / f32(max(TAPS, 1u));
}

fn lit_share(r: Receiver, at: vec3<f32>, turn: vec2<f32>) -> f32 {
    let depth = at.z - BIAS_CONSTANT - BIAS_SLOPE * max(abs(r.slope.x), abs(r.slope.y));
    if TAPS != 0u { return lit_share_of_disc(r, at, depth, turn); }
    let first = clamp(at.xy - 0.5 * f32(KERNEL - 1u), vec2(-16.0), vec2(65536.0));
    let low = vec2<i32>(floor(first));
    if KERNEL == 1u { return lit_at(low, depth); }
    let part = first - floor(first);
    let last = i32(KERNEL) - 1;
    var sum = 0.0;
    var lit_taps = 0.0;
    for (var y = 0; y <= last; y++) {
        for (var x = 0; x <= last; x++) {
            var weight = vec2(1.0);
            if x == 0 { weight.x = 1.0 - part.x; } else if x == last { weight.x = part.x; }
            if y == 0 { weight.y = 1.0 - part.y; } else if y == last { weight.y = part.y; }
            let tap = low + vec2(x, y);
            var there = depth;
            if RECEIVER_PLANE != 0u { there += rise_to(r, at, middle_of(tap)); }
            let lit = lit_at(tap, there);
            sum += weight.x * weight.y * lit;
            lit_taps += lit;
        }
    }
    // Rounding of the weights leaves neither a little light in the dark nor a little dark in the light.
    return select(sum / f32(max(last * last, 1)), 1.0, lit_taps == f32(KERNEL * KERNEL));
}

@compute @workgroup_size(WORKGROUP)
fn compare(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN {
        visibility[pixel] = select(0.0, 1.0, r.seen == SEEN_NONE);
        return;
    }
    var turn = vec2(1.0, 0.0);
    if TURNED != 0u { turn = turn_of(pixel); }
    var sum = 0.0;
    var seen = 0.0;
    // There is one at least. The loop ends before it begins a turn of which nothing is kept: a vector would
    // wait for it.
    var k = 0u;
    loop {
        let at = sample_place(r, pixel, k);
        let meets = at.w != 0.0;
        seen += select(0.0, 1.0, meets);
        sum += select(0.0, lit_share(r, at.xyz, turn), meets);
        continuing {
            k++;
            break if k >= frame.sample_count;
        }
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}
