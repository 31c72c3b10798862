//! Paraboloid views of a light at a point (Brabec, Annen, Seidel 2002: Shadow Mapping for Hemispherical and Omnidirectional Light Sources).
//!
//! A paraboloid mirrors the rays of a hemisphere into one direction: the direction `d`, of length 1, lies at `d.xy / (1 + d.z)`, where half the sphere
//! is a disc of radius 1. Beyond the disc, in the corners of the map, lie rays of the other half. Planes are no planes there, so rows alone do not tell
//! where a point is.

use super::fit::{axes, check};
use super::{LightView, WIDER};
use crate::scene::Light;
use crate::{Error, Result};
use glam::{DVec2, DVec3, DVec4, Vec3};

/// Maps of a light at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OmniMaps {
    /// On planes: one view where the light stands outside the casters, else those of a cube's sides.
    #[default]
    Planes,
    /// On paraboloids: one where the box of the casters lies in front of the light, else two. Of the methods that
    /// ask a map of nearest depths and have no slices of their own.
    Paraboloids,
}

/// Share of its width by which the map of a hemisphere is wider than its disc: filters at the rim find what lies beyond.
const RIM: f64 = 1.0 + 1.0 / 32.0;

/// 1 and the cosine of the angle to a view's axis from which on nothing is in front of it.
const BEHIND: f64 = 1e-4;

impl LightView {
    /// Paraboloid views of a light at a point that hold the casters, which lie in the box between two corners: one, as narrow as the box allows, where that
    /// lies in front of the light; else two, of a hemisphere each. `cone`: one of a spot light's cone alone, which may miss what lies beside it.
    ///
    /// # Errors
    /// [`Error::Scene`] if the light cannot be used or is directional, [`Error::Config`] if the map has no or too many texels.
    pub fn paraboloids((low, high): (DVec3, DVec3), light: &Light, map_size: u32, cone: bool) -> Result<Vec<Self>> {
        check(light, map_size)?;
        if light.is_directional() {
            return Err(Error::Scene("a directional light has no paraboloid map; a point or a spot has".to_owned()));
        }
        let at = light.homogeneous().truncate();
        let corners: [DVec3; 8] = std::array::from_fn(|k| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2)) - at
        });
        let far = corners.iter().map(|c| c.length()).fold(f64::MIN_POSITIVE.sqrt(), f64::max);
        let view = |axis: DVec3, (low, high): (DVec2, DVec2)| Self::paraboloid((at, axis), (low, high), far, map_size);
        if let (true, &Light::Spot { target, angle_degrees, .. }) = (cone, light) {
            let axis = (Vec3::from(target).as_dvec3() - at).normalize();
            let reach = DVec2::splat((f64::from(angle_degrees).to_radians() / 4.0).tan() * WIDER);
            return Ok(vec![view(axis, (-reach, reach))]);
        }
        let axis = ((low + high) * 0.5 - at).try_normalize().unwrap_or(DVec3::NEG_Y);
        if corners.iter().all(|c| c.dot(axis) > 1e-3 * c.length()) {
            let (right, up) = axes(axis);
            let turned = corners.map(|c| DVec3::new(c.dot(right), c.dot(up), c.dot(axis)));
            let mut held = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for (a, b) in (0..8usize).flat_map(|k| [1, 2, 4].map(|bit| (k, k | bit))).filter(|(a, b)| a < b) {
                let arc = arc_box(turned[a], turned[b]);
                held = (held.0.min(arc.0), held.1.max(arc.1));
            }
            let slack = DVec2::splat((held.1 - held.0).max_element().max(1e-6) * 0.5 * (WIDER - 1.0));
            return Ok(vec![Self { one_of_several: false, ..view(axis, (held.0 - slack, held.1 + slack)) }]);
        }
        let whole = (DVec2::splat(-RIM), DVec2::splat(RIM));
        Ok([axis, -axis].map(|axis| view(axis, whole)).to_vec())
    }

    /// The view from a point along an axis, of the places between two corners.
    fn paraboloid((at, axis): (DVec3, DVec3), (low, high): (DVec2, DVec2), far: f64, map_size: u32) -> Self {
        let (right, up) = axes(axis);
        let texels = DVec2::splat(f64::from(map_size)) / (high - low);
        Self {
            map_size,
            u: (right * texels.x).extend(-low.x * texels.x),
            v: (up * texels.y).extend(-low.y * texels.y),
            z: DVec4::new(0.0, 0.0, 0.0, 1.0 / far),
            w: axis.extend(0.0),
            near: BEHIND * far,
            clear: 0.0,
            perspective: true,
            complete: true,
            one_of_several: true,
            ends: [false; 4],
            closed: false,
            outside: false,
            paraboloid: Some(at),
            lamp: None,
        }
    }

    /// Texel `x`, `y` and depth of a point in a paraboloid view of a light at `at`.
    pub(super) fn project_paraboloid(&self, at: DVec3, point: DVec3) -> Option<DVec3> {
        let rel = point - at;
        let apart = rel.length();
        let front = apart + self.w.truncate().dot(rel);
        let place = |row: DVec4| row.w + row.truncate().dot(rel) / front;
        (front > BEHIND * apart).then(|| DVec3::new(place(self.u), place(self.v), apart * self.z.w))
    }

    /// Direction in which the place of texel `x`, `y` lies, away from the light, of any length; of a paraboloid view.
    pub fn ray_of_texel(&self, at: DVec2) -> DVec3 {
        let axis = |row: DVec4| row.truncate() / row.truncate().length_squared();
        let unit = |row: DVec4, at: f64| (at - row.w) / row.truncate().length();
        let [s, t] = [unit(self.u, at.x), unit(self.v, at.y)];
        let across = |row: DVec4| axis(row) * row.truncate().length();
        across(self.u) * (2.0 * s) + across(self.v) * (2.0 * t) + axis(self.w) * (1.0 - s * s - t * t)
    }
}

