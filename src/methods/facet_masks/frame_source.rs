//! Differences from frame to frame besides camera and light: the part of the image, and what is known already.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Recorder};
use crate::methods::every_surface::SampleIds;
use crate::stages::surface_receivers::GivenSurfaces;

/// The part of an image that a frame is: as many rows as its settings say, all as wide as the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strip {
    /// Width and height of the image.
    pub image: [u32; 2],
    /// First row of the frame, from the top.
    pub first_row: u32,
    /// Rows at its top and at its bottom that belong to the strips above and below.
    pub others: [u32; 2],
}

impl Strip {
    /// All of an image.
    pub fn whole(image: [u32; 2]) -> Self {
        Self { image, first_row: 0, others: [0, 0] }
    }
}

/// Whether a frame makes the light maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapSource {
    /// It makes them.
    Made,
    /// It makes what its own facets ask of them: no other frame can use them.
    Requested,
    /// A frame before made them, and they hold for this one too: of the same casters, all of whose vertices stand as they did, and the same view of
    /// the light; the camera may be another one. Of several views, which share the memory, they are made anew all the same.
    Kept,
}

/// How much of a method runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Nothing: no pixel sees a surface, so every pixel is lit.
    Nothing,
    /// The surface of each pixel and whether it faces the light; no caster is tested.
    Facing,
    /// Everything.
    Everything,
}

/// Source of the surfaces that pixels show.
#[derive(Clone, Copy, Default)]
pub enum FacetSource<'a> {
    /// Found among the triangles.
    #[default]
    Found,
    /// With one facet a pixel: records what writes [`FacetMasks::id_keys`](super::FacetMasks::id_keys) in place of the stage `camera_visibility`. It is
    /// given the frame.
    Centres(&'a dyn Fn(&mut Recorder, &Buffer<Frame>) -> Result<()>),
    /// With a facet for every surface: records what writes the triangle of each pixel, as `Centres` does but into [`GivenSurfaces::keys`]. Casters are
    /// searched for beside it. The pipelines must be [those with receivers](super::Pipelines::with_receivers).
    Receivers(&'a dyn Fn(&mut Recorder, &Buffer<Frame>) -> Result<()>, GivenSurfaces<'a>),
    /// With a facet for every surface: a G-buffer of several samples a pixel. The frames must have [`Frame::BEYOND`](crate::frame::Frame::BEYOND) set.
    Samples(&'a SampleIds<'a>),
    /// The frame before found them, of the same camera, casters and G-buffer, and kept them ([`FacetMasks::keep_found`](super::FacetMasks::keep_found)): this one
    /// is of another light.
    Kept,
}
