//! The nearest triangle at every pixel centre.

use super::sample_surfaces::see;
use super::triangle_setup::Triangle;
use super::view::View;
use glam::{DVec2, DVec3};
use subpixel_shadows::scene::AlphaTested;

/// Surface at a pixel centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentreHit {
    /// The nearest triangle, of equally near ones the lowest; `None` where nothing is seen.
    pub triangle: Option<u32>,
    /// Its depth along the view direction.
    pub depth: f64,
    /// Whether the answer could be another within the given doubts.
    pub open: bool,
    /// Whether some triangle surely covers the centre.
    pub covered: bool,
}

/// How near to call is too near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthMargin {
    /// Pixels from an edge.
    pub edge: f64,
    /// Share of the depth.
    pub depth: f64,
}

/// Looks through every pixel centre.
pub fn nearest(view: &View, triangles: &[Triangle], doubt: DepthMargin) -> Vec<CentreHit> {
    see(view, triangles, &[DVec2::splat(0.5)], doubt)
}

/// The nearest of `(depth, its doubt, triangle, surely covers)`.
pub(super) fn judge(candidates: &[(f64, f64, u32, bool)]) -> CentreHit {
    let best = |all: bool| {
        let chosen = candidates.iter().filter(|c| all || c.3);
        chosen.min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)))
    };
    let covered = candidates.iter().any(|c| c.3);
    let Some(&(depth, reach, triangle, sure)) = best(true) else {
        return CentreHit { triangle: None, depth: f64::INFINITY, open: false, covered };
    };
    let rival = |c: &&(f64, f64, u32, bool)| c.2 != triangle && c.0 - c.1 <= depth + reach;
    let open = !sure || candidates.iter().any(|c| rival(&c));
    CentreHit { triangle: Some(triangle), depth, open, covered }
}

/// Edge functions and plane of a triangle seen from the eye.
pub(super) struct Shape {
    edges: [DVec3; 3],
    normal: DVec3,
    distance: f64,
    corners: [DVec3; 3],
}

impl Shape {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let turn = if normal.dot(a) < 0.0 { 1.0 } else { -1.0 };
        let edge = |p: DVec3, q: DVec3| p.cross(q - p) * turn;
        Self { edges: [edge(b, a), edge(c, b), edge(a, c)], normal, distance: normal.dot(a), corners }
    }

    /// Least and greatest depth of its corners.
    pub(super) fn depths(&self, view: &View) -> (f64, f64) {
        let [a, b, c] = self.corners.map(|p| p.dot(view.rays.forward));
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Whether it surely covers no place within half a pixel of an image position, in either direction.
    pub(super) fn misses(&self, view: &View, at: DVec2) -> bool {
        let ray = view.rays.direction(at.x, at.y);
        self.edges.iter().any(|m| {
            let reach = m.dot(view.rays.step_x).abs() + m.dot(view.rays.step_y).abs();
            m.dot(ray) < -0.51 * reach
        })
    }

    /// As [`Shape::at`] without doubt: its depth, held between `lo` and `hi`, where it covers the place.
    pub(super) fn depth(&self, view: &View, at: DVec2, (lo, hi): (f64, f64)) -> Option<f64> {
        let ray = view.rays.direction(at.x, at.y);
        // NaN is outside.
        if !self.edges.iter().all(|m| m.dot(ray) >= 0.0) {
            return None;
        }
        let depth = (self.distance / self.normal.dot(ray)).clamp(lo, hi);
        (depth >= view.near_along(ray)).then_some(depth)
    }

    /// Whether it is there, as the alpha-tested triangle of a place, at an image position that it covers.
    pub(super) fn is_solid(&self, view: &View, at: DVec2, alpha: &AlphaTested, place: u32) -> bool {
        let [a, b, c] = self.corners;
        let ray = view.rays.direction(at.x, at.y);
        let from_a = ray * (self.distance / self.normal.dot(ray)) - a;
        let scale = self.normal.length_squared();
        let shares = [from_a.cross(c - a), (b - a).cross(from_a)].map(|part| self.normal.dot(part) / scale);
        alpha.is_solid(place, [1.0 - shares[0] - shares[1], shares[0], shares[1]])
    }

    /// Depth at an image position, its doubt, and whether the triangle surely covers the place; `None` if it surely does
    /// not, or not beyond the near plane.
    pub(super) fn at(&self, view: &View, at: DVec2, doubt: DepthMargin) -> Option<(f64, f64, bool)> {
        let ray = view.rays.direction(at.x, at.y);
        let mut sure = true;
        for m in self.edges {
            let slope = DVec2::new(m.dot(view.rays.step_x), m.dot(view.rays.step_y)).length();
            let inside = m.dot(ray);
            if inside < -doubt.edge * slope || inside.is_nan() {
                return None;
            }
            sure &= inside > doubt.edge * slope;
        }
        let over = self.normal.dot(ray);
        let (lo, hi) = self.depths(view);
        let depth = (self.distance / over).clamp(lo, hi);
        let tilt = (self.normal.dot(view.rays.step_x).abs() + self.normal.dot(view.rays.step_y).abs()) * doubt.edge;
        let reach = doubt.depth * depth + if over.abs() > tilt { depth * tilt / (over.abs() - tilt) } else { hi - lo };
        // An oblique near plane is another distance within the doubt of the place.
        let near = view.near_along(ray);
        let [x, y] = [view.rays.step_x, view.rays.step_y].map(|step| view.near_along(ray + step * doubt.edge) - near);
        let off = if near.is_finite() { x.abs() + y.abs() } else { 0.0 };
        if depth + reach + off < near {
            return None;
        }
        sure &= depth - reach - off > near && over != 0.0;
        Some((depth, reach, sure))
    }
}
