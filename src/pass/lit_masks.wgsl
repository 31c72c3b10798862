// The lit masks of a frame (`ShadowPass::lit`, `Target::lit`): one bit a sample, row by row from the top.
@group({group}) @binding({binding}) var<storage, read> lit_masks: array<u32>;

/// Words of a pixel, and the bits of its last word that are samples.
const LIT_WORDS = {words}u;
const LIT_LAST = {last}u;

/// Bits of a word that are samples.
fn lit_bits(word: u32) -> u32 {
    return select(0xffffffffu, LIT_LAST, word + 1u == LIT_WORDS);
}

/// Share of the samples of a pixel that are lit, of an image of `width` pixels a row.
fn lit_fraction(pixel: vec2<u32>, width: u32) -> f32 {
    let first = (pixel.y * width + pixel.x) * LIT_WORDS;
    var lit = 0u;
    for (var word = 0u; word < LIT_WORDS; word++) {
        lit += countOneBits(lit_masks[first + word] & lit_bits(word));
    }
    return f32(lit) / {count}.0;
}

/// Whether a sample of a pixel is lit.
fn lit_sample(pixel: vec2<u32>, width: u32, sample: u32) -> bool {
    let first = (pixel.y * width + pixel.x) * LIT_WORDS;
    return (lit_masks[first + sample / 32u] >> (sample % 32u) & 1u) != 0u;
}
