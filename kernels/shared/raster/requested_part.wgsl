// Which 8 x 8 blocks of the light's map are requested: word 0 is 0 where all are; then a bit a block, rows of
// whole words. Nothing is made of the others.

//@import frame rect divide
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> requested: array<u32>;

// Words of bits that are looked through for one rectangle: of larger ones all is taken.
const MOST_WORDS = 64u;

// The least rectangle that holds all of a rectangle of texels that is requested.
fn requested_part(rect: vec2<u32>) -> vec2<u32> {
    if is_empty(rect) || requested[0] == 0u { return rect; }
    let all = unpack_rect(rect);
    let low = all.low >> vec2(BLOCK_SHIFT);
    let high = all.high >> vec2(BLOCK_SHIFT);
    let words = block_words(frame.map_size);
    let first = low.x / 32u;
    let last = high.x / 32u;
    let across = last - first + 1u;
    let count = across * (high.y - low.y + 1u);
    if count > MOST_WORDS { return rect; }
    var found = Rect(vec2(0xffffffffu), vec2(0u));
    for (var k = 0u; k < count; k++) {
        let at = divided(k, across);
        let row = low.y + at.x;
        let word = first + at.y;
        var bits = requested[1u + row * words + word];
        if word == first { bits &= 0xffffffffu << (low.x & 31u); }
        if word == last { bits &= 0xffffffffu >> (31u - (high.x & 31u)); }
        if bits == 0u { continue; }
        found.low = min(found.low, vec2(32u * word + firstTrailingBit(bits), row));
        found.high = max(found.high, vec2(32u * word + firstLeadingBit(bits), row));
    }
    if found.low.x > found.high.x { return EMPTY_RECT; }
    return pack_rect(Rect(max(all.low, BLOCK * found.low), min(all.high, BLOCK * found.high + BLOCK - 1u)));
}
