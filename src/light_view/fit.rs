//! Fitting the light view: the narrowest view that holds every caster where it can shadow something.

use super::casters::of_large_casters;
use super::points::{MeshAndTree, Points};
use super::{LightView, Receivers, Window};
use crate::scene::mesh_tree::{MeshTree, Which};
use crate::scene::{Light, Mesh};
use crate::{Error, Result};
use glam::{DVec3, DVec4};

/// Widest half angle of the view of a point or spot light, as its tangent: 80 degrees.
const WIDEST: f64 = 5.671_281_819_617_709;

/// Steps towards the middle of all directions; the cone is then within a few degrees of the narrowest.
const CONE_ROUNDS: u32 = 32;

impl LightView {
    /// Fits the view to the casters of `mesh`. Triangles with the whole scene on their light side, such as a ground, cast
    /// nothing and widen it not. A spot or point light gets one view, along the axis of the narrowest cone that holds the
    /// casters (nearly): casters to the side then keep their distance from the plane through the light.
    ///
    /// # Errors
    /// [`Error::Scene`] if the light cannot be used, [`Error::Config`] if the map has no or too many texels, and as
    /// [`Mesh::check`].
    pub fn fit(mesh: &Mesh, light: &Light, map_size: u32) -> Result<Self> {
        Self::fit_for(mesh, light, map_size, Receivers::Planes)
    }

    /// As [`LightView::fit`], by what may be in shadow.
    ///
    /// # Errors
    /// As [`LightView::fit`].
    pub fn fit_for(mesh: &Mesh, light: &Light, map_size: u32, receivers: Receivers) -> Result<Self> {
        mesh.check("mesh")?;
        let tree = &MeshTree::new(mesh);
        let all = MeshAndTree { mesh, tree };
        Self::fit_casters(all, all, light, map_size, receivers)
    }

    /// Likewise of triangles that were checked and whose trees are known: those that cast, and among `all` others that only receive.
    pub(crate) fn fit_casters(
        casters: MeshAndTree,
        all: MeshAndTree,
        light: &Light,
        map_size: u32,
        receivers: Receivers,
    ) -> Result<Self> {
        check(light, map_size)?;
        let every = Points { casters: Some((casters, Which::All)), more: &[] };
        let bounds = all.tree.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let middle = (bounds.0 + bounds.1) * 0.5;
        let ends = [bounds.0, bounds.1];
        let every = if every.is_empty() { Points::of(&ends) } else { every };
        if receivers == Receivers::Anything {
            return Ok(Self::holding(every, middle, light, map_size));
        }
        let closed = receivers == Receivers::Outsides;
        // Of small triangles none is left out.
        let ends = [receivers == Receivers::Planes && !casters.tree.large().is_empty(); 4];
        let mut points = Points { casters: Some((casters, Which::Small)), more: &[] };
        let small = (!points.is_empty()).then(|| Self::holding(points, middle, light, map_size));
        if let Some(view) = small.filter(|view| !view.complete) {
            // If no other axis will do, what the large ones add does not matter.
            let at = light.homogeneous().truncate();
            let axes = casters.facing_axes(&view, at);
            if !axes.into_iter().any(|axis| Self::perspective(points, at, axis, map_size).complete) {
                return Ok(Self { closed, ends, ..view });
            }
        }
        let of_large = of_large_casters((casters, all), light, bounds, small.filter(|view| view.complete), receivers);
        points.more = &of_large;
        if points.is_empty() {
            // Nothing casts on anything: any view will do that is one.
            points = every;
        }
        let l = light.homogeneous();
        if light.is_directional() {
            return Ok(Self { closed, ends, ..Self::directional(points, l.truncate().normalize(), map_size) });
        }
        let start = light.towards(middle).try_normalize().map_or(DVec3::NEG_Y, |d| -d);
        let light = l.truncate();
        let axis = middle_of_directions(points, light, start);
        let view = Self::perspective(points, light, axis, map_size);
        // What casts nothing, such as a ground, is better in front of the light too: what reaches behind it is looked at in
        // every texel.
        let left = |view: &Self| (!view.complete, all.not_in_front(view));
        let mut best = (left(&view), view);
        if best.0 > (false, 0) {
            for axis in all.facing_axes(&view, light) {
                let turned = Self::perspective(points, light, axis, map_size);
                let left = left(&turned);
                if left < best.0 {
                    best = (left, turned);
                }
                if best.0 == (false, 0) {
                    break;
                }
            }
        }
        Ok(Self { closed, ends, ..best.1 })
    }

