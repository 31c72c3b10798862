// The light's view as a quadtree of square pages: level l has 2^l of them a side, of PAGE x PAGE texels
// each. Texels of level PAGE_BASE are those of the frame's map, those of each further level half as large.
// The pages of all levels lie in one grid, the finest on the left, all others one below another on its
// right: nodes, counted row by row.

const PAGE = 32u;
const PAGE_SHIFT = 5u;
const PAGE_TEXELS = 1024u;

override PAGE_BASE: u32 = 3u;
override PAGE_LAST: u32 = 8u;

// Pages a side of the finest level: rows of the grid.
fn finest_side() -> u32 { return 1u << PAGE_LAST; }

// Columns of the grid.
fn tree_width() -> u32 { return 3u << (PAGE_LAST - 1u); }

// Where the pages of a level begin in the grid.
fn tree_corner(level: u32) -> vec2<u32> {
    let side = finest_side();
    return select(vec2(side, side - (2u << level)), vec2(0u), level == PAGE_LAST);
}

fn node_of(level: u32, page: vec2<u32>) -> u32 {
    let at = tree_corner(level) + page;
    return at.y * tree_width() + at.x;
}

// Texels of a level for one of the map.
fn scale_of(level: u32) -> f32 { return bitcast<f32>((127u + level - PAGE_BASE) << 23u); }

// The exponent of a number that is not below 0: it lies between this power of two and the next; -127 of 0,
// 128 of what is no number.
fn exponent_of(x: f32) -> i32 { return i32(bitcast<u32>(x) >> 23u) - 127; }
