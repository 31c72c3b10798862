// The part of its pixel that the samples of a facet lie in (sample_surfaces).

//@import word_masks sample_copy
//@needs override WORDS: u32;

// Widens a box (its lowest and its highest corner) by those of two samples that the lowest bits of a mask
// have.
fn span_two(box: vec4<f32>, two: vec4<f32>, mask: u32) -> vec4<f32> {
    let first = (mask & 1u) != 0u;
    let second = (mask & 2u) != 0u;
    let low = min(select(vec2(1.0), two.xy, first), select(vec2(1.0), two.zw, second));
    let high = max(select(vec2(-1.0), two.xy, first), select(vec2(-1.0), two.zw, second));
    return vec4(min(box.xy, low), max(box.zw, high));
}

fn span_eight(given: vec4<f32>, at: u32, mask: u32) -> vec4<f32> {
    var box = span_two(given, samples[at], mask);
    box = span_two(box, samples[at + 1u], mask >> 2u);
    box = span_two(box, samples[at + 2u], mask >> 4u);
    return span_two(box, samples[at + 3u], mask >> 6u);
}

// Takes in the samples of a word.
fn span_word(given: vec4<f32>, mask: u32, word: u32) -> vec4<f32> {
    let at = word << 4u;
    var box = span_eight(given, at, mask);
    if SAMPLES > 8u { box = span_eight(box, at + 4u, mask >> 8u); }
    if SAMPLES > 16u {
        box = span_eight(box, at + 8u, mask >> 16u);
        box = span_eight(box, at + 12u, mask >> 24u);
    }
    return box;
}

// A box and a 256th of a pixel beyond, packed, and what packing may take away.
fn packed_span(box: vec4<f32>) -> vec2<u32> {
    let more = 0.00390625 + 0.00006103515625;
    return vec2(pack2x16snorm(box.xy - more), pack2x16snorm(box.zw + more));
}

// The box around samples.
fn span_of_samples(mask: vec4<u32>) -> vec4<f32> {
    var box = span_word(vec4(1.0, 1.0, -1.0, -1.0), mask.x, 0u);
    if WORDS > 1u { box = span_word(box, mask.y, 1u); }
    if WORDS > 2u {
        box = span_word(box, mask.z, 2u);
        box = span_word(box, mask.w, 3u);
    }
    return box;
}
