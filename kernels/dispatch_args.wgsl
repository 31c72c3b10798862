// dispatch_args: turns counts that lie in a buffer into arguments of indirect dispatches.
// Reads `counts` (any words), `requests` (one per dispatch). Writes three words a request to `args`. A count
// over 65,535 groups is folded over two dimensions, so that no dispatch is silently dropped; a request runs
// (min(count, limit) - skip) / per_group groups, rounded up. A request that no two dimensions can hold (over
// 65,535 * 65,535 groups; the host makes none) runs as many as they can.

struct ArgsRequest {
    count_word: u32,   // index into `counts`
    per_group: u32,    // items that one workgroup handles
    limit: u32,        // the list's capacity: counts beyond it are not processed
    args_word: u32,    // where the three words go
    skip: u32,         // items at the beginning that others take
    pad_1: u32,
    pad_2: u32,
    pad_3: u32,
}

override MAX_GROUPS: u32 = 65535u;  // or what the device can, if that is less
const WORKGROUP = 64u;

@group(0) @binding(0) var<storage, read> counts: array<u32>;
@group(0) @binding(1) var<storage, read> requests: array<ArgsRequest>;
@group(0) @binding(2) var<storage, read_write> args: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn fold(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&requests) { return; }
    let request = requests[id.x];
    let all = min(counts[request.count_word], request.limit);
    let items = all - min(all, request.skip);
    var groups = 0u;
    if request.per_group != 0u {
        groups = items / request.per_group + select(0u, 1u, items % request.per_group != 0u);
    }
    groups = min(groups, MAX_GROUPS * MAX_GROUPS);
    var x = groups;
    var y = 1u;
    if groups > MAX_GROUPS {
        y = groups / MAX_GROUPS + select(0u, 1u, groups % MAX_GROUPS != 0u);
        x = groups / y + select(0u, 1u, groups % y != 0u);
    }
    args[request.args_word] = x;
    args[request.args_word + 1u] = y;
    args[request.args_word + 2u] = 1u;
}
