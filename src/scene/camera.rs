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
    /// Part of the image plane that the image shows.
    #[cfg_attr(feature = "serde", serde(default))]
    pub lens: Lens,
    /// An oblique near plane besides, as a mirror or a portal needs: `[a, b, c, d]`, world units. Surfaces where `a x + b y + c z + d < 0` are not
    /// seen either; they cast shadows all the same. The eye lies on that side. What is within 10^-6 of the plane may be on either side.
    #[cfg_attr(feature = "serde", serde(default))]
    pub near_plane: Option<[f32; 4]>,
}

/// Part of the image plane that an image shows, and the shape of its pixels. The default is centred on the view direction, with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Lens {
    /// Place of the image's middle: from where the view direction meets the image plane, in halves of the image, x to the right, y up.
    /// At most [`Lens::MOST_SHIFT`] either way.
    pub shift: [f32; 2],
    /// Width of a pixel by its height, more than 0.
    pub pixel_aspect: f32,
    /// Left and right are exchanged: what a left-handed view of a right-handed world shows.
    pub mirrored: bool,
}

impl Default for Lens {
    fn default() -> Self {
        Self::CENTRED
    }
}

impl Lens {
    /// Centred on the view direction, square pixels, not mirrored.
    pub const CENTRED: Self = Self { shift: [0.0; 2], pixel_aspect: 1.0, mirrored: false };
    /// The largest shift: a poster of 17 images a side.
    pub const MOST_SHIFT: f32 = 16.0;

    /// This lens with every sample of an image of `width` x `height` pixels moved by so many pixels, x to the right, y down: the jitter of
    /// temporal antialiasing.
    pub fn jittered(self, [x, y]: [f32; 2], [width, height]: [u32; 2]) -> Self {
        let [right, down] = [(x, width), (y, height)].map(|(by, side)| 2.0 * by / side as f32);
        Self { shift: [self.shift[0] + right, self.shift[1] - down], ..self }
    }

    fn check(&self) -> Result<()> {
        let [x, y] = self.shift;
        if !(x.abs() <= Self::MOST_SHIFT && y.abs() <= Self::MOST_SHIFT) {
            let most = Self::MOST_SHIFT;
            return Err(Error::Scene(format!(
                "camera lens: a shift of ({x}, {y}) half images is not within {most} either way"
            )));
        }
        let aspect = self.pixel_aspect;
        if !(1e-3..=1e3).contains(&aspect) {
            return Err(Error::Scene(format!("camera lens: a pixel aspect of {aspect} is not between 0.001 and 1000")));
        }
        Ok(())
    }
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
    /// View depth from which on surfaces are seen ([`Camera::near`]).
    pub near: f64,
    /// The oblique near plane: surfaces are seen from the view depth on whose inverse is the dot product of this with the ray's direction, and nowhere
    /// where that is not above 0; 0 without such a plane.
    pub near_plane: DVec3,
}

impl PixelRays {
    /// The ray direction through image position `(x, y)` in pixels.
    #[inline]
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        self.corner + self.step_x * x + self.step_y * y
    }

    /// View depth from which on a ray of this direction sees surfaces, infinite where it sees none.
    #[inline]
    pub fn begin(&self, direction: DVec3) -> f64 {
        if self.near_plane == DVec3::ZERO {
            return self.near;
        }
        let inverse = self.near_plane.dot(direction);
        if inverse > 0.0 { self.near.max(1.0 / inverse) } else { f64::INFINITY }
    }

    /// Rays through the corners of an image of `width` x `height` pixels: top left, top right, bottom right, bottom left.
    pub fn corners(&self, width: u32, height: u32) -> [DVec3; 4] {
        let (w, h) = (f64::from(width), f64::from(height));
        [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(|[x, y]| self.direction(x, y))
    }

    /// The length of the longest ray of the image.
    pub fn longest(&self, width: u32, height: u32) -> f64 {
        self.corners(width, height).map(DVec3::length).into_iter().fold(0.0, f64::max)
    }
}

impl Camera {
    /// Checks every number of the camera.
    ///
    /// # Errors
    /// [`Error::Scene`] with the numbers if a value is not finite, the view direction has length 0 or is parallel to
    /// `up`, the field of view is outside (0, 180) degrees, `0 < near < far` does not hold, or the near plane has the eye on the side that is seen.
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
        if let Some([a, b, c, d]) = self.near_plane {
            let hidden = self.behind_near_plane();
            if !(hidden > 0.0 && hidden.is_finite() && [a, b, c] != [0.0; 3]) {
                return Err(Error::Scene(format!(
                    "camera near plane ({a}, {b}, {c}, {d}) does not have the eye ({}, {}, {}) on its hidden side",
                    self.eye[0], self.eye[1], self.eye[2]
                )));
            }
        }
        self.lens.check()
    }

    /// How far the eye is behind its oblique near plane, in units of the plane's normal; 0 without one.
    fn behind_near_plane(&self) -> f64 {
        let Some(plane) = self.near_plane else { return 0.0 };
        let [a, b, c, d] = plane.map(f64::from);
        -(DVec3::new(a, b, c).dot(Vec3::from(self.eye).as_dvec3()) + d)
    }

    /// A camera at `eye` that looks at `target`, centred, with square pixels. It sees surfaces from `near` on.
    pub fn look_at(eye: [f32; 3], target: [f32; 3], up: [f32; 3], vertical_fov_degrees: f32, near: f32) -> Self {
        Self { eye, target, up, vertical_fov_degrees, near, far: f32::MAX, lens: Lens::CENTRED, near_plane: None }
    }

    /// The rays of an image of `width` × `height` pixels.
    ///
    /// Sample `(x, y)` of pixel `(i, j)` has NDC `(2(i+x)/w − 1, 1 − 2(j+y)/h)`; the ray through it is
    /// `forward + (ndc.x + shift.x)·tan(fov/2)·(w/h)·pixel_aspect·right + (ndc.y + shift.y)·tan(fov/2)·up`.
    pub fn rays(&self, width: u32, height: u32) -> PixelRays {
        let eye = Vec3::from(self.eye).as_dvec3();
        let forward = (Vec3::from(self.target).as_dvec3() - eye).normalize();
        let right = forward.cross(Vec3::from(self.up).as_dvec3()).normalize();
        let up = right.cross(forward);
        let Lens { shift, pixel_aspect, mirrored } = self.lens;
        let [x, y] = shift.map(f64::from);
        let right = if mirrored { -right } else { right };
        let tan = (f64::from(self.vertical_fov_degrees).to_radians() * 0.5).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        let x_axis = right * (tan * (w / h) * f64::from(pixel_aspect));
        let y_axis = up * tan;
        PixelRays {
            eye,
            corner: forward + x_axis * (x - 1.0) + y_axis * (y + 1.0),
            step_x: x_axis * (2.0 / w),
            step_y: y_axis * (-2.0 / h),
            forward,
            near: f64::from(self.near),
            near_plane: self
                .near_plane
                .map_or(DVec3::ZERO, |[a, b, c, _]| DVec3::from([a, b, c].map(f64::from)) / self.behind_near_plane()),
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
            lens: Lens::CENTRED,
            near_plane: None,
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
