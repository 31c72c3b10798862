//! Vertices as the camera and the light see them.

use super::view::View;
use glam::{DVec3, DVec4};
use rayon::prelude::*;

/// A vertex of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vertex {
    /// `(position - eye) * scale`; `None` where that is no number that `f32` holds.
    pub point: Option<DVec3>,
    /// Texel x, y, depth and divisor; `None` for a vertex that is not in front of the light.
    pub map: Option<DVec4>,
    /// It lies surely behind the light.
    pub behind: bool,
}

/// Projects all positions.
pub fn project(view: &View, positions: &[[f32; 3]]) -> Vec<Vertex> {
    let one = |&p: &[f32; 3]| {
        let point = view.point(p);
        let point = point.as_vec3().is_finite().then_some(point);
        let behind = point.is_some_and(|p| view.map.perspective && view.map.w.dot(p.extend(1.0)) < -view.map.near);
        Vertex { point, map: point.and_then(|p| view.on_map(p)), behind }
    };
    positions.par_iter().map(one).collect()
}
