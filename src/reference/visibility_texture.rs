//! Definition of a picture's place in a texture.

/// Texel (column, row) of each pixel of an image of `width` columns, with its value; pixels are numbered row by row from the
/// top left.
pub fn texels(visibility: &[f32], width: usize) -> Vec<([usize; 2], f32)> {
    visibility.iter().enumerate().map(|(p, &v)| ([p % width.max(1), p / width.max(1)], v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_by_row() {
        let got = texels(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], 3);
        assert_eq!(got[2], ([2, 0], 0.3));
        assert_eq!(got[3], ([0, 1], 0.4));
        assert!(texels(&[], 0).is_empty());
    }
}
