//! Which samples of a pixel a triangle covers, and how far off it is there.

use super::camera_visibility::{DepthMargin, Shape};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::DVec2;
use subpixel_shadows::scene::AlphaTested;

/// A triangle at the samples of one pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Covered {
    /// Samples that it surely covers.
    pub sure: u128,
    /// Samples that it may cover.
    pub possible: u128,
    /// Its depth at each sample it surely covers; rising samples.
    pub depths: Vec<f64>,
}

/// Looks at the samples at `offsets` (in `[0, 1]²`, from the pixel's corner) of the pixel at column `x` and row `y`. Nearer than `doubt` to
/// an edge, to the near distance or to the edge of a hole a sample is only possible.
pub fn covered(
    view: &View,
    triangle: &Triangle,
    alpha: &AlphaTested,
    [x, y]: [u32; 2],
    offsets: &[DVec2],
    doubt: DepthMargin,
) -> Covered {
    let mut out = Covered::default();
    let Some(corners) = triangle.corners else { return out };
    let shape = Shape::new(corners);
    for (k, &offset) in offsets.iter().enumerate() {
        let at = DVec2::new(f64::from(x), f64::from(y)) + offset;
        let Some((depth, _, sure)) = shape.at(view, at, doubt) else { continue };
        let around = [(0.0, 0.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let solid = around.map(|(x, y)| {
            let at = at + doubt.edge * DVec2::new(x, y);
            triangle.tested.is_none_or(|place| shape.is_solid(view, at, alpha, place))
        });
        if !solid.contains(&true) {
            continue;
        }
        out.possible |= 1 << k;
        if sure && !solid.contains(&false) {
            out.sure |= 1 << k;
            out.depths.push(depth);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::triangle_setup::setup;
    use crate::reference::vertex_project::project;
    use lab::scene::builtin;
    use subpixel_shadows::light_view::LightView;

    /// A plane is seen at all samples or at none, at the depth of its points; a sample on an edge is only possible.
    #[test]
    fn a_plane_covers_what_lies_in_its_outline() {
        let scene = builtin("plane").unwrap();
        let map = LightView::fit(&scene.mesh, &scene.light, 1).unwrap();
        let bounds = scene.mesh.bounds().unwrap();
        let view = View::new(&scene.camera, &scene.light, &map, bounds, [32, 24], false);
        let vertices = project(&view, &scene.mesh.positions);
        let triangles = setup(&view, &vertices, &scene.mesh.triangles, &[]);
        let doubt = DepthMargin { edge: 1e-9, depth: 1e-9 };
        let offsets = [[0.5, 0.5], [0.25, 0.75]].map(|[x, y]| DVec2::new(x, y));
        let (mut sure, mut none) = (0, 0);
        for triangle in &triangles {
            for pixel in (0..24).flat_map(|y| (0..32).map(move |x| [x, y])) {
                let got = covered(&view, triangle, &AlphaTested::default(), pixel, &offsets, doubt);
                assert_eq!(got.sure & !got.possible, 0);
                assert_eq!(got.depths.len(), got.sure.count_ones() as usize);
                sure += got.sure.count_ones();
                none += usize::from(got.possible == 0);
                assert!(got.depths.iter().all(|&depth| depth >= view.near));
            }
        }
        assert!(sure > 100 && none > 100, "{sure} samples covered, {none} pixels not");
    }
}
