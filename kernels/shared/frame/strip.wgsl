// Pixels of a strip of rows, and the texels of the whole image.

//@import frame divide
//@needs var<uniform> frame: Frame;

// Column and row of a pixel in the strip.
fn place_in_strip(pixel: u32) -> vec2<u32> {
    return divided(pixel, frame.image_size.x).yx;
}

// The texel of the image that a place in the strip is.
fn texel_of_image(at: vec2<u32>) -> vec2<u32> {
    return vec2(at.x, frame.first_row + at.y);
}

// The texel of the application's G-buffer that a place in the strip is.
fn given_texel(at: vec2<u32>) -> vec2<u32> {
    return frame.given_origin + texel_of_image(at);
}

// Whether a row is the strip's own: others belong to strips above and below, and are here for their
// neighbours.
fn is_own(row: u32) -> bool {
    return row >= frame.rows_above && row + frame.rows_below < frame.image_size.y;
}
