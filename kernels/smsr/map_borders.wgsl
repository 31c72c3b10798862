// Borders between texels that are dark and texels that are not, and the lines that are drawn in their place
// (smsr).

//@import frame receiver
//@needs override REACH: u32;
//@needs override MIDPOINTS: u32;
//@needs override BIAS_SLOPE: f32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> nearest_keys: array<u32>;

// The receiver's plane over the texels: depth per texel to the right and down, and less the bias at the place
// of the first sample that meets it.
struct Plane {
    slope: vec2<f32>,
    place: vec2<f32>,
    depth: f32,
}

// Whether something lies before the plane in a texel; nothing does beyond the map.
fn is_dark(plane: Plane, texel: vec2<i32>) -> bool {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return false; }
    let key = nearest_keys[u32(texel.y * side + texel.x)];
    let away = middle_of(texel) - plane.place;
    let bend = BIAS_SLOPE * max(abs(plane.slope.x), abs(plane.slope.y)) * max(abs(away.x), abs(away.y));
    return key != 0u && bitcast<f32>(~key) < plane.depth + dot(plane.slope, away) - bend;
}

// The line that is drawn beside a border of a texel: `first` is where the border begins along the texels and
// `length` how long it is, 0 for none. `ends` is how far from the border the line runs at its beginning and
// at its end, in texels.
struct Line {
    first: f32,
    length: f32,
    ends: vec2<f32>,
}

// Follows the border of `texel`, whose state is `own`, towards the texel at `across`, whose state is the
// other.
fn line_of(plane: Plane, texel: vec2<i32>, across: vec2<i32>, own: bool, opposite: bool) -> Line {
    let along = abs(across.yx);
    // To either side: how far it goes on, and how it ends.
    var steps = vec2(f32(REACH));
    var ends = vec2(0.0);
    for (var side = 0u; side < 2u; side++) {
        let step = select(along, -along, side == 0u);
        var at = texel;
        for (var k = 0u; k < REACH; k++) {
            at += step;
            let turns_here = is_dark(plane, at) != own;
            let turns_away = is_dark(plane, at + across) == own;
            if turns_here || turns_away {
                let end = select(-0.5, 0.5, turns_here);
                if side == 0u { steps.x = f32(k); ends.x = end; } else { steps.y = f32(k); ends.y = end; }
                break;
            }
        }
    }
    var line: Line;
    line.first = f32(dot(texel, along)) - steps.x;
    line.length = steps.x + steps.y + 1.0;
    line.ends = ends;
    if MIDPOINTS == 0u {
        let height = select(1.0, 0.5, opposite);
        line.ends = select(vec2(0.0), vec2(height), ends > vec2(0.0));
    }
    return line;
}

// How far from its border a line runs at a place along it. Beyond the map, where places are held, nothing is
// between.
fn height_at(line: Line, along: f32) -> f32 {
    if line.length == 0.0 { return -3.0e38; }
    let t = (along - line.first) / line.length;
    if MIDPOINTS == 0u && min(line.ends.x, line.ends.y) == 0.0 { return mix(line.ends.x, line.ends.y, t); }
    let part = 2.0 * t - 1.0;
    return select(line.ends.x, line.ends.y, part > 0.0) * abs(part);
}
