//! A cube of views around a light that stands among its casters.

use super::casters::clip;
use super::fit::{axes, check};
use super::points::MeshAndTree;
use super::{LightView, WIDER, Window};
use crate::Result;
use crate::scene::mesh_tree::{Bounds, MeshTree, Which};
use crate::scene::{Light, Mesh};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Half the width of a side's view at distance 1.
const HALF: f64 = WIDER;

/// Cones wider than this, degrees, have no view of their own: its texels would be too coarse at its middle.
const WIDEST_CONE: f32 = 150.0;

/// Nearest distance along a view's axis that is tested by depth, as a share of the farthest. What reaches nearer is tested everywhere.
const NEAREST: f64 = 1.0 / 1024.0;

const SIDES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

impl LightView {
    /// Views that together hold every caster of `mesh` around a point or spot light, whatever they shadow of one another: one for
    /// each side of a cube in which a caster is, as narrow as the casters there allow. A sample in none of them is lit; one at a
    /// cube's edge lies in two, and each tells what shadows it.
    ///
    /// # Errors
    /// As [`LightView::fit`]; [`Error::Scene`](crate::Error::Scene) for a directional light, which has no place to be seen from.
    pub fn cube(mesh: &Mesh, light: &Light, map_size: u32) -> Result<Vec<Self>> {
        mesh.check("mesh")?;
        Self::cube_of(MeshAndTree { mesh, tree: &MeshTree::new(mesh) }, light, map_size)
    }

    /// Likewise of a mesh that was checked, and whose tree is known.
    pub(crate) fn cube_of(casters: MeshAndTree, light: &Light, map_size: u32) -> Result<Vec<Self>> {
        Self::cube_within(casters, light, map_size, f64::INFINITY)
    }

    /// Likewise of what is no farther from the light than `range`.
    pub(crate) fn cube_within(casters: MeshAndTree, light: &Light, map_size: u32, range: f64) -> Result<Vec<Self>> {
        check(light, map_size)?;
        let at = position(light)?;
        let of_side =
            |&side: &DVec3| Reach::of_all(casters, at, side, (HALF, range)).map(|reach| reach.view(at, side, map_size));
        let views: Vec<Self> = SIDES.par_iter().filter_map(of_side).collect();
        if views.is_empty() {
            // Nothing casts on anything: any view will do that is one.
            return Ok(vec![Reach::whole(1.0, 1.0, HALF).view(at, SIDES[0], map_size)]);
        }
        Ok(views)
    }

    /// The same of a box that holds all casters, between its lowest and its highest corner.
    ///
    /// # Errors
    /// As [`LightView::cube`].
    pub fn cube_around((low, high): (DVec3, DVec3), light: &Light, map_size: u32) -> Result<Vec<Self>> {
        // All six sides, up to the farthest corner, and next to the light.
        check(light, map_size)?;
        let at = position(light)?;
        let far = (low - at).abs().max((high - at).abs()).max_element().max(f64::MIN_POSITIVE.sqrt());
        Ok(SIDES.iter().map(|&side| Reach::whole(0.0, far, HALF).view(at, side, map_size)).collect())
    }

    /// The same of several boxes that together hold all casters: of a light outside all of them, those sides in which one is, as narrow as they allow.
    ///
    /// # Errors
    /// As [`LightView::cube`].
    pub fn cube_around_boxes(boxes: &[(DVec3, DVec3)], light: &Light, map_size: u32) -> Result<Vec<Self>> {
        check(light, map_size)?;
        let at = position(light)?;
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let all = boxes.iter().copied().reduce(join).unwrap_or((DVec3::ZERO, DVec3::ONE));
        let slack = 1e-3 * (all.1 - all.0).max_element();
        let holds = |(low, high): &(DVec3, DVec3)| at.cmpge(*low - slack).all() && at.cmple(*high + slack).all();
        if boxes.iter().any(holds) {
            // Others in the box with it may be anywhere.
            return Self::cube_around(all, light, map_size);
        }
        // Each ray that meets a caster meets a side of its box before it, and one behind it.
        let mut mesh = Mesh::default();
        for &(low, high) in boxes {
            let first = mesh.positions.len() as u32;
            let pick = |k: u32, axis: usize| (if k >> axis & 1 == 0 { low[axis] } else { high[axis] }) as f32;
            mesh.positions.extend((0..8).map(|k| [pick(k, 0), pick(k, 1), pick(k, 2)]));
            let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let halves = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
            mesh.triangles.extend(halves.map(|t| t.map(|v| v + first)));
        }
        Self::cube_of(MeshAndTree { mesh: &mesh, tree: &MeshTree::new(&mesh) }, light, map_size)
    }

