// The box of a facet's outline in the light view.

//@import frame facet from_lamp view_sides
//@needs var<uniform> frame: Frame;

// The box of the outline, without its corners.
struct OutlineBox {
    low: vec2<f32>,
    high: vec2<f32>,
    nearest: f32,
    farthest: f32,
    ahead: f32,      // largest divisor
    beyond: u32,     // sides of the view that all of it lies beyond, of a light at a point
    in_front: bool,
    known: bool,     // nearer to it, too: its corners are off by BLUR texels at most, which the box holds
    whole: bool,
}

const NO_BOX = OutlineBox(vec2(3.0e38), vec2(-3.0e38), 3.0e38, -3.0e38, -3.0e38, 15u, true, true, true);
const BLUR = 4.0;

fn box_add(out: ptr<function, OutlineBox>, point: vec3<f32>) {
    let p = from_lamp(point);
    var uvz = vec3(dot(frame.map_u, p), dot(frame.map_v, p), dot(frame.map_z, p));
    var blur = 0.0;
    if (frame.flags & FLAG_PERSPECTIVE) != 0u {
        let w = dot(frame.map_w, p);
        if w <= frame.light_low.w {
            (*out).in_front = false;
            // At the nearest distance rounding is a quarter of a texel.
            blur = 0.25 * frame.light_low.w / w;
            if !(frame.light.w != 0.0 && w > 0.0 && blur <= BLUR) { (*out).known = false; }
        }
        (*out).beyond &= sides_beyond(point);
        (*out).ahead = max((*out).ahead, w);
        uvz /= w;
    }
    (*out).nearest = min((*out).nearest, uvz.z);
    (*out).low = min((*out).low, uvz.xy - blur);
    (*out).high = max((*out).high, uvz.xy + blur);
    (*out).farthest = max((*out).farthest, uvz.z);
}

fn facet_box(pixel: u32, span: vec4<f32>, plane: vec4<f32>, limit: f32) -> OutlineBox {
    var out = NO_BOX;
    let rays = part_rays(pixel, span);
    let r0 = rays.r0;
    let r1 = rays.r1;
    let r2 = rays.r2;
    let r3 = rays.r3;
    // A ray meets the plane nearer than the limit where `over <= 0`.
    let bound = plane.w / limit;
    let along = vec4(dot(plane.xyz, r0), dot(plane.xyz, r1), dot(plane.xyz, r2), dot(plane.xyz, r3));
    let over = along - bound;
    let meets = over <= vec4(0.0);
    if meets.x { box_add(&out, r0 * (plane.w / along.x)); }
    if meets.y { box_add(&out, r1 * (plane.w / along.y)); }
    if meets.z { box_add(&out, r2 * (plane.w / along.z)); }
    if meets.w { box_add(&out, r3 * (plane.w / along.w)); }
    out.whole = all(meets);
    // Sides that the limit cuts: few facets have any.
    let cut = select(vec4(0u), vec4(1u, 2u, 4u, 8u), meets != meets.yzwx);
    for (var sides = cut.x | cut.y | cut.z | cut.w; sides != 0u; sides &= sides - 1u) {
        let side = sides & (0u - sides);
        var ray = r0;
        var next = r1;
        var ends = over.xy;
        if side == 2u { ray = r1; next = r2; ends = over.yz; }
        if side == 4u { ray = r2; next = r3; ends = over.zw; }
        if side == 8u { ray = r3; next = r0; ends = over.wx; }
        box_add(&out, mix(ray, next, ends.x / (ends.x - ends.y)) * limit);
    }
    return out;
}

// Cuts the box to that of the triangle, if it is known where all of that lies.
fn cut_to_triangle(out: ptr<function, OutlineBox>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) {
    var own = NO_BOX;
    box_add(&own, a);
    box_add(&own, b);
    box_add(&own, c);
    if !own.known { return; }
    let extent = max(abs(own.low), abs(own.high));
    let slack = 1e-6 * max(extent.x, extent.y);
    own.low -= slack;
    own.high += slack;
    // A plane that is hardly known may miss its own triangle.
    let low = max((*out).low, own.low);
    let high = min((*out).high, own.high);
    if (*out).known && all(low <= high) {
        own.low = low;
        own.high = high;
        if (*out).in_front && own.in_front { own.farthest = min((*out).farthest, own.farthest); }
        if !own.in_front { own.farthest = (*out).farthest; }
    }
    own.in_front |= (*out).in_front;
    own.whole = (*out).whole;
    *out = own;
}
