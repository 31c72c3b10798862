//! Points that a light view has to hold: the vertices of many triangles, of which a tree knows the outermost, and a few more.

use super::LightView;
use crate::scene::Mesh;
use crate::scene::mesh_tree::{Bounds, MeshTree, Which};
use glam::DVec3;

/// A mesh and its tree.
#[derive(Clone, Copy)]
pub struct MeshAndTree<'a> {
    pub mesh: &'a Mesh,
    pub tree: &'a MeshTree,
}

/// The points.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    pub casters: Option<(MeshAndTree<'a>, Which)>,
    pub more: &'a [DVec3],
}

impl<'a> Points<'a> {
    /// Points alone.
    pub fn of(more: &'a [DVec3]) -> Self {
        Self { casters: None, more }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.more.is_empty() && self.casters.is_none_or(|(casters, which)| casters.tree.is_empty(which))
    }

    /// The point of the greatest value, and that; `None` if no value is above negative infinity. `above`: what no value in a box exceeds.
    pub fn greatest(&self, above: impl Fn(&Bounds) -> f64, value: impl Fn(DVec3) -> f64) -> Option<(f64, DVec3)> {
        let of = |points: &[DVec3]| {
            let values = points.iter().map(|&p| (value(p), p)).filter(|(v, _)| *v > f64::NEG_INFINITY);
            values.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let met = self.casters.and_then(|(MeshAndTree { mesh, tree }, which)| {
            let of_triangle = |corners: [DVec3; 3]| of(&corners).map_or(f64::NEG_INFINITY, |(v, _)| v);
            let (_, t) = tree.greatest(mesh, which, above, of_triangle)?;
            of(&mesh.corners(t as usize))
        });
        met.into_iter().chain(of(self.more)).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The greatest `axis · p`; negative infinity without points.
    pub fn reach(&self, axis: DVec3) -> f64 {
        self.greatest(|b| b.reach(axis), |p| p.dot(axis)).map_or(f64::NEG_INFINITY, |(reach, _)| reach)
    }

    /// The direction from `light` to a point that is farthest from `axis`.
    pub fn farthest_direction(&self, light: DVec3, axis: DVec3) -> Option<DVec3> {
        let unit = axis.normalize_or_zero();
        let value = |p: DVec3| (p - light).try_normalize().map_or(f64::NEG_INFINITY, |d| -d.dot(axis));
        let above = |b: &Bounds| {
            // Cones of less than half of all directions are convex: the farthest from the axis is a corner.
            let corners = b.corners().map(value);
            if corners.iter().all(|&v| v < 0.0 && v > f64::NEG_INFINITY) {
                return corners.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1e-12;
            }
            let (to, radius) = (b.middle() - light, b.radius());
            let distance = to.length();
            if distance <= radius {
                return axis.length();
            }
            // The middle's angle to the axis, and that of the ball around the box.
            let off = (to.dot(unit) / distance).clamp(-1.0, 1.0).acos() + (radius / distance).asin();
            -axis.length() * (off + 1e-9).min(std::f64::consts::PI).cos()
        };
        self.greatest(above, value).and_then(|(_, p)| (p - light).try_normalize())
    }

    /// The greatest `across · q / max(axis · q, near)`, `q` being points as seen from `light`; negative infinity without points.
    pub fn reach_in_perspective(&self, light: DVec3, across: DVec3, axis: DVec3, near: f64) -> f64 {
        let ratio = |q: DVec3| q.dot(across) / q.dot(axis).max(near);
        let above = |b: &Bounds| {
            let far = b.reach(axis) - axis.dot(light);
            let most = b.reach(across) - across.dot(light);
            if -b.reach(-axis) - axis.dot(light) >= near {
                b.corners().into_iter().map(|p| ratio(p - light)).fold(f64::NEG_INFINITY, f64::max)
            } else {
                most / if most > 0.0 { near } else { far.max(near) }
            }
        };
        // Rounding of a box's corner and of a point in it may differ.
        let with_room = |b: &Bounds| {
            let most = above(b);
            most + 1e-12 * most.abs()
        };
        self.greatest(with_room, |p| ratio(p - light)).map_or(f64::NEG_INFINITY, |(reach, _)| reach)
    }
}

impl MeshAndTree<'_> {
    /// How many triangles are not wholly in front of the light.
    pub fn not_in_front(&self, view: &LightView) -> usize {
        let axis = view.w.truncate();
        let mut found = 0;
        let enter = |b: &Bounds, count: usize| {
            if b.reach(axis) + view.w.w <= view.near {
                found += count;
                return false;
            }
            -b.reach(-axis) + view.w.w <= view.near
        };
        let mut apart = 0;
        self.tree.visit(self.mesh, enter, |_, corners| {
            apart += usize::from(!corners.iter().all(|&p| view.is_in_front(p)));
            true
        });
        found + apart
    }

    /// Directions from the light straight at the planes of triangles that reach behind it, at most eight, of the first that are met.
    pub fn facing_axes(&self, view: &LightView, light: DVec3) -> Vec<DVec3> {
        let axis = view.w.truncate();
        let mut axes: Vec<DVec3> = Vec::new();
        let mut looked = 0;
        self.tree.visit(
            self.mesh,
            |b, _| -b.reach(-axis) + view.w.w <= view.near,
            |_, corners| {
                if corners.iter().all(|&p| view.is_in_front(p)) {
                    return true;
                }
                let [a, b, c] = corners;
                if let Some(normal) = (b - a).cross(c - a).try_normalize() {
                    let axis = normal * normal.dot(a - light).signum();
                    if axes.iter().all(|other| other.dot(axis) < 0.999_999) {
                        axes.push(axis);
                    }
                }
                looked += 1;
                axes.len() < FACING_AXES && looked < MOST_LOOKED_AT
            },
        );
        axes
    }
}

/// Axes that are tried.
const FACING_AXES: usize = 8;

/// Most triangles behind the light that are read for them.
const MOST_LOOKED_AT: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Light;

