//! Surfaces that an application's pixels show, as its textures tell, and the checks of them.

use super::textures::{check_sampled, check_texture};
use crate::scene::Camera;
use crate::stages::gbuffer_triangles::GbufferTrianglesParams;
use crate::{Error, Result};
use glam::Mat4;
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
    /// Format `R32Uint`, usage `TEXTURE_BINDING`, two-dimensional, one sample, the size of the image. Its first level and
    /// layer are read.
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

    pub(super) fn check(&self, size: [u32; 2]) -> Result<()> {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        check_texture("triangle id", self.texture, &[TextureFormat::R32Uint], usage, size)
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

    pub(super) fn check(&self, size: [u32; 2], ours: &[[f32; 2]]) -> Result<()> {
        use TextureFormat::{R16Uint, R32Uint, Rg16Uint};
        self.params(ours)?;
        let (usage, given) = (wgpu::TextureUsages::TEXTURE_BINDING, self.places.len() as u32);
        let (formats, what, have): (&[_], _, _) = if self.is_multisampled() {
            (&[R32Uint, R16Uint, Rg16Uint], "samples", self.texture.sample_count())
        } else {
            (&[R32Uint], "layers", self.texture.depth_or_array_layers())
        };
        check_sampled("sample triangle id", self.texture, formats, usage, size, self.texture.sample_count())?;
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

    pub(super) fn check(&self, size: [u32; 2], camera: &Camera) -> Result<()> {
        use TextureFormat::{Depth32Float, R32Float, Rgba16Float, Rgba32Float};
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        match self.place {
            SurfacePosition::Depth { texture, terms, nothing } => {
                check_texture("depth", texture, &[Depth32Float, R32Float], usage, size)?;
                terms.check()?;
                terms.check_camera(camera, size)?;
                if !nothing.is_finite() {
                    return Err(Error::Config(format!("depth texture: {nothing} cannot stand for no surface")));
                }
            }
            SurfacePosition::Position(texture) => check_texture("position", texture, &[Rgba32Float], usage, size)?,
        }
        if let Some(normals) = self.normals {
            check_texture("normal", normals, &[Rgba16Float, Rgba32Float], usage, size)?;
        }
        if let Some(ids) = self.ids {
            ids.check(size)?;
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
/// `(scale * z + offset) / (w_scale * z + w_offset)`.
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
    /// Of a projection ([`DepthTerms::of_projection`]) by how much it scales x and y: [`ShadowPass::record`](super::ShadowPass::record)
    /// refuses a camera with another field of view or aspect. `None`: nobody looks.
    pub focal: Option<[f32; 2]>,
}

impl DepthTerms {
    /// 0 at `near`, 1 at `far`.
    pub fn standard(near: f32, far: f32) -> Self {
        let scale = far / (far - near);
        Self { scale, offset: -near * scale, w_scale: 1.0, w_offset: 0.0, focal: None }
    }

    /// 0 at `near`, 1 infinitely far.
    pub fn infinite(near: f32) -> Self {
        Self { scale: 1.0, offset: -near, w_scale: 1.0, w_offset: 0.0, focal: None }
    }

    /// 1 at `near`, 0 at `far`.
    pub fn reversed(near: f32, far: f32) -> Self {
        let scale = -near / (far - near);
        Self { scale, offset: -far * scale, w_scale: 1.0, w_offset: 0.0, focal: None }
    }

    /// 1 at `near`, 0 infinitely far.
    pub fn reversed_infinite(near: f32) -> Self {
        Self { scale: 0.0, offset: near, w_scale: 1.0, w_offset: 0.0, focal: None }
    }

    /// The view depth itself.
    pub fn linear() -> Self {
        Self { scale: 1.0, offset: 0.0, w_scale: 0.0, w_offset: 1.0, focal: None }
    }

    /// Of a projection from view space, with the eye at the origin and the view along `-z` (right-handed) or `z`
    /// (left-handed), to clip space as wgpu has it, depth between 0 and 1. The viewport's depth range must be 0 to 1.
    ///
    /// # Errors
    /// [`Error::Config`], with the numbers, for what no [`Camera`] can say: a projection that is orthographic, off-centre or jittered,
    /// turned, sheared or mirrored, or seen from elsewhere than the origin; and where depth depends on more than view depth.
    pub fn of_projection(projection: Mat4) -> Result<Self> {
        let refuse = |why: String| Err(Error::Config(format!("depth terms: {why}")));
        let [x, y, z, w] = [0, 1, 2, 3].map(|row| projection.row(row));
        if !projection.is_finite() {
            return refuse(format!("the projection {projection} is not finite"));
        }
        if z.x != 0.0 || z.y != 0.0 || w.x != 0.0 || w.y != 0.0 {
            return refuse(format!("rows {z} and {w} of the projection depend on x or y"));
        }
        if w.z == 0.0 {
            return refuse(format!("row {w} of the projection is not of a perspective one"));
        }
        // What lies ahead has a positive divisor.
        let ahead = if w.z < 0.0 { -1.0 } else { 1.0 };
        if x.z != 0.0 || y.z != 0.0 {
            let [x, y] = [x.z, y.z].map(|c| c / w.z);
            return refuse(format!(
                "the projection is off-centre or jittered: its image is shifted by ({x}, {y}) of 2"
            ));
        }
        if x.w != 0.0 || y.w != 0.0 || w.w != 0.0 {
            return refuse(format!(
                "the projection's eye is not the origin: it adds ({}, {}) and divides by {}",
                x.w, y.w, w.w
            ));
        }
        if x.y != 0.0 || y.x != 0.0 {
            return refuse(format!(
                "the projection is turned or sheared: rows ({}, {}) and ({}, {})",
                x.x, x.y, y.x, y.y
            ));
        }
        let focal = [x.x, y.y].map(|c| c / w.z.abs());
        if focal.iter().any(|&c| c <= 0.0) {
            return refuse(format!(
                "the projection is flat or mirrored: it scales x by {} and y by {}",
                focal[0], focal[1]
            ));
        }
        let terms = Self { scale: z.z * ahead, offset: z.w, w_scale: w.z * ahead, w_offset: w.w, focal: Some(focal) };
        terms.check().map(|()| terms)
    }

    /// Whether an image of `camera` of so many pixels is that of the projection: no pixel lies off by more than a 64th, or by 10^-5
    /// of the image.
    fn check_camera(&self, camera: &Camera, size: [u32; 2]) -> Result<()> {
        let Some(focal) = self.focal else { return Ok(()) };
        let [width, height] = size.map(f64::from);
        let of_height = 1.0 / (f64::from(camera.vertical_fov_degrees).to_radians() * 0.5).tan();
        let wanted = [of_height * height / width, of_height];
        let have = focal.map(f64::from);
        let off = |k: usize| (have[k] / wanted[k] - 1.0).abs();
        let bound = |side: f64| (1.0 / 32.0 / side).max(1e-5);
        if off(0) <= bound(width) && off(1) <= bound(height) {
            return Ok(());
        }
        let ([x, y], [wx, wy]) = (have, wanted);
        let fov = camera.vertical_fov_degrees;
        Err(Error::Config(format!(
            "depth terms: the projection scales x by {x} and y by {y}, the camera of {fov} degrees over {width}x{height} pixels by {wx:.7} and {wy:.7}"
        )))
    }

    pub(super) fn words(&self) -> [f32; 4] {
        [self.scale, self.offset, self.w_scale, self.w_offset]
    }

    fn check(&self) -> Result<()> {
        let words = self.words().map(f64::from);
        let [a, b, c, d] = words;
        if words.iter().all(|w| w.is_finite()) && a * d - b * c != 0.0 {
            return Ok(());
        }
        Err(Error::Config(format!("depth terms: ({a} z + {b}) / ({c} z + {d}) does not tell view depths apart")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::camera::{lh::proj::directx as lh, rh::proj::directx as rh};

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
            let of = DepthTerms::of_projection(matrix).expect("a projection");
            [0.5, 1.0, 3.0, 8.0].iter().for_each(|&z| near(value(of, z), value(terms, z)));
        }
        assert!(DepthTerms::of_projection(Mat4::ZERO).is_err());
        assert!(DepthTerms::of_projection(Mat4::from_rotation_x(0.1)).is_err());
        let orthographic = Mat4::from_diagonal(glam::Vec4::new(1.2, 1.8, -1.0 / 7.5, 1.0));
        assert!(DepthTerms::of_projection(orthographic).is_err());
    }

    /// Everything that a camera cannot say is refused, with the numbers.
    #[test]
    fn projections_of_no_camera_are_refused() {
        let sound = rh::perspective_infinite_reverse(0.9, 4.0 / 3.0, 0.1);
        assert!(DepthTerms::of_projection(sound).is_ok());
        for at_w in [-1.0, 1.0] {
            let with = |column: usize, row: usize, value: f32| {
                let mut m = rh::perspective_infinite_reverse(0.9, 4.0 / 3.0, 0.1);
                m.z_axis.w = at_w;
                m.col_mut(column)[row] = value;
                DepthTerms::of_projection(m).map_err(|e| e.to_string())
            };
            assert!(with(2, 3, at_w).is_ok());
            for (column, row, value, numbers) in [
                (2, 0, 0.25 / 320.0, "0.00078125"),
                (2, 1, -0.3, "0.3"),
                (3, 0, 0.5, "adds (0.5, 0)"),
                (3, 1, 0.125, "adds (0, 0.125)"),
                (3, 3, 0.75, "divides by 0.75"),
                (1, 0, 0.0625, "0.0625"),
                (0, 1, 0.03125, "0.03125"),
                (0, 2, 0.5, "0.5"),
                (1, 3, 0.5, "0.5"),
                (0, 0, -1.5, "x by -1.5"),
                (1, 1, 0.0, "y by 0"),
                (1, 1, f32::NAN, "NaN"),
                (2, 3, 0.0, "not of a perspective one"),
            ] {
                let got = with(column, row, value);
                assert!(got.as_ref().is_err_and(|e| e.contains(numbers)), "{column} {row} {value}: {got:?}");
            }
        }
        for m in [
            rh::frustum(-0.1, 0.2, -0.1, 0.1, 0.1, 10.0),
            rh::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0),
            rh::perspective(0.9, 1.5, 0.1, 10.0) * Mat4::from_rotation_z(0.1),
            Mat4::from_translation(glam::Vec3::new(0.001, 0.0, 0.0)) * sound,
        ] {
            assert!(DepthTerms::of_projection(m).is_err(), "{m}");
        }
    }

    /// Terms of a projection go with the camera that it is of, and with none that puts a pixel elsewhere.
    #[test]
    fn terms_know_their_camera() {
        let camera = |vertical_fov_degrees: f32| Camera {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees,
            near: 0.1,
            far: 10.0,
        };
        for size in [[1, 1], [320, 240], [1920, 1080], [16384, 16384], [16384, 1]] {
            let aspect = size[0] as f32 / size[1] as f32;
            for fov in [0.5f32, 40.0, 90.0, 170.0] {
                for m in [rh::perspective, lh::perspective] {
                    let terms = DepthTerms::of_projection(m(fov.to_radians(), aspect, 0.1, 10.0)).expect("a camera's");
                    terms.check_camera(&camera(fov), size).expect("the camera's own");
                    let refused = |fov: f32, size| terms.check_camera(&camera(fov), size).map_err(|e| e.to_string());
                    // An eighth of a pixel at the image's edge.
                    let by = 1.0 + 0.25 / size[1].max(1000) as f64;
                    let other = (((f64::from(fov).to_radians() / 2.0).tan() * by).atan() * 2.0).to_degrees() as f32;
                    if size[1] > 100 {
                        assert!(
                            refused(other, size).is_err_and(|e| e.contains(&format!("{other} degrees"))),
                            "{fov} {size:?}"
                        );
                    }
                    let wider = [size[0] + 1 + size[0] / 8, size[1]];
                    assert!(refused(fov, wider).is_err_and(|e| e.contains(&wider[0].to_string())), "{fov} {size:?}");
                }
            }
        }
        let blind = DepthTerms::reversed_infinite(0.1);
        blind.check_camera(&camera(10.0), [7, 5]).expect("nothing to compare with");
    }
}
