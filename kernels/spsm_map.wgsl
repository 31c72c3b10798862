// spsm_map: the sub-pixel shadow map (Lecocq 2013, sections 3.2 and 3.3): of each texel the closest triangle
// that touches it. Only texels that are asked for (`seen`, see seen_texels) are made. `raster` finds over the
// casters' 8 x 8 blocks of texels the least depth that any triangle's plane has over each texel
// (conservative), and the lowest triangle index at it. `encode` writes the record of each texel. Atomics of
// 32 bits find the depth alone in that run: it lists in `won` each block in which its triangle was nearest
// when it came, with the texels where it was. `choose` goes through that list and finds the triangles.
// `encode` says if a texel has a depth but no triangle: the list was too short, or `choose`, which is
// compiled for itself, rounds otherwise than `raster`. Then `again` has `raster` run once more over all
// blocks, and `encode` over all texels. Of a triangle that is not wholly in front of the light the part that
// is counts; ENCODING 0, which keeps corners, leaves it out.
//@bindings Map: raster, encode, divide, choose, again

//@import dispatch keys spsm_bindings spsm_raster spsm_encode

@group(0) @binding(11) var<storage, read_write> won: array<vec4<u32>>;  // triangle, block, texels of it

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let second = (step.index & PASS_AGAIN) != 0u;
    let task = task_of(item);
    let bits = may_win(task);
    var left = bits;
    while any(left != vec2(0u)) {
        let at = task.corner + take_texel(&left);
        raise(at.y * frame.map_size + at.x, key_of(least_at(task.shape, vec2<f32>(at) + 0.5)), task.t,
            second);
    }
    if !second && any(bits != vec2(0u)) {
        let slot = atomicAdd(&seen[SEEN_WON], 1u);
        if slot < arrayLength(&won) {
            let block = task.corner >> vec2(BLOCK_SHIFT);
            won[slot] = vec4(task.t, block.x | (block.y << 16u), bits);
        }
    }
}

// The blocks won in this run, if all are listed.
@compute @workgroup_size(1)
fn divide() {
    let blocks = atomicLoad(&seen[SEEN_WON]);
    let first = atomicLoad(&seen[SEEN_BASE + 1u]);
    atomicStore(&seen[SEEN_BASE], first);
    atomicStore(&seen[SEEN_BASE + 1u], blocks);
    atomicStore(&seen[SEEN_CHOSEN], select(0u, blocks - first, blocks <= arrayLength(&won)));
    atomicStore(&seen[SEEN_AGAIN], 0u);
}

// All blocks and all texels, if any texel lacks its triangle.
@compute @workgroup_size(1)
fn again() {
    if atomicLoad(&seen[SEEN_LOST]) == 0u {
        atomicStore(&seen[SEEN_CHOSEN], 0u);
        return;
    }
    atomicStore(&seen[SEEN_CHOSEN], seen_words());
    atomicStore(&seen[SEEN_AGAIN], work_offsets[frame.triangle_count]);
}

@compute @workgroup_size(WORKGROUP)
fn choose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= atomicLoad(&seen[SEEN_CHOSEN]) { return; }
    let block = won[atomicLoad(&seen[SEEN_BASE]) + item];
    let t = block.x;
    let corner = vec2(block.y & 0xffffu, block.y >> 16u) << vec2(BLOCK_SHIFT);
    let shape = cover_of(t);
    var left = block.zw;
    var nearest = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let at = corner + place;
        let texel = at.y * frame.map_size + at.x;
        if held_depth(texel) == key_of(least_at(shape, vec2<f32>(at) + 0.5)) { add_texel(&nearest, place); }
    }
    while any(nearest != vec2(0u)) {
        let at = corner + take_texel(&nearest);
        let texel = at.y * frame.map_size + at.x;
        raise(texel, held_depth(texel), t, true);
    }
}
