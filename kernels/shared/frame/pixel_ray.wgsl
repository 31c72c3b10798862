// Pixels and the rays of their samples from the eye, offsets in pixels from the centre.

//@import frame divide
//@needs var<uniform> frame: Frame;

// The pixel's upper left corner in the image, in pixels.
fn pixel_corner(pixel: u32) -> vec2<f32> {
    let place = divided(pixel, frame.image_size.x);
    return vec2(f32(place.y), f32(frame.first_row + place.x));
}

fn pixel_ray(pixel: u32) -> vec3<f32> {
    let at = pixel_corner(pixel) + 0.5;
    return frame.ray_corner.xyz + at.x * frame.ray_x.xyz + at.y * frame.ray_y.xyz;
}

fn ray_at(pixel: u32, offset: vec2<f32>) -> vec3<f32> {
    return pixel_ray(pixel) + offset.x * frame.ray_x.xyz + offset.y * frame.ray_y.xyz;
}
