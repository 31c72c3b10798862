// sample_surfaces: which surface each sample sees, and the facets made of that: one for every triangle that samples of the
// pixel see, with the mask of those samples.
// `nearest` runs an invocation for each word of samples of a complex pixel over ROUND_LENGTH triangles of its list, from
// round `step.round` on, and keeps for each sample the nearest, of equally near ones the lowest (`sample_ids`). Where another surface
// almost touches it (`rival_ids`), `settle_rivals` decides with 46 bits.
// `group_samples` counts the triangles that the samples of a complex pixel see into `facet_counts`; `emit` lists them at
// `pixel_facets`, in the order of their first samples. `emit_single` lists the facets of single pixels, and makes what
// lies beyond the last facet empty. Nothing is written beyond the capacities. `id_keys` takes the complement of the
// triangle at the pixel centre, which is sample 0; it must be 0 before.
// What all samples see may not fit one binding: complex pixels are taken in bands of `step.slots`, and `sample_ids` and
// `rival_ids` are those of a band.

//@import frame
//@import dispatch
//@import facet
//@import facing
//@import double_float
//@import vertex
//@import facing_46
//@import eye_edges
//@import eye_view
//@import nearest_sample
//@import eye_order_46

struct Step {
    round: u32,
    first_slot: u32,  // of the band
    slots: u32,       // of the band at most
    pad_0: u32,
}

override WORDS: u32 = 1u;
const WORKGROUP = 32u;       // one lane for each sample of a word
const GROUP_NEAREST = 64u;
const GROUP_SINGLE = 64u;
const ROUND_LENGTH = 512u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> step: Step;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> pixel_list: array<u32>;
@group(0) @binding(7) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(8) var<storage, read> complex_total: array<u32>;
@group(0) @binding(9) var<storage, read> positions: array<f32>;
@group(0) @binding(10) var<storage, read_write> sample_ids: array<u32>;
@group(0) @binding(17) var<storage, read_write> rival_ids: array<u32>;
@group(0) @binding(11) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(12) var<storage, read> complex_flags: array<u32>;
@group(0) @binding(13) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(14) var<storage, read_write> facets: array<Facet>;
@group(0) @binding(15) var<storage, read_write> masks: array<u32>;  // coverage, occluded, invalid: WORDS words each
@group(0) @binding(16) var<storage, read_write> id_keys: array<u32>;

var<workgroup> wg_ids: array<u32, 128>;
var<workgroup> wg_firsts: array<atomic<u32>, 4>;
var<workgroup> wg_masks: array<atomic<u32>, 512>;

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// Complex pixels of the band.
fn slot_count() -> u32 {
    let all = min(complex_total[0], frame.complex_capacity);
    return min(all - min(all, step.first_slot), step.slots);
}

fn complex_pixel(slot: u32) -> u32 {
    return complex_pixels[step.first_slot + slot];
}

@compute @workgroup_size(GROUP_NEAREST)
fn nearest(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, GROUP_NEAREST, local);
    let slot = item / WORDS;
    let word = item % WORDS;
    if slot >= slot_count() { return; }
    let pixel = complex_pixel(slot);
    let centre = pixel_ray(pixel);
    let first = pixel_offsets[pixel] + step.round * ROUND_LENGTH;
    let end = min(min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity), first + ROUND_LENGTH);
    if step.round != 0u && first >= end { return; }
    let base = 32u * item;
    let count = min(frame.sample_count - 32u * word, 32u);
    // A count that compilers do not know: some would write all 32 turns out.
    let all = 32u * min(count, 1u);
    for (var k = 0u; k < all; k++) {
        best_ids[k] = NO_TRIANGLE;
        best_rivals[k] = NO_TRIANGLE;
        best_near[k] = 3.0e38;
        best_far[k] = 3.0e38;
        if step.round == 0u || k >= count { continue; }
        let t = sample_ids[base + k];
        if t == NO_TRIANGLE { continue; }
        best_ids[k] = t;
        best_rivals[k] = rival_ids[base + k];
        best_near[k] = eye_depth(corners_of(t), ray_at(pixel, sample_offset(32u * word + k)));
        best_far[k] = best_near[k];
    }
    for (var n = first; n < end; n++) { look_at(pixel_list[n], word, count, pixel, centre); }
    for (var k = 0u; k < all; k++) {
        sample_ids[base + k] = best_ids[k];
        rival_ids[base + k] = best_rivals[k];
    }
}

