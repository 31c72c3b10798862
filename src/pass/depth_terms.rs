//! Depth buffers of an application: what their values are of, and whether that is the camera's.

use crate::scene::{Camera, Lens, OrthographicView, PerspectiveTerms, inverse_near};
use crate::{Error, Result};

/// How a depth buffer holds depth: at view depth `z` (distance from the eye along the view direction, world units) the value
/// `(scale * z + offset) / (w_scale * z + w_offset)`; where the near plane is oblique, `scale` is another at each pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthTerms {
    /// Of `z`, above.
    pub scale: f32,
    /// Alone, above.
    pub offset: f32,
    /// Of `z`, below.
    pub w_scale: f32,
    /// Alone, below.
    pub w_offset: f32,
    /// By how much `scale`, which is that in the image's middle, grows to its right end and to its top: not 0 where the near plane is oblique.
    pub tilt: [f32; 2],
    /// The projection that they are of ([`DepthTerms::of_projection`]): [`ShadowPass::record`](super::ShadowPass::record) refuses a camera
    /// with another image. `None`: nobody looks.
    pub image: Option<ImageTerms>,
}

/// Image of a projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageTerms {
    /// Scale of x and y at view depth 1.
    pub focal: [f32; 2],
    /// Place of the image's middle, as in [`Lens::shift`].
    pub shift: [f32; 2],
    /// Whether left and right are exchanged: as in [`Lens::mirrored`].
    pub mirrored: bool,
}

impl DepthTerms {
    /// 0 at `near`, 1 at `far`.
    pub fn standard(near: f32, far: f32) -> Self {
        let scale = far / (far - near);
        Self { scale, offset: -near * scale, w_scale: 1.0, w_offset: 0.0, tilt: [0.0; 2], image: None }
    }

    /// 0 at `near`, 1 infinitely far.
    pub fn infinite(near: f32) -> Self {
        Self { scale: 1.0, offset: -near, w_scale: 1.0, w_offset: 0.0, tilt: [0.0; 2], image: None }
    }

    /// 1 at `near`, 0 at `far`.
    pub fn reversed(near: f32, far: f32) -> Self {
        let scale = -near / (far - near);
        Self { scale, offset: -far * scale, w_scale: 1.0, w_offset: 0.0, tilt: [0.0; 2], image: None }
    }

    /// 1 at `near`, 0 infinitely far.
    pub fn reversed_infinite(near: f32) -> Self {
        Self { scale: 0.0, offset: near, w_scale: 1.0, w_offset: 0.0, tilt: [0.0; 2], image: None }
    }

    /// 1 on a camera's near plane, which may be oblique ([`Camera::near_plane`]), and less beyond it: no less than 0 in an image of so many pixels.
    pub fn of_camera(camera: &Camera, [width, height]: [u32; 2]) -> Self {
        let rays = camera.rays(width, height);
        let inverse = rays.corners(width, height).map(|ray| rays.near_plane.dot(ray));
        let most = inverse.into_iter().fold(0.0, f64::max);
        if most == 0.0 {
            return Self::reversed_infinite(camera.near);
        }
        let [top_left, top_right, right_low, left_low] = inverse.map(|of| of / most);
        let middle = 0.25 * (top_left + top_right + right_low + left_low);
        let tilt = [top_right - top_left, top_left - left_low].map(|by| (-0.5 * by) as f32);
        let [scale, offset] = [1.0 - middle, 1.0 / most].map(|c| c as f32);
        Self { scale, offset, w_scale: 1.0, w_offset: 0.0, tilt, image: None }
    }

    /// Of an orthographic camera's depth buffer, in its mapped world: 0 at the near distance and 1 at the far one of the camera that the view is of, reversed the other way
    /// round.
    pub fn orthographic(view: &OrthographicView, reversed: bool) -> Self {
        let [near, far] = view.inverse_depth;
        let [zero, one] = if reversed { [far, near] } else { [near, far] };
        let gain = one - zero;
        let [scale, offset] = [-zero / gain, 1.0 / gain].map(|c| c as f32);
        let tilt = view.inverse_tilt.map(|by| (-by / gain) as f32);
        let Lens { shift, mirrored, .. } = view.camera.lens;
        let image = Some(ImageTerms { focal: view.camera.focal(view.size).map(|c| c as f32), shift, mirrored });
        Self { scale, offset, w_scale: 1.0, w_offset: 0.0, tilt, image }
    }