    /// The view of a spot light's cone, as narrow as the casters in it allow that are no farther than `range`: outside the cone, and farther, it may miss
    /// some. `None` for other lights, and cones of more than 150 degrees.
    ///
    /// # Errors
    /// As [`LightView::cube`].
    pub(crate) fn cone_of(casters: MeshAndTree, light: &Light, map_size: u32, range: f64) -> Result<Option<Self>> {
        check(light, map_size)?;
        let Some((at, axis, half)) = cone(light) else { return Ok(None) };
        // Nothing casts: any view of the cone will do.
        let reach = Reach::of_all(casters, at, axis, (half, range)).unwrap_or(Reach::whole(1.0, 1.0, half));
        Ok(Some(reach.view(at, axis, map_size)))
    }

    /// The same of a box that holds all casters.
    ///
    /// # Errors
    /// As [`LightView::cube`].
    pub(crate) fn cone_around((low, high): (DVec3, DVec3), light: &Light, map_size: u32) -> Result<Option<Self>> {
        check(light, map_size)?;
        let Some((at, axis, half)) = cone(light) else { return Ok(None) };
        let far = (axis * (low - at)).max(axis * (high - at)).element_sum().max(f64::MIN_POSITIVE.sqrt());
        Ok(Some(Reach::whole(0.0, far, half).view(at, axis, map_size)))
    }
}

/// Place and axis of a spot light, and half the width of its view at distance 1; `None` where it has none.
fn cone(light: &Light) -> Option<(DVec3, DVec3, f64)> {
    let Light::Spot { position, target, angle_degrees } = *light else { return None };
    let [at, target] = [position, target].map(|p| Vec3::from(p).as_dvec3());
    let half = (f64::from(angle_degrees).to_radians() / 2.0).tan() * WIDER;
    (angle_degrees <= WIDEST_CONE).then(|| (at, (target - at).normalize(), half))
}

fn position(light: &Light) -> Result<DVec3> {
    if light.is_directional() {
        return Err(crate::Error::Scene("a directional light stands nowhere: no cube of views".to_owned()));
    }
    Ok(light.homogeneous().truncate())
}

/// Extent of casters in a side: across and along its axis.
#[derive(Clone, Copy)]
struct Reach {
    low: [f64; 2],
    high: [f64; 2],
    nearest: f64,
    farthest: f64,
}

impl Reach {
    const NONE: Self = Self {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
        nearest: f64::INFINITY,
        farthest: f64::NEG_INFINITY,
    };

    /// All of a view, between two distances along its axis.
    fn whole(nearest: f64, farthest: f64, half: f64) -> Self {
        Self { low: [-half; 2], high: [half; 2], nearest, farthest }
    }

