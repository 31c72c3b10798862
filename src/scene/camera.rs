//! The pinhole camera and its pixel rays.

use crate::{Error, Result};
use glam::{DVec2, DVec3, Vec3};

/// A pinhole camera. Right-handed, world units as in the file.
///
/// The eye is held in `f32` so that the distance of an `f32` vertex from it is known exactly to every part of the
/// program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Camera {
    /// Position.
    pub eye: [f32; 3],
    /// Point looked at.
    pub target: [f32; 3],
    /// Direction that is up in the image; need not be orthogonal to the view.
    pub up: [f32; 3],
    /// Full vertical field of view, degrees, in (0, 180).
    pub vertical_fov_degrees: f32,
    /// Surfaces nearer than this along the view direction are not seen.
    pub near: f32,
    /// Distance that holds the scene. Nothing is clipped against it: no stage quantises depth.
    pub far: f32,
}

/// The rays of an image: `direction(x, y) = corner + x * step_x + y * step_y`, with `x` right and `y` down in pixels.
///
/// Not normalised: the component along the view direction is 1, so a ray parameter is view depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelRays {
    /// The eye.
    pub eye: DVec3,
    /// Direction through the top left corner of the image.
    pub corner: DVec3,
    /// Change of direction for one pixel to the right.
    pub step_x: DVec3,
    /// Change of direction for one pixel down.
    pub step_y: DVec3,
    /// Unit view direction.
    pub forward: DVec3,
}

impl PixelRays {
    /// The ray direction through image position `(x, y)` in pixels.
    #[inline]
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        self.corner + self.step_x * x + self.step_y * y
    }
}

impl Camera {
    /// Checks every number of the camera.
    ///
    /// # Errors
    /// [`Error::Scene`] with the numbers if a value is not finite, the view direction has length 0 or is parallel to
    /// `up`, the field of view is outside (0, 180) degrees, or `0 < near < far` does not hold.
    pub fn check(&self) -> Result<()> {
        let all = [self.eye, self.target, self.up];
        for (what, v) in ["eye", "target", "up"].iter().zip(all) {
            if !v.iter().all(|c| c.is_finite()) {
                return Err(Error::Scene(format!("camera {what} ({}, {}, {}) is not finite", v[0], v[1], v[2])));
            }
        }
        let fov = self.vertical_fov_degrees;
        if !(fov > 0.0 && fov < 180.0) {
            return Err(Error::Scene(format!("camera field of view of {fov} degrees is not between 0 and 180")));
        }
        if !(self.near > 0.0 && self.near < self.far && self.far.is_finite()) {
            return Err(Error::Scene(format!(
                "camera needs 0 < near < far, has near {} and far {}",
                self.near, self.far
            )));
        }
        let view = Vec3::from(self.target).as_dvec3() - Vec3::from(self.eye).as_dvec3();
        if view.length() == 0.0 {
            return Err(Error::Scene(format!(
                "camera eye and target are both ({}, {}, {})",
                self.eye[0], self.eye[1], self.eye[2]
            )));
        }
        let up = Vec3::from(self.up).as_dvec3();
        if view.cross(up).length() <= 1e-9 * view.length() * up.length() {
            return Err(Error::Scene(format!(
                "camera up ({}, {}, {}) is parallel to the view direction ({}, {}, {})",
                self.up[0], self.up[1], self.up[2], view.x, view.y, view.z
            )));
        }
        Ok(())
    }

    /// The rays of an image of `width` × `height` pixels.
    ///
    /// Sample `(x, y)` of pixel `(i, j)` has NDC `(2(i+x)/w − 1, 1 − 2(j+y)/h)`; the ray through it is
    /// `forward + ndc.x·tan(fov/2)·(w/h)·right + ndc.y·tan(fov/2)·up`.
    pub fn rays(&self, width: u32, height: u32) -> PixelRays {
        let eye = Vec3::from(self.eye).as_dvec3();
        let forward = (Vec3::from(self.target).as_dvec3() - eye).normalize();
        let right = forward.cross(Vec3::from(self.up).as_dvec3()).normalize();
        let up = right.cross(forward);
        let tan = (f64::from(self.vertical_fov_degrees).to_radians() * 0.5).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        let x_axis = right * (tan * (w / h));
        let y_axis = up * tan;
        PixelRays {
            eye,
            corner: forward - x_axis + y_axis,
            step_x: x_axis * (2.0 / w),
            step_y: y_axis * (-2.0 / h),
            forward,
        }
    }

    /// A camera that frames the box from `lowest` to `highest`, looking down at it from an angle.
    pub fn framing(lowest: DVec3, highest: DVec3) -> Self {
        let centre = (lowest + highest) * 0.5;
        let radius = ((highest - lowest).length() * 0.5).max(f64::MIN_POSITIVE.sqrt());
        let fov = 40.0f64;
        let distance = radius / (fov.to_radians() * 0.5).sin();
        let towards = DVec3::new(0.55, 0.5, 1.0).normalize();
        let eye = centre + towards * distance;
        Self {
            eye: eye.as_vec3().into(),
            target: centre.as_vec3().into(),
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: fov as f32,
            near: (distance * 1e-3) as f32,
            far: (distance * 100.0) as f32,
        }
    }

    /// Where `point` lands in the image, in pixels, and its view depth; `None` at or behind the eye.
    #[inline]
    pub fn project(&self, point: DVec3, width: u32, height: u32) -> Option<(DVec2, f64)> {
        let rays = self.rays(width, height);
        let p = point - rays.eye;
        let depth = p.dot(rays.forward);
        if depth <= 0.0 {
            return None;
        }
        let q = p / depth - rays.corner;
        let x = q.dot(rays.step_x) / rays.step_x.length_squared();
        let y = q.dot(rays.step_y) / rays.step_y.length_squared();
        Some((DVec2::new(x, y), depth))
    }
}
