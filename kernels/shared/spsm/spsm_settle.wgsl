// Tests of a pixel's whole footprint by the closest triangles.

//@import receiver spsm_record spsm_sheet spsm_border spsm_footprint
//@needs override RADIUS: i32;
//@needs override MANY: u32;

// Whether a closest triangle may lie before the receiver in a texel of the footprint: by its plane, or by its
// outline.
fn any_before(r: Receiver, f: Footprint, outlined: bool) -> bool {
    var found = false;
    var texel = f.first;
    loop {
        let s = sheet_at(texel);
        if outlined {
            found = found || before(s, r, f.at, middle_of(texel));
        } else {
            found = found || before_by_plane(s, receiver_around(r, f.at, middle_of(texel)), r.far,
                -bias_of(r)) != BEHIND;
        }
        if MANY == 0u { break; }
        texel.x += 1;
        if texel.x > f.last.x { texel = vec2(f.first.x, texel.y + 1); }
        if texel.y > f.last.y { break; }
    }
    return found;
}

// How the triangle of a texel stands to the footprint: COVERS_ONE where it covers all of it, COVERS_TEXEL
// where by its plane it lies before the receiver in all of the texel.
const COVERS_ONE = 1u;
const COVERS_TEXEL = 2u;

fn covers_as(r: Receiver, f: Footprint, texel: vec2<i32>) -> u32 {
    let half = 0.5 * (f.high - f.low);
    let limit = -bias_of(r);
    let sure = limit - depth_noise();
    let s = sheet_at(texel);
    let there = 0.5 * (f.low + f.high) - middle_of(texel);
    let around = receiver_around(r, f.at, middle_of(texel));
    let gap = s.depth - around;
    let most = dot(gap, vec3(there, 1.0)) + dot(abs(gap.xy), half)
        + dot(s.doubt, vec3(abs(there) + half, 1.0)) + step_doubt(gap.xy);
    // The edges' normals have |x| + |y| = 1: the box's larger half side is more than enough.
    let one = s.held && inside_by(s, there) >= max(half.x, half.y) && most < limit;
    let before = most < sure && before_by_plane(s, around, r.far, sure) == BEFORE;
    return select(0u, COVERS_ONE, one) | select(0u, COVERS_TEXEL, before);
}

// Whether the triangle of the pixel's own texel covers the footprint.
fn covered_by_own(r: Receiver, f: Footprint) -> bool {
    return (covers_as(r, f, texel_of(f.at)) & COVERS_ONE) != 0u;
}

// Whether one triangle around covers the footprint, or with `by_all` all in and around the texels of the
// footprint lie before it by their planes: then every pattern of depth tests there is the covered one. Of a
// footprint whose middle is outside the texels it was held to, the first alone is asked, so that no loop goes
// from the one to the other.
fn covered(r: Receiver, f: Footprint, by_all: bool) -> bool {
    let middle = texel_of(f.at);
    let held = all(middle >= f.first) && all(middle <= f.last);
    let low = select(middle - RADIUS, min(f.first - 1, middle - RADIUS), held);
    let high = select(middle + RADIUS, max(f.last + 1, middle + RADIUS), held);
    var one = false;
    var all_before = held && by_all;
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            let texel = vec2(x, y);
            let found = covers_as(r, f, texel);
            let near = all(abs(texel - middle) <= vec2(RADIUS));
            one = one || (near && (found & COVERS_ONE) != 0u);
            let beside = any(texel < f.first - 1) || any(texel > f.last + 1);
            all_before = all_before && (beside || (found & COVERS_TEXEL) != 0u);
        }
    }
    return one || all_before;
}
