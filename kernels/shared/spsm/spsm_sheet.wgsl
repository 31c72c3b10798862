// Questions to a sheet of the sub-pixel shadow map. Places are in texels.

//@import frame spsm_record seen_texels receiver
//@needs override ENCODING: u32;
//@needs override SPLIT: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> seen: array<atomic<u32>>;
//@needs var<storage, read> upper_records: array<vec4<u32>>;
//@needs var<storage, read> lower_records: array<vec4<u32>>;

var<private> missed: bool;  // a texel was read that is not made

fn sheet_at(texel: vec2<i32>) -> Sheet {
    if any(texel < vec2(0)) || any(texel >= vec2(i32(frame.map_size))) { return Sheet(); }
    let place = seen_place(vec2<u32>(texel));
    if (atomicLoad(&seen[SEEN_BITS + place.x]) & place.y) == 0u {
        missed = true;
        return Sheet();
    }
    let at = u32(texel.y) * frame.map_size + u32(texel.x);
    let upper = upper_rows() * frame.map_size;
    var record: vec4<u32>;
    if SPLIT == 0u || at < upper { record = upper_records[at]; } else { record = lower_records[at - upper]; }
    return decode_record(record, middle_of(texel));
}

fn inside_by(s: Sheet, at: vec2<f32>) -> f32 {
    let p = vec3(at, 1.0);
    return min(dot(s.edges[0], p), min(dot(s.edges[1], p), dot(s.edges[2], p)));
}

fn doubt_at(s: Sheet, at: vec2<f32>) -> f32 {
    return dot(s.doubt, vec3(abs(at), 1.0));
}

// How far the code may have moved an edge, texels as |x| + |y|.
fn edge_doubt() -> f32 {
    if ENCODING == 0u { return f32(frame.map_size) / 65535.0; }
    return 0.002;
}

// Depth error from a moved edge where two sheets meet: the one is taken for the other across it.
fn step_doubt(gap: vec2<f32>) -> f32 {
    return edge_doubt() * (abs(gap.x) + abs(gap.y));
}

// The part of range (from x to y) of a line start + s * along on the inner side of an edge; empty where x >
// y.
fn cut_range(range: vec2<f32>, start: vec2<f32>, along: vec2<f32>, edge: vec3<f32>) -> vec2<f32> {
    let value = dot(edge, vec3(start, 1.0));
    let rate = dot(edge.xy, along);
    if abs(rate) < 1e-7 { return select(range, vec2(1.0, 0.0), value < 0.0); }
    let at = -value / rate;
    if rate > 0.0 { return vec2(max(range.x, at), range.y); }
    return vec2(range.x, min(range.y, at));
}

// Edge e of a sheet, whose other two are f and g, inside the square of half side `reach` around `middle`: its
// two ends, if anything of it is there. The sheet lies on the side (d.y, -d.x) of the way d from start to
// end.
struct Piece { start: vec2<f32>, end: vec2<f32>, some: bool }

fn piece_of(e: vec3<f32>, f: vec3<f32>, g: vec3<f32>, middle: vec2<f32>, reach: f32) -> Piece {
    let size = dot(e.xy, e.xy);
    let start = middle - e.xy * (dot(e, vec3(middle, 1.0)) / size);
    let along = vec2(-e.y, e.x);
    var range = vec2(-8.0, 8.0);
    range = cut_range(range, start, along, vec3(1.0, 0.0, reach - middle.x));
    range = cut_range(range, start, along, vec3(-1.0, 0.0, reach + middle.x));
    range = cut_range(range, start, along, vec3(0.0, 1.0, reach - middle.y));
    range = cut_range(range, start, along, vec3(0.0, -1.0, reach + middle.y));
    range = cut_range(range, start, along, f);
    range = cut_range(range, start, along, g);
    return Piece(start + range.x * along, start + range.y * along, range.x <= range.y);
}

// Parts of a sheet's edges in its texel: both ends each. Nothing where the triangle holds the whole texel: no
// edge is asked for there.
struct Outline { a: Piece, b: Piece, c: Piece }

fn outline_of(s: Sheet) -> Outline {
    let corner = vec3(0.5, -0.5, 0.0);
    let whole = inside_by(s, corner.xx) >= 0.0 && inside_by(s, corner.xy) >= 0.0
        && inside_by(s, corner.yx) >= 0.0
        && inside_by(s, corner.yy) >= 0.0;
    if whole { return Outline(); }
    let a = piece_of(s.edges[0], s.edges[1], s.edges[2], vec2(0.0), 0.5);
    let b = piece_of(s.edges[1], s.edges[2], s.edges[0], vec2(0.0), 0.5);
    let c = piece_of(s.edges[2], s.edges[0], s.edges[1], vec2(0.0), 0.5);
    return Outline(a, b, c);
}

fn gap_at(s: Sheet, gap: vec3<f32>, at: vec2<f32>) -> f32 {
    return dot(gap, vec3(at, 1.0)) + doubt_at(s, at) + step_doubt(gap.xy);
}

fn least_at_ends(s: Sheet, gap: vec3<f32>, p: Piece) -> f32 {
    return select(3.0e38, min(gap_at(s, gap, p.start), gap_at(s, gap, p.end)), p.some);
}

// Least depth of the sheet over its texel less that of the receiver (per x, per y, at the centre), each place
// taken where the triangle lies in the texel (Lecocq 2013, figure 9): at the texel's corner where the
// triangle holds it, else on an edge. Where nothing of the triangle is in the texel, as coded, the corner
// nearest to it decides. Doubt included.
fn least_gap(s: Sheet, o: Outline, receiver: vec3<f32>) -> f32 {
    let gap = s.depth - receiver;
    let corner = vec2(select(0.5, -0.5, gap.x > 0.0), select(0.5, -0.5, gap.y > 0.0));
    if inside_by(s, corner) >= 0.0 { return gap_at(s, gap, corner); }
    let least = min(least_at_ends(s, gap, o.a), min(least_at_ends(s, gap, o.b), least_at_ends(s, gap, o.c)));
    if least < 1.0e38 { return least; }
    var at = corner;
    for (var k = 0u; k < 4u; k++) {
        let other = vec2(select(-0.5, 0.5, (k & 1u) == 1u), select(-0.5, 0.5, k >= 2u));
        if inside_by(s, other) > inside_by(s, at) { at = other; }
    }
    return gap_at(s, gap, at);
}
