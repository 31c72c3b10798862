// texel_group: brings the values of (key, value) pairs with equal keys together, without sorting.
// Reads the first min(count, limit) of `keys` and of `values` (with params.indices the pair's own index
// instead); pairs whose key is not below `groups` belong nowhere and are left out. Writes `grouped`, never
// past `capacity`. `clear` zeroes the counters; `count` counts each key and keeps the rank its pair drew; the
// prefix_scan of the counters gives `offsets`; `scatter` puts each value at its group's offset plus its rank.
// The order inside a group is the order in which the adapter ran the atomics: the set of values is defined,
// their order is not.
//@bindings Group: count, scatter

//@import dispatch

struct TexelGroupParams {
    limit: u32,         // pairs
    count_word: u32,    // where in `counts` the number of pairs stands
    groups: u32,        // keys are below it
    capacity: u32,      // values that `grouped` can hold
    indices: u32,       // 1: group indices, not values
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

const WORKGROUP = 64u;
const CLEARED = 16u;            // words that an invocation clears
const QUAD = 4u;                // pairs that an invocation handles

@group(0) @binding(0) var<uniform> params: TexelGroupParams;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> values: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> ranks: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> key_counts: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> cleared: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> grouped: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn clear(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let first = flat_group(group, groups) * WORKGROUP * CLEARED / 4u + local;
    for (var i = 0u; i < CLEARED / 4u; i++) {
        let at = first + i * WORKGROUP;
        if at < arrayLength(&cleared) { cleared[at] = vec4(0u); }
    }
}

// Which of the four pairs from `first` on exist and belong to a group.
fn belonging(first: u32, key: vec4<u32>) -> vec4<bool> {
    let end = min(counts[params.count_word], params.limit);
    return (vec4(first) + vec4(0u, 1u, 2u, 3u) < vec4(end)) & (key < vec4(params.groups));
}

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id * QUAD >= params.limit { return; }
    let key = keys[id];
    let belongs = belonging(id * QUAD, key);
    var rank = vec4(0u);
    if belongs.x { rank.x = atomicAdd(&key_counts[key.x], 1u); }
    if belongs.y { rank.y = atomicAdd(&key_counts[key.y], 1u); }
    if belongs.z { rank.z = atomicAdd(&key_counts[key.z], 1u); }
    if belongs.w { rank.w = atomicAdd(&key_counts[key.w], 1u); }
    ranks[id] = rank;
}

fn place(belongs: bool, key: u32, rank: u32, value: u32) {
    if !belongs { return; }
    let at = offsets[key] + rank;
    if at < params.capacity { grouped[at] = value; }
}

@compute @workgroup_size(WORKGROUP)
fn scatter(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id * QUAD >= params.limit { return; }
    let key = keys[id];
    let belongs = belonging(id * QUAD, key);
    let rank = ranks[id];
    var value = vec4(id * QUAD) + vec4(0u, 1u, 2u, 3u);
    if params.indices == 0u { value = values[id]; }
    place(belongs.x, key.x, rank.x, value.x);
    place(belongs.y, key.y, rank.y, value.y);
    place(belongs.z, key.z, rank.z, value.z);
    place(belongs.w, key.w, rank.w, value.w);
}
