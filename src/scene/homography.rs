//! Homographies: maps of space that keep lines and planes.

use super::Light;
use crate::shared_struct;
use crate::{Error, Result};
use glam::{DVec3, DVec4, Vec3};

shared_struct! {
    /// A map of space that keeps lines and planes: the place `p` comes to `(right · q, up · q, -depth) / (divisor · q)`, where `q` is
    /// `(p - origin, 1)`. The default maps nothing.
    ///
    /// Visibility stays as it is wherever the divisor is above 0: which of two surfaces is the nearer one along a ray of the camera, and what lies
    /// between a place and a light.
    "shared/math/homography" => pub struct Homography {
        /// Subtracted from a place first; `w`: the depth, 0 for no map at all.
        pub origin: [f32; 4],
        /// Row of x.
        pub right: [f32; 4],
        /// Row of y.
        pub up: [f32; 4],
        /// Row of what all three are divided by.
        pub divisor: [f32; 4],
    }
}

/// Share of its size by which a mapped box is wider than the box of what it holds: above what single precision loses.
const SLACK: f64 = 1e-5;
/// Share of a light's own size below which its divisor is 0: a light at infinity stays there.
const AT_INFINITY: f64 = 1e-6;

impl Homography {
    /// Whether it maps nothing.
    pub fn is_none(&self) -> bool {
        self.origin[3] == 0.0
    }

    /// The homogeneous place that a homogeneous one comes to.
    fn of(&self, place: DVec4) -> DVec4 {
        if self.is_none() {
            return place;
        }
        let [origin, right, up, divisor] =
            [self.origin, self.right, self.up, self.divisor].map(|row| DVec4::from(row.map(f64::from)));
        let q = (place.truncate() - origin.truncate() * place.w).extend(place.w);
        DVec4::new(right.dot(q), up.dot(q), -origin.w * place.w, divisor.dot(q))
    }

    /// Where a place comes to; `None` where the divisor is not above 0.
    pub fn point(&self, place: DVec3) -> Option<DVec3> {
        let to = self.of(place.extend(1.0));
        (to.w > 0.0).then(|| to.truncate() / to.w)
    }

    /// Where a light comes to: to a point, or to infinity. A spot light comes to a point light: it has no cone there.
    ///
    /// # Errors
    /// [`Error::Scene`] for a light whose divisor is below 0, with the number.
    pub fn light(&self, light: &Light) -> Result<Light> {
        if self.is_none() {
            return Ok(*light);
        }
        let at = light.homogeneous();
        let to = self.of(at);
        let divisor = DVec4::from(self.divisor.map(f64::from));
        let size = divisor.truncate().length() * at.truncate().length() + at.w * divisor.w.abs();
        if to.w.abs() <= AT_INFINITY * size {
            return Ok(Light::Directional { direction: to.truncate().normalize_or_zero().as_vec3().into() });
        }
        if to.w < 0.0 {
            let [x, y, z] = at.truncate().to_array();
            return Err(Error::Scene(format!(
                "a homography divides by {} at the light ({x}, {y}, {z}): it was made for other lights",
                to.w
            )));
        }
        Ok(Light::Point { position: (to.truncate() / to.w).as_vec3().into() })
    }

    /// A box that holds what comes out of a box, rounded to single precision anywhere.
    ///
    /// # Errors
    /// [`Error::Scene`] for a box that the divisor is not above 0 in, with its corners.
    pub fn bounds(&self, [low, high]: [[f32; 3]; 2]) -> Result<[[f32; 3]; 2]> {
        if self.is_none() {
            return Ok([low, high]);
        }
        let corner = |k: usize| {
            let at = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            self.point(Vec3::new(at(0), at(1), at(2)).as_dvec3())
        };
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for k in 0..8 {
            let Some(to) = corner(k) else {
                return Err(Error::Scene(format!(
                    "a homography was made for a smaller world than the box from {low:?} to {high:?}"
                )));
            };
            (least, most) = (least.min(to), most.max(to));
        }
        let slack = DVec3::splat(SLACK * least.abs().max(most.abs()).max_element());
        Ok([least - slack, most + slack].map(|p| p.as_vec3().into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Homography = Homography {
        origin: [1.0, 2.0, 3.0, 5.0],
        right: [1.0, 0.0, 0.0, 0.25],
        up: [0.0, 1.0, 0.0, 0.0],
        divisor: [0.0, 0.25, 1.0, 5.0],
    };

    #[test]
    fn none_maps_nothing() {
        let none = Homography::default();
        let sun = Light::Directional { direction: [1.0, 2.0, 3.0] };
        assert_eq!(none.point(DVec3::new(1.0, -2.0, 3.0)), Some(DVec3::new(1.0, -2.0, 3.0)));
        assert_eq!(none.light(&sun).expect("a light"), sun);
        assert_eq!(none.bounds([[0.0; 3], [1.0; 3]]).expect("a box"), [[0.0; 3], [1.0; 3]]);
    }

    /// Points of a line stay on a line, in their order, and a light stays on the line from a point to it.
    #[test]
    fn lines_stay_lines() {
        let lights = [
            Light::Directional { direction: [0.0, -4.0, 1.0] },
            Light::Directional { direction: [0.5, 0.25, 0.5] },
            Light::Point { position: [3.0, 1.0, 4.0] },
        ];
        for (k, light) in lights.into_iter().enumerate() {
            let place = DVec3::new(0.5, 1.5, 2.0);
            let way = light.towards(place) * 0.25;
            let [a, b, c] = [0.0, 1.0, 2.0].map(|t| SOME.point(place + t * way).expect("a place"));
            let to = SOME.light(&light).expect("a light").towards(a);
            assert_eq!(SOME.light(&light).expect("a light").is_directional(), k == 0);
            let [along, ahead] = [(b - a).normalize(), (c - b).normalize()];
            assert!(along.dot(ahead) > 1.0 - 1e-12 && along.dot(to.normalize()) > 1.0 - 1e-12, "{light:?}");
        }
    }

    #[test]
    fn boxes_hold_what_is_mapped() {
        let given = [[-1.0, 0.5, 2.0], [2.0, 1.0, 4.0]];
        let [low, high] = SOME.bounds(given).expect("a box").map(|p| Vec3::from(p).as_dvec3());
        let mut widest = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for k in 0..11 * 11 * 11 {
            let at = DVec3::new(f64::from(k % 11), f64::from(k / 11 % 11), f64::from(k / 121)) / 10.0;
            let [from, to] = given.map(|p| Vec3::from(p).as_dvec3());
            let p = SOME.point(from + (to - from) * at).expect("a place");
            assert!(p.cmpge(low).all() && p.cmple(high).all(), "{at}");
            widest = [widest[0].min(p), widest[1].max(p)];
        }
        assert!((widest[0] - low).max_element() < 1e-4 && (high - widest[1]).max_element() < 1e-4);
        let refused = SOME.bounds([[0.0; 3], [1.0, 1.0, -9.0]]).map_err(|e| e.to_string());
        assert!(refused.is_err_and(|e| e.contains("-9.0")));
        let behind = Light::Point { position: [0.0, 0.0, -9.0] };
        assert!(SOME.light(&behind).is_err_and(|e| e.to_string().contains("other lights")));
    }
}
