// Which texels a sample's shadow is searched in (Lecocq 2013, sections 4.1 and 6.4), by the pattern of depth
// tests around it: a row of the table `patterns`.

//@needs override RADIUS: i32;
//@needs override STRETCH: i32;
//@needs override SQUARE: i32;

// Direction of the n-th run of lit texels.
fn towards_lit(pattern: vec4<u32>, n: u32) -> vec2<i32> {
    let code = pattern.x >> (8u * n);
    return vec2(i32(code & 15u), i32((code >> 4u) & 15u)) - 8;
}

// The k-th texel of the square that is searched, from the sample's own, row by row.
fn square_step(k: i32) -> vec2<i32> {
    return vec2(k % SQUARE, k / SQUARE) - RADIUS;
}

// The k-th texel beyond it along the tangents, nearest first, by steps of one texel along the tangent's
// longer side, the other rounded.
fn tangent_step(k: i32, pattern: vec4<u32>) -> vec2<i32> {
    let place = k % max(2 * STRETCH, 1);
    let out = towards_lit(pattern, u32(k / max(2 * STRETCH, 1)));
    let way = select(1, -1, (place & 1) == 1) * (RADIUS + 1 + place / 2);
    let along = way * vec2(-out.y, out.x);
    let size = max(abs(out.x), abs(out.y));
    // Rounded down of along / size + 1/2: a quotient of small integers, kept clear of the next by a quarter.
    return vec2<i32>(floor((vec2<f32>(2 * along + size) + 0.25) / f32(2 * size)));
}
