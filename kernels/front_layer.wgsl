// front_layer: proves, texel by texel, that the nearest layer is one sheet that covers the texel and nothing
// crosses. `check` marks in `mask` every texel that a caster touches (conservatively) without a layer at its
// centre, or with two at the nearest depth, or touches at a depth interval that holds the texel's split
// depth: of the others no sheet leads from the front group to the back one. So does every texel that one
// touches which is not wholly in front of the light, but does not surely cover. Triangles that are no casters
// (FLAG_CULL_BACK) are left out, as in light_layers; of an alpha-tested one, which is in no layer, only the
// split depth counts behind which it lies whole. `settle` turns layers and mask into `splits` (see
// front_split), after silhouette_mask has marked the edges. Together: a texel left unmarked has no silhouette
// edge before its split depth, one layer there at its centre, and no triangle across the split, so one sheet
// covers all of it.

//@import frame dispatch work_items front_split cover_cells mask_rows facing

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<storage, read> second_keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> mask: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> splits: array<f32>;
@group(0) @binding(9) var<storage, read> facing: array<u32>;

//@import frame_copy

@compute @workgroup_size(WORKGROUP)
fn check(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[slot]);
    let i = triangles[t];
    if is_culled(frame.flags, i.w, facing[t]) { return; }
    // A triangle with holes is no sheet behind which all is in shadow.
    let tested = is_tested(i.w);
    let shape = cover_triangle(map_points[i.x], map_points[i.y], map_points[i.z]);
    let corner = block.low & vec2(~7u);
    var left = cover_cells(shape, block, 0xffu);
    var marks = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let cell = corner + place;
        let centre = vec2<f32>(cell) + 0.5;
        if !covers(shape, centre) { continue; }
        let texel = cell.y * frame.map_size + cell.x;
        let first = nearest_keys[texel];
        let second = second_keys[texel];
        let split = split_depth(first, second);
        let range = depth_range(shape, centre);
        let parted = (range.x > split) | ((range.y < split) & !tested);
        let open = shape.cut && ((frame.flags & FLAG_CUT_LAYERS) == 0u || !holds(shape, centre, 1.0));
        if (first == 0u) | (first == second) | open | !parted { add_texel(&marks, place); }
    }
    mark_rows(corner, marks);
}

@compute @workgroup_size(WORKGROUP)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let texel = flat_invocation(group, groups, WORKGROUP, local);
    if texel >= frame.map_size * frame.map_size { return; }
    let x = texel % frame.map_size;
    let y = texel / frame.map_size;
    let word = atomicLoad(&mask[y * ((frame.map_size + 31u) / 32u) + x / 32u]);
    let first = nearest_keys[texel];
    var split = UNCOVERED;
    if (word & (1u << (x % 32u))) != 0u {
        split = MARKED;
    } else if first != 0u {
        split = split_depth(first, second_keys[texel]);
    }
    splits[texel] = split;
}
