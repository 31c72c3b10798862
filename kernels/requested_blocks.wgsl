// requested_blocks: which 8 x 8 blocks of the light's map the listed facets ask for, so that casters need be
// set up, and texels made, in no others (as pages of a map are requested: Lefohn 2007). Writes `requested`:
// word 0 is 0 where every block is, then a bit a block, in rows of whole words. `begin` follows a clear;
// `request` takes the blocks of the texels that each facet may touch, as if it covered all of its pixel:
// none of those that cannot be lit, nor of those that lie beyond the view or, of several views, are settled
// or held by one before. facet_classify finds these texels anew and may round otherwise: the margin is taken
// twice.

//@import frame dispatch rect facet facing double_float vertex facing_46 front_split only_receiver
//@import facet_extent

override CLAMPED: u32 = 2u;    // 0: FLAG_CLAMP is never set, 1: always, 2: as the frame says
override RECEIVERS: u32 = 1u;  // 0: there are no triangles behind the casters'
const WORKGROUP = 64u;
const REACH = 0.505;           // half a pixel, and more than any part of one reaches beyond
const MOST_WORDS = 1024u;      // words that one facet writes; one that asks for more asks for all

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;  // w: 1 of a closed body, more: tested
@group(0) @binding(2) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(3) var<storage, read> splits: array<f32>;
@group(0) @binding(4) var<storage, read_write> facets: array<Facet>;
@group(0) @binding(5) var<storage, read_write> requested: array<atomic<u32>>;

//@import frame_copy

@compute @workgroup_size(1)
fn begin() {
    atomicStore(&requested[0], 1u);
}

fn ask(rect: vec2<u32>) {
    if is_empty(rect) { return; }
    let texels = unpack_rect(rect);
    let low = texels.low >> vec2(BLOCK_SHIFT);
    let high = texels.high >> vec2(BLOCK_SHIFT);
    let first = low.x / 32u;
    let last = high.x / 32u;
    if (last - first + 1u) * (high.y - low.y + 1u) > MOST_WORDS {
        atomicStore(&requested[0], 0u);
        return;
    }
    for (var y = low.y; y <= high.y; y++) {
        for (var x = first; x <= last; x++) {
            var bits = 0xffffffffu;
            if x == first { bits &= 0xffffffffu << (low.x & 31u); }
            if x == last { bits &= 0xffffffffu >> (31u - (high.x & 31u)); }
            let word = 1u + y * block_words(frame.map_size) + x;
            if (atomicLoad(&requested[word]) & bits) != bits { atomicOr(&requested[word], bits); }
        }
    }
}

// The texels that a facet asks for.
fn texels_asked(f: u32) -> vec2<u32> {
    let facet = facets[f];
    if facet.triangle == NO_TRIANGLE { return EMPTY_RECT; }
    let further = (frame.flags & FLAG_FURTHER_VIEW) != 0u;
    if further && (facet.state & (WAS_SETTLED | WAS_HELD)) != 0u { return EMPTY_RECT; }
    let shape = shape_of(facet.triangle);
    var turns = turns_in_single(shape.a, shape.ab, shape.ac);
    // Few are unsure: a loop that the others do not enter.
    for (var unsure = any(turns == vec2(0.0)); unsure; unsure = false) {
        turns = turns_of(shape.i, shape.a, shape.ab, shape.ac);
    }
    let away = turns.x * select(1.0, -1.0, is_reversed(shape.given.xyz, shape.i)) < 0.0;
    if turns.x * turns.y <= 0.0 || (away && (frame.flags & FLAG_CLOSED) != 0u) { return EMPTY_RECT; }
    let part = vec4(-REACH, -REACH, REACH, REACH);
    let e = extent_of(f, part, shape, turns.x, is_merged(f));
    var margin = frame.map_margin;
    if RECEIVERS != 0u && only_receives(shape.triangle) {
        margin = margin_beyond(reach_beyond(facet.pixel, part, e.plane, e.limit));
    }
    let lit_outside = (frame.flags & FLAG_NO_VIEW) == 0u;
    if lies_beside(e.outline) && lit_outside { return EMPTY_RECT; }
    let rect = texels_of(e.outline, 2.0 * margin);
    return select(rect, vec2(0u), is_empty(rect) && !lit_outside);
}

@compute @workgroup_size(WORKGROUP)
fn request(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let f = flat_invocation(group, groups, WORKGROUP, local);
    if f >= frame.facets_total || atomicLoad(&requested[0]) == 0u { return; }
    ask(texels_asked(f));
}
