// The lists of lights of a frame (`Target::listed`, `ShadowPass::record_light_lists`): by tile of 8 x 8 pixels.
@group({group}) @binding({binding}) var<storage, read> light_lists: array<u32>;

/// A light of a pixel's tile.
struct ListedLight {
    light: u32,       // its number
    visibility: f32,  // in the pixel; 0 too where the light does not reach it
    next: u32,        // next entry of the tile, 0: none
}

/// Word of the tile of a pixel.
fn light_tile(pixel: vec2<u32>) -> u32 {
    return 4u + 2u * ((pixel.y >> 3u) * light_lists[2] + (pixel.x >> 3u));
}

/// First entry of the tile of a pixel, 0: none.
fn first_light(pixel: vec2<u32>) -> u32 {
    return light_lists[light_tile(pixel)] & 0x7fffffffu;
}

/// Whether no light of the pixel's tile had no room in the lists.
fn lists_all_lights(pixel: vec2<u32>) -> bool {
    return (light_lists[light_tile(pixel)] >> 31u) == 0u;
}

/// An entry of the pixel's tile, which is not 0.
fn listed_light(entry: u32, pixel: vec2<u32>) -> ListedLight {
    let at = 4u + 2u * light_lists[3] + 18u * (entry - 1u);
    let word = light_lists[at + 2u + ((pixel.y & 7u) << 1u) + ((pixel.x >> 2u) & 1u)];
    let byte = (word >> ((pixel.x & 3u) << 3u)) & 255u;
    return ListedLight(light_lists[at], f32(byte) / 255.0, light_lists[at + 1u]);
}
