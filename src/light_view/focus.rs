//! Views cut to what the camera may see in shadow: focusing (Scherzer et al. 2011, section 4.1).
//!
//! In a view's own coordinates, texels and, of a light at a point, the inverse of the divisor, else the depth, every plane of the world is a plane. What is seen
//! lies between some of them, all along its rays to infinity; without the third coordinate (Fourier, Motzkin) they are lines on the map, which cut it.

use super::casters::clip;
use super::fit::inside;
use super::{LightView, SeenBox, unit_scale};
use crate::scene::Camera;
use glam::{DMat4, DVec2, DVec3, DVec4};

/// A map of casters that stand is cut, and made anew as the camera moves, only to less than this share of it.
const WORTH_IT: f64 = 1.0 / 16.0;

/// Pixels by which the image is taken to be larger on each side.
const BESIDE: f64 = 0.5;

/// A map is turned to the narrowest box around a part where that leaves less than this share of the box along its own sides.
const TURNED: f64 = 0.8;

/// Part of a map in a box: rows of its texel coordinates along two axes of the box, and there the lowest and the highest corner.
#[derive(Clone, Copy)]
struct Part {
    /// Take `(x, y, 1)` of the map to places in the box.
    axes: [DVec3; 2],
    low: DVec2,
    high: DVec2,
}

impl Part {
    fn new(axes: [DVec3; 2], corners: &[DVec3]) -> Self {
        let start = Self { axes, low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        corners.iter().fold(start, |Self { low, high, .. }, p| {
            let at = DVec2::new(axes[0].dot(*p), axes[1].dot(*p));
            Self { axes, low: low.min(at), high: high.max(at) }
        })
    }

    fn area(&self) -> f64 {
        (self.high - self.low).element_product()
    }
}

impl LightView {
    /// The parts of one light's views that hold all that a camera may see in their shadow, of the casters between two corners of a box; a view in which
    /// there is nothing of it is left out, but for one. `within`: only what lies between these corners is seen. `stand`: casters and light
    /// stand, so that a single view can be kept; it is cut where that leaves little of it. Texels are no smaller than single precision tells points apart.
    pub(crate) fn focused(
        views: Vec<Self>,
        camera: &Camera,
        [w, h]: [u32; 2],
        bounds: (DVec3, DVec3),
        (within, stand): (bool, bool),
    ) -> Vec<Self> {
        // Beyond an end of a map facets and casters meet at its side.
        if views.iter().any(|view| view.paraboloid.is_some() || view.ends != [false; 4]) {
            return views;
        }
        let rays = camera.rays(w, h);
        let (eye, scale) = (rays.eye, unit_scale(rays.eye, bounds));
        let [right, low] = [w, h].map(|side| f64::from(side) + BESIDE);
        let corners = [[-BESIDE, -BESIDE], [right, -BESIDE], [right, low], [-BESIDE, low]];
        let seen = SeenBox {
            corners: corners.map(|[x, y]| rays.direction(x, y)),
            ..SeenBox::new(&rays, [w, h], f64::from(camera.near), bounds, scale)
        };
        let part_of = |view: &Self| view.relative_to(eye, scale).part_seen(&seen, within);
        let keeps = stand && views.len() == 1;
        let part = |view: &Self| {
            let part = part_of(view)?;
            let share = part.area() / f64::from(view.map_size).powi(2);
            Some(if keeps && share > WORTH_IT { *view } else { view.cut_to(part, (eye, scale)) })
        };
        let cut: Vec<Self> = views.iter().filter_map(part).collect();
        if cut.is_empty() { views.into_iter().take(1).collect() } else { cut }
    }

    /// Where on the map lies what is seen, nearest to the light no caster; `None` if nowhere. Of a view in the space of `seen`.
    fn part_seen(&self, seen: &SeenBox, within: bool) -> Option<Part> {
        let third = if self.perspective { DVec4::W } else { self.z };
        // Its columns are the rows: a plane of the world times this is one of the view.
        let planes = DMat4::from_cols(self.u, self.v, third, self.w).inverse();
        if !planes.is_finite() {
            return Some(self.part_of(&self.corners()));
        }
        let mut bounded: Vec<DVec4> = (0..4).map(|k| seen.side(k).extend(0.0)).collect();
        if self.perspective {
            bounded.push(DVec4::W);
            if self.clear > 0.0 {
                bounded.push(self.w - DVec4::W * (self.clear * (1.0 - 1e-6)));
            }
        } else {
            bounded.push(self.z + DVec4::W * 1e-3);
        }
        if within {
            let (lo, hi) = seen.bounds;
            let slack = 1e-6 * (hi - lo).max_element();
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                bounded.push(axis.extend(slack - axis.dot(lo)));
                bounded.push((-axis).extend(slack + axis.dot(hi)));
            }
        }
        let bounded: Vec<DVec4> = bounded.into_iter().map(|plane| planes * plane).collect();
        let mut polygon = self.corners().to_vec();
        let line = |plane: DVec4| DVec3::new(plane.x, plane.y, plane.w);
        for plane in &bounded {
            if plane.z == 0.0 {
                clip(&mut polygon, |p| line(*plane).dot(p));
            }
            if plane.z <= 0.0 {
                continue;
            }
            for other in bounded.iter().filter(|other| other.z < 0.0) {
                clip(&mut polygon, |p| line(*other * plane.z - *plane * other.z).dot(p));
            }
        }
        (!polygon.is_empty()).then(|| self.part_of(&polygon))
    }

