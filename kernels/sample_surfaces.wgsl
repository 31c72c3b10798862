// sample_surfaces: which surface each sample sees, and the facets made of that: one for every triangle that samples of the
// pixel see, with the mask of those samples.
// `nearest` runs an invocation for each word of samples of a complex pixel over ROUND_LENGTH triangles of its list, from `round` on, and keeps for
// each sample the nearest, of equally near ones the lowest (`sample_ids`). A sample that a linear edge function cannot place
// is looked at from the nearer end of each edge; depths are compared by bounds, and computed where bounds overlap.
// `group_samples` counts the triangles that the samples of a complex pixel see into `facet_counts`; `emit` lists them at
// `pixel_facets`, in the order of their first samples. `emit_single` lists the facets of single pixels, and makes what
// lies beyond the last facet empty. Nothing is written beyond the capacities. `id_keys` takes the complement of the
// triangle at the pixel centre, which is sample 0; it must be 0 before.

//@import frame
//@import dispatch
//@import pass
//@import facet
//@import facing
//@import eye_edges

override WORDS: u32 = 1u;
const WORKGROUP = 32u;       // one lane for each sample of a word
const GROUP_NEAREST = 64u;
const GROUP_SINGLE = 64u;
const ROUND_LENGTH = 512u;
const DEPTH_SLACK = 0.00001;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> step: Pass;                     // the round
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> pixel_list: array<u32>;
@group(0) @binding(7) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(8) var<storage, read> complex_total: array<u32>;
@group(0) @binding(10) var<storage, read_write> sample_ids: array<u32>;
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

fn slot_count() -> u32 {
    return min(complex_total[0], frame.complex_capacity);
}

// A triangle as the rays of one pixel see it.
struct View {
    edges: array<vec4<f32>, 3>,  // at the pixel centre, per pixel right and down, and doubt
    over: vec3<f32>,             // normal . ray likewise, positive where the plane is met before the eye's horizon
    over_doubt: f32,
    distance: f32,
    distance_doubt: f32,
    nearest: f32,
    farthest: f32,
}

fn view_of(i: vec3<u32>, centre: vec3<f32>) -> View {
    var s: View;
    s.edges[0] = eye_edge(i.x, i.y, centre);
    s.edges[1] = eye_edge(i.y, i.z, centre);
    s.edges[2] = eye_edge(i.z, i.x, centre);
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    let normal = cross(b - a, c - a);
    // Rounding of the normal, of the corners themselves, and of the products with a ray of the pixel.
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 2e-6 * largest(b - a) * largest(c - a) + 6e-7 * reach * (largest(b - a) + largest(c - a));
    let distance = dot(normal, a);
    let turn = sign(distance);
    s.over = turn * vec3(dot(normal, centre), dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz));
    s.over_doubt = 2.0 * doubt * largest(centre);
    s.distance = abs(distance);
    s.distance_doubt = doubt * reach;
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    s.nearest = min(depths.x, min(depths.y, depths.z));
    s.farthest = max(depths.x, max(depths.y, depths.z));
    return s;
}

// Nearest and farthest that `eye_depth` may say at a ray with this value of `over`.
fn depth_bounds(s: View, over: f32) -> vec2<f32> {
    var near = s.nearest;
    var far = s.farthest;
    let most = over + s.over_doubt;
    let least = over - s.over_doubt;
    if most > 0.0 && s.distance > s.distance_doubt { near = max(near, (s.distance - s.distance_doubt) / most * (1.0 - DEPTH_SLACK)); }
    if least > 0.0 { far = min(far, (s.distance + s.distance_doubt) / least * (1.0 + DEPTH_SLACK)); }
    return vec2(near - DEPTH_SLACK * abs(near), far + DEPTH_SLACK * abs(far));
}

// What is known of each sample of a word: its triangle, and bounds of its depth.
var<private> best_ids: array<u32, 32>;
var<private> best_near: array<f32, 32>;
var<private> best_far: array<f32, 32>;

fn corners_of(t: u32) -> vec3<u32> {
    return vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
}

// Takes in that triangle `t`, of corners `i`, may be what sample `k` of a word sees; `offset` is the sample's.
// What is rare stands in a loop of one turn: CPU adapters jump over a loop, but not over a branch.
fn consider(k: u32, offset: vec2<f32>, t: u32, i: vec3<u32>, s: View, unsure: bool, pixel: u32) {
    var bounds = depth_bounds(s, s.over.x + offset.x * s.over.y + offset.y * s.over.z);
    var stays = bounds.x <= best_far[k];
    // Too near to tell, to what is known or to the near plane.
    let open = !(bounds.x >= frame.forward.w && bounds.y < best_near[k]);
    for (var look = stays && (unsure || open); look; look = false) {
        let ray = ray_at(pixel, offset);
        if unsure {
            let v = vec3(eye_edge_near(i.x, i.y, ray), eye_edge_near(i.y, i.z, ray), eye_edge_near(i.z, i.x, ray));
            stays = all(v >= vec3(0.0)) || all(v <= vec3(0.0));
        }
        if !stays || !open { continue; }
        bounds = vec2(eye_depth(i, ray));
        stays = bounds.x >= frame.forward.w;
        let other = best_ids[k];
        if !stays || other == NO_TRIANGLE { continue; }
        if best_near[k] != best_far[k] { best_near[k] = eye_depth(corners_of(other), ray); }
        best_far[k] = best_near[k];
        stays = bounds.x < best_far[k] || (bounds.x == best_far[k] && t < other);
    }
    if stays {
        best_ids[k] = t;
        best_near[k] = bounds.x;
        best_far[k] = bounds.y;
    }
}