    /// Meshes with large and small triangles, and places of a light above, among and next to them.
    fn cases() -> Vec<(Mesh, DVec3)> {
        let mut cases = Vec::new();
        for name in ["windmill", "knot", "plant"] {
            let mut mesh = crate::test_scenes::builtin(name).mesh;
            let ground = mesh.ground_below().unwrap();
            mesh.add_ground(&ground);
            let (low, high) = mesh.bounds().unwrap();
            for share in [
                DVec3::new(0.7, 2.5, 0.4),
                DVec3::new(0.45, 0.3, 0.55),
                DVec3::new(1.4, 0.2, -0.3),
                DVec3::new(0.1, 0.9, 0.9),
                DVec3::new(0.52, 3.0, 0.48),
                DVec3::new(0.5, 1.5, 0.51),
            ] {
                cases.push((mesh.clone(), low + (high - low) * share));
            }
        }
        cases
    }

    fn largest(points: impl Iterator<Item = f64>) -> f64 {
        points.fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn what_the_tree_finds_is_what_all_points_tell() {
        for (mesh, light) in cases() {
            let tree = MeshTree::new(&mesh);
            let casters = MeshAndTree { mesh: &mesh, tree: &tree };
            let more = [DVec3::new(3.0, -1.0, 2.0)];
            for which in [Which::Small, Which::All] {
                let points = Points { casters: Some((casters, which)), more: &more };
                let asked = |t: &usize| which == Which::All || !tree.large().contains(&(*t as u32));
                let each = || (0..mesh.triangles.len()).filter(asked).flat_map(|t| mesh.corners(t)).chain(more);
                for k in 0..6 {
                    let axis = DVec3::new(f64::from(k).sin(), f64::from(k).cos() - 0.6, (f64::from(k) * 1.7).sin());
                    let unit = axis.normalize();
                    assert_eq!(points.reach(axis), largest(each().map(|p| p.dot(axis))));
                    let off = |d: DVec3| -d.dot(axis);
                    let found = points.farthest_direction(light, axis).map(off).unwrap();
                    let wanted = largest(each().filter_map(|p| (p - light).try_normalize()).map(off));
                    assert!((found - wanted).abs() <= 1e-14, "{light}: {found} {wanted}");
                    for (across, near) in [(unit.any_orthonormal_vector(), 0.3), (-unit.any_orthonormal_vector(), 5.0)]
                    {
                        let found = points.reach_in_perspective(light, across, unit, near);
                        let wanted = largest(each().map(|p| (p - light).dot(across) / (p - light).dot(unit).max(near)));
                        assert!((found - wanted).abs() <= 1e-12 * wanted.abs(), "{light}: {found} {wanted}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_reaches_behind_the_light_is_counted() {
        let mut behind = [0, 0];
        for (mesh, at) in cases() {
            let tree = MeshTree::new(&mesh);
            let casters = MeshAndTree { mesh: &mesh, tree: &tree };
            let view = LightView::fit(&mesh, &Light::Point { position: at.as_vec3().into() }, 64).unwrap();
            for k in 0..4 {
                let w = view.w + glam::DVec4::new(0.0, 0.0, 0.0, -0.3 * f64::from(k) * view.near);
                let view = LightView { w, ..view };
                let is_behind = |t: &usize| !mesh.corners(*t).iter().all(|&p| view.is_in_front(p));
                let wanted = (0..mesh.triangles.len()).filter(is_behind).count();
                assert_eq!(casters.not_in_front(&view), wanted, "{at} {k}");
                let axes = casters.facing_axes(&view, at);
                assert_eq!(axes.is_empty(), wanted == 0);
                assert!(axes.len() <= FACING_AXES && axes.iter().all(|a| (a.length() - 1.0).abs() < 1e-12));
                behind[usize::from(wanted > 0)] += 1;
            }
        }
        assert!(behind[0] > 5 && behind[1] > 5, "{behind:?}");
    }
}