    /// The view depth itself.
    pub fn linear() -> Self {
        Self { scale: 1.0, offset: 0.0, w_scale: 0.0, w_offset: 1.0, tilt: [0.0; 2], image: None }
    }

    /// Of a projection from view space, with the eye at the origin and the view along `-z` (right-handed) or `z`
    /// (left-handed), to clip space as wgpu has it, depth between 0 and 1. The viewport's depth range must be 0 to 1.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for what no [`Camera`] can say: as [`PerspectiveTerms::new`].
    pub fn of_projection(matrix: &[[f32; 4]; 4]) -> Result<Self> {
        let projection = PerspectiveTerms::new(matrix)?;
        let ([focal, shift], [a, b, c]) =
            ([projection.focal, projection.shift].map(|v| v.map(|c| c as f32)), projection.depth.map(|c| c as f32));
        let image = Some(ImageTerms { focal, shift, mirrored: projection.mirrors() });
        let tilt = projection.tilt.map(|by| by as f32);
        let terms = Self { scale: a, offset: b, w_scale: c, w_offset: 0.0, tilt, image };
        terms.check().map(|()| terms)
    }

    /// The projection of a camera for a depth buffer of these terms: from view space as [`Camera::view`] has it to clip space as wgpu has it.
    ///
    /// # Errors
    /// [`Error::Config`] for terms that no projection has, such as [`DepthTerms::linear`].
    pub fn projection(&self, camera: &Camera, size: [u32; 2]) -> Result<[[f32; 4]; 4]> {
        if self.w_offset != 0.0 || self.w_scale <= 0.0 {
            let (c, d) = (self.w_scale, self.w_offset);
            return Err(Error::Config(format!("depth terms: no projection divides by {c} z + {d}")));
        }
        let [x, y] = camera.focal(size).map(|c| c as f32 * self.w_scale);
        let Lens { shift, mirrored, .. } = camera.lens;
        let [right, up] = shift.map(|c| c * self.w_scale);
        let x = if mirrored { -x } else { x };
        let [by_x, by_y] = self.tilt.map(|c| c / self.w_scale);
        Ok([
            [x, 0.0, x * by_x, 0.0],
            [0.0, y, y * by_y, 0.0],
            [right, up, right * by_x + up * by_y - self.scale, -self.w_scale],
            [0.0, 0.0, self.offset, 0.0],
        ])
    }

    /// Whether an image of `camera` of so many pixels is that of the projection: no pixel lies off by more than a 64th, or by 10^-5
    /// of the image.
    pub(super) fn check_camera(&self, camera: &Camera, size: [u32; 2]) -> Result<()> {
        let Some(image) = self.image else { return Ok(()) };
        let wanted = camera.focal(size);
        let have = image.focal.map(f64::from);
        let bound = |k: usize| (1.0 / 32.0 / f64::from(size[k])).max(1e-5);
        let scaled = |k: usize| (have[k] / wanted[k] - 1.0).abs() <= bound(k);
        let moved = |k: usize| (image.shift[k] - camera.lens.shift[k]).abs() <= bound(k) as f32;
        let [width, height] = size;
        if !(scaled(0) && scaled(1)) {
            let ([x, y], [wx, wy]) = (have, wanted);
            let fov = camera.vertical_fov_degrees;
            return Err(Error::Config(format!(
                "depth terms: the projection scales x by {x} and y by {y}, the camera of {fov} degrees over {width}x{height} pixels by {wx:.7} and {wy:.7}"
            )));
        }
        if !(moved(0) && moved(1)) {
            let ([x, y], [wx, wy]) = (image.shift, camera.lens.shift);
            return Err(Error::Config(format!(
                "depth terms: the projection shifts its image by ({x}, {y}) halves, the camera by ({wx}, {wy})"
            )));
        }
        if image.mirrored != camera.lens.mirrored {
            let [projection, camera] =
                [image.mirrored, camera.lens.mirrored].map(|is| if is { "left" } else { "right" });
            return Err(Error::Config(format!(
                "depth terms: the projection is {projection}-handed, the camera {camera}-handed (mirrored)"
            )));
        }
        self.check_near_plane(camera, size)
    }

