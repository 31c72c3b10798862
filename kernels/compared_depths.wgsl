// compared_depths: the depth by which each texel of a shadow map is compared, from its two nearest: half way
// between them (MIDPOINT: Woo 1992), the second (SECOND: Wang and Molnar 1994), or half way, but no more than
// FARTHEST beyond the nearest (DUAL: Weiskopf and Ertl 2003). By the first two a texel without a second depth
// shadows nothing. Reads `second_keys`; changes `nearest_keys` in place. Keys are complements of the bits of
// a depth, 0 where nothing shadows.

//@import frame dispatch front_split

const MIDPOINT = 0u;
const SECOND = 1u;
const DUAL = 2u;
override RULE: u32 = MIDPOINT;
override FARTHEST: f32 = 0.0;  // depth
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> second_keys: array<u32>;
@group(0) @binding(2) var<storage, read_write> nearest_keys: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let texel = flat_invocation(group, groups, WORKGROUP, local);
    if texel >= frame.map_size * frame.map_size { return; }
    let nearest = nearest_keys[texel];
    let second = second_keys[texel];
    if nearest == 0u { return; }
    let split = split_depth(nearest, second);
    var key = second;
    if RULE == MIDPOINT { key = select(key_of_depth(split), 0u, second == 0u); }
    if RULE == DUAL { key = key_of_depth(min(split, depth_of_key(nearest) + FARTHEST)); }
    nearest_keys[texel] = key;
}
