// axis_density: how many texels each part of the axes of the light's map takes (rectilinear texture warping:
// Rosen 2012; with LOGARITHMIC logarithmic shadow maps: Lloyd et al. 2008). `request` finds the box of each
// pixel's samples and how many texels for one of the map it wants along either axis: as many as make none
// longer than its step along it, to the right or down, or than NARROWEST of its longest step, no more than
// single precision tells apart. It raises the words of `requests` that stand for spans of 2^k cells, of which
// two cover the box; with LOGARITHMIC to 1, and the last word to the nearest distance from the eye. `shape`
// makes of them the density of each cell, in ONEs: the greatest asked for within SPREAD cells, and the mean
// of that over as many; with LOGARITHMIC where one was asked for that of the strip's nearest point. To all it
// adds the least by which none takes more than STRETCH times the mean. Behind prefix_scan `divide` finds
// where the texels begin that share the axes by density (`borders`).

//@import frame dispatch receiver map_footprint axis_table divide

const WORKGROUP = 64u;
const SHAPE_WORKGROUP = 256u;
const EACH = 4u;                // cells an invocation of `shape`: AXIS_CELLS / SHAPE_WORKGROUP
const LEVELS = 11u;             // of spans: from one cell to all
const NEAREST_WORD = 22528u;    // of `requests`: 2 * LEVELS * AXIS_CELLS
const REQUEST_WORDS = 22529u;
const ONE = 128u;               // density of one texel for one of the map
const MOST = 131072u;           // greatest density of a cell
const SPREAD = 4u;
const REQUESTED = 0u;
const LOGARITHMIC = 1u;
const NARROWEST = 0.25;

override DENSITY: u32 = REQUESTED;
override STRETCH: u32 = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> requests: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> densities: array<u32>;
@group(0) @binding(7) var<storage, read> axes: array<u32>;
@group(0) @binding(8) var<storage, read_write> borders: array<f32>;

var<workgroup> cells: array<u32, 2048>;  // twice AXIS_CELLS: as they were and as they will be
var<workgroup> greatest: atomic<u32>;
var<workgroup> total: atomic<u32>;

fn span_word(axis: u32, level: u32, cell: u32) -> u32 { return (axis * LEVELS + level) * AXIS_CELLS + cell; }

fn raise(word: u32, to: u32) {
    if atomicLoad(&requests[word]) < to { atomicMax(&requests[word], to); }
}

@compute @workgroup_size(WORKGROUP)
fn request(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let f = map_footprint(pixel);
    if !f.some { return; }
    let side = f32(frame.map_size);
    if any(f.high < vec2(0.0)) || any(f.low >= vec2(side)) { return; }
    let end = vec2(f32(AXIS_CELLS) - 1.0);
    let scale = f32(AXIS_CELLS) / side;
    let first = vec2<u32>(clamp(f.low * scale, vec2(0.0), end));
    let last = vec2<u32>(clamp(f.high * scale, vec2(0.0), end));
    let longest = sqrt(max(dot(f.right, f.right), dot(f.down, f.down)));
    let step = max(max(abs(f.right), abs(f.down)), vec2(NARROWEST * longest));
    let told = f32(ONE) * 0.5 * f.w / place_noise();
    let wanted = min(f32(ONE) / step, vec2(min(told, f32(MOST))));
    for (var axis = 0u; axis < 2u; axis++) {
        let density = select(u32(ceil(max(wanted[axis], 1.0))), 1u, DENSITY == LOGARITHMIC);
        let level = firstLeadingBit(last[axis] - first[axis] + 1u);
        raise(span_word(axis, level, first[axis]), density);
        raise(span_word(axis, level, last[axis] + 1u - (1u << level)), density);
    }
    if DENSITY == LOGARITHMIC { raise(NEAREST_WORD, ~bitcast<u32>(f.distance)); }
}

// A row that takes points from the eye.
fn from_eye(row: vec4<f32>) -> vec4<f32> {
    return vec4(row.xyz, dot(row, from_lamp(vec3(0.0))));
}

// Texels that a pixel as far as the nearest point of a cell's strip wants there along the axis, but for a
// factor that all have; `near`: no receiver is nearer to the eye.
fn strip_density(axis: u32, cell: u32, near: f32) -> f32 {
    let at = (f32(cell) + 0.5) * (f32(frame.map_size) / f32(AXIS_CELLS));
    var row = frame.map_u;
    if axis == 1u { row = frame.map_v; }
    // The strip's plane; its point nearest to the eye, the origin.
    let plane = from_eye(row - at * frame.map_w);
    let steep = length(plane.xyz);
    let apart = abs(plane.w) / steep;
    let w = from_eye(frame.map_w).w - dot(frame.map_w.xyz, plane.xyz) * plane.w / (steep * steep);
    let beside = sqrt(max(near * near - apart * apart, 0.0));
    let most_w = max(w + length(frame.map_w.xyz) * beside, frame.light_low.w);
    return select(1.0, most_w, (frame.flags & FLAG_PERSPECTIVE) != 0u) * steep / max(apart, near);
}

