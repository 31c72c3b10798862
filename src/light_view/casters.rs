//! What of a mesh casts on something that can be lit: what the light's view has to hold.

use super::fit::axes;
use super::{LightView, Receivers};
use crate::scene::{Light, Mesh};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Triangles of which it is looked at what they lie before.
const LARGE_TRIANGLES: usize = 64;

/// Directions in which the part of a large triangle that casts is measured.
const AXES: usize = 8;

/// Share of the part of a large triangle that casts by which it is taken larger: a facet that stands for a whole pixel goes on
/// beyond what is there.
const GROWN: f64 = 1.0 / 64.0;

/// Points whose view holds every caster where it can shadow something. Of the largest triangles only the part counts that lies
/// before something that can be lit: a ground casts on nothing but what sticks into it, and does not widen the view.
pub(super) fn caster_points(
    mesh: &Mesh,
    light: &Light,
    (lo, hi): (DVec3, DVec3),
    map_size: u32,
    receivers: Receivers,
) -> Vec<DVec3> {
    let towards = light.towards((lo + hi) * 0.5).try_normalize().unwrap_or(DVec3::Y);
    let (right, up) = axes(towards);
    let extent = |t: usize| {
        let c = mesh.corners(t).map(|p| glam::DVec2::new(p.dot(right), p.dot(up)));
        let size = c[0].max(c[1]).max(c[2]) - c[0].min(c[1]).min(c[2]);
        size.max_element()
    };
    let mut order: Vec<(f64, usize)> = (0..mesh.triangles.len()).map(|t| (extent(t), t)).collect();
    let large = order.len().min(LARGE_TRIANGLES);
    if large < order.len() {
        order.select_nth_unstable_by(large, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    }
    let mut out: Vec<DVec3> = order[large..].iter().flat_map(|&(_, t)| mesh.corners(t)).collect();
    let small = (!out.is_empty()).then(|| LightView::holding(&out, (lo + hi) * 0.5, light, map_size));
    let slack = 1e-9 * (hi - lo).length();
    let texels = f64::from(map_size);
    let inside = |view: &LightView, p: DVec3| {
        let at = view.project(p);
        at.is_some_and(|at| at.truncate().min_element() >= 0.0 && at.truncate().max_element() <= texels)
    };
    for &(_, t) in &order[..large] {
        let corners = mesh.corners(t);
        if receivers == Receivers::Planes {
            out.extend(part_before_a_box(mesh, corners, light, slack));
        } else if small.is_some_and(|view| view.complete && corners.iter().all(|&p| inside(&view, p))) {
            out.extend(corners);
        } else if let Some(caster) = LargeCaster::new(corners, light, slack) {
            out.extend(caster.part_that_casts(mesh, light, receivers));
        }
    }
    out
}

/// Points around the part of a triangle that lies before the box of all that is behind its plane; with a light at a point all of
/// it, as only one at infinity sends parallel rays: what lies behind, widened along them, is then where it can matter.
fn part_before_a_box(mesh: &Mesh, triangle: [DVec3; 3], light: &Light, slack: f64) -> Vec<DVec3> {
    let [a, b, c] = triangle;
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
    let away = if normal.dot(light.towards(a)) < 0.0 { normal } else { -normal };
    let behind = |corners: [DVec3; 3]| corners.into_iter().any(|p| away.dot(p - a) > slack).then_some(corners);
    let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
    let all = (0..mesh.triangles.len()).into_par_iter().filter_map(|t| behind(mesh.corners(t)));
    let (low, high) = all.flat_map_iter(|t| t).map(|p| (p, p)).reduce(nothing, join);
    if low.x > high.x {
        return Vec::new();
    }
    if !light.is_directional() {
        return triangle.to_vec();
    }
    let towards = light.towards(a).normalize();
    let (right, up) = axes(towards);
    overlap(&triangle, low, high, right, up, towards)
}

/// Corners of the part of the view that both `points` and the box from `low` to `high` take.
fn overlap(points: &[DVec3], low: DVec3, high: DVec3, right: DVec3, up: DVec3, towards: DVec3) -> Vec<DVec3> {
    if low.x > high.x {
        return Vec::new();
    }
    let view = |p: DVec3| DVec3::new(p.dot(right), p.dot(up), p.dot(towards));
    let spread = |ps: &mut dyn Iterator<Item = DVec3>| {
        ps.map(view).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)))
    };
    let corners: [DVec3; 8] = std::array::from_fn(|k| {
        DVec3::new([low.x, high.x][k & 1], [low.y, high.y][(k >> 1) & 1], [low.z, high.z][k >> 2])
    });
    let (l0, h0) = spread(&mut points.iter().copied());
    let (l1, h1) = spread(&mut corners.into_iter());
    let (mut l, mut h) = (l0.max(l1), h0.min(h1));
    (l.z, h.z) = (l0.z, h0.z);
    if l.x > h.x || l.y > h.y {
        return Vec::new();
    }
    [l, h].map(|q| right * q.x + up * q.y + towards * q.z).to_vec()
}

/// How far something reaches along directions, from and to.
type Reach = [(f64, f64); AXES];

/// A triangle, and what tells whether it lies between the light and something.
struct LargeCaster {
    corners: [DVec3; 3],
    /// Of its plane, away from the light.
    away: DVec3,
    /// Of the planes through the light and its edges, inward; 0 where there is none.
    sides: [DVec3; 3],
    /// Directions in its plane in which it is measured.
    along: [DVec3; AXES],
    slack: f64,
}

