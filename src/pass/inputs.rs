//! Inputs that an application hands to the pass, and the checks of them.

use super::GBuffer;
use super::textures::check_texture;
use crate::scene::{Camera, Light};
use crate::stages::caster_positions::Vertices;
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
    /// In a vertex buffer that the application rewrites: each frame brings it as [`Moved`].
    Moving {
        /// One pose. Vertices at one point of it are taken as one and must stay at one point (each frame says whether they
        /// did), so that a seam of doubled vertices is no boundary. No position is used besides.
        rest: &'a [[f32; 3]],
        /// Vertex indices of each triangle.
        triangles: &'a [[u32; 3]],
    },
}

impl<'a> Casters<'a> {
    pub(super) fn parts(&self) -> (&'a [[f32; 3]], &'a [[u32; 3]]) {
        match *self {
            Self::Static { positions, triangles } => (positions, triangles),
            Self::Moving { rest, triangles } => (rest, triangles),
        }
    }
}

/// Where moving casters are in a frame.
#[derive(Clone, Copy, Debug)]
pub struct Moved<'a> {
    /// As many positions as the pose at rest has, in the same order.
    pub vertices: Vertices<'a>,
    /// Lowest and highest corner of a box that holds all vertices, world units. The light view is fitted to it: a box that is
    /// too wide (up to some 10^6 times) costs time and changes nothing, one that is too tight makes the frame incomplete, and its status says so.
    pub bounds: [[f32; 3]; 2],
}

/// Inputs of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The camera. Its image is the whole target; pixels are square. A G-buffer must be drawn with the projection of this camera: no
    /// jitter, centred. Of a depth buffer [`DepthTerms::of_projection`](super::DepthTerms::of_projection) sees to it; of others nobody can.
    pub camera: &'a Camera,
    /// The light, which may be another every frame: its views are then fitted anew, which takes no walk over all casters.
    pub light: &'a Light,
    /// Where moving casters are; `None` for static ones.
    pub moved: Option<Moved<'a>>,
    /// State of the surfaces seen.
    pub gbuffer: GBuffer<'a>,
}

impl<'a> Inputs<'a> {
    /// A frame of static casters without a G-buffer.
    pub fn new(camera: &'a Camera, light: &'a Light) -> Self {
        Self { camera, light, moved: None, gbuffer: GBuffer::None }
    }
}

/// Where results go.
#[derive(Clone, Copy, Debug, Default)]
pub struct Target<'a> {
    /// Visibility of each pixel in `[0, 1]`, row 0 at the top; 1 where nothing is seen. Format `R32Float`, usage
    /// `STORAGE_BINDING`, two-dimensional, one sample, the size of the image. Its first level and layer are written.
    pub visibility: Option<&'a wgpu::Texture>,
    /// Lit samples of each pixel, one bit a sample, [`words`](crate::samples::Samples::words) words a pixel, row by row from
    /// the top; all ones where nothing is seen. Usage `COPY_DST`; written from its start.
    pub lit: Option<&'a wgpu::Buffer>,
}

impl Target<'_> {
    pub(super) fn check(&self, size: [u32; 2], lit_bytes: Option<u64>) -> Result<()> {
        if let Some(texture) = self.visibility {
            use wgpu::{TextureFormat, TextureUsages};
            check_texture("visibility", texture, &[TextureFormat::R32Float], TextureUsages::STORAGE_BINDING, size)?;
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
