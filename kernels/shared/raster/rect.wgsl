// Rectangles of texels or pixels, both corners included, packed as x | y << 16. Work items are the 8 x 8
// blocks, aligned to multiples of 8, that a rectangle touches.

//@import divide

const BLOCK = 8u;
const BLOCK_SHIFT = 3u;

struct Rect {
    low: vec2<u32>,
    high: vec2<u32>,
}

const EMPTY_RECT = vec2<u32>(0xffffffffu, 0u);

fn pack_rect(r: Rect) -> vec2<u32> {
    return vec2(r.low.x | (r.low.y << 16u), r.high.x | (r.high.y << 16u));
}

fn unpack_rect(p: vec2<u32>) -> Rect {
    return Rect(vec2(p.x & 0xffffu, p.x >> 16u), vec2(p.y & 0xffffu, p.y >> 16u));
}

fn is_empty(p: vec2<u32>) -> bool {
    return (p.x & 0xffffu) > (p.y & 0xffffu);
}

// The cells whose closed squares touch the box from `low` to `high`; EMPTY_RECT outside a grid of `size`.
fn cells_touched(low: vec2<f32>, high: vec2<f32>, size: vec2<u32>) -> vec2<u32> {
    let limit = vec2<f32>(size);
    if any(high < vec2(0.0)) || any(low >= limit) { return EMPTY_RECT; }
    let a = vec2<u32>(clamp(floor(low), vec2(0.0), limit - 1.0));
    let b = vec2<u32>(clamp(floor(high), vec2(0.0), limit - 1.0));
    return pack_rect(Rect(a, b));
}

fn block_count(p: vec2<u32>) -> u32 {
    if is_empty(p) { return 0u; }
    let r = unpack_rect(p);
    let n = (r.high >> vec2(BLOCK_SHIFT)) - (r.low >> vec2(BLOCK_SHIFT)) + 1u;
    return n.x * n.y;
}

// Words of a row of bits, one for each block across so many cells.
fn block_words(cells: u32) -> u32 {
    return (cells + 32u * BLOCK - 1u) / (32u * BLOCK);
}

// The part of the rectangle that lies in its `index`th block.
fn block_of(p: vec2<u32>, index: u32) -> Rect {
    let r = unpack_rect(p);
    let first = r.low >> vec2(BLOCK_SHIFT);
    let across = (r.high.x >> BLOCK_SHIFT) - first.x + 1u;
    let corner = (first + divided(index, across).yx) << vec2(BLOCK_SHIFT);
    return Rect(max(r.low, corner), min(r.high, corner + BLOCK - 1u));
}
