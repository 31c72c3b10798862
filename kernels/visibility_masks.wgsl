// visibility_masks: which samples of each undecided facet are occluded, and which are not valid (Pan 2009, section 3.4).
// One invocation a candidate pair of facet and triangle; its result is or-ed into `masks` (coverage, occluded, invalid:
// WORDS words each).
//
// A sample is occluded by a triangle iff the segment from its point on the facet's plane to the light crosses it: the
// point lies inside three planes through the light and an edge and beyond the triangle's own plane. In the image each of
// the four is a half-plane, found without division: see shared/shadow_lines. A triangle with no part strictly on the
// light's side of the facet casts nothing on it.
// `evaluate` works in single precision and puts every candidate it cannot decide, or whose lines it cannot place within
// LINE_TRUST pixels, on the list `doubts`; `refine` decides those with 46 bits.

//@import frame
//@import dispatch
//@import facet
//@import facing
//@import double_float
//@import candidates

override WORDS: u32 = 1u;
override ANGLES: u32 = 0u;   // size of the lookup table; 0: every sample is tested against every line
override OFFSETS: u32 = 0u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> facets: array<Facet>;
@group(0) @binding(3) var<storage, read_write> candidates: Candidates;
@group(0) @binding(4) var<storage, read> triangles: array<u32>;
@group(0) @binding(5) var<storage, read> positions: array<f32>;
@group(0) @binding(8) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read_write> masks: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> doubts: array<u32>;

//@import shadow_lines
//@import shadow_lines_46

// Four half-planes as matrices: column k holds what line k is at the centre, per pixel right, per pixel down.
struct Lines {
    centre: vec4<f32>,
    right: vec4<f32>,
    down: vec4<f32>,
}

// Samples inside all four lines. A sample on a line is inside for one of the two triangles that share it.
fn word_mask(word: u32, l: Lines) -> u32 {
    var out = 0u;
    let count = (min(frame.sample_count, 32u) + 1u) >> 1u;
    let first = word << 4u;
    for (var k = 0u; k < count; k++) {
        let s = samples[first + k];
        let a = l.centre + s.x * l.right + s.y * l.down;
        let b = l.centre + s.z * l.right + s.w * l.down;
        let ma = min(min(a.x, a.y), min(a.z, a.w));
        let mb = min(min(b.x, b.y), min(b.z, b.w));
        out |= ((bitcast<u32>(ma) >> 31u) | ((bitcast<u32>(mb) >> 31u) << 1u)) << (2u * k);
    }
    return ~out;
}

// Samples inside one line, from the table: the mask of the nearest tabulated direction and distance from the centre.
fn table_mask(line: vec3<f32>) -> vec4<u32> {
    let sum = abs(line.y) + abs(line.z);
    // The angle as its place on a diamond, -1 to 3.
    let part = line.z / sum;
    let turn = select(2.0 - part, part, line.y >= 0.0) + 1.0;
    let distance = -line.x / length(line.yz);
    let a = min(u32(turn * 0.25 * f32(ANGLES)), ANGLES - 1u);
    let o = u32(clamp((distance * 0.70710678 + 0.5) * f32(OFFSETS), 0.0, f32(OFFSETS) - 1.0));
    let at = (a * OFFSETS + o) * WORDS;
    var m = vec4(table[at], 0u, 0u, 0u);
    if WORDS > 1u { m.y = table[at + 1u]; }
    if WORDS > 2u {
        m.z = table[at + 2u];
        m.w = table[at + 3u];
    }
    return m;
}

fn inside(l: Lines) -> vec4<u32> {
    let reach = 0.501 * (abs(l.right) + abs(l.down));
    if any(l.centre < -reach) { return vec4(0u); }
    let crossing = l.centre <= reach;
    if !any(crossing) { return vec4(0xffffffffu); }
    if ANGLES != 0u {
        var t = vec4(0xffffffffu);
        if crossing.x { t &= table_mask(vec3(l.centre.x, l.right.x, l.down.x)); }
        if crossing.y { t &= table_mask(vec3(l.centre.y, l.right.y, l.down.y)); }
        if crossing.z { t &= table_mask(vec3(l.centre.z, l.right.z, l.down.z)); }
        if crossing.w { t &= table_mask(vec3(l.centre.w, l.right.w, l.down.w)); }
        return t;
    }
    var m = vec4(0u);
    m.x = word_mask(0u, l);
    if WORDS > 1u { m.y = word_mask(1u, l); }
    if WORDS > 2u {
        m.z = word_mask(2u, l);
        m.w = word_mask(3u, l);
    }
    return m;
}

// Whether no sample is left that could still be lit: nothing more needs to be known of the facet.
fn is_dark(f: u32) -> bool {
    var open = 0u;
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + w;
        open |= atomicLoad(&masks[at]) & ~atomicLoad(&masks[at + WORDS]) & ~atomicLoad(&masks[at + 2u * WORDS]);
    }
    return open == 0u;
}

