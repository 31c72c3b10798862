// spsm_query: shadows from the sub-pixel shadow map (Lecocq 2013, sections 4 and 5).
// `classify` settles pixels: nothing seen, dark; LIT where in no texel that the pixel's footprint touches the closest triangle
// lies before the receiver; SHADOWED where one triangle around covers the footprint. The others are UNCERTAIN and flagged.
// `recover` takes the list of those: for every texel that samples of the pixel fall in, the triangles around it are tested
// (algorithm 1), the border's tangents looked up by the pattern of depth tests (figures 7, 8), and what the triangles do not
// cover is judged by the piecewise linear border that links their outer edges (figure 10), all samples from one
// reconstruction. Writes `visibility` and `lit` (WORDS words a pixel).

//@import frame
//@import dispatch
//@import facing
//@import spsm_record
//@import spsm_sheet
//@import receiver
//@import spsm_border
//@import spsm_search

override ENCODING: u32 = 1u;
override WORDS: u32 = 1u;
override RADIUS: i32 = 1;     // texels searched around a sample's own
override STRETCH: i32 = 0;    // and beyond these along the border's tangents, to either side
override BIAS: f32 = 1e-5;
override SQUARE: i32 = 2 * RADIUS + 1;
const WORKGROUP = 64u;
const CLASS_EMPTY = 0u;
const CLASS_DARK = 1u;
const CLASS_LIT = 2u;
const CLASS_SHADOWED = 3u;
const CLASS_UNCERTAIN = 4u;
const MOST_TEXELS = 25.0;     // of a footprint that is settled as a whole

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;   // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(3) var<uniform> patterns: array<vec4<u32>, 512>; // directions towards the light, their number, kept, covered
@group(0) @binding(4) var<storage, read> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> upper_records: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> lower_records: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(10) var<storage, read_write> lit: array<u32>;
@group(0) @binding(11) var<storage, read_write> marks: array<u32>;  // of each pixel whether it is uncertain; then its class
@group(0) @binding(12) var<storage, read> kept: array<u32>;         // as many as pixels, then how many there are

fn pixel_count() -> u32 { return frame.image_size.x * frame.image_size.y; }

fn settle(pixel: u32, kind: u32) {
    marks[pixel_count() + pixel] = kind;
    marks[pixel] = select(0u, 1u, kind == CLASS_UNCERTAIN);
    let open = kind == CLASS_EMPTY || kind == CLASS_LIT;
    visibility[pixel] = select(0.0, 1.0, open);
    for (var w = 0u; w < WORDS; w++) { lit[WORDS * pixel + w] = select(0u, 0xffffffffu, open); }
}

fn class_of(pixel: u32) -> u32 {
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN { return select(CLASS_DARK, CLASS_EMPTY, r.seen == SEEN_NONE); }
    let at = place_of(r, ray_of(pixel, vec2(0.0)));
    if at.w == 0.0 { return CLASS_LIT; }
    var low = at.xy;
    var high = at.xy;
    if frame.sample_count > 1u {
        for (var k = 0u; k < 4u; k++) {
            let corner = place_of(r, ray_of(pixel, vec2(select(-0.5, 0.5, (k & 1u) == 1u), select(-0.5, 0.5, k >= 2u))));
            if corner.w == 0.0 { return CLASS_UNCERTAIN; }
            low = min(low, corner.xy);
            high = max(high, corner.xy);
        }
    }
    let side = f32(frame.map_size);
    if any(high < vec2(0.0)) || any(low >= vec2(side)) { return CLASS_LIT; }
    let first = vec2<i32>(clamp(floor(low), vec2(0.0), vec2(side - 1.0)));
    let last = vec2<i32>(clamp(floor(high), vec2(0.0), vec2(side - 1.0)));
    let extent = vec2<f32>(last - first + 1);
    if extent.x * extent.y > MOST_TEXELS { return CLASS_UNCERTAIN; }
    var free = true;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            free = free && !before(sheet_at(vec2(x, y)), r, at, middle_of(vec2(x, y)));
        }
    }
    if free { return CLASS_LIT; }
    let middle = vec2<i32>(floor(at.xy));
    let half = 0.5 * (high - low);
    for (var y = -RADIUS; y <= RADIUS; y++) {
        for (var x = -RADIUS; x <= RADIUS; x++) {
            let texel = middle + vec2(x, y);
            let s = sheet_at(texel);
            let there = 0.5 * (low + high) - middle_of(texel);
            let gap = s.depth - receiver_around(r, at, middle_of(texel));
            let most = dot(gap, vec3(there, 1.0)) + dot(abs(gap.xy), half) + dot(s.doubt, vec3(abs(there) + half, 1.0)) + step_doubt(gap.xy);
            // The edges' normals have |x| + |y| = 1: the box's larger half side is more than enough.
            if s.held && inside_by(s, there) >= max(half.x, half.y) && most < -bias_of(r) { return CLASS_SHADOWED; }
        }
    }
    return CLASS_UNCERTAIN;
}

