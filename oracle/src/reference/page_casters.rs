//! The nearest caster at every texel centre of a page.

use super::light_layers::depth_in_front;
use super::triangle_setup::{Reach, Triangle};
use super::view::{Flat, View};
use glam::DVec2;

/// Texels a side of a page.
pub const PAGE: u32 = 32;

/// A texel of a page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PageTexel {
    /// Depth of the nearest caster.
    pub nearest: Option<f64>,
    /// Change of it for a texel of the map to either side, the sum of both.
    pub slope: f64,
    /// An edge passes the centre within the guard.
    pub open: bool,
}

/// The texels of a page, row by row, on a level that has `scale` texels for one of the map. An edge within `guard` texels of the map leaves
/// a texel open.
pub fn texels(view: &View, triangles: &[Triangle], scale: f64, page: [u32; 2], guard: f64) -> Vec<PageTexel> {
    let casters = Casters::new(view, triangles, guard);
    let corner = page.map(|at| f64::from(at * PAGE));
    let place = |k: u32| DVec2::new(corner[0] + f64::from(k % PAGE) + 0.5, corner[1] + f64::from(k / PAGE) + 0.5);
    (0..PAGE * PAGE).map(|k| casters.at(place(k) / scale)).collect()
}

/// Casters that are asked for the nearest at places of the map.
#[derive(Debug)]
pub(super) struct Casters<'a> {
    view: &'a View,
    figures: Vec<(Option<Flat>, &'a Triangle)>,
    guard: f64,
}

impl<'a> Casters<'a> {
    /// An edge within `guard` texels of the map leaves a texel open.
    pub(super) fn new(view: &'a View, triangles: &'a [Triangle], guard: f64) -> Self {
        let figures = triangles.iter().filter(|t| t.map != Reach::Nowhere).map(|t| (t.flat(), t)).collect();
        Self { view, figures, guard }
    }

    /// The texel whose centre lies there.
    pub(super) fn at(&self, at: DVec2) -> PageTexel {
        let mut texel = PageTexel::default();
        for (flat, triangle) in &self.figures {
            let found = match (flat, triangle.corners) {
                (Some(flat), _) => {
                    let inside = flat.inside(at).into_iter().fold(f64::INFINITY, f64::min);
                    texel.open |= flat.is_thin() && inside > -64.0 * self.guard;
                    Some((flat.depth(at), inside, flat.slope.map_or(0.0, |s| s.abs().element_sum())))
                }
                (None, Some(corners)) => {
                    depth_in_front(self.view, corners, at).map(|(depth, inside)| (depth, inside, 0.0))
                }
                _ => None,
            };
            let Some((depth, inside, slope)) = found else { continue };
            texel.open |= inside.abs() <= self.guard;
            if inside >= 0.0 && texel.nearest.is_none_or(|nearest| depth < nearest) {
                texel.nearest = Some(depth);
                texel.slope = slope;
            }
        }
        texel
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Light, Mesh};

    #[test]
    fn a_page_holds_what_a_map_of_its_level_would() {
        let mesh =
            Mesh { positions: vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 1.0]], triangles: vec![[0, 1, 2]] };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let map = LightView::fit(&mesh, &light, 64).unwrap();
        let camera = Camera::look_at([0.0, 3.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 40.0, 0.1);
        let view = View::new(&camera, &light, &map, mesh.bounds().unwrap(), [4, 4], false);
        let corners = [DVec3::new(8.0, 8.0, 0.25), DVec3::new(24.0, 8.0, 0.25), DVec3::new(8.0, 24.0, 0.75)];
        let flat = Flat::new(corners);
        let triangle = Triangle { map: Reach::Flat(flat), corners: Some(corners), ..Triangle::DROPPED };
        let texels = |scale: f64, page| super::texels(&view, &[triangle], scale, page, 1e-6);
        let count = |texels: &[PageTexel]| texels.iter().filter(|t| t.nearest.is_some()).count();
        let of_map = texels(1.0, [0, 0]);
        assert!(count(&of_map) >= 120 && count(&of_map) <= 136, "half of 16 x 16 texels");
        let pages = (0..9).map(|k| [k % 3, k / 3]);
        let finer: usize = pages.map(|page| count(&texels(4.0, page))).sum();
        assert!((15 * 128..=17 * 128).contains(&finer), "16 times as many: {finer}");
        let at = of_map[(16 * PAGE + 10) as usize];
        assert!((at.nearest.unwrap() - (0.25 + 0.5 * 8.5 / 16.0)).abs() < 1e-12, "{at:?}");
    }
}
