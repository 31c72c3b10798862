//! Surfaces that an application's pixels show, as its textures tell, and the checks of them.

use super::depth_terms::DepthTerms;
use super::textures::{ImagePart, check_sampled, check_texture};
use crate::scene::Camera;
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
    /// Where the surface at each pixel centre is, be it a caster's or not. With one facet a pixel it stands for the pixel; with one for every surface the
    /// pass finds the casters that samples see itself, and what is no caster is seen beside and behind them.
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

/// Textures of the surface at each pixel centre: two-dimensional, the size of the image, usage `TEXTURE_BINDING`; the first level and layer are
/// read. With a facet for every surface depths may be multisampled, and normals beside them: those at the sample nearest to the centre are taken, where
/// that sample lies ([`SurfaceTextures::places`]). All other textures have one sample. The pass must have been made with
/// [`PassConfig::receivers`](super::PassConfig::receivers).
///
/// A pixel that shows a caster takes that caster's triangle, so that no surface shadows itself and no bias is needed. Which
/// pixels do is said by `ids`. Without them it is found by comparing the given place with the caster that the pass itself
/// sees at the pixel centre, and then with all that lie there. All other surfaces receive shadows and cast none.
///
/// **Error.** With [`FacetMode::One`](crate::methods::FacetMode::One) one plane represents the whole pixel. With
/// [`FacetMode::All`](crate::methods::FacetMode::All) every sample sees the casters that the pass itself finds there, without error. Of what casts nothing
/// one place a pixel is known, so its own outline is right to a pixel:
///
/// - A pixel whose centre shows it has its plane at all samples, before and behind casters.
/// - A pixel whose centre shows a caster has it where casters leave samples free: that of the nearest pixel, up to two away, whose plane does not run
///   before what is seen there. Where it would hide a part of that caster it is not seen, and where one caster covers the pixel nothing is looked for.
/// - A pixel whose centre shows nothing, or what is unusable, has none.
///
/// Numbers must name the casters that the pass sees there; a pixel in which it finds none keeps the one that they name. Casters that the camera does not
/// see ([`Roles::UNSEEN`](crate::scene::Roles::UNSEEN)) and that lie on surfaces that it does shadow these here and there.
///
/// A surface that casts nothing is as exact as its place and normal; reconstructed normals are off at creases, and a surface without another pixel of its kind near
/// in its row or column is taken to face the eye. A caster that lies in the plane of such a surface shadows it or not by the
/// rounding of its place.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTextures<'a> {
    /// Where the surfaces are.
    pub place: SurfacePosition<'a>,
    /// Their geometric normals, world space, any length but 0, of either side; `Rgba16Float` or `Rgba32Float`, alpha is not
    /// read. With multisampled depths those of each sample, or one a pixel, that of the surface which the sample nearest to the centre shows. `None`: reconstructed from the nearest pixels in its row and column that show no caster, of two
    /// the one whose depth differs less.
    pub normals: Option<&'a wgpu::Texture>,
    /// Which pixels show casters: the rest show something else, or nothing. `None`: found out.
    pub ids: Option<TriangleTexture<'a>>,
    /// Where in the pixel the samples of multisampled textures lie, `[0, 1)`, x to the right, y down, as many as they have: 2 to 16.
    pub places: &'a [[f32; 2]],
    /// How far from the plane of a caster its surface may be said to be, as a share of its view depth; of positions the rounding of their coordinates
    /// is added. It is no bias: it says which pixels show a caster, where there are no `ids`, and with a facet for every surface which planes are one, and which
    /// of two is before the other. [`SurfaceTextures::TOLERANCE`] is above what a depth buffer of 32
    /// bits loses if it is reversed, and a tenth of a pixel of most cameras. A surface that is no caster
    /// but nearer than this to one that lies there takes the caster's shadow.
    pub tolerance: f32,
}

impl<'a> SurfaceTextures<'a> {
    /// The tolerance of [`SurfaceTextures::new`]: 10^-4.
    pub const TOLERANCE: f32 = 1e-4;

    /// Surfaces by their place alone.
    pub fn new(place: SurfacePosition<'a>) -> Self {
        let places = &SampleTexture::STANDARD_4;
        Self { place, normals: None, ids: None, places, tolerance: Self::TOLERANCE }
    }

    pub(super) fn check(&self, part: ImagePart, camera: &Camera) -> Result<()> {
        use TextureFormat::{Depth32Float, R32Float, Rgba16Float, Rgba32Float};
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        match self.place {
            SurfacePosition::Depth { texture, terms, nothing } => {
                let formats = &[Depth32Float, R32Float];
                check_sampled("depth", texture, formats, usage, part, (0, texture.sample_count()))?;
                terms.check()?;
                terms.check_camera(camera, part.size)?;
                if !nothing.is_finite() {
                    return Err(Error::Config(format!("depth texture: {nothing} cannot stand for no surface")));
                }
            }
            SurfacePosition::Position(texture) => check_texture("position", texture, &[Rgba32Float], usage, part)?,
        }
        if let Some(normals) = self.normals {
            let samples = if normals.sample_count() > 1 { self.samples() } else { 1 };
            check_sampled("normal", normals, &[Rgba16Float, Rgba32Float], usage, part, (0, samples))?;
        }
        if let Some(ids) = self.ids {
            ids.check(part)?;
        }
        self.check_places()?;
        if !(self.tolerance >= 0.0 && self.tolerance < 1.0) {
            return Err(Error::Config(format!("a tolerance of {} view depths is not in [0, 1)", self.tolerance)));
        }
        Ok(())
    }
}

impl SurfaceTextures<'_> {
    /// Samples of a depth.
    pub(super) fn samples(&self) -> u32 {
        match self.place {
            SurfacePosition::Depth { texture, .. } => texture.sample_count(),
            SurfacePosition::Position(_) => 1,
        }
    }

    /// Checks where samples lie, if there are several.
    fn check_places(&self) -> Result<()> {
        let (samples, given) = (self.samples(), self.places.len());
        if samples == 1 {
            return Ok(());
        }
        if given != samples as usize {
            return Err(Error::Config(format!("depth texture: {samples} samples, {given} places are given")));
        }
        if let Some((k, p)) = (0..).zip(self.places).find(|(_, p)| !p.iter().all(|v| (0.0..1.0).contains(v))) {
            let [x, y] = p;
            return Err(Error::Config(format!(
                "sample {k} of the depth texture is at ({x}, {y}), not in its pixel, [0, 1)"
            )));
        }
        if self.ids.is_some() {
            let text = "triangle numbers of one sample beside multisampled depths: they may show another surface";
            return Err(Error::Config(text.to_owned()));
        }
        Ok(())
    }
}

/// Where surfaces are.
#[derive(Clone, Copy, Debug)]
pub enum SurfacePosition<'a> {
    /// A depth buffer, of any convention, of the frame's camera.
    Depth {
        /// `Depth32Float` (its depth aspect alone) or `R32Float`, of one or several samples.
        texture: &'a wgpu::Texture,
        /// Terms of its values.
        terms: DepthTerms,
        /// The exact value for no surface: the one that the application clears it to. Visibility is 1 there.
        nothing: f32,
    },
    /// World positions, `Rgba32Float`; alpha 0 means no surface.
    Position(&'a wgpu::Texture),
}
