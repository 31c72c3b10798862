// Where pairs meet: the texels of the map, or tiles of 2 x 2 of them.

//@import frame rect
//@needs var<uniform> frame: Frame;

override TILE_SHIFT: u32 = 0u;  // 0: texels; 1: tiles

fn places_across() -> u32 { return (frame.map_size + TILE_SHIFT) >> TILE_SHIFT; }

fn place_index(at: vec2<u32>) -> u32 { return at.y * places_across() + at.x; }

// The word, after those of all places, of the 8 x 8 block of texels that `texel` lies in.
fn block_word(texel: vec2<u32>) -> u32 {
    let across = (frame.map_size + BLOCK - 1u) >> BLOCK_SHIFT;
    return places_across() * places_across() + (texel.y >> BLOCK_SHIFT) * across + (texel.x >> BLOCK_SHIFT);
}
