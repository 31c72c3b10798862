// The nearest triangle of each sample of a word, kept by one invocation. Edges and inverse depths are
// compared by bounds of linear functions; what those leave open is computed from the corners. Where two
// surfaces almost touch, the other one is kept as a rival; where more may, the sample is crowded.

//@import frame pixel_ray facing eye_edges eye_view surface_step word_offsets alpha
//@needs override WORDS: u32;
//@needs override SAMPLES: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples: array<vec4<f32>, 64>;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> pixel_list: array<u32>;
//@needs var<storage, read_write> sample_keys: array<u32>;
//@needs var<storage, read_write> rivals_found: array<u32>;

// State of each sample of the word: the complement of its triangle (0: none) and bounds of its inverse depth.
// They are only indexed by what compilers know, so that they stay in registers. Where `rivals` has a bit,
// another triangle almost touches it there: `rivals_found`; the upper bound is then that of both.
var<private> best_keys: array<u32, 32>;
var<private> best_high: array<f32, 32>;
var<private> best_low: array<f32, 32>;
var<private> rivals: u32;
var<private> crowded: u32;

// The triangle that is tested, and the samples for which bounds do not tell; those of the triangles of a
// batch.
var<private> view: View;
var<private> whole: bool;  // it has no holes
var<private> open: u32;
var<private> opens: array<u32, BATCH>;

const BATCH = 8u;

fn corners_of(t: u32) -> vec3<u32> {
    return triangles[t].xyz;
}

// Whether an alpha-tested triangle has a hole where a ray from the eye meets it.
fn is_hole(t: u32, u: Corners, ray: vec3<f32>) -> bool {
    if ALPHA == 0u { return false; }
    let word = triangles[t].w;
    return is_tested(word) && !is_solid(word, u.a, u.b, u.c, vec3(0.0), ray);
}

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// The state kept of a sample.
struct Held { key: u32, high: f32 }

fn held_at(k: u32) -> Held {
    var held = Held(0u, 0.0);
    for (var n = 0u; n < 32u; n++) {
        held.key = select(held.key, best_keys[n], n == k);
        held.high = select(held.high, best_high[n], n == k);
    }
    return held;
}

// Bounds of the inverse of a depth and its doubt: upper, lower.
fn inverse_of(depth: vec2<f32>) -> vec2<f32> {
    let nearest = depth.x - depth.y;
    return vec2(select(3.0e38, 1.000001 / nearest, nearest > 1e-38), 0.999999 / (depth.x + depth.y));
}

// Raises the upper bound, or, if it `takes` the sample, puts down triangle and both bounds.
fn keep(k: u32, takes: bool, key: u32, high: f32, low: f32) {
    for (var n = 0u; n < 32u; n++) {
        best_keys[n] = select(best_keys[n], key, (n == k) & takes);
        best_high[n] = select(best_high[n], high, n == k);
        best_low[n] = select(best_low[n], low, (n == k) & takes);
    }
}

// Triangle `t` at sample `k`, a constant, by bounds. No branch, so `&` for `&&`, which is one: in a loop,
// SwiftShader follows every way through branches in a row when it compiles.
fn look(k: u32, offset: vec2<f32>, t: u32) {
    let v = view.at + offset.x * view.right + offset.y * view.down;
    let ahead = v > view.doubt;
    let behind = v < -view.doubt;
    let slope = offset.x * view.slopes.x + offset.y * view.slopes.y;
    let high = min(view.high + slope, view.highest);
    let low = max(view.low + slope, view.lowest);
    let matters = !(any(ahead) & any(behind)) & (high >= best_low[k]);
    let sure = (all(ahead) | all(behind)) & (low > best_high[k]) & (high * frame.forward.w < 0.99999) & whole;
    open |= select(0u, 1u << k, matters & !sure);
    let takes = matters & sure;
    best_keys[k] = select(best_keys[k], ~t, takes);
    best_high[k] = select(best_high[k], high, takes);
    best_low[k] = select(best_low[k], low, takes);
    rivals &= select(0xffffffffu, ~(1u << k), takes);
}

fn look_twice(n: u32, t: u32) {
    let pair = offsets[n];
    look(2u * n, pair.xy, t);
    look(2u * n + 1u, pair.zw, t);
}

