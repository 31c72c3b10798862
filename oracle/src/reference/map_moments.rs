//! Mean and variance of the depths of squares of texels.

/// Mean and variance of each cell of `level` of a map of `size` × `size` depths, row by row: of its `2^level` × `2^level` texels, as far as
/// the map has them.
pub fn moments(depths: &[f64], size: u32, level: u32) -> Vec<[f64; 2]> {
    let side = size.div_ceil(1 << level);
    let range = |cell: u32| (cell << level)..((cell + 1) << level).min(size);
    let cell = |k: u32| {
        let texels = || range(k / side).flat_map(|y| range(k % side).map(move |x| depths[(y * size + x) as usize]));
        let count = texels().count() as f64;
        let mean = texels().sum::<f64>() / count;
        [mean, texels().map(|d| (d - mean).powi(2)).sum::<f64>() / count]
    };
    (0..side * side).map(cell).collect()
}
