// triangle_texel_pairs: lists, texel by texel, the casters that touch a texel with pixel-texel pairs (Pan 2009, section
// 3.3). Two runs of the same entry point around a scan: pass 0 counts into `texel_counts`, pass 1 writes the triangles to
// `pair_triangles` at `pair_offsets`, never beyond the capacity; order inside a texel is not defined.
// Instead of both, `append` lists the pairs as they come: texels in `keys`, triangles in `values`, their number in
// `appended`, to be sorted (the paper's way).
// A caster that lies behind the farthest facet of the texel makes no pair.

//@import frame
//@import dispatch
//@import pass
//@import rect
//@import work_items
//@import conservative
//@import span
//@import append

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(0) @binding(3) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> texel_deepest: array<u32>;
@group(0) @binding(7) var<storage, read_write> texel_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> pair_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> pair_triangles: array<u32>;
@group(0) @binding(10) var<storage, read_write> appended: array<atomic<u32>>;  // pairs appended; not 0 if more than 2^32
@group(0) @binding(11) var<storage, read_write> keys: array<u32>;
@group(0) @binding(12) var<storage, read_write> values: array<u32>;

// The texels of the block, one bit each row by row, that make a pair with triangle `t`.
fn texels_of(t: u32, block: Rect) -> vec2<u32> {
    var texels = vec2(0u);
    let across = (frame.map_size + BLOCK - 1u) / BLOCK;
    let b = (block.low.y >> BLOCK_SHIFT) * across + (block.low.x >> BLOCK_SHIFT);
    if texel_deepest[frame.map_size * frame.map_size + b] == 0u { return texels; }
    let shape = cover_triangle(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]]);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        var cut = span_of(block.low.x, block.high.x);
        if shape.in_front && !shape.thin {
            cut = cut_span(cut_span(cut_span(cut, shape.edges[0], row), shape.edges[1], row), shape.edges[2], row);
        }
        let cells = cells_of(cut, block.low.x, block.high.x);
        for (var x = cells.x; x <= cells.y; x++) {
            let deepest = texel_deepest[y * frame.map_size + x];
            if deepest == 0u { continue; }
            let centre = vec2(f32(x) + 0.5, row);
            if !covers(shape, centre) { continue; }
            if shape.in_front && depth_range(shape, centre).x - frame.depth_margin > bitcast<f32>(deepest - 1u) { continue; }
            add_texel(&texels, vec2(x, y) - block.low);
        }
    }
    return texels;
}

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[t]);
    var texels = texels_of(t, block);
    while any(texels != vec2(0u)) {
        let at = block.low + take_texel(&texels);
        let texel = at.y * frame.map_size + at.x;
        let rank = atomicAdd(&texel_counts[texel], 1u);
        if step.index == 1u {
            let at = pair_offsets[texel] + rank;
            if at < frame.triangle_texel_capacity { pair_triangles[at] = t; }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn append(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[t]);
    var texels = texels_of(t, block);
    var place = room_for(texels);
    while any(texels != vec2(0u)) {
        let at = block.low + take_texel(&texels);
        if place < frame.triangle_texel_capacity {
            keys[place] = at.y * frame.map_size + at.x;
            values[place] = t;
        }
        place++;
    }
}
