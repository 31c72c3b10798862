//! Surfaces that cast nothing, by an application's depths or positions, among the triangles that samples of a pixel may see.
//!
//! - **Reads** what pixels show ([`super::pixel_receivers`]: `keys`, and the vertices behind the casters'), and the texture of depths or
//!   positions again. Works on the lists of [`super::pixel_triangles`], in four steps between its own.
//! - **Writes** for each receiver that a pixel may show an element of what [`super::pixel_coverage`] lists, with the samples that it covers. A pixel that shows a receiver has that one for all its samples, so a caster is seen where it is nearer.
//!   One that shows a caster has the receivers of the eight pixels around it, one of each plane, that do not run before that caster: at each sample that of
//!   the nearest pixel, unless the plane runs before what the pixel at the nearest side shows.
//! - **Strips.** Pixels are the strip's, textures the whole image's; neighbours are looked for in the strip alone, two rows beyond those
//!   of `pixel_receivers`.
//! - **Guarantee.** Same inputs, same bits. Nothing is written beyond the capacity.
//! - **Error.** One place a pixel says what is there: a receiver's own outline is known to a pixel, and a surface that no pixel around shows
//!   is missing. Before and behind casters outlines are those of the casters, exactly.
//! - **Cost.** Three dispatches over pixels, which for most read a word, and one over complex pixels.

use super::pixel_coverage::PairCoverage;
use super::pixel_receivers::{GivenTexture, PixelReceiversParams};
use super::pixel_triangles::PixelLists;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::bindings::{TextureFloat, TextureFloatSamples};
use crate::gpu::kernels::surface_receivers as kernel;
pub use crate::gpu::kernels::surface_receivers::WORKGROUP;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};

/// Content of pixels by an application's textures.
#[derive(Clone, Copy, Debug)]
pub struct GivenSurfaces<'a> {
    /// Contents of the textures, as `pixel_receivers` has them.
    pub params: PixelReceiversParams,
    /// Depths or positions.
    pub place: GivenTexture<'a>,
    /// Complement of each pixel's triangle.
    pub keys: &'a Buffer<u32>,
}

/// Places of the casters and of the three vertices of each pixel's receiver behind theirs.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverPlaces<'a> {
    /// World units.
    pub positions: &'a Buffer<[f32; 4]>,
    /// Relative to the eye, scaled; written behind the casters'.
    pub points: &'a Buffer<[f32; 4]>,
}

/// Complex pixels: which, and how many.
#[derive(Clone, Copy, Debug)]
pub struct ListedPixels<'a> {
    /// The pixels.
    pub pixels: &'a Buffer<u32>,
    /// Their count.
    pub total: &'a Buffer<u32>,
    /// A workgroup for each [`WORKGROUP`] of them.
    pub groups: Groups<'a>,
}

/// The pipelines, for one number of samples.
#[derive(Debug)]
pub struct SurfaceReceivers {
    own: kernel::OwnProgram,
    choose: kernel::ChooseProgram,
    list: kernel::ListProgram,
    cover: kernel::CoverProgram,
    uniforms: Uniforms,
}

impl SurfaceReceivers {
    /// Builds them for `samples` samples a pixel.
    pub fn new(device: &wgpu::Device, samples: u32) -> Self {
        let constants = kernel::Constants { words: samples.div_ceil(32) };
        Self {
            own: kernel::OwnProgram::new(device, constants),
            choose: kernel::ChooseProgram::new(device, constants),
            list: kernel::ListProgram::new(device, constants),
            cover: kernel::CoverProgram::new(device, constants),
            uniforms: Uniforms::default(),
        }
    }