    /// Whether the oblique near plane of these terms, if they have one, is the camera's: inverse distances of both at the image's corners agree to a
    /// thousandth of the largest.
    fn check_near_plane(&self, camera: &Camera, [width, height]: [u32; 2]) -> Result<()> {
        if self.tilt == [0.0; 2] {
            return Ok(());
        }
        let [a, b, c] = [self.scale, self.offset, self.w_scale].map(f64::from);
        let [middle, right, top] = inverse_near([a, b, c], self.tilt.map(f64::from));
        let terms = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| middle + x * right + y * top);
        let rays = camera.rays(width, height);
        let ours = rays.corners(width, height).map(|ray| rays.near_plane.dot(ray));
        let most = terms.map(f64::abs).into_iter().fold(0.0, f64::max);
        let agree = |k: usize| (terms[k] - ours[k]).abs() <= 1e-3 * most;
        match (0..4).find(|&k| !agree(k)) {
            None => Ok(()),
            Some(k) => Err(Error::Config(format!(
                "depth terms: the projection has an oblique near plane, of inverse distance {:.6} in a corner of the image; the camera's has {:.6} there",
                terms[k], ours[k]
            ))),
        }
    }

    fn words(&self) -> [f32; 4] {
        [self.scale, self.offset, self.w_scale, self.w_offset]
    }

    /// The terms at the top left corner of an image of so many pixels, and what the first gains per pixel right and per pixel down.
    pub(super) fn over_image(&self, [width, height]: [u32; 2]) -> ([f32; 4], [f32; 2]) {
        let [right, up] = self.tilt;
        let [_, offset, w_scale, w_offset] = self.words();
        ([self.scale - right + up, offset, w_scale, w_offset], [2.0 * right / width as f32, -2.0 * up / height as f32])
    }

    pub(super) fn check(&self) -> Result<()> {
        let words = self.words().map(f64::from);
        let [a, b, c, d] = words;
        let all = words.iter().all(|w| w.is_finite()) && self.tilt.iter().all(|w| w.is_finite());
        if all && (a * d - b * c != 0.0 || self.tilt != [0.0; 2]) {
            return Ok(());
        }
        Err(Error::Config(format!("depth terms: ({a} z + {b}) / ({c} z + {d}) does not tell view depths apart")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat4;
    use glam::camera::{lh::proj::directx as lh, rh::proj::directx as rh};

    fn terms_of(matrix: Mat4) -> Result<DepthTerms> {
        DepthTerms::of_projection(&matrix.to_cols_array_2d())
    }

    fn value(t: DepthTerms, z: f32) -> f32 {
        (t.scale * z + t.offset) / (t.w_scale * z + t.w_offset)
    }

    #[test]
    fn terms_are_those_of_the_projections() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a}, {b}");
        for (terms, at_near, at_far) in [
            (DepthTerms::standard(0.5, 8.0), 0.0, 1.0),
            (DepthTerms::reversed(0.5, 8.0), 1.0, 0.0),
            (DepthTerms::infinite(0.5), 0.0, 1.0 - 0.5 / 8.0),
            (DepthTerms::reversed_infinite(0.5), 1.0, 0.5 / 8.0),
            (DepthTerms::linear(), 0.5, 8.0),
        ] {
            near(value(terms, 0.5), at_near);
            near(value(terms, 8.0), at_far);
        }
        // Depth and divisor of view-space z and 1, along -z and along z.
        let projection = |[zz, zw, wz]: [f32; 3]| {
            Mat4::from_cols_array_2d(&[
                [1.2, 0.0, 0.0, 0.0],
                [0.0, 1.8, 0.0, 0.0],
                [0.0, 0.0, zz, wz],
                [0.0, 0.0, zw, 0.0],
            ])
        };
        let far = 8.0 / 7.5;
        for (matrix, terms) in [
            (projection([-far, -0.5 * far, -1.0]), DepthTerms::standard(0.5, 8.0)),
            (projection([far, -0.5 * far, 1.0]), DepthTerms::standard(0.5, 8.0)),
            (projection([-1.0, -0.5, -1.0]), DepthTerms::infinite(0.5)),
            (projection([0.0, 0.5, -1.0]), DepthTerms::reversed_infinite(0.5)),
        ] {
            let of = terms_of(matrix).expect("a projection");
            [0.5, 1.0, 3.0, 8.0].iter().for_each(|&z| near(value(of, z), value(terms, z)));
        }
    }

    /// Terms of a projection go with the camera that it is of, and with none that puts a pixel elsewhere.
    #[test]
    fn terms_know_their_camera() {
        let camera = |fov: f32| Camera::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], fov, 0.1);
        let lefty = |camera: Camera| Camera { lens: Lens { mirrored: true, ..camera.lens }, ..camera };
        for size in [[1, 1], [320, 240], [1920, 1080], [16384, 16384], [16384, 1]] {
            let aspect = size[0] as f32 / size[1] as f32;
            for fov in [0.5f32, 40.0, 90.0, 170.0] {
                for left in [false, true] {
                    let project = if left { lh::perspective } else { rh::perspective };
                    let terms = terms_of(project(fov.to_radians(), aspect, 0.1, 10.0)).expect("a camera's");
                    let handed = |camera| if left { lefty(camera) } else { camera };
                    let own = handed(camera(fov));
                    terms.check_camera(&own, size).expect("the camera's own");
                    let refused = |camera: Camera, size| terms.check_camera(&camera, size).map_err(|e| e.to_string());
                    let other = if left { camera(fov) } else { lefty(camera(fov)) };
                    assert!(refused(other, size).is_err_and(|e| e.contains("handed")), "{fov} {size:?}");
                    // An eighth of a pixel at the image's edge.
                    let by = 1.0 + 0.25 / size[1].max(1000) as f64;
                    let other = (((f64::from(fov).to_radians() / 2.0).tan() * by).atan() * 2.0).to_degrees() as f32;
                    if size[1] > 100 {
                        assert!(
                            refused(handed(camera(other)), size)
                                .is_err_and(|e| e.contains(&format!("{other} degrees"))),
                            "{fov} {size:?}"
                        );
                        let moved = Lens { shift: [0.0, -0.25 / size[1] as f32], ..own.lens };
                        let moved = refused(Camera { lens: moved, ..own }, size);
                        assert!(moved.is_err_and(|e| e.contains("shifts")), "{fov} {size:?}");
                    }
                    let wider = [size[0] + 1 + size[0] / 8, size[1]];
                    assert!(refused(own, wider).is_err_and(|e| e.contains(&wider[0].to_string())), "{fov} {size:?}");
                }
            }
        }
        let blind = DepthTerms::reversed_infinite(0.1);
        blind.check_camera(&camera(10.0), [7, 5]).expect("nothing to compare with");
    }

    /// A camera behind an oblique near plane is that of its own matrices, and its depth goes with no other plane.
    #[test]
    fn oblique_near_planes_come_back() {
        let lens = Lens { shift: [0.3, -0.7], pixel_aspect: 1.5, mirrored: true };
        let plain = Camera::look_at([1.0, 2.0, 3.0], [0.0, 1.0, -1.0], [0.0, 1.0, 0.0], 50.0, 0.25);
        let size = [320, 200];
        for camera in [plain, Camera { lens, ..plain }] {
            for near_plane in
                [[-0.2, -0.3, -1.0, 0.5], [0.9, 0.1, -0.5, -1.0], [0.0, -2.0, 0.0, 3.0], [3.0, 0.0, 0.4, -5.0]]
            {
                let camera = Camera { near_plane: Some(near_plane), ..camera };
                camera.check().expect("the eye is hidden");
                let terms = DepthTerms::of_camera(&camera, size);
                let matrix = terms.projection(&camera, size).expect("a projection");
                let of = DepthTerms::of_projection(&matrix).expect("a camera's");
                let off = |a: f32, b: f32| (a - b).abs() > 1e-5 * (1.0 + b.abs());
                assert!(!off(of.scale, terms.scale) && !off(of.offset, terms.offset), "{of:?} {terms:?}");
                assert!((0..2).all(|k| !off(of.tilt[k], terms.tilt[k])), "{of:?} {terms:?}");
                of.check_camera(&camera, size).expect("the camera's own");
                let again = Camera::of_matrices(&camera.view(), &matrix, size).expect("a camera");
                of.check_camera(&again, size).expect("the camera's own");
                let [rays, theirs] = [camera, again].map(|c| c.rays(size[0], size[1]));
                for [x, y] in [[3.0, 190.0], [160.0, 100.0], [300.0, 20.0]] {
                    let ray = rays.direction(x, y);
                    let [begin, other] = [&rays, &theirs].map(|r| 1.0 / r.begin(ray));
                    assert!((begin - other).abs() < 1e-4 * begin.max(0.1), "{near_plane:?}: {begin} {other}");
                    // The depth of the near plane is 1.
                    if begin > 0.0 && begin < 1.0 / 0.25 {
                        let [ndc_x, ndc_y] = [x / 160.0 - 1.0, 1.0 - y / 100.0];
                        let scale = f64::from(terms.scale)
                            + ndc_x * f64::from(terms.tilt[0])
                            + ndc_y * f64::from(terms.tilt[1]);
                        let value = scale + f64::from(terms.offset) * begin;
                        assert!((value - 1.0).abs() < 1e-5, "{near_plane:?}: {value}");
                    }
                }
                let [a, b, c, d] = near_plane;
                for other in [None, Some([a, b, c, d * 1.1 - 0.1]), Some([a + 0.05, b, c, d])] {
                    let refused =
                        of.check_camera(&Camera { near_plane: other, ..camera }, size).map_err(|e| e.to_string());
                    assert!(refused.is_err_and(|e| e.contains("oblique near plane")), "{near_plane:?} {other:?}");
                }
                let seen =
                    Camera { near_plane: Some(near_plane.map(|c| -c)), ..camera }.check().map_err(|e| e.to_string());
                assert!(seen.is_err_and(|e| e.contains("hidden side")));
            }
        }
    }

    /// The projection of terms has these terms and the camera's image; terms of no projection are refused.
    #[test]
    fn terms_make_projections() {
        let lens = Lens { shift: [0.3, -0.7], pixel_aspect: 1.5, mirrored: true };
        let camera = Camera::look_at([1.0, 2.0, 3.0], [0.0, 1.0, -1.0], [0.0, 1.0, 0.0], 50.0, 0.25);
        let size = [320, 200];
        for camera in [camera, Camera { lens, ..camera }] {
            for terms in
                [DepthTerms::standard(0.25, 8.0), DepthTerms::reversed(0.25, 8.0), DepthTerms::reversed_infinite(0.25)]
            {
                let matrix = terms.projection(&camera, size).expect("a projection");
                let of = DepthTerms::of_projection(&matrix).expect("a camera's");
                of.check_camera(&camera, size).expect("the camera's own");
                assert_eq!(DepthTerms { image: None, ..of }, terms);
                let other = Lens { mirrored: !camera.lens.mirrored, ..camera.lens };
                assert!(of.check_camera(&Camera { lens: other, ..camera }, size).is_err());
            }
        }
        assert!(DepthTerms::linear().projection(&camera, size).is_err_and(|e| e.to_string().contains("0 z + 1")));
    }
}
