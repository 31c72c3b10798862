//! Shadows of the triangles that the texels of a map keep (Dai, Yang, Feng 2008), in the light's view.

use super::light_layers::{depth_in_front, shares_at};
use super::triangle_setup::Triangle;
use super::view::View;
use glam::{DVec2, DVec3};
use subpixel_shadows::scene::AlphaTested;

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct KeptLookup<'a> {
    /// Camera, light and light view.
    pub view: &'a View,
    /// The triangles.
    pub triangles: &'a [Triangle],
    /// Vertices of each.
    pub vertices: &'a [[u32; 3]],
    /// Where they have holes.
    pub alpha: &'a AlphaTested,
    /// Of each texel, row by row, the triangle that is nearest at its centre.
    pub kept: &'a [Option<u32>],
    /// Texels a side that are asked around a place.
    pub lookups: u32,
    /// Depth by which a triangle must lie before a place.
    pub bias: f64,
}

/// How far places and depths may be off: what depends on less is not told.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeptMargin {
    /// Texels.
    pub place: f64,
    /// Depth.
    pub depth: f64,
}

impl KeptLookup<'_> {
    /// The triangles that a place asks.
    pub fn asked(&self, place: DVec2) -> Vec<u32> {
        let size = i64::from(self.view.map.map_size);
        let reach = i64::from(self.lookups / 2);
        let around = |at: f64| (at.floor() as i64 - reach).max(0)..=(at.floor() as i64 + reach).min(size - 1);
        let texels = around(place.y).flat_map(|y| around(place.x).map(move |x| (y * size + x) as usize));
        let mut found: Vec<u32> = texels.filter_map(|texel| self.kept[texel]).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Whether a triangle shares an edge with a receiver, and seen from the light the two lie on its two sides; `None` where one of them is
    /// edge-on.
    pub(super) fn is_beside(&self, receiver: u32, t: u32) -> Option<bool> {
        let [own, other] = [receiver, t].map(|t| self.vertices[t as usize]);
        let shared: Vec<u32> = own.into_iter().filter(|v| other.contains(v)).collect();
        let &[start, end] = &shared[..] else { return Some(false) };
        let side_of = |t: u32, vertices: [u32; 3]| {
            let corners = self.triangles[t as usize].corners?;
            let at = |v| vertices.iter().position(|&w| w == v).map(|k| corners[k]);
            let third = vertices.into_iter().find(|v| !shared.contains(v)).and_then(at)?;
            let edge = [at(start)?, at(end)?];
            let side = self.view.side([edge[0], edge[1], third]);
            let size = (edge[1] - edge[0]).length() * (third - edge[0]).length();
            (side.abs() > 1e-5 * size).then_some(side > 0.0)
        };
        Some(side_of(receiver, own)? != side_of(t, other)?)
    }

    /// Whether a triangle lies before a place (texel x, y, depth).
    fn is_before(&self, t: u32, at: DVec3, doubt: KeptMargin) -> Option<bool> {
        let triangle = &self.triangles[t as usize];
        let corners = triangle.corners?;
        let Some((depth, inside)) = depth_in_front(self.view, corners, at.truncate()) else { return Some(false) };
        let gap = at.z - self.bias - depth;
        let shares = || shares_at(self.view, corners, at.truncate());
        if inside < -doubt.place || gap < -doubt.depth {
            Some(false)
        } else if inside >= doubt.place && gap > doubt.depth {
            Some(triangle.tested.is_none_or(|place| self.alpha.is_solid(place, shares())))
        } else {
            None
        }
    }

    /// Whether a place of triangle `receiver` is lit; `None` if that depends on less than `doubt`.
    pub fn is_lit(&self, at: DVec3, receiver: u32, doubt: KeptMargin) -> Option<bool> {
        let mut lit = Some(true);
        for t in self.asked(at.truncate()).into_iter().filter(|&t| t != receiver) {
            let before = self.is_before(t, at, doubt);
            if before == Some(false) {
                continue;
            }
            match (before, self.is_beside(receiver, t)) {
                (_, Some(true)) => {}
                (Some(true), Some(false)) => return Some(false),
                _ => lit = None,
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
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Light, Mesh};

    /// A roof over a floor, a texel of which keeps it: only what asks that texel is shadowed by it.
    #[test]
    fn a_triangle_shadows_where_its_texel_is_asked() {
        let mesh = Mesh {
            positions: vec![
                [-4.0, 0.0, -4.0],
                [4.0, 0.0, -4.0],
                [0.0, 0.0, 4.0],
                [-1.0, 1.0, -1.0],
                [1.0, 1.0, -1.0],
                [0.0, 1.0, 1.0],
            ],
            triangles: vec![[0, 2, 1], [3, 5, 4]],
        };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let (low, high) = mesh.bounds().expect("a mesh");
        let camera = Camera::framing(low, high);
        let map = LightView::fit(&mesh, &light, 32).expect("a light view");
        let view = View::new(&camera, &light, &map, (low, high), [4, 4], false);
        let triangles = setup(&view, &project(&view, &mesh.positions), &mesh.triangles, &[]);
        let at = view.on_map(view.point([0.0, 0.0, -0.2])).expect("in front of the light").truncate();
        let [x, y] = [at.x, at.y].map(|place| place as usize);
        let mut kept = vec![None; 32 * 32];
        kept[y * 32 + x + 2] = Some(1);
        let alpha = AlphaTested::default();
        let look = |lookups| KeptLookup {
            view: &view,
            triangles: &triangles,
            vertices: &mesh.triangles,
            alpha: &alpha,
            kept: &kept,
            lookups,
            bias: 1e-5,
        };
        let lit = |lookups| look(lookups).is_lit(at, 0, KeptMargin::default());
        assert_eq!([1, 3, 5, 7].map(lit), [Some(true), Some(true), Some(false), Some(false)]);
        assert_eq!(look(7).is_lit(at, 1, KeptMargin::default()), Some(true), "its own triangle is asked");
        let above = view.on_map(view.point([0.0, 1.5, -0.2])).expect("in front of the light").truncate();
        assert_eq!(look(7).is_lit(above, 0, KeptMargin::default()), Some(true));
        let close = KeptMargin { depth: f64::INFINITY, ..KeptMargin::default() };
        assert_eq!(look(7).is_lit(at, 0, close), None);
    }
}
