// A triangle that covers samples of a pixel that may show several surfaces (pixel_coverage). Its inverse
// depth there is bounded by linear functions of the offset from the pixel centre, in pixels.

struct Covering {
    triangle: u32,
    high: f32,     // upper bound at the centre
    low: f32,      // lower bound
    slope_x: f32,  // added to both by a pixel right
    slope_y: f32,  // and one down
}
