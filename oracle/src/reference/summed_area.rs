//! Definition of the summed-area table and of the sum over a rectangle.

/// The table of a row-major map: element `(x, y)` is the sum over all texels `(i, j)` with `i ≤ x` and `j ≤ y`,
/// modulo 2^32.
pub fn table(texels: &[u32], width: usize) -> Vec<u32> {
    let mut above = vec![0u32; width];
    let mut sat = Vec::with_capacity(texels.len());
    for row in texels.chunks(width.max(1)) {
        let mut sum = 0u32;
        for (above, &texel) in above.iter_mut().zip(row) {
            sum = sum.wrapping_add(texel);
            *above = above.wrapping_add(sum);
            sat.push(*above);
        }
    }
    sat
}

/// One bit a texel (set where it is not 0): bit `x % 32` of word `x / 32` of its row, each row padded to whole words.
pub fn pack(texels: &[u32], width: usize) -> Vec<u32> {
    let word = |texels: &[u32]| texels.iter().enumerate().fold(0, |word, (x, &t)| word | u32::from(t != 0) << x);
    texels.chunks(width.max(1)).flat_map(|row| row.chunks(32).map(word)).collect()
}

/// The map, one `u32` a texel, that `words` hold one bit a texel.
pub fn unpack(words: &[u32], width: usize) -> Vec<u32> {
    let row = |words: &[u32]| (0..width).map(|x| words[x / 32] >> (x % 32) & 1).collect::<Vec<_>>();
    words.chunks(width.div_ceil(32).max(1)).flat_map(row).collect()
}

/// The sum over texels `(i, j)` with `x0 ≤ i ≤ x1` and `y0 ≤ j ≤ y1`, modulo 2^32, by four reads of the table.
/// Beyond the map there is nothing; a rectangle without texels has sum 0.
pub fn rect_sum(sat: &[u32], width: usize, [x0, y0, x1, y1]: [usize; 4]) -> u32 {
    let height = sat.len().checked_div(width).unwrap_or(0);
    let (x1, y1) = (x1.min(width.wrapping_sub(1)), y1.min(height.wrapping_sub(1)));
    if sat.is_empty() || x0 > x1 || y0 > y1 {
        return 0;
    }
    // The sum over the `x` first columns and `y` first rows.
    let corner = |x: usize, y: usize| if x == 0 || y == 0 { 0 } else { sat[(y - 1) * width + x - 1] };
    corner(x1 + 1, y1 + 1)
        .wrapping_sub(corner(x0, y1 + 1))
        .wrapping_sub(corner(x1 + 1, y0))
        .wrapping_add(corner(x0, y0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_sum_their_texels() {
        let (width, height) = (7, 5);
        let texels: Vec<u32> = (0..width * height).map(|i| (i as u32).wrapping_mul(0x9e37_79b9)).collect();
        let sat = table(&texels, width);
        for y0 in 0..height {
            for y1 in 0..height + 2 {
                for x0 in 0..width + 1 {
                    for x1 in 0..width + 2 {
                        let inside = (0..width * height)
                            .filter(|i| (x0..=x1).contains(&(i % width)) && (y0..=y1).contains(&(i / width)));
                        let sum = inside.fold(0u32, |sum, i| sum.wrapping_add(texels[i]));
                        assert_eq!(rect_sum(&sat, width, [x0, y0, x1, y1]), sum, "{x0},{y0} to {x1},{y1}");
                    }
                }
            }
        }
    }

    #[test]
    fn packing_keeps_bits() {
        for width in [1, 31, 32, 33, 64, 65] {
            let texels: Vec<u32> = (0..width * 3).map(|i| (i % 3 == 1) as u32).collect();
            let words = pack(&texels, width);
            assert_eq!(words.len(), 3 * width.div_ceil(32));
            assert_eq!(unpack(&words, width), texels);
        }
        assert_eq!(table(&[], 0), Vec::<u32>::new());
    }
}
