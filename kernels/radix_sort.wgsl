// radix_sort: one pass of a stable least-significant-digit sort of (key, value) pairs.
// Reads the first min(count, limit) of `keys_in` and `values_in`. Writes them to `keys_out` and `values_out`,
// ordered by the digit (key >> shift) & (bins - 1), equal digits in their old order. `count` writes each
// block's histogram (bin-major); the prefix_scan of it gives `offsets`; `scatter` places each pair. An
// invocation owns 64 consecutive pairs and a column of 16-bit counters, two bins to a word: the order of the
// pairs needs neither atomics nor subgroups. A counter is at most 4,096 in a block, so halves never carry
// into each other. Bounds: an invocation loops at most 64 times in each of three loops.
//@bindings Digits: count, scatter

//@import dispatch

struct RadixSortParams {
    limit: u32,         // pairs
    count_word: u32,    // where in `counts` the number of pairs stands
    shift: u32,         // lowest bit of the digit
    bins: u32,          // values of the digit
    blocks: u32,        // blocks of `limit` pairs
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

const WORKGROUP = 64u;
const PAIRS = 64u;              // pairs a thread
const BLOCK = 4096u;            // WORKGROUP * PAIRS
const DIGIT_BITS = 6u;          // most bits of a digit
const MAX_BINS = 64u;
const COLUMN = 65u;             // WORKGROUP + 1, so that a scan along it meets all memory banks

@group(0) @binding(0) var<uniform> params: RadixSortParams;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> keys_in: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> values_in: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> histogram: array<u32>;
@group(0) @binding(5) var<storage, read> offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys_out: array<u32>;
@group(0) @binding(7) var<storage, read_write> values_out: array<u32>;

var<workgroup> wg_counters: array<u32, 2080>;   // COLUMN * MAX_BINS / 2, zero at first
var<workgroup> wg_bases: array<u32, 64>;

fn digit(key: u32) -> u32 {
    return (key >> params.shift) & (params.bins - 1u);
}

fn bump(local: u32, key: u32) {
    let bin = digit(key);
    wg_counters[bin / 2u * COLUMN + local] += 1u << (bin % 2u * 16u);
}

// Counts an invocation's pairs by digit.
fn tally(local: u32, begin: u32, end: u32) {
    for (var at = begin; at < end; at += 4u) {
        let key = keys_in[at / 4u];
        bump(local, key.x);
        if at + 1u < end { bump(local, key.y); }
        if at + 2u < end { bump(local, key.z); }
        if at + 3u < end { bump(local, key.w); }
    }
}

// Writes a pair to the next place of its digit.
fn place(local: u32, key: u32, value: u32) {
    let bin = digit(key);
    let half = bin % 2u * 16u;
    let slot = bin / 2u * COLUMN + local;
    let counter = wg_counters[slot];
    wg_counters[slot] = counter + (1u << half);
    let at = wg_bases[bin] + ((counter >> half) & 0xffffu);
    keys_out[at] = key;
    values_out[at] = value;
}

// The pairs of an invocation: from x (a multiple of 4) on, up to y.
fn own_pairs(block: u32, local: u32) -> vec2<u32> {
    let begin = block * BLOCK + local * PAIRS;
    return vec2(begin, min(begin + PAIRS, min(counts[params.count_word], params.limit)));
}

@compute @workgroup_size(WORKGROUP)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let block = flat_group(group, groups);
    if block >= params.blocks { return; }
    let own = own_pairs(block, local);
    tally(local, own.x, own.y);
    workgroupBarrier();
    let bin = local * 2u;
    if bin >= params.bins { return; }
    var sum = 0u;
    for (var i = 0u; i < WORKGROUP; i++) {
        sum += wg_counters[local * COLUMN + i];
    }
    histogram[bin * params.blocks + block] = sum & 0xffffu;
    if bin + 1u < params.bins { histogram[(bin + 1u) * params.blocks + block] = sum >> 16u; }
}

@compute @workgroup_size(WORKGROUP)
fn scatter(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) local: u32) {
    let block = flat_group(group, groups);
    if block >= params.blocks { return; }
    let own = own_pairs(block, local);
    if local < params.bins { wg_bases[local] = offsets[local * params.blocks + block]; }
    tally(local, own.x, own.y);
    workgroupBarrier();
    // Turn each bin's counts into the number of its pairs before each invocation.
    if local * 2u < params.bins {
        var before = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            let counted = wg_counters[local * COLUMN + i];
            wg_counters[local * COLUMN + i] = before;
            before += counted;
        }
    }
    workgroupBarrier();
    for (var at = own.x; at < own.y; at += 4u) {
        let key = keys_in[at / 4u];
        let value = values_in[at / 4u];
        place(local, key.x, value.x);
        if at + 1u < own.y { place(local, key.y, value.y); }
        if at + 2u < own.y { place(local, key.z, value.z); }
        if at + 3u < own.y { place(local, key.w, value.w); }
    }
}
