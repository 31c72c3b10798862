// compact: keeps the flagged items of a list, in order.
// Reads `flags` (a word an item, kept if not 0; or, with params.packed, bit i % 32 of word i / 32) of the
// first min(count, limit) items, and `kept_from` (with params.indices the item's own index instead). Writes
// `kept`, never past `capacity`. `count` notes each 32 items as one word of `marks` and its number of bits in
// `mark_counts`; the prefix_scan of those gives `offsets`; `emit` writes each marked item to its place.
// Bounds: an invocation loops 32 times.
//@bindings Lists: count, emit

//@import dispatch

struct CompactParams {
    limit: u32,         // items
    count_word: u32,    // where in `counts` the number of items stands
    capacity: u32,      // items that `kept` can hold
    packed: u32,        // 1: flags are bits
    indices: u32,       // 1: keep indices, not values
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

const WORKGROUP = 64u;
const ITEMS = 32u;      // items a mark

@group(0) @binding(0) var<uniform> params: CompactParams;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> flags: array<u32>;
@group(0) @binding(3) var<storage, read_write> marks: array<u32>;
@group(0) @binding(4) var<storage, read_write> mark_counts: array<u32>;
@group(0) @binding(5) var<storage, read> offsets: array<u32>;
@group(0) @binding(6) var<storage, read> kept_from: array<u32>;
@group(0) @binding(7) var<storage, read_write> kept: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    let first = id * ITEMS;
    if first >= params.limit { return; }
    let end = min(counts[params.count_word], params.limit);
    let here = min(end - min(end, first), ITEMS);
    var mark = 0u;
    if params.packed == 1u {
        if here > 0u { mark = flags[id] & (0xffffffffu >> (ITEMS - here)); }
    } else {
        for (var i = 0u; i < here; i++) {
            mark |= select(0u, 1u << i, flags[first + i] != 0u);
        }
    }
    marks[id] = mark;
    mark_counts[id] = countOneBits(mark);
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id * ITEMS >= params.limit { return; }
    var mark = marks[id];
    for (var at = offsets[id]; mark != 0u && at < params.capacity; at++) {
        let item = id * ITEMS + firstTrailingBit(mark);
        mark &= mark - 1u;
        if params.indices == 1u { kept[at] = item; } else { kept[at] = kept_from[item]; }
    }
}
