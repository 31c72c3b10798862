//! Inputs that an application hands to the pass, and the checks of them.

use super::textures::{ImagePart, check_sampled};
use super::{GBuffer, ListedTarget, UploadedCasters};
use crate::methods::Prepared;
use crate::scene::{AlphaTested, Camera, Homography, Light, OrthographicView};
use crate::stages::caster_positions::Vertices;
use crate::stages::instance_positions::Transforms;
use crate::stages::pixel_counts::PixelCounts;
use crate::stages::visibility_texture::Packing;
use crate::{Error, Result};

/// The triangles that cast and receive shadows: topology is given once.
#[derive(Clone, Copy, Debug)]
pub enum Casters<'a> {
    /// At rest and known to the CPU; uploaded once.
    Static {
        /// Positions, world units.
        positions: &'a [[f32; 3]],
        /// Vertex indices of each triangle.
        triangles: &'a [[u32; 3]],
    },
    /// At rest, prepared already, with or without alpha: what several passes of one mesh share is found once. Triangles have the numbers of the
    /// mesh that was prepared.
    Prepared(&'a Prepared),
    /// At rest, prepared and uploaded already ([`CasterUpload`](super::CasterUpload)): passes share the memory, and one more takes none of its own.
    /// Triangles as with `Prepared`.
    Uploaded(&'a UploadedCasters),
    /// In a vertex buffer that the application rewrites: each frame brings it as [`Moved`].
    Moving {
        /// One pose. Vertices at one point of it are taken as one and must stay at one point (each frame says whether they
        /// did), so that a seam of doubled vertices is no boundary. No position is used besides.
        rest: &'a [[f32; 3]],
        /// Vertex indices of each triangle.
        triangles: &'a [[u32; 3]],
    },
    /// Meshes in as many places as there are instances, each by a transform that the application may rewrite: each frame brings them as
    /// [`Placed`]. Triangles are numbered instance by instance, as those of its mesh.
    Instanced {
        /// The meshes.
        meshes: &'a [CasterMesh<'a>],
        /// The mesh of each instance.
        instances: &'a [u32],
    },
    /// Any of these together: parts that stand, move, or are instances. Each frame says where those are that do not stand
    /// ([`Inputs::parts`]), and any part is [added](crate::ShadowPass::add_part) and [removed](crate::ShadowPass::remove_part) by itself. What stands is
    /// prepared and written once. The light's views hold the box of each part. Triangles have the numbers that
    /// [`part_triangles`](crate::ShadowPass::part_triangles) tells, those of the first parts one after the other.
    Parts {
        /// The first parts, whose numbers are 0, 1, ….
        parts: &'a [CasterPart<'a>],
        /// Triangles of parts to come that memory is made for at once: as many vertices and twice as many edges. Of more than there is room for, all memory is
        /// made anew, for twice as many.
        room: usize,
    },
    /// Casters of one mesh, of which some triangles are alpha-tested.
    AlphaTested {
        /// The casters: those that stand or move by a vertex buffer. Of instances the [meshes](CasterMesh::alpha) say it.
        casters: &'a Casters<'a>,
        /// Which of their triangles have holes, and where. Texture coordinates do not change.
        tested: &'a AlphaTested,
    },
}

impl Casters<'_> {
    /// Whether some triangles are alpha-tested.
    pub fn are_tested(&self) -> bool {
        match self {
            Casters::Static { .. } | Casters::Moving { .. } => false,
            Casters::Prepared(prepared) => !prepared.alpha().is_empty(),
            Casters::Uploaded(uploaded) => !uploaded.prepared.alpha().is_empty(),
            Casters::Instanced { meshes, .. } => meshes.iter().any(CasterMesh::is_tested),
            Casters::Parts { parts, .. } => parts.iter().any(|part| part.mesh.is_tested()),
            Casters::AlphaTested { tested, .. } => !tested.is_empty(),
        }
    }
}

/// A mesh of instances.
#[derive(Clone, Copy, Debug)]
pub struct CasterMesh<'a> {
    /// Positions before any transform.
    pub positions: &'a [[f32; 3]],
    /// Vertex indices of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Its triangles that are alpha-tested.
    pub alpha: Option<&'a AlphaTested>,
}

impl<'a> CasterMesh<'a> {
    /// A mesh without holes.
    pub fn new(positions: &'a [[f32; 3]], triangles: &'a [[u32; 3]]) -> Self {
        Self { positions, triangles, alpha: None }
    }

    fn is_tested(&self) -> bool {
        self.alpha.is_some_and(|alpha| !alpha.is_empty())
    }
}

