//! Definition of a picture's place in a texture, and of a complete frame.

use subpixel_shadows::status::{Need, Status, StatusBand};

/// Texel (column, row) of each pixel of an image of `width` columns, with its value; pixels are numbered row by row from the
/// top left.
pub fn texels(visibility: &[f32], width: usize) -> Vec<([usize; 2], f32)> {
    visibility.iter().enumerate().map(|(p, &v)| ([p % width.max(1), p / width.max(1)], v)).collect()
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
    fn row_by_row() {
        let got = texels(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], 3);
        assert_eq!(got[2], ([2, 0], 0.3));
        assert_eq!(got[3], ([0, 1], 0.4));
        assert!(texels(&[], 0).is_empty());
    }
}
