//! Which samples of each facet are occluded, and which do not count.
//!
//! The predicate is that of [`crate::truth::predicate`], and what a facet's samples, shadows and validity lines are is
//! written once in [`crate::truth::facet_truth`]; here it looks at the listed triangles alone.

use super::facet_classify::FacetAtPixel;
use super::view::View;
use crate::truth::{FacetInput, FacetResult, FacetTruth, Progress, split_mask};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Judges each facet against its candidates, in parallel; facets without candidates keep `None`. Progress counts facets.
pub fn masks(
    truth: &FacetTruth,
    facets: &[FacetAtPixel],
    candidates: &[Vec<u32>],
    progress: Progress,
) -> Vec<Option<FacetResult>> {
    let done = AtomicUsize::new(0);
    let judge = |(k, part): (usize, &[FacetAtPixel])| -> Vec<Option<FacetResult>> {
        let lists = &candidates[k * PART..];
        let results = part.iter().zip(lists).map(|(facet, list)| {
            let triangle = facet.triangle?;
            let input = FacetInput { pixel: facet.pixel, triangle, coverage: split_mask(facet.coverage) };
            (!list.is_empty()).then(|| truth.judge_among(&input, list))
        });
        let results = results.collect();
        let count = done.fetch_add(part.len(), Ordering::Relaxed) + part.len();
        if let Some(report) = progress {
            report(count, facets.len());
        }
        results
    };
    facets.par_chunks(PART).enumerate().flat_map_iter(judge).collect()
}

/// The half-planes of the image that bound the shadow of a caster on a facet of triangle `own`, found as in Pan 2009, section
/// 3.4: from the light onto the facet's plane, from there onto the screen. Each is what it is at the pixel centre, per pixel
/// right, per pixel down, positive inside; the fourth is that of the caster's own plane, `None` if that does not cross the
/// facet's. `None` at all for a caster with no part over the facet.
///
/// A half-plane holds the projection of a point of it, unless the point lies beyond the centre of the projection: then the
/// other side does (the paper's figure 6).
pub fn two_step(
    view: &View,
    facet: &FacetAtPixel,
    own: [DVec3; 3],
    caster: [DVec3; 3],
) -> Option<([DVec3; 3], Option<DVec3>)> {
    let normal = facet.plane.truncate();
    let height = |p: DVec3| if own.contains(&p) { 0.0 } else { normal.dot(p - own[0]) };
    let heights = caster.map(height);
    if heights.iter().all(|&h| h <= 0.0) {
        return None;
    }
    let (x, y) = (facet.pixel % view.image[0], facet.pixel / view.image[0]);
    let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let sense = |beyond: bool| if beyond { -1.0 } else { 1.0 };
    let on_screen = |p: DVec3| (view.on_image(p) - centre, sense(p.dot(view.rays.forward) < 0.0));
    let thrown: [(DVec2, f64); 3] = std::array::from_fn(|k| {
        let to_light = view.light.truncate() - caster[k] * view.light.w;
        let rise = normal.dot(to_light);
        let (at, side) = on_screen(caster[k] - to_light * (heights[k] / rise));
        (at, side * sense(rise < 0.0))
    });
    let [a, b, c] = thrown;
    let edges = [half_plane(a.0, b.0, c), half_plane(b.0, c.0, a), half_plane(c.0, a.0, b)];
    let mut crossings = (0..3).filter_map(|k| {
        let (n, h, g) = ((k + 1) % 3, heights[k], heights[(k + 1) % 3]);
        ((h > 0.0) != (g > 0.0)).then(|| on_screen(caster[k] + (caster[n] - caster[k]) * (h / (h - g))).0)
    });
    let line = crossings.next().zip(crossings.next());
    let highest = (0..3).max_by(|&i, &j| heights[i].total_cmp(&heights[j])).map(|k| thrown[k]);
    Some((edges, line.zip(highest).map(|((p, q), top)| half_plane(p, q, top))))
}

/// The half-plane bounded by the line through `p` and `q` that holds the point, or if its sense is negative does not.
fn half_plane(p: DVec2, q: DVec2, (point, sense): (DVec2, f64)) -> DVec3 {
    let d = q - p;
    let line = DVec3::new(d.y * p.x - d.x * p.y, -d.y, d.x);
    line * (d.perp_dot(point - p).signum() * sense)
}

