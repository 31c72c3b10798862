//! Lights listed by tiles of 8 × 8 pixels, for clustered and forward shading.
//!
//! - **Reads** the facets of a frame that has run, with their masks, triangles and positions; or the visibility of every pixel and the triangle
//!   at its centre.
//! - **Writes** a buffer of the application's: of each tile the lights that reach it and are not dark in all of it, with a byte of visibility a pixel
//!   ([`words_for`] says how long it is). Lights are added one after the other.
//! - **Guarantee.** The same words in every run. A byte is the nearest 255th of the share of a pixel's seen samples that are lit and within
//!   reach; without a range and a cone that of an `r8unorm` target, but for pixels that see nothing, which have 0.
//! - **Capacity.** What has no room is not written; its tile is marked ([`TILE_LACKS`]), and how many entries were needed is counted.
//! - **Cost.** Six dispatches a light. 8 bytes a tile, 72 an entry; a light that reaches no pixel of a tile has none there. Samples are asked one by one
//!   in pixels that the end of the reach crosses.
//! - **Source.** Olsson, Billeter, Assarsson 2012, "Clustered Deferred and Forward Shading", section 3 (lists by tile); Yang, Hensley, Grün,
//!   Thibieroz 2010, "Real-Time Concurrent Linked List Construction on the GPU" (entries linked).

use super::facet_classify::Facets;
use super::{Count, PrefixScan, holds, prefix_scan};
use crate::frame::Frame;
use crate::gpu::bindings::Write;
use crate::gpu::kernels::light_lists as kernel;
pub use crate::gpu::kernels::light_lists::{LIST_ENTRY, LIST_HEAD, TILE_LACKS};
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::methods::prepared::CasterBuffers;
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// A light, and where its entries go.
    "light_lists/light_part" => pub struct LightPart {
        /// Axis of the cone, of length 1; without a cone 0.
        pub axis: [f32; 3],
        /// Cosine of half its angle; without a cone -2.
        pub cosine: f32,
        /// Range, world units.
        pub range: f32,
        /// Not 0: neither is asked.
        pub everywhere: u32,
        /// Number of the light.
        pub light: u32,
        /// Entries that the buffer has room for.
        pub capacity: u32,
        /// Tiles in a row of the image.
        pub tiles_across: u32,
        /// Tiles of the image.
        pub tiles: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
    }
}

impl LightPart {
    /// A light that reaches everywhere, in lists of an image of so many pixels that have room for `capacity` entries.
    pub fn everywhere(light: u32, size: [u32; 2], capacity: u32) -> Self {
        let [across, down] = size.map(|side| side.div_ceil(TILE));
        Self {
            axis: [0.0; 3],
            cosine: -2.0,
            range: f32::MAX,
            everywhere: 1,
            light,
            capacity,
            tiles_across: across,
            tiles: across * down,
            ..Self::default()
        }
    }
}

/// Pixels along a side of a tile.
pub const TILE: u32 = 8;

/// Words of the lists of an image of so many pixels with so many entries.
pub fn words_for(size: [u32; 2], entries: u64) -> u64 {
    let tiles = size.map(|side| u64::from(side.div_ceil(TILE)));
    u64::from(LIST_HEAD) + 2 * tiles[0] * tiles[1] + u64::from(LIST_ENTRY) * entries
}

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct LightLists {
    share: kernel::ShareProgram,
    centres: kernel::ShareCentresProgram,
    begin: kernel::BeginProgram,
    mark: kernel::MarkProgram,
    emit: kernel::EmitProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Memory of an image, whatever the number of lights.
#[derive(Debug)]
pub struct LightListMemory {
    /// A byte a pixel, tile by tile.
    pub shares: Buffer<u32>,
    /// Entries that the lists needed so far.
    pub need: Buffer<u32>,
    counts: Buffer<u32>,
    offsets: Buffer<u32>,
    scratch: prefix_scan::PrefixScanScratch,
}

impl LightListMemory {
    /// That of an image of so many pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> Result<Self> {
        let [across, down] = size.map(|side| side.div_ceil(TILE) as usize);
        let tiles = across * down;
        Ok(Self {
            shares: Buffer::storage(device, "light_lists.shares", 16 * tiles)?,
            need: Buffer::storage(device, "light_lists.need", 1)?,
            counts: Buffer::storage(device, "light_lists.counts", tiles + 1)?,
            // Behind the offsets their sum.
            offsets: Buffer::storage(device, "light_lists.offsets", tiles + 3)?,
            scratch: PrefixScan::scratch(device, tiles + 1)?,
        })
    }

    /// Tiles of the image.
    pub fn tiles(&self) -> usize {
        self.counts.len() - 1
    }
}

impl LightLists {
    /// Builds the pipelines for masks of `words` words.
    pub fn new(device: &wgpu::Device, words: u32) -> Self {
        let constants = kernel::Constants { words };
        Self {
            share: kernel::ShareProgram::new(device, constants),
            centres: kernel::ShareCentresProgram::new(device, constants),
            begin: kernel::BeginProgram::new(device, constants),
            mark: kernel::MarkProgram::new(device, constants),
            emit: kernel::EmitProgram::new(device, constants),
            scan: PrefixScan::new(device),
            uniforms: Uniforms::default(),
        }
    }

