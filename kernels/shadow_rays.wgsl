// shadow_rays: from every sample of each listed facet a ray to the light through the tree of casters, until
// one is in the way. The model is that of visibility_masks: a sample is occluded iff the open segment from
// its point on the facet's plane to the light crosses a triangle that has a part strictly on the light's side
// of that plane. The facet's own triangle has none, and nothing is moved off the surface: sides decide, not a
// distance. `trace` tests triangles as Moeller and Trumbore (1997) with a bound for what rounding may do, one
// invocation a sample and word. Triangles that it cannot decide are noted in `work`; `refine` decides those
// with 46 bits. Samples for which `work` has no room are followed once more by `refine_all`. `cut_facets`
// finds the triangles that cut a facet within its pixel, and with them the invalid mask. The occluded and
// invalid masks of listed facets are replaced. `work`: 0: facets listed; 1: the same if `refine_all` is
// needed, else 0; 2: walks that ended early; 3: doubts noted; from 4 on the samples without room of each
// listed facet, WORDS words each; then the doubts (place in the list and sample as one word, triangle).

//@import frame dispatch facet facing double_float vertex facing_46 caster_tree

override WORDS: u32 = 1u;
const WORKGROUP = 64u;
const WORK_HEAD = 4u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> tree: TreePlace;
@group(0) @binding(3) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(4) var<storage, read> listed: array<u32>;
@group(0) @binding(5) var<storage, read_write> work: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read> nodes: array<vec4<u32>>;
// A vertex, two edges from it; w: bits of the indices, see leaf_caster
@group(0) @binding(7) var<storage, read> casters: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> positions: array<vec3<f32>>;
// Coverage, occluded, invalid: WORDS words each
@group(0) @binding(10) var<storage, read_write> masks: array<atomic<u32>>;

//@import frame_copy

//@import shadow_lines shadow_lines_46 shadow_ray leaf_caster ray_doubts facet_cut

var<workgroup> wg_occluded: array<atomic<u32>, 64>;
var<workgroup> wg_open: array<atomic<u32>, 64>;

// Result of the ray of `sample`: DOUBTFUL is one whose doubts have no room; with `exact` there are none. A
// node's triangles are sifted before any is tested closely.
fn follow(g: Ground, r: Ray, sample: u32, exact: bool) -> u32 {
    var found = FREE;
    if tree.node_count == 0u { return found; }
    let w = walk_of(r.at, r.light, frame.light.w == 0.0, tree.slack);
    var stack: array<vec2<u32>, STACK>;
    var held = 0u;
    var group = vec2(0u, 0x80000000u);
    for (var steps = 0u; steps < MOST_STEPS; steps++) {
        let at = next_node(group, w.octant);
        group.y = without_next(group.y);
        if group.y >= 0x01000000u && held < STACK {
            stack[held] = group;
            held += 1u;
        }
        let met = met_by(w, at);
        group = met.xy;
        var kept = 0u;
        for (var left = met.w; left != 0u; left = without_next(left)) {
            let bit = firstLeadingBit(left);
            if !misses(r, met.z + bit) { kept |= 1u << bit; }
            steps++;
        }
        for (; kept != 0u; kept = without_next(kept)) {
            let k = met.z + firstLeadingBit(kept);
            var what = blocks(g, r, k);
            if exact && what == DOUBTFUL { what = blocks_46(g, r.offset, k); }
            if what == BLOCKED { return BLOCKED; }
            if what == DOUBTFUL && !note(sample, k) { found = DOUBTFUL; }
            steps++;
        }
        if group.y < 0x01000000u {
            if held == 0u { return found; }
            held -= 1u;
            group = stack[held];
        }
    }
    atomicAdd(&work[2], 1u);
    return found;
}

