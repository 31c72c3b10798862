//! The nearest triangle at every pixel centre.

use super::triangle_setup::Triangle;
use super::view::{View, centre};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// What is seen at a pixel centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
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
pub struct Doubt {
    /// Pixels from an edge.
    pub edge: f64,
    /// Share of the depth.
    pub depth: f64,
}

/// Looks through every pixel centre.
pub fn nearest(view: &View, triangles: &[Triangle], doubt: Doubt) -> Vec<Seen> {
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
        let mut found: Vec<Vec<(f64, f64, u32, bool)>> = vec![Vec::new(); width as usize];
        for &t in list {
            let triangle = &triangles[t as usize];
            let (Some(corners), Some((lo, hi))) = (triangle.corners, triangle.image) else { continue };
            let shape = Shape::new(corners);
            let (first, last) = ((lo.x - 2.0).max(0.0), (hi.x + 2.0).min(f64::from(width) - 1.0));
            if first > last {
                continue;
            }
            for x in first as u32..=last as u32 {
                if let Some((depth, reach, sure)) = shape.at(view, centre(x, y as u32), doubt) {
                    found[x as usize].push((depth, reach, t, sure));
                }
            }
        }
        found.into_iter().map(|candidates| judge(&candidates)).collect::<Vec<_>>()
    };
    rows.par_iter().enumerate().flat_map_iter(row).collect()
}

/// The nearest of `(depth, its doubt, triangle, surely covers)`.
fn judge(candidates: &[(f64, f64, u32, bool)]) -> Seen {
    let best = |all: bool| {
        let chosen = candidates.iter().filter(|c| all || c.3);
        chosen.min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)))
    };
    let covered = candidates.iter().any(|c| c.3);
    let Some(&(depth, reach, triangle, sure)) = best(true) else {
        return Seen { triangle: None, depth: f64::INFINITY, open: false, covered };
    };
    let rival = |c: &&(f64, f64, u32, bool)| c.2 != triangle && c.0 - c.1 <= depth + reach;
    let open = !sure || candidates.iter().any(|c| rival(&c));
    Seen { triangle: Some(triangle), depth, open, covered }
}

/// Edge functions and plane of a triangle seen from the eye.
struct Shape {
    edges: [DVec3; 3],
    normal: DVec3,
    distance: f64,
    corners: [DVec3; 3],
}

impl Shape {
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let turn = if normal.dot(a) < 0.0 { 1.0 } else { -1.0 };
        let edge = |p: DVec3, q: DVec3| p.cross(q - p) * turn;
        Self { edges: [edge(b, a), edge(c, b), edge(a, c)], normal, distance: normal.dot(a), corners }
    }

    /// Depth at an image position, its doubt, and whether the triangle surely covers the place; `None` if it surely does
    /// not, or not beyond the near plane.
    fn at(&self, view: &View, at: DVec2, doubt: Doubt) -> Option<(f64, f64, bool)> {
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
        let depths = self.corners.map(|p| p.dot(view.rays.forward));
        let lo = depths[0].min(depths[1]).min(depths[2]);
        let hi = depths[0].max(depths[1]).max(depths[2]);
        let depth = (self.distance / over).clamp(lo, hi);
        let tilt = (self.normal.dot(view.rays.step_x).abs() + self.normal.dot(view.rays.step_y).abs()) * doubt.edge;
        let reach = doubt.depth * depth + if over.abs() > tilt { depth * tilt / (over.abs() - tilt) } else { hi - lo };
        if depth + reach < view.near {
            return None;
        }
        sure &= depth - reach > view.near && over != 0.0;
        Some((depth, reach, sure))
    }
}