/// A part of the casters.
#[derive(Clone, Copy, Debug)]
pub struct CasterPart<'a> {
    /// Its mesh, of one that moves by a vertex buffer in some pose: see [`Casters::Moving`].
    pub mesh: CasterMesh<'a>,
    /// Whether it moves.
    pub kind: PartKind,
}

/// Whether a part of the casters moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// It is where its mesh is.
    Standing,
    /// Each frame has its vertices in a buffer: [`PartAt::Moved`].
    Moving,
    /// So many instances of its mesh, numbered one after the other; each frame has their transforms: [`PartAt::Placed`].
    Instances(u32),
}

impl<'a> CasterPart<'a> {
    /// A mesh that stands.
    pub fn standing(mesh: CasterMesh<'a>) -> Self {
        Self { mesh, kind: PartKind::Standing }
    }

    /// A mesh whose vertices the application rewrites.
    pub fn moving(rest: CasterMesh<'a>) -> Self {
        Self { mesh: rest, kind: PartKind::Moving }
    }

    /// So many instances of a mesh.
    pub fn instances(mesh: CasterMesh<'a>, count: u32) -> Self {
        Self { mesh, kind: PartKind::Instances(count) }
    }
}

/// Place of a part in a frame.
#[derive(Clone, Copy, Debug)]
pub struct PartPlace<'a> {
    /// Number of the part.
    pub part: u32,
    /// Where it is.
    pub at: PartAt<'a>,
}

/// Source of a part's place, and the box that holds it.
#[derive(Clone, Copy, Debug)]
pub enum PartAt<'a> {
    /// Of [`PartKind::Moving`].
    Moved(Moved<'a>),
    /// Of [`PartKind::Instances`].
    Placed(Placed<'a>),
}

impl PartAt<'_> {
    /// The box that holds the part.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        match self {
            Self::Moved(moved) => moved.bounds,
            Self::Placed(placed) => placed.bounds,
        }
    }
}

/// Places of instances in a frame.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The transform of each instance.
    pub transforms: Transforms<'a>,
    /// Lowest and highest corner of a box that holds all of them, world units; as [`Moved::bounds`]. [`Transforms::bounds`] finds it.
    pub bounds: [[f32; 3]; 2],
}

/// Where moving casters are in a frame.
#[derive(Clone, Copy, Debug)]
pub struct Moved<'a> {
    /// As many positions as the pose at rest has, in the same order.
    pub vertices: Vertices<'a>,
    /// Lowest and highest corner of a box that holds all vertices, world units. The light view is fitted to it: a box that is
    /// too wide (up to some 10^6 times; of an orthographic camera 10^4) costs time and changes nothing, one that is too tight makes the frame incomplete, and its status says so.
    ///
    /// It is asked of the application, as how many views the light has, and where they look, is decided when a frame is recorded, and where vertices are
    /// the GPU finds when it runs; the box of a frame before would not surely hold them. An animation's box, or that of its bones grown by what is
    /// skinned to them, will do.
    pub bounds: [[f32; 3]; 2],
}

/// Inputs of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The camera. A G-buffer must be drawn with its projection, jitter included ([`Camera::of_matrices`]): of a depth buffer
    /// [`DepthTerms::of_projection`](super::DepthTerms::of_projection) sees to it; of others nobody can.
    pub camera: &'a Camera,
    /// Map of the world, of an orthographic camera ([`Inputs::orthographic`]): casters, which move or are instances, and the light are given where
    /// they are in the world. Range and cone of the light are then not made use of. It takes no casters that stand, no histories, no lists of lights,
    /// and of surfaces in a G-buffer their depths alone. Depths that a frame tells and takes are those of its mapped world.
    pub homography: Option<&'a Homography>,
    /// The light, which may be another every frame: its views are then fitted anew, which takes no walk over all casters.
    pub light: &'a Light,
    /// Layers that the light is in, a bit each, of those that triangles [cast and receive](crate::scene::Roles) in; all of them if nothing else is said.
    pub layers: u8,
    /// How far the light's shadows are asked; everywhere if nothing else is said.
    pub reach: LightReach,
    /// View depths, in world units, between which slices of [`PartBy::SeenDepth`](crate::light_view::PartBy::SeenDepth) are cut, above 0 and rising:
    /// those that an earlier frame told ([`FrameStatus::depths`](super::FrameStatus::depths)). `None`: those of the casters' box. `facet-masks` and
    /// `supersampled` answer the same by any; of methods whose pixels ask one view, what is nearer or farther may be without shadow.
    pub depths: Option<[f32; 2]>,
    /// Where moving casters are; `None` for others.
    pub moved: Option<Moved<'a>>,
    /// Where instances are; `None` for other casters.
    pub placed: Option<Placed<'a>>,
    /// Where each part is that does not stand, in any order; empty for casters that are not in [parts](Casters::Parts).
    pub parts: &'a [PartPlace<'a>],
    /// State of the surfaces seen.
    pub gbuffer: GBuffer<'a>,
    /// Texel of the G-buffer's textures that the image's top left pixel is: the corner of a viewport. `None`: the image is all of them, to the
    /// texel.
    pub origin: Option<[u32; 2]>,
}

