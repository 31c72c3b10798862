//! Orthographic cameras, as cameras of a mapped world.

use super::projection::{ViewAxes, eye_and_target};
use super::{Camera, Homography, Lens, Light};
use crate::{Error, Result};
use glam::{DMat2, DVec2, DVec3, DVec4, Vec3};

/// A camera of parallel rays. Right-handed, world units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Orthographic {
    /// A point of the ray through the image's middle.
    pub eye: [f32; 3],
    /// Point looked at.
    pub target: [f32; 3],
    /// Direction that is up in the image; need not be orthogonal to the view.
    pub up: [f32; 3],
    /// Height of the image, world units.
    pub height: f32,
    /// Surfaces nearer than this along the view direction, from the eye, are not seen; they cast shadows all the same. May be below 0.
    pub near: f32,
    /// Distance of the other end of a depth buffer ([`DepthTerms::orthographic`](crate::pass::DepthTerms::orthographic)). Nothing is cut off there.
    pub far: f32,
    /// Part of the image plane that the image shows, and the shape of its pixels.
    pub lens: Lens,
}

/// A frame of an orthographic camera: a pinhole camera in a world that is mapped so that parallel rays meet in the eye.
///
/// Lines and planes of the mapped world are those of the world, and so is what hides what, from the eye and from lights: visibility is the same, sample
/// by sample, but for the rounding of mapped places to single precision. Distances are not: what is said of the mapped world in its units has no
/// meaning in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthographicView {
    /// The camera, at the origin of the mapped world.
    pub camera: Camera,
    /// The map.
    pub homography: Homography,
    /// Pixels of the image.
    pub(crate) size: [u32; 2],
    /// Inverse view depth of the mapped world in the image's middle, at the near and at the far distance.
    pub(crate) inverse_depth: [f64; 2],
    /// Gain of it from the middle of the image to its right end and to its top.
    pub(crate) inverse_tilt: [f64; 2],
}

/// So many sizes of the world lie between the farthest of it and where the divisor is 0.
const AHEAD: f64 = 1.0;
/// So many at the least between a light at a point and there.
const LIGHT_AHEAD: f64 = 1.0 / 16.0;
/// So many sizes of the world the divisor may grow to for a light at a point that is far ahead, or one along the view.
const MOST_STRETCH: f64 = 64.0;

impl Orthographic {
    /// A camera at `eye` that looks at `target`, whose image is `height` high. It sees surfaces from the eye on.
    pub fn look_at(eye: [f32; 3], target: [f32; 3], up: [f32; 3], height: f32) -> Self {
        Self { eye, target, up, height, near: 0.0, far: f32::MAX, lens: Lens::CENTRED }
    }

