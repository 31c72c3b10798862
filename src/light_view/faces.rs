//! Parts of a camera's view by the faces of its frustum (Kozlov 2004: Perspective Shadow Maps, Care and Feeding, in GPU Gems; Lloyd, Tuft, Yoon, Manocha
//! 2006: Warping and Partitioning for Low Error Shadow Maps; Scherzer 2011, section 4.3.2).
//!
//! Every ray of light through the frustum passes one of its sides on the way in and one face on the way out. Those of one side lie between the
//! two planes through the light, the eye and the side's edges: a wedge, on the light's map a sector about the eye. Within it pixels get
//! smaller along one line, the side's middle, along which a warp bends the map.

use super::LightView;
use super::SeenBox;
use glam::{DMat3, DVec3, DVec4};

/// Share of a side by which its wedge is wider, so that rounding leaves no gap between two.
const WIDER: f64 = 1e-4;

impl LightView {
    /// Where the light is, in the view's space: a point and 1, or a unit direction towards it and 0. Of a view without a warp.
    fn light(&self) -> DVec4 {
        let [u, v, w] = [self.u, self.v, self.w].map(DVec4::truncate);
        if self.perspective {
            // All three rows are 0 there.
            let rows = DMat3::from_cols(u, v, w).transpose();
            return (rows.inverse() * -DVec3::new(self.u.w, self.v.w, self.w.w)).extend(1.0);
        }
        let along = u.cross(v).normalize_or_zero();
        (along * -along.dot(self.z.truncate()).signum()).extend(0.0)
    }
}

impl LightView {
    /// The area over which a warp spreads the texels of a map, in texels of this view.
    pub(super) fn spread(&self, warp: DMat3) -> f64 {
        let (back, side) = (warp.inverse(), f64::from(self.map_size));
        let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| {
            let p = back * DVec3::new(x, y, 1.0);
            p.truncate() / p.z
        });
        0.5 * (corners[2] - corners[0]).perp_dot(corners[3] - corners[1]).abs()
    }
}

