// page_refinement: a shadow map made finer page by page for as long as that changes what pixels see (queried
// virtual shadow maps: Giegl, Wimmer 2007), in rounds of one level of the tree each, `step.index`, from level
// FIRST on, of which all pages are made. `ask` takes on a pixel to the round's level, if it is on the level
// before, asks for none coarser itself (see level_for), and its box touches a page there in which CHANGED
// pixels changed; writes its level to `levels` and asks for the pages that its box touches: the word of a
// page in `requests` becomes one more than the highest class of such a number, and the words before count
// the pages of each class and above. `choose` leaves out the lower classes until the pages are no more than
// BUDGET: writes `flags`, 1 of a page that is made, `masks`, the levels of which a page may be made that
// holds a node or lies in it, and adds up the pages made and asked for in `totals`. `compare` compares every
// sample of the pixels of the level with its page's depth, as page_query does: writes `visibility`, and
// counts in `changes` the pixels that changed, in every page that their boxes touch; in the first round all
// do. A pixel that finds a page not made keeps what it has and goes back to the level before for good.

//@import frame dispatch receiver map_footprint page_asked page_tree pass

const WORKGROUP = 64u;
const CLASSES = 128u;          // of numbers of changed pixels, four to a double

override FIRST: u32 = 0u;
override CHANGED: u32 = 1u;
override BUDGET: u32 = 64u;
override BIAS_CONSTANT: f32 = 0.00002;
override BIAS_SLOPE: f32 = 1.0;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> step: Pass;
@group(0) @binding(3) var<storage, read> id_keys: array<u32>;
@group(0) @binding(4) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> requests: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> levels: array<u32>;
@group(0) @binding(8) var<storage, read_write> changes: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> flags: array<u32>;
@group(0) @binding(10) var<storage, read_write> masks: array<u32>;
@group(0) @binding(11) var<storage, read_write> totals: array<u32, 2>;
@group(0) @binding(12) var<storage, read> table: array<u32>;
@group(0) @binding(13) var<storage, read> pages: array<u32>;
@group(0) @binding(14) var<storage, read_write> visibility: array<f32>;

// The class of a number that is not 0.
fn class_of(n: u32) -> u32 {
    let exponent = firstLeadingBit(n);
    return min(4u * exponent + (((n << 2u) >> exponent) & 3u), CLASSES - 1u);
}

fn finest_asked(f: MapFootprint) -> u32 { return (level_for(f) + THIRDS - 1u) / THIRDS; }

@compute @workgroup_size(WORKGROUP)
fn ask(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let level = step.index;
    if level == FIRST {
        levels[pixel] = level;
        return;
    }
    if levels[pixel] + 1u != level { return; }
    let f = map_footprint(pixel);
    if !f.some || finest_asked(f) < level { return; }
    let before = pages_touched(level - 1u, f.low, f.high);
    if !before.some { return; }
    var most = 0u;
    for (var y = before.first.y; y <= before.last.y; y++) {
        for (var x = before.first.x; x <= before.last.x; x++) {
            most = max(most, atomicLoad(&changes[node_of(level - 1u, vec2(x, y))]));
        }
    }
    if most < CHANGED { return; }
    levels[pixel] = level;
    let class_asked = class_of(most);
    let touched = pages_touched(level, f.low, f.high);
    for (var y = touched.first.y; y <= touched.last.y; y++) {
        for (var x = touched.first.x; x <= touched.last.x; x++) {
            let word = CLASSES + node_of(level, vec2(x, y));
            if atomicLoad(&requests[word]) > class_asked { continue; }
            // Who raises the word counts the page in the classes between.
            let had = atomicMax(&requests[word], class_asked + 1u);
            for (var k = had; k <= class_asked; k++) { atomicAdd(&requests[k], 1u); }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn choose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let node = flat_invocation(group, groups, WORKGROUP, local);
    if node >= finest_side() * tree_width() { return; }
    let level = step.index;
    let whole = level == FIRST;
    var least = 0u;
    while least < CLASSES && atomicLoad(&requests[least]) > BUDGET { least++; }
    if node == 0u {
        let across = u32(ceil(f32(frame.map_size) * scale_of(level) / f32(PAGE)));
        var asked = across * across;
        var made = asked;
        if !whole {
            asked = atomicLoad(&requests[0]);
            made = 0u;
            if least < CLASSES { made = atomicLoad(&requests[least]); }
        }
        totals[0] += made;
        totals[1] += asked;
    }
    let at = page_of(node);
    flags[node] = 0u;
    masks[node] = 0u;
    if !at.some { return; }
    // Whether there are any in a page of a level before is not looked up.
    var made = true;
    if at.level >= level {
        let page = at.page >> vec2(at.level - level);
        made = atomicLoad(&requests[CLASSES + node_of(level, page)]) > least;
        if whole { made = all(vec2<f32>(page * PAGE) < vec2(f32(frame.map_size) * scale_of(level))); }
    }
    flags[node] = select(0u, 1u, made && at.level == level);
    masks[node] = select(0u, 1u, made) << level;
}

@compute @workgroup_size(WORKGROUP)
fn compare(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let level = step.index;
    if levels[pixel] != level { return; }
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN {
        visibility[pixel] = select(0.0, 1.0, r.seen == SEEN_NONE);
        return;
    }
    let scale = scale_of(level);
    let bias = BIAS_CONSTANT + BIAS_SLOPE * max(abs(r.slope.x), abs(r.slope.y)) / scale;
    var sum = 0.0;
    var seen = 0.0;
    var whole = true;
    // There is one sample at least. The loop ends before it begins a turn of which nothing is kept.
    var k = 0u;
    loop {
        let at = sample_place(r, pixel, k);
        if at.w != 0.0 {
            seen += 1.0;
            var lit = true;
            if all(at.xy >= vec2(0.0)) && all(at.xy < vec2(f32(frame.map_size))) {
                let texel = vec2<u32>(at.xy * scale);
                let node = node_of(level, texel >> vec2(PAGE_SHIFT));
                let number = table[node];
                whole = whole && table[node + 1u] != number;
                let key = pages[number * PAGE_TEXELS + (texel.y % PAGE) * PAGE + texel.x % PAGE];
                lit = key == 0u || bitcast<f32>(~key) >= at.z - bias;
            }
            sum += select(0.0, 1.0, lit);
        }
        continuing {
            k++;
            break if k >= frame.sample_count;
        }
    }
    if !whole {
        levels[pixel] = level - 1u;
        return;
    }
    let now = select(sum / seen, 1.0, seen == 0.0);
    let same = level != FIRST && visibility[pixel] == now;
    visibility[pixel] = now;
    if same { return; }
    let f = map_footprint(pixel);
    // Of the last level there is no next.
    if !f.some || finest_asked(f) <= level { return; }
    let touched = pages_touched(level, f.low, f.high);
    if !touched.some { return; }
    for (var y = touched.first.y; y <= touched.last.y; y++) {
        for (var x = touched.first.x; x <= touched.last.x; x++) {
            atomicAdd(&changes[node_of(level, vec2(x, y))], 1u);
        }
    }
}