    /// Reach of all casters in a range; `None` if none is in the pyramid of the side, or the cone, of this half width.
    fn of_all(casters: MeshAndTree, light: DVec3, side: DVec3, (half, range): (f64, f64)) -> Option<Self> {
        let (right, up) = axes(side);
        let out = |b: &Bounds, across: DVec3| {
            let inward = side * half - across;
            b.reach(inward) < inward.dot(light)
        };
        // Along one axis alone, and that of the box: more may be in the range than is.
        let farther = |b: &Bounds| range < f64::INFINITY && -b.reach(-side) - side.dot(light) > range;
        let greatest = |above: &dyn Fn(&Bounds) -> f64, value: &dyn Fn(Self) -> f64| {
            let above = |b: &Bounds| {
                let beside = [right, -right, up, -up].into_iter().any(|across| out(b, across));
                if beside || farther(b) { f64::NEG_INFINITY } else { above(b) }
            };
            let value = |corners: [DVec3; 3]| {
                let reach = Self::of(corners.map(|p| p - light), side, half);
                if reach.nearest <= range && reach.low[0] <= reach.high[0] { value(reach) } else { f64::NEG_INFINITY }
            };
            casters.tree.greatest(casters.mesh, Which::All, above, value).map(|(reach, _)| reach)
        };
        // From the light along the axis, of a box.
        let (nearest, farthest) =
            (|b: &Bounds| -b.reach(-side) - side.dot(light), |b: &Bounds| b.reach(side) - side.dot(light));
        let ratio = |b: &Bounds, across: DVec3| {
            if nearest(b) <= 0.0 {
                return half;
            }
            let corners = b.corners().map(|p| (p - light).dot(across) / (p - light).dot(side));
            (corners.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1e-9).min(half)
        };
        Some(Self {
            low: [-greatest(&|b| ratio(b, -right), &|r| -r.low[0])?, -greatest(&|b| ratio(b, -up), &|r| -r.low[1])?],
            high: [greatest(&|b| ratio(b, right), &|r| r.high[0])?, greatest(&|b| ratio(b, up), &|r| r.high[1])?],
            nearest: -greatest(&|b| -nearest(b).max(0.0), &|r| -r.nearest)?,
            farthest: greatest(&farthest, &|r| r.farthest)?,
        })
    }

    /// Reach of the part of a triangle, relative to the light, that lies in the pyramid of a side.
    fn of(triangle: [DVec3; 3], side: DVec3, half: f64) -> Self {
        let (right, up) = axes(side);
        let mut part = triangle.to_vec();
        for across in [right, -right, up, -up] {
            clip(&mut part, |p| half * p.dot(side) - p.dot(across));
        }
        let of_point = |p: &DVec3| {
            let w = p.dot(side).max(0.0);
            // At the light itself it is everywhere.
            let [low, high] = if w > 0.0 {
                let at = [p.dot(right) / w, p.dot(up) / w].map(|v| v.clamp(-half, half));
                [at, at]
            } else {
                [[-half; 2], [half; 2]]
            };
            Self { low, high, nearest: w, farthest: w }
        };
        part.iter().map(of_point).fold(Self::NONE, Self::join)
    }

    fn join(self, o: Self) -> Self {
        Self {
            low: [self.low[0].min(o.low[0]), self.low[1].min(o.low[1])],
            high: [self.high[0].max(o.high[0]), self.high[1].max(o.high[1])],
            nearest: self.nearest.min(o.nearest),
            farthest: self.farthest.max(o.farthest),
        }
    }

