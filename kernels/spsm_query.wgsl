// spsm_query: shadows from the sub-pixel shadow map (Lecocq 2013, sections 4 and 5).
// `classify` settles most pixels: nothing seen, dark, LIT where by its plane no closest triangle lies before
// the receiver in any texel that the pixel's footprint touches, SHADOWED where the triangle of the pixel's
// own texel covers it. `settle` takes the list of the others: LIT where none lies before it by what of it is
// in the texel; SHADOWED where one triangle around covers the footprint, or all in and around its texels lie
// before it by their planes. What is left is UNCERTAIN. `paint` writes what the classes say. `recover` takes
// the list of the uncertain, from behind the bits of `seen`: for every texel that samples of the pixel fall
// in, the triangles around it are tested (algorithm 1), the border's tangents looked up by the pattern of
// depth tests (figures 7, 8), and what the triangles do not cover is judged by the piecewise linear border
// that links their outer edges (figure 10), all samples from one reconstruction. Writes `visibility` and
// `lit` (WORDS words a pixel). Several dispatches, not one with early ends: lanes of a vector that are done
// wait for those that are not.
//@bindings Texels: classify, settle, paint, recover

//@import frame dispatch facing spsm_record spsm_sheet receiver spsm_border spsm_search spsm_footprint
//@import spsm_settle seen_texels spsm_recovery

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
override WORDS: u32 = 1u;
override MANY: u32 = 1u;      // 0: one sample a pixel, at its centre
override RADIUS: i32 = 1;     // texels searched around a sample's own
override STRETCH: i32 = 0;    // and beyond these along the border's tangents, to either side
override RECOVERY: u32 = 1u;  // 0: what no triangle around covers is lit (figure 2, middle)
override BIAS: f32 = 1e-5;
override SQUARE: i32 = 2 * RADIUS + 1;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;   // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
// Directions towards the light, their number, kept, covered
@group(0) @binding(3) var<uniform> patterns: array<vec4<u32>, 512>;
@group(0) @binding(4) var<storage, read> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> upper_records: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> lower_records: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(10) var<storage, read_write> lit: array<u32>;
// Of each pixel whether it is uncertain; then its class
@group(0) @binding(11) var<storage, read_write> marks: array<u32>;
// As many as pixels, then how many there are
@group(0) @binding(12) var<storage, read> kept: array<u32>;
@group(0) @binding(13) var<storage, read_write> seen: array<atomic<u32>>;

fn pixel_count() -> u32 { return frame.image_size.x * frame.image_size.y; }

// Says if a texel was read that was not asked for, and so is not made: the frame has to run again with all of
// them.
fn tell_missed() {
    if missed { atomicStore(&seen[SEEN_MISSED], 1u); }
}

fn note(pixel: u32, kind: u32, listed: u32) {
    marks[pixel_count() + pixel] = kind;
    marks[listed] = select(0u, 1u, kind == CLASS_UNCERTAIN);
}

@compute @workgroup_size(WORKGROUP)
fn classify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= pixel_count() { return; }
    let r = receiver_of(pixel);
    let f = footprint_of(r, pixel);
    var kind = select(CLASS_LIT, CLASS_UNCERTAIN, any_before(r, f, false));
    if kind == CLASS_UNCERTAIN && covered_by_own(r, f) { kind = CLASS_SHADOWED; }
    if f.class_known != CLASS_EMPTY { kind = f.class_known; }
    if r.seen != SEEN_OPEN { kind = select(CLASS_DARK, CLASS_EMPTY, r.seen == SEEN_NONE); }
    // Where all is known, what was read is not used.
    missed = missed && r.seen == SEEN_OPEN && f.class_known == CLASS_EMPTY;
    tell_missed();
    note(pixel, kind, pixel);
}

@compute @workgroup_size(WORKGROUP)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= min(kept[pixel_count()], pixel_count()) { return; }
    let pixel = kept[item];
    let r = receiver_of(pixel);
    let f = footprint_of(r, pixel);
    let open = !any_before(r, f, true);
    let missed_own = missed;
    var kind = select(CLASS_UNCERTAIN, CLASS_SHADOWED, covered(r, f, RECOVERY == 1u));
    if open {
        kind = CLASS_LIT;
        missed = missed_own;
    }
    if f.class_known != CLASS_EMPTY { kind = f.class_known; }
    missed = missed && f.class_known == CLASS_EMPTY;
    tell_missed();
    note(pixel, kind, item);
}

@compute @workgroup_size(WORKGROUP)
fn paint(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= pixel_count() { return; }
    let kind = marks[pixel_count() + pixel];
    let open = kind == CLASS_EMPTY || kind == CLASS_LIT;
    visibility[pixel] = select(0.0, 1.0, open);
    for (var w = 0u; w < WORDS; w++) { lit[WORDS * pixel + w] = select(0u, 0xffffffffu, open); }
}

@compute @workgroup_size(WORKGROUP)
fn recover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    let list = SEEN_BITS + 2u * seen_words();
    if item >= min(atomicLoad(&seen[list + pixel_count()]), pixel_count()) { return; }
    let pixel = atomicLoad(&seen[list + item]);
    let r = receiver_of(pixel);
    var open = vec4(0u);    // samples still to be judged: those whose rays meet the plane
    var around: Around;
    around.middle = place_of(r, pixel_ray(pixel));
    for (var k = 0u; k < frame.sample_count; k++) {
        let bit = 1u << (k & 31u);
        let ray = sample_ray(pixel, k);
        if place_of(r, ray).w != 0.0 { open[k >> 5u] |= bit; }
        if meets_triangle(r, ray) { around.own[k >> 5u] |= bit; }
    }
    let counted = open;
    var dark = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        while open[w] != 0u {
            let first = 32u * w + firstTrailingBit(open[w]);
            let at = sample_place(r, pixel, first);
            let texel = texel_of(at);
            var here = vec4(0u);
            for (var v = w; v < WORDS; v++) {
                for (var left = open[v]; left != 0u; left &= left - 1u) {
                    let other = texel_of(sample_place(r, pixel, 32u * v + firstTrailingBit(left)));
                    here[v] |= select(0u, left & (0u - left), all(other == texel));
                }
            }
            open &= ~here;
            dark |= shadowed_of(r, pixel, texel, at, first, here, around);
        }
    }
    tell_missed();
    let judged = countOneBits(counted);
    let bright = countOneBits(counted & ~dark);
    let all_seen = judged.x + judged.y + judged.z + judged.w;
    let share = f32(bright.x + bright.y + bright.z + bright.w) / f32(all_seen);
    visibility[pixel] = select(share, 1.0, all_seen == 0u);
    for (var w = 0u; w < WORDS; w++) { lit[WORDS * pixel + w] = counted[w] & ~dark[w]; }
}
