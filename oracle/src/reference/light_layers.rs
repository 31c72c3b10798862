//! The nearest and the second nearest caster at every texel centre.

use super::triangle_setup::{Reach, Triangle};
use super::view::{Cut, Flat, View, by_rows, centre, columns};
use glam::{DVec2, DVec3};

/// Layers over a texel centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layer {
    /// Depth and triangle of the nearest caster.
    pub nearest: Option<(f64, u32)>,
    /// Depth and triangle of the next.
    pub second: Option<(f64, u32)>,
    /// An edge passes the centre within the guard, or the two are equally far: not certain.
    pub open: bool,
    /// A triangle so thin, or reaching so far out, that 32 bits do not place its edges within the guard passes the centre
    /// that near; or one that reaches behind the light is there, not surely.
    pub thin: bool,
}

impl Layer {
    /// Depth half way between the two; beyond everything where there is no second, `None` where there is none at all.
    pub fn split(&self) -> Option<f64> {
        let (nearest, _) = self.nearest?;
        Some(self.second.map_or(f64::INFINITY, |(second, _)| 0.5 * (nearest + second)))
    }
}

/// Looks along the light through the centre of each of `size` × `size` texels. An edge within `guard` (texels, as
/// |x| + |y| across the edge) leaves the texel open, and so does a rival whose depth differs by at most `tie`.
pub fn layers(triangles: &[Triangle], size: u32, guard: f64, tie: f64) -> Vec<Layer> {
    // A triangle with holes is no layer.
    let whole = |t: &Triangle| if t.tested.is_some() { None } else { t.flat() };
    let figures: Vec<Option<Flat>> = triangles.iter().map(whole).collect();
    let cut = |(t, triangle): (u32, &Triangle)| Some((t, triangle.cut().filter(|_| triangle.tested.is_none())?));
    let cuts: Vec<(u32, Cut)> = (0..).zip(triangles).filter_map(cut).collect();
    by_rows(&figures, size, guard, |y, list, row: &mut [Layer]| {
        for &t in list {
            let Some(flat) = &figures[t as usize] else { continue };
            for x in columns(flat, guard, size) {
                let at = centre(x, y);
                let inside = flat.inside(at);
                if inside.iter().any(|&e| e < -guard) {
                    continue;
                }
                let layer = &mut row[x as usize];
                let near = inside.iter().any(|&e| e <= guard);
                let (lo, hi) = flat.bounds();
                let far = 1e-6 * lo.abs().max(hi.abs()).max_element() > guard;
                layer.open |= near && !flat.is_thin() && !far;
                layer.thin |= near && (flat.is_thin() || far);
                if inside.iter().all(|&e| e >= 0.0) {
                    add(layer, flat.depth(at), t);
                }
            }
        }
        for (x, layer) in (0..).zip(row.iter_mut()) {
            let at = centre(x, y);
            for (t, cut) in &cuts {
                let Some(depth) = cut.depth(at).filter(|_| cut.inside(at).iter().all(|&e| e >= 0.0)) else { continue };
                layer.thin |= !cut.is_layer(at);
                add(layer, depth, *t);
            }
            let (Some((a, _)), Some((b, _))) = (layer.nearest, layer.second) else { continue };
            layer.open |= b - a <= tie;
        }
    })
}

fn add(layer: &mut Layer, depth: f64, triangle: u32) {
    let new = Some((depth, triangle));
    match (layer.nearest, layer.second) {
        (None, _) => layer.nearest = new,
        (Some((d, _)), _) if depth < d => (layer.nearest, layer.second) = (new, layer.nearest),
        (_, None) => layer.second = new,
        (_, Some((d, _))) if depth < d => layer.second = new,
        _ => {}
    }
}

/// Whether a triangle counts as over every texel, because it reaches behind the light.
pub fn any_everywhere(triangles: &[Triangle]) -> bool {
    triangles.iter().any(|t| t.map == Reach::Everywhere)
}

/// Functions of a place on the map that are the shares of a triangle's corners in its point there, over the divisor of that; and a determinant
/// that is 0 where the light lies in its plane.
fn edges_on_map(view: &View, corners: [DVec3; 3]) -> ([DVec3; 3], f64) {
    let row = |p: DVec3| {
        let p = p.extend(1.0);
        DVec3::new(view.map.u.dot(p), view.map.v.dot(p), view.map.w.dot(p))
    };
    let [p, q, r] = corners.map(row);
    let det = p.dot(q.cross(r));
    ([q.cross(r), r.cross(p), p.cross(q)].map(|edge| edge / det), det)
}

/// Shares of a triangle's corners in its point at a place on the map.
pub fn shares_at(view: &View, corners: [DVec3; 3], place: DVec2) -> [f64; 3] {
    let shares = edges_on_map(view, corners).0.map(|edge| edge.dot(place.extend(1.0)));
    let all: f64 = shares.iter().sum();
    shares.map(|share| share / all)
}

/// Depth at `centre` of a triangle, of whose corners some may lie behind the light, and how far within its edges that is, texels as |x| + |y|
/// across the nearest edge, below 0 outside; `None` if the light lies in its plane, or what is there lies nearer than the view's nearest
/// distance.
pub fn depth_in_front(view: &View, corners: [DVec3; 3], centre: DVec2) -> Option<(f64, f64)> {
    let (edges, det) = edges_on_map(view, corners);
    let [zp, zq, zr] = corners.map(|p| view.map.z.dot(p.extend(1.0)));
    let at = centre.extend(1.0);
    let shares = edges.map(|edge| edge.dot(at));
    let within = edges.map(|edge| edge.dot(at) / (edge.x.abs() + edge.y.abs()));
    // Positive where it is in front; its inverse is the divisor.
    let over: f64 = shares.iter().sum();
    let depth = shares[0] * zp + shares[1] * zq + shares[2] * zr;
    let inside = within.into_iter().fold(f64::INFINITY, f64::min);
    (det != 0.0 && over > 0.0 && 1.0 / over > view.map.near).then_some((depth, inside))
}