    /// Fits the view to all triangles of `mesh`, whatever they shadow of one another: for receivers that are no part of it.
    ///
    /// # Errors
    /// As [`LightView::fit`].
    pub fn fit_all(mesh: &Mesh, light: &Light, map_size: u32) -> Result<Self> {
        Self::fit_for(mesh, light, map_size, Receivers::Anything)
    }

    /// The view that holds all of `points`, of which `middle` is somewhere in the middle.
    pub(super) fn holding(points: Points, middle: DVec3, light: &Light, map_size: u32) -> Self {
        let l = light.homogeneous();
        if light.is_directional() {
            Self::directional(points, l.truncate().normalize(), map_size)
        } else {
            let start = light.towards(middle).try_normalize().map_or(DVec3::NEG_Y, |d| -d);
            let axis = middle_of_directions(points, l.truncate(), start);
            Self::perspective(points, l.truncate(), axis, map_size)
        }
    }

    /// Fits the view to a box that holds all casters, between its lowest and its highest corner: for casters whose vertices
    /// are not known. It is wider than that of [`LightView::fit`], so more casters share a texel; the picture is the same.
    ///
    /// # Errors
    /// As [`LightView::fit`].
    pub fn around(bounds: (DVec3, DVec3), light: &Light, map_size: u32) -> Result<Self> {
        Self::around_boxes(&[bounds], light, map_size)
    }

    /// Likewise to several boxes that together hold all casters.
    ///
    /// # Errors
    /// As [`LightView::fit`].
    pub fn around_boxes(boxes: &[(DVec3, DVec3)], light: &Light, map_size: u32) -> Result<Self> {
        check(light, map_size)?;
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let all = boxes.iter().copied().reduce(join).unwrap_or((DVec3::ZERO, DVec3::ONE));
        let boxes = if boxes.is_empty() { &[all] } else { boxes };
        let of_box = |&(lowest, highest): &(DVec3, DVec3)| -> [DVec3; 8] {
            let pick = |k: usize, axis: usize| if k >> axis & 1 == 0 { lowest[axis] } else { highest[axis] };
            std::array::from_fn(|k| DVec3::new(pick(k, 0), pick(k, 1), pick(k, 2)))
        };
        let corners: Vec<DVec3> = boxes.iter().flat_map(of_box).collect();
        Ok(Self::holding(Points::of(&corners), (all.0 + all.1) * 0.5, light, map_size))
    }

    fn directional(points: Points, towards: DVec3, map_size: u32) -> Self {
        let (right, up) = axes(towards);
        let along = [right, up, -towards];
        let lo: DVec3 = along.map(|axis| -points.reach(-axis)).into();
        let hi: DVec3 = along.map(|axis| points.reach(axis)).into();
        let (lo, size) = padded(lo, hi);
        let (scale, pad) = inside(map_size);
        let row = |axis: DVec3, lo: f64, size: f64, scale: f64, pad: f64| {
            (axis * (scale / size)).extend(pad - lo * (scale / size))
        };
        Self {
            map_size,
            u: row(right, lo.x, size.x, scale, pad),
            v: row(up, lo.y, size.y, scale, pad),
            z: row(-towards, lo.z, size.z, 1.0, 0.0),
            w: DVec4::W,
            near: 0.0,
            clear: 0.0,
            perspective: false,
            complete: true,
            one_of_several: false,
            ends: [false; 4],
            closed: false,
            outside: false,
            paraboloid: None,
            lamp: None,
        }
    }

    fn perspective(points: Points, light: DVec3, axis: DVec3, map_size: u32) -> Self {
        let (right, up) = axes(axis);
        let far = (points.reach(axis) - axis.dot(light)).max(f64::MIN_POSITIVE.sqrt());
        let nearest = (-points.reach(-axis) - axis.dot(light)).min(far);
        // Casters nearer than this, or behind the light, are "not in front": they are looked at everywhere.
        let near = (0.5 * nearest).max(1e-4 * far);
        // Nearer ones are held too: they cast on what is as near.
        let held = if nearest > 0.0 { near.min(nearest) } else { near };
        let reach = |across: DVec3| points.reach_in_perspective(light, across, axis, held);
        let (lo, hi) = ([-reach(-right), -reach(-up)], [reach(right), reach(up)]);
        let widest = [-lo[0], -lo[1], hi[0], hi[1]].into_iter().fold(0.0, f64::max);
        let complete = nearest > 0.0 && widest <= WIDEST;
        let [lo, hi] = [lo, hi].map(|[x, y]| DVec3::new(x.clamp(-WIDEST, WIDEST), y.clamp(-WIDEST, WIDEST), 0.0));
        let window = Window { low: lo, high: hi, near, far, clear: nearest };
        Self { complete, ..Self::through(window, light, axis, map_size) }
    }