    /// The camera of a view matrix (world to view space) and an orthographic projection (view to clip space as wgpu has it, depth between 0 and 1), of
    /// an image of `width` x `height` pixels: off-centre, jittered, left-handed, with oblong pixels. `reversed`: depth is 1 at the near plane and 0 at the far one.
    /// The eye is the point of the view's middle ray that is nearest to the world's origin, and near and far distance are from there.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for a perspective projection, one that is turned, sheared or flat, and as [`Camera::of_matrices`] for the
    /// view; [`Error::Scene`] as [`Orthographic::check`].
    pub fn of_matrices(
        view: &[[f32; 4]; 4],
        projection: &[[f32; 4]; 4],
        reversed: bool,
        [width, height]: [u32; 2],
    ) -> Result<Self> {
        let refuse = |why: String| Err(Error::Config(format!("projection: {why}")));
        if !projection.iter().flatten().all(|c| c.is_finite()) {
            return refuse(format!("{projection:?} is not finite"));
        }
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| projection.map(|column| f64::from(column[row])));
        if w[..3] != [0.0; 3] || w[3] <= 0.0 {
            return refuse(format!("its divisor, row {w:?}, is not of an orthographic one"));
        }
        if x[1] != 0.0 || x[2] != 0.0 || y[0] != 0.0 || y[2] != 0.0 || z[..2] != [0.0; 2] {
            return refuse(format!("it is turned, sheared or oblique: rows {x:?}, {y:?} and {z:?}"));
        }
        if x[0] == 0.0 || y[1] == 0.0 || z[2] == 0.0 {
            return refuse(format!("it is flat: it scales x by {}, y by {} and z by {}", x[0], y[1], z[2]));
        }
        let axes = ViewAxes::new(view)?;
        // Depth grows along z of view space, or falls.
        let ahead = if (z[2] > 0.0) == reversed { -1.0 } else { 1.0 };
        let at = |depth: bool| (f64::from(u8::from(depth)) * w[3] - z[3]) / z[2] * ahead / axes.scale;
        // Where along the view the eye is, is free: rounded to single precision it is best near the origin. Rows that rounding has turned a little
        // have the view across those of x and y.
        let view = axes.right.cross(axes.up).normalize() * ahead;
        let beyond = axes.eye.dot(view);
        let [near, far] = [at(reversed), at(!reversed)].map(|at| (at + beyond) as f32);
        let (eye, target) = eye_and_target(axes.eye - view * beyond, view);
        let [wide, high] = [x[0], y[1]].map(|of| 2.0 * w[3] / of.abs() / axes.scale);
        let aspect = wide / high * f64::from(height) / f64::from(width);
        let camera = Self {
            eye,
            target,
            up: (axes.up * y[1].signum()).as_vec3().into(),
            height: high as f32,
            near,
            far,
            lens: Lens {
                shift: [x[3], y[3]].map(|c| (-c / w[3]) as f32),
                pixel_aspect: if (aspect - 1.0).abs() < 1e-6 { 1.0 } else { aspect as f32 },
                mirrored: ahead * x[0].signum() * y[1].signum() > 0.0,
            },
        };
        camera.check().map(|()| camera)
    }

    /// Checks every number of the camera.
    ///
    /// # Errors
    /// [`Error::Scene`] with the numbers, as [`Camera::check`], and for a height that is not above 0 or a far distance that is not above the near one.
    pub fn check(&self) -> Result<()> {
        let Self { eye, target, up, height, near, far, lens } = *self;
        Camera { lens, ..Camera::look_at(eye, target, up, 40.0, 1.0) }.check()?;
        if !(height > 0.0 && height.is_finite()) {
            return Err(Error::Scene(format!("orthographic camera: a height of {height} is not above 0")));
        }
        if !(near.is_finite() && far.is_finite() && near < far) {
            return Err(Error::Scene(format!("orthographic camera needs near < far, has near {near} and far {far}")));
        }
        Ok(())
    }

    /// Unit directions right, up and ahead of the view.
    fn axes(&self) -> [DVec3; 3] {
        let [eye, target, up] = [self.eye, self.target, self.up].map(|p| Vec3::from(p).as_dvec3());
        let ahead = (target - eye).normalize_or_zero();
        let right = ahead.cross(up).normalize_or_zero();
        [right, right.cross(ahead), ahead]
    }

    /// The ray through image position `(x, y)` in pixels of an image of so many: a point of it at distance 0, and the unit view direction.
    pub fn ray(&self, [x, y]: [f64; 2], [width, height]: [u32; 2]) -> (DVec3, DVec3) {
        let [right, up, ahead] = self.axes();
        let [wide, high] = self.halves([width, height]);
        let [at_x, at_y] = self.lens.shift.map(f64::from);
        let x = (2.0 * x / f64::from(width) - 1.0 + at_x) * wide;
        let y = (1.0 - 2.0 * y / f64::from(height) + at_y) * high;
        (Vec3::from(self.eye).as_dvec3() + right * x + up * y, ahead)
    }

    /// From the middle of the image to its right end, along the view's right, and to its top, world units.
    fn halves(&self, [width, height]: [u32; 2]) -> [f64; 2] {
        let half = 0.5 * f64::from(self.height);
        let wide = half * f64::from(width) / f64::from(height) * f64::from(self.lens.pixel_aspect);
        [if self.lens.mirrored { -wide } else { wide }, half]
    }

    /// This camera's frame, of an image of `size` pixels, in a world that lies between the corners `bounds` and has these lights: all casters of the
    /// frame, all receivers that a G-buffer shows, and of a light of some extent all its [points](super::AreaLight::points), around the middle of the
    /// casters' box. Places are known to about 10^-7 of the size of the box, or of the image where that is larger.
    ///
    /// A surface that a light shines along, to what that leaves open, is dark.
    ///
    /// # Errors
    /// [`Error::Scene`], with the numbers, for a camera, a light or a box that cannot be used, and for lights that no map can hold together: two or more
    /// directional ones that shine against the view from opposite sides, one that does within 0.9 degrees of it, or one at a point more than 64 sizes of
    /// the world ahead; [`Error::Config`] for an image without pixels.
    pub fn in_world(&self, bounds: [[f32; 3]; 2], lights: &[Light], size: [u32; 2]) -> Result<OrthographicView> {
        self.check()?;
        lights.iter().try_for_each(Light::check)?;
        if size.contains(&0) {
            return Err(Error::Config(format!("orthographic camera: an image of {} x {} pixels", size[0], size[1])));
        }
        let [low, high] = bounds.map(|p| Vec3::from(p).as_dvec3());
        if !(low.is_finite() && high.is_finite() && low.cmple(high).all()) {
            return Err(Error::Scene(format!("orthographic camera: no box from {:?} to {:?}", bounds[0], bounds[1])));
        }
        let [right, up, ahead] = self.axes();
        let eye = Vec3::from(self.eye).as_dvec3();
        let middle = (0.5 * (low + high) - eye).dot(ahead);
        let origin = (eye + ahead * middle).as_vec3().as_dvec3();
        let [wide, tall] = self.halves(size);
        let extent = (high - low).length().max(2.0 * wide.abs()).max(2.0 * tall);
        let lean = lean(lights, [right, up, ahead])?;
        let across = ahead + right * lean.x + up * lean.y;
        let corner = |k: usize| {
            let at = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            across.dot(DVec3::new(at(0), at(1), at(2)) - origin)
        };
        let (least, most) = (0..8).map(corner).fold((f64::MAX, f64::MIN), |(a, b), of| (a.min(of), b.max(of)));
        let extent = extent.max(most - least);
        let mut divisor = most + AHEAD * extent;
        for light in lights.iter().map(Light::homogeneous).filter(|at| at.w != 0.0) {
            let at = across.dot(light.truncate() - origin);
            divisor = divisor.max(at + LIGHT_AHEAD * extent);
            if divisor - most > MOST_STRETCH * extent {
                let [x, y, z] = light.truncate().to_array();
                return Err(Error::Scene(format!(
                    "orthographic camera: the light ({x}, {y}, {z}) is more than {MOST_STRETCH} times as far ahead as the world is large, {extent}"
                )));
            }
        }
        let offset = eye - origin;
        let row = |of: DVec3, add: f64| of.extend(add).as_vec4().to_array();
        let homography = Homography {
            origin: origin.extend(divisor).as_vec4().into(),
            right: row(right, -right.dot(offset)),
            up: row(up, -up.dot(offset)),
            divisor: row(-across, divisor),
        };
        let depth = f64::from(homography.origin[3]);
        // The near plane: where the distance ahead is `near`.
        let from = f64::from(self.near) + ahead.dot(offset);
        let near_plane = DVec4::new(-lean.x, -lean.y, -(divisor - from) / depth, -1.0);
        let tan = tall / depth;
        let deepest = depth / (divisor - most);
        let camera = Camera {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: (2.0 * tan.atan()).to_degrees() as f32,
            near: (0.5 * depth / (divisor - least)) as f32,
            far: (2.0 * deepest) as f32,
            lens: self.lens,
            near_plane: Some(near_plane.as_vec4().into()),
        };
        if let Err(error) = camera.check() {
            return Err(Error::Scene(format!(
                "orthographic camera: a height of {} in a world of size {extent}: {error}",
                self.height
            )));
        }
        let [at_x, at_y] = self.lens.shift.map(f64::from);
        let tilt = [-lean.x * wide / depth, -lean.y * tall / depth];
        let at = |distance: f32| (divisor - f64::from(distance) - ahead.dot(offset)) / depth;
        let inverse_depth = [self.near, self.far].map(|end| at(end) + at_x * tilt[0] + at_y * tilt[1]);
        Ok(OrthographicView { camera, homography, size, inverse_depth, inverse_tilt: tilt })
    }
}

