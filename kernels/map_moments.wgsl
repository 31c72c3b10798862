// map_moments: mean and variance of the depths of ever larger squares of texels of a map (Donnelly and
// Lauritzen 2006, whose two moments they are: kept apart, so that nothing cancels), or of exponentials of
// them (EXPONENT: Annen et al. 2008; Lauritzen and McCool 2008). A cell of level k is a square of 2^k texels
// a side, cut at the map's border; a texel without a caster is as deep as `levels.far`. `reduce` makes up to
// five levels above level FIRST, which is the texels (`nearest_keys`) or was made by a run before. Writes
// `moments`, level after level.

//@import frame dispatch front_split moments

const WORKGROUP = 256u;
const TILE = 32u;    // cells of level FIRST a side that a workgroup takes
const HALF = 16u;
const LEVELS = 5u;   // that it makes of them

override FIRST: u32 = 0u;
override EXPONENT: f32 = 0.0;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> moments: array<vec2<f32>>;

var<workgroup> tile: array<vec3<f32>, 256>;  // mean, variance, texels

// Texels that a column or row of cells of a level takes.
fn extent(level: u32, cell: u32) -> f32 {
    let begin = cell << level;
    return select(0.0, f32(min(1u << level, frame.map_size - begin)), begin < frame.map_size);
}

// Where a level begins among the moments.
fn start_of(level: u32) -> u32 {
    return level_start(level) + select(0u, levels.falling, EXPONENT < 0.0);
}

fn cell_of(at: vec2<u32>) -> vec3<f32> {
    let size = extent(FIRST, at.x) * extent(FIRST, at.y);
    if size == 0.0 { return vec3(0.0); }
    if FIRST == 0u { return vec3(texel_moments(nearest_keys[at.y * frame.map_size + at.x], EXPONENT), size); }
    return vec3(moments[start_of(FIRST) + at.y * level_side(FIRST) + at.x], size);
}

fn joined(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {
    let sizes = vec4(a.z, b.z, c.z, d.z);
    let size = a.z + b.z + c.z + d.z;
    if size == 0.0 { return vec3(0.0); }
    return vec3(mixed(vec4(a.x, b.x, c.x, d.x), vec4(a.y, b.y, c.y, d.y), sizes / size), size);
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
            moments[start_of(level) + cell.y * level_side(level) + cell.x] = made.xy;
        }
        workgroupBarrier();
        if active_cell { tile[own.y * HALF + own.x] = made; }
        workgroupBarrier();
    }
}
