//! Lights of some extent.

use super::Light;
use crate::{Error, Result};
use glam::{DVec3, Vec3};

/// A light of some extent, as points of it. Its shadows are soft: the mean of the hard ones of the points, each of which is exact
/// ([`ShadowPass::record_area`](crate::ShadowPass::record_area)).
///
/// The points lie evenly over a disc: of a directional light in the sky, of a spot light across its direction, of a point light turned to what it is
/// asked for, so that it looks like a ball from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    /// Its middle.
    pub light: Light,
    /// Radius, world units; of a directional light degrees as seen from the scene, less than 45.
    pub radius: f64,
    /// Points, 1 to [`AreaLight::MOST`]; one is the middle.
    pub points: u32,
}

impl AreaLight {
    /// Most points.
    pub const MOST: u32 = 1024;

    /// Checks every number.
    ///
    /// # Errors
    /// [`Error::Scene`] for a light, a radius or a number of points that cannot be.
    pub fn check(&self) -> Result<()> {
        self.light.check()?;
        let Self { radius, points, .. } = *self;
        let most = if self.light.is_directional() { 45.0 } else { f64::MAX };
        if !(0.0..most).contains(&radius) {
            return Err(Error::Scene(format!(
                "a light's radius of {radius}: 0 or more, of a directional light less than 45 degrees"
            )));
        }
        if !(1..=Self::MOST).contains(&points) {
            return Err(Error::Scene(format!("{points} points of a light: 1 to {} are possible", Self::MOST)));
        }
        Ok(())
    }

    /// Its points, the disc of a point light turned to `toward`. Points k of n lie at the radius √((k + ½) / n), each turned by the golden angle
    /// from the one before (Vogel 1979).
    pub fn points(&self, toward: DVec3) -> Vec<Light> {
        let count = f64::from(self.points);
        let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let middle = self.light.homogeneous().truncate();
        let (axis, radius) = match self.light {
            Light::Directional { .. } => (middle, self.radius.to_radians().tan() * middle.length()),
            Light::Spot { target, .. } => (middle - Vec3::from(target).as_dvec3(), self.radius),
            Light::Point { .. } => (middle - toward, self.radius),
        };
        let axis = axis.try_normalize().unwrap_or(DVec3::Y);
        let (x, y) = axis.any_orthonormal_pair();
        let point = |k: u32| {
            let out = if self.points == 1 { 0.0 } else { radius * ((f64::from(k) + 0.5) / count).sqrt() };
            let (sin, cos) = (turn * f64::from(k)).sin_cos();
            let at = (middle + out * (cos * x + sin * y)).as_vec3().to_array();
            match self.light {
                Light::Directional { .. } => Light::Directional { direction: at },
                Light::Spot { target, angle_degrees, .. } => Light::Spot { position: at, target, angle_degrees },
                Light::Point { .. } => Light::Point { position: at },
            }
        };
        if self.points == 1 { vec![self.light] } else { (0..self.points).map(point).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUN: Light = Light::Directional { direction: [3.0, 4.0, 1.0] };
    const LAMP: Light = Light::Point { position: [1.0, 5.0, -2.0] };

    /// Over the disc there is everywhere as much: means over the points are those over the disc.
    #[test]
    fn points_lie_evenly_over_the_disc() {
        for light in [SUN, LAMP, Light::Spot { position: [1.0, 5.0, -2.0], target: [0.0; 3], angle_degrees: 60.0 }] {
            let area = AreaLight { light, radius: 2.0, points: 256 };
            let middle = light.homogeneous().truncate();
            let points: Vec<DVec3> = area.points(DVec3::ZERO).iter().map(|l| l.homogeneous().truncate()).collect();
            let radius = if light.is_directional() { 2f64.to_radians().tan() * middle.length() } else { 2.0 };
            let out: Vec<DVec3> = points.iter().map(|p| (*p - middle) / radius).collect();
            let mean = out.iter().sum::<DVec3>() / 256.0;
            let square = out.iter().map(|p| p.length_squared()).sum::<f64>() / 256.0;
            assert!(mean.length() < 0.01 && (square - 0.5).abs() < 0.01, "{light:?}: {mean}, {square}");
            assert!(out.iter().all(|p| p.length() < 1.0 && p.dot(middle.normalize()).abs() < 1e-5), "{light:?}");
            let quarters = out.iter().filter(|p| p.length() < 0.5).count();
            assert!((60..=68).contains(&quarters), "{light:?}: {quarters} of 256 in a quarter of the disc");
        }
    }

    #[test]
    fn one_point_is_the_light_itself() {
        assert_eq!(AreaLight { light: SUN, radius: 3.0, points: 1 }.points(DVec3::ONE), [SUN]);
        // Where it is itself asked for, the disc lies flat.
        let flat = AreaLight { light: LAMP, radius: 1.0, points: 8 }.points(DVec3::new(1.0, 5.0, -2.0));
        assert!(flat.iter().all(|l| l.check().is_ok() && (l.homogeneous().y - 5.0).abs() < 1e-6));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let area = AreaLight { light: SUN, radius: 1.0, points: 16 };
        assert!(area.check().is_ok() && AreaLight { radius: 0.0, ..area }.check().is_ok());
        assert!(AreaLight { light: LAMP, radius: 1e6, ..area }.check().is_ok());
        for (bad, word) in [
            (AreaLight { radius: 45.0, ..area }, "45"),
            (AreaLight { radius: -1.0, ..area }, "-1"),
            (AreaLight { radius: f64::NAN, ..area }, "NaN"),
            (AreaLight { points: 0, ..area }, "0 points"),
            (AreaLight { points: 1025, ..area }, "1025"),
            (AreaLight { light: Light::Directional { direction: [0.0; 3] }, ..area }, "length 0"),
        ] {
            assert!(bad.check().unwrap_err().to_string().contains(word), "{bad:?}");
        }
    }
}
