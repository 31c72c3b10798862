// Sums over rectangles of a map, by four reads of its summed-area table `sat`: row-major, `size.x` words a
// row, element (x, y) the sum over all texels (i, j) with i <= x and j <= y, modulo 2^32.

//@needs var<storage, read> sat: array<u32>;

// The sum over texels (i, j) with low.x <= i <= high.x and low.y <= j <= high.y, modulo 2^32: exact whenever
// the true sum is below 2^32. `high` beyond the map is taken as its last texel; a rectangle without texels
// has sum 0.
fn rect_sum(size: vec2<u32>, low: vec2<u32>, high: vec2<u32>) -> u32 {
    let last = min(high, size - 1u);
    // One condition: for values of uniforms that a condition asks for alone llvmpipe compiles the kernel
    // anew.
    if any(size == vec2(0u)) | any(low > last) { return 0u; }
    var sum = sat[last.y * size.x + last.x];
    if low.x > 0u { sum -= sat[last.y * size.x + low.x - 1u]; }
    if low.y > 0u { sum -= sat[(low.y - 1u) * size.x + last.x]; }
    if low.x > 0u && low.y > 0u { sum += sat[(low.y - 1u) * size.x + low.x - 1u]; }
    return sum;
}
