// pixel_coverage: which samples of its pixel each listed triangle covers (pixel_triangles), and bounds of its
// depth there. `cover` runs an invocation for each pair of pixel and triangle. A mask has the samples whose
// rays meet the triangle, its edges included, beyond the near distance and where it is solid. Bounds of edge
// functions tell of most samples; the others are computed from the corners, the near distance with 46 bits
// where single precision leaves it open. What covers any sample is appended to the list of its pixel, which
// begins where that of all its triangles does: `pixel_counts` (0 before) counts, order inside a pixel is not
// defined, `covering_masks` has WORDS words for each element of `coverings`. Pairs that stand in the list of
// another pixel are passed over (surface_receivers).

//@import frame dispatch pixel_ray facing facing_46 double_float eye_edges eye_order_46 eye_view alpha vertex
//@import pixel_pair covering word_masks

override WORDS: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> samples_given: array<vec4<f32>, 64>;  // two offsets from the centre each
@group(0) @binding(2) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(5) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> pixel_list: array<PixelPair>;
@group(0) @binding(7) var<storage, read_write> pixel_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> coverings: array<Covering>;
@group(0) @binding(9) var<storage, read_write> covering_masks: array<u32>;

//@import frame_copy sample_copy covered_samples

@compute @workgroup_size(WORKGROUP)
fn cover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    take_samples();
    let n = flat_invocation(group, groups, WORKGROUP, local);
    let total = pixel_offsets[frame.image_size.x * frame.image_size.y];
    if n >= min(total, frame.pixel_triangle_capacity) { return; }
    let pair = pixel_list[n];
    // Where fewer were written than counted (`emit_rest` of pixel_triangles), an older frame's stands here.
    let first = pixel_offsets[pair.pixel];
    if n < first || n >= pixel_offsets[pair.pixel + 1u] { return; }
    let corners = corners_at(triangles[pair.triangle].xyz);
    let view = view_of(corners, pixel_ray(pair.pixel));
    let mask = covered_samples(pair, corners, view);
    if all(mask == vec4(0u)) { return; }
    let at = first + atomicAdd(&pixel_counts[pair.pixel], 1u);
    let depth = depth_bounds(view);
    coverings[at] = Covering(pair.triangle, depth.x, depth.y, depth.z, depth.w);
    for (var w = 0u; w < WORDS; w++) { covering_masks[at * WORDS + w] = mask[w]; }
}
