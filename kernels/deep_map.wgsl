// deep_map: the visibility function of each texel of a deep shadow map (Lokovic and Veach 2000): the share of
// light that its SUB x SUB sub-texels, which are the texels of a map of nearest depths (`nearest_keys`), let
// pass to a depth, one step less behind each. Compressed to NODES nodes at most, lines between them, by the
// paper's greedy search: a line goes on as long as one slope keeps it within the error of all corners of the
// steps. Where so many nodes do not hold ERROR, up to TRIES of a texel's invocations try a greater one each,
// the last a single line, and the first whose nodes suffice makes them. All light before the first step
// and what is left behind the last are exact, and no line rises. Writes `deep`, NODES + 1 words a texel: how
// many nodes there are, above 16 bits the greatest difference from the steps, measured (of ERROR_UNIT,
// rounded up); the nodes. Adds up in `worst`: the greatest of these, and how many texels took more than
// ERROR.

//@import frame dispatch front_split deep_nodes

const WORKGROUP = 64u;
const MOST_NODES = 15u;
const ERROR_UNIT = 32768u;   // of all light
const TRIES = 8u;            // errors of a texel, as far as it has invocations
const STEEPEST = 3.0e38;

override SUB: u32 = 4u;      // 2, 4 or 8
override NODES: u32 = 7u;
override ERROR: f32 = 8.0;   // of WHOLE

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(2) var<storage, read_write> deep: array<u32>;
@group(0) @binding(3) var<storage, read_write> worst: array<atomic<u32>, 2>;

var<workgroup> given: array<u32, 64>;             // places, of each texel one after another
var<workgroup> steps: array<u32, 64>;             // the same, sorted
var<workgroup> nodes: array<u32, 256>;            // 16 a texel
var<workgroup> chosen: array<atomic<u32>, 16>;    // of each texel the invocation whose error does
var<workgroup> made: array<atomic<u32>, 16>;      // of each texel how many nodes
var<workgroup> off: array<atomic<u32>, 16>;       // of each texel the difference

// The place of a sub-texel's depth.
fn place_in(sub_texel: vec2<u32>) -> u32 {
    if any(sub_texel >= vec2(frame.map_size)) { return NO_PLACE; }
    let key = nearest_keys[sub_texel.y * frame.map_size + sub_texel.x];
    return select(deep_place(depth_of_key(key)), NO_PLACE, key == 0u);
}

// A line that is being made: where it begins, and its least and greatest slope.
struct Line {
    place: u32,
    light: f32,
    least: f32,
    greatest: f32,
}

// The slopes by which a line meets a corner within an error, and is not below `rest`.
fn slopes_to(line: Line, place: u32, light: f32, error: f32, rest: f32) -> vec2<f32> {
    let away = f32(max(place, line.place + 1u) - line.place);
    return vec2(max(light - error, rest) - line.light, min(light + error - line.light, 0.0)) / away;
}

// Nodes of a texel, whose steps are `count` from `base` on, within an error: how many it takes, NODES + 1 at
// most; none but the ends where it is a single line. With `keep` they are written.
fn build(base: u32, count: u32, error: f32, single: bool, keep: bool) -> u32 {
    let at = base / (SUB * SUB) * 16u;
    let step = f32(WHOLE) / f32(SUB * SUB);
    let rest = f32(WHOLE) - step * f32(count);
    var line = Line(steps[base], f32(WHOLE), -STEEPEST, 0.0);
    if keep { nodes[at] = (line.place << 8u) | WHOLE; }
    var taken = 1u;
    var last = line.place;
    var above = f32(WHOLE);
    // Two corners a step.
    for (var k = 0u; k < 2u * count && taken < NODES; k++) {
        let n = k / 2u;
        let end = n + 1u == count;
        // Of several at one place the last tells.
        if !end && steps[base + min(n + 1u, 63u)] == steps[base + n] { continue; }
        let behind = k % 2u == 1u;
        if single && !(end && behind) { continue; }
        let place = steps[base + n] + k % 2u;
        let light = select(above, f32(WHOLE) - step * f32(n + 1u), behind);
        above = light;
        if place == line.place { continue; }
        let within = select(error, 0.0, end && behind);
        var slopes = slopes_to(line, place, light, within, rest);
        if max(slopes.x, line.least) > min(slopes.y, line.greatest) && last > line.place {
            // The line ends at the corner before.
            let along = 0.5 * (line.least + line.greatest) * f32(last - line.place);
            let kept = floor(clamp(line.light + along, rest, line.light) + 0.5);
            line = Line(last, kept, -STEEPEST, 0.0);
            if keep { nodes[at + taken] = (last << 8u) | u32(kept); }
            taken++;
            slopes = slopes_to(line, place, light, within, rest);
        }
        line.greatest = min(line.greatest, slopes.y);
        line.least = min(max(line.least, slopes.x), line.greatest);
        last = place;
    }
    // There is room for the last.
    let whole = taken < NODES && last > steps[base + count - 1u];
    if keep && whole { nodes[at + taken] = (last << 8u) | u32(rest); }
    return select(NODES, taken, whole) + 1u;
}

