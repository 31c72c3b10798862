// Texels (or pixels) of an 8 x 8 block as bits, row by row.

fn add_texel(texels: ptr<function, vec2<u32>>, at: vec2<u32>) {
    let bit = 1u << ((at.y & 3u) * 8u + at.x);
    if at.y < 4u { (*texels).x |= bit; } else { (*texels).y |= bit; }
}

// Takes the first texel out; there must be one.
fn take_texel(texels: ptr<function, vec2<u32>>) -> vec2<u32> {
    let lower = (*texels).x == 0u;
    let word = select((*texels).x, (*texels).y, lower);
    let k = firstTrailingBit(word);
    if lower { (*texels).y = word & (word - 1u); } else { (*texels).x = word & (word - 1u); }
    return vec2(k & 7u, (k >> 3u) + select(0u, 4u, lower));
}
