// spsm_map, for devices with 64-bit atomics: depth and triangle of a texel are one key, found in one run of
// `raster`.
//@bindings Map: raster, encode

//@import dispatch keys_64 spsm_bindings spsm_raster spsm_encode

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let task = task_of(item);
    var left = may_win(task);
    while any(left != vec2(0u)) {
        let at = task.corner + take_texel(&left);
        raise(at.y * frame.map_size + at.x, key_of(least_at(task.shape, vec2<f32>(at) + 0.5)), task.t);
    }
}
