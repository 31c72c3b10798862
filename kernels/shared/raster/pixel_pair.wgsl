// A pixel that may show several surfaces, and a triangle that may be one of them (pixel_triangles).

struct PixelPair { triangle: u32, pixel: u32 }