    /// A word a pixel: which of the receivers around it may be seen in it.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn memory(device: &wgpu::Device, pixels: usize) -> Result<Buffer<u32>> {
        Buffer::storage(device, "surface_receivers.chosen", pixels)
    }

    /// Begins lists, of which counts and cover keys are 0, with the receivers that pixels show.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no room behind the casters' vertices for those of every pixel.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record_own(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        given: GivenSurfaces,
        places: ReceiverPlaces,
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
        chosen: &Buffer<u32>,
    ) -> Result<()> {
        let pixels = lists.counts.len();
        for (name, buffer) in [("positions", places.positions), ("points", places.points)] {
            let room = (buffer.bytes() as usize / 16).saturating_sub(buffer.len());
            super::holds("surface_receivers", name, room, 3 * pixels)?;
        }
        for (name, buffer) in [("keys", given.keys), ("id_keys", id_keys), ("chosen", chosen)] {
            super::holds("surface_receivers", name, buffer.len(), pixels)?;
        }
        let bindings = kernel::Own {
            frame: frame.as_uniform(),
            keys: given.keys.as_read(),
            positions: places.positions.as_read(),
            made_points: places.points.as_write(),
            cover_keys: lists.cover_keys.as_write(),
            id_keys: id_keys.as_write(),
            pixel_counts: lists.counts.as_write(),
            chosen: chosen.as_write(),
        };
        stage.run(&self.own, bindings, Groups::Items(pixels as u64));
        Ok(())
    }

    /// Adds to counted lists the receivers around pixels that show casters. A pixel that shows a caster and for which none was counted keeps that one.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record_choose(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        given: GivenSurfaces,
        points: &Buffer<[f32; 4]>,
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
        chosen: &Buffer<u32>,
    ) -> Result<()> {
        let params = self.uniforms.get(stage.device, &given.params)?;
        let bindings = kernel::Choose {
            frame: frame.as_uniform(),
            params: params.as_uniform(),
            place: TextureFloat(given.place.single),
            place_samples: TextureFloatSamples(given.place.samples),
            keys: given.keys.as_read(),
            points: points.as_read(),
            cover_keys: lists.cover_keys.as_write(),
            id_keys: id_keys.as_write(),
            pixel_counts: lists.counts.as_write(),
            chosen: chosen.as_write(),
        };
        stage.run(&self.choose, bindings, Groups::Items(lists.counts.len() as u64));
        Ok(())
    }

    /// Writes receivers into lists that have the casters.
    pub fn record_list(&self, stage: &mut Stage, frame: &Buffer<Frame>, lists: &PixelLists, chosen: &Buffer<u32>) {
        let bindings = kernel::List {
            frame: frame.as_uniform(),
            pixel_counts: lists.counts.as_write(),
            chosen: chosen.as_write(),
            pixel_offsets: lists.offsets.as_read(),
            pixel_list: lists.list.as_write(),
        };
        stage.run(&self.list, bindings, Groups::Items(lists.counts.len() as u64));
    }

    /// Appends receivers to what covers samples of complex pixels.
    ///
    /// # Errors
    /// As [`SurfaceReceivers::record_choose`].
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record_cover(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        samples: &Buffer<[f32; 4]>,
        given: GivenSurfaces,
        points: &Buffer<[f32; 4]>,
        listed: ListedPixels,
        lists: &PixelLists,
        (coverage, chosen): (&PairCoverage, &Buffer<u32>),
    ) -> Result<()> {
        let params = self.uniforms.get(stage.device, &given.params)?;
        let bindings = kernel::Cover {
            frame: frame.as_uniform(),
            params: params.as_uniform(),
            samples: samples.as_uniform(),
            place: TextureFloat(given.place.single),
            place_samples: TextureFloatSamples(given.place.samples),
            points: points.as_read(),
            pixel_counts: lists.counts.as_write(),
            chosen: chosen.as_write(),
            pixel_offsets: lists.offsets.as_read(),
            complex_pixels: listed.pixels.as_read(),
            complex_total: listed.total.as_read(),
            coverings: coverage.list.as_write(),
            covering_masks: coverage.masks.as_write(),
        };
        stage.run(&self.cover, bindings, listed.groups);
        Ok(())
    }
}
