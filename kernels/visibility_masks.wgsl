// visibility_masks: which samples of each undecided facet are occluded, and which are not valid (Pan 2009, section 3.4).
// One invocation a pixel-texel pair loops over the triangles of its texel and ors their masks in registers; then one
// atomicOr a word into `masks` (coverage, occluded, invalid: WORDS words each). `round` picks which ROUND_LENGTH
// triangles of long lists this dispatch looks at.
//
// A sample is occluded by a triangle iff the segment from its point on the facet's plane to the light crosses it: the
// point lies inside three planes through the light and an edge and beyond the triangle's own plane. In the image each of
// the four is a half-plane, found without division: see shared/shadow_lines. Edges count as inside for both triangles at
// them, the triangle's own plane for none.
// A triangle with no part strictly on the light's side of the facet casts nothing on it. A line that single precision
// places no better than LINE_TRUST pixels is computed again with 46 bits.

//@import frame
//@import dispatch
//@import facet
//@import facing
//@import double_float

override WORDS: u32 = 1u;
const WORKGROUP = 64u;
const ROUND_LENGTH = 1024u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> facets: array<Facet>;
@group(0) @binding(3) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> status: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read> triangle_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> pair_triangles: array<u32>;
@group(0) @binding(7) var<storage, read> triangles: array<u32>;
@group(0) @binding(8) var<storage, read> positions: array<f32>;
@group(0) @binding(9) var<storage, read_write> masks: array<atomic<u32>>;

//@import shadow_lines

const STATUS_PAIRS = 0u;         // pixel-texel pairs needed
const STATUS_LONGEST = 9u;       // longest triangle list that was met
const STATUS_EVALUATIONS = 10u;  // triangle and facet evaluated against each other, low and high word

var<workgroup> wg_evaluations: atomic<u32>;

fn word_mask(word: u32, line: vec3<f32>, strict: bool) -> u32 {
    var bits = 0u;
    let count = (min(frame.sample_count, 32u) + 1u) >> 1u;
    let first = word << 4u;
    for (var k = 0u; k < count; k++) {
        let s = samples[first + k];
        let v = line.x + line.y * s.xz + line.z * s.yw;
        let inside = select(v >= vec2(0.0), v > vec2(0.0), strict);
        bits |= (select(0u, 1u, inside.x) | select(0u, 2u, inside.y)) << (2u * k);
    }
    return bits;
}

fn half_plane(line: vec3<f32>, strict: bool) -> vec4<u32> {
    // Lines that no sample of the pixel can be beyond.
    let reach = 0.501 * (abs(line.y) + abs(line.z));
    if line.x > reach { return vec4(0xffffffffu); }
    if line.x < -reach { return vec4(0u); }
    var m = vec4(0u);
    m.x = word_mask(0u, line, strict);
    if WORDS > 1u { m.y = word_mask(1u, line, strict); }
    if WORDS > 2u {
        m.z = word_mask(2u, line, strict);
        m.w = word_mask(3u, line, strict);
    }
    return m;
}

// The mask of triangle `i` (vertex indices in rising order) on the facet, and in `invalid` what it makes invalid.
fn triangle_mask(g: Ground, i: vec3<u32>, invalid: ptr<function, vec4<u32>>) -> vec4<u32> {
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    let h = vec3(height_of(g, i.x, a), height_of(g, i.y, b), height_of(g, i.z, c));
    if all(h <= vec3(0.0)) { return vec4(0u); }
    let turn = turn_of(a, b, c, i);
    if turn == 0.0 { return vec4(0u); }
    var m = vec4(0xffffffffu);
    if !all(h > vec3(0.0)) {
        let line = turn * own_line(g, a, b, c, i);
        m = half_plane(line, true);
        if (frame.flags & FLAG_VALIDITY) != 0u && meets_pixel(line, a, b, c, h, g.pixel) {
            // The samples on the other side of the line than the pixel centre see another surface.
            if line.x > 0.0 { *invalid |= ~half_plane(line, false); }
            if line.x < 0.0 { *invalid |= m; }
        }
        if all(m == vec4(0u)) { return m; }
    }
    m &= half_plane(turn * edge_line(g, a, b, i.xy), false);
    if all(m == vec4(0u)) { return m; }
    m &= half_plane(turn * edge_line(g, b, c, i.yz), false);
    if all(m == vec4(0u)) { return m; }
    return m & half_plane(-turn * edge_line(g, a, c, i.xz), false);
}

@compute @workgroup_size(WORKGROUP)
fn evaluate(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    var done = 0u;
    if k < min(atomicLoad(&status[STATUS_PAIRS]), frame.pixel_texel_capacity) { done = evaluate_pair(pairs[k]); }
    atomicAdd(&wg_evaluations, done);
    workgroupBarrier();
    if local == 0u {
        let sum = atomicLoad(&wg_evaluations);
        let before = atomicAdd(&status[STATUS_EVALUATIONS], sum);
        if before + sum < before { atomicAdd(&status[STATUS_EVALUATIONS + 1u], 1u); }
    }
}

// Evaluates one facet against the triangles of one texel; returns how many.
fn evaluate_pair(pair: vec2<u32>) -> u32 {
    let list = triangle_offsets[pair.y];
    let list_end = min(triangle_offsets[pair.y + 1u], frame.triangle_texel_capacity);
    if list_end > list + ROUND_LENGTH { atomicMax(&status[STATUS_LONGEST], list_end - list); }
    let first = list + frame.round * ROUND_LENGTH;
    let end = min(list_end, first + ROUND_LENGTH);
    if first >= end { return 0u; }
    let facet = facets[pair.x];
    let g = ground_of(facet);
    var occluded = vec4(0u);
    var invalid = vec4(0u);
    for (var n = first; n < end; n++) {
        let t = pair_triangles[n];
        if t == facet.triangle { continue; }
        var i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
        if i.x > i.y { i = i.yxz; }
        if i.y > i.z { i = i.xzy; }
        if i.x > i.y { i = i.yxz; }
        occluded |= triangle_mask(g, i, &invalid);
    }
    let base = 3u * WORDS * pair.x;
    for (var w = 0u; w < WORDS; w++) {
        let o = base + WORDS + w;
        if (occluded[w] & ~atomicLoad(&masks[o])) != 0u { atomicOr(&masks[o], occluded[w]); }
        let v = base + 2u * WORDS + w;
        if (invalid[w] & ~atomicLoad(&masks[v])) != 0u { atomicOr(&masks[v], invalid[w]); }
    }
    return end - first;
}