    /// Records lists of no light into the first words of `lists`.
    ///
    /// # Errors
    /// [`Error::Config`] if `lists` is too short; [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_begin(&self, stage: &mut Stage, part: LightPart, lists: &wgpu::Buffer) -> Result<()> {
        fits(part, lists)?;
        let tiles = Groups::Items(u64::from(part.tiles));
        let part = &self.uniforms.get(stage.device, &part)?;
        stage.run(&self.begin, kernel::Begin { part: part.as_uniform(), lists: Write::of(lists) }, tiles);
        Ok(())
    }

    /// Records the visibility of the pixels of a strip of rows, from the facets of the frame; `samples` are the offsets as
    /// [`sample_words`](crate::frame::sample_words) has them.
    ///
    /// # Errors
    /// [`Error::Config`] for memory of another image; [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_share(
        &self,
        stage: &mut Stage,
        (frame, samples, size): (&Buffer<Frame>, &Buffer<[f32; 4]>, [u32; 2]),
        part: LightPart,
        casters: &CasterBuffers,
        facets: &Facets,
        memory: &LightListMemory,
    ) -> Result<()> {
        holds("light_lists", "shares", memory.shares.len(), 16 * part.tiles as usize)?;
        let part = &self.uniforms.get(stage.device, &part)?;
        let bindings = kernel::Share {
            frame: frame.as_uniform(),
            part: part.as_uniform(),
            samples: samples.as_uniform(),
            facets: facets.list.as_read(),
            masks: facets.masks.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            triangles: casters.triangles.as_read().cast(),
            positions: casters.positions.as_read().cast(),
            shares: memory.shares.as_write(),
        };
        stage.run(&self.share, bindings, fours(size));
        Ok(())
    }

    /// As [`LightLists::record_share`], from the `visibility` of every pixel and the triangle at its centre ([`id_keys`](kernel::ShareCentres::id_keys)).
    ///
    /// # Errors
    /// As [`LightLists::record_share`].
    pub fn record_centres(
        &self,
        stage: &mut Stage,
        (frame, size): (&Buffer<Frame>, [u32; 2]),
        part: LightPart,
        casters: &CasterBuffers,
        (id_keys, visibility): (&Buffer<u32>, &Buffer<f32>),
        memory: &LightListMemory,
    ) -> Result<()> {
        holds("light_lists", "shares", memory.shares.len(), 16 * part.tiles as usize)?;
        let part = &self.uniforms.get(stage.device, &part)?;
        let bindings = kernel::ShareCentres {
            frame: frame.as_uniform(),
            part: part.as_uniform(),
            triangles: casters.triangles.as_read().cast(),
            positions: casters.positions.as_read().cast(),
            shares: memory.shares.as_write(),
            id_keys: id_keys.as_read(),
            visibility: visibility.as_read(),
        };
        stage.run(&self.centres, bindings, fours(size));
        Ok(())
    }

    /// Records the entries of a light, of which the visibility of all pixels is known, behind those that `lists` has.
    ///
    /// # Errors
    /// As [`LightLists::record_begin`] and [`LightLists::record_share`].
    pub fn record_append(
        &self,
        stage: &mut Stage,
        part: LightPart,
        memory: &LightListMemory,
        lists: &wgpu::Buffer,
    ) -> Result<()> {
        fits(part, lists)?;
        let tiles = part.tiles as usize;
        holds("light_lists", "shares", memory.shares.len(), 16 * tiles)?;
        let part = &self.uniforms.get(stage.device, &part)?;
        let mark = kernel::Mark {
            part: part.as_uniform(),
            given: memory.shares.as_read(),
            counts: memory.counts.as_write(),
            lists: Write::of(lists),
        };
        stage.run(&self.mark, mark, Groups::Items(tiles as u64));
        let total = (&memory.offsets, tiles + 1);
        let count = Count::Exactly(tiles + 1);
        self.scan.record(stage, &memory.counts, &memory.offsets, total, &memory.scratch, count)?;
        let emit = kernel::Emit {
            part: part.as_uniform(),
            given: memory.shares.as_read(),
            marks: memory.counts.as_read(),
            offsets: memory.offsets.as_read(),
            lists: Write::of(lists),
            need: memory.need.as_write(),
        };
        stage.run(&self.emit, emit, Groups::Items(16 * tiles as u64));
        Ok(())
    }
}

/// Invocations for four pixels of a row each.
fn fours([width, height]: [u32; 2]) -> Groups<'static> {
    Groups::Items(u64::from(width.div_ceil(4)) * u64::from(height))
}

/// Checks that the lists have the room that they are said to have.
fn fits(part: LightPart, lists: &wgpu::Buffer) -> Result<()> {
    let words = u64::from(LIST_HEAD) + 2 * u64::from(part.tiles) + u64::from(LIST_ENTRY) * u64::from(part.capacity);
    if lists.size() < 4 * words {
        return Err(Error::Config(format!(
            "light_lists: 'lists' has {} bytes, {} are needed",
            lists.size(),
            4 * words
        )));
    }
    Ok(())
}
