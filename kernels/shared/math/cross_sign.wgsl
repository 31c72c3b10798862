// The sign of a cross product of whole numbers of up to 31 bits, exact: 32 bits do not hold the products.

// a * b as a number of 64 bits in two's complement: high word, low word.
fn wide_product(a: i32, b: i32) -> vec2<u32> {
    let x = u32(abs(a));
    let y = u32(abs(b));
    let low = (x & 0xffffu) * (y & 0xffffu);
    let middle = (x >> 16u) * (y & 0xffffu) + (low >> 16u);
    let other = (x & 0xffffu) * (y >> 16u) + (middle & 0xffffu);
    let size = vec2((x >> 16u) * (y >> 16u) + (middle >> 16u) + (other >> 16u),
        (other << 16u) | (low & 0xffffu));
    if (a < 0) == (b < 0) { return size; }
    return vec2(~size.x + select(0u, 1u, size.y == 0u), ~size.y + 1u);
}

// The sign of a.x * b.y - a.y * b.x.
fn cross_sign(a: vec2<i32>, b: vec2<i32>) -> i32 {
    let p = wide_product(a.x, b.y);
    let q = wide_product(a.y, b.x);
    if all(p == q) { return 0; }
    let high = bitcast<vec2<i32>>(vec2(p.x, q.x));
    return select(-1, 1, high.x > high.y || (high.x == high.y && p.y > q.y));
}
