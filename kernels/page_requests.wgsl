// page_requests: which pages of the light's view the pixels need (Lefohn, Sengupta, Owens 2007), and which
// of them there is room for. `request` finds for each pixel the level whose texels are no longer than the
// pixel's step on its receiver, to the right or down, whichever is longer, FINER levels beyond it, no
// finer than single precision tells texels apart, and so coarse that the box of its samples is a page long
// at most; writes it to `levels`, in thirds of a level, which round up, and marks the pages that the box
// touches. Bits s to s + 2 of a node of `requests` say that its page is needed if all are s thirds coarser
// than asked for; the words before count the pages of each s, but for the coarsest page, which is always
// there. `choose` takes the least s whose pages are no more than BUDGET: writes `flags`, 1 of a page that
// is made, `masks`, the levels of which a page is made that holds a node or lies in it, and behind the
// offsets in `table` that s and the pages of s = 0.
//
// With EDGES (adaptive shadow maps: Fernando et al. 2001) a pixel whose box, grown by a texel of the map,
// holds no texel that the table `sat` counts, of silhouettes, asks for no finer level than PAGE_BASE.
// With FITTED (fitted virtual shadow maps: Giegl, Wimmer 2007) `request` marks no pages, but cells of the
// view, which are the pages of one level: a word of each, behind the nodes, is one more than the finest
// level in thirds that is asked for by a pixel whose box touches it. `spread` marks all pages of each cell
// at its level, and `fit` writes to `levels` the finest level of the cells that a pixel touches. With TILED
// (tiled shadow maps: Arvo 2004) a cell besides has a weight, in words behind these: a pixel whose box
// touches it adds 1, or EDGE_WEIGHT if it holds a silhouette, as above; `weigh` sums them up in the last word
// before the nodes. The level of a cell is that of its share of BUDGET by weight, where that is not finer.

//@import frame dispatch receiver map_footprint page_asked page_tree summed_area

const WORKGROUP = 64u;
const REQUEST_HEAD = 32u;
const TABLE_TAIL = 2u;         // words of `table` behind the nodes before those that `choose` writes
const MOST_CELLS = 5u;         // level whose pages are cells, where there are finer ones
const WEIGHTS = 31u;           // word of `requests` that holds the sum of the cells' weights
const EDGE_WEIGHT = 8u;        // of a pixel near a silhouette

override FITTED: u32 = 0u;
override TILED: u32 = 0u;
override EDGES: u32 = 0u;
override BUDGET: u32 = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> requests: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> levels: array<u32>;
@group(0) @binding(7) var<storage, read_write> flags: array<u32>;
@group(0) @binding(8) var<storage, read_write> masks: array<u32>;
@group(0) @binding(9) var<storage, read_write> table: array<u32>;
@group(0) @binding(10) var<storage, read> sat: array<u32>;

// Asks for a page that is `more` thirds finer than its pixel, and for those that hold it in its place. Who
// asks first goes on to the next.
fn ask(level: u32, page: vec2<u32>, more: u32) {
    for (var coarser = 0u; coarser <= level; coarser++) {
        let at = level - coarser;
        let word = REQUEST_HEAD + node_of(at, page >> vec2(coarser));
        // The page is needed from this many thirds on, and for two more.
        let begin = THIRDS * coarser + 2u - more;
        let bit = 1u << begin;
        if (atomicLoad(&requests[word]) & bit) != 0u { break; }
        let had = atomicOr(&requests[word], bit);
        if (had & bit) != 0u { break; }
        if at == 0u { continue; }
        // Bit s + 2 of these: it was needed at s.
        let known = had | (had << 1u) | (had << 2u);
        for (var k = max(begin, 2u); k <= begin + 2u; k++) {
            if ((known >> k) & 1u) == 0u { atomicAdd(&requests[k - 2u], 1u); }
        }
    }
}

// The level whose pages are cells.
fn cell_level() -> u32 { return min(MOST_CELLS, PAGE_LAST); }

fn cell_word(cell: vec2<u32>) -> u32 {
    return REQUEST_HEAD + finest_side() * tree_width() + (cell.y << cell_level()) + cell.x;
}

fn weight_word(cell: vec2<u32>) -> u32 { return cell_word(cell) + (1u << (2u * cell_level())); }

// One more than the level of a cell, in thirds; 0 if no pixel touches it.
fn cell_asked(cell: vec2<u32>) -> u32 {
    let finest = atomicLoad(&requests[cell_word(cell)]);
    if TILED == 0u || finest == 0u { return finest; }
    let weight = f32(max(atomicLoad(&requests[weight_word(cell)]), 1u));
    let share = f32(BUDGET) * weight / f32(max(atomicLoad(&requests[WEIGHTS]), 1u));
    let thirds = i32(THIRDS * cell_level()) + i32(floor(1.5 * log2(share)));
    return 1u + u32(clamp(thirds, 0, i32(finest) - 1));
}

