// smsr: shadows by depth comparison with a light-view map of nearest depths, whose staircase borders are
// drawn anew as straight lines (Bondarev 2014, Shadow Map Silhouette Revectorization). A texel of the map is
// dark where its depth lies before the receiver's plane at its centre, less the bias: BIAS_CONSTANT, and
// BIAS_SLOPE times the steeper of the receiver's two slopes for each texel away from the pixel, as surfaces
// bend. Where a sample's texel and the one beside it differ, the border between them is followed along the
// texels to either side, REACH at most, to where it ends: turning to the sample's side (also where it turns
// both ways), away from it, or not within reach. From where it ends follows a line in the sample's texel; a
// sample between border and line takes the answer from beyond the border. With MIDPOINTS the line goes
// through the middles of the steps (Jimenez et al. 2011: patterns Z, U and L), on both sides of the border.
// Else as Bondarev has it: from the corners of the dark texels to the far end of the border, or its middle
// where both ends are corners, so that shadows only grow; of two borders on opposite sides of a texel each
// has half of it. A pixel around which all texels are alike, as far as lines reach, is settled by them; only
// the others look at samples. The borders are followed in the light view on the receiver's plane, not on the
// screen: what hides a part of the receiver, or the image's edge, cuts none off. Writes `visibility`: the
// mean over the samples whose rays meet the receiver. Bounds: 64 texels around a pixel; of each sample two
// long borders at most, twice REACH turns each: 2 x 2 x 64 x 128 samples.

//@import frame dispatch facing receiver

override REACH: u32 = 16u;
override MIDPOINTS: u32 = 1u;
override BIAS_CONSTANT: f32 = 0.00005;
override BIAS_SLOPE: f32 = 0.5;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibility: array<f32>;

//@import map_borders

const DARK = 0u;
const LIT = 1u;
const SEVERAL = 2u;
const MOST_TEXELS = 64;

// State of all texels of a box, if they are few and alike: then no sample between them lies at a border.
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
    // Texel of the sample before, and its state; samples that follow each other often share one.
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
fn revectorize(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
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
