// The depth that parts the nearest layer of a texel from all others: half way between the first and the
// second surface at the texel's centre; beyond everything where there is no second.

const BEYOND = 3.0e38;

fn depth_of_key(key: u32) -> f32 {
    return bitcast<f32>(~key);
}

fn key_of_depth(depth: f32) -> u32 {
    return ~bitcast<u32>(max(depth, 0.0));
}

fn split_depth(nearest_key: u32, second_key: u32) -> f32 {
    if second_key == 0u { return BEYOND; }
    return 0.5 * depth_of_key(nearest_key) + 0.5 * depth_of_key(second_key);
}

// State of a texel, as one number (array `splits`):
//   MARKED     silhouettes, or layers that are not certain: evaluate what lies here
//   UNCOVERED  no caster anywhere in the texel
//   else       one sheet covers the whole texel in front of this depth, all else lies behind it
const MARKED = -2.0;
const UNCOVERED = -1.0;
