// smsr: shadows by depth comparison with a light-view map of nearest depths, whose staircase borders are drawn anew as straight
// lines (Bondarev 2014, Shadow Map Silhouette Revectorization).
// A texel of the map is dark where its depth lies before the receiver's plane at its centre, less the bias: BIAS_CONSTANT, and
// BIAS_SLOPE times the steeper of the receiver's two slopes for each texel away from the pixel, as surfaces bend.
// Where a sample's texel and the one beside it differ, the border between them is followed along the texels to either side, REACH at
// most, to where it ends: turning to the sample's side (also where it turns both ways), away from it, or not within reach. From
// where it ends follows a line in the sample's texel; a sample between border and line takes the answer from beyond the border.
// With MIDPOINTS the line goes through the middles of the steps (Jimenez et al. 2011: patterns Z, U and L), on both sides of the
// border. Else as Bondarev has it: from the corners of the dark texels to the far end of the border, or its middle where both ends
// are corners, so that shadows only grow; of two borders on opposite sides of a texel each has half of it.
// A pixel around which all texels are alike, as far as lines reach, is settled by them; only the others look at samples.
// The borders are followed in the light view on the receiver's plane, not on the screen: what hides a part of the receiver, or
// the image's edge, cuts none off.
// Writes `visibility`: the mean over the samples whose rays meet the receiver.
// Bounds: 64 texels around a pixel; of each sample two long borders at most, twice REACH turns each: 2 x 2 x 64 x 128 samples.

//@import frame
//@import dispatch
//@import facing
//@import receiver

override REACH: u32 = 16u;
override MIDPOINTS: u32 = 1u;
override BIAS_CONSTANT: f32 = 0.00005;
override BIAS_SLOPE: f32 = 0.5;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibility: array<f32>;

// The receiver's plane over the texels: depth per texel to the right and down, and less the bias at the place of the first sample
// that meets it.
struct Plane {
    slope: vec2<f32>,
    place: vec2<f32>,
    depth: f32,
}

// Whether something lies before the plane in a texel; nothing does beyond the map.
fn is_dark(plane: Plane, texel: vec2<i32>) -> bool {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return false; }
    let key = nearest_keys[u32(texel.y * side + texel.x)];
    let away = middle_of(texel) - plane.place;
    let bend = BIAS_SLOPE * max(abs(plane.slope.x), abs(plane.slope.y)) * max(abs(away.x), abs(away.y));
    return key != 0u && bitcast<f32>(~key) < plane.depth + dot(plane.slope, away) - bend;
}

// The line that is drawn beside a border of a texel: `first` is where the border begins along the texels and `length` how long it
// is, 0 for none. `ends` is how far from the border the line runs at its beginning and at its end, in texels.
struct Line {
    first: f32,
    length: f32,
    ends: vec2<f32>,
}

// Follows the border of `texel`, whose state is `own`, towards the texel at `across`, whose state is the other.
fn line_of(plane: Plane, texel: vec2<i32>, across: vec2<i32>, own: bool, opposite: bool) -> Line {
    let along = abs(across.yx);
    // To either side: how far it goes on, and how it ends.
    var steps = vec2(f32(REACH));
    var ends = vec2(0.0);
    for (var side = 0u; side < 2u; side++) {
        let step = select(along, -along, side == 0u);
        var at = texel;
        for (var k = 0u; k < REACH; k++) {
            at += step;
            let turns_here = is_dark(plane, at) != own;
            let turns_away = is_dark(plane, at + across) == own;
            if turns_here || turns_away {
                let end = select(-0.5, 0.5, turns_here);
                if side == 0u { steps.x = f32(k); ends.x = end; } else { steps.y = f32(k); ends.y = end; }
                break;
            }
        }
    }
    var line: Line;
    line.first = f32(dot(texel, along)) - steps.x;
    line.length = steps.x + steps.y + 1.0;
    line.ends = ends;
    if MIDPOINTS == 0u {
        let height = select(1.0, 0.5, opposite);
        line.ends = select(vec2(0.0), vec2(height), ends > vec2(0.0));
    }
    return line;
}

// How far from its border a line runs at a place along it. Beyond the map, where places are held, nothing is between.
fn height_at(line: Line, along: f32) -> f32 {
    if line.length == 0.0 { return -3.0e38; }
    let t = (along - line.first) / line.length;
    if MIDPOINTS == 0u && min(line.ends.x, line.ends.y) == 0.0 { return mix(line.ends.x, line.ends.y, t); }
    let part = 2.0 * t - 1.0;
    return select(line.ends.x, line.ends.y, part > 0.0) * abs(part);
}

const DARK = 0u;
const LIT = 1u;
const SEVERAL = 2u;
const MOST_TEXELS = 64;

