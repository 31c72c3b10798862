// sample_surfaces: which surface each sample sees, and the facets made of that: one for every surface that
// samples of the pixel see, with the mask of those samples. With MERGE neighbouring triangles of one plane
// are one surface (`surfaces`). `nearest` runs an invocation for each complex pixel over ROUND_LENGTH
// triangles of its list, from round `step.round` on, and keeps for each sample of word `step.word` the
// nearest, of equally near ones the lowest (`sample_keys`, complement; 0 for none). Where another surface
// almost touches it (`rivals_found`: triangles, then two masks a word), `settle_rivals` decides with 46 bits;
// where more than two do, which it lists in `crowds` (emptied by `begin`), `settle_crowds` does, round by
// round. `name_surfaces` writes the surfaces of samples to `named_keys`, as `sample_keys` has their
// triangles, and behind them how far off the triangles of larger surfaces reach; without MERGE the triangles
// themselves are `group_keys`. `group_samples` counts the surfaces that the samples of a complex pixel see
// into `facet_counts`; `emit` lists them at `pixel_facets`, in the order of their first samples, each with
// that of its triangles that most samples see. `emit_single` lists the facets of single pixels, and makes
// what lies beyond the last facet empty. Nothing is written beyond the capacities. `id_keys` takes the
// complement of the triangle at the pixel centre, which is sample 0; it must be 0 before. The surfaces of all
// samples may not fit one binding: complex pixels are taken in bands of `step.slots`, and `sample_keys` and
// `rivals_found` are those of a band, sample by sample: neighbouring invocations find theirs side by side.
//@bindings Search: nearest, settle_rivals, settle_crowds

//@import frame dispatch facet facing double_float vertex facing_46 eye_edges eye_view nearest_sample
//@import eye_order_46

override WORDS: u32 = 1u;
override MERGE: u32 = 0u;
override SAMPLES: u32 = 32u;  // of a word at most: code for more is left out
const WORKGROUP = 64u;
override ROUND_LENGTH: u32 = 512u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> step: SurfaceStep;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> pixel_list: array<u32>;
@group(0) @binding(7) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(8) var<storage, read> complex_total: array<u32>;
@group(0) @binding(9) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(10) var<storage, read_write> sample_keys: array<u32>;
@group(0) @binding(17) var<storage, read_write> rivals_found: array<u32>;
// How many pixels have crowded samples; of each slot and pixel
@group(0) @binding(22) var<storage, read_write> crowds: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(12) var<storage, read> complex_flags: array<u32>;
@group(0) @binding(13) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(14) var<storage, read_write> facets: array<Facet>;
// Coverage, occluded, invalid: WORDS words each
@group(0) @binding(15) var<storage, read_write> masks: array<u32>;
@group(0) @binding(16) var<storage, read_write> id_keys: array<u32>;
// Of each triangle, the lowest of its surface; SEVERAL: of more than one
@group(0) @binding(18) var<storage, read> surfaces: array<u32>;
@group(0) @binding(19) var<storage, read_write> named_keys: array<u32>;
@group(0) @binding(20) var<storage, read> seen_keys: array<u32>;   // as `sample_keys`
@group(0) @binding(21) var<storage, read> group_keys: array<u32>;  // as `named_keys`

//@import frame_copy
const SEVERAL = 0x80000000u;
//@import surface_groups touching_samples

@compute @workgroup_size(1)
fn begin() {
    atomicStore(&crowds[0], 0u);
}

@compute @workgroup_size(WORKGROUP)
fn nearest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_offsets();
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= slot_count() { return; }
    let pixel = complex_pixel(slot);
    let centre = pixel_ray(pixel);
    let first = pixel_offsets[pixel] + step.round * ROUND_LENGTH;
    let end = min(min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity), first + ROUND_LENGTH);
    let count = min(frame.sample_count - 32u * step.word, 32u);
    if step.round != 0u {
        if first >= end { return; }
        resume(slot, pixel, count);
    }
    for (var n = first; n < end; n += BATCH) { take_in(n, min(n + BATCH, end), count, slot, pixel, centre); }
    put_down(slot, count);
}

@compute @workgroup_size(WORKGROUP)
fn settle_rivals(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= slot_count() { return; }
    settle_rivals_of(slot);
}

@compute @workgroup_size(WORKGROUP)
fn settle_crowds(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let n = flat_invocation(group, groups, WORKGROUP, local);
    if n >= atomicLoad(&crowds[0]) { return; }
    settle_crowd(n);
}

@compute @workgroup_size(WORKGROUP)
fn name_surfaces(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= slot_count() { return; }
    var several = 0u;
    var at = slot;
    var last = 0u;
    var other = vec4(0u);  // samples that see another triangle than the one before
    for (var w = 0u; w < WORDS; w++) {
        var bits = 0u;
        for (var k = 0u; k < 32u; k++) {
            let key = sample_keys[at];
            var name = 0u;
            if key != 0u { name = surfaces[~key]; several |= name; name = ~(name & ~SEVERAL); }
            named_keys[at] = name;
            bits |= select(0u, 1u << k, key != last && key != 0u);
            last = key;
            at += step.slots;
        }
        other[w] = bits;
    }
    if (several & SEVERAL) == 0u { return; }
    named_keys[place(slot, 32u * WORDS)] = bitcast<u32>(farthest_corner(slot, other));
}

@compute @workgroup_size(WORKGROUP)
fn group_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= slot_count() { return; }
    load_groups(slot);
    var count = 0u;
    for (var left = samples_left(slot); any(left != vec4(0u)); count++) {
        left &= ~samples_of(slot, group_keys[place(slot, lowest_sample(left))]);
    }
    facet_counts[complex_pixel(slot)] = count;
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= slot_count() { return; }
    let pixel = complex_pixel(slot);
    load_groups(slot);
    if MERGE != 0u { load_seen(slot); }
    id_keys[pixel] = seen_keys[place(slot, 0u)];
    var f = pixel_facets[pixel];
    for (var left = samples_left(slot); any(left != vec4(0u)) && f < frame.facets_total; f++) {
        var k = lowest_sample(left);
        let mask = samples_of(slot, group_keys[place(slot, k)]);
        left &= ~mask;
        var facet = Facet(pixel, NO_TRIANGLE, STATE_EMPTY, 0.0, vec2(0.0));
        if MERGE != 0u {
            let own = most_seen(slot, mask);
            if any(own != mask) {
                k = lowest_sample(own);
                facet.state = STATE_MERGED;
                facet.limit = bitcast<f32>(group_keys[place(slot, 32u * WORDS)]);
            }
        }
        facet.triangle = ~seen_keys[place(slot, k)];
        facet.origin = sample_offset(k);
        facets[f] = facet;
        for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * f + w] = mask[w]; }
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit_single(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel >= pixel_facets[pixels] && pixel < frame.facets_total {
        facets[pixel].triangle = NO_TRIANGLE;
        facets[pixel].state = STATE_EMPTY;
    }
    if pixel >= pixels || complex_flags[pixel] != 0u { return; }
    let f = pixel_facets[pixel];
    let entry = pixel_offsets[pixel];
    if f == pixel_facets[pixel + 1u] || f >= frame.facets_total { return; }
    if entry >= frame.pixel_triangle_capacity {
        // The frame runs again; what an older one left here would be looked at till then
        facets[f].triangle = NO_TRIANGLE;
        return;
    }
    let t = pixel_list[entry];
    facets[f] = Facet(pixel, t, STATE_EMPTY, 0.0, vec2(0.0));
    for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * f + w] = full_word(w); }
    id_keys[pixel] = ~t;
}
