//! Parts of a mesh that cast on something that can be lit: the light's view has to hold them.

use super::fit::axes;
use super::points::MeshAndTree;
use super::{LightView, Receivers};
use crate::scene::Light;
use crate::scene::mesh_tree::{Bounds, Which};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Directions in which the part of a large triangle that casts is measured.
const AXES: usize = 8;

/// Share by which the casting part of a large triangle is enlarged: a facet that represents a whole pixel goes on beyond what is there.
const GROWN: f64 = 1.0 / 64.0;

/// Points that a view has to hold beside the small triangles, so that it holds every caster where it can shadow something. Of the
/// largest triangles only the part counts that lies before something that can be lit, of `all` triangles: a ground casts on nothing but what sticks
/// into it, and does not widen the view. `small`: the view of the small triangles, if there is one that holds them.
pub(super) fn of_large_casters(
    (casters, all): (MeshAndTree, MeshAndTree),
    light: &Light,
    (lo, hi): (DVec3, DVec3),
    small: Option<LightView>,
    receivers: Receivers,
) -> Vec<DVec3> {
    let MeshAndTree { mesh, tree } = casters;
    // Corners are exact: above the rounding of their heights over a plane, and below what kernels tell from 0 (2^-40 of the distance over
    // which they are measured) of all that is not a hundred times smaller than the scene.
    let slack = 1e-14 * (hi - lo).length();
    let texels = small.map_or(0.0, |view| f64::from(view.map_size));
    let inside = |view: &LightView, p: DVec3| {
        let at = view.project(p);
        at.is_some_and(|at| at.truncate().min_element() >= 0.0 && at.truncate().max_element() <= texels)
    };
    let of_one = |&t: &u32| {
        let corners = mesh.corners(t as usize);
        if receivers == Receivers::Planes {
            part_before_a_box(all, corners, light, slack)
        } else if small.is_some_and(|view| corners.iter().all(|&p| inside(&view, p))) {
            corners.to_vec()
        } else {
            LargeCaster::new(corners, light, slack)
                .map_or_else(Vec::new, |caster| caster.part_that_casts(all, light, receivers))
        }
    };
    tree.large().par_iter().flat_map_iter(of_one).collect()
}

/// Points around the part of a triangle that lies before the box of all that is behind its plane; with a light at a point all of
/// it, as only one at infinity sends parallel rays: what lies behind, widened along them, is then where it can matter.
fn part_before_a_box(casters: MeshAndTree, triangle: [DVec3; 3], light: &Light, slack: f64) -> Vec<DVec3> {
    let [a, b, c] = triangle;
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
    let away = if normal.dot(light.towards(a)) < 0.0 { normal } else { -normal };
    let limit = away.dot(a) + slack;
    let reach = |axis: DVec3| {
        let above = |b: &Bounds| if b.reach(away) > limit { b.reach(axis) } else { f64::NEG_INFINITY };
        let value = |corners: [DVec3; 3]| {
            let behind = corners.iter().any(|p| p.dot(away) > limit);
            if behind { greatest(&corners, axis) } else { f64::NEG_INFINITY }
        };
        casters.tree.greatest(casters.mesh, Which::All, above, value).map(|(reach, _)| reach)
    };
    if reach(DVec3::X).is_none() {
        return Vec::new();
    }
    if !light.is_directional() {
        return triangle.to_vec();
    }
    let corner = |sign: f64| DVec3::AXES.map(|axis| sign * reach(sign * axis).unwrap_or(f64::NEG_INFINITY)).into();
    let (low, high) = (corner(-1.0), corner(1.0));
    let towards = light.towards(a).normalize();
    let (right, up) = axes(towards);
    overlap(&triangle, low, high, right, up, towards)
}

