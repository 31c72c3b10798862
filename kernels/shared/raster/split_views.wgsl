// Light views of slices of what the camera sees, each with a map of frame.map_size texels a side. Needs
// `frame`.

struct SplitViews {
    rows: array<vec4<f32>, 12>,   // three a view: (point, 1) to texel x and y, times the third
    warps: array<vec4<f32>, 12>,  // three a view: texel (x, y, 1, 0) of the whole view likewise
    backs: array<vec4<f32>, 12>,  // three a view: the inverse of that
    ends: vec4<f32>,              // view depth at which each slice ends
    count: u32,
    levels: u32,                  // levels of moments above the texels
    level_stride: u32,            // moments of a view
    far: f32,                     // depth where there is no caster: well beyond that of anything
    level_starts: array<vec4<u32>, 4>,  // where each level begins among the moments of its view
}

@group(0) @binding(1) var<uniform> splits: SplitViews;

// A point in the view of a slice: texel x, y times the divisor, and the divisor, which is at least about 1 in
// the map (times that of the whole view).
fn in_split(view: u32, p: vec4<f32>) -> vec3<f32> {
    let k = 3u * view;
    return vec3(dot(splits.rows[k], p), dot(splits.rows[k + 1u], p), dot(splits.rows[k + 2u], p));
}

// Divisor of the whole view.
fn whole_divisor(p: vec4<f32>) -> f32 {
    return select(1.0, dot(frame.map_w, p), (frame.flags & FLAG_PERSPECTIVE) != 0u);
}

// The slice of a view depth.
fn split_of(depth: f32) -> u32 {
    let beyond = vec4<u32>(vec4(depth) >= splits.ends);
    return min(beyond.x + beyond.y + beyond.z + beyond.w, splits.count - 1u);
}

// Cells a side of a level: the texels are level 0.
fn level_side(level: u32) -> u32 {
    return ((frame.map_size - 1u) >> level) + 1u;
}

fn level_start(level: u32) -> u32 {
    return splits.level_starts[level >> 2u][level & 3u];
}
