//! Surfaces that an application's pixels show, as its textures tell, and the checks of them.

use super::textures::{ImagePart, check_sampled, check_texture};
use crate::scene::{Camera, Lens, PerspectiveTerms, inverse_near};
use crate::stages::gbuffer_triangles::GbufferTrianglesParams;
use crate::{Error, Result};
use wgpu::TextureFormat;

/// Surfaces that the application's pixels show, as far as it knows them.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub enum GBuffer<'a> {
    /// Nothing: the pass finds the nearest triangle of the casters, at each pixel centre or for each sample.
    #[default]
    None,
    /// The triangle at each pixel centre. One facet a pixel, as without a G-buffer: for the same triangles the same bits.
    TriangleIds(TriangleTexture<'a>),
    /// Where the surface at each pixel centre is, be it a caster's or not. One facet a pixel.
    Surfaces(SurfaceTextures<'a>),
    /// The triangles at several places of each pixel. A facet for every surface that one of them shows.
    SampleIds(SampleTexture<'a>),
}

/// A texture of triangle numbers.
#[derive(Clone, Copy, Debug)]
pub struct TriangleTexture<'a> {
    /// Format `R32Uint`, usage `TEXTURE_BINDING`, two-dimensional, one sample. Its first level and layer are read.
    pub texture: &'a wgpu::Texture,
    /// The number of the first triangle; the others follow in the order in which they were given to the pass.
    pub first: u32,
    /// The number for no triangle of the casters: visibility 1 there, if nothing else says that a surface is seen.
    pub none: u32,
}

impl<'a> TriangleTexture<'a> {
    /// Triangles counted from 0; `u32::MAX` where there is none.
    pub fn new(texture: &'a wgpu::Texture) -> Self {
        Self { texture, first: 0, none: u32::MAX }
    }

    pub(super) fn check(&self, part: ImagePart) -> Result<()> {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        check_texture("triangle id", self.texture, &[TextureFormat::R32Uint], usage, part)
    }
}

/// Triangle numbers at several places of each pixel, for a pass with [`FacetMode::All`](crate::methods::FacetMode::All).
///
/// Each sample of the picture sees the nearest of the triangles that its pixel's G-buffer samples show and that it lies in; one
/// that lies in none of them takes what the nearest G-buffer sample shows, if anything, on that triangle's plane.
///
/// **Error.** A surface that none of the pixel's G-buffer samples shows is missing: `data/reports/gbuffer.md` says how often.
/// With the samples of the picture themselves nothing is, and the picture is that of the pass without a G-buffer, bit for bit.
#[derive(Clone, Copy, Debug)]
pub struct SampleTexture<'a> {
    /// Two-dimensional, the size of the image, usage `TEXTURE_BINDING`; the first level is read. Either of one sample and as many
    /// layers as there are `places`, format `R32Uint`; or multisampled, of as many samples, format `R32Uint` (where the device
    /// can), `R16Uint`, or `Rg16Uint` with the low half of a number in red and the high half in green.
    pub texture: &'a wgpu::Texture,
    /// Where in the pixel each sample lies: `[0, 1)`, x to the right, y down; 1 to 128 of them.
    pub places: &'a [[f32; 2]],
    /// The number of the first triangle; the others follow in the order in which they were given to the pass.
    pub first: u32,
    /// The number for no triangle.
    pub none: u32,
}

impl<'a> SampleTexture<'a> {
    /// Where the samples of a multisampled texture of four lie on nearly all devices (the standard pattern of Vulkan, Direct3D
    /// and Metal).
    pub const STANDARD_4: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];

    /// Triangles counted from 0; `u32::MAX` where there is none.
    pub fn new(texture: &'a wgpu::Texture, places: &'a [[f32; 2]]) -> Self {
        Self { texture, places, first: 0, none: u32::MAX }
    }

    /// Whether it is a multisampled texture.
    pub(super) fn is_multisampled(&self) -> bool {
        self.texture.sample_count() > 1
    }

    /// Parameters of the stage, for a picture with samples at `ours`.
    pub(super) fn params(&self, ours: &[[f32; 2]]) -> Result<GbufferTrianglesParams> {
        GbufferTrianglesParams::new(ours, self.places, self.first, self.none)
    }

    pub(super) fn check(&self, part: ImagePart, ours: &[[f32; 2]]) -> Result<()> {
        use TextureFormat::{R16Uint, R32Uint, Rg16Uint};
        self.params(ours)?;
        let (usage, given) = (wgpu::TextureUsages::TEXTURE_BINDING, self.places.len() as u32);
        let (formats, what, have): (&[_], _, _) = if self.is_multisampled() {
            (&[R32Uint, R16Uint, Rg16Uint], "samples", self.texture.sample_count())
        } else {
            (&[R32Uint], "layers", self.texture.depth_or_array_layers())
        };
        check_sampled("sample triangle id", self.texture, formats, usage, part, (0, self.texture.sample_count()))?;
        if have != given {
            return Err(Error::Config(format!("sample triangle id texture: {have} {what}, {given} places are given")));
        }
        Ok(())
    }
}

