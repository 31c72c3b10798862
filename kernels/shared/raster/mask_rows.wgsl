// Marks the texels of an 8 x 8 block in `mask` (one bit a texel, rows padded to 32), a row of the block at a
// time.

//@import frame block_bits
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> mask: array<atomic<u32>>;

fn mark_rows(corner: vec2<u32>, texels: vec2<u32>) {
    let across = (frame.map_size + 31u) / 32u;
    for (var rows = rows_of(texels); rows != 0u; rows &= rows - 1u) {
        let k = firstTrailingBit(rows);
        atomicOr(&mask[(corner.y + k) * across + corner.x / 32u], row_bits(texels, k) << (corner.x & 31u));
    }
}
