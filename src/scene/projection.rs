//! Cameras as the matrices of an application, `m[column][row]`, as WGSL and glam hold them: `clip = m * (x, y, z, 1)`.

use super::camera::{Camera, Lens};
use crate::{Error, Result};
use glam::{DMat3, DVec3, DVec4, Vec3};

/// A perspective projection from view space, its eye at the origin, to clip space as wgpu has it: x and y of the image between -1 and 1, y up, depth
/// between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerspectiveTerms {
    /// Scale of x and y at view depth 1.
    pub focal: [f64; 2],
    /// Place of the image's middle, as in [`Lens::shift`].
    pub shift: [f64; 2],
    /// Sign of x and of y: -1 where the image is turned over.
    pub turned: [f64; 2],
    /// Sign of the view direction along z: -1 right-handed, 1 left-handed.
    pub ahead: f64,
    /// Depth at view depth `d`, as `(a d + b) / (c d)`, in the image's middle.
    pub depth: [f64; 3],
    /// By how much `a` grows from there to the image's right end and to its top: not 0 where the near plane is oblique.
    pub tilt: [f64; 2],
}

impl PerspectiveTerms {
    /// Takes a matrix apart.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for what no [`Camera`] can say: a projection that is not finite or orthographic, turned, sheared or
    /// flat, or seen from elsewhere than the origin.
    pub fn new(matrix: &[[f32; 4]; 4]) -> Result<Self> {
        let refuse = |why: String| Err(Error::Config(format!("projection: {why}")));
        if !matrix.iter().flatten().all(|c| c.is_finite()) {
            return refuse(format!("{matrix:?} is not finite"));
        }
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| matrix.map(|column| column[row]));
        if w[0] != 0.0 || w[1] != 0.0 {
            return refuse(format!("its divisor, row {w:?}, depends on x or y"));
        }
        if w[2] == 0.0 {
            return refuse(format!(
                "its divisor, row {w:?}, is not of a perspective one: a camera of parallel rays is an Orthographic"
            ));
        }
        if x[3] != 0.0 || y[3] != 0.0 || w[3] != 0.0 {
            return refuse(format!("its eye is not the origin: it adds ({}, {}) and divides by {}", x[3], y[3], w[3]));
        }
        if x[1] != 0.0 || y[0] != 0.0 {
            return refuse(format!("it is turned or sheared: rows ({}, {}) and ({}, {})", x[0], x[1], y[0], y[1]));
        }
        let by_depth = f64::from(w[2]);
        let scales = [x[0], y[1]].map(|c| f64::from(c) / by_depth.abs());
        if scales.contains(&0.0) {
            return refuse(format!("it is flat: it scales x by {} and y by {}", scales[0], scales[1]));
        }
        // A point ahead has a positive divisor.
        let ahead = by_depth.signum();
        // Depth by x and y of clip space, which grow with the view depth.
        let by = [(z[0], x[0]), (z[1], y[1])].map(|(depth, place)| f64::from(depth) / f64::from(place));
        let straight = f64::from(z[2]) - by[0] * f64::from(x[2]) - by[1] * f64::from(y[2]);
        Ok(Self {
            focal: scales.map(f64::abs),
            shift: [x[2], y[2]].map(|c| -f64::from(c) / by_depth),
            turned: scales.map(f64::signum),
            ahead,
            depth: [straight * ahead, f64::from(z[3]), by_depth.abs()],
            tilt: by.map(|by| by * by_depth.abs()),
        })
    }

    /// Whether left and right are exchanged, in a view that is not mirrored itself.
    pub fn mirrors(&self) -> bool {
        self.ahead * self.turned[0] * self.turned[1] > 0.0
    }

    /// Inverse view depth of the near plane in the image's middle, and what it gains from there to the right end and to the top. The near plane is
    /// the one of depth 0 or 1 that has the eye on its hidden side.
    pub fn near_plane(&self) -> [f64; 3] {
        inverse_near(self.depth, self.tilt)
    }

    /// Nearest and farthest view depth; infinity where there is no farthest. Of a projection whose near plane is not oblique.
    ///
    /// # Errors
    /// [`Error::Config`] if depth does not lie between 0 and 1 from a positive distance on.
    pub fn range(&self) -> Result<[f64; 2]> {
        let [a, b, c] = self.depth;
        let ends = [-b / a, b / (c - a)].map(|end| if end.is_finite() { end } else { f64::INFINITY });
        let [near, far] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if near > 0.0 && near < far {
            return Ok([near, far]);
        }
        Err(Error::Config(format!(
            "projection: depth ({a} d + {b}) / ({c} d) is not that of a near and a far distance"
        )))
    }
}