/// Textures of the surface at each pixel centre: two-dimensional, one sample, the size of the image, usage
/// `TEXTURE_BINDING`; the first level and layer are read. The pass must have been made with
/// [`PassConfig::receivers`](super::PassConfig::receivers).
///
/// A pixel that shows a caster takes that caster's triangle, so that no surface shadows itself and no bias is needed. Which
/// pixels do is said by `ids`. Without them it is found by comparing the given place with the casters that the pass itself
/// sees at the pixel centre and, where two rasterizers may differ by a rounding, at the pixels around it. So the application
/// must draw every caster that may hide another from its camera, or give numbers: what is taken for no caster, but lies on
/// one, is in its shadow here and there. All other surfaces receive shadows and cast none.
///
/// **Error.** One plane represents the whole pixel, as with all G-buffers of one sample. A surface that casts nothing is as
/// exact as its place and normal; reconstructed normals are off at creases, and a surface without another pixel of its kind near
/// in its row or column is taken to face the eye. A caster that lies in the plane of such a surface shadows it or not by the
/// rounding of its place.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTextures<'a> {
    /// Where the surfaces are.
    pub place: SurfacePosition<'a>,
    /// Their geometric normals, world space, any length but 0, of either side; `Rgba16Float` or `Rgba32Float`, alpha is not
    /// read. `None`: reconstructed from the nearest pixels in its row and column that show no caster, of two
    /// the one whose depth differs less.
    pub normals: Option<&'a wgpu::Texture>,
    /// Which pixels show casters: the rest show something else, or nothing. `None`: found out.
    pub ids: Option<TriangleTexture<'a>>,
    /// Without `ids`: how far from the plane of a caster its surface may be said to be, as a share of its view depth. It is
    /// no bias: it only says which pixels show a caster. [`SurfaceTextures::TOLERANCE`] is above what a depth buffer of 32
    /// bits loses if it is reversed or a position texture, and a tenth of a pixel of most cameras. A surface that is no caster
    /// but nearer than this to one that would be seen there takes the caster's shadow.
    pub tolerance: f32,
}

impl<'a> SurfaceTextures<'a> {
    /// The tolerance of [`SurfaceTextures::new`]: 10^-4.
    pub const TOLERANCE: f32 = 1e-4;

    /// Surfaces by their place alone.
    pub fn new(place: SurfacePosition<'a>) -> Self {
        Self { place, normals: None, ids: None, tolerance: Self::TOLERANCE }
    }

    pub(super) fn check(&self, part: ImagePart, camera: &Camera) -> Result<()> {
        use TextureFormat::{Depth32Float, R32Float, Rgba16Float, Rgba32Float};
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        match self.place {
            SurfacePosition::Depth { texture, terms, nothing } => {
                check_texture("depth", texture, &[Depth32Float, R32Float], usage, part)?;
                terms.check()?;
                terms.check_camera(camera, part.size)?;
                if !nothing.is_finite() {
                    return Err(Error::Config(format!("depth texture: {nothing} cannot stand for no surface")));
                }
            }
            SurfacePosition::Position(texture) => check_texture("position", texture, &[Rgba32Float], usage, part)?,
        }
        if let Some(normals) = self.normals {
            check_texture("normal", normals, &[Rgba16Float, Rgba32Float], usage, part)?;
        }
        if let Some(ids) = self.ids {
            ids.check(part)?;
        }
        if !(self.tolerance >= 0.0 && self.tolerance < 1.0) {
            return Err(Error::Config(format!("a tolerance of {} view depths is not in [0, 1)", self.tolerance)));
        }
        Ok(())
    }
}

/// Where surfaces are.
#[derive(Clone, Copy, Debug)]
pub enum SurfacePosition<'a> {
    /// A depth buffer, of any convention, of the frame's camera.
    Depth {
        /// `Depth32Float` (its depth aspect alone) or `R32Float`.
        texture: &'a wgpu::Texture,
        /// Terms of its values.
        terms: DepthTerms,
        /// The exact value for no surface: the one that the application clears it to. Visibility is 1 there.
        nothing: f32,
    },
    /// World positions, `Rgba32Float`; alpha 0 means no surface.
    Position(&'a wgpu::Texture),
}

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
    fn check_camera(&self, camera: &Camera, size: [u32; 2]) -> Result<()> {
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

    fn check(&self) -> Result<()> {
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