impl<'a> Inputs<'a> {
    /// A frame of static casters without a G-buffer.
    pub fn new(camera: &'a Camera, light: &'a Light) -> Self {
        Self {
            camera,
            homography: None,
            light,
            layers: u8::MAX,
            reach: LightReach::EVERYWHERE,
            depths: None,
            moved: None,
            placed: None,
            parts: &[],
            gbuffer: GBuffer::None,
            origin: None,
        }
    }

    /// A frame of an orthographic camera, without a G-buffer.
    pub fn orthographic(view: &'a OrthographicView, light: &'a Light) -> Self {
        Self { homography: Some(&view.homography), ..Self::new(&view.camera, light) }
    }

    /// The homography that places are mapped by when they are written; the default maps nothing.
    pub(super) fn map_of_places(&self) -> Homography {
        self.homography.copied().unwrap_or_default()
    }
}

/// A texture that visibility is written into: two-dimensional, one sample.
///
/// `R32Float` of usage `STORAGE_BINDING` is written in place; `R8Unorm` (the nearest 255th), `R16Float` (the nearest) and `R32Float` of usage `COPY_DST` by a
/// copy; of `Rgba8Unorm`, usage `COPY_SRC` and `COPY_DST`, one channel is, so that four lights lie in one texture. Copies take the memory of the image in
/// that format once more, rows padded to 256 bytes.
#[derive(Clone, Copy, Debug)]
pub struct TargetTexture<'a> {
    /// The texture.
    pub texture: &'a wgpu::Texture,
    /// Mip level.
    pub level: u32,
    /// Layer of an array.
    pub layer: u32,
    /// Channel of `Rgba8Unorm`, 0 to 3; 0 for other formats.
    pub channel: u32,
    /// Texel that the image's top left pixel is. `None`: the image is the whole level, to the texel.
    pub origin: Option<[u32; 2]>,
}

impl<'a> TargetTexture<'a> {
    /// The whole first level of the first layer.
    pub fn new(texture: &'a wgpu::Texture) -> Self {
        Self { texture, level: 0, layer: 0, channel: 0, origin: None }
    }

    /// How a copy writes it; `None` where the texture is written in place.
    pub(super) fn packing(&self) -> Option<Packing> {
        use wgpu::{TextureFormat as F, TextureUsages};
        match self.texture.format() {
            F::R8Unorm => Some(Packing::R8Unorm),
            F::R16Float => Some(Packing::R16Float),
            F::Rgba8Unorm => Some(Packing::Rgba8Channel(self.channel)),
            _ if self.texture.usage().contains(TextureUsages::STORAGE_BINDING) => None,
            _ => Some(Packing::R32Float),
        }
    }

    fn check(&self, size: [u32; 2]) -> Result<()> {
        use wgpu::{TextureFormat as F, TextureUsages};
        let (texture, what) = (self.texture, "visibility");
        let formats = [F::R32Float, F::R16Float, F::R8Unorm, F::Rgba8Unorm];
        let usage = match self.packing() {
            None => TextureUsages::STORAGE_BINDING,
            Some(Packing::Rgba8Channel(_)) => TextureUsages::COPY_DST | TextureUsages::COPY_SRC,
            Some(_) => TextureUsages::COPY_DST,
        };
        let (level, layer, channel) = (self.level, self.layer, self.channel);
        let (levels, layers) = (texture.mip_level_count(), texture.depth_or_array_layers());
        if level >= levels || layer >= layers {
            return Err(Error::Config(format!(
                "{what} texture: level {level} of {levels} and layer {layer} of {layers} are not both there"
            )));
        }
        let channels = if texture.format() == F::Rgba8Unorm { 4 } else { 1 };
        if channel >= channels {
            return Err(Error::Config(format!("{what} texture: channel {channel}, the format has {channels} of use")));
        }
        check_sampled(what, texture, &formats, usage, ImagePart { size, origin: self.origin }, (level, 1))
    }
}