/// [`PerspectiveTerms::near_plane`] of its `depth` and `tilt`.
pub(crate) fn inverse_near([a, b, c]: [f64; 3], [x, y]: [f64; 2]) -> [f64; 3] {
    if b < 0.0 { [a, x, y].map(|of| -of / b) } else { [c - a, -x, -y].map(|of| of / b) }
}

/// A view matrix taken apart: a turn, a shift and an even scale.
pub(super) struct ViewAxes {
    pub eye: DVec3,
    /// Unit directions of x, y and z of view space.
    pub right: DVec3,
    pub up: DVec3,
    pub back: DVec3,
    /// Units of view space by those of the world.
    pub scale: f64,
}

impl ViewAxes {
    /// Takes a matrix (world to view space) apart.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for one that is no turn, shift and even scale, or mirrored.
    pub fn new(view: &[[f32; 4]; 4]) -> Result<Self> {
        let refuse = |why: String| Err(Error::Config(format!("view: {why}")));
        if !view.iter().flatten().all(|c| c.is_finite()) {
            return refuse(format!("{view:?} is not finite"));
        }
        let last = view.map(|column| column[3]);
        if last != [0.0, 0.0, 0.0, 1.0] {
            return refuse(format!("its last row is {last:?}, not (0, 0, 0, 1)"));
        }
        let columns = view.map(|column| DVec4::from(column.map(f64::from)).truncate());
        let turn = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let scale = turn.determinant().abs().cbrt();
        let off = turn * turn.transpose() * (1.0 / (scale * scale)) - DMat3::IDENTITY;
        let worst = off.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
        if !(scale > 0.0 && worst < 1e-3) {
            return refuse(format!("{view:?} is no turn, shift and even scale"));
        }
        if turn.determinant() < 0.0 {
            return refuse("it is mirrored: a left-handed camera has a left-handed projection".to_owned());
        }
        let [right, up, back] = turn.transpose().to_cols_array_2d().map(|row| DVec3::from(row) / scale);
        Ok(Self { eye: turn.inverse() * -columns[3], right, up, back, scale })
    }
}

/// An eye in single precision, and a point ahead of it so far away that rounding the point moves no direction.
pub(super) fn eye_and_target(eye: DVec3, ahead: DVec3) -> ([f32; 3], [f32; 3]) {
    let eye = eye.as_vec3();
    let far_off = 4.0 * eye.abs().max_element().max(1.0);
    let target = eye.as_dvec3() + ahead.normalize() * f64::from(far_off);
    (eye.into(), target.as_vec3().into())
}

impl Camera {
    /// The camera of a view matrix (world to view space) and a projection (view to clip space as wgpu has it), of an image of `width` x
    /// `height` pixels. Off-centre, jittered, left-handed, with oblong pixels, infinite or reversed depth, an oblique near plane: all of these. Surfaces
    /// nearer than the near plane are not seen; there is no far plane. Eye and directions are rounded to `f32`, as the matrices are.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for an orthographic projection ([`Orthographic`](super::Orthographic) takes these) and what else no camera can say ([`PerspectiveTerms::new`]); for a view that is no turn, shift and even scale, or mirrored (which the projection may be). [`Error::Scene`] as
    /// [`Camera::check`].
    pub fn of_matrices(view: &[[f32; 4]; 4], projection: &[[f32; 4]; 4], [width, height]: [u32; 2]) -> Result<Self> {
        let projection = PerspectiveTerms::new(projection)?;
        let axes = ViewAxes::new(view)?;
        let scale = axes.scale;
        let oblique = projection.tilt != [0.0; 2];
        let [near, far] = if oblique { [scale, f64::INFINITY] } else { projection.range()? };
        let (eye, target) = eye_and_target(axes.eye, axes.back * projection.ahead);
        let [fx, fy] = projection.focal;
        let aspect = fy / fx * f64::from(height) / f64::from(width);
        let camera = Self {
            eye,
            target,
            up: (axes.up * projection.turned[1]).as_vec3().into(),
            vertical_fov_degrees: ((1.0 / fy).atan() * 2.0).to_degrees() as f32,
            near: (near / scale) as f32,
            far: (far / scale).min(f64::from(f32::MAX)) as f32,
            lens: Lens {
                shift: projection.shift.map(|c| c as f32),
                // Square pixels stay square.
                pixel_aspect: if (aspect - 1.0).abs() < 1e-6 { 1.0 } else { aspect as f32 },
                mirrored: projection.mirrors(),
            },
            near_plane: None,
        };
        camera.check()?;
        if !oblique {
            return Ok(camera);
        }
        let camera = camera.behind(projection.near_plane().map(|of| of * scale), [width, height])?;
        camera.check().map(|()| camera)
    }