@compute @workgroup_size(WORKGROUP)
fn settle_rivals(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = flat_group(group, groups);
    if slot >= slot_count() { return; }
    for (var w = 0u; w < WORDS; w++) {
        let at = 32u * (WORDS * slot + w) + lane;
        let rival = rival_ids[at];
        // A loop of one turn: CPU adapters jump over a loop, but not over a branch.
        for (var open = rival != NO_TRIANGLE; open; open = false) {
            let t = sample_ids[at];
            let ray = ray_at(complex_pixel(slot), sample_offset(32u * w + lane));
            let order = order_46(corners_of(rival), corners_of(t), ray);
            if order < 0.0 || (order == 0.0 && rival < t) { sample_ids[at] = rival; }
        }
    }
}

// Groups the samples of a complex pixel by triangle: bits of the first samples in `wg_firsts`, and at each first sample
// the mask of its group in `wg_masks`. All lanes of a workgroup call it.
fn find_groups(slot: u32, lane: u32) {
    for (var w = 0u; w < WORDS; w++) {
        let k = lane + 32u * w;
        wg_ids[k] = sample_ids[slot * 32u * WORDS + k];
        for (var n = 0u; n < WORDS; n++) { atomicStore(&wg_masks[WORDS * k + n], 0u); }
    }
    if lane < 4u { atomicStore(&wg_firsts[lane], 0u); }
    workgroupBarrier();
    for (var w = 0u; w < WORDS; w++) {
        let k = lane + 32u * w;
        if wg_ids[k] == NO_TRIANGLE { continue; }
        var first = 0u;
        while wg_ids[first] != wg_ids[k] { first += 1u; }
        if first == k { atomicOr(&wg_firsts[w], 1u << lane); }
        atomicOr(&wg_masks[WORDS * first + w], 1u << lane);
    }
    workgroupBarrier();
}

@compute @workgroup_size(WORKGROUP)
fn group_samples(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = flat_group(group, groups);
    if slot >= slot_count() { return; }
    find_groups(slot, lane);
    if lane != 0u { return; }
    var count = 0u;
    for (var w = 0u; w < WORDS; w++) { count += countOneBits(atomicLoad(&wg_firsts[w])); }
    facet_counts[complex_pixel(slot)] = count;
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = flat_group(group, groups);
    if slot >= slot_count() { return; }
    let pixel = complex_pixel(slot);
    find_groups(slot, lane);
    if lane == 0u { id_keys[pixel] = ~wg_ids[0]; }
    var f = pixel_facets[pixel];
    for (var w = 0u; w < WORDS; w++) {
        let firsts = atomicLoad(&wg_firsts[w]);
        let rank = f + countOneBits(firsts & ((1u << lane) - 1u));
        f += countOneBits(firsts);
        if ((firsts >> lane) & 1u) == 0u || rank >= frame.facets_total { continue; }
        let k = lane + 32u * w;
        facets[rank].pixel = pixel;
        facets[rank].triangle = wg_ids[k];
        facets[rank].origin = sample_offset(k);
        for (var n = 0u; n < WORDS; n++) { masks[3u * WORDS * rank + n] = atomicLoad(&wg_masks[WORDS * k + n]); }
    }
}

@compute @workgroup_size(GROUP_SINGLE)
fn emit_single(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, GROUP_SINGLE, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel >= pixel_facets[pixels] && pixel < frame.facets_total { facets[pixel].triangle = NO_TRIANGLE; }
    if pixel >= pixels || complex_flags[pixel] != 0u { return; }
    let f = pixel_facets[pixel];
    let entry = pixel_offsets[pixel];
    if f == pixel_facets[pixel + 1u] || f >= frame.facets_total { return; }
    if entry >= frame.pixel_triangle_capacity {
        facets[f].triangle = NO_TRIANGLE;  // the frame runs again; what an older one left here would be looked at till then
        return;
    }
    let t = pixel_list[entry];
    facets[f].pixel = pixel;
    facets[f].triangle = t;
    facets[f].origin = vec2(0.0);
    for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * f + w] = full_word(w); }
    id_keys[pixel] = ~t;
}