/// How far the shadows of a light at a point are asked. What lies farther has no defined visibility: shading leaves the light out there, and views of it
/// may miss what casts there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightReach {
    /// Of a spot light, in its cone alone: it has one view, as wide as that (up to 150 degrees; wider ones are as without), wherever it stands.
    pub cone: bool,
    /// Distance from the light, world units. A light among casters that stand has views of those within it alone.
    pub range: f32,
}

impl LightReach {
    /// In every direction, infinitely far.
    pub const EVERYWHERE: Self = Self { cone: false, range: f32::INFINITY };

    /// In the cone of a spot light, up to a distance.
    pub fn cone(range: f32) -> Self {
        Self { cone: true, range }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self.range > 0.0 {
            true => Ok(()),
            false => Err(Error::Config(format!("a range of the light of {} is not more than 0", self.range))),
        }
    }
}

/// One of several lights, and where its results go.
#[derive(Clone, Copy, Debug)]
pub struct LightTarget<'a> {
    /// The light.
    pub light: Light,
    /// As [`Inputs::layers`].
    pub layers: u8,
    /// As [`Inputs::reach`].
    pub reach: LightReach,
    /// Where its results go.
    pub target: Target<'a>,
}

impl<'a> LightTarget<'a> {
    /// A light of all layers, everywhere.
    pub fn new(light: Light, target: Target<'a>) -> Self {
        Self { light, layers: u8::MAX, reach: LightReach::EVERYWHERE, target }
    }
}

/// Where results go.
#[derive(Clone, Copy, Debug, Default)]
pub struct Target<'a> {
    /// Visibility of each pixel in `[0, 1]`, row 0 at the top: the share that is lit of its samples that see anything; 1 where none does. A surface whose seen
    /// side faces away from the light is dark, be it a caster or not.
    pub visibility: Option<TargetTexture<'a>>,
    /// Lit samples of each pixel, one bit a sample, [`words`](crate::samples::Samples::words) words a pixel, row by row from
    /// the top; all ones where no sample of the pixel sees anything. Usage `COPY_DST`; written from its start.
    pub lit: Option<&'a wgpu::Buffer>,
    /// Work of each pixel, a [`PixelCounts`] a pixel, row by row from the top: for passes with [`count_pixels`](crate::methods::Settings::count_pixels). Usage
    /// `COPY_DST`; written from its start. They are of the frame itself, also where [`keep_last`](super::PassConfig::keep_last) shows another, and of
    /// the last of several points of a light.
    pub counts: Option<&'a wgpu::Buffer>,
    /// Lists of lights that the light is put into, for passes with [`light_lists`](super::PassConfig::light_lists).
    pub listed: Option<ListedTarget<'a>>,
}

impl<'a> Target<'a> {
    /// The first level and layer of a texture of the size of the image.
    pub fn texture(texture: &'a wgpu::Texture) -> Self {
        Self { visibility: Some(TargetTexture::new(texture)), ..Self::default() }
    }

    /// Checks the buffer of counts; `kept`: the method has them.
    pub(super) fn check_counts(&self, pixels: usize, kept: bool) -> Result<()> {
        let Some(counts) = self.counts else { return Ok(()) };
        let refuse = |text: String| Err(Error::Config(format!("counts of pixels: {text}")));
        let (usage, bytes) = (counts.usage(), (pixels * size_of::<PixelCounts>()) as u64);
        if !kept {
            return refuse(
                "the pass has none (settings: count_pixels, and a method that has facets or classes)".to_owned(),
            );
        }
        if !usage.contains(wgpu::BufferUsages::COPY_DST) {
            return refuse(format!("the usage {usage:?} of the buffer lacks COPY_DST"));
        }
        if counts.size() < bytes {
            return refuse(format!("a buffer of {} bytes, {bytes} are needed", counts.size()));
        }
        Ok(())
    }

    pub(super) fn check(&self, size: [u32; 2], lit_bytes: Option<u64>) -> Result<()> {
        if let Some(texture) = self.visibility {
            texture.check(size)?;
        }
        let Some(lit) = self.lit else { return Ok(()) };
        let Some(lit_bytes) = lit_bytes else {
            return Err(Error::Config("lit masks: the method keeps none".to_owned()));
        };
        if !lit.usage().contains(wgpu::BufferUsages::COPY_DST) {
            return Err(Error::Config(format!("lit masks: the usage {:?} of the buffer lacks COPY_DST", lit.usage())));
        }
        if lit.size() < lit_bytes {
            return Err(Error::Config(format!("lit masks: a buffer of {} bytes, {lit_bytes} are needed", lit.size())));
        }
        Ok(())
    }
}