    fn view(self, light: DVec3, side: DVec3, map_size: u32) -> LightView {
        let far = self.farthest.max(f64::MIN_POSITIVE.sqrt());
        let near = (0.5 * self.nearest).max(NEAREST * far);
        let [low, high] = [self.low, self.high].map(|[x, y]| DVec3::new(x, y, 0.0));
        let window = Window { low, high, near, far, clear: self.nearest };
        LightView { one_of_several: true, ..LightView::through(window, light, side, map_size) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_mesh(count: usize) -> Mesh {
        let mut state = 12345u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from_bits(0x3f80_0000 | state >> 9) * 2.0 - 3.0
        };
        let mut mesh = Mesh::default();
        for t in 0..count as u32 {
            let middle = [4.0 * next(), 4.0 * next(), 4.0 * next()];
            for _ in 0..3 {
                mesh.positions.push(middle.map(|m| m + next()));
            }
            mesh.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        }
        mesh
    }

    #[test]
    fn every_point_of_every_caster_lies_in_a_view() {
        let mesh = random_mesh(300);
        let light = Light::Point { position: [0.1, -0.2, 0.3] };
        let views = LightView::cube(&mesh, &light, 64).unwrap();
        assert_eq!(views.len(), 6);
        assert!(!LightView::fit(&mesh, &light, 64).unwrap().complete, "one view is enough");
        let mut twice = 0;
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t);
            for (i, j) in (0..=8).flat_map(|i| (0..=8 - i).map(move |j| (i, j))) {
                let p = a + (b - a) * (f64::from(i) / 8.0) + (c - a) * (f64::from(j) / 8.0);
                let inside = |view: &&LightView| {
                    let q = p.extend(1.0);
                    let (u, v, w) = (view.u.dot(q), view.v.dot(q), view.w.dot(q));
                    w >= 0.0 && u >= 0.0 && v >= 0.0 && u <= 64.0 * w && v <= 64.0 * w
                };
                let found = views.iter().filter(inside).count();
                assert!(found >= 1, "{p} lies in no view");
                twice += usize::from(found > 1);
            }
        }
        assert!(twice > 0, "no point at an edge of the cube");
    }

    /// Points of boxes, and those of their inside, lie in views in front of and within their depths; a light that stands in one has all six sides.
    #[test]
    fn every_point_of_every_box_lies_in_a_view() {
        let boxes = [
            (DVec3::new(1.0, -0.5, -0.5), DVec3::new(3.0, 0.5, 0.75)),
            (DVec3::new(-4.0, -1.0, 2.0), DVec3::new(-0.25, 3.0, 2.0)),
            (DVec3::new(-1.0, -6.0, -1.0), DVec3::new(0.5, -3.0, 1.0)),
        ];
        let views = LightView::cube_around_boxes(&boxes, &Light::Point { position: [0.0; 3] }, 64).unwrap();
        assert_eq!(views.len(), 5, "in one side there is none");
        let mut missed = 0;
        for (low, high) in boxes {
            for k in 0..729u32 {
                let share = DVec3::new(f64::from(k % 9), f64::from(k / 9 % 9), f64::from(k / 81)) / 8.0;
                let p = low + (high - low) * share;
                let inside = |view: &&LightView| {
                    let q = p.extend(1.0);
                    let [u, v, z, w] = [view.u, view.v, view.z, view.w].map(|row| row.dot(q));
                    let across = w > 0.0 && u >= 0.0 && v >= 0.0 && u <= 64.0 * w && v <= 64.0 * w;
                    across && w >= view.clear - 1e-9 && z <= (1.0 + 1e-9) * w
                };
                assert!(views.iter().any(|view| inside(&view)), "{p} lies in no view");
                // A view fewer is told.
                missed += u32::from(!views[1..].iter().any(|view| inside(&view)));
            }
        }
        assert!(missed > 20, "{missed}");
        let within = Light::Point { position: [2.0, -0.25, 0.0] };
        assert_eq!(LightView::cube_around_boxes(&boxes, &within, 64).unwrap().len(), 6);
    }

    #[test]
    fn sides_without_casters_have_no_view_and_others_are_as_narrow_as_what_is_there() {
        let small = |x: f32, y: f32, z: f32| [[x, y, z], [x + 0.5, y, z], [x, y + 0.5, z]];
        let corners: Vec<_> = [small(0.0, 0.0, 5.0), small(0.0, 0.0, -4.0)].concat();
        let mesh = Mesh { positions: corners, triangles: vec![[0, 1, 2], [3, 4, 5]] };
        let views = LightView::cube(&mesh, &Light::Point { position: [0.0; 3] }, 64).unwrap();
        assert_eq!(views.len(), 2);
        for (view, p) in views.iter().zip([DVec3::new(0.5, 0.0, 5.0), DVec3::new(0.5, 0.0, -4.0)]) {
            let at = view.project(p).unwrap();
            assert!(at.x < 1.1 || at.x > 62.9, "{at}");
            assert!(at.z.abs() <= 1.0 + 1e-9 && view.near > 1.9, "{at} {}", view.near);
        }
        assert!(LightView::cube(&mesh, &Light::Directional { direction: [0.0, 1.0, 0.0] }, 64).is_err());
        let around =
            LightView::cube_around((DVec3::splat(-1.0), DVec3::splat(2.0)), &Light::Point { position: [0.0; 3] }, 8);
        assert_eq!(around.unwrap().len(), 6);
        assert_eq!(LightView::cube(&Mesh::default(), &Light::Point { position: [0.0; 3] }, 8).unwrap().len(), 1);
    }
}
