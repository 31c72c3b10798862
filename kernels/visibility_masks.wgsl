// visibility_masks: which samples of each undecided facet are occluded, and which are not valid (Pan 2009,
// section 3.4). One invocation a candidate pair of facet and triangle; its result is or-ed into `masks`
// (coverage, occluded, invalid: WORDS words each).
//
// A sample is occluded by a triangle iff the segment from its point on the facet's plane to the light
// crosses it: the point lies inside three planes through the light and an edge and beyond the triangle's
// own plane. In the image each of the four is a half-plane, found without division: see shadow_lines. A
// triangle with no part strictly on the light's side of the facet casts nothing on it, and an
// alpha-tested one nothing where it has a hole on the sample's own way to the light (solid_samples).
// `evaluate` works in single precision and puts every candidate it cannot decide, whose lines it cannot
// place within LINE_TRUST pixels, or with a line nearer to a sample than rounding may move it, on the
// list `doubts`; `refine` decides those with 46 bits. So two triangles at an edge agree on every sample,
// whichever of the two decides each. Other candidates that may cut the facet are put on the list `cuts`,
// for `cut_facets`: few do, and vector machines pay for code that no lane takes. Each has room for all
// candidates, `cuts` with FLAG_VALIDITY alone.

//@import frame dispatch facet facing double_float vertex facing_46 candidates

override WORDS: u32 = 1u;
override ANGLES: u32 = 0u;   // size of the lookup table; 0: every sample is tested against every line
override OFFSETS: u32 = 0u;
override CUTS: u32 = 1u;     // 0: FLAG_VALIDITY is never set
override TWO_STEP: u32 = 0u;  // 1: by two projections (two_step), and nothing is put on the list `doubts`
const WORKGROUP = 64u;
const CUT_GROUPS = 256u;     // workgroups that go through what may cut

@group(0) @binding(0) var<uniform> frame_given: Frame;
// Two offsets from the pixel centre each
@group(0) @binding(1) var<uniform> samples_given: array<vec4<f32>, 64>;
@group(0) @binding(2) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(3) var<storage, read_write> candidates: Candidates;
@group(0) @binding(4) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(8) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read_write> masks: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> doubts: array<u32>;
@group(0) @binding(9) var<storage, read_write> cuts: array<u32>;

//@import frame_copy

//@import shadow_lines shadow_lines_46 sample_masks two_step facet_masks alpha solid_samples

fn project(f: u32, t: u32) {
    let given = triangles[t];
    let i = rising(given.xyz);
    let g = ground_of(f);
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    var h = vec3(dot(g.normal, a - g.at), dot(g.normal, b - g.at), dot(g.normal, c - g.at));
    h = select(h, vec3(0.0), owned_by(i, g.own));
    if all(h <= vec3(0.0)) { return; }
    let l = two_step_lines(g, a, b, c, h);
    let edges = EdgeLines(l.centre.xyz, l.right.xyz, l.down.xyz);
    add(f, 1u, solid_samples(f, g, given, edges, inside(l)));
    cut(f, g, vec3(l.centre.w, l.right.w, l.down.w), a, b, c, h);
}

// False if single precision cannot tell. `k`: the candidate.
fn settle(k: u32, f: u32, t: u32) -> bool {
    let given = triangles[t];
    let i = rising(given.xyz);
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    let side = facing_of(a, b, c, frame.light);
    if side == UNSURE { return false; }
    let g = ground_of(f);
    let turn = select(-1.0, 1.0, side == FRONT);
    let owned = owned_by(i, g.own);
    let beside = is_beside(g, i, owned, turn);
    if beside && g.alone { return true; }
    let ab = edge_line(g, a, edge_of(i.x, i.y));
    let bc = edge_line(g, b, edge_of(i.y, i.z));
    let ac = edge_line(g, a, edge_of(i.x, i.z));
    var l = Lines(
        turn * vec4(ab.x, bc.x, -ac.x, 0.0), turn * vec4(ab.y, bc.y, -ac.y, 0.0),
        turn * vec4(ab.z, bc.z, -ac.z, 0.0));
    var error = vec4(ab.w, bc.w, ac.w, 0.0);
    let reach = 0.501 * (abs(l.right) + abs(l.down));
    // Wholly outside an edge: nothing is cast, and no cut of the facet lies in the pixel either.
    if any(l.centre.xyz < -reach.xyz - error.xyz) { return true; }
    let h = vec3(height_of(g, owned.x, a), height_of(g, owned.y, b), height_of(g, owned.z, c));
    if any(h == vec3(OPEN)) { return false; }
    if all(h <= vec3(0.0)) { return true; }
    if all(h > vec3(0.0)) {
        l.centre.w = 1.0;
    } else {
        let own = own_line(g, a, edge_of(i.x, i.y), edge_of(i.x, i.z));
        l.centre.w = turn * own.x;
        l.right.w = turn * own.y;
        l.down.w = turn * own.z;
        error.w = own.w;
    }
    let edges = EdgeLines(l.centre.xyz, l.right.xyz, l.down.xyz);
    l.centre = centre_of(l, beside, owned);
    let slope = abs(l.right) + abs(l.down);
    let far = error > LINE_TRUST * slope;
    // Where a hole is depends on lines that do not cross the pixel, too.
    let asks = ALPHA != 0u && is_tested(given.w);
    if any(far & ((abs(l.centre) <= 0.501 * slope + error) | vec4(vec3(asks), false))) { return false; }
    var m = vec4(0u);
    if ANGLES != 0u {
        // The table rounds lines farther than `error`.
        m = inside(l);
    } else {
        let t = told(l, error);
        if t.open { return false; }
        m = t.mask;
    }
    add(f, 1u, solid_samples(f, g, given, edges, m));
    if may_cut(vec3(l.centre.w, l.right.w, l.down.w), h) {
        cuts[atomicAdd(&candidates.tally[TALLY_CUTS], 1u)] = k;
    }
    return true;
}

