// Of the triangles of a pixel the nearest at each sample of a word, by bounds (sample_surfaces).

//@import frame surface_step covering word_offsets pixel_entries sample_copy
//@needs override WORDS: u32;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read_write> covering_masks: array<u32>;
//@needs var<storage, read_write> coverings: array<Covering>;

// Of each sample the greatest lower bound of the inverse depth. Only indexed by what compilers know, so that
// it stays in registers.
var<private> nearest_low: array<f32, 32>;

// Samples that several triangles cover.
fn covered_twice(e: Entries) -> u32 {
    var once = 0u;
    var twice = 0u;
    for (var n = 0u; n < e.count; n++) {
        let mask = covering_masks[place_of(e, n) * WORDS + step.word];
        twice |= once & mask;
        once |= mask;
    }
    return twice;
}

// No branch: in a loop, SwiftShader follows every way through branches in a row when it compiles.
fn raise(k: u32, offset: vec2<f32>, depth: Covering, mask: u32) {
    let low = depth.low + offset.x * depth.slope_x + offset.y * depth.slope_y;
    nearest_low[k] = select(nearest_low[k], max(nearest_low[k], low), ((mask >> k) & 1u) != 0u);
}

fn raise_two(n: u32, depth: Covering, mask: u32) {
    let pair = offsets[n];
    raise(2u * n, pair.xy, depth, mask);
    raise(2u * n + 1u, pair.zw, depth, mask);
}

// The bit of sample `k` if a triangle may be the nearest there.
fn left_at(k: u32, offset: vec2<f32>, depth: Covering) -> u32 {
    let high = depth.high + offset.x * depth.slope_x + offset.y * depth.slope_y;
    return select(0u, 1u << k, high >= nearest_low[k]);
}

fn left_of_two(n: u32, depth: Covering) -> u32 {
    let pair = offsets[n];
    return left_at(2u * n, pair.xy, depth) | left_at(2u * n + 1u, pair.zw, depth);
}

fn raise_all(depth: Covering, mask: u32) {
    raise_two(0u, depth, mask);
    raise_two(1u, depth, mask);
    raise_two(2u, depth, mask);
    raise_two(3u, depth, mask);
    if SAMPLES > 8u {
        raise_two(4u, depth, mask);
        raise_two(5u, depth, mask);
        raise_two(6u, depth, mask);
        raise_two(7u, depth, mask);
    }
    if SAMPLES > 16u {
        raise_two(8u, depth, mask);
        raise_two(9u, depth, mask);
        raise_two(10u, depth, mask);
        raise_two(11u, depth, mask);
        raise_two(12u, depth, mask);
        raise_two(13u, depth, mask);
        raise_two(14u, depth, mask);
        raise_two(15u, depth, mask);
    }
}

fn left_of_all(depth: Covering) -> u32 {
    var left = left_of_two(0u, depth) | left_of_two(1u, depth) | left_of_two(2u, depth)
        | left_of_two(3u, depth);
    if SAMPLES > 8u {
        left |= left_of_two(4u, depth) | left_of_two(5u, depth) | left_of_two(6u, depth)
            | left_of_two(7u, depth);
    }
    if SAMPLES > 16u {
        left |= left_of_two(8u, depth) | left_of_two(9u, depth) | left_of_two(10u, depth)
            | left_of_two(11u, depth);
        left |= left_of_two(12u, depth) | left_of_two(13u, depth) | left_of_two(14u, depth)
            | left_of_two(15u, depth);
    }
    return left;
}

// The first entry from the n-th on that covers one of some samples, or the count: searched in a loop of its
// own, so that the dear part of another runs for such entries alone.
fn next_of(e: Entries, first: u32, some: u32) -> u32 {
    var n = first;
    while n < e.count && (covering_masks[place_of(e, n) * WORDS + step.word] & some) == 0u { n++; }
    return n;
}

// Takes from the masks, of the samples `twice`, those at which another triangle is nearer. Returns those that
// several masks are left with.
fn keep_nearest(e: Entries, twice: u32) -> u32 {
    for (var k = 0u; k < 32u; k++) { nearest_low[k] = 0.0; }
    for (var n = next_of(e, 0u, twice); n < e.count; n = next_of(e, n + 1u, twice)) {
        let at = place_of(e, n);
        raise_all(coverings[at], covering_masks[at * WORDS + step.word] & twice);
    }
    var once = 0u;
    var open = 0u;
    for (var n = next_of(e, 0u, twice); n < e.count; n = next_of(e, n + 1u, twice)) {
        let at = place_of(e, n);
        let all = covering_masks[at * WORDS + step.word];
        let left = all & twice & left_of_all(coverings[at]);
        open |= once & left;
        once |= left;
        covering_masks[at * WORDS + step.word] = (all & ~twice) | left;
    }
    return open;
}