    /// Corners of the map.
    fn corners(&self) -> [DVec3; 4] {
        let side = f64::from(self.map_size);
        [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| DVec3::new(x, y, 1.0))
    }

    /// The box around a convex part of the map: along the map's sides, or one of its own where that is much narrower.
    fn part_of(&self, polygon: &[DVec3]) -> Part {
        let along = Part::new([DVec3::X, DVec3::Y], polygon);
        // Lengths of the world, in which a turned box is one, too.
        let fine = self.texels_across();
        let unit = DVec2::new(fine.y, fine.x) / fine.max_element();
        let turned = |(k, p): (usize, &DVec3)| {
            let q = polygon[(k + 1) % polygon.len()];
            let dir = ((q - *p).truncate() * unit).try_normalize()?;
            Some(Part::new([dir, dir.perp()].map(|axis| (axis * unit).extend(0.0)), polygon))
        };
        let in_texels = |part: &Part| part.area() / (unit.x * unit.y);
        let boxes = polygon.iter().enumerate().filter_map(turned);
        let least = boxes.min_by(|a, b| a.area().total_cmp(&b.area()));
        least.filter(|part| in_texels(part) < TURNED * along.area()).map_or(along, |part| {
            // In texels of the map, as the other one.
            let by = (unit.x * unit.y).sqrt().recip();
            Part { axes: part.axes.map(|axis| axis * by), low: part.low * by, high: part.high * by }
        })
    }

    /// The view of a part of its map. Rounding in the space of an eye stays a fraction of a texel, where it is one, and next to a light at a point as
    /// much is told apart as before.
    fn cut_to(&self, Part { axes, low, high }: Part, (eye, scale): (DVec3, f64)) -> Self {
        let side = f64::from(self.map_size);
        let (across, pad) = inside(self.map_size);
        let size = (high - low).max(DVec2::splat(1e-3 * side));
        if size.min_element() > 0.9 * side {
            return *self;
        }
        let low = 0.5 * (low + high - size);
        let row = |axis: DVec3, low: f64, size: f64| {
            let row = self.u * axis.x + self.v * axis.y;
            (row - self.w * low) * (across / size) + self.w * pad
        };
        let cut = Self { u: row(axes[0], low.x, size.x), v: row(axes[1], low.y, size.y), ..*self };
        let whole = self.relative_to(eye, scale).noise_in_texels();
        let least = if self.perspective { 0.25 * self.near * scale } else { 0.1 };
        let noise = cut.relative_to(eye, scale).noise_in_texels();
        let even = whole.even.max(least) / noise.even;
        let by_divisor = whole.by_divisor.max(0.25) / noise.by_divisor;
        let by = even.min(by_divisor);
        if by < 1.0 { cut.coarser(by) } else { cut }
    }

