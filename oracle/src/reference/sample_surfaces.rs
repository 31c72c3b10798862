//! Which surface each sample sees, and the facets made of that.

use super::camera_visibility::{CentreHit, DepthMargin, Shape, judge};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;
use subpixel_shadows::scene::AlphaTested;

/// Surface at a sample, as at a pixel centre.
pub type Sample = CentreHit;

/// One surface of a pixel: triangle, and the samples that see it.
pub type Surface = (u32, u128);

/// Surfaces at the samples at `offsets` (in `[0, 1]²`, from the pixel's corner) of all pixels, pixel by pixel.
pub fn see(view: &View, triangles: &[Triangle], offsets: &[DVec2], doubt: DepthMargin) -> Vec<Sample> {
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

/// The nearest triangle at each of `offsets` in each pixel of some rows, of equally near ones the lowest: what [`see`] says
/// without doubt, found without looking at triangles that lie behind all of a pixel or beside it. Alpha-tested ones are seen where they are
/// solid.
pub fn nearest(
    view: &View,
    triangles: &[Triangle],
    alpha: &AlphaTested,
    offsets: &[DVec2],
    rows: Range<u32>,
) -> Vec<Option<u32>> {
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); rows.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        let Some((lo, hi)) = triangle.image else { continue };
        let (first, last) = ((lo.y - 2.0).max(f64::from(rows.start)), (hi.y + 2.0).min(f64::from(rows.end) - 1.0));
        if first <= last {
            (first as u32..=last as u32).for_each(|row| lists[(row - rows.start) as usize].push(t as u32));
        }
    }
    let (width, count) = (view.image[0] as usize, offsets.len());
    let row = |(y, list): (u32, &Vec<u32>)| {
        let mut kept = vec![(f64::INFINITY, u32::MAX); width * count];
        // What all samples of a pixel see is nearer than this.
        let mut farthest = vec![f64::INFINITY; width];
        for &t in list {
            let triangle = &triangles[t as usize];
            let (Some(corners), Some((lo, hi))) = (triangle.corners, triangle.image) else { continue };
            let (first, last) = ((lo.x - 2.0).max(0.0), (hi.x + 2.0).min(width as f64 - 1.0));
            if first > last {
                continue;
            }
            let shape = Shape::new(corners);
            let depths = shape.depths(view);
            for x in first as usize..=last as usize {
                let corner = DVec2::new(x as f64, f64::from(y));
                if depths.0 > farthest[x] || shape.misses(view, corner + 0.5) {
                    continue;
                }
                let samples = &mut kept[x * count..(x + 1) * count];
                for (best, &offset) in samples.iter_mut().zip(offsets) {
                    if let Some(depth) = shape.depth(view, corner + offset, depths)
                        && (depth, t) < *best
                        && triangle.tested.is_none_or(|place| shape.is_solid(view, corner + offset, alpha, place))
                    {
                        *best = (depth, t);
                    }
                }
                farthest[x] = samples.iter().fold(0.0, |far, s| s.0.max(far));
            }
        }
        kept.into_iter().map(|(_, t)| (t != u32::MAX).then_some(t)).collect::<Vec<_>>()
    };
    rows.into_par_iter().zip(&lists).flat_map_iter(row).collect()
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
    use super::*;
    use crate::reference::triangle_setup::setup;
    use crate::reference::vertex_project::project;
    use lab::scene::builtin;
    use subpixel_shadows::light_view::LightView;

    #[test]
    fn a_surface_has_the_triangle_that_most_of_its_samples_see() {
        let surface_of = [0, 1, 1, 1, 0];
        let seen = [Some(2), Some(0), Some(3), Some(3), None, Some(4), Some(2), Some(1)];
        assert_eq!(merged(&seen, &surface_of), [(2, 0b1100_1101), (0, 0b10_0010)], "2 comes before 3, 0 before 4");
        assert_eq!(merged(&seen[1..], &surface_of), [(0, 0b1_0001), (3, 0b110_0110)]);
        let alone = [0, 1, 2, 3, 4];
        assert_eq!(merged(&seen, &alone), surfaces(&seen));
    }

    /// The search that skips triangles finds what a search of all triangles finds.
    #[test]
    fn the_nearest_is_what_is_seen() {
        for name in ["windmill", "plane"] {
            let scene = builtin(name).unwrap();
            let map = LightView::fit(&scene.mesh, &scene.light, 1).unwrap();
            let view = View::new(&scene.camera, &scene.light, &map, scene.mesh.bounds().unwrap(), [32, 24], false);
            let vertices = project(&view, &scene.mesh.positions);
            let triangles = setup(&view, &vertices, &scene.mesh.triangles, &[]);
            let offsets = [[0.5, 0.5], [0.0, 0.0], [0.99, 0.01], [0.25, 0.75]].map(|[x, y]| DVec2::new(x, y));
            let all = see(&view, &triangles, &offsets, DepthMargin { edge: 0.0, depth: 0.0 });
            let all: Vec<_> = all.into_iter().map(|s| s.triangle).collect();
            let found: Vec<_> = [0..5, 5..6, 6..24]
                .into_iter()
                .flat_map(|rows| nearest(&view, &triangles, &AlphaTested::default(), &offsets, rows))
                .collect();
            assert!(all == found, "{name}");
            assert!(all.contains(&None) && all.iter().flatten().count() > 1000, "{name}");
            assert!(
                all != nearest(&view, &triangles[1..], &AlphaTested::default(), &offsets, 0..24),
                "{name}: other triangles are seen"
            );
        }
    }

    #[test]
    fn surfaces_come_in_the_order_of_their_first_samples() {
        assert_eq!(surfaces(&[None, Some(7), Some(2), Some(7), None]), [(7, 0b1010), (2, 0b100)]);
        assert_eq!(surfaces(&[None; 8]), []);
    }
}