@compute @workgroup_size(WORKGROUP)
fn cut_facets(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_samples();
    let count = atomicLoad(&candidates.tally[TALLY_CUTS]);
    let stride = WORKGROUP * groups.x * groups.y;
    for (var n = flat_invocation(group, groups, WORKGROUP, local); n < count; n += stride) {
        let pair = candidates.list[cuts[n]];
        if is_dark(pair.x) { continue; }
        let i = rising(triangles[pair.y].xyz);
        let g = ground_of(pair.x);
        // Where a cut ends is a ratio of heights, of which single precision may know no more than the signs.
        let n = full_normal(g.own);
        let h = full_heights_of(g, n, i);
        if all(h <= vec3(0.0)) { continue; }
        let a = point_of(i.x);
        let b = point_of(i.y);
        let c = point_of(i.z);
        let side = facing_of(a, b, c, frame.light);
        let turn = select(-1.0, 1.0, side == FRONT);
        let beside = is_beside(g, i, owned_by(i, g.own), select(turn, 0.0, side == UNSURE));
        // Facets that are cut are one a pixel.
        let line = beyond_centre(turn * full_line(g, n, full_normal(i), i.x), beside);
        cut(pair.x, g, line, a, b, c, h);
    }
}

@compute @workgroup_size(WORKGROUP)
fn evaluate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_samples();
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= min(atomicLoad(&candidates.tally[TALLY_CANDIDATES]), frame.candidate_capacity) { return; }
    let pair = candidates.list[k];
    if is_dark(pair.x) { return; }
    if TWO_STEP != 0u {
        project(pair.x, pair.y);
        return;
    }
    if !settle(k, pair.x, pair.y) { doubts[atomicAdd(&candidates.tally[TALLY_DOUBTS], 1u)] = k; }
}

@compute @workgroup_size(WORKGROUP)
fn refine(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_samples();
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= atomicLoad(&candidates.tally[TALLY_DOUBTS]) { return; }
    let pair = candidates.list[doubts[k]];
    if is_dark(pair.x) { return; }
    let given = triangles[pair.y];
    let i = rising(given.xyz);
    let g = ground_of(pair.x);
    let n = full_normal(g.own);
    let h = full_heights_of(g, n, i);
    if all(h <= vec3(0.0)) { return; }
    let crosses = !all(h > vec3(0.0));
    let a = point_of(i.x);
    let b = point_of(i.y);
    let c = point_of(i.z);
    // Edge-on to the light it casts nothing, but it may still cut.
    let turn = full_turn_of(i);
    if turn == 0.0 && !crosses { return; }
    let owned = owned_by(i, g.own);
    let beside = is_beside(g, i, owned, turn);
    if beside && g.alone { return; }
    var l = full_lines(g, n, i, select(turn, 1.0, turn == 0.0), crosses);
    let edges = EdgeLines(l.centre.xyz, l.right.xyz, l.down.xyz);
    l.centre = centre_of(l, beside, owned);
    if turn != 0.0 { add(pair.x, 1u, solid_samples(pair.x, g, given, edges, inside(l))); }
    cut(pair.x, g, vec3(l.centre.w, l.right.w, l.down.w), a, b, c, h);
}
