// The cells of an 8 x 8 block where a conservatively covered triangle may be, as bits; they are then gone
// through in one loop: lanes of a vector wait for the fullest block, not for the fullest of each row.

//@import rect conservative span block_bits

// Of the given rows of the block alone, as eight bits.
fn cover_cells(shape: Cover, block: Rect, rows: u32) -> vec2<u32> {
    var cells = vec2(0u);
    for (var left = rows & cells_bits(vec2(block.low.y, block.high.y)); left != 0u; left &= left - 1u) {
        let k = firstTrailingBit(left);
        let row = f32((block.low.y & ~7u) + k) + 0.5;
        var cut = span_of(block.low.x, block.high.x);
        if shape.in_front && !shape.thin {
            cut = cut_span(cut_span(cut_span(cut, shape.edges[0], row), shape.edges[1], row), shape.edges[2],
                row);
        }
        add_cells(&cells, k, cells_of(cut, block.low.x, block.high.x));
    }
    return cells;
}