// Triangle `t` at sample `k`, from its corners.
fn decide(k: u32, t: u32, slot: u32, pixel: u32) {
    let ray = ray_at(pixel, sample_offset(32u * step.word + k));
    let u = corners_at(corners_of(t));
    let depth = eye_depth(u, ray);
    if !covers_ray(u, ray) || depth.x + depth.y < frame.forward.w || is_hole(t, u, ray) { return; }
    if is_near_open(depth) {
        // It may lie nearer than the near distance: as one of a crowd it is tested with 46 bits.
        crowded |= 1u << k;
        return;
    }
    if !(depth.x >= frame.forward.w) { return; }
    let bounds = inverse_of(depth);
    let held = held_at(k);
    let other = ~held.key;
    let bit = 1u << k;
    var takes = true;
    var touching = false;
    if other != NO_TRIANGLE {
        let known = eye_depth(corners_at(corners_of(other)), ray);
        takes = depth.x < known.x || (depth.x == known.x && t < other);
        touching = abs(depth.x - known.x) <= TOUCHING * known.x + depth.y + known.y;
    }
    if touching {
        rivals_found[place(slot, 32u * step.word + k)] = select(t, other, takes);
        crowded |= rivals & bit;
        rivals |= bit;
    } else if takes {
        // A rival of the other may come as near as this one, which is then one of three.
        if bounds.y > held.high { rivals &= ~bit; }
        crowded |= rivals & bit;
    }
    let high = select(bounds.x, max(bounds.x, held.high), (rivals & bit) != 0u);
    if takes || touching { keep(k, takes, ~t, high, bounds.y); }
}

// The samples of a word for which bounds do not tell whether they see triangle `t`.
fn look_at(t: u32, count: u32, centre: vec3<f32>) {
    view = view_of(corners_at(corners_of(t)), centre);
    open = 0u;
    whole = ALPHA == 0u || !is_tested(triangles[t].w);
    look_twice(0u, t);
    look_twice(1u, t);
    look_twice(2u, t);
    look_twice(3u, t);
    if SAMPLES > 8u {
        look_twice(4u, t);
        look_twice(5u, t);
        look_twice(6u, t);
        look_twice(7u, t);
    }
    if SAMPLES > 16u {
        look_twice(8u, t);
        look_twice(9u, t);
        look_twice(10u, t);
        look_twice(11u, t);
        look_twice(12u, t);
        look_twice(13u, t);
        look_twice(14u, t);
        look_twice(15u, t);
    }
    open &= select((1u << count) - 1u, 0xffffffffu, count == 32u);
}

// Takes in up to BATCH triangles of the pixel's list, from `first` on. `count`: samples of the word. Samples
// that bounds leave open are decided for all triangles in one loop: they are rare, and cost as much as a
// triangle does. The result does not depend on the order.
fn take_in(first: u32, end: u32, count: u32, slot: u32, pixel: u32, centre: vec3<f32>) {
    for (var n = 0u; n < BATCH; n++) { opens[n] = 0u; }
    var some = false;
    for (var n = first; n < end; n++) {
        look_at(pixel_list[n], count, centre);
        for (var m = 0u; m < BATCH; m++) { opens[m] = select(opens[m], open, m == n - first); }
        some |= open != 0u;
    }
    while some {
        var at = 0u;
        var left = 0u;
        for (var m = 0u; m < BATCH; m++) {
            at = select(at, m, opens[m] != 0u);
            left = select(left, opens[m], opens[m] != 0u);
        }
        some = false;
        for (var m = 0u; m < BATCH; m++) {
            opens[m] = select(opens[m], left & (left - 1u), m == at);
            some |= opens[m] != 0u;
        }
        decide(firstTrailingBit(left), pixel_list[first + at], slot, pixel);
    }
}

// Resumes the word's `count` samples where earlier rounds left them.
fn resume(slot: u32, pixel: u32, count: u32) {
    let word = 32u * step.word;
    let masks_at = place(slot, 32u * WORDS + step.word);
    rivals = rivals_found[masks_at];
    crowded = rivals_found[masks_at + WORDS * step.slots];
    for (var k = 0u; k < count; k++) {
        let key = sample_keys[place(slot, word + k)];
        if key == 0u { continue; }
        let ray = ray_at(pixel, sample_offset(word + k));
        var bounds = inverse_of(eye_depth(corners_at(corners_of(~key)), ray));
        if ((rivals >> k) & 1u) != 0u {
            let rival = rivals_found[place(slot, word + k)];
            bounds.x = max(bounds.x, inverse_of(eye_depth(corners_at(corners_of(rival)), ray)).x);
        }
        keep(k, true, key, bounds.x, bounds.y);
    }
}

fn put_down(slot: u32, count: u32) {
    let masks_at = place(slot, 32u * WORDS + step.word);
    for (var k = 0u; k < 32u; k++) {
        sample_keys[place(slot, 32u * step.word + k)] = select(0u, best_keys[k], k < count);
    }
    rivals_found[masks_at] = rivals;
    rivals_found[masks_at + WORDS * step.slots] = crowded;
}