@compute @workgroup_size(WORKGROUP)
fn classify(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= pixel_count() { return; }
    settle(pixel, class_of(pixel));
}

// Samples of `group`, all in one texel, that are in shadow.
fn shadowed_of(r: Receiver, pixel: u32, texel: vec2<i32>, at: vec4<f32>, group: vec4<u32>) -> vec4<u32> {
    if !before_place(sheet_at(texel), r, at, middle_of(texel)) { return vec4(0u); }
    var mask = 16u;     // the texel itself
    for (var n = 0; n < 8; n++) {
        let k = n + select(0, 1, n >= 4);
        let here = texel + vec2(k % 3 - 1, k / 3 - 1);
        if before_place(sheet_at(here), r, at, middle_of(here)) { mask |= 1u << u32(k); }
    }
    let pattern = patterns[mask];
    var dark = vec4(0u);
    let centre = middle_of(texel);
    piece_count = 0u;
    let all = SQUARE * SQUARE + 2 * STRETCH * i32(pattern.y);
    for (var k = 0; k < all; k++) {
        let step = step_of(k, pattern);
        let here = texel + step;
        let s = sheet_at(here);
        if !s.held { continue; }
        for (var w = 0u; w < WORDS; w++) {
            for (var left = group[w] & ~dark[w]; left != 0u; left &= left - 1u) {
                let place = sample_place(r, pixel, 32u * w + firstTrailingBit(left));
                let hit = shadows(s, vec3(place.xy - middle_of(here), place.z), r);
                dark[w] |= select(0u, left & (0u - left), hit);
            }
        }
        // Along the tangents triangles are only tested: linking their edges too makes the border too wide.
        if k >= SQUARE * SQUARE { continue; }
        let inner = max(abs(step.x), abs(step.y)) <= 1;
        if inner && (pattern.z & (1u << u32(max(3 * step.y + step.x + 4, 0)))) == 0u { continue; }
        if RADIUS > 1 && !inner && !before_place(s, r, at, middle_of(here)) { continue; }
        let offset = middle_of(here) - centre;
        let gap = s.depth - receiver_around(r, at, middle_of(here));
        for (var e = 0u; e < 3u; e++) {
            let piece = piece_of(s, e, -offset, 1.5);
            // An edge behind the receiver throws no shadow on it.
            let nearer = dot(gap, vec3(0.5 * (piece.start + piece.end), 1.0)) < 0.0;
            if piece.some && nearer {
                pieces[piece_count] = vec4(piece.start + offset, piece.end + offset);
                piece_count++;
            }
        }
    }
    if pattern.w == 1u { return group; }
    if pattern.y == 0u { return dark; }
    for (var w = 0u; w < WORDS; w++) {
        for (var left = group[w] & ~dark[w]; left != 0u; left &= left - 1u) {
            let place = sample_place(r, pixel, 32u * w + firstTrailingBit(left)).xy - centre;
            var open = false;
            for (var n = 0u; n < pattern.y; n++) {
                open = open || beyond_border(place, normalize(vec2<f32>(towards_lit(pattern, n))));
            }
            dark[w] |= select(left & (0u - left), 0u, open);
        }
    }
    return dark;
}

@compute @workgroup_size(WORKGROUP)
fn recover(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= min(kept[pixel_count()], pixel_count()) { return; }
    let pixel = kept[item];
    let r = receiver_of(pixel);
    var open = vec4(0u);    // samples still to be judged: those whose rays meet the plane
    for (var k = 0u; k < frame.sample_count; k++) {
        let bit = 1u << (k & 31u);
        if sample_place(r, pixel, k).w != 0.0 { open[k >> 5u] |= bit; }
    }
    let counted = open;
    var dark = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        while open[w] != 0u {
            let at = sample_place(r, pixel, 32u * w + firstTrailingBit(open[w]));
            let texel = texel_of(at);
            var here = vec4(0u);
            for (var v = w; v < WORDS; v++) {
                for (var left = open[v]; left != 0u; left &= left - 1u) {
                    let other = texel_of(sample_place(r, pixel, 32u * v + firstTrailingBit(left)));
                    here[v] |= select(0u, left & (0u - left), all(other == texel));
                }
            }
            open &= ~here;
            dark |= shadowed_of(r, pixel, texel, at, here);
        }
    }
    let seen = countOneBits(counted);
    let bright = countOneBits(counted & ~dark);
    let all_seen = seen.x + seen.y + seen.z + seen.w;
    let share = f32(bright.x + bright.y + bright.z + bright.w) / f32(all_seen);
    visibility[pixel] = select(share, 1.0, all_seen == 0u);
    for (var w = 0u; w < WORDS; w++) { lit[WORDS * pixel + w] = counted[w] & ~dark[w]; }
}
