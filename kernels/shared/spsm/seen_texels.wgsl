// The texels of a light-view map that are asked for, as bits of its 8 x 8 blocks: two words a block, the
// upper four rows in the first; those asked for last once more; and what goes with them.

//@import frame
//@needs var<uniform> frame: Frame;

const SEEN_WON = 0u;        // blocks won, see spsm_map
const SEEN_CHOSEN = 1u;     // items to be gone through
const SEEN_AGAIN = 2u;      // items to be run again
const SEEN_LOST = 3u;       // not 0: a texel lacks its triangle
const SEEN_MISSED = 4u;     // not 0: a texel was read that is not made
const SEEN_BASE = 6u;       // first block of the run, and of the next
const SEEN_BITS = 8u;       // where the bits begin; then as many words of those asked for last, then a list
                            // of pixels, with space for all, and their number

fn seen_words() -> u32 {
    let blocks = (frame.map_size + 7u) >> 3u;
    return 2u * blocks * blocks;
}

// Word and bit of a texel.
fn seen_place(texel: vec2<u32>) -> vec2<u32> {
    let block = (texel.y >> 3u) * ((frame.map_size + 7u) >> 3u) + (texel.x >> 3u);
    return vec2(2u * block + ((texel.y >> 2u) & 1u), 1u << (8u * (texel.y & 3u) + (texel.x & 7u)));
}
