// Samples of a complex pixel by the triangles that cover any (gbuffer_triangles).

//@import frame covering word_masks
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> pixel_offsets: array<u32>;
//@needs var<storage, read_write> pixel_counts: array<u32>;
//@needs var<storage, read_write> coverings: array<Covering>;
//@needs var<storage, read_write> covering_masks: array<u32>;

// Words of a mask.
fn words() -> u32 { return (frame.sample_count + 31u) >> 5u; }

// The samples that none covers.
fn samples_left(pixel: u32) -> vec4<u32> {
    let first = pixel_offsets[pixel];
    var left = full_mask(frame.sample_count);
    for (var n = first; n < first + pixel_counts[pixel]; n++) {
        for (var w = 0u; w < words(); w++) { left[w] &= ~covering_masks[n * words() + w]; }
    }
    return left;
}

// Gives sample `k` to a listed triangle, which is appended if it covers no other.
fn give(pixel: u32, k: u32, t: u32) {
    let first = pixel_offsets[pixel];
    let end = first + pixel_counts[pixel];
    var at = first;
    while at < end && coverings[at].triangle != t { at++; }
    if at == end {
        if at >= min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity) { return; }
        coverings[at] = Covering(t, 3.0e38, 0.0, 0.0, 0.0);
        for (var w = 0u; w < words(); w++) { covering_masks[at * words() + w] = 0u; }
        pixel_counts[pixel] = at + 1u - first;
    }
    covering_masks[at * words() + (k >> 5u)] |= 1u << (k & 31u);
}
