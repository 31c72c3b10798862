//! Needs of a frame, by its counters.

use crate::methods::facet_masks::{Capacities, status};

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
    /// Of a frame with the capacities `now` and these status words.
    pub fn of(words: &[u32], now: Capacities) -> Self {
        // A set flag: more than 2^32. No list can hold them, but those of a part of the facets may fit.
        let of = |count: u32, flag: u32| if flag != 0 { u64::from(u32::MAX) } else { u64::from(count) };
        let camera = [status::PIXEL_TRIANGLES, status::COMPLEX_PIXELS, status::FACETS];
        let needs = Self {
            camera: camera.map(|at| of(words[at], words[at + 1])),
            longest_pixel: words[status::LONGEST_PIXEL],
            ..Self::default()
        };
        bands(now).fold(needs, |needs, first| {
            let band = &words[first..first + status::BAND_WORDS];
            needs.or(Self {
                pixel_pairs: of(band[0], band[1]),
                triangle_pairs: of(band[2], band[3]),
                candidates: u64::from(band[4]),
                longest: band[6],
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

/// First status words of all bands of all views.
pub(super) fn bands(now: Capacities) -> impl Iterator<Item = usize> {
    (0..now.views).flat_map(move |view| (0..now.bands).map(move |band| status::band(view, band, now.bands)))
}
