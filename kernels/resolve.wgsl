// resolve: from masks to visibility (Pan 2009, section 3.4, last paragraphs).
// Reads facets, their masks (coverage, occluded, invalid: WORDS words each) and which facets a pixel has.
// Writes `visibility` (lit share of the samples that count, 1 where nothing is seen) and `lit` (WORDS words a
// pixel: which samples are lit, all of them where nothing is seen). Counts into `status` how many facets each
// state has; with FLAG_CLAMP a pixel without a facet counts as an empty one. Writes the frame's stamp there:
// this stage is the last, so that who reads the stamp knows that the frame has run.
// `seen_samples` writes which samples count instead (`seen`, WORDS words a pixel), for `pixel_filter`.

//@import frame dispatch status facet

override WORDS: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> facets: array<Facet>;
@group(0) @binding(2) var<storage, read> masks: array<u32>;
@group(0) @binding(3) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(4) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(5) var<storage, read_write> lit: array<u32>;
@group(0) @binding(6) var<storage, read_write> status: Status;
@group(0) @binding(7) var<storage, read_write> seen: array<u32>;

var<workgroup> wg_states: array<atomic<u32>, 5>;

@compute @workgroup_size(WORKGROUP)
fn resolve(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel + 1u == pixels { atomicStore(&status.head.finished, frame.stamp); }
    if pixel < pixels {
        var samples = 0u;
        var bright = 0u;
        var words = vec4(0u);
        let end = min(pixel_facets[pixel + 1u], arrayLength(&facets));
        if (frame.flags & FLAG_CLAMP) != 0u && pixel_facets[pixel] >= end {
            atomicAdd(&wg_states[STATE_EMPTY], 1u);
        }
        for (var f = pixel_facets[pixel]; f < end; f++) {
            let state = facets[f].state;
            atomicAdd(&wg_states[state], 1u);
            if state == STATE_EMPTY { continue; }
            for (var w = 0u; w < WORDS; w++) {
                let base = 3u * WORDS * f + w;
                var counted = masks[base];
                var open = counted;
                if state == STATE_DARK || state == STATE_SHADOWED { open = 0u; }
                if state == STATE_UNDECIDED {
                    counted &= ~masks[base + 2u * WORDS];
                    open = counted & ~masks[base + WORDS];
                }
                samples += countOneBits(counted);
                bright += countOneBits(open);
                words[w] |= open;
            }
        }
        visibility[pixel] = select(f32(bright) / f32(samples), 1.0, samples == 0u);
        for (var w = 0u; w < WORDS; w++) {
            lit[WORDS * pixel + w] = select(words[w], 0xffffffffu, samples == 0u);
        }
    }
    workgroupBarrier();
    if local < 5u {
        let n = atomicLoad(&wg_states[local]);
        if n != 0u { atomicAdd(&status.head.facets[local], n); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn seen_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    var words = vec4(0u);
    let end = min(pixel_facets[pixel + 1u], arrayLength(&facets));
    for (var f = pixel_facets[pixel]; f < end; f++) {
        let state = facets[f].state;
        if state == STATE_EMPTY { continue; }
        for (var w = 0u; w < WORDS; w++) {
            let base = 3u * WORDS * f + w;
            let counted = masks[base];
            words[w] |= select(counted, counted & ~masks[base + 2u * WORDS], state == STATE_UNDECIDED);
        }
    }
    for (var w = 0u; w < WORDS; w++) { seen[WORDS * pixel + w] = words[w]; }
}
