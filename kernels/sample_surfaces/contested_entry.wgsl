// A sample at which bounds leave several triangles (sample_surfaces).

//@import frame pixel_ray eye_edges eye_order_46 surface_step covering pixel_entries
//@needs override WORDS: u32;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read_write> coverings: array<Covering>;
//@needs var<storage, read_write> covering_masks: array<u32>;

fn corners_of(t: u32) -> vec3<u32> {
    return triangles[t].xyz;
}

// View depth of an entry at a ray, with its doubt; far off where the triangle is edge-on.
fn entry_depth(at: u32, ray: vec3<f32>) -> vec2<f32> {
    let depth = eye_depth(corners_at(corners_of(coverings[at].triangle)), ray);
    return select(depth, vec2(3.0e38, 0.0), depth.x < 0.0);
}

// Takes sample `k` of the word from all masks but that of the nearest triangle, of equally near ones the
// lowest. Two that single precision does not tell apart are compared; of more, each has a number for how near
// it is to a bound of the nearest: the first may be as good as the second and that as the third, a sliver
// whose depth is poorly known, but the third not as the first. Three turns an entry: `ROUND_LENGTH` of them
// for 32 samples are fewer than llvmpipe ends loops at.
fn settle_sample(e: Entries, pixel: u32, k: u32) {
    let bit = 1u << k;
    let ray = ray_at(pixel, sample_offset(32u * step.word + k));
    var bound = 3.0e38;
    for (var n = 0u; n < e.count; n++) {
        let at = place_of(e, n);
        if (covering_masks[at * WORDS + step.word] & bit) != 0u {
            let depth = entry_depth(at, ray);
            bound = min(bound, depth.x + depth.y);
        }
    }
    var first = 0u;
    var second = 0u;
    var count = 0u;
    for (var n = 0u; n < e.count; n++) {
        let at = place_of(e, n);
        let word = at * WORDS + step.word;
        if (covering_masks[word] & bit) == 0u { continue; }
        let depth = entry_depth(at, ray);
        if depth.x - depth.y > bound * (1.0 + 2.0 * TOUCHING) {
            covering_masks[word] &= ~bit;
        } else {
            second = first;
            first = at;
            count++;
        }
    }
    for (var pair = count == 2u; pair; pair = false) {
        let t = coverings[first].triangle;
        let s = coverings[second].triangle;
        let order = order_46(corners_of(s), corners_of(t), ray);
        let farther = select(second, first, order < 0.0 || (order == 0.0 && s < t));
        covering_masks[farther * WORDS + step.word] &= ~bit;
    }
    // Else no turn.
    let some = select(0u, e.count, count > 2u);
    var best = 0u;
    var best_triangle = NO_TRIANGLE;
    var best_key = 0u;
    for (var n = 0u; n < some; n++) {
        let at = place_of(e, n);
        let word = at * WORDS + step.word;
        if (covering_masks[word] & bit) == 0u { continue; }
        let t = coverings[at].triangle;
        let key = key_46(corners_of(t), ray, bound);
        if best_triangle == NO_TRIANGLE || key > best_key || (key == best_key && t < best_triangle) {
            if best_triangle != NO_TRIANGLE { covering_masks[best * WORDS + step.word] &= ~bit; }
            best = at;
            best_triangle = t;
            best_key = key;
        } else {
            covering_masks[word] &= ~bit;
        }
    }
}
