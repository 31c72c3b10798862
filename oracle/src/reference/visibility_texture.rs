//! Definition of a picture's place in a texture, and of a complete frame.

use subpixel_shadows::status::{Need, Status, StatusBand};

/// Texel (column, row) of each pixel of an image of `width` columns, with its value; pixels are numbered row by row from the
/// top left.
pub fn texels(visibility: &[f32], width: usize) -> Vec<([usize; 2], f32)> {
    visibility.iter().enumerate().map(|(p, &v)| ([p % width.max(1), p / width.max(1)], v)).collect()
}

/// The 16 bits of the number nearest to a value between 0 and 1, of two equally near the even one: found among all of them.
pub fn half(value: f64) -> u16 {
    // All numbers of 16 bits from 0 to 1, which are as they are ordered.
    let number = |bits: u16| {
        let (exponent, mantissa) = (i32::from(bits >> 10), f64::from(bits & 1023));
        if exponent == 0 { mantissa * 2f64.powi(-24) } else { (1.0 + mantissa / 1024.0) * 2f64.powi(exponent - 15) }
    };
    let above = (0..=0x3c00u16).collect::<Vec<_>>().partition_point(|&bits| number(bits) < value) as u16;
    let below = above.saturating_sub(1);
    let [down, up] = [below, above].map(|bits| (number(bits) - value).abs());
    if down < up || (down == up && below & 1 == 0) { below } else { above }
}

/// The nearest 255th of a value between 0 and 1.
pub fn byte(value: f64) -> u8 {
    (value * 255.0).round() as u8
}

/// The mean of the visibility of several points of a light, each a picture, summed one by one.
pub fn mean(points: &[Vec<f32>]) -> Vec<f32> {
    let pixels = points.first().map_or(0, Vec::len);
    (0..pixels).map(|p| points.iter().fold(0.0, |sum, point| sum + point[p]) / points.len() as f32).collect()
}

/// How long the lists of a frame are: of pixel-texel pairs, triangle-texel pairs, candidates and triangles over a place of the map, all of a
/// band; and with a facet for every surface of triangles in the lists of pixels, complex pixels, facets, and triangles over a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lengths {
    /// Of a band.
    pub band: [u32; 4],
    /// Of the camera's lists.
    pub camera: Option<[u32; 4]>,
}

/// Whether nothing is missing in a frame of the given stamp that left these counters.
pub fn is_complete(status: &Status, faults: &[u32], stamp: u32, lengths: Lengths) -> bool {
    let holds = |need: Need, length: u32| need.items <= length && need.over == 0;
    let band = |band: &StatusBand| {
        let [pixel, triangle, candidates, place] = lengths.band;
        let pairs = holds(band.pixel_pairs, pixel) && holds(band.triangle_pairs, triangle);
        pairs && band.candidates <= candidates && band.longest <= place
    };
    let head = &status.head;
    let camera = lengths.camera.is_none_or(|[triangles, complex, facets, pixel]| {
        let lists = holds(head.pixel_triangles, triangles) && holds(head.complex_pixels, complex);
        lists && holds(head.facets_needed, facets) && head.longest_pixel <= pixel
    });
    head.finished == stamp && camera && status.bands.iter().all(band) && faults.iter().all(|&f| f == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_and_bytes_are_the_nearest() {
        for (value, bits) in [(0.0, 0), (1.0, 0x3c00), (0.5, 0x3800), (0.75, 0x3a00), (2f64.powi(-24), 1), (1e-9, 0)] {
            assert_eq!(half(value), bits, "{value}");
        }
        // Half way between two of them.
        assert_eq!([half(1.5 * 2f64.powi(-24)), half(2.5 * 2f64.powi(-24))], [2, 2]);
        assert_eq!([byte(0.0), byte(0.5), byte(1.0), byte(1.0 / 32.0)], [0, 128, 255, 8]);
    }

    #[test]
    fn row_by_row() {
        let got = texels(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], 3);
        assert_eq!(got[2], ([2, 0], 0.3));
        assert_eq!(got[3], ([0, 1], 0.4));
        assert!(texels(&[], 0).is_empty());
    }
}
