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

// Takes the first tile of 2 x 2 texels out, of which there must be one: its place in the block, and its
// texels as four bits.
fn take_tile(texels: ptr<function, vec2<u32>>) -> vec3<u32> {
    let lower = (*texels).x == 0u;
    let word = select((*texels).x, (*texels).y, lower);
    let k = firstTrailingBit(word);
    let tile = vec2((k & 7u) >> 1u, k >> 4u);
    let at = 16u * tile.y + 2u * tile.x;
    let rest = word & ~(0x303u << at);
    if lower { (*texels).y = rest; } else { (*texels).x = rest; }
    let bits = word >> at;
    return vec3(tile + vec2(0u, select(0u, 2u, lower)), (bits & 3u) | ((bits >> 6u) & 12u));
}

// Cells from x to y of a block's row as eight bits; none where the first exceeds the last.
fn cells_bits(cells: vec2<u32>) -> u32 {
    if cells.x > cells.y { return 0u; }
    return (0xffu << (cells.x & 7u)) & (0xffu >> (7u - (cells.y & 7u)));
}

// Adds cells from x to y of row `y`.
fn add_cells(texels: ptr<function, vec2<u32>>, y: u32, cells: vec2<u32>) {
    let bits = cells_bits(cells) << (8u * (y & 3u));
    *texels |= select(vec2(bits, 0u), vec2(0u, bits), (y & 4u) != 0u);
}

// Rows of a block in which a bit is set.
fn rows_of(texels: vec2<u32>) -> u32 {
    let half = texels | (texels >> vec2(4u));
    let quarter = half | (half >> vec2(2u));
    let one = (quarter | (quarter >> vec2(1u))) & vec2(0x01010101u);
    let packed = (one * 0x01020408u) >> vec2(24u);
    return (packed.x & 15u) | ((packed.y & 15u) << 4u);
}

// The eight bits of row `y`.
fn row_bits(texels: vec2<u32>, y: u32) -> u32 {
    return (select(texels.x, texels.y, y >= 4u) >> (8u * (y & 3u))) & 0xffu;
}
