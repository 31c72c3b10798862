// Where a facet's part of the pixel lies in the light view: its outline as four corners, which of thin and
// slanting facets takes much less than its box.

//@import frame facet facet_outline facing
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> undecided: array<Undecided>;

// Corners lie at middle + u + v + rest, middle - u + v - rest, middle - u - v + rest and middle + u - v -
// rest.
struct Quad {
    middle: vec2<f32>,
    u: vec2<f32>,
    v: vec2<f32>,
    rest: vec2<f32>,  // at least that, the margin, and what far corners are off
}

fn quad_of(f: u32) -> Quad {
    let low = undecided[f].box_low;
    let high = undecided[f].box_high;
    let plane = undecided[f].plane;
    let rays = part_rays(undecided[f].pixel, part_of(undecided[f].span));
    let along = vec4(dot(plane.xyz, rays.r0), dot(plane.xyz, rays.r1), dot(plane.xyz, rays.r2),
        dot(plane.xyz, rays.r3));
    let a = seen_from_light(rays.r0 * (plane.w / along.x));
    let b = seen_from_light(rays.r1 * (plane.w / along.y));
    let c = seen_from_light(rays.r2 * (plane.w / along.z));
    let d = seen_from_light(rays.r3 * (plane.w / along.w));
    // Cut off by the limit, or not all in front of the light, it is its box.
    let whole = all(along - plane.w / undecided[f].limit <= vec4(0.0))
        & (min(min(a.z, b.z), min(c.z, d.z)) > 0.0)
        & (undecided[f].triangle < frame.triangle_count);
    let half = 0.5 * (high - low);
    if !whole { return Quad(0.5 * (low + high), vec2(half.x, 0.0), vec2(0.0, half.y), vec2(0.0)); }
    let ac = a.xy + c.xy;
    let bd = b.xy + d.xy;
    let rounding = 4e-6 * (max(largest(a), largest(c)) + max(largest(b), largest(d)));
    let rest = 0.25 * abs(ac - bd) + frame.map_margin + rounding;
    return Quad(0.25 * (ac + bd), 0.25 * ((b.xy + c.xy) - (a.xy + d.xy)),
        0.25 * ((c.xy + d.xy) - (a.xy + b.xy)), rest);
}

fn turned(p: vec2<f32>, q: vec2<f32>) -> f32 { return p.x * q.y - p.y * q.x; }

// The cells of a tile that the quad touches, as far as axes across its sides tell; a cell is half a texel.
fn quad_cells(q: Quad, tile: vec2<u32>) -> u32 {
    let at = 2.0 * vec2<f32>(tile) + 0.25 - q.middle;
    let rest = q.rest + 0.25;
    let wide = abs(turned(q.u, q.v));
    let across = vec2(wide + abs(q.u.x) * rest.y + abs(q.u.y) * rest.x,
        wide + abs(q.v.x) * rest.y + abs(q.v.y) * rest.x);
    let first = vec2(turned(q.u, at), turned(q.v, at));
    let x = -0.5 * vec2(q.u.y, q.v.y);
    let y = 0.5 * vec2(q.u.x, q.v.x);
    var cells = 0u;
    for (var row = 0u; row < 4u; row++) {
        let e = first + f32(row) * y;
        let u = abs(vec4(e.x, e.x + x.x, e.x + 2.0 * x.x, e.x + 3.0 * x.x));
        let v = abs(vec4(e.y, e.y + x.y, e.y + 2.0 * x.y, e.y + 3.0 * x.y));
        let bits = select(vec4(0u), vec4(1u, 2u, 4u, 8u), (u <= vec4(across.x)) & (v <= vec4(across.y)));
        cells |= (bits.x | bits.y | bits.z | bits.w) << (4u * row);
    }
    return cells;
}
