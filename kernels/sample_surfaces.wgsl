// sample_surfaces: which surface each sample sees, and the facets made of that: one for every surface that
// samples of the pixel see, with the mask of those samples. With MERGE neighbouring triangles of one plane
// are one surface (`surfaces`). It is told which samples each triangle in the list of a complex pixel covers
// (pixel_coverage: `coverings`, `covering_masks`). `begin` notes where these lists stand, and takes
// `pixel_counts` down to 0. `nearest` runs an invocation for each complex pixel and takes from the masks of
// word `step.word` the samples at which bounds say that another triangle is nearer; those that several are
// left with are `contested`: `settle` decides, with 46 bits where single precision does not tell, of equally
// near ones for the lowest. Then each sample is in one mask at most. `gather` moves what sees anything to the
// front of the pixel's list, and counts the surfaces into `facet_counts`. Of a list longer than ROUND_LENGTH
// a round takes that many, with those that earlier rounds left in front. `emit` lists the facets of complex
// pixels at `pixel_facets`, in the order of their first samples, each with that of its triangles that most
// samples see, and leaves in `id_keys` the complement of the triangle at the pixel's centre, which is sample
// 0. `emit_single` lists those of single pixels, whose triangles `id_keys` has, and makes what lies beyond
// the last facet empty. Nothing is written beyond the capacities.
//@bindings Search: nearest, settle

//@import frame dispatch facet facing double_float vertex facing_46 eye_edges eye_order_46 covering
//@import word_masks

override WORDS: u32 = 1u;
override MERGE: u32 = 0u;
const WORKGROUP = 64u;
override ROUND_LENGTH: u32 = 512u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> samples_given: array<vec4<f32>, 64>;  // two offsets from the centre each
@group(0) @binding(2) var<uniform> step: SurfaceStep;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> coverings: array<Covering>;
@group(0) @binding(7) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(8) var<storage, read> complex_total: array<u32>;
@group(0) @binding(9) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(10) var<storage, read_write> covering_masks: array<u32>;
@group(0) @binding(11) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(12) var<storage, read> complex_flags: array<u32>;
@group(0) @binding(13) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(14) var<storage, read_write> facets: array<Facet>;
// Coverage, occluded, invalid: WORDS words each
@group(0) @binding(15) var<storage, read_write> masks: array<u32>;
@group(0) @binding(16) var<storage, read_write> id_keys: array<u32>;
// Of each triangle, the lowest of its surface; SEVERAL: of more than one
@group(0) @binding(17) var<storage, read> surfaces: array<u32>;
@group(0) @binding(18) var<storage, read_write> pixel_counts: array<u32>;
@group(0) @binding(19) var<storage, read_write> contested: array<u32>;  // WORDS words a complex pixel
@group(0) @binding(20) var<storage, read_write> slots: array<PixelSlot>;

//@import frame_copy sample_copy
const SEVERAL = 0x80000000u;
//@import surface_step word_offsets pixel_entries nearest_entry contested_entry facet_span

@compute @workgroup_size(WORKGROUP)
fn begin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= frame.complex_capacity { return; }
    var made = PixelSlot(NO_TRIANGLE, 0u, 0u, 0u, 0.0);
    if slot < complex_total[0] {
        let pixel = complex_pixels[slot];
        let first = pixel_offsets[pixel];
        made = PixelSlot(pixel, first, first + pixel_counts[pixel], 0u, 0.0);
        pixel_counts[pixel] = 0u;
    }
    slots[slot] = made;
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
    if slot >= frame.complex_capacity { return; }
    let entries = entries_of(slots[slot]);
    let twice = covered_twice(entries);
    var open = 0u;
    if twice != 0u { open = keep_nearest(entries, twice); }
    contested[slot * WORDS + step.word] = open;
}

@compute @workgroup_size(WORKGROUP)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= frame.complex_capacity { return; }
    let own = slots[slot];
    let entries = entries_of(own);
    for (var left = contested[slot * WORDS + step.word]; left != 0u; left &= left - 1u) {
        settle_sample(entries, own.pixel, firstTrailingBit(left));
    }
}

@compute @workgroup_size(WORKGROUP)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= frame.complex_capacity { return; }
    let own = slots[slot];
    if own.pixel == NO_TRIANGLE { return; }
    let entries = entries_of(own);
    let long = own.end - own.first > ROUND_LENGTH;
    var count = 0u;
    var made = 0u;
    var several = false;
    for (var n = next_seen(entries, 0u); n < entries.count; n = next_seen(entries, n + 1u)) {
        let was = place_of(entries, n);
        let at = own.first + count;
        let triangle = coverings[was].triangle;
        let mask = mask_at(was);
        // Later rounds alone ask for the depth.
        for (var whole = at != was && long; whole; whole = false) { coverings[at] = coverings[was]; }
        coverings[at].triangle = triangle;
        for (var w = 0u; w < WORDS; w++) { covering_masks[at * WORDS + w] = mask[w]; }
        var fresh = true;
        if MERGE != 0u {
            let name = surface_of(triangle);
            let one_of = (name & SEVERAL) != 0u;
            several |= one_of;
            fresh = !one_of || next_named(own.first, at, name) == at;
        }
        made += select(0u, 1u, fresh);
        count++;
    }
    // Rare, and dear.
    var far = 0.0;
    for (var n = select(count, 0u, several); n < count; n++) {
        far = max(far, far_corner(coverings[own.first + n].triangle));
    }
    slots[slot].kept = count;
    slots[slot].far = far;
    facet_counts[own.pixel] = made;
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_samples();
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= frame.complex_capacity { return; }
    let here = slots[slot];
    if here.pixel == NO_TRIANGLE { return; }
    let pixel = here.pixel;
    let first = here.first;
    let end = first + here.kept;
    var left = vec4(0u);
    for (var n = first; n < end; n++) { left |= mask_at(n); }
    id_keys[pixel] = 0u;
    if (left.x & 1u) != 0u { id_keys[pixel] = ~coverings[entry_with(first, end, 0u)].triangle; }
    var f = pixel_facets[pixel];
    for (; any(left != vec4(0u)) && f < frame.facets_total; f++) {
        var best = entry_with(first, end, lowest_bit(left));
        var mask = mask_at(best);
        var own = mask;
        let name = name_of(best);
        if MERGE != 0u {
            var n = end;
            if (name & SEVERAL) != 0u { n = next_named(first, end, name); }
            for (; n < end; n = next_named(n + 1u, end, name)) {
                let more = mask_at(n);
                mask |= more;
                let size = size_of(more);
                let most = size_of(own);
                if size > most || (size == most && lowest_bit(more) < lowest_bit(own)) {
                    best = n;
                    own = more;
                }
            }
        }
        left &= ~mask;
        let merged = any(own != mask);
        let span = packed_span(span_of_samples(mask));
        let origin = sample_offset(lowest_bit(own));
        var facet = Facet(pixel, coverings[best].triangle, STATE_EMPTY, 0.0, origin, span);
        if merged {
            facet.state = STATE_MERGED;
            facet.limit = here.far;
        }
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
    if f == pixel_facets[pixel + 1u] || f >= frame.facets_total { return; }
    let span = packed_span(vec4(frame.sample_low, frame.sample_high));
    facets[f] = Facet(pixel, ~id_keys[pixel], STATE_EMPTY, 0.0, vec2(0.0), span);
    for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * f + w] = full_word(w); }
}
