// map_moments: mean and variance of the depths of ever larger squares of texels of a map (Donnelly and
// Lauritzen 2006, whose two moments they are: kept apart, so that nothing cancels), or of exponentials of
// them (WARP: Annen et al. 2008; Lauritzen and McCool 2008), or of one of LAYERS of them (WARP: its number;
// Lauritzen and McCool 2008); or the means of sine and cosine of one of TERMS waves of depth (WARP: its
// number; Annen et al. 2007). A cell of level k is a square of 2^k texels a side, cut at the map's border; a
// texel without a caster is as deep as `levels.far`. `reduce` makes up to five levels above level FIRST,
// which is the texels (`nearest_keys`) or was made by a run before. Writes `moments`, level after level; with
// FOUR also third and fourth central moments (Peters and Klein 2015), behind all of those.

//@import frame dispatch front_split moments

const WORKGROUP = 256u;
const TILE = 32u;    // cells of level FIRST a side that a workgroup takes
const HALF = 16u;
const LEVELS = 5u;   // that it makes of them

override FIRST: u32 = 0u;
override WARP: f32 = 0.0;
override LAYERS: u32 = 0u;
override TERMS: u32 = 0u;
override FOUR: u32 = 0u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> moments: array<vec2<f32>>;

struct Cell {
    low: vec2<f32>,   // mean, variance
    high: vec2<f32>,  // with FOUR: third and fourth central moments
    size: f32,        // texels
}

var<workgroup> tile: array<Cell, 256>;

// Texels that a column or row of cells of a level takes.
fn extent(level: u32, cell: u32) -> f32 {
    let begin = cell << level;
    return select(0.0, f32(min(1u << level, frame.map_size - begin)), begin < frame.map_size);
}

// Where a level begins among the moments.
fn start_of(level: u32) -> u32 {
    return level_start(level) + set_of(WARP) * levels.second;
}

fn cell_of(at: vec2<u32>) -> Cell {
    let size = extent(FIRST, at.x) * extent(FIRST, at.y);
    if size == 0.0 { return Cell(vec2(0.0), vec2(0.0), 0.0); }
    if FIRST == 0u {
        return Cell(texel_moments(nearest_keys[at.y * frame.map_size + at.x], WARP), vec2(0.0), size);
    }
    let place = start_of(FIRST) + at.y * level_side(FIRST) + at.x;
    var high = vec2(0.0);
    if FOUR == 1u { high = moments[levels.second + place]; }
    return Cell(moments[place], high, size);
}

fn joined(a: Cell, b: Cell, c: Cell, d: Cell) -> Cell {
    let sizes = vec4(a.size, b.size, c.size, d.size);
    let size = a.size + b.size + c.size + d.size;
    if size == 0.0 { return Cell(vec2(0.0), vec2(0.0), 0.0); }
    let means = vec4(a.low.x, b.low.x, c.low.x, d.low.x);
    let variances = vec4(a.low.y, b.low.y, c.low.y, d.low.y);
    let low = mixed(means, variances, sizes / size);
    var high = vec2(0.0);
    if FOUR == 1u {
        let three = vec4(a.high.x, b.high.x, c.high.x, d.high.x);
        let four = vec4(a.high.y, b.high.y, c.high.y, d.high.y);
        high = mixed_high(means - low.x, variances, three, four, sizes / size);
    }
    return Cell(low, high, size);
}

@compute @workgroup_size(WORKGROUP)
fn reduce(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let across = (level_side(FIRST) + TILE - 1u) / TILE;
    let number = flat_group(group, groups);
    let corner = vec2(number % across, number / across);
    let own = vec2(local % HALF, local / HALF);
    let at = corner * TILE + own * 2u;
    var made = joined(cell_of(at), cell_of(at + vec2(1u, 0u)), cell_of(at + vec2(0u, 1u)), cell_of(at + 1u));
    for (var k = 1u; k <= LEVELS; k++) {
        let side = TILE >> k;
        let level = FIRST + k;
        let active_cell = all(own < vec2(side));
        if k > 1u && active_cell {
            let base = 2u * own.y * HALF + 2u * own.x;
            made = joined(tile[base], tile[base + 1u], tile[base + HALF], tile[base + HALF + 1u]);
        }
        let cell = corner * side + own;
        if active_cell && level <= levels.count && all(cell < vec2(level_side(level))) {
            let place = start_of(level) + cell.y * level_side(level) + cell.x;
            moments[place] = made.low;
            if FOUR == 1u { moments[levels.second + place] = made.high; }
        }
        workgroupBarrier();
        if active_cell { tile[own.y * HALF + own.x] = made; }
        workgroupBarrier();
    }
}