/// The greatest `axis · p`; negative infinity without points.
fn greatest(points: &[DVec3], axis: DVec3) -> f64 {
    points.iter().map(|p| p.dot(axis)).fold(f64::NEG_INFINITY, f64::max)
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

/// A triangle, and what tells whether it lies between the light and something.
struct LargeCaster {
    corners: [DVec3; 3],
    /// Normal of its plane, away from the light.
    away: DVec3,
    /// Normals of the planes through the light and its edges, inward; 0 where there is none.
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

    /// Corners of a polygon that holds the part of it that lies before something of the mesh.
    fn part_that_casts(&self, casters: MeshAndTree, light: &Light, receivers: Receivers) -> Vec<DVec3> {
        let mut part = self.corners.to_vec();
        for axis in self.along {
            let Some(high) = self.reach(casters, axis, light, receivers) else { return Vec::new() };
            let Some(low) = self.reach(casters, -axis, light, receivers).map(|reach| -reach) else { return Vec::new() };
            let more = GROWN * (high - low);
            clip(&mut part, |p| axis.dot(p - self.corners[0]) - (low - more));
            clip(&mut part, |p| (high + more) - axis.dot(p - self.corners[0]));
        }
        part
    }

    /// How far the part before any triangle that can be lit reaches along `axis` from the first corner; `None` if there is no such part.
    fn reach(&self, casters: MeshAndTree, axis: DVec3, light: &Light, receivers: Receivers) -> Option<f64> {
        let first = self.corners[0];
        let own = greatest(&self.corners.map(|p| p - first), axis);
        let above = |b: &Bounds| {
            let out = |n: DVec3, at: DVec3| n != DVec3::ZERO && b.reach(n) - n.dot(at) <= 0.5 * self.slack;
            if out(self.away, first) || (0..3).any(|k| out(self.sides[k], self.corners[k])) {
                return f64::NEG_INFINITY;
            }
            // Where the corners of its part behind the plane are thrown along the light; more than `own` it is not in any case.
            let corners = b.corners();
            let depth = corners.map(|p| self.away.dot(p - first));
            let mut most = f64::NEG_INFINITY;
            for (k, &p) in corners.iter().enumerate() {
                if depth[k] > 0.0 {
                    let to = light.towards(p);
                    let along = -self.away.dot(to);
                    most = most.max(if along > 0.0 { axis.dot(p + to * (depth[k] / along) - first) } else { own });
                }
                for j in [k | 1, k | 2, k | 4] {
                    if (depth[j] > 0.0) != (depth[k] > 0.0) {
                        let on_plane = p + (corners[j] - p) * (depth[k] / (depth[k] - depth[j]));
                        most = most.max(axis.dot(on_plane - first));
                    }
                }
            }
            own.min(most + self.slack)
        };
        let value = |corners: [DVec3; 3]| {
            let [a, b, c] = corners;
            if receivers != Receivers::Surfaces && (b - a).cross(c - a).dot(light.towards(a)) <= 0.0 {
                return f64::NEG_INFINITY;
            }
            let part = self.before(corners, light);
            part.into_iter().map(|p| axis.dot(p - first)).fold(f64::NEG_INFINITY, f64::max)
        };
        casters.tree.greatest(casters.mesh, Which::All, above, value).map(|(reach, _)| reach)
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
    if normal.length() <= 1e-13 * edge.length() * to_light.length() {
        return DVec3::ZERO;
    }
    let Some(unit) = normal.try_normalize() else { return DVec3::ZERO };
    let side = unit.dot(other - p);
    if side.abs() > 1e-13 * (other - p).length() { unit * side.signum() } else { DVec3::ZERO }
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

    #[test]
    fn the_part_before_something_reaches_as_far_as_all_triangles_tell() {
        use crate::scene::mesh_tree::MeshTree;
        let (mut parts, mut none) = (0, 0);
        for name in ["windmill", "plant", "bumpy"] {
            let mut mesh = crate::test_scenes::builtin(name).mesh;
            let ground = mesh.ground_below().unwrap();
            mesh.add_ground(&ground);
            let casters = MeshAndTree { mesh: &mesh, tree: &MeshTree::new(&mesh) };
            let (low, high) = mesh.bounds().unwrap();
            let above = (low + high) * 0.5 + DVec3::new(0.3, 1.2, 0.1) * (high - low);
            for light in [
                Light::Directional { direction: [0.3, 1.0, 0.2] },
                Light::Directional { direction: [0.5, -1.0, 0.1] },
                Light::Point { position: above.as_vec3().into() },
            ] {
                for &t in casters.tree.large().iter().step_by(9) {
                    let slack = 1e-9 * (high - low).length();
                    let Some(caster) = LargeCaster::new(mesh.corners(t as usize), &light, slack) else { continue };
                    for receivers in [Receivers::Outsides, Receivers::Surfaces] {
                        for axis in [caster.along[1], -caster.along[5]] {
                            let lit = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(light.towards(a)) > 0.0;
                            let wanted = (0..mesh.triangles.len())
                                .map(|t| mesh.corners(t))
                                .filter(|&corners| receivers == Receivers::Surfaces || lit(corners))
                                .flat_map(|corners| caster.before(corners, &light))
                                .map(|p| axis.dot(p - caster.corners[0]))
                                .fold(f64::NEG_INFINITY, f64::max);
                            let found = caster.reach(casters, axis, &light, receivers).unwrap_or(f64::NEG_INFINITY);
                            assert!(
                                found == wanted || (found - wanted).abs() <= slack,
                                "{name} {light:?} {t}: {found} {wanted}"
                            );
                            parts += usize::from(wanted > f64::NEG_INFINITY);
                            none += usize::from(wanted == f64::NEG_INFINITY);
                        }
                    }
                }
            }
        }
        assert!(parts > 40 && none > 10, "{parts} {none}");
    }
}
