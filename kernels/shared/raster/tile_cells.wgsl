// The cells of a tile: 4 x 4, half a texel a side, sixteen bits row by row.

// The cells that a box touches; all in tiles, so that tile (x, y) reaches from x to x + 1 and y to y + 1.
fn box_cells(tile: vec2<u32>, low: vec2<f32>, high: vec2<f32>) -> u32 {
    let corner = vec2<f32>(tile);
    let first = vec2<u32>(clamp(floor(4.0 * (low - corner)), vec2(0.0), vec2(4.0)));
    let last = vec2<u32>(clamp(floor(4.0 * (high - corner)), vec2(-1.0), vec2(3.0)) + 1.0);
    let columns = (0xfu << first.x) & ((1u << last.x) - 1u);
    return columns * (0x1111u & (0x1111u << (4u * first.y)) & ((1u << (4u * last.y)) - 1u));
}

// The cells of some of a tile's texels, which are four bits row by row.
fn texel_cells(texels: u32) -> u32 {
    let upper = ((texels & 1u) * 0x33u) | (((texels >> 1u) & 1u) * 0xccu);
    return upper | (((texels >> 2u) & 1u) * 0x3300u) | ((texels >> 3u) * 0xcc00u);
}

// The upper half of a depth's bits, so rounded down; depths before 0 count as 0.
fn depth_code(depth: f32) -> u32 { return bitcast<u32>(max(depth, 0.0)) >> 16u; }