fn add(f: u32, part: u32, m: vec4<u32>) {
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + part * WORDS + w;
        if (m[w] & ~atomicLoad(&masks[at])) != 0u { atomicOr(&masks[at], m[w]); }
    }
}

// Takes in what a triangle does to a facet: `turn` 1 if it faces the light, `h` its heights over the facet.
fn apply(f: u32, g: Ground, l: Lines, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>) {
    let m = inside(l);
    if any(m != vec4(0u)) { add(f, 1u, m); }
    if (frame.flags & FLAG_VALIDITY) == 0u || all(h > vec3(0.0)) { return; }
    let own = vec3(l.centre.w, l.right.w, l.down.w);
    if own.x == 0.0 || !meets_pixel(own, a, b, c, h, g.pixel) { return; }
    // The samples on the other side of the line than the pixel centre see another surface.
    let far = -sign(own.x);
    let one = Lines(vec4(far * own.x), vec4(far * own.y), vec4(far * own.z));
    add(f, 2u, inside(one));
}

fn rising(t: u32) -> vec3<u32> {
    var i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    return i;
}

// False if single precision cannot tell.
fn settle(f: u32, t: u32) -> bool {
    let i = rising(t);
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    let side = facing_of(a, b, c, frame.light);
    if side == UNSURE { return false; }
    let g = ground_of(f);
    let turn = select(-1.0, 1.0, side == FRONT);
    let ab = edge_line(g, a, b);
    let bc = edge_line(g, b, c);
    let ac = edge_line(g, a, c);
    var l = Lines(
        turn * vec4(ab.x, bc.x, -ac.x, 0.0), turn * vec4(ab.y, bc.y, -ac.y, 0.0), turn * vec4(ab.z, bc.z, -ac.z, 0.0));
    var error = vec4(ab.w, bc.w, ac.w, 0.0);
    let reach = 0.501 * (abs(l.right) + abs(l.down));
    // Wholly outside an edge: nothing is cast, and no cut of the facet lies in the pixel either.
    if any(l.centre.xyz < -reach.xyz - error.xyz) { return true; }
    let h = vec3(height_of(g, is_own(i.x, g.own), a), height_of(g, is_own(i.y, g.own), b), height_of(g, is_own(i.z, g.own), c));
    if any(h == vec3(OPEN)) { return false; }
    if all(h <= vec3(0.0)) { return true; }
    if all(h > vec3(0.0)) {
        l.centre.w = 3.0e38;
    } else {
        let own = own_line(g, a, b, c);
        l.centre.w = turn * own.x;
        l.right.w = turn * own.y;
        l.down.w = turn * own.z;
        error.w = own.w;
    }
    let slope = abs(l.right) + abs(l.down);
    let doubtful = (error > LINE_TRUST * slope) & (abs(l.centre) <= 0.501 * slope + error);
    if any(doubtful) { return false; }
    apply(f, g, l, a, b, c, h);
    return true;
}

@compute @workgroup_size(WORKGROUP)
fn evaluate(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= min(atomicLoad(&candidates.tally[TALLY_CANDIDATES]), frame.candidate_capacity) { return; }
    let pair = candidates.list[k];
    if is_dark(pair.x) { return; }
    if !settle(pair.x, pair.y) { doubts[atomicAdd(&candidates.tally[TALLY_DOUBTS], 1u)] = k; }
}

@compute @workgroup_size(WORKGROUP)
fn refine(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= atomicLoad(&candidates.tally[TALLY_DOUBTS]) { return; }
    let pair = candidates.list[doubts[k]];
    if is_dark(pair.x) { return; }
    let i = rising(pair.y);
    let g = ground_of(pair.x);
    let n = full_normal(g.own);
    let h = vec3(full_height_of(g, n, i.x), full_height_of(g, n, i.y), full_height_of(g, n, i.z));
    if all(h <= vec3(0.0)) { return; }
    let turn = full_turn_of(i);
    if turn == 0.0 { return; }
    let p = full_point_of(i.x);
    let ab = full_edge_line(g, n, i.xy);
    let bc = full_edge_line(g, n, i.yz);
    let ac = full_edge_line(g, n, i.xz);
    var own = vec3(3.0e38, 0.0, 0.0) * turn;
    if !all(h > vec3(0.0)) { own = full_line(g, n, full_normal(i), p); }
    let l = Lines(
        turn * vec4(ab.x, bc.x, -ac.x, own.x), turn * vec4(ab.y, bc.y, -ac.y, own.y), turn * vec4(ab.z, bc.z, -ac.z, own.z));
    apply(pair.x, g, l, point_of(i.x), point_of(i.y), point_of(i.z), h);
}
