// Sides of the light's map beyond which parts of large casters were left out (FLAG_ENDS): what goes on beyond
// them, facets and casters, meets in all texels at them. A bit a side: lowest x, highest x, lowest y, highest
// y.

//@import frame
//@needs var<uniform> frame: Frame;

// The ends that a box of the map goes beyond.
fn ends_beyond(low: vec2<f32>, high: vec2<f32>) -> u32 {
    let size = f32(frame.map_size);
    let over = select(vec4(0u), vec4(1u, 2u, 4u, 8u),
        vec4(low.x, -high.x, low.y, -high.y) < vec4(0.0, -size, 0.0, -size));
    return ((over.x | over.y | over.z | over.w) * FLAG_ENDS) & frame.flags;
}

// The ends that cells from `low` to `high` of a map of so many a side lie at.
fn ends_at(low: vec2<u32>, high: vec2<u32>, across: u32) -> u32 {
    let at = select(vec4(0u), vec4(1u, 2u, 4u, 8u),
        vec4(low.x == 0u, high.x + 1u == across, low.y == 0u, high.y + 1u == across));
    return ((at.x | at.y | at.z | at.w) * FLAG_ENDS) & frame.flags;
}

// The ends that a triangle goes beyond, by its corners of `map_points`; one that does not lie in front of the
// light may go beyond any.
fn ends_of_triangle(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> u32 {
    let in_front = min(a.w, min(b.w, c.w)) > 0.0;
    let low = select(vec2(-3.0e38), min(min(a.xy, b.xy), c.xy), in_front);
    let high = select(vec2(3.0e38), max(max(a.xy, b.xy), c.xy), in_front);
    return ends_beyond(low, high);
}