@compute @workgroup_size(SHAPE_WORKGROUP)
fn shape(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let axis = flat_group(group, groups);
    if local == 0u {
        atomicStore(&greatest, 0u);
        atomicStore(&total, 0u);
    }
    for (var k = 0u; k < EACH; k++) {
        let cell = local + k * SHAPE_WORKGROUP;
        cells[cell] = atomicLoad(&requests[span_word(axis, LEVELS - 1u, cell)]);
    }
    workgroupBarrier();
    // Each span hands on to its halves.
    var old = 0u;
    for (var level = LEVELS - 1u; level > 0u; level--) {
        let half = 1u << (level - 1u);
        for (var k = 0u; k < EACH; k++) {
            let cell = local + k * SHAPE_WORKGROUP;
            var here = max(atomicLoad(&requests[span_word(axis, level - 1u, cell)]), cells[old + cell]);
            if cell >= half { here = max(here, cells[old + cell - half]); }
            cells[AXIS_CELLS - old + cell] = here;
        }
        old = AXIS_CELLS - old;
        workgroupBarrier();
    }
    for (var k = 0u; k < EACH; k++) {
        let cell = local + k * SHAPE_WORKGROUP;
        var here = 0u;
        for (var j = 0u; j <= 2u * SPREAD; j++) {
            here = max(here, cells[old + clamp(cell + j, SPREAD, AXIS_CELLS - 1u + SPREAD) - SPREAD]);
        }
        cells[AXIS_CELLS - old + cell] = here;
    }
    old = AXIS_CELLS - old;
    workgroupBarrier();
    var kept = array<u32, EACH>();
    if DENSITY == LOGARITHMIC {
        let near = bitcast<f32>(~atomicLoad(&requests[NEAREST_WORD]));
        var of_strip = array<f32, EACH>();
        for (var k = 0u; k < EACH; k++) {
            let cell = local + k * SHAPE_WORKGROUP;
            if cells[old + cell] == 0u { continue; }
            of_strip[k] = strip_density(axis, cell, near);
            atomicMax(&greatest, bitcast<u32>(of_strip[k]));
        }
        workgroupBarrier();
        let most = bitcast<f32>(atomicLoad(&greatest));
        workgroupBarrier();
        for (var k = 0u; k < EACH; k++) {
            if most > 0.0 { kept[k] = u32(ceil(of_strip[k] / most * f32(MOST))); }
        }
        if local == 0u { atomicStore(&greatest, 0u); }
        workgroupBarrier();
    } else {
        for (var k = 0u; k < EACH; k++) {
            let cell = local + k * SHAPE_WORKGROUP;
            var sum = 2u * SPREAD;  // rounds up
            for (var j = 0u; j <= 2u * SPREAD; j++) {
                sum += cells[old + clamp(cell + j, SPREAD, AXIS_CELLS - 1u + SPREAD) - SPREAD];
            }
            kept[k] = sum / (2u * SPREAD + 1u);
        }
    }
    for (var k = 0u; k < EACH; k++) {
        atomicMax(&greatest, kept[k]);
        atomicAdd(&total, kept[k]);
    }
    workgroupBarrier();
    let most = atomicLoad(&greatest);
    let even = STRETCH * (atomicLoad(&total) / AXIS_CELLS);
    let more = select(0u, (most - even + STRETCH - 2u) / (STRETCH - 1u), most > even);
    for (var k = 0u; k < EACH; k++) {
        densities[axis * AXIS_CELLS + local + k * SHAPE_WORKGROUP] = max(kept[k] + more, 1u);
    }
}

@compute @workgroup_size(WORKGROUP)
fn divide(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    let across = frame.map_size + 1u;
    if item >= 2u * across { return; }
    let of_axis = divided(item, across);
    let first = of_axis.x * AXIS_CELLS;
    let start = axes[first];
    let all = axes[first + AXIS_CELLS] - start;
    // `texel` parts of `map_size` of them, exactly: a whole number and a rest.
    let texel = of_axis.y;
    let left = texel * (all % frame.map_size);
    let whole = texel * (all / frame.map_size) + left / frame.map_size;
    let rest = f32(left % frame.map_size) / f32(frame.map_size);
    var low = 0u;
    var high = AXIS_CELLS;
    while low + 1u < high {
        let middle = (low + high) >> 1u;
        if axes[first + middle] - start <= whole { low = middle; } else { high = middle; }
    }
    let before = axes[first + low];
    let part = (f32(whole - (before - start)) + rest) / f32(axes[first + low + 1u] - before);
    borders[item] = (f32(low) + part) * (f32(frame.map_size) / f32(AXIS_CELLS));
}
