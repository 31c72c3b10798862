//! What an application knows of the surfaces that its pixels show, and the checks of it.

use super::textures::{check_sampled, check_texture};
use crate::stages::gbuffer_triangles::Params;
use crate::{Error, Result};
use glam::Mat4;
use wgpu::TextureFormat;

/// What the application knows of the surfaces that its pixels show.
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
    /// What stands for no triangle of the casters: visibility 1 there, if nothing else says that a surface is seen.
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
    /// What stands for no triangle.
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

    /// What the stage is told, for a picture with samples at `ours`.
    pub(super) fn params(&self, ours: &[[f32; 2]]) -> Result<Params> {
        Params::new(ours, self.places, self.first, self.none)
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
/// **Error.** One plane stands for the whole pixel, as with all G-buffers of one sample. A surface that casts nothing is as
/// exact as its place and normal; reconstructed normals are off at creases, and a surface without another pixel of its kind near
/// in its row or column is taken to face the eye. A caster that lies in the plane of such a surface shadows it or not by the
/// rounding of its place.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTextures<'a> {
    /// Where the surfaces are.
    pub place: Place<'a>,
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
    pub fn new(place: Place<'a>) -> Self {
        Self { place, normals: None, ids: None, tolerance: Self::TOLERANCE }
    }

    pub(super) fn check(&self, size: [u32; 2]) -> Result<()> {
        use TextureFormat::{Depth32Float, R32Float, Rgba16Float, Rgba32Float};
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        match self.place {
            Place::Depth { texture, terms, nothing } => {
                check_texture("depth", texture, &[Depth32Float, R32Float], usage, size)?;
                terms.check()?;
                if !nothing.is_finite() {
                    return Err(Error::Config(format!("depth texture: {nothing} cannot stand for no surface")));
                }
            }
            Place::Position(texture) => check_texture("position", texture, &[Rgba32Float], usage, size)?,
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
pub enum Place<'a> {
    /// A depth buffer, of any convention, of the frame's camera.
    Depth {
        /// `Depth32Float` (its depth aspect alone) or `R32Float`.
        texture: &'a wgpu::Texture,
        /// What its values mean.
        terms: DepthTerms,
        /// The value that stands for no surface, exactly: what the application clears it to. Visibility is 1 there.
        nothing: f32,
    },
    /// World positions, `Rgba32Float`; alpha 0 stands for no surface.
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
}

impl DepthTerms {
    /// 0 at `near`, 1 at `far`.
    pub fn standard(near: f32, far: f32) -> Self {
        let scale = far / (far - near);
        Self { scale, offset: -near * scale, w_scale: 1.0, w_offset: 0.0 }
    }

    /// 0 at `near`, 1 infinitely far.
    pub fn infinite(near: f32) -> Self {
        Self { scale: 1.0, offset: -near, w_scale: 1.0, w_offset: 0.0 }
    }

    /// 1 at `near`, 0 at `far`.
    pub fn reversed(near: f32, far: f32) -> Self {
        let scale = -near / (far - near);
        Self { scale, offset: -far * scale, w_scale: 1.0, w_offset: 0.0 }
    }

    /// 1 at `near`, 0 infinitely far.
    pub fn reversed_infinite(near: f32) -> Self {
        Self { scale: 0.0, offset: near, w_scale: 1.0, w_offset: 0.0 }
    }

    /// The view depth itself.
    pub fn linear() -> Self {
        Self { scale: 1.0, offset: 0.0, w_scale: 0.0, w_offset: 1.0 }
    }

    /// Of a projection from view space, with the eye at the origin and the view along `-z` (right-handed) or `z`
    /// (left-handed), to clip space as wgpu has it, depth between 0 and 1. The viewport's depth range must be 0 to 1.
    ///
    /// # Errors
    /// [`Error::Config`] if depth depends on more than view depth, or the projection is orthographic: the cameras here are not.
    pub fn of_projection(projection: Mat4) -> Result<Self> {
        let (z, w) = (projection.row(2), projection.row(3));
        if z.x != 0.0 || z.y != 0.0 || w.x != 0.0 || w.y != 0.0 {
            return Err(Error::Config(format!("depth terms: rows {z} and {w} of the projection depend on x or y")));
        }
        if w.z == 0.0 {
            return Err(Error::Config(format!("depth terms: row {w} of the projection is not of a perspective one")));
        }
        // What lies ahead has a positive divisor.
        let ahead = if w.z < 0.0 { -1.0 } else { 1.0 };
        let terms = Self { scale: z.z * ahead, offset: z.w, w_scale: w.z * ahead, w_offset: w.w };
        terms.check().map(|()| terms)
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
}
