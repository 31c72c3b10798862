// Samples at which surfaces almost touch (sample_surfaces), by 46 bits.

//@import frame pixel_ray eye_edges eye_order_46 surface_step nearest_sample surface_groups
//@needs override WORDS: u32;
//@needs override ROUND_LENGTH: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read> pixel_offsets: array<u32>;
//@needs var<storage, read> pixel_list: array<u32>;
//@needs var<storage, read_write> sample_keys: array<u32>;
//@needs var<storage, read_write> rivals_found: array<u32>;
//@needs var<storage, read_write> crowds: array<atomic<u32>>;

// Two at a sample; lists the pixel if there may be more.
fn settle_rivals_of(slot: u32) {
    let pixel = complex_pixel(slot);
    var crowd = 0u;
    for (var w = 0u; w < WORDS; w++) {
        crowd |= rivals_found[place(slot, 33u * WORDS + w)];
        var left = rivals_found[place(slot, 32u * WORDS + w)];
        while left != 0u {
            let k = 32u * w + firstTrailingBit(left);
            left &= left - 1u;
            let at = place(slot, k);
            let rival = rivals_found[at];
            let t = ~sample_keys[at];
            let order = order_46(corners_of(rival), corners_of(t), ray_at(pixel, sample_offset(k)));
            if order < 0.0 || (order == 0.0 && rival < t) { sample_keys[at] = ~rival; }
        }
    }
    if crowd != 0u {
        let at = 2u * atomicAdd(&crowds[0], 1u);
        atomicStore(&crowds[at + 1u], slot);
        atomicStore(&crowds[at + 2u], pixel);
    }
}

// Whether a triangle covers a ray beyond the near distance. `depth`: of its plane, with its doubt.
fn is_there(t: u32, u: Corners, ray: vec3<f32>, depth: vec2<f32>) -> bool {
    if !covers_ray(u, ray) || depth.x + depth.y < frame.forward.w || is_hole(t, u, ray) { return false; }
    if is_near_open(depth) { return is_beyond_near_46(u.i, ray); }
    return depth.x >= frame.forward.w;
}

// Of the triangles of a round that cover a ray, and `known` (NO_TRIANGLE: none), the nearest. By a number for
// each, how near it is to a bound of the nearest: of three the first may be as good as the second and that as
// the third, a sliver whose depth is poorly known, but the third not as the first.
fn nearest_of_crowd(ray: vec3<f32>, known: u32, first: u32, end: u32) -> u32 {
    var bound = 3.0e38;
    if known != NO_TRIANGLE {
        let depth = eye_depth(corners_at(corners_of(known)), ray);
        bound = depth.x + depth.y;
    }
    for (var n = first; n < end; n++) {
        let t = pixel_list[n];
        let u = corners_at(corners_of(t));
        let depth = eye_depth(u, ray);
        if depth.x + depth.y < bound && is_there(t, u, ray, depth) { bound = depth.x + depth.y; }
    }
    var best = known;
    var best_key = 0u;
    if known != NO_TRIANGLE { best_key = key_46(corners_of(known), ray, bound); }
    for (var n = first; n < end; n++) {
        let t = pixel_list[n];
        let u = corners_at(corners_of(t));
        let depth = eye_depth(u, ray);
        if t == known || depth.x - depth.y > bound * (1.0 + 2.0 * TOUCHING) || !is_there(t, u, ray, depth) {
            continue;
        }
        let key = key_46(u.i, ray, bound);
        if best == NO_TRIANGLE || key > best_key || (key == best_key && t < best) {
            best = t;
            best_key = key;
        }
    }
    return best;
}

// The crowded samples of a word of the n-th listed pixel.
fn settle_crowd(n: u32) {
    let slot = atomicLoad(&crowds[2u * n + 1u]);
    let pixel = atomicLoad(&crowds[2u * n + 2u]);
    let first = pixel_offsets[pixel] + step.round * ROUND_LENGTH;
    let end = min(min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity), first + ROUND_LENGTH);
    for (var left = rivals_found[place(slot, 33u * WORDS + step.word)]; left != 0u; left &= left - 1u) {
        let k = 32u * step.word + firstTrailingBit(left);
        let at = place(slot, k);
        sample_keys[at] = ~nearest_of_crowd(ray_at(pixel, sample_offset(k)), ~sample_keys[at], first, end);
    }
}
