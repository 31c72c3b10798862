// Conservative overlap of a projected triangle with a texel, and its range of depth there. Needs `frame`.
// A texel is tested with its square grown by frame.map_margin, which is far above the rounding of the projection and of
// the edge functions; large coordinates grow it further.

//@import front_part

struct Cover {
    edges: array<vec3<f32>, 3>,  // inside where dot((x, y, 1), edge) >= 0 for a texel centre, reach included
    low: vec2<f32>,
    high: vec2<f32>,
    depth: vec3<f32>,            // depth = dot((x, y, 1), depth); a flat range where the slope is not known
    half_range: f32,
    reach: f32,                  // half a texel, margins included
    nearest: f32,
    farthest: f32,
    in_front: bool,              // what lies in front of the light is known; else every texel counts as touched
    thin: bool,                  // too thin for its orientation to be known: touched where an edge is
}

fn cover_edge(a: vec2<f32>, b: vec2<f32>, turn: f32, reach: f32) -> vec3<f32> {
    let n = turn * vec2(a.y - b.y, b.x - a.x);
    return vec3(n, reach * (abs(n.x) + abs(n.y)) - dot(n, a));
}

fn cover_triangle(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> Cover {
    return cover_triangle_by(a, b, c, frame.map_margin);
}

fn cover_triangle_by(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, margin: f32) -> Cover {
    var s: Cover;
    let part = front_part(a, b, c);
    let low = min(min(part.a.xy, part.b.xy), min(part.c.xy, part.d.xy));
    let high = max(max(part.a.xy, part.b.xy), max(part.c.xy, part.d.xy));
    let extent = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let reach = 0.5 + margin + 4e-6 * extent;
    s.reach = reach;
    s.low = low - reach;
    s.high = high + reach;
    let ab = part.b.xy - part.a.xy;
    let ac = part.d.xy - part.a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let size = max(abs(ab.x) + abs(ab.y), abs(ac.x) + abs(ac.y));
    s.thin = abs(area) <= 4e-6 * (extent + size) * size;
    // What is cut off reaches far: which way it turns may not be known though it is wide.
    s.in_front = part.any && (part.whole || !s.thin);
    let turn = select(-1.0, 1.0, area > 0.0);
    s.edges[0] = cover_edge(part.a.xy, part.b.xy, turn, reach);
    s.edges[1] = cover_edge(part.b.xy, part.c.xy, turn, reach);
    s.edges[2] = cover_edge(part.d.xy, part.a.xy, turn, reach);
    s.nearest = min(min(part.a.z, part.b.z), min(part.c.z, part.d.z)) - frame.depth_margin;
    s.farthest = max(max(part.a.z, part.b.z), max(part.c.z, part.d.z)) + frame.depth_margin;
    if s.thin {
        s.depth = vec3(0.0, 0.0, 0.5 * (s.nearest + s.farthest));
        s.half_range = s.farthest - s.nearest;
    } else {
        let za = part.b.z - part.a.z;
        let zc = part.d.z - part.a.z;
        let slope = vec2(za * ac.y - zc * ab.y, zc * ab.x - za * ac.x) / area;
        s.depth = vec3(slope, part.a.z - dot(slope, part.a.xy));
        s.half_range = (reach + 4e-6 * extent) * (abs(slope.x) + abs(slope.y)) + frame.depth_margin;
    }
    return s;
}

fn covers(s: Cover, centre: vec2<f32>) -> bool {
    if !s.in_front { return true; }
    if any(centre < s.low) || any(centre > s.high) { return false; }
    let at = vec3(centre, 1.0);
    let e = vec3(dot(s.edges[0], at), dot(s.edges[1], at), dot(s.edges[2], at));
    if all(e >= vec3(0.0)) { return true; }
    if !s.thin { return false; }
    // Within reach of the line of an edge: e - 2 * reach * |n| <= 0 <= e.
    return near_edge(s, 0u, e.x) || near_edge(s, 1u, e.y) || near_edge(s, 2u, e.z);
}

fn near_edge(s: Cover, k: u32, e: f32) -> bool {
    return e >= 0.0 && e <= 2.0 * s.reach * (abs(s.edges[k].x) + abs(s.edges[k].y));
}

// Nearest and farthest depth the triangle may have over the texel.
fn depth_range(s: Cover, centre: vec2<f32>) -> vec2<f32> {
    let middle = dot(s.depth, vec3(centre, 1.0));
    return vec2(max(middle - s.half_range, s.nearest), min(middle + s.half_range, s.farthest));
}
