//! Which surface each sample sees, and the facets made of that.

use super::camera_visibility::{Doubt, Seen, Shape, judge};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::DVec2;
use rayon::prelude::*;

/// What a sample sees: as a pixel centre.
pub type Sample = Seen;

/// One surface of a pixel: triangle, and the samples that see it.
pub type Surface = (u32, u128);

/// What the samples at `offsets` (in `[0, 1]²`, from the pixel's corner) of all pixels see, pixel by pixel.
pub fn see(view: &View, triangles: &[Triangle], offsets: &[DVec2], doubt: Doubt) -> Vec<Sample> {
    let [width, height] = view.image;
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); height as usize];
    for (t, triangle) in triangles.iter().enumerate() {
        let Some((lo, hi)) = triangle.image else { continue };
        let (first, last) = ((lo.y - 2.0).max(0.0), (hi.y + 2.0).min(f64::from(height) - 1.0));
        if first <= last {
            (first as usize..=last as usize).for_each(|row| rows[row].push(t as u32));
        }
    }
    let row = |(y, list): (usize, &Vec<u32>)| {
        let mut found: Vec<Vec<(f64, f64, u32, bool)>> = vec![Vec::new(); width as usize * offsets.len()];
        for &t in list {
            let triangle = &triangles[t as usize];
            let (Some(corners), Some((lo, hi))) = (triangle.corners, triangle.image) else { continue };
            let shape = Shape::new(corners);
            let (first, last) = ((lo.x - 2.0).max(0.0), (hi.x + 2.0).min(f64::from(width) - 1.0));
            if first > last {
                continue;
            }
            for x in first as usize..=last as usize {
                for (k, &offset) in offsets.iter().enumerate() {
                    let at = DVec2::new(x as f64, y as f64) + offset;
                    if let Some((depth, reach, sure)) = shape.at(view, at, doubt) {
                        found[x * offsets.len() + k].push((depth, reach, t, sure));
                    }
                }
            }
        }
        found.into_iter().map(|candidates| judge(&candidates)).collect::<Vec<_>>()
    };
    rows.par_iter().enumerate().flat_map_iter(row).collect()
}

/// The surfaces of one pixel, in the order of their first samples: each sample that sees one lies in exactly one.
pub fn surfaces(samples: &[Option<u32>]) -> Vec<Surface> {
    let mut out: Vec<Surface> = Vec::new();
    for (k, triangle) in samples.iter().enumerate() {
        let Some(triangle) = *triangle else { continue };
        match out.iter_mut().find(|s| s.0 == triangle) {
            Some(surface) => surface.1 |= 1 << k,
            None => out.push((triangle, 1 << k)),
        }
    }
    out
}

/// The same with the triangles of one surface (`surface_of` each triangle) taken together: each has the triangle that most of
/// its samples see, of several the one of the first sample.
pub fn merged(samples: &[Option<u32>], surface_of: &[u32]) -> Vec<Surface> {
    let named: Vec<_> = samples.iter().map(|seen| seen.map(|t| surface_of[t as usize])).collect();
    let triangles = surfaces(samples);
    let of = |(surface, mask): Surface| {
        let parts = triangles.iter().filter(|(t, _)| surface_of[*t as usize] == surface);
        // The last of the greatest is kept: turned around, that is the first.
        let most = parts.rev().max_by_key(|(_, part)| part.count_ones());
        (most.map_or(surface, |(t, _)| *t), mask)
    };
    surfaces(&named).into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::{merged, surfaces};

    #[test]
    fn a_surface_has_the_triangle_that_most_of_its_samples_see() {
        let surface_of = [0, 1, 1, 1, 0];
        let seen = [Some(2), Some(0), Some(3), Some(3), None, Some(4), Some(2), Some(1)];
        assert_eq!(merged(&seen, &surface_of), [(2, 0b1100_1101), (0, 0b10_0010)], "2 comes before 3, 0 before 4");
        assert_eq!(merged(&seen[1..], &surface_of), [(0, 0b1_0001), (3, 0b110_0110)]);
        let alone = [0, 1, 2, 3, 4];
        assert_eq!(merged(&seen, &alone), surfaces(&seen));
    }

    #[test]
    fn surfaces_come_in_the_order_of_their_first_samples() {
        assert_eq!(surfaces(&[None, Some(7), Some(2), Some(7), None]), [(7, 0b1010), (2, 0b100)]);
        assert_eq!(surfaces(&[None; 8]), []);
    }
}
