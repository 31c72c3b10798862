// Coordinates kept in a box.

//@import finite

// A coordinate by its bits; what is no number goes to the low side.
fn within(bits: u32, low: f32, high: f32) -> f32 {
    let x = bitcast<f32>(bits);
    if !is_finite(x) || x < low { return low; }
    return select(x, high, x > high);
}
