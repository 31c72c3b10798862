// Flattens a dispatch that the host (gpu::recorder::fold) or `dispatch_args` folded over two dimensions.

fn flat_group(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return group.y * groups.x + group.x;
}

fn flat_invocation(group: vec3<u32>, groups: vec3<u32>, size: u32, local: u32) -> u32 {
    return flat_group(group, groups) * size + local;
}
