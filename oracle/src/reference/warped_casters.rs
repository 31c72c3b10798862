//! The nearest caster at every texel centre of a map whose axes are warped.

use super::page_casters::{Casters, PageTexel};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::DVec2;

/// Middles of the texels between these borders.
pub fn centres(borders: &[f64]) -> Vec<f64> {
    borders.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect()
}

/// The texels, row by row, whose centres lie at these places of either axis, in texels of the even map. An edge within `guard` of these leaves one open.
pub fn texels(view: &View, triangles: &[Triangle], [columns, rows]: [&[f64]; 2], guard: f64) -> Vec<PageTexel> {
    let casters = Casters::new(view, triangles, guard);
    rows.iter().flat_map(|&y| columns.iter().map(move |&x| DVec2::new(x, y))).map(|at| casters.at(at)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::page_casters;
    use super::super::triangle_setup::Reach;
    use super::super::view::Flat;
    use super::*;
    use glam::DVec3;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Light, Mesh};

    #[test]
    fn even_axes_hold_what_a_page_does() {
        let mesh =
            Mesh { positions: vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 1.0]], triangles: vec![[0, 1, 2]] };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let map = LightView::fit(&mesh, &light, 32).unwrap();
        let camera = Camera::look_at([0.0, 3.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 40.0, 0.1);
        let view = View::new(&camera, &light, &map, mesh.bounds().unwrap(), [4, 4], false);
        let corners = [DVec3::new(8.0, 8.0, 0.25), DVec3::new(24.0, 8.0, 0.25), DVec3::new(8.0, 24.0, 0.75)];
        let triangles =
            [Triangle { map: Reach::Flat(Flat::new(corners)), corners: Some(corners), ..Triangle::DROPPED }];
        let even: Vec<f64> = (0..=32).map(f64::from).collect();
        let of = |x: &[f64], y: &[f64]| texels(&view, &triangles, [&centres(x), &centres(y)], 1e-6);
        assert_eq!(of(&even, &even), page_casters::texels(&view, &triangles, 1.0, [0, 0], 1e-6));
        // Three columns in the middle of which the triangle ends.
        let narrow = of(&[8.0, 12.0, 23.0, 32.0], &[8.0, 9.0]);
        assert_eq!(narrow.iter().map(|t| t.nearest.is_some()).collect::<Vec<_>>(), [true, true, false]);
    }
}
