// Effect of a caster on a facet, as far as outlines and slopes in the light view tell (candidate_pairs).

//@import frame facet facet_quad facing
//@needs override ALONE: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> undecided: array<Undecided>;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> map_points: array<vec4<f32>>;

const NOTHING = 0u;
const MATTERS = 1u;
const COVERS = 2u;

// How far the quad reaches beyond the line a-b (x: its outermost point, y: its innermost, both positive
// inside).
fn reach_of(a: vec2<f32>, b: vec2<f32>, turn: f32, quad: Quad) -> vec2<f32> {
    let n = turn * vec2(a.y - b.y, b.x - a.x);
    let at = dot(n, quad.middle - a);
    let wide = abs(dot(n, quad.u)) + abs(dot(n, quad.v)) + dot(abs(n), quad.rest);
    return vec2(at - wide, at + wide);
}

// Facet data that `effect` reads.
struct Own {
    i: vec3<u32>,  // its own triangle
    turn: f32,     // sign of the area of that in the light view; 0 if the facet has samples elsewhere
    // Sign of the area of what turns away from the light, if such casters of closed bodies are left out; else
    // 0
    back: f32,
}

fn own_of(f: u32, t: u32) -> Own {
    let way = sign(dot(cross(frame.map_u.xyz, frame.map_v.xyz), frame.map_z.xyz));
    var own = Own(vec3(0u), 0.0, select(0.0, way, (frame.flags & FLAG_CULL_BACK) != 0u));
    if ALONE != 0u {
        own.i = triangles[t].xyz;
        let tilts = undecided[f].tilts;
        let turn = -way * facet_turn(tilts) * select(1.0, -1.0, is_reversed(own.i, rising(own.i)));
        own.turn = select(0.0, turn, (tilts & FACET_ALONE) != 0u);
    }
    return own;
}

// Whether two triangles run through an edge in opposite directions.
fn share_edge(i: vec3<u32>, j: vec3<u32>) -> bool {
    let one = (i == j.yzx) & (i.yzx == j);
    let two = (i == j.zxy) & (i.yzx == j.yzx);
    let three = (i == j) & (i.yzx == j.zxy);
    return any(one | two | three);
}

// Effect that a triangle may have on a facet: none, some, or it covers the whole facet. Of two triangles at
// an edge that face the light alike neither casts on the other. What is no caster (FLAG_CULL_BACK) may still
// cut a facet whose plane it reaches. One with holes covers none.
fn effect(
    t: u32,
    own: Own,
    middle: vec2<f32>,
    half: vec2<f32>,
    quad: Quad,
    slope: vec4<f32>,
    farthest: f32,
) -> u32 {
    let i = triangles[t];
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    let low = min(min(a.xy, b.xy), c.xy);
    let high = max(max(a.xy, b.xy), c.xy);
    let apart = any((low > middle + half) | (high < middle - half));
    let beyond = min(a.z, min(b.z, c.z)) > farthest + frame.depth_margin;
    let over = vec3(
        dot(slope.xyz, vec3(a.xy, 1.0)) - a.z, dot(slope.xyz, vec3(b.xy, 1.0)) - b.z,
        dot(slope.xyz, vec3(c.xy, 1.0)) - c.z);
    // Rounding grows with the distance at which the slope is followed.
    let reach = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let noise = slope.w + 1e-6 * (abs(slope.x) + abs(slope.y)) * reach;
    let below = all(over < vec3(-noise));
    let ab = b.xy - a.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let size = max(abs(ab.x) + abs(ab.y), abs(ac.x) + abs(ac.y));
    let thin = abs(area) <= 4e-6 * (reach + size) * size;
    let turn = select(-1.0, 1.0, area > 0.0);
    let grown = Quad(quad.middle, quad.u, quad.v, quad.rest + 4e-6 * reach);
    let e0 = reach_of(a.xy, b.xy, turn, grown);
    let e1 = reach_of(b.xy, c.xy, turn, grown);
    let e2 = reach_of(c.xy, a.xy, turn, grown);
    var beside = false;
    // That a triangle turns to the light or away is known if no corner's rounding turns it.
    let known = abs(area) > (2.0 * frame.map_margin + 4e-6 * (reach + size)) * size;
    if ALONE != 0u { beside = share_edge(own.i, i.xyz) & (turn * own.turn > 0.0) & known; }
    let above = all(over > vec3(noise)) & (noise < 1e30);
    let spare = (i.w == 1u) & (turn * own.back > 0.0) & above & known;
    let outside = (min(e0.y, min(e1.y, e2.y)) < 0.0) & !thin;
    let covers = (min(e0.x, min(e1.x, e2.x)) > 0.0) & !thin & above & (i.w < 2u);
    let in_front = min(a.w, min(b.w, c.w)) > 0.0;
    let e = select(select(MATTERS, COVERS, covers), NOTHING,
        apart | beyond | below | outside | beside | spare);
    return select(MATTERS, e, in_front);
}
