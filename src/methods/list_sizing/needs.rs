//! Needs of a frame, by its counters.

use crate::status::{Need, Status};

/// How long the lists of a frame should have been. Of lists behind one that was too short it is what the shorter one made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Pixel-texel pairs of the band with most.
    pub pixel_pairs: u64,
    /// Triangle-texel pairs of the band with most.
    pub triangle_pairs: u64,
    /// Candidates of the band with most.
    pub candidates: u64,
    /// Triangles over the place of the map with most, where above seven eighths of a round.
    pub longest: u32,
    /// Triangles in the lists of all pixels, pixels that may show several surfaces, facets.
    pub camera: [u64; 3],
    /// Triangles over the pixel with most.
    pub longest_pixel: u32,
}

impl Needs {
    /// Needs of a frame with this status.
    pub fn of(status: &Status) -> Self {
        let head = &status.head;
        let needs = Self {
            camera: [head.pixel_triangles, head.complex_pixels, head.facets_needed].map(Need::items),
            longest_pixel: head.longest_pixel,
            ..Self::default()
        };
        status.bands.iter().fold(needs, |needs, band| {
            needs.or(Self {
                pixel_pairs: band.pixel_pairs.items(),
                triangle_pairs: band.triangle_pairs.items(),
                candidates: u64::from(band.candidates),
                longest: band.longest,
                ..Self::default()
            })
        })
    }

    /// Needs that hold both.
    pub fn or(self, other: Self) -> Self {
        let [a, b] = [self.camera, other.camera];
        Self {
            pixel_pairs: self.pixel_pairs.max(other.pixel_pairs),
            triangle_pairs: self.triangle_pairs.max(other.triangle_pairs),
            candidates: self.candidates.max(other.candidates),
            longest: self.longest.max(other.longest),
            camera: [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])],
            longest_pixel: self.longest_pixel.max(other.longest_pixel),
        }
    }
}
