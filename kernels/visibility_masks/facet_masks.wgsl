// The masks of a facet while casters are evaluated: what is open still, what is added, and what cuts it.

//@import frame shadow_lines sample_masks
//@needs override WORDS: u32;
//@needs override CUTS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> masks: array<atomic<u32>>;

// Whether no sample is left that could still be lit: nothing more needs to be known of the facet.
fn is_dark(f: u32) -> bool {
    var open = 0u;
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + w;
        open |= atomicLoad(&masks[at]) & ~atomicLoad(&masks[at + WORDS])
            & ~atomicLoad(&masks[at + 2u * WORDS]);
    }
    return open == 0u;
}

fn add(f: u32, part: u32, m: vec4<u32>) {
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + part * WORDS + w;
        if (m[w] & ~atomicLoad(&masks[at])) != 0u { atomicOr(&masks[at], m[w]); }
    }
}

// Whether the coverage mask already says which samples the facet represents: then nothing cuts it.
fn is_partial(f: u32) -> bool {
    var seen = 0u;
    for (var w = 0u; w < WORDS; w++) { seen += countOneBits(atomicLoad(&masks[3u * WORDS * f + w])); }
    return seen != frame.sample_count;
}

// The lines of a triangle, at the pixel centre. Of one facet a pixel the centre lies on its own triangle, so
// on this side of an edge that the two share, whatever rounding made of that.
fn centre_of(l: Lines, beside: bool, owned: vec3<bool>) -> vec4<f32> {
    let at_edge = vec4(!owned.z, !owned.x, !owned.y, true)
        & vec4(beside & ((frame.flags & FLAG_CLAMP) == 0u));
    return select(l.centre, vec4(-1e-37),
        at_edge & (l.centre >= vec4(0.0)) & (l.centre <= CREASE * (abs(l.right) + abs(l.down))));
}

// Whether a triangle of heights `h` over a facet may cut it within its pixel, along `line`.
fn may_cut(line: vec3<f32>, h: vec3<f32>) -> bool {
    if CUTS == 0u { return false; }
    return (frame.flags & FLAG_VALIDITY) != 0u && !all(h > vec3(0.0)) && line.x != 0.0
        && abs(line.x) <= 0.5 * (abs(line.y) + abs(line.z));
}

// Where a triangle cuts the facet within its pixel, along `line`, the samples on the other side of the line
// than the pixel centre see another surface.
fn cut(f: u32, g: Ground, line: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>) {
    if CUTS == 0u { return; }
    if !may_cut(line, h) || is_partial(f) || !meets_pixel(line, a, b, c, h, g.pixel) { return; }
    let far = -sign(line.x) * line;
    add(f, 2u, inside(Lines(vec4(far.x), vec4(far.y), vec4(far.z))));
}
