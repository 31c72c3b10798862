//! Which triangles the samples of a pixel may see.

use super::camera_visibility::DepthMargin;
use super::sample_surfaces::{Sample, see};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::DVec2;

/// Triangles that must be listed at a pixel, seen at some places of its square.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListedPixel {
    /// Triangles that some place surely sees, rising.
    pub seen: Vec<u32>,
    /// Whether some place surely sees nothing.
    pub open: bool,
}

/// Looks at `places` of each pixel, in `[0, 1]²`. What is within `doubt` of another answer is left out.
pub fn pixels(view: &View, triangles: &[Triangle], places: &[DVec2], doubt: DepthMargin) -> Vec<ListedPixel> {
    let samples = see(view, triangles, places, doubt);
    samples.chunks(places.len().max(1)).map(pixel).collect()
}

fn pixel(samples: &[Sample]) -> ListedPixel {
    let mut seen: Vec<u32> = samples.iter().filter(|s| !s.open).filter_map(|s| s.triangle).collect();
    seen.sort_unstable();
    seen.dedup();
    ListedPixel { seen, open: samples.iter().any(|s| !s.open && s.triangle.is_none()) }
}

/// Whether the box of what is seen of a triangle comes within `reach` pixels of a pixel's square: none else may be listed.
pub fn may_touch(triangle: &Triangle, x: u32, y: u32, reach: f64) -> bool {
    let corner = DVec2::new(f64::from(x), f64::from(y));
    triangle.image.is_some_and(|(lo, hi)| {
        let (lo, hi) = (lo - reach, hi + reach);
        corner.x <= hi.x && corner.y <= hi.y && corner.x + 1.0 >= lo.x && corner.y + 1.0 >= lo.y
    })
}
