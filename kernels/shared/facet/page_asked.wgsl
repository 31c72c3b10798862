// Levels that pixels ask of the tree of pages, and the pages that they touch.

//@import frame map_footprint page_tree divide
//@needs var<uniform> frame: Frame;

const THIRDS = 3u;  // of a level, by which levels are asked for
const SLACK = 0.5;  // texels: whoever reads places samples anew and may round otherwise

override FINER: u32 = 0u;

// The level in thirds of a footprint: that whose texels are no longer than its steps, and FINER beyond it; no
// finer than single precision tells texels apart, and than makes the box of its samples a page long.
fn level_for(f: MapFootprint) -> u32 {
    let square = max(dot(f.right, f.right), dot(f.down, f.down));
    let extent = max(f.high.x - f.low.x, f.high.y - f.low.y);
    let matched = i32(THIRDS * (PAGE_BASE + FINER)) + i32(ceil(clamp(-1.5 * log2(square), -99.0, 99.0)));
    // Half a texel of it is above the rounding of a place.
    let told = min(exponent_of(0.5 * f.w / place_noise()), i32(PAGE_SHIFT) - 1 - exponent_of(extent));
    return u32(clamp(min(matched, i32(THIRDS) * (i32(PAGE_BASE) + told)), 0, i32(THIRDS * PAGE_LAST)));
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
