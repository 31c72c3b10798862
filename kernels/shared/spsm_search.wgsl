// Which texels a sample's shadow is searched in (Lecocq 2013, sections 4.1 and 6.4), by the pattern of depth tests around it: a row
// of the table `patterns`. Needs the overrides RADIUS, SQUARE and STRETCH.

// Direction of the n-th run of lit texels.
fn towards_lit(pattern: vec4<u32>, n: u32) -> vec2<i32> {
    let code = pattern.x >> (8u * n);
    return vec2(i32(code & 15u), i32((code >> 4u) & 15u)) - 8;
}

// The k-th texel that is searched, from the sample's own: the square row by row, then along each tangent, nearest first, by
// steps of one texel along its longer side, the other rounded.
fn step_of(k: i32, pattern: vec4<u32>) -> vec2<i32> {
    let beyond = k - SQUARE * SQUARE;
    if beyond < 0 { return vec2(k % SQUARE, k / SQUARE) - RADIUS; }
    let place = beyond % max(2 * STRETCH, 1);
    let out = towards_lit(pattern, u32(beyond / max(2 * STRETCH, 1)));
    let way = select(1, -1, (place & 1) == 1) * (RADIUS + 1 + place / 2);
    let along = way * vec2(-out.y, out.x);
    let size = max(abs(out.x), abs(out.y));
    // Rounded down of along / size + 1/2, in integers; nothing is as far as 64 texels away.
    return (2 * along + size + 128 * size) / vec2(2 * size) - 64;
}
