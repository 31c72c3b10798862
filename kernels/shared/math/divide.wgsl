// Which row and place in it an index is. Dividing integers takes a vector machine one lane at a time; floats
// it divides at once, and what rounding leaves is a step at most.

// Quotient and remainder, exact where the quotient is below 2^22 and `by` below 2^30.
fn divided(index: u32, by: u32) -> vec2<u32> {
    let quotient = u32(f32(index) / f32(by));
    let rest = bitcast<i32>(index - quotient * by);
    let step = select(0, -1, rest < 0) + select(0, 1, rest >= i32(by));
    return vec2(bitcast<u32>(bitcast<i32>(quotient) + step), bitcast<u32>(rest - step * i32(by)));
}