impl SeenBox {
    /// The parts by the sides that light comes in by, or, from in front of the camera, goes out by; each wider by a share `overlap` of its side. All
    /// of it is one part where the light is in the frustum and comes in by no side.
    pub(super) fn faces(&self, view: &LightView, overlap: f64) -> Vec<Self> {
        let light = view.light();
        let to = light.truncate();
        // Beyond what is seen, or before: in the first case light leaves by sides, in the other it comes in by them.
        let farthest = self.box_corners().map(|p| p.dot(self.forward)).fold(0.0, f64::max);
        let before = to.dot(self.forward) <= light.w * farthest;
        let by = overlap.max(WIDER);
        let side = |k: usize| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 4]);
            let outward = a.cross(b) * -a.cross(b).dot(self.corners[(k + 2) % 4]).signum();
            let lit = outward.dot(to);
            // Nearly no light passes a side that looks along it.
            if lit.abs() <= 1e-9 * outward.length() * to.length() || (lit > 0.0) != before {
                return None;
            }
            let middle = (a + b) * 0.5;
            let plane = |edge: DVec3| {
                let normal = edge.cross(to);
                normal * normal.dot(middle).signum()
            };
            Some(Self { axis: middle, wedge: [plane(a - (b - a) * by), plane(b + (b - a) * by)], ..*self })
        };
        let sides: Vec<Self> = (0..4).filter_map(side).collect();
        if sides.is_empty() { vec![*self] } else { sides }
    }

    /// From which to which depth the part between two depths that lies in `view` reaches; `None` if there is none.
    pub(super) fn range(&self, view: &LightView, near: f64, far: f64) -> Option<[f64; 2]> {
        let part = self.part(view, near, far);
        let depths = part.iter().map(|p| p.dot(self.forward));
        let (from, to) = depths.fold((f64::INFINITY, 0.0f64), |(lo, hi), d| (lo.min(d), hi.max(d)));
        (from <= to).then_some([from.max(near), to])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PartBy, SplitPlan, Warp};
    use super::*;
    use crate::scene::{Camera, Light, Mesh};
    use crate::test_scenes::builtin;

    const SIZE: [u32; 2] = [64, 48];
    const FACES: SplitPlan = SplitPlan {
        by: PartBy::FrustumFaces,
        splits: 1,
        warp: Warp::Fitted,
        focus: SplitPlan::FOCUS,
        weight: SplitPlan::WEIGHT,
    };

    fn sun(direction: [f32; 3]) -> Light {
        Light::Directional { direction }
    }

    /// A camera over a wide ground that looks along it.
    fn over_ground() -> (Mesh, Camera) {
        let corners = [[-40.0, -90.0], [40.0, -90.0], [40.0, 9.0], [-40.0, 9.0]];
        let mut mesh =
            Mesh { positions: corners.map(|[x, z]| [x, 0.0, z]).to_vec(), triangles: vec![[0, 2, 1], [0, 3, 2]] };
        // Towers, so that shadows may fall anywhere.
        for (k, [x, z]) in
            [[0.0, -30.0], [-39.0, -88.0], [39.0, -88.0], [39.0, 8.0], [-39.0, 8.0]].into_iter().enumerate()
        {
            mesh.positions.extend([[x - 1.0, 0.0, z], [x + 1.0, 0.0, z], [x, 8.0, z]]);
            let at = 4 + 3 * k as u32;
            mesh.triangles.push([at, at + 1, at + 2]);
        }
        let camera = builtin("plane").camera;
        (mesh, Camera { eye: [0.0, 2.0, 6.0], target: [0.0, 1.6, -20.0], up: [0.0, 1.0, 0.0], near: 0.1, ..camera })
    }

    fn cameras(camera: Camera) -> [Camera; 3] {
        let near = Camera { eye: [0.4, 0.5, 1.1], target: [0.0, 0.8, 0.0], near: 0.01, ..camera };
        [camera, near, Camera { eye: [0.3, 6.0, 0.4], target: [0.0; 3], up: [0.0, 0.0, 1.0], ..camera }]
    }

    fn lights() -> [Light; 8] {
        [
            sun([0.3, 1.0, 0.2]),
            sun([0.0, 1.0, 0.0]),
            sun([0.1, 0.3, 1.0]),
            sun([-0.2, 0.4, -1.0]),
            Light::Point { position: [1.0, 9.0, 2.0] },
            Light::Point { position: [0.0, 20.0, 40.0] },
            Light::Point { position: [-9.0, 12.0, -30.0] },
            // Within sight.
            Light::Point { position: [0.0, 5.0, -0.5] },
        ]
    }

    /// Points that rays through the image meet in the mesh's box, at several depths.
    fn seen_points(mesh: &Mesh, camera: &Camera) -> Vec<DVec3> {
        let rays = camera.rays(SIZE[0], SIZE[1]);
        let [a, b, c, d] = rays.corners(SIZE[0], SIZE[1]);
        let (low, high) = mesh.bounds().unwrap();
        let mut found = Vec::new();
        for k in 0..16 * 16 * 8 {
            let share = |k: i32| f64::from(k % 16) / 15.0;
            let ray = a.lerp(b, share(k)).lerp(d.lerp(c, share(k)), share(k / 16));
            let [from, to] = [(low - rays.eye) / ray, (high - rays.eye) / ray];
            let near = from.min(to).max_element().max(f64::from(camera.near));
            let far = from.max(to).min_element();
            if near < far {
                found.push(rays.eye + ray * (near + (far - near) * (f64::from(k / 256) + 0.5) / 8.0));
            }
        }
        found
    }

    fn holds(view: &LightView, p: DVec3) -> bool {
        let side = f64::from(view.map_size) + 1e-6;
        view.project(p).is_some_and(|t| t.truncate().min_element() > -1e-6 && t.truncate().max_element() < side)
    }

    /// All that is seen and in the whole view lies on the map of a face. Where one is left out, something does not.
    #[test]
    fn faces_hold_what_is_seen() {
        let scene = builtin("windmill");
        let (ground, along) = over_ground();
        let scenes = cameras(scene.camera).map(|c| (&scene.mesh, c)).into_iter().chain([(&ground, along)]);
        let [mut points, mut faces, mut missed] = [0; 3];
        for (mesh, camera) in scenes {
            let bounds = mesh.bounds().unwrap();
            for light in lights() {
                let whole = LightView::fit(mesh, &light, 64).unwrap();
                let seen: Vec<DVec3> = seen_points(mesh, &camera).into_iter().filter(|&p| holds(&whole, p)).collect();
                points += seen.len();
                for (warp, overlap) in
                    [(Warp::Box, 0.0), (Warp::LightSpace, 0.0), (Warp::Trapezoid, 0.1), (Warp::Fitted, 0.0)]
                {
                    let views = whole.slices(&camera, SIZE, bounds, &SplitPlan { warp, ..FACES }, overlap, None);
                    assert!((1..=4).contains(&views.len()) && views.iter().all(|v| v.one_of_several));
                    for &p in &seen {
                        assert!(views.iter().any(|v| holds(v, p)), "{p} is on no map: {light:?} {camera:?} {warp:?}");
                    }
                    for k in 0..views.len() {
                        let is_out = |p: &DVec3| !views.iter().enumerate().any(|(j, v)| j != k && holds(v, *p));
                        faces += 1;
                        missed += usize::from(seen.iter().any(is_out));
                    }
                }
            }
        }
        assert!(points > 10_000 && missed > faces / 2, "{points} points; {missed} of {faces} faces are missed");
    }

    /// The sides that light comes in by, or leaves by.
    #[test]
    fn light_passes_these_sides() {
        let (mesh, camera) = over_ground();
        let count = |light: Light, camera: &Camera| {
            let whole = LightView::fit(&mesh, &light, 64).unwrap();
            whole.slices(camera, SIZE, mesh.bounds().unwrap(), &FACES, 0.0, None).len()
        };
        let level = Camera { target: [0.0, 2.0, -20.0], ..camera };
        // From above by the upper side alone; from behind by all, as it leaves by all from ahead; from above and aside by two.
        assert_eq!(count(sun([0.0, 1.0, 0.0]), &level), 1);
        assert_eq!(count(sun([0.0, 0.02, 1.0]), &level), 4);
        assert_eq!(count(sun([0.0, 0.02, -1.0]), &level), 4);
        assert_eq!(count(sun([1.0, 1.0, 0.0]), &level), 2);
        assert_eq!(count(Light::Point { position: [0.0, 2.5, -20.0] }, &level), 1);
    }

    /// The longer side of a texel on the ground beside a pixel's width, in the mean over the lower half of the image: with the light low behind the eye, or
    /// low before it, where near and far are one on the map, less than with as many slices; elsewhere more, as Lloyd found.
    #[test]
    fn texels_are_smaller_where_the_light_is_behind() {
        let (mesh, camera) = over_ground();
        let bounds = mesh.bounds().unwrap();
        let rays = camera.rays(SIZE[0], SIZE[1]);
        let [a, b, c, d] = rays.corners(SIZE[0], SIZE[1]);
        let ground: Vec<DVec3> = (0..32 * 32)
            .map(|k| (f64::from(k % 32) / 31.0, f64::from(k / 32) / 31.0))
            .map(|(x, y)| a.lerp(b, x).lerp(d.lerp(c, x), y))
            .filter(|ray| ray.y < 0.0)
            .map(|ray| rays.eye + ray * (rays.eye.y / -ray.y))
            .filter(|p| p.cmpge(bounds.0 - 1e-9).all() && p.cmple(bounds.1 + 1e-9).all())
            .collect();
        let coarse = |light: &Light, plan: &SplitPlan| {
            let whole = LightView::fit(&mesh, light, 512).unwrap();
            let views = whole.slices(&camera, SIZE, bounds, plan, 0.0, None);
            let held: Vec<DVec3> = ground.iter().copied().filter(|&p| holds(&whole, p)).collect();
            assert!(held.len() > 200, "{}", held.len());
            let of = |&p: &DVec3| {
                let view = views.iter().find(|v| holds(v, p)).expect("a view");
                let step = (p - rays.eye).dot(rays.forward) * 1e-4;
                let at = |d: DVec3| (view.project(p + d * step).unwrap() - view.project(p).unwrap()).truncate();
                let (x, z) = (at(DVec3::X), at(DVec3::Z));
                let (sum, area) = (x.length_squared() + z.length_squared(), x.perp_dot(z).abs());
                let longest = (0.5 * (sum + (sum * sum - 4.0 * area * area).max(0.0).sqrt())).sqrt() / area;
                longest * 1e-4
            };
            held.iter().map(of).sum::<f64>() / held.len() as f64
        };
        let slices = |splits| SplitPlan { by: PartBy::Depth, splits, ..FACES };
        for (direction, fewer) in [([0.02, 0.08, 1.0], true), ([0.02, 0.04, 1.0], true), ([0.6, 1.0, 0.05], false)] {
            let light = sun(direction);
            let [one, four, faces] = [slices(1), slices(4), FACES].map(|plan| coarse(&light, &plan));
            assert!(
                faces < one && (faces < 0.6 * four) == fewer,
                "{direction:?}: {one} of one, {four}, {faces} of faces"
            );
        }
    }
}