impl LargeCaster {
    /// `None` if it has no area.
    fn new(corners: [DVec3; 3], light: &Light, slack: f64) -> Option<Self> {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let normal = u.cross(v);
        let unit = normal.try_normalize()?;
        let away = if unit.dot(light.towards(a)) > 0.0 { -unit } else { unit };
        let sides = [(a, b, c), (b, c, a), (c, a, b)].map(|(p, q, other)| plane_of_light(light, p, q, other));
        let (x, y) = axes(unit);
        let along = std::array::from_fn(|k| {
            let (sin, cos) = (PI * k as f64 / AXES as f64).sin_cos();
            x * cos + y * sin
        });
        Some(Self { corners, away, sides, along, slack })
    }

    /// Corners of a polygon that holds the part of it that lies before something of `mesh`.
    fn part_that_casts(&self, mesh: &Mesh, light: &Light, receivers: Receivers) -> Vec<DVec3> {
        let lit = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(light.towards(a)) > 0.0;
        let receives = |t: usize| {
            let corners = mesh.corners(t);
            (receivers == Receivers::Surfaces || lit(corners)).then_some(corners)
        };
        let reach = self.reach_over((0..mesh.triangles.len()).into_par_iter().filter_map(receives), light);
        if reach[0].0 > reach[0].1 {
            return Vec::new();
        }
        let mut part = self.corners.to_vec();
        for (g, (low, high)) in self.along.into_iter().zip(reach) {
            let more = GROWN * (high - low);
            clip(&mut part, |p| g.dot(p - self.corners[0]) - (low - more));
            clip(&mut part, |p| (high + more) - g.dot(p - self.corners[0]));
        }
        part
    }

    /// How far the part before any of these triangles reaches along each direction.
    fn reach_over(&self, triangles: impl ParallelIterator<Item = [DVec3; 3]>, light: &Light) -> Reach {
        let nothing = || [(f64::INFINITY, f64::NEG_INFINITY); AXES];
        let join = |a: Reach, b: Reach| std::array::from_fn(|k| (a[k].0.min(b[k].0), a[k].1.max(b[k].1)));
        let take = |known: Reach, triangle| {
            self.before(triangle, light)
                .into_iter()
                .fold(known, |known, p| join(known, self.along.map(|g| g.dot(p - self.corners[0])).map(|x| (x, x))))
        };
        triangles.fold(nothing, take).reduce(nothing, join)
    }

    /// The part that lies between the light and a triangle, as a polygon; empty if there is none of any size.
    fn before(&self, triangle: [DVec3; 3], light: &Light) -> Vec<DVec3> {
        let outside = |n: DVec3, at: DVec3, points: &[DVec3]| points.iter().all(|p| n.dot(*p - at) <= self.slack);
        if outside(self.away, self.corners[0], &triangle)
            || (0..3).any(|k| self.sides[k] != DVec3::ZERO && outside(self.sides[k], self.corners[k], &triangle))
        {
            return Vec::new();
        }
        let mut behind = triangle.to_vec();
        clip(&mut behind, |p| self.away.dot(p - self.corners[0]));
        let mut part = self.corners.to_vec();
        let middle = behind.iter().sum::<DVec3>() / behind.len() as f64;
        for (k, &p) in behind.iter().enumerate() {
            let n = plane_of_light(light, p, behind[(k + 1) % behind.len()], middle);
            if n != DVec3::ZERO {
                if outside(n, p, &self.corners) {
                    return Vec::new();
                }
                clip(&mut part, |q| n.dot(q - p));
            }
        }
        part
    }
}

/// Unit normal of the plane through the light, `p` and `q`, to the side of `other`; 0 where they are as good as in a line, or
/// `other` in the plane.
fn plane_of_light(light: &Light, p: DVec3, q: DVec3, other: DVec3) -> DVec3 {
    let (to_light, edge) = (light.towards(p), q - p);
    let normal = edge.cross(to_light);
    if normal.length() <= 1e-9 * edge.length() * to_light.length() {
        return DVec3::ZERO;
    }
    let Some(unit) = normal.try_normalize() else { return DVec3::ZERO };
    let side = unit.dot(other - p);
    if side.abs() > 1e-9 * (other - p).length() { unit * side.signum() } else { DVec3::ZERO }
}

/// Leaves of a convex polygon where `inside`, which is linear, is not below 0.
pub(super) fn clip(polygon: &mut Vec<DVec3>, inside: impl Fn(DVec3) -> f64) {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (at_p, at_q) = (inside(p), inside(q));
        if at_p >= 0.0 {
            out.push(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            out.push(p + (q - p) * (at_p / (at_p - at_q)));
        }
    }
    *polygon = out;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_only_is_not_before() {
        let light = Light::Directional { direction: [0.5, 1.0, 0.0] };
        let top = [DVec3::ZERO, DVec3::new(4.0, 0.0, 4.0), DVec3::new(4.0, 0.0, 0.0)];
        let caster = LargeCaster::new(top, &light, 1e-9).unwrap();
        // A wall below its edge, on the light's side: the light passes the edge on its way.
        let wall = |x: f64| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, -1.0, 0.0), DVec3::new(x, 0.0, 4.0)];
        assert!(caster.before(wall(4.0), &light).is_empty());
        assert!(!caster.before(wall(3.9), &light).is_empty());
        assert!(caster.before(top, &light).is_empty(), "before itself");
        let above = top.map(|p| p + DVec3::Y);
        assert!(caster.before(above, &light).is_empty());
        let below = top.map(|p| p - DVec3::Y);
        assert!(!caster.before(below, &light).is_empty());
    }
}
