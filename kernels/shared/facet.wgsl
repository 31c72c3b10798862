// Facets: what stands for a surface inside one pixel (Pan 2009, section 3.1). Needs `frame`.

//@import pixel_ray

struct Facet {
    plane: vec4<f32>,   // dot(xyz, point) = w on it; the light and the eye lie where dot(xyz, point) > w
    pixel: u32,
    triangle: u32,      // the triangle whose plane it is
    rect: vec2<u32>,    // texels its light-view outline touches
    state: u32,
    farthest: f32,      // its largest depth from the light
    limit: f32,         // view depth beyond which the plane is not followed
    tilt: f32,          // relative rounding of the normal, in units of 2^-24
    at: vec3<f32>,      // its point at the sample `origin`
    doubt: f32,         // how far rounding may have moved that point along its ray, times -dot(plane.xyz, ray)
    box_low: vec2<f32>, // box of its outline, in texels
    box_high: vec2<f32>,
    slope: vec4<f32>,   // depth from the light = dot(slope.xyz, (x, y, 1)) in texels, give or take w
    origin: vec2<f32>,  // a sample of its coverage, relative to the pixel centre: where `at` is
    span: vec2<u32>,    // box around the samples it covers, lowest and highest corner packed; 0: the whole pixel
}

const STATE_EMPTY = 0u;      // no surface: counts as lit
const STATE_DARK = 1u;       // faces away from the light
const STATE_LIT = 2u;        // settled: nothing between it and the light
const STATE_SHADOWED = 3u;   // settled: one sheet covers all of it
const STATE_UNDECIDED = 4u;  // to be evaluated
const STATE_MERGED = 5u;     // before facets are classified: of several triangles, which reach no farther than `limit`

const PIXEL_REACH = 0.50390625;  // half a pixel and 1/256: samples lie well inside the outline

struct Outline {
    corners: array<vec2<f32>, 5>,  // in texels, in order around
    count: u32,
    farthest: f32,
    in_front: bool,                // the whole outline lies in front of the light
    whole: bool,                   // every ray of the pixel meets the plane in front of the limit
}

// A word of the mask of all samples.
fn full_word(word: u32) -> u32 {
    let left = frame.sample_count - 32u * word;
    return select((1u << left) - 1u, 0xffffffffu, left >= 32u);
}

// Lowest and highest corner of what a facet covers of its pixel, relative to the centre.
fn part_of(packed: vec2<u32>) -> vec4<f32> {
    if all(packed == vec2(0u)) { return vec4(-PIXEL_REACH, -PIXEL_REACH, PIXEL_REACH, PIXEL_REACH); }
    return vec4(unpack2x16snorm(packed.x), unpack2x16snorm(packed.y));
}

// The footprint on `plane` of a part of the pixel as the light sees it, cut off where view depth exceeds `limit`.
fn facet_outline(pixel: u32, span: vec4<f32>, plane: vec4<f32>, limit: f32) -> Outline {
    var out: Outline;
    out.in_front = true;
    out.whole = true;
    out.farthest = -3.0e38;
    let centre = pixel_ray(pixel);
    // A ray meets the plane nearer than the limit where `over <= 0`.
    let bound = plane.w / limit;
    var offsets = array<vec2<f32>, 4>(span.xy, span.zy, span.zw, span.xw);
    for (var k = 0u; k < 4u; k++) {
        let ray = centre + (offsets[k].x * frame.ray_x.xyz + offsets[k].y * frame.ray_y.xyz);
        let next = offsets[(k + 1u) & 3u];
        let ray_next = centre + (next.x * frame.ray_x.xyz + next.y * frame.ray_y.xyz);
        let over = dot(plane.xyz, ray) - bound;
        let over_next = dot(plane.xyz, ray_next) - bound;
        if over <= 0.0 { outline_add(&out, ray * (plane.w / dot(plane.xyz, ray))); } else { out.whole = false; }
        if (over <= 0.0) != (over_next <= 0.0) {
            let cut = mix(ray, ray_next, over / (over - over_next));
            outline_add(&out, cut * limit);
        }
    }
    return out;
}

fn outline_add(out: ptr<function, Outline>, point: vec3<f32>) {
    let p = vec4(point, 1.0);
    var uvz = vec3(dot(frame.map_u, p), dot(frame.map_v, p), dot(frame.map_z, p));
    if (frame.flags & FLAG_PERSPECTIVE) != 0u {
        let w = dot(frame.map_w, p);
        if w <= frame.light_low.w {
            (*out).in_front = false;
            return;
        }
        uvz /= w;
    }
    if (*out).count < 5u {
        (*out).corners[(*out).count] = uvz.xy;
        (*out).count += 1u;
    }
    (*out).farthest = max((*out).farthest, uvz.z);
}

// Whether the outline touches the texel around `centre`: separating axes across the outline's edges (Pan 2009, section
// 3.3, figure 5), the texel grown by the margin; the texel's own axes are settled by the rectangle.
fn outline_touches(out: ptr<function, Outline>, centre: vec2<f32>, reach: f32) -> bool {
    let count = (*out).count;
    if count < 3u || !(*out).in_front { return true; }
    var low = vec2(3.0e38);
    var high = vec2(-3.0e38);
    var left = true;
    var right = true;
    for (var k = 0u; k < count; k++) {
        let a = (*out).corners[k];
        var b = (*out).corners[0];
        if k + 1u < count { b = (*out).corners[k + 1u]; }
        let d = b - a;
        let e = d.x * (centre.y - a.y) - d.y * (centre.x - a.x);
        let slack = reach * (abs(d.x) + abs(d.y));
        left = left && e >= -slack;
        right = right && e <= slack;
        low = min(low, a);
        high = max(high, a);
    }
    return (left || right) && all(centre >= low - reach) && all(centre <= high + reach);
}
