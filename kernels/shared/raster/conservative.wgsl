// Conservative overlap of a projected triangle with a texel, and its range of depth there. A texel is tested
// with its square grown by frame.map_margin, which is far above the rounding of the projection and of the
// edge functions; large coordinates grow it further.

//@import frame undivided
//@needs var<uniform> frame: Frame;

struct Cover {
    edges: array<vec3<f32>, 3>,  // inside where dot((x, y, 1), edge) >= 0 for a texel centre, reach included
    low: vec2<f32>,
    high: vec2<f32>,
    depth: vec3<f32>,            // depth = dot((x, y, 1), depth); a flat range where the slope is not known
    half_range: f32,
    reach: f32,                  // half a texel, margins included
    nearest: f32,
    farthest: f32,
    in_front: bool,              // its edges are known; else every texel counts as touched
    // Not all corners lie in front of the light: more counts as touched, at any depth
    cut: bool,
    thin: bool,                  // too thin for its orientation to be known: touched where an edge is
    // Of one that is cut: how far beyond being touched, by each edge, all of a texel is inside, and what the
    // light's nearest distance is at most of its own there, as dot((x, y, 1), front)
    whole: vec3<f32>,
    front: vec3<f32>,
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
    s.in_front = true;
    s.cut = false;
    let low = min(min(a.xy, b.xy), c.xy);
    let high = max(max(a.xy, b.xy), c.xy);
    let extent = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let reach = 0.5 + margin + 4e-6 * extent;
    s.reach = reach;
    s.low = low - reach;
    s.high = high + reach;
    let ab = b.xy - a.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let size = max(abs(ab.x) + abs(ab.y), abs(ac.x) + abs(ac.y));
    s.thin = abs(area) <= 4e-6 * (extent + size) * size;
    let turn = select(-1.0, 1.0, area > 0.0);
    s.edges[0] = cover_edge(a.xy, b.xy, turn, reach);
    s.edges[1] = cover_edge(b.xy, c.xy, turn, reach);
    s.edges[2] = cover_edge(c.xy, a.xy, turn, reach);
    s.nearest = min(a.z, min(b.z, c.z)) - frame.depth_margin;
    s.farthest = max(a.z, max(b.z, c.z)) + frame.depth_margin;
    if s.thin {
        s.depth = vec3(0.0, 0.0, 0.5 * (s.nearest + s.farthest));
        s.half_range = s.farthest - s.nearest;
    } else {
        let za = b.z - a.z;
        let zc = c.z - a.z;
        let slope = vec2(za * ac.y - zc * ab.y, zc * ab.x - za * ac.x) / area;
        s.depth = vec3(slope, a.z - dot(slope, a.xy));
        s.half_range = (reach + 4e-6 * extent) * (abs(slope.x) + abs(slope.y)) + frame.depth_margin;
    }
    // Few are cut off at the light: a loop that the others do not enter.
    for (var cut = min(a.w, min(b.w, c.w)) <= 0.0; cut; cut = false) { s = cover_cut(a, b, c, margin); }
    return s;
}

