// pixel_counts: the work of each pixel in numbers, to be looked at.
// `count_pairs` reads a band's pixel-texel pairs and `count_candidates` its candidates; they add to `counts`
// at the facet's pixel, what was there stays. `count_facets` reads the facets of each pixel, `count_classes`
// the classes that a method keeps behind as many other words; both write the first two words of `counts`, of
// the most demanding facet the class.

//@import frame dispatch facet candidates

override TILE_SHIFT: u32 = 1u;  // 0: a pair names a texel, not a part of a tile
const WORKGROUP = 64u;

struct PixelCounts {
    state: u32,   // class, in rising order of the method's work
    facets: u32,
    texels: atomic<u32>,
    pairs: atomic<u32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> facets: array<Facet>;
@group(0) @binding(2) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(3) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(4) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> candidates: Candidates;
@group(0) @binding(6) var<storage, read> classes: array<u32>;
@group(0) @binding(7) var<storage, read_write> counts: array<PixelCounts>;

@compute @workgroup_size(WORKGROUP)
fn count_pairs(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    let listed = min(atomicLoad(&candidates.tally[TALLY_PAIRS]), frame.pixel_texel_capacity);
    if k >= listed { return; }
    let pair = pairs[k];
    var texels = 1u;
    if TILE_SHIFT != 0u { texels = countOneBits(pair.y & 15u); }
    atomicAdd(&counts[undecided[pair.x].pixel].texels, texels);
}

@compute @workgroup_size(WORKGROUP)
fn count_candidates(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    let listed = min(atomicLoad(&candidates.tally[TALLY_CANDIDATES]), frame.candidate_capacity);
    if k >= listed { return; }
    atomicAdd(&counts[undecided[candidates.list[k].x].pixel].pairs, 1u);
}

@compute @workgroup_size(WORKGROUP)
fn count_facets(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    var found = 0u;
    var most = STATE_EMPTY;
    let end = min(pixel_facets[pixel + 1u], arrayLength(&facets));
    for (var f = pixel_facets[pixel]; f < end; f++) {
        let state = facets[f].state;
        found += select(0u, 1u, state != STATE_EMPTY);
        most = max(most, state);
    }
    counts[pixel].state = most;
    counts[pixel].facets = found;
}

@compute @workgroup_size(WORKGROUP)
fn count_classes(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel >= pixels { return; }
    counts[pixel].state = classes[pixels + pixel];
    counts[pixel].facets = select(0u, 1u, classes[pixels + pixel] != STATE_EMPTY);
}
