// Depth tests of receiver against sheet, and the border of a shadow as the outer edges of the sheets around
// give it (Lecocq 2013, section 4.2).

//@import spsm_record spsm_sheet receiver
//@needs override BIAS: f32;

var<private> pieces: array<vec4<f32>, 75>;  // edges of up to 25 texels: both ends
var<private> piece_count: u32;

// Bias for rounding of the light view, over a receiver of this slope.
fn bias_of(r: Receiver) -> f32 {
    return BIAS + depth_noise() + (abs(r.slope.x) + abs(r.slope.y)) * place_noise();
}

// Between what values least_gap lies, whatever of the texel the triangle takes: the plane over the whole
// texel, a little more than what rounding makes of it.
fn gap_bounds(s: Sheet, receiver: vec3<f32>) -> vec2<f32> {
    let gap = s.depth - receiver;
    let tilt = abs(gap.x) + abs(gap.y);
    let reach = 0.50001 * tilt + 1e-6 * (abs(s.depth.z) + abs(receiver.z));
    let middle = gap.z + s.doubt.z + edge_doubt() * tilt;
    return vec2(middle - reach, middle + reach + 0.50001 * (s.doubt.x + s.doubt.y));
}

const BEHIND = 0u;
const BEFORE = 1u;
const EITHER = 2u;

// Whether the texel's triangle lies before the receiver anywhere in the texel, as far as its plane alone
// tells.
fn before_by_plane(s: Sheet, around: vec3<f32>, far: f32, most: f32) -> u32 {
    let here = gap_bounds(s, around);
    let there = gap_bounds(s, vec3(0.0, 0.0, far));
    if !s.held || here.x >= most || there.x >= most { return BEHIND; }
    return select(EITHER, BEFORE, here.y < most && there.y < most);
}

// Likewise, by its outline in the texel: before the receiver's plane, and not behind all of its triangle,
// which ends where the plane goes on.
fn before_by(s: Sheet, o: Outline, around: vec3<f32>, far: f32, most: f32) -> bool {
    return least_gap(s, o, around) < most && least_gap(s, o, vec3(0.0, 0.0, far)) < most;
}

fn before(s: Sheet, r: Receiver, at: vec4<f32>, centre: vec2<f32>) -> bool {
    let around = receiver_around(r, at, centre);
    let most = -bias_of(r);
    let told = before_by_plane(s, around, r.far, most);
    if told != EITHER { return told == BEFORE; }
    return before_by(s, outline_of(s), around, r.far, most);
}

// Likewise for one place: besides, the triangle's plane at the place, or all of the triangle in the texel,
// lies before it. Where a surface is hollow each of two neighbours lies before the other's plane, and neither
// shadows the other.
fn before_place(s: Sheet, r: Receiver, at: vec4<f32>, centre: vec2<f32>) -> bool {
    let around = receiver_around(r, at, centre);
    let most = -bias_of(r);
    let told = before_by_plane(s, around, r.far, most);
    if told == BEHIND { return false; }
    let there = at.xy - centre;
    let limit = at.z - bias_of(r);
    let plane_before = dot(s.depth, vec3(there, 1.0)) + doubt_at(s, there) < limit;
    if told == BEFORE && plane_before { return true; }
    let outline = outline_of(s);
    if told == EITHER && !before_by(s, outline, around, r.far, most) { return false; }
    if plane_before { return true; }
    var turned = s;
    turned.depth = -s.depth;
    return -least_gap(turned, outline, vec3(0.0)) + 2.0 * doubt_at(s, vec2(0.5)) < limit;
}

// Algorithm 1, for a place relative to the sheet's texel.
fn shadows(s: Sheet, at: vec3<f32>, r: Receiver) -> bool {
    let doubt = doubt_at(s, at.xy) + step_doubt(s.depth.xy - r.slope) + bias_of(r);
    return inside_by(s, at.xy) >= 0.0 && at.z > dot(s.depth, vec3(at.xy, 1.0)) + doubt;
}

// Whether `at` lies on the lit side of the border that the outer edges link, seen in direction `out`.
fn beyond_border(at: vec2<f32>, out: vec2<f32>) -> bool {
    let along = vec2(-out.y, out.x);
    let t = dot(at, along);
    let reach = dot(at, out);
    var top = -3.0e38;
    var previous = vec2(-3.0e38, 0.0);
    var after = vec2(3.0e38, 0.0);
    for (var k = 0u; k < piece_count; k++) {
        let a = pieces[k].xy;
        let b = pieces[k].zw;
        let d = b - a;
        // The sheet lies on the side (d.y, -d.x): an outer edge looks along `out`.
        if !(dot(vec2(-d.y, d.x), out) > 0.0) { continue; }
        let head = vec2(dot(a, along), dot(a, out));
        let tail = vec2(dot(b, along), dot(b, out));
        let left = select(tail, head, head.x <= tail.x);
        let right = select(head, tail, head.x <= tail.x);
        if left.x <= t && t <= right.x {
            top = max(top, mix(left.y, right.y,
                select((t - left.x) / (right.x - left.x), 0.5, right.x - left.x < 1e-6)));
        }
        if right.x <= t && (right.x > previous.x || (right.x == previous.x && right.y > previous.y)) {
            previous = right;
        }
        if left.x >= t && (left.x < after.x || (left.x == after.x && left.y > after.y)) { after = left; }
    }
    if top < -1.0e38 && previous.x > -1.0e38 && after.x < 1.0e38 {
        top = mix(previous.y, after.y, (t - previous.x) / max(after.x - previous.x, 1e-6));
    }
    return reach > top;
}
