// candidate_pairs: lists the (facet, triangle) pairs that are worth evaluating.
// One invocation a pixel-texel pair walks the triangles of its place, ROUND_LENGTH of them from `round` on, and keeps those
// that touch the box of the facet's outline in the light view and rise over the facet's plane there. Both tests are
// conservative by the frame's margins: what they drop casts nothing on the facet, nor cuts it within its pixel. Of a tile the
// word before the triangle tells first whether it may touch what the facet has of the tile, and lie before it.
// A triangle that covers the whole box and lies wholly before the facet settles it: its occluded mask is filled and the
// walk ends.
// Writes `candidates` (facet, triangle), never beyond the capacity, and counts into its `tally`; their order is not defined.
// A pair that shares several places is met in each. `seen` remembers what was met lately: a slot holds one pair, which slot
// and content together name without doubt, so what is left out was tested, and what was forgotten is tested again.

//@import frame
//@import dispatch
//@import facet
//@import facing
//@import candidates
//@import rect
//@import places
//@import tile_cells
//@import divide

override WORDS: u32 = 1u;
const WORKGROUP = 64u;
const ROUND_LENGTH = 4096u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> facets: array<Facet>;
@group(0) @binding(2) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> triangle_offsets: array<u32>;
@group(0) @binding(4) var<storage, read> pair_triangles: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(6) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> candidates: Candidates;
@group(0) @binding(8) var<storage, read_write> masks: array<atomic<u32>>;

//@import frame_copy

var<workgroup> wg_tests: atomic<u32>;

const NOTHING = 0u;
const MATTERS = 1u;
const COVERS = 2u;

const SEEN_BITS = 16u;  // SEEN = 1 << SEEN_BITS
const KNOWN = 0x80000000u;

// Whether the pair was met before, as far as `seen` remembers; it does from now on. A facet of 25 bits and the high bits of a
// triangle of 22 fill a slot; the low bits of the triangle, and they, choose it.
fn was_met(f: u32, t: u32) -> bool {
    if (f >= (1u << 25u)) | (t >= (1u << (SEEN_BITS + 6u))) { return false; }
    let content = KNOWN | f | ((t >> SEEN_BITS) << 25u);
    let slot = (t ^ ((content * 2654435769u) >> (32u - SEEN_BITS))) & (SEEN - 1u);
    return atomicExchange(&candidates.seen[slot], content) == content;
}

// How far the box reaches beyond the line a-b (x: its outermost point, y: its innermost, both positive inside).
fn reach_of(a: vec2<f32>, b: vec2<f32>, turn: f32, middle: vec2<f32>, half: vec2<f32>) -> vec2<f32> {
    let n = turn * vec2(a.y - b.y, b.x - a.x);
    let at = dot(n, middle - a);
    let wide = dot(abs(n), half);
    return vec2(at - wide, at + wide);
}

// What is asked of a facet's own triangle: its vertices, and the sign of its area in the light view; 0 if the facet has samples
// elsewhere.
struct Own { i: vec3<u32>, turn: f32 }

fn own_of(f: u32, t: u32) -> Own {
    let given = triangles[t];
    // What faces the light runs around this way in the light view.
    let way = -sign(dot(cross(frame.map_u.xyz, frame.map_v.xyz), frame.map_z.xyz));
    let turn = way * sign(facets[f].doubt) * select(1.0, -1.0, is_reversed(given, rising(given)));
    return Own(given, select(0.0, turn, facets[f].tilt < 0.0));
}

// Whether two triangles run through an edge in opposite directions.
fn share_edge(i: vec3<u32>, j: vec3<u32>) -> bool {
    let one = (i == j.yzx) & (i.yzx == j);
    let two = (i == j.zxy) & (i.yzx == j.yzx);
    let three = (i == j) & (i.yzx == j.zxy);
    return any(one | two | three);
}

