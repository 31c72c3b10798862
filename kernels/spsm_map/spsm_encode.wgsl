// Writing the records of the sub-pixel shadow map.

//@import divide dispatch spsm_bindings spsm_raster
//@needs fn held_depth(cell: u32) -> u32;
//@needs fn held_triangle(cell: u32) -> u32;

fn store(texel: u32, record: vec4<u32>) {
    let upper = frame.map_size * upper_rows();
    if SPLIT == 0u || texel < upper {
        upper_records[texel] = record;
    } else {
        lower_records[texel - upper] = record;
    }
}

// The record of a texel.
fn made(texel: u32, centre: vec2<f32>) -> vec4<u32> {
    let t = ~held_triangle(texel);
    if t >= frame.triangle_count {
        if held_depth(texel) != 0u { atomicStore(&seen[SEEN_LOST], 1u); }
        return vec4(0u, 0u, 0u, EMPTY_WORD);
    }
    // Vertices in order of index, so that an edge has one code in both of its triangles.
    var i = triangles[t];
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    let shift = vec3(centre, 0.0);
    if ENCODING == 1u && min(a.w, min(b.w, c.w)) <= 0.0 {
        let part = cut_shape(a, b, c);
        let edges = array(
            line_around(part.edges[0], centre), line_around(part.edges[1], centre),
            line_around(part.edges[2], centre));
        return encode_lines(edges, vec3(part.depth.xy, dot(part.depth, vec3(centre, 1.0))));
    }
    return encode_record(Corners(a.xyz - shift, b.xyz - shift, c.xyz - shift), centre);
}

// One invocation the texels of a word of bits: 8 x 4.
@compute @workgroup_size(WORKGROUP)
fn encode(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word >= seen_words() { return; }
    let block = divided(word >> 1u, (frame.map_size + 7u) >> 3u);
    let corner = vec2(8u * block.y, 8u * block.x + 4u * (word & 1u));
    for (var left = atomicLoad(&seen[run_bits() + word]); left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        let at = corner + vec2(bit & 7u, bit >> 3u);
        if any(at >= vec2(frame.map_size)) { continue; }
        let texel = at.y * frame.map_size + at.x;
        store(texel, made(texel, vec2<f32>(at) + 0.5));
    }
}
