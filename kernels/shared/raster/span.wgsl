// Which cells of a row a convex shape may touch: rows of a block are cut by the lines of its edges before
// cells are tested.

// Cells from x to y of a row whose centres may lie where edge.x * x + edge.y * row + edge.z >= 0, a little
// more than that.
fn cut_span(span: vec2<f32>, edge: vec3<f32>, row: f32) -> vec2<f32> {
    let rest = edge.y * row + edge.z;
    let at = -rest / edge.x;
    // Rounding of the rest moves the place by as much as the edge runs along the row.
    let slack = 0.51 + 2e-6 * (abs(edge.y * row) + abs(edge.z)) / abs(edge.x);
    if edge.x > 0.0 { return vec2(max(span.x, at - slack - 0.5), span.y); }
    if edge.x < 0.0 { return vec2(span.x, min(span.y, at + slack - 0.5)); }
    return span;
}

fn span_of(block_low: u32, block_high: u32) -> vec2<f32> {
    return vec2(f32(block_low), f32(block_high));
}

// First and last cell of a span; nothing where the first exceeds the last.
fn cells_of(span: vec2<f32>, block_low: u32, block_high: u32) -> vec2<u32> {
    let low = clamp(ceil(span.x), f32(block_low), f32(block_high) + 1.0);
    let high = clamp(floor(span.y), f32(block_low) - 1.0, f32(block_high));
    if !(low <= high) { return vec2(1u, 0u); }
    return vec2(u32(low), u32(high));
}