// A triangle that reaches behind the light's nearest distance. The lines of its edges are found without
// division, so that of what lies in front of the light they hold all, however near to the light it comes
// (Olano and Greer 1997). They reach out by what rounding may have moved the corners. Depth is linear in the
// place as that of any plane, and so is the inverse of the distance; both may be off by as much.
fn cover_cut(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, margin: f32) -> Cover {
    var s: Cover;
    let near = frame.light_low.w;
    let p = undivided(a, near).xyw;
    let q = undivided(b, near).xyw;
    let r = undivided(c, near).xyw;
    let size = f32(frame.map_size);
    let far = vec3(
        max(max(abs(p.x), abs(p.y)), size * abs(p.z)), max(max(abs(q.x), abs(q.y)), size * abs(q.z)),
        max(max(abs(r.x), abs(r.y)), size * abs(r.z)));
    let off = 8.0 * frame.map_margin * near;
    let both = far * far.yzx;
    let pq = cross(p, q);
    let qr = cross(q, r);
    let rp = cross(r, p);
    let det = dot(p, qr);
    // Rounding far from the light, more in a narrow view.
    let one = vec3(1.0);
    let across = max(dot(abs(frame.map_u.xyz), one), dot(abs(frame.map_v.xyz), one));
    let share = 4e-6 + 2e-6 * (across / size + dot(abs(frame.map_w.xyz), one));
    let noise = (off * (both.x + both.y + both.z) + 2.0 * share * far.x * far.y * far.z) / size;
    s.in_front = (frame.flags & FLAG_PERSPECTIVE) != 0u && abs(det) > noise;
    s.cut = true;
    let turn = select(-1.0, 1.0, det > 0.0);
    let slack = off * (far + far.yzx) + share * both;
    s.edges[0] = line_beside(turn * pq, 0.5 + margin, slack.x);
    s.edges[1] = line_beside(turn * qr, 0.5 + margin, slack.y);
    s.edges[2] = line_beside(turn * rp, 0.5 + margin, slack.z);
    let bare = turn * vec3(pq.z, qr.z, rp.z);
    s.whole = 2.0 * (vec3(s.edges[0].z, s.edges[1].z, s.edges[2].z) - bare);
    s.low = vec2(-3.0e38);
    s.high = vec2(3.0e38);
    s.half_range = 3.0e38;
    s.reach = 0.5 + margin;
    s.nearest = -3.0e38;
    s.farthest = 3.0e38;
    s.front = vec3(0.0, 0.0, 3.0e38);
    if s.in_front && abs(det) > 4.0 * noise {
        let z = vec3(undivided(a, near).z, undivided(b, near).z, undivided(c, near).z);
        let plane = (z.x * qr + z.y * rp + z.z * pq) / det;
        let spread = abs(plane.x) + abs(plane.y);
        let sure = abs(det) - noise;
        let error = (dot(abs(z), slack.yzx) + 2.0 * noise) / sure + 8.0 * frame.depth_margin
            + 1e-6 * (size * spread + abs(plane.z));
        s.depth = plane;
        s.half_range = s.reach * spread + error;
        let inverse = (near / det) * (pq + qr + rp);
        let more = s.reach * (abs(inverse.x) + abs(inverse.y))
            + near * (slack.x + slack.y + slack.z) / sure;
        s.front = inverse + vec3(0.0, 0.0, more);
    }
    return s;
}

// Whether a triangle that is cut surely covers all of a texel (`share` 1), or its centre (0.75), where that
// is well beyond the light's nearest distance.
fn holds(s: Cover, centre: vec2<f32>, share: f32) -> bool {
    let at = vec3(centre, 1.0);
    let e = vec3(dot(s.edges[0], at), dot(s.edges[1], at), dot(s.edges[2], at));
    return all(e >= share * s.whole) && dot(s.front, at) <= 1.25 - 0.75 * share;
}

fn line_beside(n: vec3<f32>, reach: f32, slack: f32) -> vec3<f32> {
    return n + vec3(0.0, 0.0, reach * (abs(n.x) + abs(n.y)) + slack);
}

fn covers(s: Cover, centre: vec2<f32>) -> bool {
    if !s.in_front { return true; }
    if any((centre < s.low) | (centre > s.high)) { return false; }
    let at = vec3(centre, 1.0);
    let e = vec3(dot(s.edges[0], at), dot(s.edges[1], at), dot(s.edges[2], at));
    if all(e >= vec3(0.0)) { return true; }
    if !s.thin { return false; }
    // Within reach of the line of an edge: e - 2 * reach * |n| <= 0 <= e.
    return near_edge(s, 0u, e.x) | near_edge(s, 1u, e.y) | near_edge(s, 2u, e.z);
}

fn near_edge(s: Cover, k: u32, e: f32) -> bool {
    return (e >= 0.0) & (e <= 2.0 * s.reach * (abs(s.edges[k].x) + abs(s.edges[k].y)));
}

// Nearest and farthest depth the triangle may have over the texel.
fn depth_range(s: Cover, centre: vec2<f32>) -> vec2<f32> {
    let middle = dot(s.depth, vec3(centre, 1.0));
    return vec2(max(middle - s.half_range, s.nearest), min(middle + s.half_range, s.farthest));
}