// What a triangle may do to a facet: nothing, something, or cover all of it. Of two triangles at an edge that face the light alike
// neither casts on the other.
fn effect(t: u32, own: Own, middle: vec2<f32>, half: vec2<f32>, slope: vec4<f32>, farthest: f32) -> u32 {
    let i = triangles[t];
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    let low = min(min(a.xy, b.xy), c.xy);
    let high = max(max(a.xy, b.xy), c.xy);
    let apart = any((low > middle + half) | (high < middle - half));
    let beyond = min(a.z, min(b.z, c.z)) > farthest + frame.depth_margin;
    let over = vec3(
        dot(slope.xyz, vec3(a.xy, 1.0)) - a.z, dot(slope.xyz, vec3(b.xy, 1.0)) - b.z, dot(slope.xyz, vec3(c.xy, 1.0)) - c.z);
    // Rounding grows with the distance at which the slope is followed.
    let reach = max(max(abs(low.x), abs(low.y)), max(abs(high.x), abs(high.y)));
    let noise = slope.w + 1e-6 * (abs(slope.x) + abs(slope.y)) * reach;
    let below = all(over < vec3(-noise));
    let ab = b.xy - a.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let size = max(abs(ab.x) + abs(ab.y), abs(ac.x) + abs(ac.y));
    let thin = abs(area) <= 4e-6 * (reach + size) * size;
    let turn = select(-1.0, 1.0, area > 0.0);
    let grown = half + 4e-6 * reach;
    let e0 = reach_of(a.xy, b.xy, turn, middle, grown);
    let e1 = reach_of(b.xy, c.xy, turn, middle, grown);
    let e2 = reach_of(c.xy, a.xy, turn, middle, grown);
    let beside = share_edge(own.i, i) & (turn * own.turn > 0.0) & !thin;
    let outside = (min(e0.y, min(e1.y, e2.y)) < 0.0) & !thin;
    let covers = (min(e0.x, min(e1.x, e2.x)) > 0.0) & !thin & all(over > vec3(noise)) & (noise < 1e30);
    let in_front = min(a.w, min(b.w, c.w)) > 0.0;
    let e = select(select(MATTERS, COVERS, covers), NOTHING, apart | beyond | below | outside | beside);
    return select(MATTERS, e, in_front);
}

fn triangle_at(n: u32) -> u32 {
    if TILE_SHIFT == 0u { return pair_triangles[n]; }
    return pair_triangles[2u * n + 1u];
}

// Of the triangles from `first` to before `end`, which are not more than 32, those that may touch `cells` and lie before `depth`.
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
    if list_end > list + ROUND_LENGTH { atomicMax(&candidates.tally[TALLY_LONGEST], list_end - list); }
    let first = list + frame.round * ROUND_LENGTH;
    let end = min(list_end, first + ROUND_LENGTH);
    if first >= end { return 0u; }
    let own = facets[f].triangle;
    let around = own_of(f, own);
    let low = facets[f].box_low;
    let high = facets[f].box_high;
    let middle = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let slope = facets[f].slope;
    let farthest = facets[f].farthest;
    var cells = 0u;
    if TILE_SHIFT != 0u {
        cells = texel_cells(pair.y & 15u) & box_cells(divided(place, places_across()).yx, 0.5 * low, 0.5 * high);
    }
    let depth = depth_code(farthest + frame.depth_margin);
    // One loop a question, each over what the ones before left: vector machines pay for code that no lane takes. What costs less
    // comes first: of texels most pairs are new, of tiles most are not.
    for (var batch = first; batch < end; batch += 32u) {
        var left = near(batch, min(end, batch + 32u), cells, depth);
        if TILE_SHIFT != 0u { left = unmet(f, own, batch, left); }
        var kept = 0u;
        var covered = false;
        for (; left != 0u; left &= left - 1u) {
            let t = triangle_at(batch + firstTrailingBit(left));
            let e = effect(t, around, middle, half, slope, farthest);
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
        for (; kept != 0u; kept &= kept - 1u) {
            if at < frame.candidate_capacity { candidates.list[at] = vec2(f, triangle_at(batch + firstTrailingBit(kept))); }
            at += 1u;
        }
    }
    return end - first;
}

@compute @workgroup_size(WORKGROUP)
fn cull(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let k = flat_invocation(group, groups, WORKGROUP, local);
    var tests = 0u;
    if k < min(atomicLoad(&candidates.tally[TALLY_PAIRS]), frame.pixel_texel_capacity) { tests = walk(pairs[k]); }
    atomicAdd(&wg_tests, tests);
    workgroupBarrier();
    if local == 0u {
        let sum = atomicLoad(&wg_tests);
        let before = atomicAdd(&candidates.tally[TALLY_TESTS], sum);
        if before + sum < before { atomicAdd(&candidates.tally[TALLY_TESTS + 1u], 1u); }
    }
}
