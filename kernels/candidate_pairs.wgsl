// candidate_pairs: lists the (facet, triangle) pairs that are worth evaluating.
// One invocation a pixel-texel pair walks the triangles of its place, ROUND_LENGTH of them in round `step`,
// and keeps those that touch the facet's outline in the light view and rise over the facet's plane there.
// Both tests are conservative by the frame's margins: what they drop casts nothing on the facet, nor cuts it
// within its pixel. Of a tile the word before the triangle tells first whether it may touch what the facet
// has of the tile, and lie before it. A triangle that covers the whole outline and lies wholly before the
// facet settles it: its occluded mask is filled and the walk ends. Writes `candidates` (facet, triangle),
// never beyond the capacity, and counts into its `tally`; their order is not defined. A pair that shares
// several places is met in each. `seen` remembers what was met lately: a slot holds one pair, which slot and
// content together name without doubt, so what is left out was tested, and what was forgotten is tested
// again.

//@import frame dispatch pass facet facet_outline facet_quad facing candidates rect places tile_cells divide

override WORDS: u32 = 1u;
override ALONE: u32 = 1u;  // 0: of no facet all samples lie on its own triangle
override ROUND_LENGTH: u32 = 4096u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(2) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> triangle_offsets: array<u32>;
@group(0) @binding(4) var<storage, read> pair_triangles: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec4<u32>>;  // w: 1 of a closed body, more: tested
@group(0) @binding(6) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> candidates: Candidates;
@group(0) @binding(8) var<storage, read_write> masks: array<atomic<u32>>;
@group(0) @binding(9) var<uniform> step: Pass;

//@import frame_copy

//@import caster_effect

var<workgroup> wg_tests: atomic<u32>;

const SEEN_BITS = 16u;  // SEEN = 1 << SEEN_BITS
const KNOWN = 0x80000000u;

// Whether the pair was met before, as far as `seen` remembers; it does from now on. A facet of 25 bits and
// the high bits of a triangle of 22 fill a slot; the low bits of the triangle, and they, choose it.
fn was_met(f: u32, t: u32) -> bool {
    if (f >= (1u << 25u)) | (t >= (1u << (SEEN_BITS + 6u))) { return false; }
    let content = KNOWN | f | ((t >> SEEN_BITS) << 25u);
    let slot = (t ^ ((content * 2654435769u) >> (32u - SEEN_BITS))) & (SEEN - 1u);
    return atomicExchange(&candidates.seen[slot], content) == content;
}

fn triangle_at(n: u32) -> u32 {
    if TILE_SHIFT == 0u { return pair_triangles[n]; }
    return pair_triangles[2u * n + 1u];
}

// Of the triangles from `first` to before `end`, which are not more than 32, those that may touch `cells` and
// lie before `depth`.
fn near(first: u32, end: u32, cells: u32, depth: u32) -> u32 {
    if TILE_SHIFT == 0u { return 0xffffffffu >> (32u - (end - first)); }
    var found = 0u;
    for (var n = first; n < end; n++) {
        let word = pair_triangles[2u * n];
        found |= select(0u, 1u << (n - first), ((word & cells) != 0u) & ((word >> 16u) <= depth));
    }
    return found;
}

// Of the triangles behind `first` that `asked` has a bit for, those that the facet did not meet before.
fn unmet(f: u32, own: u32, first: u32, asked: u32) -> u32 {
    var found = 0u;
    for (var left = asked; left != 0u; left &= left - 1u) {
        let t = triangle_at(first + firstTrailingBit(left));
        found |= select(left & (0u - left), 0u, t == own || was_met(f, t));
    }
    return found;
}

fn walk(pair: vec2<u32>) -> u32 {
    let f = pair.x;
    var place = pair.y;
    if TILE_SHIFT != 0u { place = pair.y >> 4u; }
    let list = triangle_offsets[place];
    let list_end = min(triangle_offsets[place + 1u], frame.triangle_texel_capacity);
    // Longer lists are told of: another round may soon be needed.
    let length = max(list_end, list) - list;
    if length > ROUND_LENGTH / 8u * 7u { atomicMax(&candidates.tally[TALLY_LONGEST], length); }
    let first = list + step.index * ROUND_LENGTH;
    let end = min(list_end, first + ROUND_LENGTH);
    if first >= end { return 0u; }
    let own = undecided[f].triangle;
    let around = own_of(f, own);
    let low = undecided[f].box_low;
    let high = undecided[f].box_high;
    let middle = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let slope = undecided[f].slope;
    let farthest = undecided[f].farthest;
    var cells = 0u;
    if TILE_SHIFT != 0u {
        cells = texel_cells(pair.y & 15u)
            & box_cells(divided(place, places_across()).yx, 0.5 * low, 0.5 * high);
    }
    let quad = quad_of(f);
    if TILE_SHIFT != 0u { cells &= quad_cells(quad, divided(place, places_across()).yx); }
    let depth = depth_code(farthest + frame.depth_margin);
    // One loop a question, each over what the ones before left: vector machines pay for code that no lane
    // takes. What costs less comes first: of texels most pairs are new, of tiles most are not.
    for (var batch = first; batch < end; batch += 32u) {
        var left = near(batch, min(end, batch + 32u), cells, depth);
        if TILE_SHIFT != 0u { left = unmet(f, own, batch, left); }
        var kept = 0u;
        var covered = false;
        for (; left != 0u; left &= left - 1u) {
            let t = triangle_at(batch + firstTrailingBit(left));
            let e = effect(t, around, middle, half, quad, slope, farthest);
            kept |= select(0u, left & (0u - left), (e == MATTERS) & (t != own));
            covered = covered | ((e == COVERS) & (t != own));
        }
        if covered {
            // Every sample is occluded, whatever else there is.
            for (var w = 0u; w < WORDS; w++) { atomicOr(&masks[3u * WORDS * f + WORDS + w], 0xffffffffu); }
            return end - first;
        }
        if TILE_SHIFT == 0u { kept = unmet(f, own, batch, kept); }
        if kept == 0u { continue; }
        var at = atomicAdd(&candidates.tally[TALLY_CANDIDATES], countOneBits(kept));
        // No list is so long. Not to begin anew at 0.
        if at >= 0x80000000u { atomicStore(&candidates.tally[TALLY_CANDIDATES], 0x80000000u); }
        for (; kept != 0u; kept &= kept - 1u) {
            if at < frame.candidate_capacity {
                candidates.list[at] = vec2(f, triangle_at(batch + firstTrailingBit(kept)));
            }
            at += 1u;
        }
    }
    return end - first;
}

@compute @workgroup_size(WORKGROUP)
fn cull(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let k = flat_invocation(group, groups, WORKGROUP, local);
    var tests = 0u;
    if k < min(atomicLoad(&candidates.tally[TALLY_PAIRS]), frame.pixel_texel_capacity) {
        tests = walk(pairs[k]);
    }
    atomicAdd(&wg_tests, tests);
    workgroupBarrier();
    if local == 0u {
        let sum = atomicLoad(&wg_tests);
        let before = atomicAdd(&candidates.tally[TALLY_TESTS], sum);
        if before + sum < before { atomicAdd(&candidates.tally[TALLY_TESTS + 1u], 1u); }
    }
}