// Light at a place by a texel's nodes.
fn light_at(at: u32, count: u32, place: u32) -> f32 {
    if place <= (nodes[at] >> 8u) { return f32(WHOLE); }
    for (var k = 1u; k < count; k++) {
        if place <= (nodes[at + k] >> 8u) { return light_between(nodes[at + k - 1u], nodes[at + k], place); }
    }
    return f32(nodes[at + count - 1u] & 0xffu);
}

@compute @workgroup_size(WORKGROUP)
fn compress(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let all = SUB * SUB;
    let side = (frame.map_size + SUB - 1u) / SUB;
    let slot = local / all;
    let own = local % all;
    let base = slot * all;
    let tries = min(all, TRIES);
    let texel = flat_group(group, groups) * (WORKGROUP / all) + slot;
    let there = texel < side * side;
    var place = NO_PLACE;
    if there { place = place_in(vec2(texel % side, texel / side) * SUB + vec2(own % SUB, own / SUB)); }
    given[local] = place;
    if own == 0u {
        atomicStore(&chosen[slot], tries - 1u);
        atomicStore(&made[slot], 0u);
        atomicStore(&off[slot], 0u);
    }
    workgroupBarrier();
    // Places before this one, before or at it, and the sub-texels that have any.
    var before = 0u;
    var equals = 0u;
    var rank = 0u;
    var count = 0u;
    for (var k = 0u; k < all; k++) {
        let other = given[base + k];
        before += select(0u, 1u, other < place);
        equals += select(0u, 1u, other == place);
        rank += select(0u, 1u, other < place || (other == place && k < own));
        count += select(0u, 1u, other != NO_PLACE);
    }
    steps[base + rank] = place;
    workgroupBarrier();
    let first = min(ERROR, 64.0);
    let more = f32(own) / f32(tries - 1u);
    let error = first + (64.0 - first) * (more * more);
    // Most texels need no error but the first; of the others some invocations try theirs, one makes them.
    for (var turn = 0u; turn < 3u; turn++) {
        let least = atomicLoad(&chosen[slot]);
        workgroupBarrier();
        let keep = turn != 1u;
        var is_own = own == select(least, 0u, turn == 0u);
        if turn == 1u { is_own = own > 0u && own < tries; }
        if count > 0u && is_own && least > 0u {
            let taken = build(base, count, error, own == tries - 1u, keep);
            if taken <= NODES { atomicMin(&chosen[slot], own); }
            if keep { atomicStore(&made[slot], min(taken, NODES)); }
        }
        workgroupBarrier();
    }
    // The difference at both ends of the own step: between steps all lines are straight.
    let taken = atomicLoad(&made[slot]);
    if place != NO_PLACE {
        let at = slot * 16u;
        let step = f32(WHOLE) / f32(all);
        let high = abs(light_at(at, taken, place) - (f32(WHOLE) - step * f32(before)));
        let low = abs(light_at(at, taken, place + 1u) - (f32(WHOLE) - step * f32(before + equals)));
        atomicMax(&off[slot], u32(ceil(max(high, low) * f32(ERROR_UNIT / WHOLE))));
    }
    workgroupBarrier();
    if !there { return; }
    let difference = atomicLoad(&off[slot]);
    let words = texel * (NODES + 1u);
    for (var k = own; k < NODES; k += all) {
        deep[words + 1u + k] = select(0u, nodes[slot * 16u + k], k < taken);
    }
    if own == 0u {
        deep[words] = taken | (difference << 16u);
        if difference > 0u { atomicMax(&worst[0], difference); }
        if count > 0u && atomicLoad(&chosen[slot]) > 0u { atomicAdd(&worst[1], 1u); }
    }
}