// What all texels of a box are, if there are few and they are alike: then no sample between them lies at a border.
fn state_around(plane: Plane, low: vec2<f32>, high: vec2<f32>, whole: bool) -> u32 {
    // Beyond the map all texels are alike: one will do.
    let size = vec2(f32(frame.map_size));
    let first = vec2<i32>(floor(clamp(low, vec2(-1.0), size)));
    let count = vec2<i32>(floor(clamp(high, vec2(-1.0), size))) - first + 1;
    var left = count.x * count.y;
    if !whole || left > MOST_TEXELS { return SEVERAL; }
    let dark = is_dark(plane, first);
    var at = first;
    loop {
        if is_dark(plane, at) != dark { return SEVERAL; }
        left -= 1;
        if left <= 0 { break; }
        at.x += 1;
        if at.x >= first.x + count.x { at = vec2(first.x, at.y + 1); }
    }
    return select(LIT, DARK, dark);
}

// The lit share of the samples that meet the receiver.
fn lit_share(r: Receiver, plane: Plane, pixel: u32) -> f32 {
    var sum = 0.0;
    var seen = 0.0;
    // What the texel of the sample before is; samples that follow each other often share one.
    var texel = vec2(-100);
    var dark = false;
    var left: Line;
    var right: Line;
    var above: Line;
    var below: Line;
    for (var k = 0u; k < frame.sample_count; k++) {
        let at = sample_place(r, pixel, k);
        let here = texel_of(at);
        // A loop that ends at once: vector machines run a branch whether a lane takes it or not.
        for (var another = at.w != 0.0 && any(here != texel); another; another = false) {
            texel = here;
            dark = is_dark(plane, texel);
            let differs = vec4(
                is_dark(plane, texel - vec2(1, 0)) != dark, is_dark(plane, texel + vec2(1, 0)) != dark,
                is_dark(plane, texel - vec2(0, 1)) != dark, is_dark(plane, texel + vec2(0, 1)) != dark);
            left = Line();
            right = Line();
            above = Line();
            below = Line();
            let bits = select(vec4(0u), vec4(1u, 2u, 4u, 8u), differs);
            var borders = bits.x | bits.y | bits.z | bits.w;
            // Corners are those of dark texels.
            if MIDPOINTS == 0u && dark { borders = 0u; }
            for (var rest = borders; rest != 0u; rest &= rest - 1u) {
                let side = firstTrailingBit(rest);
                let sign = select(-1, 1, (side & 1u) != 0u);
                let across = select(vec2(sign, 0), vec2(0, sign), side >= 2u);
                let opposite = ((borders >> (side ^ 1u)) & 1u) != 0u;
                let line = line_of(plane, texel, across, dark, opposite);
                if side == 0u { left = line; }
                if side == 1u { right = line; }
                if side == 2u { above = line; }
                if side == 3u { below = line; }
            }
        }
        if at.w == 0.0 { continue; }
        let inside = at.xy - vec2<f32>(texel);
        let beyond = inside.x < height_at(left, at.y) || 1.0 - inside.x < height_at(right, at.y)
            || inside.y < height_at(above, at.x) || 1.0 - inside.y < height_at(below, at.x);
        seen += 1.0;
        sum += select(0.0, 1.0, dark == beyond);
    }
    return select(sum / seen, 1.0, seen == 0.0);
}

@compute @workgroup_size(WORKGROUP)
fn revectorize(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN {
        visibility[pixel] = select(0.0, 1.0, r.seen == SEEN_NONE);
        return;
    }
    var met = sample_place(r, pixel, 0u);
    for (var k = 1u; met.w == 0.0 && k < frame.sample_count; k++) { met = sample_place(r, pixel, k); }
    let plane = Plane(r.slope, met.xy, met.z - BIAS_CONSTANT);
    let corners = array(
        place_of(r, ray_at(pixel, vec2(-0.5))), place_of(r, ray_at(pixel, vec2(0.5, -0.5))),
        place_of(r, ray_at(pixel, vec2(0.5))), place_of(r, ray_at(pixel, vec2(-0.5, 0.5))));
    let whole = met.w * corners[0].w * corners[1].w * corners[2].w * corners[3].w != 0.0;
    // A line is no farther from its border than this.
    let reach = select(1.0, 0.5, MIDPOINTS != 0u);
    let low = min(min(corners[0].xy, corners[1].xy), min(corners[2].xy, corners[3].xy)) - reach;
    let high = max(max(corners[0].xy, corners[1].xy), max(corners[2].xy, corners[3].xy)) + reach;
    let one = state_around(plane, low, high, whole);
    var share = select(0.0, 1.0, one == LIT);
    for (var several = one == SEVERAL; several; several = false) { share = lit_share(r, plane, pixel); }
    visibility[pixel] = share;
}