fn look_at(t: u32, word: u32, count: u32, pixel: u32, centre: vec3<f32>) {
    let i = corners_of(t);
    let s = view_of(i, centre);
    let at = vec3(s.edges[0].x, s.edges[1].x, s.edges[2].x);
    let ax = vec3(s.edges[0].y, s.edges[1].y, s.edges[2].y);
    let ay = vec3(s.edges[0].z, s.edges[1].z, s.edges[2].z);
    let doubt = vec3(s.edges[0].w, s.edges[1].w, s.edges[2].w);
    var inside = 0u;
    var unsure = 0u;
    for (var p = 0u; p < (count + 1u) / 2u; p++) {
        let pair = samples[16u * word + p];
        let v = at + pair.x * ax + pair.y * ay;
        let w = at + pair.z * ax + pair.w * ay;
        inside |= select(1u, 0u, any(v > doubt) && any(v < -doubt)) << (2u * p);
        inside |= select(2u, 0u, any(w > doubt) && any(w < -doubt)) << (2u * p);
        unsure |= select(0u, 1u, any(abs(v) <= doubt)) << (2u * p);
        unsure |= select(0u, 2u, any(abs(w) <= doubt)) << (2u * p);
    }
    inside &= select((1u << count) - 1u, 0xffffffffu, count == 32u);
    while inside != 0u {
        let k = firstTrailingBit(inside);
        inside &= inside - 1u;
        consider(k, sample_offset(32u * word + k), t, i, s, ((unsure >> k) & 1u) != 0u, pixel);
    }
}

@compute @workgroup_size(GROUP_NEAREST)
fn nearest(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, GROUP_NEAREST, local);
    let slot = item / WORDS;
    let word = item % WORDS;
    if slot >= slot_count() { return; }
    let pixel = complex_pixels[slot];
    let centre = pixel_ray(pixel);
    let first = pixel_offsets[pixel] + step.index * ROUND_LENGTH;
    let end = min(min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity), first + ROUND_LENGTH);
    if step.index != 0u && first >= end { return; }
    let base = 32u * item;
    let count = min(frame.sample_count - 32u * word, 32u);
    for (var k = 0u; k < 32u; k++) {
        best_ids[k] = NO_TRIANGLE;
        best_near[k] = 3.0e38;
        best_far[k] = 3.0e38;
        if step.index == 0u || k >= count { continue; }
        let t = sample_ids[base + k];
        if t == NO_TRIANGLE { continue; }
        best_ids[k] = t;
        best_near[k] = eye_depth(corners_of(t), ray_at(pixel, sample_offset(32u * word + k)));
        best_far[k] = best_near[k];
    }
    for (var n = first; n < end; n++) { look_at(pixel_list[n], word, count, pixel, centre); }
    for (var k = 0u; k < 32u; k++) { sample_ids[base + k] = best_ids[k]; }
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
    facet_counts[complex_pixels[slot]] = count;
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = flat_group(group, groups);
    if slot >= slot_count() { return; }
    let pixel = complex_pixels[slot];
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

fn full_word(word: u32) -> u32 {
    let left = frame.sample_count - 32u * word;
    return select((1u << left) - 1u, 0xffffffffu, left >= 32u);
}

@compute @workgroup_size(GROUP_SINGLE)
fn emit_single(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let pixel = flat_invocation(group, groups, GROUP_SINGLE, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if pixel >= pixel_facets[pixels] && pixel < frame.facets_total { facets[pixel].triangle = NO_TRIANGLE; }
    if pixel >= pixels || complex_flags[pixel] != 0u { return; }
    let f = pixel_facets[pixel];
    let entry = pixel_offsets[pixel];
    if f == pixel_facets[pixel + 1u] || f >= frame.facets_total || entry >= frame.pixel_triangle_capacity { return; }
    let t = pixel_list[entry];
    facets[f].pixel = pixel;
    facets[f].triangle = t;
    facets[f].origin = vec2(0.0);
    for (var w = 0u; w < WORDS; w++) { masks[3u * WORDS * f + w] = full_word(w); }
    id_keys[pixel] = ~t;
}
