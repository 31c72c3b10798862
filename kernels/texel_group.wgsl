// texel_group: brings the values of (key, value) pairs with equal keys together, without sorting.
// Reads the first min(count, limit) of `keys` and of `values` (with params.indices the pair's own index instead); pairs
// whose key is not below `groups` belong nowhere and are left out. Writes `grouped`, never past `capacity`.
// `clear` zeroes the counters; `count` counts each key and keeps the rank its pair drew; the prefix_scan of the counters
// gives `offsets`; `scatter` puts each value at its group's offset plus its rank. The order inside a group is the order
// in which the adapter ran the atomics: the set of values is defined, their order is not.

//@import dispatch

struct Params {
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

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read> values: array<u32>;
@group(0) @binding(4) var<storage, read_write> ranks: array<u32>;
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

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id >= min(counts[params.count_word], params.limit) { return; }
    let key = keys[id];
    if key < params.groups { ranks[id] = atomicAdd(&key_counts[key], 1u); }
}

@compute @workgroup_size(WORKGROUP)
fn scatter(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id >= min(counts[params.count_word], params.limit) { return; }
    let key = keys[id];
    if key >= params.groups { return; }
    let at = offsets[key] + ranks[id];
    if at >= params.capacity { return; }
    if params.indices == 1u { grouped[at] = id; } else { grouped[at] = values[id]; }
}