/// Facets a task.
const PART: usize = 512;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::facet_classify::{MapAround, Part, classify_parts};
    use crate::reference::front_layer::{Margin, Split};
    use crate::reference::triangle_setup::setup;
    use crate::reference::vertex_project::project;
    use crate::truth::predicate::{Cover, FacetPlane, Plane, Shadow};
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};

    /// The paper's two projections and planes through the eye bound the same shadow, also of casters that reach beneath the
    /// facet, behind the eye and beyond the light.
    #[test]
    fn two_projections_bound_what_pencils_bound() {
        let mut state = 7u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32 * 2.0 - 1.0
        };
        let (mut compared, mut shadowed, mut beneath, mut behind, mut beyond) = (0, 0, 0, 0, 0);
        for round in 0..4000 {
            let mut corner = |size: f32| [unit() * size, unit() * size, unit() * size];
            let own = [[-3.0, 0.0, -3.0], [0.0, 0.0, 4.0], [4.0, 0.0, -2.0]];
            let caster = [corner(1.5), corner(1.5), corner(1.5)];
            let light = [unit() * 2.0, 0.6 + unit() * 0.4, unit() * 2.0];
            let light =
                if round % 2 == 0 { Light::Directional { direction: light } } else { Light::Point { position: light } };
            let mesh = Mesh { positions: [own, caster].concat(), triangles: vec![[0, 1, 2], [3, 4, 5]] };
            let camera = Camera {
                eye: [unit(), 1.0 + unit() * 0.5, 1.0],
                target: [0.0; 3],
                up: [0.0, 1.0, 0.0],
                vertical_fov_degrees: 50.0,
                near: 1e-3,
                far: 1e3,
                lens: Lens::CENTRED,
                near_plane: None,
            };
            let map = LightView::fit(&mesh, &light, 4).unwrap();
            let view = View::new(&camera, &light, &map, mesh.bounds().unwrap(), [16, 12], false);
            let triangles = setup(&view, &project(&view, &mesh.positions), &mesh.triangles, &[]);
            let [own, caster] = [0, 1].map(|t: usize| triangles[t].corners.unwrap());
            let around = MapAround {
                triangles: &triangles,
                marked: &[true; 16],
                splits: &[Split::Marked; 16],
                samples: &[[0.5, 0.5]],
                casters: u32::MAX,
            };
            let pixel = (round * 37) % 192;
            let part = Part { pixel, triangle: Some(0), seen_by: None };
            let facet = &classify_parts(&view, &around, &[0; 16], &[part], Margin::default(), false)[0];
            let ray =
                |x: f64, y: f64| view.rays.direction(f64::from(pixel % 16) + 0.5 + x, f64::from(pixel / 16) + 0.5 + y);
            if facet.plane.truncate().dot(ray(0.0, 0.0)) >= 0.0 {
                continue;
            }
            let plane = Plane::new(own);
            let exact =
                Shadow::new(FacetPlane { plane: &plane, around: f64::INFINITY }, caster, view.light, &view.rays);
            let lines = two_step(&view, facet, own, caster);
            for k in 0..64 {
                let (x, y) = (f64::from(k % 8) / 8.0 - 0.5, f64::from(k / 8) / 8.0 - 0.5);
                let r = ray(x, y);
                let cover = exact.cover(r);
                if matches!(cover, Cover::Near(_)) || plane.normal.dot(r) * plane.distance <= 0.0 {
                    continue;
                }
                let inside = lines
                    .is_some_and(|(edges, own)| edges.into_iter().chain(own).all(|l| l.x + l.y * x + l.z * y > 0.0));
                assert_eq!(inside, cover == Cover::In, "round {round}: {lines:?}");
                (compared, shadowed) = (compared + 1, shadowed + u32::from(inside));
            }
            let normal = facet.plane.truncate();
            beneath += u32::from(caster.iter().any(|p| normal.dot(*p - own[0]) < 0.0) && lines.is_some());
            behind += u32::from(caster.iter().any(|p| p.dot(view.rays.forward) < 0.0));
            let light = view.light.truncate();
            beyond += u32::from(view.light.w > 0.0 && caster.iter().any(|p| normal.dot(light - *p) < 0.0));
        }
        assert!(compared > 100_000 && shadowed > 3_000, "{shadowed} of {compared}");
        assert!(beneath > 500 && behind > 300 && beyond > 500, "{beneath} {behind} {beyond}");
    }
}