/// The box of the places of all directions between two, in front of a view along z, by the great circle through both: its image is a circle.
fn arc_box(a: DVec3, b: DVec3) -> (DVec2, DVec2) {
    let place = |d: DVec3| d.truncate() / (d.length() + d.z);
    let (mut low, mut high) = (place(a).min(place(b)), place(a).max(place(b)));
    let n = a.cross(b);
    let m = n.length();
    for (nx, ny, swap) in [(n.x, n.y, false), (n.y, n.x, true)] {
        for end in [(nx + m) / n.z, (nx - m) / n.z] {
            let at = if swap { DVec2::new(ny / n.z, end) } else { DVec2::new(end, ny / n.z) };
            let d = (2.0 * at).extend(1.0 - at.length_squared());
            if at.is_finite() && a.cross(d).dot(n) >= 0.0 && d.cross(b).dot(n) >= 0.0 {
                (low, high) = (low.min(at), high.max(at));
            }
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: (DVec3, DVec3) = (DVec3::new(-1.0, -2.0, 0.5), DVec3::new(3.0, 1.0, 4.0));

    fn points() -> impl Iterator<Item = DVec3> {
        (0..729u32).map(|k| {
            let share = DVec3::new(f64::from(k % 9), f64::from(k / 9 % 9), f64::from(k / 81)) / 8.0;
            BOX.0 + (BOX.1 - BOX.0) * share
        })
    }

    fn views(light: [f32; 3]) -> Vec<LightView> {
        LightView::paraboloids(BOX, &Light::Point { position: light }, 128, false).unwrap()
    }

    fn holds(view: &LightView, p: DVec3) -> bool {
        view.project(p).is_some_and(|at| at.truncate().cmpge(DVec2::ZERO).all() && at.truncate().max_element() <= 128.0)
    }

    /// One view from outside, two from within; all that is in the box lies in them, at depths up to 1. Half a view misses some.
    #[test]
    fn every_point_of_the_box_lies_in_a_view() {
        for (light, count) in [([0.0, 9.0, 1.0], 1), ([1.0, -0.5, 2.0], 2), ([1.0, 0.9, 2.0], 2), ([9.0, 9.0, 0.6], 1)]
        {
            let views = views(light);
            assert_eq!(views.len(), count, "{light:?}");
            let mut missed = 0;
            for p in points() {
                assert!(views.iter().any(|view| holds(view, p)), "{light:?}: {p} lies in no view");
                assert!(views.iter().filter_map(|view| view.project(p)).all(|at| (0.0..=1.0 + 1e-9).contains(&at.z)));
                missed +=
                    u32::from(!holds(&LightView { map_size: 128, u: views[0].u + DVec4::W * 64.0, ..views[0] }, p));
            }
            assert!(missed > 50, "{light:?}: {missed}");
        }
    }

    /// The ray of a texel leads to a point at that texel, in every space of rows.
    #[test]
    fn rays_lead_to_their_texels() {
        for (light, origin, scale) in
            [([0.0, 9.0, 1.0], DVec3::ZERO, 1.0), ([1.0, -0.5, 2.0], DVec3::new(3.0, 1.0, -2.0), 0.25)]
        {
            for view in views(light) {
                let moved = view.relative_to(origin, scale);
                let at = (DVec3::from(light.map(f64::from)) - origin) * scale;
                for k in 0..64u32 {
                    let texel = DVec2::new(f64::from(k % 8), f64::from(k / 8)) * 16.0 + 0.5;
                    let point = at + moved.ray_of_texel(texel) * 0.7;
                    let found = moved.project(point).unwrap();
                    assert!((found.truncate() - texel).length() < 1e-9, "{texel}: {found}");
                    let world = view.project(point / scale + origin).unwrap();
                    assert!((world - found).length() < 1e-9, "{world} {found}");
                }
            }
        }
    }

    /// Arcs lie in their boxes and touch each side.
    #[test]
    fn boxes_of_arcs_are_tight() {
        let mut bent = 0;
        for k in 0..200u32 {
            let turn = |k: u32| f64::from(k.wrapping_mul(2_654_435_769) >> 8) / f64::from(1u32 << 23) - 1.0;
            let [a, b] =
                [0, 3].map(|j| DVec3::new(turn(7 * k + j), turn(7 * k + j + 1), turn(7 * k + j + 2) * 0.6 + 0.5));
            let (low, high) = arc_box(a, b);
            let places = (0..=400).map(|i| a.normalize().lerp(b.normalize(), f64::from(i) / 400.0));
            let places: Vec<DVec2> = places.map(|d| d.truncate() / (d.length() + d.z)).collect();
            let (least, most) =
                places.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
            let slack = 1e-3 * (1.0 + high.abs().max_element());
            assert!(low.cmple(least + 1e-9).all() && high.cmpge(most - 1e-9).all(), "{a} {b}");
            assert!((least - low).max_element() < slack && (high - most).max_element() < slack, "{a} {b}");
            let [first, last] = [places[0], places[400]];
            bent += u32::from((high - first.max(last)).max(first.min(last) - low).max_element() > 0.01);
        }
        assert!(bent > 10, "{bent}");
    }

    #[test]
    fn what_stands_nowhere_is_refused() {
        let refused = LightView::paraboloids(BOX, &Light::Directional { direction: [0.0, 1.0, 0.0] }, 64, false);
        assert!(refused.unwrap_err().to_string().contains("directional"));
    }

    /// A spot light's cone fills one map.
    #[test]
    fn a_cone_has_one_view() {
        let light = Light::Spot { position: [1.0, 0.0, 2.0], target: [1.0, -2.0, 2.0], angle_degrees: 170.0 };
        let views = LightView::paraboloids(BOX, &light, 128, true).unwrap();
        let at = DVec3::new(1.0, 0.0, 2.0);
        let to = |degrees: f64| at + DVec3::new(0.0, -degrees.to_radians().cos(), degrees.to_radians().sin());
        assert!(
            views.len() == 1
                && holds(&views[0], to(84.9))
                && holds(&views[0], to(-84.9))
                && !holds(&views[0], to(88.0))
        );
    }
}
