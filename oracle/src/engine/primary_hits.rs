//! Surfaces of the pixels of a band of rows, and their facets.

use super::Clock;
use crate::reference::facet_classify::Part;
use crate::reference::sample_surfaces::{nearest, surfaces};
use crate::reference::triangle_setup::Triangle;
use crate::reference::view::View;
use crate::truth::full_mask;
use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::scene::AlphaTested;

/// The facets of a band of rows, pixel by pixel.
pub(super) struct Seen {
    /// The band's first pixel.
    pub first_pixel: u32,
    /// The facets.
    pub parts: Vec<Part>,
    /// The triangle at the centre of each pixel.
    pub centres: Vec<Option<u32>>,
    /// Pixels whose samples do not all see one surface; 0 with one facet a pixel.
    pub complex: u64,
    /// First facet of each pixel, and the end.
    starts: Vec<u32>,
}

impl Seen {
    /// Of the triangles, some of which may be alpha-tested.
    pub fn new(
        clock: &mut Clock,
        view: &View,
        (triangles, alpha): (&[Triangle], &AlphaTested),
        settings: &Settings,
        rows: Range<u32>,
    ) -> Self {
        let first_pixel = rows.start * view.image[0];
        match settings.facets {
            FacetMode::One => clock.time("camera_visibility", || {
                let centres = nearest(view, triangles, alpha, &[DVec2::splat(0.5)], rows);
                let part = |(pixel, &triangle)| Part { pixel, triangle, seen_by: None };
                let parts: Vec<Part> = (first_pixel..).zip(&centres).map(part).collect();
                let starts = (0..=parts.len() as u32).collect();
                Self { first_pixel, parts, centres, complex: 0, starts }
            }),
            FacetMode::All => clock.time("sample_surfaces", || {
                let samples = settings.samples.offsets();
                let offsets: Vec<DVec2> =
                    samples.iter().map(|o| DVec2::new(f64::from(o[0]), f64::from(o[1]))).collect();
                let seen = nearest(view, triangles, alpha, &offsets, rows);
                let of: Vec<_> = seen.par_chunks(samples.len()).map(surfaces).collect();
                // The first sample is the pixel centre.
                let centres = seen.iter().step_by(samples.len()).copied().collect();
                let every = full_mask(samples.len() as u32);
                let (mut parts, mut starts, mut complex) = (Vec::with_capacity(of.len()), vec![0], 0);
                for (pixel, surfaces) in (first_pixel..).zip(&of) {
                    if surfaces.is_empty() {
                        parts.push(Part { pixel, triangle: None, seen_by: None });
                    }
                    let part = |&(triangle, seen_by): &(u32, u128)| Part {
                        pixel,
                        triangle: Some(triangle),
                        seen_by: Some(seen_by),
                    };
                    parts.extend(surfaces.iter().map(part));
                    complex += u64::from(surfaces.first().is_some_and(|s| s.1 != every));
                    starts.push(parts.len() as u32);
                }
                Self { first_pixel, parts, centres, complex, starts }
            }),
        }
    }

    /// The facets of each pixel.
    pub fn of_pixels(&self) -> impl Iterator<Item = Range<usize>> {
        self.starts.windows(2).map(|w| w[0] as usize..w[1] as usize)
    }
}