    /// The view with texels larger about its middle: `by` times as many on a side hold what it held.
    pub(super) fn coarser(&self, by: f64) -> Self {
        let middle = self.w * (0.5 * f64::from(self.map_size));
        let about_middle = |row: DVec4| middle + (row - middle) * by;
        Self { u: about_middle(self.u), v: about_middle(self.v), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Light;
    use glam::Vec3;

    /// A number below 1, the next of a sequence.
    fn next(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }

    fn place(state: &mut u64, wide: f64) -> [f32; 3] {
        std::array::from_fn(|_| ((next(state) - 0.5) * wide) as f32)
    }

    fn looking(eye: [f32; 3], target: [f32; 3], fov: f32) -> Camera {
        Camera::look_at(eye, target, [0.0, 1.0, 0.0], fov, 0.05)
    }

    /// Box of casters that a light has views of, and a camera.
    struct World {
        bounds: (DVec3, DVec3),
        light: Light,
        views: Vec<LightView>,
        camera: Camera,
    }

    fn worlds(count: usize) -> Vec<World> {
        let mut state = 11;
        let mut of = |k: usize| {
            let ends = [place(&mut state, 10.0), place(&mut state, 10.0)].map(|p| Vec3::from(p).as_dvec3());
            let bounds = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let (eye, target) = (place(&mut state, 12.0), place(&mut state, 10.0));
            let camera = looking(eye, target, 5.0 + 70.0 * next(&mut state) as f32);
            let light = match k % 3 {
                0 => Light::Directional { direction: place(&mut state, 2.0) },
                1 => Light::Point { position: place(&mut state, 6.0) },
                _ => Light::Point { position: place(&mut state, 30.0) },
            };
            let view = LightView::around(bounds, &light, 256).unwrap();
            let views = if view.complete { vec![view] } else { LightView::cube_around(bounds, &light, 256).unwrap() };
            World { bounds, light, views, camera }
        };
        (0..count).map(&mut of).collect()
    }

    fn holds(view: &LightView, p: DVec3) -> bool {
        let side = f64::from(view.map_size);
        view.project(p).is_some_and(|at| at.truncate().min_element() >= 0.0 && at.truncate().max_element() <= side)
    }

    /// Counts points that a camera sees in a shadow, and those that no cut view holds of what some view held; by how much texels are finer.
    fn check(within: bool, spoil: impl Fn(&mut Vec<LightView>)) -> (usize, usize, f64) {
        let (mut missing, mut seen, mut areas) = (0, 0, (0.0, 0.0));
        let mut state = 5;
        for World { bounds, light, views, camera } in worlds(150) {
            let mut cut = LightView::focused(views.clone(), &camera, [60, 40], bounds, (within, false));
            assert!(!cut.is_empty() && cut.len() <= views.len());
            spoil(&mut cut);
            let rays = camera.rays(60, 40);
            for _ in 0..400 {
                let ray = rays.direction(60.0 * next(&mut state), 40.0 * next(&mut state));
                let p = rays.eye + ray * (0.1 + 40.0 * next(&mut state).powi(3));
                let in_box = p.cmpge(bounds.0).all() && p.cmple(bounds.1).all();
                // Somewhere on its way to the light is the box.
                let towards =
                    if light.is_directional() { light.towards(p).normalize() * 60.0 } else { light.towards(p) };
                let shadowed = (0..=400).any(|k| {
                    let at = p + towards * (f64::from(k) / 400.0);
                    at.cmpge(bounds.0).all() && at.cmple(bounds.1).all()
                });
                if !shadowed || (within && !in_box) || !views.iter().any(|view| holds(view, p)) {
                    continue;
                }
                seen += 1;
                missing += usize::from(!cut.iter().any(|view| holds(view, p)));
            }
            // Texels that a unit of the world takes.
            let fine = |views: &[LightView]| views.iter().map(|v| v.u.length() * v.v.length()).sum::<f64>();
            areas.0 += (fine(&cut) / cut.len() as f64).ln();
            areas.1 += (fine(&views) / views.len() as f64).ln();
        }
        (missing, seen, ((areas.0 - areas.1) / 150.0).exp())
    }

    #[test]
    fn what_is_seen_in_shadow_lies_in_a_view() {
        for (within, least) in [(false, 1.2), (true, 1.2)] {
            let (missing, seen, finer) = check(within, |_| {});
            assert!(seen > 1000, "{seen} points say little");
            assert_eq!(missing, 0, "of {seen}, within: {within}");
            eprintln!("{finer}");
            assert!(finer > least, "texels are {finer} times as fine, within: {within}");
        }
    }

    #[test]
    fn a_view_that_is_a_tenth_too_narrow_is_found_out() {
        let (missing, ..) = check(true, |views| views.iter_mut().for_each(|view| *view = view.coarser(1.1)));
        assert!(missing > 20, "{missing}");
    }

    #[test]
    fn a_view_that_can_be_kept_is_cut_where_little_is_left() {
        let bounds = (DVec3::splat(-50.0), DVec3::splat(50.0));
        let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
        let whole = vec![LightView::around(bounds, &light, 256).unwrap()];
        let cut = |fov: f32, stand: bool| {
            let camera = looking([0.0, 30.0, 0.1], [0.0; 3], fov);
            LightView::focused(whole.clone(), &camera, [64, 64], bounds, (true, stand)) != whole
        };
        assert_eq!([cut(2.0, true), cut(40.0, true), cut(40.0, false)], [true, false, true]);
    }

    #[test]
    fn of_views_that_show_nothing_one_is_left() {
        let bounds = (DVec3::splat(-1.0), DVec3::splat(1.0));
        let light = Light::Point { position: [0.0; 3] };
        let cube = LightView::cube_around(bounds, &light, 64).unwrap();
        let away = looking([0.0, 0.0, 5.0], [0.0, 0.0, 9.0], 60.0);
        assert_eq!(LightView::focused(cube.clone(), &away, [9, 7], bounds, (true, false)), cube[..1]);
        let beside = looking([9.0, 0.0, 0.5], [0.5, 0.0, 0.5], 2.0);
        // To its right, to its left and behind it.
        assert_eq!(LightView::focused(cube, &beside, [9, 7], bounds, (true, false)).len(), 3);
    }
}
