//! Blocks of the light's map that facets ask for, and what is left of a rectangle of texels by them.

/// Texels a side of a block.
const BLOCK: u32 = 8;

/// Blocks of 8 × 8 texels that rectangles (first and last column and row) touch, row by row, of a map of `size` texels a side.
pub fn blocks_of(rects: impl IntoIterator<Item = [u32; 4]>, size: u32) -> Vec<bool> {
    let across = size.div_ceil(BLOCK);
    let mut blocks = vec![false; (across * across) as usize];
    for [x0, y0, x1, y1] in rects.into_iter().map(|rect| rect.map(|c| c / BLOCK)) {
        (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (y * across + x) as usize)).for_each(|k| blocks[k] = true);
    }
    blocks
}

/// The least rectangle that holds all texels of `rect` in requested blocks.
pub fn requested_part(rect: [u32; 4], blocks: &[bool], size: u32) -> Option<[u32; 4]> {
    let across = size.div_ceil(BLOCK);
    let [x0, y0, x1, y1] = rect;
    let texels = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| [x, y]));
    let asked = texels.filter(|[x, y]| blocks[(y / BLOCK * across + x / BLOCK) as usize]);
    asked.fold(None, |found, [x, y]| {
        let [a, b, c, d] = found.unwrap_or([x, y, x, y]);
        Some([a.min(x), b.min(y), c.max(x), d.max(y)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_keeps_what_is_requested() {
        let blocks = blocks_of([[9, 0, 9, 3], [20, 17, 30, 17]], 33);
        assert_eq!(blocks.iter().filter(|b| **b).count(), 1 + 2);
        assert_eq!(requested_part([3, 3, 32, 32], &blocks, 33), Some([8, 3, 31, 23]));
        assert_eq!(requested_part([10, 2, 12, 9], &blocks, 33), Some([10, 2, 12, 7]));
        assert_eq!(requested_part([0, 8, 15, 32], &blocks, 33), None);
    }
}