    /// The view from a point along `axis`.
    pub(super) fn through(window: Window, light: DVec3, axis: DVec3, map_size: u32) -> Self {
        let Window { low, high, near, far, clear } = window;
        let (right, up) = axes(axis);
        let (lo, size) = padded(low, high);
        let (scale, pad) = inside(map_size);
        let origin = |axis: DVec3| axis.extend(-axis.dot(light));
        let w = origin(axis);
        let row = |axis: DVec3, lo: f64, size: f64| (origin(axis) - w * lo) * (scale / size) + w * pad;
        // depth = (1/near - 1/w) / (1/near - 1/far) = (far * w - near * far) / ((far - near) * w)
        let far = far.max(near * 1.001);
        let z = (w * far - DVec4::W * (near * far)) / (far - near);
        Self {
            map_size,
            u: row(right, lo.x, size.x),
            v: row(up, lo.y, size.y),
            z,
            w,
            near,
            clear,
            perspective: true,
            complete: true,
            one_of_several: false,
            ends: [false; 4],
            closed: false,
            outside: false,
            paraboloid: None,
            lamp: Some(light),
        }
    }
}

/// Whether light and map can be used.
pub(super) fn check(light: &Light, map_size: u32) -> Result<()> {
    light.check()?;
    if !(1..=LightView::LARGEST_MAP).contains(&map_size) {
        return Err(Error::Config(format!(
            "a map of {map_size} texels a side; 1 to {} are possible",
            LightView::LARGEST_MAP
        )));
    }
    Ok(())
}

/// The scale and padding that keep the casters at least a texel inside the map, where it is that large.
pub(super) fn inside(map_size: u32) -> (f64, f64) {
    let size = f64::from(map_size);
    if map_size < 4 { (size * 0.5, size * 0.25) } else { (size - 2.0, 1.0) }
}

/// Lowest corner and extent of a box, with no side of length 0.
fn padded(lo: DVec3, hi: DVec3) -> (DVec3, DVec3) {
    if !lo.is_finite() || !hi.is_finite() {
        return (DVec3::ZERO, DVec3::ONE);
    }
    let size = hi - lo;
    let least = size.max_element().max(lo.abs().max_element() * 1e-6).max(1e-30) * 1e-3;
    let grown = size.max(DVec3::splat(least));
    (lo - (grown - size) * 0.5, grown)
}

/// The axis of nearly the narrowest cone from `light` that holds all `points`: the farthest direction draws it nearer, by
/// less each time (Bădoiu and Clarkson 2003).
fn middle_of_directions(points: Points, light: DVec3, start: DVec3) -> DVec3 {
    let mut axis = start;
    for round in 0..CONE_ROUNDS {
        let Some(farthest) = points.farthest_direction(light, axis) else { break };
        axis += (farthest - axis) / f64::from(round + 2);
    }
    axis.try_normalize().unwrap_or(start)
}

