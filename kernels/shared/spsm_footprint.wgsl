// What a pixel covers of the light view, and what the closest triangles there say of all of it. Needs shared/spsm_border, the
// classes of spsm_query, and the overrides MANY and RADIUS.

// What of the light view a pixel covers: the place of its centre, the box of its corners, and the texels that the box touches.
struct Footprint {
    at: vec4<f32>,
    low: vec2<f32>,
    high: vec2<f32>,
    first: vec2<i32>,
    last: vec2<i32>,
    class_known: u32,   // CLASS_EMPTY where it is not known yet
}

fn footprint_of(r: Receiver, pixel: u32) -> Footprint {
    var f: Footprint;
    f.at = place_of(r, ray_at(pixel, vec2(0.0)));
    f.low = f.at.xy;
    f.high = f.at.xy;
    var whole = true;
    if MANY != 0u {
        for (var k = 0u; k < 4u; k++) {
            let corner = place_of(r, ray_at(pixel, vec2(select(-0.5, 0.5, (k & 1u) == 1u), select(-0.5, 0.5, k >= 2u))));
            whole = whole && corner.w != 0.0;
            f.low = min(f.low, corner.xy);
            f.high = max(f.high, corner.xy);
        }
    }
    let side = f32(frame.map_size);
    f.first = vec2<i32>(clamp(floor(f.low), vec2(0.0), vec2(side - 1.0)));
    f.last = vec2<i32>(clamp(floor(f.high), vec2(0.0), vec2(side - 1.0)));
    let extent = vec2<f32>(f.last - f.first + 1);
    let beside = any(f.high < vec2(0.0)) || any(f.low >= vec2(side));
    let large = extent.x * extent.y > MOST_TEXELS;
    if f.at.w == 0.0 || (whole && beside) { f.class_known = CLASS_LIT; } else if !whole || large { f.class_known = CLASS_UNCERTAIN; }
    // Nothing that is settled already is looked at texel by texel.
    if f.class_known != CLASS_EMPTY { f.last = f.first; }
    return f;
}

// Whether a closest triangle may lie before the receiver in a texel of the footprint: by its plane, or by its outline.
fn any_before(r: Receiver, f: Footprint, outlined: bool) -> bool {
    var found = false;
    var texel = f.first;
    loop {
        let s = sheet_at(texel);
        if outlined {
            found = found || before(s, r, f.at, middle_of(texel));
        } else {
            found = found || before_by_plane(s, receiver_around(r, f.at, middle_of(texel)), r.far, -bias_of(r)) != BEHIND;
        }
        if MANY == 0u { break; }
        texel.x += 1;
        if texel.x > f.last.x { texel = vec2(f.first.x, texel.y + 1); }
        if texel.y > f.last.y { break; }
    }
    return found;
}

// Whether one triangle around covers the footprint, or, of a footprint in one texel, all nine lie before it by their planes:
// then every pattern of depth tests there is the covered one.
fn covered(r: Receiver, f: Footprint) -> bool {
    let middle = vec2<i32>(floor(f.at.xy));
    let half = 0.5 * (f.high - f.low);
    let limit = -bias_of(r);
    let sure = limit - depth_noise();
    var one = false;
    var nine = all(f.first == f.last) && all(middle == f.first);
    for (var y = -RADIUS; y <= RADIUS; y++) {
        for (var x = -RADIUS; x <= RADIUS; x++) {
            let texel = middle + vec2(x, y);
            let s = sheet_at(texel);
            let there = 0.5 * (f.low + f.high) - middle_of(texel);
            let around = receiver_around(r, f.at, middle_of(texel));
            let gap = s.depth - around;
            let most = dot(gap, vec3(there, 1.0)) + dot(abs(gap.xy), half) + dot(s.doubt, vec3(abs(there) + half, 1.0)) + step_doubt(gap.xy);
            // The edges' normals have |x| + |y| = 1: the box's larger half side is more than enough.
            one = one || (s.held && inside_by(s, there) >= max(half.x, half.y) && most < limit);
            let before = most < sure && before_by_plane(s, around, r.far, sure) == BEFORE;
            nine = nine && (before || max(abs(x), abs(y)) > 1);
        }
    }
    return one || nine;
}
