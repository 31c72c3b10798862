// sorted_pairs: from (texel, item) pairs sorted by texel the number of pairs of each texel (Pan 2009, section
// 3.3). Reads the first min(count, limit) of `keys` and `values`. `bounds` adds to `texel_counts`, which must
// be 0: the last pair of a texel adds the place after it, the first subtracts its own. `join` writes `pairs`
// (item, texel).

//@import dispatch

struct SortedPairsParams {
    limit: u32,         // pairs
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> params: SortedPairsParams;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read> values: array<u32>;
@group(0) @binding(4) var<storage, read_write> texel_counts: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> pairs: array<vec2<u32>>;

@compute @workgroup_size(WORKGROUP)
fn bounds(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = flat_invocation(group, groups, WORKGROUP, local);
    let count = min(counts[0], params.limit);
    if i >= count { return; }
    let texel = keys[i];
    if texel >= arrayLength(&texel_counts) { return; }
    if i == 0u || keys[i - 1u] != texel { atomicSub(&texel_counts[texel], i); }
    if i + 1u == count || keys[i + 1u] != texel { atomicAdd(&texel_counts[texel], i + 1u); }
}

@compute @workgroup_size(WORKGROUP)
fn join(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = flat_invocation(group, groups, WORKGROUP, local);
    if i >= min(counts[0], params.limit) { return; }
    pairs[i] = vec2(values[i], keys[i]);
}
