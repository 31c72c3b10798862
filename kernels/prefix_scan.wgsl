// prefix_scan: exclusive scan of u32 values with saturating sums. Reads `input` (values from min(count,
// limit) on count as 0). Writes `output` up to `limit`, the sum of all to `total[total_word]` and 1 to the
// word after it if that sum exceeds u32::MAX (then it is u32::MAX), else 0; with `only_counted` whole
// blocks beyond the count are not written. Three passes: `reduce` sums each block exactly in 64 bits,
// `spine` turns block sums into prefixes in one workgroup, `downsweep` scans each block from its prefix.
// Saturating addition is associative, so the result is one value however the work is split. A list above
// the binding limit is bound in segments of whole blocks: `first` is where the bound range begins, `sums`
// always spans all blocks. Bounds: an invocation of reduce or downsweep loops 32 times, one of the
// spine 2 * blocks / 64 times.

//@import dispatch workgroup_scan

struct PrefixScanParams {
    limit: u32,         // values to scan
    count_word: u32,    // where in `counts` the number of values stands
    first: u32,         // first value of the bound segment
    length: u32,        // values of the bound segment
    first_block: u32,   // block of `first`
    blocks: u32,        // blocks of all segments
    total_word: u32,    // where the sum goes
    only_counted: u32,  // 1: nothing need be written beyond the count
}

const WORKGROUP = 64u;
const SIDE = 8u;                      // SIDE * SIDE = WORKGROUP
const QUADS = 16u;                    // vec4 a thread
const BLOCK = 4096u;                  // WORKGROUP * QUADS * 4
const SPINE_CHUNK = 4u;               // least blocks an invocation
const SATURATED = 0xffffffffu;

@group(0) @binding(0) var<uniform> params: PrefixScanParams;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> input: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> sums: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> output: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> total: array<u32>;

// How many values of the bound segment count.
fn live() -> u32 {
    let count = min(counts[params.count_word], params.limit);
    return min(count - min(count, params.first), params.length);
}

// Four values from `at` on; those from `end` on are 0.
fn load(at: u32, end: u32) -> vec4<u32> {
    if at >= end { return vec4(0u); }
    return select(vec4(0u), input[at / 4u], vec4(at) + vec4(0u, 1u, 2u, 3u) < vec4(end));
}

fn add_saturating(a: u32, b: u32) -> u32 {
    let sum = a + b;
    return select(sum, SATURATED, sum < a);
}

// The sum of four 64-bit sums.
fn across(low: vec4<u32>, high: vec4<u32>) -> vec2<u32> {
    let half = add_wide(vec2(low.x, high.x), vec2(low.y, high.y));
    return add_wide(half, add_wide(vec2(low.z, high.z), vec2(low.w, high.w)));
}

@compute @workgroup_size(WORKGROUP)
fn reduce(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) local: u32) {
    let block = flat_group(group, groups);
    if block * BLOCK >= params.length { return; }
    let end = live();
    var low = vec4(0u);
    var high = vec4(0u);
    if (block + 1u) * BLOCK <= end {
        for (var i = 0u; i < QUADS; i++) {
            let value = input[block * (BLOCK / 4u) + i * WORKGROUP + local];
            low += value;
            high += select(vec4(0u), vec4(1u), low < value);
        }
    } else {
        let quads = select(QUADS, 0u, block * BLOCK >= end);
        for (var i = 0u; i < quads; i++) {
            let value = load(block * BLOCK + (i * WORKGROUP + local) * 4u, end);
            low += value;
            high += select(vec4(0u), vec4(1u), low < value);
        }
    }
    let sum = across(low, high);
    let before = workgroup_exclusive(local, SIDE, WORKGROUP, sum);
    if local == WORKGROUP - 1u { sums[params.first_block + block] = add_wide(before, sum); }
}

// After it `sums[b]` holds block b's exclusive and inclusive prefix, both saturated.
@compute @workgroup_size(WORKGROUP)
fn spine(@builtin(local_invocation_index) local: u32) {
    let chunk = max((params.blocks + WORKGROUP - 1u) / WORKGROUP, SPINE_CHUNK);
    let working = (params.blocks + chunk - 1u) / chunk;
    let begin = min(local * chunk, params.blocks);
    let end = min(begin + chunk, params.blocks);
    var sum = vec2(0u);
    for (var i = begin; i < end; i++) {
        sum = add_wide(sum, sums[i]);
    }
    var prefix = workgroup_exclusive(local, SIDE, working, sum);
    for (var i = begin; i < end; i++) {
        let next = add_wide(prefix, sums[i]);
        sums[i] = vec2(saturated(prefix), saturated(next));
        prefix = next;
    }
    if local + 1u == max(working, 1u) {
        total[params.total_word] = saturated(prefix);
        total[params.total_word + 1u] = select(0u, 1u, prefix.y != 0u);
    }
}

@compute @workgroup_size(WORKGROUP)
fn downsweep(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
             @builtin(local_invocation_index) local: u32) {
    let block = flat_group(group, groups);
    let end = live();
    if block * BLOCK >= select(params.length, end, params.only_counted == 1u) { return; }
    let begin = block * BLOCK + local * QUADS * 4u;
    let bounds = sums[params.first_block + block];
    // A block that saturates inside, or is not full, is rare: only it pays for checks.
    let plain = bounds.y != SATURATED && (block + 1u) * BLOCK <= end;

    var kept: array<vec4<u32>, QUADS>;
    var low = vec4(0u);
    var high = vec4(0u);
    if plain {
        for (var i = 0u; i < QUADS; i++) {
            kept[i] = input[begin / 4u + i];
            low += kept[i];
        }
    } else {
        for (var i = 0u; i < QUADS; i++) {
            kept[i] = load(begin + i * 4u, end);
            low += kept[i];
            high += select(vec4(0u), vec4(1u), low < kept[i]);
        }
    }
    var run = add_saturating(bounds.x,
        saturated(workgroup_exclusive(local, SIDE, WORKGROUP, across(low, high))));

    if plain {
        for (var i = 0u; i < QUADS; i++) {
            let value = kept[i];
            let y = run + value.x;
            let z = y + value.y;
            let w = z + value.z;
            output[begin / 4u + i] = vec4(run, y, z, w);
            run = w + value.w;
        }
        return;
    }
    for (var i = 0u; i < QUADS; i++) {
        let at = begin + i * 4u;
        if at >= params.length { return; }
        var prefix = vec4(run);
        prefix.y = add_saturating(run, kept[i].x);
        prefix.z = add_saturating(prefix.y, kept[i].y);
        prefix.w = add_saturating(prefix.z, kept[i].z);
        run = add_saturating(prefix.w, kept[i].w);
        if at + 4u <= params.length {
            output[at / 4u] = prefix;
        } else {
            output[at / 4u].x = prefix.x;
            if at + 1u < params.length { output[at / 4u].y = prefix.y; }
            if at + 2u < params.length { output[at / 4u].z = prefix.z; }
        }
    }
}
