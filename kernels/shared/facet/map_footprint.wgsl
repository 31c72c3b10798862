// A pixel's footprint in the light's map: how its place there moves from pixel to pixel, and the box around
// its samples.

//@import frame receiver
//@needs var<uniform> frame: Frame;

const PLACE_NOISE = 0.00000095367;   // of a product of a row of the light's view and a point

struct MapFootprint {
    some: bool,        // the pixel's centre sees a receiver that may be lit, in front of the light
    right: vec2<f32>,  // texels of the map for a pixel to the right
    down: vec2<f32>,   // for a pixel down
    low: vec2<f32>,    // box around the samples; the centre where one of its corners is not seen
    high: vec2<f32>,
    w: f32,            // divisor of the centre's place
    distance: f32,     // of the receiver from the eye
}

fn map_footprint(pixel: u32) -> MapFootprint {
    var f: MapFootprint;
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN { return f; }
    let ray = ray_at(pixel, vec2(0.0));
    let point = plane_point(r, ray);
    let at = place_at(point);
    if at.w == 0.0 { return f; }
    f.some = true;
    f.distance = length(point.xyz);
    // How the place moves from pixel to pixel.
    let over = dot(r.normal, ray);
    let right = (r.height / over) * (frame.ray_x.xyz - ray * (dot(r.normal, frame.ray_x.xyz) / over));
    let down = (r.height / over) * (frame.ray_y.xyz - ray * (dot(r.normal, frame.ray_y.xyz) / over));
    f.w = dot(frame.map_w, from_lamp(point.xyz));
    let u = frame.map_u.xyz - at.x * frame.map_w.xyz;
    let v = frame.map_v.xyz - at.y * frame.map_w.xyz;
    f.right = vec2(dot(u, right), dot(v, right)) / f.w;
    f.down = vec2(dot(u, down), dot(v, down)) / f.w;
    f.low = at.xy;
    f.high = at.xy;
    var box_low = at.xy;
    var box_high = at.xy;
    var whole = true;
    for (var k = 0u; k < 4u; k++) {
        let corner = place_of(r, ray_at(pixel, vec2(
            select(frame.sample_low.x, frame.sample_high.x, (k & 1u) == 1u),
            select(frame.sample_low.y, frame.sample_high.y, k >= 2u))));
        whole = whole && corner.w != 0.0;
        box_low = min(box_low, corner.xy);
        box_high = max(box_high, corner.xy);
    }
    if whole {
        f.low = box_low;
        f.high = box_high;
    }
    return f;
}

fn sum_of(v: vec4<f32>) -> f32 { return dot(abs(v), vec4(1.0)); }

// Rounding of a place, texels times its divisor.
fn place_noise() -> f32 {
    return PLACE_NOISE * (max(sum_of(frame.map_u), sum_of(frame.map_v))
        + sum_of(frame.map_w) * f32(frame.map_size));
}