@compute @workgroup_size(WORKGROUP)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let lanes = min(frame.sample_count, 32u);
    let mine = local / lanes;
    let slot = flat_group(group, groups) * (WORKGROUP / lanes) + mine;
    let lane = local % lanes;
    let is_there = slot < atomicLoad(&work[0]);
    var f = 0u;
    if is_there {
        f = listed[slot];
        let g = ground_of(f);
        for (var word = 0u; word < WORDS; word++) {
            if ((atomicLoad(&masks[3u * WORDS * f + word]) >> lane) & 1u) == 0u { continue; }
            let r = ray_of_sample(g, 32u * word + lane);
            if !r.meets { continue; }
            let found = follow(g, r, (slot << 7u) | (32u * word + lane), false);
            if found == BLOCKED { atomicOr(&wg_occluded[mine * WORDS + word], 1u << lane); }
            if found == DOUBTFUL {
                atomicOr(&wg_open[mine * WORDS + word], 1u << lane);
                atomicMax(&work[1], atomicLoad(&work[0]));
            }
        }
    }
    workgroupBarrier();
    if !is_there || lane >= WORDS { return; }
    atomicStore(&masks[3u * WORDS * f + WORDS + lane], atomicLoad(&wg_occluded[mine * WORDS + lane]));
    atomicStore(&work[WORK_HEAD + WORDS * slot + lane], atomicLoad(&wg_open[mine * WORDS + lane]));
}

@compute @workgroup_size(WORKGROUP)
fn refine(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let n = flat_invocation(group, groups, WORKGROUP, local);
    let room = doubts();
    if n >= min(atomicLoad(&work[3]), room.y) { return; }
    let sample = atomicLoad(&work[room.x + 2u * n]);
    let f = listed[sample >> 7u];
    let at = 3u * WORDS * f + WORDS + ((sample >> 5u) & 3u);
    let bit = 1u << (sample & 31u);
    if (atomicLoad(&masks[at]) & bit) != 0u { return; }
    let g = ground_of(f);
    let k = atomicLoad(&work[room.x + 2u * n + 1u]);
    if blocks_46(g, offset_of(sample & 127u), k) == BLOCKED { atomicOr(&masks[at], bit); }
}

@compute @workgroup_size(WORKGROUP)
fn refine_all(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let lanes = min(frame.sample_count, 32u);
    let slot = flat_group(group, groups) * (WORKGROUP / lanes) + local / lanes;
    if slot >= atomicLoad(&work[1]) { return; }
    let f = listed[slot];
    let lane = local % lanes;
    for (var word = 0u; word < WORDS; word++) {
        if ((atomicLoad(&work[WORK_HEAD + WORDS * slot + word]) >> lane) & 1u) == 0u { continue; }
        let g = ground_of(f);
        if follow(g, ray_of_sample(g, 32u * word + lane), 0u, true) == BLOCKED {
            atomicOr(&masks[3u * WORDS * f + WORDS + word], 1u << lane);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn cut_facets(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= atomicLoad(&work[0]) { return; }
    let f = listed[slot];
    for (var w = 0u; w < WORDS; w++) { atomicStore(&masks[3u * WORDS * f + 2u * WORDS + w], 0u); }
    if (frame.flags & FLAG_VALIDITY) == 0u || is_partial(f) || tree.node_count == 0u { return; }
    let g = ground_of(f);
    let w = pencil_of(f, g);
    var stack: array<vec2<u32>, STACK>;
    var held = 0u;
    var waiting = vec2(0u, 0x80000000u);
    for (var steps = 0u; steps < MOST_STEPS; steps++) {
        let node = next_node(waiting, w.octant);
        waiting.y = without_next(waiting.y);
        if waiting.y >= 0x01000000u && held < STACK {
            stack[held] = waiting;
            held += 1u;
        }
        let met = met_by(w, node);
        waiting = met.xy;
        for (var left = met.w; left != 0u; left = without_next(left)) {
            cut_by(f, g, met.z + firstLeadingBit(left));
            steps++;
        }
        if waiting.y < 0x01000000u {
            if held == 0u { return; }
            held -= 1u;
            waiting = stack[held];
        }
    }
    atomicAdd(&work[2], 1u);
}
