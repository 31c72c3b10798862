// Scan over the invocations of a workgroup, in exact 64-bit sums (x = low word, y = high word). `side` *
// `side` is the workgroup size, at most 64. Two levels of `side` serial steps and two barriers, because a
// barrier costs more than a handful of reads of workgroup memory, on CPU adapters most of all.

var<workgroup> wg_values: array<vec2<u32>, 64>;
var<workgroup> wg_rows: array<vec2<u32>, 8>;

fn add_wide(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2(low, a.y + b.y + select(0u, 1u, low < a.x));
}

// A 64-bit sum as u32, u32::MAX where it does not fit.
fn saturated(wide: vec2<u32>) -> u32 {
    return select(wide.x, 0xffffffffu, wide.y != 0u);
}

// The sum of `value` over the invocations before `local`, for the first `working` invocations; the others get
// 0 and their values do not count. Every invocation of the workgroup must call it.
fn workgroup_exclusive(local: u32, side: u32, working: u32, value: vec2<u32>) -> vec2<u32> {
    let row = local / side;
    wg_values[local] = value;
    workgroupBarrier();
    if local * side < working {
        var sum = vec2(0u);
        for (var i = local * side; i < min(local * side + side, working); i++) {
            sum = add_wide(sum, wg_values[i]);
        }
        wg_rows[local] = sum;
    }
    workgroupBarrier();
    var before = vec2(0u);
    if local < working {
        for (var i = 0u; i < row; i++) {
            before = add_wide(before, wg_rows[i]);
        }
        for (var i = row * side; i < local; i++) {
            before = add_wide(before, wg_values[i]);
        }
    }
    return before;
}