/// How far the planes of one divisor lean from across the view, to the right and up: the least by which no directional light comes from behind where
/// the divisor is 0.
fn lean(lights: &[Light], [right, up, ahead]: [DVec3; 3]) -> Result<DVec2> {
    let directional = lights.iter().map(Light::homogeneous).filter(|at| at.w == 0.0);
    let ways: Vec<DVec3> = directional.map(|at| at.truncate().normalize()).collect();
    let limits: Vec<(DVec2, f64)> =
        ways.iter().map(|way| (DVec2::new(way.dot(right), way.dot(up)), -way.dot(ahead))).collect();
    let fits = |lean: &DVec2| limits.iter().all(|(by, most)| by.dot(*lean) <= most + 1e-9 * (1.0 + lean.length()));
    let touching = limits.iter().map(|(by, most)| *by * (most / by.length_squared()));
    let crossing = |(a, b): (&(DVec2, f64), &(DVec2, f64))| {
        Some(DMat2::from_cols(a.0, b.0).transpose().try_inverse()? * DVec2::new(a.1, b.1))
    };
    let pairs = limits.iter().enumerate().flat_map(|(k, b)| limits[..k].iter().map(move |a| (a, b)));
    let crossings = pairs.filter_map(crossing);
    let least = std::iter::once(DVec2::ZERO)
        .chain(touching)
        .chain(crossings)
        .filter(|lean| lean.is_finite() && lean.length() <= MOST_STRETCH && fits(lean))
        .min_by(|a, b| a.length().total_cmp(&b.length()));
    least.ok_or_else(|| {
        let mut told: Vec<_> =
            ways.iter().take(4).map(|w| format!("({:.4}, {:.4}, {:.4})", w.x, w.y, w.z)).collect();
        if ways.len() > told.len() {
            told.push(format!("{} more", ways.len() - told.len()));
        }
        Error::Scene(format!(
            "orthographic camera: no map of the world holds the directional lights {} as seen along ({:.4}, {:.4}, {:.4})",
            told.join(", "),
            ahead.x,
            ahead.y,
            ahead.z
        ))
    })
}

#[cfg(test)]
mod tests;
