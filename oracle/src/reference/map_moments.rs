//! Moments of the depths of squares of texels.

/// Mean, variance, third and fourth central moment of each cell of `level` of a map of `size` × `size` depths, row by row: of its `2^level` × `2^level` texels, as far as
/// the map has them.
pub fn moments(depths: &[f64], size: u32, level: u32) -> Vec<[f64; 4]> {
    let side = size.div_ceil(1 << level);
    let range = |cell: u32| (cell << level)..((cell + 1) << level).min(size);
    let cell = |k: u32| {
        let texels = || range(k / side).flat_map(|y| range(k % side).map(move |x| depths[(y * size + x) as usize]));
        let count = texels().count() as f64;
        let mean = texels().sum::<f64>() / count;
        let central = |power: i32| texels().map(|d| (d - mean).powi(power)).sum::<f64>() / count;
        [mean, central(2), central(3), central(4)]
    };
    (0..side * side).map(cell).collect()
}
