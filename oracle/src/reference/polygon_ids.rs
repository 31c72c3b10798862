//! Shadows by whose polygon lies nearest to the light at a texel's centre (Hourcade, Nicolas 1985).

use super::kept_triangles::KeptLookup;
use glam::DVec2;

/// A map of triangles and the polygons they are of.
#[derive(Clone, Copy, Debug)]
pub struct PolygonLookup<'a> {
    /// The map, and how many texels a side are asked; its bias means nothing.
    pub map: KeptLookup<'a>,
    /// Of each triangle the lowest of its polygon.
    pub surfaces: &'a [u32],
}

impl PolygonLookup<'_> {
    /// Whether a place of triangle `receiver` is lit; `None` where that depends on a triangle that is edge-on to the light.
    pub fn is_lit(&self, place: DVec2, receiver: u32) -> Option<bool> {
        let own = KeptLookup { lookups: 1, ..self.map };
        if own.asked(place).is_empty() {
            return Some(true);
        }
        let mut lit = Some(false);
        for t in self.map.asked(place) {
            let same = self.surfaces[t as usize] == self.surfaces[receiver as usize];
            match if same { Some(true) } else { self.map.is_beside(receiver, t) } {
                Some(true) => return Some(true),
                Some(false) => {}
                None => lit = None,
            }
        }
        lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::triangle_setup::setup;
    use crate::reference::vertex_project::project;
    use crate::reference::view::View;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{AlphaTested, Camera, Light, Mesh};

    /// A floor of two triangles, a slope at its edge, and a roof: texels that keep each of them.
    #[test]
    fn what_is_its_own_or_beside_it_is_lit() {
        let mesh = Mesh {
            positions: vec![
                [-4.0, 0.0, -4.0],
                [4.0, 0.0, -4.0],
                [-4.0, 0.0, 4.0],
                [4.0, 0.0, 4.0],
                [6.0, 1.0, 0.0],
                [-1.0, 1.0, -1.0],
                [1.0, 1.0, -1.0],
                [0.0, 1.0, 1.0],
            ],
            triangles: vec![[0, 2, 1], [1, 2, 3], [1, 3, 4], [5, 7, 6]],
        };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let (low, high) = mesh.bounds().expect("a mesh");
        let camera = Camera::framing(low, high);
        let map = LightView::fit(&mesh, &light, 32).expect("a light view");
        let view = View::new(&camera, &light, &map, (low, high), [4, 4], false);
        let triangles = setup(&view, &project(&view, &mesh.positions), &mesh.triangles, &[]);
        let place = DVec2::splat(16.5);
        let alpha = AlphaTested::default();
        let lit = |centre: Option<u32>, beside: Option<u32>, receiver, lookups| {
            let mut kept = vec![None; 32 * 32];
            kept[16 * 32 + 16] = centre;
            kept[16 * 32 + 17] = beside;
            let map = KeptLookup {
                view: &view,
                triangles: &triangles,
                vertices: &mesh.triangles,
                alpha: &alpha,
                kept: &kept,
                lookups,
                bias: 0.0,
            };
            PolygonLookup { map, surfaces: &[0, 0, 2, 3] }.is_lit(place, receiver)
        };
        assert_eq!(lit(None, Some(3), 0, 1), Some(true), "nothing is there");
        assert_eq!([0, 1].map(|t| lit(Some(t), None, 0, 1)), [Some(true); 2], "its own polygon");
        assert_eq!(lit(Some(2), None, 1, 1), Some(true), "beside it");
        assert_eq!(lit(Some(2), None, 0, 1), Some(false), "no edge in common");
        assert_eq!(lit(Some(3), Some(0), 1, 1), Some(false));
        assert_eq!(lit(Some(3), Some(0), 1, 3), Some(true), "a neighbour tells");
        assert_eq!(lit(Some(3), None, 1, 3), Some(false));
    }
}