    /// This camera with the oblique near plane that the image of `width` x `height` pixels says: its inverse view depth in the middle, and what
    /// that gains to the right end and to the top.
    fn behind(self, [middle, right, top]: [f64; 3], [width, height]: [u32; 2]) -> Result<Self> {
        let rays = self.rays(width, height);
        let [by_x, by_y] = [right * 2.0 / f64::from(width), -top * 2.0 / f64::from(height)];
        let image = DMat3::from_cols(rays.corner, rays.step_x, rays.step_y).transpose();
        let plane = image.inverse() * DVec3::new(middle - right + top, by_x, by_y);
        let length = plane.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(Error::Config(format!(
                "projection: its near plane has an inverse depth of {middle} in the image's middle, {right} more at its right end and {top} more at its top"
            )));
        }
        let normal = plane / length;
        // Nothing in the image is nearer, and the eye is.
        let inverse = rays.corners(width, height).map(|ray| plane.dot(ray)).into_iter().fold(0.0, f64::max);
        let near = if inverse > 0.0 { (0.999 / inverse).clamp(1e-30, 1e30) } else { 1.0 };
        let offset = -1.0 / length - normal.dot(rays.eye);
        let near_plane = Some([normal.x, normal.y, normal.z, offset].map(|c| c as f32));
        Ok(Self { near: near as f32, near_plane, ..self })
    }

    /// The view matrix: world to view space, the eye at the origin, the view along `-z`, y up.
    pub fn view(&self) -> [[f32; 4]; 4] {
        let eye = Vec3::from(self.eye).as_dvec3();
        let forward = (Vec3::from(self.target).as_dvec3() - eye).normalize();
        let right = forward.cross(Vec3::from(self.up).as_dvec3()).normalize();
        let rows = [right, right.cross(forward), -forward];
        let column = |k: usize| rows.map(|row| row[k] as f32);
        let [a, b, c] = [0, 1, 2].map(column);
        let [x, y, z] = rows.map(|row| -row.dot(eye) as f32);
        [[a[0], a[1], a[2], 0.0], [b[0], b[1], b[2], 0.0], [c[0], c[1], c[2], 0.0], [x, y, z, 1.0]]
    }

    /// By how much an image of `width` x `height` pixels scales x and y at view depth 1.
    pub fn focal(&self, [width, height]: [u32; 2]) -> [f64; 2] {
        let of_height = 1.0 / (f64::from(self.vertical_fov_degrees).to_radians() * 0.5).tan();
        [of_height * f64::from(height) / (f64::from(width) * f64::from(self.lens.pixel_aspect)), of_height]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::camera::{
        lh::proj::directx as lh, lh::view as left_view, rh::proj::directx as rh, rh::view as right_view,
    };
    use glam::{DVec2, Mat4, Vec4Swizzles};

    const SIZE: [u32; 2] = [320, 200];

    fn of(view: Mat4, projection: Mat4) -> Result<Camera> {
        Camera::of_matrices(&view.to_cols_array_2d(), &projection.to_cols_array_2d(), SIZE)
    }

    /// How far, in pixels, points of the world lie on the camera's image from where the matrices put them.
    fn off(camera: &Camera, view: Mat4, projection: Mat4) -> f64 {
        let mut worst = 0.0f64;
        for k in 0..27 {
            let p = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) - 1.0;
            let clip = projection.as_dmat4() * (view.as_dmat4() * p.extend(1.0));
            let Some((at, _)) = camera.project(p, SIZE[0], SIZE[1]) else { continue };
            let ndc = clip.xy() / clip.w;
            let wanted = (ndc * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
            worst = worst.max(wanted.distance(at));
        }
        worst
    }

    /// A camera puts points where the matrices that it is of put them: centred, jittered, off-centre, left-handed, turned over.
    #[test]
    fn matrices_are_cameras() {
        let (eye, target) = (Vec3::new(3.0, 2.5, 4.0), Vec3::new(0.1, 0.2, -0.3));
        let up = Vec3::new(0.2, 1.0, 0.1);
        let right = right_view::look_at_mat4(eye, target, up);
        let left = left_view::look_at_mat4(eye, target, up);
        let aspect = SIZE[0] as f32 / SIZE[1] as f32;
        let moved = |x: f32, y: f32, of: Mat4| Mat4::from_translation(Vec3::new(x, y, 0.0)) * of;
        let centred = rh::perspective_infinite_reverse(0.9, aspect, 0.1);
        for (name, view, projection) in [
            ("centred", right, centred),
            ("jittered", right, moved(0.5 / 320.0, -0.6 / 200.0, centred)),
            ("off-centre", right, rh::frustum(-0.1, 0.2, -0.15, 0.05, 0.1, 10.0)),
            ("left-handed", left, lh::perspective(0.7, aspect, 0.1, 10.0)),
            ("left-handed, off-centre", left, lh::frustum(-0.1, 0.2, -0.15, 0.05, 0.1, 10.0)),
            ("oblong pixels", right, rh::perspective(0.7, 3.0, 0.1, 10.0)),
            ("turned over", right, Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0)) * moved(0.1, 0.2, centred)),
            ("scaled", right * Mat4::from_scale(Vec3::splat(3.0)), centred),
        ] {
            let camera = of(view, projection).expect(name);
            let worst = off(&camera, view, projection);
            assert!(worst < 1e-3, "{name}: {worst} pixels, {camera:?}");
            assert!(
                off(&Camera { lens: Lens::CENTRED, ..camera }, view, projection) > 0.1 || camera.lens == Lens::CENTRED
            );
            // Its own matrices say the same.
            let own = Mat4::from_cols_array_2d(&camera.view());
            let terms =
                crate::pass::DepthTerms::reversed_infinite(0.1).projection(&camera, SIZE).expect("a projection");
            let worst = off(&camera, own, Mat4::from_cols_array_2d(&terms));
            assert!(worst < 1e-3, "{name}: {worst} pixels");
        }
        let near = |projection| of(right, projection).expect("a camera").near;
        for projection in [
            rh::perspective(0.9, 1.0, 0.125, 10.0),
            rh::perspective_infinite(0.9, 1.0, 0.125),
            rh::perspective_infinite_reverse(0.9, 1.0, 0.125),
        ] {
            assert!((near(projection) - 0.125).abs() < 1e-6, "{projection}");
        }
        assert!((near(Mat4::from_scale(Vec3::new(1.0, 1.0, 2.0)) * centred)).is_finite());
    }

    /// Of an eye far from the origin, the direction is as good as the matrix.
    #[test]
    fn far_eyes_look_where_they_look() {
        let eye = Vec3::new(40_000.0, 2.5, -70_000.0);
        let view = right_view::look_at_mat4(eye, eye + Vec3::new(-0.6, -0.2, 0.77), Vec3::Y);
        let camera = of(view, rh::perspective_infinite_reverse(0.9, 1.6, 0.1)).expect("a camera");
        let wanted = -view.transpose().z_axis.xyz().as_dvec3();
        let forward = camera.rays(SIZE[0], SIZE[1]).forward;
        assert!((forward - wanted.normalize()).length() < 2e-7, "{forward} {wanted}");
    }

    /// Everything that a camera cannot say is refused, with the numbers.
    #[test]
    fn matrices_of_no_camera_are_refused() {
        let view = right_view::look_at_mat4(Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO, Vec3::Y);
        for at_w in [-1.0, 1.0] {
            let with = |column: usize, row: usize, value: f32| {
                let mut m = rh::perspective_infinite_reverse(0.9, 4.0 / 3.0, 0.1);
                m.z_axis.w = at_w;
                m.col_mut(column)[row] = value;
                of(view, m).map_err(|e| e.to_string())
            };
            assert!(with(2, 3, at_w).is_ok());
            for (column, row, value, numbers) in [
                (3, 0, 0.5, "adds (0.5, 0)"),
                (3, 1, 0.125, "adds (0, 0.125)"),
                (3, 3, 0.75, "divides by 0.75"),
                (1, 0, 0.0625, "0.0625"),
                (0, 1, 0.03125, "0.03125"),
                (1, 3, 0.5, "0.5"),
                (1, 1, 0.0, "y by 0"),
                (1, 1, f32::NAN, "NaN"),
                (2, 3, 0.0, "Orthographic"),
                (3, 2, -0.1, "near and a far"),
                (2, 0, 17.0, "17"),
            ] {
                let got = with(column, row, value);
                assert!(got.as_ref().is_err_and(|e| e.contains(numbers)), "{column} {row} {value}: {got:?}");
            }
        }
        let sound = rh::perspective(0.9, 1.5, 0.1, 10.0);
        for m in [
            Mat4::ZERO,
            Mat4::from_rotation_x(0.1),
            rh::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0),
            sound * Mat4::from_rotation_z(0.1),
        ] {
            assert!(of(view, m).is_err(), "{m}");
        }
        for (m, why) in [
            (Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)) * view, "mirrored"),
            (Mat4::from_scale(Vec3::new(1.0, 2.0, 1.0)) * view, "even scale"),
            (Mat4::ZERO, "last row"),
            (sound, "last row"),
            (Mat4::from_scale(Vec3::ZERO) * view, "even scale"),
        ] {
            let got = of(m, sound).map_err(|e| e.to_string());
            assert!(got.as_ref().is_err_and(|e| e.contains(why)), "{why}: {got:?}");
        }
    }
}