/// Two unit axes across `along`.
pub(super) fn axes(along: DVec3) -> (DVec3, DVec3) {
    let helper = if along.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let right = along.cross(helper).normalize();
    (right, right.cross(along))
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;
    use glam::DMat4;

    #[test]
    fn casters_lie_inside_the_map_and_the_ground_does_not_widen_it() {
        let mesh = scene();
        for light in [
            Light::Directional { direction: [0.3, 1.0, 0.2] },
            Light::Point { position: [0.5, 6.0, 0.5] },
            Light::Spot { position: [3.0, 6.0, 2.0], target: [0.0, 0.0, 0.0], angle_degrees: 40.0 },
        ] {
            let view = LightView::fit(&mesh, &light, 64).unwrap();
            let mut widest = DVec3::ZERO;
            for p in &mesh.positions[..4] {
                let at = view.project(glam::Vec3::from(*p).as_dvec3()).unwrap();
                assert!(at.x >= 0.99 && at.y >= 0.99 && at.x <= 63.01 && at.y <= 63.01, "{light:?} {at}");
                assert!((-1e-9..=1.0 + 1e-9).contains(&at.z), "{light:?} {at}");
                widest = widest.max(at);
            }
            assert!(widest.x > 60.0 && widest.y > 60.0, "{light:?}: the view is wider than its casters: {widest}");
        }
    }

    #[test]
    fn a_scene_in_which_nothing_casts_has_a_view_too() {
        let sheet =
            Mesh { positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], triangles: vec![[0, 2, 1]] };
        for mesh in [sheet, Mesh::default()] {
            for light in [Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Point { position: [0.5, 6.0, 0.5] }]
            {
                let view = LightView::fit(&mesh, &light, 64).unwrap();
                let inverse = DMat4::from_cols(view.u, view.v, view.z, view.w).inverse();
                assert!(inverse.is_finite() && (view.near > 1.0 || light.is_directional()), "{light:?} {view:?}");
            }
        }
    }

    #[test]
    fn a_wide_floor_under_a_point_light_lies_in_front_of_it() {
        for name in ["spheres", "cage"] {
            let scene = crate::test_scenes::builtin(name);
            let view = LightView::fit(&scene.mesh, &scene.light, 512).unwrap();
            for p in &scene.mesh.positions {
                let at = view.project(glam::Vec3::from(*p).as_dvec3());
                assert!(at.is_some_and(|at| at.z >= -1e-9), "{name}: {p:?} at {at:?}");
            }
            let samples = crate::samples::Samples::new(Default::default(), 32).unwrap();
            let bounds = scene.mesh.bounds().unwrap();
            let frame = crate::frame::Frame::new(&scene.camera, &scene.light, &view, bounds, [8, 6], &samples);
            assert!(frame.map_margin < 0.1 && frame.depth_margin < 1e-3, "{name}: {}", frame.map_margin);
        }
    }

    /// A lamp over a floor that reaches farther to one side than to the other, and a column that rises above it: what the view holds
    /// comes before what lies in front of the light.
    #[test]
    fn a_view_that_holds_all_comes_first() {
        let mut incomplete = 0;
        for (wide, tall) in [(5.0, 3.0), (5.0, 1.5), (5.0, 12.0), (1.0, 3.0), (30.0, 3.0), (30.0, 40.0)] {
            let mut mesh = Mesh::default();
            let mut quad = |corners: [[f32; 3]; 4]| {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(corners);
                mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| first + k)));
            };
            for k in 0..32 {
                let x = -60.0 + 2.5 * k as f32;
                quad([[x, 0.0, -wide], [x, 0.0, wide], [x + 2.5, 0.0, wide], [x + 2.5, 0.0, -wide]]);
            }
            for [a, b] in [
                [[10.0, -0.5], [10.0, 0.5]],
                [[10.0, 0.5], [11.0, 0.5]],
                [[11.0, 0.5], [11.0, -0.5]],
                [[11.0, -0.5], [10.0, -0.5]],
            ] {
                quad([[a[0], 0.0, a[1]], [b[0], 0.0, b[1]], [b[0], tall, b[1]], [a[0], tall, a[1]]]);
            }
            quad([[10.0, tall, -0.5], [10.0, tall, 0.5], [11.0, tall, 0.5], [11.0, tall, -0.5]]);
            let light = Light::Point { position: [0.0, 1.0, 0.0] };
            let view = LightView::fit_for(&mesh, &light, 64, Receivers::Outsides).unwrap();
            incomplete += usize::from(!view.complete);
        }
        assert_eq!(incomplete, 0);
    }

    #[test]
    fn a_ground_lies_in_front_of_a_lamp_above_it() {
        for (name, high) in [("spheres", 4.9), ("cage", 5.2), ("plant", 6.0)] {
            let mut mesh = crate::test_scenes::builtin(name).mesh;
            let ground = mesh.ground_below().unwrap();
            mesh.add_ground(&ground);
            for (x, z) in [(-2.6, 3.1), (1.0, 0.2), (-5.0, -4.0)] {
                let view = LightView::fit(&mesh, &Light::Point { position: [x, high, z] }, 512).unwrap();
                assert!(
                    mesh.positions.iter().all(|p| view.is_in_front(glam::Vec3::from(*p).as_dvec3())),
                    "{name} {x} {z}"
                );
            }
        }
    }

    #[test]
    fn a_box_of_casters_lies_inside_its_map() {
        let (low, high) = (DVec3::new(-1.0, 0.0, -2.0), DVec3::new(1.0, 3.0, 0.5));
        for light in [Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Point { position: [0.5, 6.0, 0.5] }] {
            let view = LightView::around((low, high), &light, 64).unwrap();
            assert!(view.complete);
            for k in 0..27 {
                let at = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) * 0.5;
                let p = view.project(low + (high - low) * at).unwrap();
                assert!(p.min_element() >= -1e-9 && p.x <= 64.0 && p.y <= 64.0 && p.z <= 1.0 + 1e-9, "{light:?} {p}");
            }
        }
        let inside = LightView::around((low, high), &Light::Point { position: [0.0, 1.0, 0.0] }, 64).unwrap();
        assert!(!inside.complete);
        assert!(LightView::around((low, high), &Light::Point { position: [0.0, 9.0, 0.0] }, 0).is_err());
    }

    /// The share of the map's width and height that a box of points takes.
    fn share(view: &LightView, points: &[DVec3]) -> DVec3 {
        let at = points.iter().map(|&p| view.project(p).expect("in front of the light"));
        let (lo, hi) = at.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), at| (lo.min(at), hi.max(at)));
        assert!(
            lo.truncate().min_element() > 0.0 && hi.truncate().max_element() < f64::from(view.map_size),
            "{lo} {hi}"
        );
        (hi - lo) / f64::from(view.map_size)
    }

    #[test]
    fn a_slab_does_not_widen_the_view_of_what_stands_on_it() {
        for name in ["knot", "spheres", "cage"] {
            let scene = crate::test_scenes::builtin(name);
            let prepared = crate::methods::Prepared::new(&scene.mesh).unwrap();
            let points: Vec<DVec3> = prepared
                .mesh
                .positions
                .iter()
                .map(|p| glam::Vec3::from(*p).as_dvec3())
                .filter(|p| p.y > 0.001)
                .collect();
            for light in [
                scene.light,
                Light::Directional { direction: [0.3, 1.0, 0.2] },
                Light::Point { position: [-3.0, 6.0, 2.0] },
            ] {
                let receivers = if prepared.closed { Receivers::Outsides } else { Receivers::Surfaces };
                let view = LightView::fit_for(&prepared.mesh, &light, 512, receivers).unwrap();
                assert_eq!(view.closed, name != "cage");
                assert!(
                    share(&view, &points).truncate().min_element() > 0.7,
                    "{name} {light:?} {}",
                    share(&view, &points)
                );
                // With both its sides the slab takes most of the map.
                let both = LightView::fit_for(&prepared.mesh, &light, 512, Receivers::Surfaces).unwrap();
                assert!(name == "cage" || share(&both, &points).truncate().max_element() < 0.5, "{name} {light:?}");
            }
        }
    }

    #[test]
    fn of_a_large_triangle_the_part_before_something_is_in_the_view() {
        // A roof over a small table, both turned up; by two sheets of another kind the part is told apart.
        let mut mesh = Mesh::default();
        for (half, y) in [(10.0f32, 3.0f32), (0.5, 0.0)] {
            let base = mesh.positions.len() as u32;
            mesh.positions.extend([[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]]);
            mesh.triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
        }
        for light in [
            Light::Directional { direction: [0.3, 1.0, 0.2] },
            Light::Point { position: [1.0, 9.0, 0.5] },
            Light::Directional { direction: [0.0, 1.0, 0.0] },
        ] {
            for (mesh, receivers) in [(&mesh, Receivers::Outsides), (&mesh, Receivers::Surfaces)] {
                let view = LightView::fit_for(mesh, &light, 64, receivers).unwrap();
                let mut off = 0.0f64;
                for (x, z) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (0.0, 0.0)] {
                    // Where the ray from a place of the table to the light meets the roof.
                    let place = DVec3::new(x, 0.0, z);
                    let to = light.towards(place);
                    let at = view.project(place + to * (3.0 / to.y)).unwrap();
                    assert!(at.truncate().min_element() > 0.9 && at.truncate().max_element() < 63.1, "{light:?} {at}");
                    off = off.max((at.truncate() - 32.0).abs().max_element());
                }
                assert!(off > 20.0, "{light:?}: the roof widens the view: {off}");
            }
        }
        // Turned over, the table is lit on no side that a closed mesh shows.
        let mut over = mesh.clone();
        over.triangles[2..].iter_mut().for_each(|t| t.swap(1, 2));
        let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
        let casters = MeshAndTree { mesh: &over, tree: &MeshTree::new(&over) };
        let points =
            |receivers| of_large_casters((casters, casters), &light, over.bounds().unwrap(), None, receivers).len();
        let (a, b) = (points(Receivers::Outsides), points(Receivers::Surfaces));
        assert!(a == 0 && b > 0, "{a} {b}");
    }
}
