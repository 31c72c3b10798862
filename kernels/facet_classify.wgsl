// facet_classify: makes the facets of a pixel list and settles all that need no evaluation (Pan 2009, section
// 3.3). `one` lists one facet a pixel, from the triangle at its centre, with a full coverage mask. `classify`
// finds for each listed facet its plane, its light-view outline and rectangle, and its state:
// DARK where its seen side faces away from the light, or light or eye are in its plane; decided with 46 bits
// where single
// precision leaves it open; with FLAG_CLOSED also where it is seen from inside the body, whose rest keeps the
// light off;
// LIT where no caster is in the rectangle, or where no texel of it is marked and the facet lies before the
// split depth;
//   SHADOWED where no texel of it is marked and it lies behind the split depth;
// UNDECIDED else: `facet_items` then holds the number of 8 x 8 blocks of its rectangle, 0 in all other
// states. Facets of triangles behind the casters' (only_receiver) are LIT too where they lie nearer to the
// light than any caster, and settled by the splits of all texels of a small rectangle. `begin` empties the
// list of unsure facets; `classify` puts those on it of whose triangle single precision does not tell which
// side light or eye are on, and `classify_unsure` classifies them with 46 bits: vector machines pay for code
// that no lane takes. A facet of what is no caster (FLAG_CULL_BACK) is never settled. There is no depth bias:
// the split depth was proved (front_layer) to lie between two sheets. A facet whose plane runs off towards
// the horizon inside the pixel keeps only the samples inside its own triangle. With FLAG_CLAMP all facets
// have only such samples, but for FLAG_BEYOND: their rectangles are cut to their triangles. A merged facet
// (STATE_MERGED) has samples of other triangles in its plane, and is followed as far as those reach. Of
// several views of the light all after the first have FLAG_FURTHER_VIEW: what a facet is in all of them is
// put together, its masks are kept, and its rectangle and what it is evaluated by are those of the view at
// hand.

//@import frame dispatch rect facet facing double_float vertex facing_46 front_split only_receiver summed_area

override WORDS: u32 = 1u;
override CLAMPED: u32 = 2u;    // 0: FLAG_CLAMP is never set, 1: always, 2: as the frame says
override RECEIVERS: u32 = 1u;  // 0: there are no triangles behind the casters'
const WORKGROUP = 64u;
const UNSURE_GROUPS = 64u;     // workgroups that go through the list of unsure facets

@group(0) @binding(0) var<uniform> frame_given: Frame;
// Two offsets from the pixel centre each
@group(0) @binding(1) var<uniform> samples_given: array<vec4<f32>, 64>;
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;  // w: 1 of a closed body, more: tested
@group(0) @binding(4) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(5) var<storage, read> sat: array<u32>;
@group(0) @binding(6) var<storage, read> splits: array<f32>;
@group(0) @binding(7) var<storage, read_write> facets: array<Facet>;
@group(0) @binding(11) var<storage, read_write> undecided: array<Undecided>;
// Coverage, occluded, invalid: WORDS words each
@group(0) @binding(8) var<storage, read_write> masks: array<u32>;
// Behind them how many are unsure, and which
@group(0) @binding(9) var<storage, read_write> facet_items: array<atomic<u32>>;
// First facet of each pixel, and the end
@group(0) @binding(10) var<storage, read_write> pixel_facets: array<u32>;

//@import frame_copy

//@import facet_place

@compute @workgroup_size(WORKGROUP)
fn one(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel > pixels { return; }
    pixel_facets[pixel] = pixel;
    if pixel == pixels { return; }
    facets[pixel] = Facet(pixel, ~id_keys[pixel], STATE_EMPTY, 0.0, vec2(0.0), vec2(0u));
    for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * pixel + w] = full_word(w); }
}

@compute @workgroup_size(1)
fn begin() {
    atomicStore(&facet_items[frame_given.facets_total], 0u);
}

// Clears the facet's masks in the first view; whether it has a surface.
fn begin_facet(f: u32) -> bool {
    if (frame.flags & FLAG_FURTHER_VIEW) == 0u {
        for (var w = WORDS; w < 3u * WORDS; w++) { masks[3u * WORDS * f + w] = 0u; }
    }
    let seen = facets[f].triangle != NO_TRIANGLE;
    if !seen {
        facets[f].state = STATE_EMPTY;
        atomicStore(&facet_items[f], 0u);
    }
    return seen;
}

fn classify_seen(f: u32) {
    let shape = shape_of(facets[f].triangle);
    let turns = turns_in_single(shape.a, shape.ab, shape.ac);
    if any(turns == vec2(0.0)) {
        let count = &facet_items[frame.facets_total];
        atomicStore(&facet_items[frame.facets_total + 1u + atomicAdd(count, 1u)], f);
        return;
    }
    place(f, shape, turns);
}

@compute @workgroup_size(WORKGROUP)
fn classify(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let f = flat_invocation(group, groups, WORKGROUP, local);
    if f >= frame.facets_total || !begin_facet(f) { return; }
    classify_seen(f);
}

@compute @workgroup_size(WORKGROUP)
fn classify_unsure(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let count = atomicLoad(&facet_items[frame.facets_total]);
    let stride = WORKGROUP * groups.x * groups.y;
    for (var k = flat_invocation(group, groups, WORKGROUP, local); k < count; k += stride) {
        let f = atomicLoad(&facet_items[frame.facets_total + 1u + k]);
        let shape = shape_of(facets[f].triangle);
        place(f, shape, turns_of(shape.i, shape.a, shape.ab, shape.ac));
    }
}
