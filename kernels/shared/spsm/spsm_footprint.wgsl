// Footprint of a pixel in the light view.

//@import frame pixel_ray receiver
//@needs override MANY: u32;
//@needs var<uniform> frame: Frame;

const CLASS_EMPTY = 0u;
const CLASS_DARK = 1u;
const CLASS_LIT = 2u;
const CLASS_SHADOWED = 3u;
const CLASS_UNCERTAIN = 4u;
const MOST_TEXELS = 25.0;     // of a footprint that is settled as a whole

// Footprint of a pixel in the light view: the place of its centre, the box of its corners, and the texels
// that the box touches.
struct Footprint {
    at: vec4<f32>,
    low: vec2<f32>,
    high: vec2<f32>,
    first: vec2<i32>,
    last: vec2<i32>,
    class_known: u32,   // CLASS_EMPTY where it is not known yet
}

fn footprint_of(r: Receiver, pixel: u32) -> Footprint {
    var f: Footprint;
    f.at = place_of(r, ray_at(pixel, vec2(0.0)));
    f.low = f.at.xy;
    f.high = f.at.xy;
    var whole = true;
    if MANY != 0u {
        for (var k = 0u; k < 4u; k++) {
            let corner = place_of(r, ray_at(pixel,
                vec2(select(-0.5, 0.5, (k & 1u) == 1u), select(-0.5, 0.5, k >= 2u))));
            whole = whole && corner.w != 0.0;
            f.low = min(f.low, corner.xy);
            f.high = max(f.high, corner.xy);
        }
    }
    let side = f32(frame.map_size);
    f.first = vec2<i32>(clamp(floor(f.low), vec2(0.0), vec2(side - 1.0)));
    f.last = vec2<i32>(clamp(floor(f.high), vec2(0.0), vec2(side - 1.0)));
    let extent = vec2<f32>(f.last - f.first + 1);
    let beside = any(f.high < vec2(0.0)) || any(f.low >= vec2(side));
    let large = extent.x * extent.y > MOST_TEXELS;
    if f.at.w == 0.0 || (whole && beside) {
        f.class_known = CLASS_LIT;
    } else if !whole || large {
        f.class_known = CLASS_UNCERTAIN;
    }
    // Nothing that is settled already is tested texel by texel.
    if f.class_known != CLASS_EMPTY { f.last = f.first; }
    return f;
}
