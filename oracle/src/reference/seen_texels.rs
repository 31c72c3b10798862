//! Which texels of the light-view map are asked for.

use glam::DVec2;

/// Texels of a map of `size` texels a side that any box (least and greatest corner, in texels) touches, and `reach` texels around them; row
/// by row.
pub fn asked(boxes: impl IntoIterator<Item = [DVec2; 2]>, reach: u32, size: u32) -> Vec<bool> {
    let mut texels = vec![false; (size as usize).pow(2)];
    let (reach, side) = (f64::from(reach), f64::from(size));
    for [low, high] in boxes {
        let (low, high) = (low.floor() - reach, high.floor() + reach);
        if low.cmpge(DVec2::splat(side)).any() || high.cmplt(DVec2::ZERO).any() {
            continue;
        }
        let (low, high) = (low.max(DVec2::ZERO), high.min(DVec2::splat(side - 1.0)));
        for y in low.y as usize..=high.y as usize {
            let row = y * size as usize;
            texels[row + low.x as usize..=row + high.x as usize].fill(true);
        }
    }
    texels
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(low: [f64; 2], high: [f64; 2], reach: u32) -> Vec<usize> {
        let texels = asked([[DVec2::from(low), DVec2::from(high)]], reach, 4);
        texels.iter().enumerate().filter(|t| *t.1).map(|t| t.0).collect()
    }

    #[test]
    fn boxes_ask_for_what_they_touch() {
        assert_eq!(marked([1.2, 0.5], [1.9, 0.5], 0), [1]);
        assert_eq!(marked([1.2, 0.5], [2.0, 1.0], 0), [1, 2, 5, 6]);
        assert_eq!(marked([0.2, 0.5], [0.3, 0.5], 1), [0, 1, 4, 5]);
        // From outside the map its border is within reach, or is not.
        assert_eq!(marked([-0.5, 3.5], [-0.5, 3.5], 1), [8, 12]);
        assert_eq!(marked([-1.5, 3.5], [-1.5, 3.5], 1), [0usize; 0]);
        assert_eq!(marked([-9.0, -9.0], [9.0, 9.0], 0).len(), 16);
    }
}
