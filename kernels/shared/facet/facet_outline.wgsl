// The outline of a facet in the light view.

//@import frame facet from_lamp
//@needs var<uniform> frame: Frame;

// Corners in order around, in texels; where there are less than five, one of them again for the others.
struct Outline {
    a: vec2<f32>,
    b: vec2<f32>,
    c: vec2<f32>,
    d: vec2<f32>,
    e: vec2<f32>,
    known: bool,  // three corners to five, all in front of the light
}

// Its place in the light view, and whether that is in front of the light.
fn seen_from_light(point: vec3<f32>) -> vec3<f32> {
    let p = from_lamp(point);
    let uv = vec2(dot(frame.map_u, p), dot(frame.map_v, p));
    if (frame.flags & FLAG_PERSPECTIVE) == 0u { return vec3(uv, 1.0); }
    let w = dot(frame.map_w, p);
    return vec3(uv / w, select(0.0, 1.0, w > frame.light_low.w));
}

// The outline of a part of the pixel on `plane` as the light sees it, cut off where view depth exceeds
// `limit`.
fn facet_outline(pixel: u32, span: vec4<f32>, plane: vec4<f32>, limit: f32) -> Outline {
    let corners = part_rays(pixel, span);
    var rays = array<vec3<f32>, 4>(corners.r0, corners.r1, corners.r2, corners.r3);
    let along = vec4(dot(plane.xyz, rays[0]), dot(plane.xyz, rays[1]), dot(plane.xyz, rays[2]),
        dot(plane.xyz, rays[3]));
    // A ray meets the plane nearer than the limit where `over <= 0`.
    let over = along - plane.w / limit;
    let meets = over <= vec4(0.0);
    let a = seen_from_light(rays[0] * (plane.w / along.x));
    let b = seen_from_light(rays[1] * (plane.w / along.y));
    let c = seen_from_light(rays[2] * (plane.w / along.z));
    let d = seen_from_light(rays[3] * (plane.w / along.w));
    var out = Outline(a.xy, b.xy, c.xy, d.xy, a.xy, all(vec4(a.z, b.z, c.z, d.z) > vec4(0.0)));
    // Few facets are cut by the limit: a loop that the others do not enter.
    for (var cut = !all(meets); cut; cut = false) {
        var count = 0u;
        out.known = true;
        for (var k = 0u; k < 4u; k++) {
            let next = (k + 1u) & 3u;
            if meets[k] {
                count++;
                add_corner(&out, count, seen_from_light(rays[k] * (plane.w / along[k])));
            }
            if meets[k] != meets[next] {
                count++;
                add_corner(&out, count, seen_from_light(mix(rays[k], rays[next],
                    over[k] / (over[k] - over[next])) * limit));
            }
        }
        // More than five there are only by rounding.
        out.known = out.known & (count >= 3u) & (count <= 5u);
    }
    return out;
}

fn add_corner(out: ptr<function, Outline>, count: u32, corner: vec3<f32>) {
    if corner.z <= 0.0 { (*out).known = false; }
    if count == 1u { (*out).a = corner.xy; }
    if count <= 2u { (*out).b = corner.xy; }
    if count <= 3u { (*out).c = corner.xy; }
    if count <= 4u { (*out).d = corner.xy; }
    (*out).e = corner.xy;
}

// Whether the outline touches the texel around `centre`: separating axes across the outline's edges (Pan
// 2009, section 3.3, figure 5), the texel grown by the margin; the texel's own axes are settled by the
// rectangle.
fn outline_touches(out: Outline, centre: vec2<f32>, reach: f32) -> bool {
    var ends = vec2(3.0e38, -3.0e38);
    ends = beside(ends, out.a, out.b, centre, reach);
    ends = beside(ends, out.b, out.c, centre, reach);
    ends = beside(ends, out.c, out.d, centre, reach);
    ends = beside(ends, out.d, out.e, centre, reach);
    ends = beside(ends, out.e, out.a, centre, reach);
    let low = min(min(out.a, out.b), min(out.c, min(out.d, out.e))) - reach;
    let high = max(max(out.a, out.b), max(out.c, max(out.d, out.e))) + reach;
    return !out.known | (((ends.x >= 0.0) | (ends.y <= 0.0)) & all((centre >= low) & (centre <= high)));
}

// Least and greatest place beside an edge that the texel reaches to, of this edge and those before.
fn beside(ends: vec2<f32>, a: vec2<f32>, b: vec2<f32>, centre: vec2<f32>, reach: f32) -> vec2<f32> {
    let d = b - a;
    let e = d.x * (centre.y - a.y) - d.y * (centre.x - a.x);
    let slack = reach * (abs(d.x) + abs(d.y));
    return vec2(min(ends.x, e + slack), max(ends.y, e - slack));
}
