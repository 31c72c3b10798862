// spsm_map: the sub-pixel shadow map (Lecocq 2013, sections 3.2 and 3.3): of each texel the closest triangle that touches it.
// `raster` finds over the casters' 8 x 8 blocks of texels the least depth that any triangle's plane has over each texel
// (conservative), and lists in `won` each block in which its triangle was nearest when it came, with the texels where it was.
// `choose` goes through that list alone and finds the lowest triangle index at the least depth. `encode` writes the record of
// each texel, and says if one has a depth but no triangle: the list was too short, or `choose`, which is compiled for itself,
// rounds otherwise than `raster`. Then `again` has `raster` run once more over all blocks, and `encode` over all texels.
// A triangle that is not wholly in front of the light is left out.

//@import frame
//@import dispatch
//@import pass
//@import rect
//@import work_items
//@import conservative
//@import span
//@import spsm_record

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
const WORKGROUP = 64u;
const LIFT = 2.0;   // times its own range of depths by which a triangle may count as nearer than it is

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> depth_keys: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> id_keys: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> upper_records: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read_write> lower_records: array<vec4<u32>>;
@group(0) @binding(11) var<storage, read_write> won: array<vec4<u32>>;              // triangle, block, texels of it
@group(0) @binding(12) var<storage, read_write> won_counts: array<atomic<u32>, 4>;  // blocks won, to be chosen from, to run again; not 0: a triangle is missing

// Least depth of the plane over the texel as a key that falls with it, whatever its sign. The plane of a triangle that is
// almost edge-on is nearest: it is at the border of what it belongs to, and the texel shall hold the border. LIFT keeps what
// is far behind from coming before what hides it.
fn key_at(shape: Cover, centre: vec2<f32>) -> u32 {
    let least = dot(shape.depth, vec3(centre, 1.0)) - shape.half_range;
    let first = shape.nearest - LIFT * (shape.farthest - shape.nearest);
    let bits = bitcast<u32>(select(max(least, first), first, shape.thin));
    return select(bits, ~(bits | 0x80000000u), (bits >> 31u) == 0u);
}

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[t]);
    let shape = cover_triangle_by(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]], place_noise());
    if !shape.in_front { return; }
    var bits = vec2(0u);
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        var cut = span_of(block.low.x, block.high.x);
        if !shape.thin {
            cut = cut_span(cut_span(cut_span(cut, shape.edges[0], row), shape.edges[1], row), shape.edges[2], row);
        }
        let cells = cells_of(cut, block.low.x, block.high.x);
        for (var x = cells.x; x <= cells.y; x++) {
            let centre = vec2(f32(x) + 0.5, row);
            if !covers(shape, centre) { continue; }
            let key = key_at(shape, centre);
            let texel = y * frame.map_size + x;
            if step.index == 0u {
                let held = atomicLoad(&depth_keys[texel]);
                if held < key { atomicMax(&depth_keys[texel], key); }
                // Another of the same depth may have a lower index.
                if held <= key { bits |= texel_bit(x, y); }
            } else if atomicLoad(&depth_keys[texel]) == key {
                atomicMax(&id_keys[texel], ~t);
            }
        }
    }
    if any(bits != vec2(0u)) {
        let slot = atomicAdd(&won_counts[0], 1u);
        if slot < arrayLength(&won) {
            won[slot] = vec4(t, (block.low.x >> BLOCK_SHIFT) | ((block.low.y >> BLOCK_SHIFT) << 16u), bits);
        }
    }
}

// A texel of a block as one of 64 bits.
fn texel_bit(x: u32, y: u32) -> vec2<u32> {
    let bit = 1u << (8u * (y & 3u) + (x & 7u));
    return select(vec2(bit, 0u), vec2(0u, bit), (y & 4u) != 0u);
}

// The won blocks, if all are listed.
@compute @workgroup_size(1)
fn divide() {
    let blocks = atomicLoad(&won_counts[0]);
    atomicStore(&won_counts[1], select(0u, blocks, blocks <= arrayLength(&won)));
    atomicStore(&won_counts[2], 0u);
}

// All blocks and all texels, if any texel lacks its triangle.
@compute @workgroup_size(1)
fn again() {
    if atomicLoad(&won_counts[3]) == 0u {
        atomicStore(&won_counts[1], 0u);
        return;
    }
    atomicStore(&won_counts[1], frame.map_size * frame.map_size);
    atomicStore(&won_counts[2], work_offsets[frame.triangle_count]);
}

@compute @workgroup_size(WORKGROUP)
fn choose(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= atomicLoad(&won_counts[1]) { return; }
    let block = won[item];
    let t = block.x;
    let corner = vec2(block.y & 0xffffu, block.y >> 16u) << vec2(BLOCK_SHIFT);
    let shape = cover_triangle_by(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]], place_noise());
    var left = block.zw;
    while any(left != vec2(0u)) {
        let low = left.x != 0u;
        let bit = firstTrailingBit(select(left.y, left.x, low));
        left = select(vec2(0u, left.y & (left.y - 1u)), vec2(left.x & (left.x - 1u), left.y), low);
        let at = corner + vec2(bit & 7u, (bit >> 3u) + select(4u, 0u, low));
        let texel = at.y * frame.map_size + at.x;
        if atomicLoad(&depth_keys[texel]) == key_at(shape, vec2<f32>(at) + 0.5) { atomicMax(&id_keys[texel], ~t); }
    }
}

fn store(texel: u32, record: vec4<u32>) {
    let upper = frame.map_size * upper_rows();
    if SPLIT == 0u || texel < upper { upper_records[texel] = record; } else { lower_records[texel - upper] = record; }
}

@compute @workgroup_size(WORKGROUP)
fn encode(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let texel = flat_invocation(group, groups, WORKGROUP, local);
    if texel >= frame.map_size * frame.map_size { return; }
    let t = ~atomicLoad(&id_keys[texel]);
    if t >= frame.triangle_count {
        if atomicLoad(&depth_keys[texel]) != 0u { atomicStore(&won_counts[3], 1u); }
        store(texel, vec4(0u, 0u, 0u, EMPTY_WORD));
        return;
    }
    // Vertices in order of index, so that an edge has one code in both of its triangles.
    var i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let centre = vec2<f32>(divided(texel, frame.map_size).yx) + 0.5;
    let shift = vec3(centre, 0.0);
    let corners = Corners(map_points[i.x].xyz - shift, map_points[i.y].xyz - shift, map_points[i.z].xyz - shift);
    store(texel, encode_record(corners, centre));
}
