// The light's map warped along its axes: of as many texels, those of either axis as wide as a function of
// that axis makes them. Each axis (0: x, 1: y) is cut into AXIS_CELLS cells, which take shares of its texels.
// `axes` holds the exclusive scan of the shares, those of y behind those of x, and their sum; `borders` where
// each warped texel begins, in texels of the map that is not warped, and where the last ends, of x, then y.

//@import frame
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> axes: array<u32>;
//@needs var<storage, read> borders: array<f32>;

const AXIS_CELLS = 1024u;

fn border_of(axis: u32, texel: u32) -> f32 { return borders[axis * (frame.map_size + 1u) + texel]; }

// The warped texel that a place of the map lies in, which must lie on the map.
fn warped_texel(axis: u32, at: f32) -> u32 {
    let side = f32(frame.map_size);
    let place = at * (f32(AXIS_CELLS) / side);
    let cell = min(u32(place), AXIS_CELLS - 1u);
    let first = axis * AXIS_CELLS;
    let start = axes[first];
    let before = axes[first + cell];
    let share = f32(axes[first + cell + 1u] - before) * (place - f32(cell));
    let passed = (f32(before - start) + share) / f32(axes[first + AXIS_CELLS] - start);
    let texel = min(u32(passed * side), frame.map_size - 1u);
    // Rounding may have passed a border: the table of borders is what holds.
    let beyond = select(0u, 1u, at >= border_of(axis, texel + 1u));
    return texel + beyond - select(0u, 1u, at < border_of(axis, texel));
}