// Whether a box of places on the map comes near a silhouette.
fn is_at_edge(low: vec2<f32>, high: vec2<f32>) -> bool {
    let end = vec2(f32(frame.map_size) - 1.0);
    return rect_sum(vec2(frame.map_size), vec2<u32>(clamp(low - 1.0, vec2(0.0), end)),
        vec2<u32>(clamp(high + 1.0, vec2(0.0), end))) > 0u;
}

@compute @workgroup_size(WORKGROUP)
fn request(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    levels[pixel] = 0u;
    let f = map_footprint(pixel);
    if !f.some { return; }
    var thirds = level_for(f);
    let told = (EDGES != 0u && thirds > THIRDS * PAGE_BASE) || TILED != 0u;
    let at_edge = told && is_at_edge(f.low, f.high);
    if EDGES != 0u && !at_edge { thirds = min(thirds, THIRDS * PAGE_BASE); }
    levels[pixel] = thirds;
    let level = (thirds + THIRDS - 1u) / THIRDS;
    let touched = pages_touched(select(level, cell_level(), FITTED != 0u), f.low, f.high);
    if !touched.some { return; }
    for (var y = touched.first.y; y <= touched.last.y; y++) {
        for (var x = touched.first.x; x <= touched.last.x; x++) {
            let page = vec2(x, y);
            if FITTED == 0u {
                ask(level, page, THIRDS * level - thirds);
                continue;
            }
            atomicMax(&requests[cell_word(page)], thirds + 1u);
            if TILED != 0u { atomicAdd(&requests[weight_word(page)], select(1u, EDGE_WEIGHT, at_edge)); }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn weigh(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let cell = flat_invocation(group, groups, WORKGROUP, local);
    if cell >= 1u << (2u * cell_level()) { return; }
    let weight = atomicLoad(&requests[weight_word(vec2(0u)) + cell]);
    if weight != 0u { atomicAdd(&requests[WEIGHTS], weight); }
}

@compute @workgroup_size(WORKGROUP)
fn fit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let f = map_footprint(pixel);
    if !f.some { return; }
    let touched = pages_touched(cell_level(), f.low, f.high);
    if !touched.some { return; }
    var finest = 0u;
    for (var y = touched.first.y; y <= touched.last.y; y++) {
        for (var x = touched.first.x; x <= touched.last.x; x++) {
            finest = max(finest, cell_asked(vec2(x, y)));
        }
    }
    levels[pixel] = max(finest, 1u) - 1u;
}

@compute @workgroup_size(WORKGROUP)
fn spread(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let node = flat_invocation(group, groups, WORKGROUP, local);
    if node >= finest_side() * tree_width() { return; }
    let at = page_of(node);
    let cells = cell_level();
    if !at.some || at.level < cells { return; }
    let asked = cell_asked(at.page >> vec2(at.level - cells));
    if asked == 0u { return; }
    let thirds = asked - 1u;
    let level = (thirds + THIRDS - 1u) / THIRDS;
    // Cells of pages as large as they are, or larger, ask for the one that holds them.
    if level != at.level && !(at.level == cells && level < cells) { return; }
    let page = at.page >> vec2(at.level - level);
    if any(vec2<f32>(page * PAGE) >= vec2(f32(frame.map_size) * scale_of(level))) { return; }
    ask(level, page, THIRDS * level - thirds);
}

// Whether a page is made `thirds` coarser than asked, by the bits of its node.
fn is_made(bits: u32, thirds: u32) -> bool {
    return thirds < 32u && ((bits >> (thirds & 31u)) & 7u) != 0u;
}

fn bits_of(level: u32, page: vec2<u32>) -> u32 {
    return atomicLoad(&requests[REQUEST_HEAD + node_of(level, page)]);
}

@compute @workgroup_size(WORKGROUP)
fn choose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let node = flat_invocation(group, groups, WORKGROUP, local);
    let side = finest_side();
    let nodes = side * tree_width();
    if node >= nodes { return; }
    var coarser = 0u;
    while coarser < THIRDS * PAGE_LAST && atomicLoad(&requests[coarser]) >= BUDGET { coarser++; }
    if node == 0u {
        table[nodes + TABLE_TAIL] = coarser;
        table[nodes + TABLE_TAIL + 1u] = atomicLoad(&requests[0]) + 1u;
    }
    let at = page_of(node);
    let level = at.level;
    let page = at.page;
    flags[node] = 0u;
    masks[node] = 0u;
    if !at.some { return; }
    // Bits of a page are those of its own pages below, moved by a level's thirds for each.
    let bits = bits_of(level, page);
    var mask = 1u;
    for (var below = level; below <= PAGE_LAST; below++) {
        mask |= select(0u, 1u, is_made(bits, coarser + THIRDS * (below - level))) << below;
    }
    for (var above = 1u; above < level; above++) {
        mask |= select(0u, 1u, is_made(bits_of(above, page >> vec2(level - above)), coarser)) << above;
    }
    flags[node] = (mask >> level) & 1u;
    masks[node] = mask;
}
