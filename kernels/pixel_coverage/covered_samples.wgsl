// The samples that a triangle covers in a pixel (pixel_coverage).

//@import frame pixel_ray facing near_distance facing_46 double_float eye_edges eye_order_46 eye_view
//@import alpha mapped_view pixel_pair word_masks sample_copy
//@needs override WORDS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;

// Three edge functions in units of their doubt, each turned so that it is positive inside.
struct Edges { at: vec3<f32>, right: vec3<f32>, down: vec3<f32> }

// Samples of a word: those that are surely inside, and those that are not surely outside.
struct Told { inside: u32, touched: u32 }

fn edges_of(view: View, turn: f32) -> Edges {
    // A share of the values more for the roundings of this scale.
    let size = abs(view.at) + abs(view.right) + abs(view.down);
    let unit = turn / max(view.doubt + 4e-7 * size, vec3(1e-30));
    return Edges(unit * view.at, unit * view.right, unit * view.down);
}

// Takes in two samples. What is no number is not surely outside.
fn tell_two(at: u32, k: u32, e: Edges, told: ptr<function, Told>) {
    let s = samples[at + k];
    let a = e.at + s.x * e.right + s.y * e.down;
    let b = e.at + s.z * e.right + s.w * e.down;
    let least_a = min(a.x, min(a.y, a.z));
    let least_b = min(b.x, min(b.y, b.z));
    (*told).inside |= (select(0u, 1u, least_a > 1.0) | select(0u, 2u, least_b > 1.0)) << (2u * k);
    (*told).touched |= (select(1u, 0u, least_a < -1.0) | select(2u, 0u, least_b < -1.0)) << (2u * k);
}

fn tell(word: u32, e: Edges) -> Told {
    let at = word << 4u;
    var told = Told(0u, 0u);
    tell_two(at, 0u, e, &told);
    if SAMPLES > 2u {
        tell_two(at, 1u, e, &told);
        tell_two(at, 2u, e, &told);
        tell_two(at, 3u, e, &told);
    }
    if SAMPLES > 8u {
        tell_two(at, 4u, e, &told);
        tell_two(at, 5u, e, &told);
        tell_two(at, 6u, e, &told);
        tell_two(at, 7u, e, &told);
    }
    if SAMPLES > 16u {
        tell_two(at, 8u, e, &told);
        tell_two(at, 9u, e, &told);
        tell_two(at, 10u, e, &told);
        tell_two(at, 11u, e, &told);
        tell_two(at, 12u, e, &told);
        tell_two(at, 13u, e, &told);
        tell_two(at, 14u, e, &told);
        tell_two(at, 15u, e, &told);
    }
    return told;
}

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples_given[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// Samples at which a triangle is; those at which single precision does not tell on which side of the near
// distance.
struct Covered { mask: vec4<u32>, near_open: vec4<u32> }

// Sample `k`, from the corners. `inside`: of the edges it is known.
fn decide(k: u32, pair: PixelPair, u: Corners, inside: bool, covered: ptr<function, Covered>) {
    let ray = ray_at(pair.pixel, sample_offset(k));
    let depth = eye_depth(u, ray);
    let word = triangles[pair.triangle].w;
    let begin = near_along(ray);
    let card = Card(u.a, u.b, u.c, mapped_ahead());
    let hole = ALPHA != 0u && is_tested(word) && !is_solid(word, card, vec3(0.0), ray);
    let there = (inside || covers_ray(u, ray)) && !hole && depth.x + depth.y >= begin;
    let near = is_near_open(depth, begin);
    let bit = bit_of(k);
    if there && (near || depth.x >= begin) { (*covered).mask |= bit; }
    if there && near { (*covered).near_open |= bit; }
}

fn covered_samples(pair: PixelPair, u: Corners, view: View) -> vec4<u32> {
    var inside = vec4(0u);
    var touched = vec4(0u);
    // A plane through the eye may turn either way.
    var turn = select(view.turn, 1.0, view.turn == 0.0);
    loop {
        let e = edges_of(view, turn);
        let first = tell(0u, e);
        inside.x |= first.inside;
        touched.x |= first.touched;
        if WORDS > 1u {
            let second = tell(1u, e);
            inside.y |= second.inside;
            touched.y |= second.touched;
        }
        if WORDS > 2u {
            let third = tell(2u, e);
            let fourth = tell(3u, e);
            inside.z |= third.inside;
            touched.z |= third.touched;
            inside.w |= fourth.inside;
            touched.w |= fourth.touched;
        }
        if view.turn != 0.0 || turn < 0.0 { break; }
        turn = -1.0;
    }
    touched &= full_mask(frame.sample_count);
    inside &= touched;
    if view.turn == 0.0 { inside = vec4(0u); }
    // All of it lies beyond the near distance, and it has no holes: else samples inside are asked, too.
    let slope = 0.5 * (abs(view.slopes.x) + abs(view.slopes.y));
    let most = min(view.high + slope, view.highest);
    let beyond = most * frame.forward.w < 0.99999
        && most < 0.99999 * least_inverse_near(pixel_ray(pair.pixel));
    let whole = ALPHA == 0u || !is_tested(triangles[pair.triangle].w);
    var covered = Covered(select(vec4(0u), inside, beyond && whole), vec4(0u));
    for (var left = touched & ~covered.mask; any(left != vec4(0u)); left = without_lowest(left)) {
        let k = lowest_bit(left);
        decide(k, pair, u, any((inside & bit_of(k)) != vec4(0u)), &covered);
    }
    for (var left = covered.near_open; any(left != vec4(0u)); left = without_lowest(left)) {
        let k = lowest_bit(left);
        if !is_beyond_near_46(u.i, ray_at(pair.pixel, sample_offset(k))) { covered.mask &= ~bit_of(k); }
    }
    return covered.mask;
}

// Bounds of the inverse depth over the pixel: those of the plane, or of the corners where these are as tight.
fn depth_bounds(view: View) -> vec4<f32> {
    if view.high - view.low < view.highest - view.lowest {
        return vec4(view.high, view.low, view.slopes);
    }
    return vec4(view.highest, view.lowest, 0.0, 0.0);
}
