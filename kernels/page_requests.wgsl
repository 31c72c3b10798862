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
// at its level, and `fit` writes to `levels` the finest level of the cells that a pixel touches.

//@import frame dispatch receiver map_footprint page_tree divide summed_area

const WORKGROUP = 64u;
const REQUEST_HEAD = 32u;
const THIRDS = 3u;            // of a level: steps by which all are made coarser
const TABLE_TAIL = 2u;         // words of `table` behind the nodes before those that `choose` writes
const MOST_CELLS = 5u;         // level whose pages are cells, where there are finer ones
const SLACK = 0.5;             // texels: whoever reads places samples anew and may round otherwise

override FINER: u32 = 0u;
override FITTED: u32 = 0u;
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

// The level that a pixel asks for whose step is the root of `square` texels of level PAGE_BASE, and its box
// `extent` of them long, of a divisor `w`; in thirds.
fn level_for(square: f32, extent: f32, w: f32) -> i32 {
    let matched = i32(THIRDS * (PAGE_BASE + FINER)) + i32(ceil(clamp(-1.5 * log2(square), -99.0, 99.0)));
    // Half a texel of it is above the rounding of a place.
    let told = min(exponent_of(0.5 * w / place_noise()), i32(PAGE_SHIFT) - 1 - exponent_of(extent));
    return clamp(min(matched, i32(THIRDS) * (i32(PAGE_BASE) + told)), 0, i32(THIRDS * PAGE_LAST));
}

// The level whose pages are cells.
fn cell_level() -> u32 { return min(MOST_CELLS, PAGE_LAST); }

fn cell_word(cell: vec2<u32>) -> u32 {
    return REQUEST_HEAD + finest_side() * tree_width() + (cell.y << cell_level()) + cell.x;
}

struct Touched { first: vec2<u32>, last: vec2<u32>, some: bool }

// The pages of a level that a box of places on the map touches.
fn pages_touched(level: u32, low: vec2<f32>, high: vec2<f32>) -> Touched {
    let side = f32(frame.map_size);
    let scale = scale_of(level);
    let end = vec2(ceil(side * scale) - 1.0);
    return Touched(vec2<u32>(clamp(low * scale - SLACK, vec2(0.0), end)) >> vec2(PAGE_SHIFT),
        vec2<u32>(clamp(high * scale + SLACK, vec2(0.0), end)) >> vec2(PAGE_SHIFT),
        all(high >= vec2(0.0)) && all(low < vec2(side)));
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
    let square = max(dot(f.right, f.right), dot(f.down, f.down));
    let low = f.low;
    let high = f.high;
    let extent = max(high.x - low.x, high.y - low.y);
    var thirds = u32(level_for(square, extent, f.w));
    if EDGES != 0u && thirds > THIRDS * PAGE_BASE && !is_at_edge(low, high) { thirds = THIRDS * PAGE_BASE; }
    levels[pixel] = thirds;
    let level = (thirds + THIRDS - 1u) / THIRDS;
    let touched = pages_touched(select(level, cell_level(), FITTED != 0u), low, high);
    if !touched.some { return; }
    for (var y = touched.first.y; y <= touched.last.y; y++) {
        for (var x = touched.first.x; x <= touched.last.x; x++) {
            if FITTED == 0u {
                ask(level, vec2(x, y), THIRDS * level - thirds);
            } else {
                atomicMax(&requests[cell_word(vec2(x, y))], thirds + 1u);
            }
        }
    }
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
            finest = max(finest, atomicLoad(&requests[cell_word(vec2(x, y))]));
        }
    }
    levels[pixel] = max(finest, 1u) - 1u;
}

struct Node { level: u32, page: vec2<u32>, some: bool }

// The page of a node. Beside a level, and in the last row, the grid has nodes that are none.
fn page_of(node: u32) -> Node {
    let side = finest_side();
    let at = divided(node, tree_width()).yx;
    var level = PAGE_LAST;
    if at.x >= side { level = firstLeadingBit(max(side - at.y - 1u, 1u)); }
    let page = at - tree_corner(level);
    return Node(level, page, all(page < vec2(1u << level)));
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
    let asked = atomicLoad(&requests[cell_word(at.page >> vec2(at.level - cells))]);
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
