//! Directional, spot and point lights.

use crate::{Error, Result};
use glam::{DVec3, DVec4, Vec3};

/// A light. A hard shadow knows only where it is; a spot light's cone matters for shading alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "lowercase"))]
pub enum Light {
    /// Parallel light.
    Directional {
        /// The direction towards the light; any length but 0.
        direction: [f32; 3],
    },
    /// Light from a point into a cone.
    Spot {
        /// Position.
        position: [f32; 3],
        /// Point the cone is turned to.
        target: [f32; 3],
        /// Full opening angle of the cone, degrees, in (0, 180).
        angle_degrees: f32,
    },
    /// Light from a point in all directions.
    Point {
        /// Position.
        position: [f32; 3],
    },
}

impl Light {
    /// The light as a homogeneous point: `(direction towards it, 0)` or `(position, 1)`.
    #[inline]
    pub fn homogeneous(&self) -> DVec4 {
        match *self {
            Self::Directional { direction } => Vec3::from(direction).as_dvec3().extend(0.0),
            Self::Spot { position, .. } | Self::Point { position } => Vec3::from(position).as_dvec3().extend(1.0),
        }
    }

    /// Direction from `point` towards the light, not normalised; its length is the distance for spot and point.
    #[inline]
    pub fn towards(&self, point: DVec3) -> DVec3 {
        let l = self.homogeneous();
        l.truncate() - point * l.w
    }

    /// Whether the light is at infinity.
    #[inline]
    pub fn is_directional(&self) -> bool {
        matches!(self, Self::Directional { .. })
    }

    /// Checks every number of the light.
    ///
    /// # Errors
    /// [`Error::Scene`] with the numbers if a value is not finite, a direction has length 0, or a spot's angle is
    /// outside (0, 180) degrees.
    pub fn check(&self) -> Result<()> {
        let finite = |what: &str, v: [f32; 3]| {
            if v.iter().all(|c| c.is_finite()) {
                Ok(())
            } else {
                Err(Error::Scene(format!("light {what} ({}, {}, {}) is not finite", v[0], v[1], v[2])))
            }
        };
        match *self {
            Self::Directional { direction } => {
                finite("direction", direction)?;
                if direction == [0.0; 3] {
                    return Err(Error::Scene("light direction (0, 0, 0) has length 0".into()));
                }
            }
            Self::Spot { position, target, angle_degrees } => {
                finite("position", position)?;
                finite("target", target)?;
                if position == target {
                    return Err(Error::Scene(format!(
                        "spot light position and target are both ({}, {}, {})",
                        position[0], position[1], position[2]
                    )));
                }
                if !(angle_degrees > 0.0 && angle_degrees < 180.0) {
                    return Err(Error::Scene(format!(
                        "spot light angle of {angle_degrees} degrees is not between 0 and 180"
                    )));
                }
            }
            Self::Point { position } => finite("position", position)?,
        }
        Ok(())
    }
}
