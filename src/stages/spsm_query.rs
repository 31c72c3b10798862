//! Shadows from the sub-pixel shadow map (Lecocq 2013, sections 4 and 5).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, the records of `spsm_map`, sample offsets.
//! - **Writes** `visibility` (lit share of the samples; 1 where the pixel sees nothing), `lit` (mask of the lit samples),
//!   `marks` ([`Class`]) and the list of uncertain pixels.
//! - **Guarantee.** Bit-equal from run to run. A pixel is settled as a whole or every sample of it is judged by itself. A texel
//!   that is read and is not marked holds nothing, and is told ([`TexelMarks::missed`](super::seen_texels::TexelMarks::missed)).
//! - **Cost.** One dispatch over pixels; a compaction; one over the pixels that have a closest triangle's plane before them and
//!   are not covered by their own texel's triangle; a compaction; one over pixels that writes what the classes say; one over the
//!   uncertain pixels, which alone recover.

use super::PrimaryHits;
use super::compact::{self, Compact, Flags};
use super::spsm_map::SpsmTexels;
use super::{Count, DispatchArgs, PrefixScan, dispatch_args};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::spsm_query as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Stage};
use crate::spsm_code::BorderPattern;

/// State of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Class {
    /// It sees nothing.
    Empty = kernel::CLASS_EMPTY,
    /// Its seen side faces away from the light.
    Dark = kernel::CLASS_DARK,
    /// No closest triangle lies before it.
    Lit = kernel::CLASS_LIT,
    /// One triangle covers it, or all nine around it lie before it.
    Shadowed = kernel::CLASS_SHADOWED,
    /// To be recovered, sample by sample.
    Uncertain = kernel::CLASS_UNCERTAIN,
}

/// Settings that the pipelines are compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpsmQueryOptions {
    /// 0 for the paper's records, 1 for edge lines.
    pub encoding: u32,
    /// Words of a mask.
    pub words: u32,
    /// Whether a pixel has more samples than the one at its centre.
    pub many: bool,
    /// Texels searched around a sample's own.
    pub radius: u32,
    /// Texels searched beyond these along the border's tangents, to either side; up to 2, and only with a radius of 1.
    pub stretch: u32,
    /// Whether what no triangle covers is judged by the border that outer edges link (section 4.2); without, it is lit.
    pub recovery: bool,
    /// Depth by which a caster must lie before a receiver.
    pub bias: f32,
}

impl Default for SpsmQueryOptions {
    /// One sample, edge lines, 3 × 3 texels.
    fn default() -> Self {
        Self { encoding: 1, words: 1, many: false, radius: 1, stretch: 0, recovery: true, bias: 1e-5 }
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct SpsmQuery {
    classify: kernel::ClassifyProgram,
    settle: kernel::SettleProgram,
    paint: kernel::PaintProgram,
    recover: kernel::RecoverProgram,
    compact: Compact,
    fold: DispatchArgs,
}

/// Outputs of the stage.
#[derive(Debug)]
pub struct SpsmPixels {
    /// Lit share of each pixel.
    pub visibility: Buffer<f32>,
    /// Lit samples of each pixel.
    pub lit: Buffer<u32>,
    /// Whether each pixel is uncertain; then the [`Class`] of each.
    pub marks: Buffer<u32>,
    /// The uncertain pixels, rising, with space for all; then how many, and 0.
    pub list: Buffer<u32>,
    asked: Buffer<u32>,
    patterns: Buffer<[u32; 4]>,
    requests: dispatch_args::Requests,
    asked_args: Buffer<u32>,
    args: Buffer<u32>,
    scratch: compact::CompactScratch,
}

impl SpsmPixels {
    /// Reads the [`Class`] of each pixel.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    pub fn classes(&self, gpu: &Gpu) -> Result<Vec<u32>> {
        Ok(self.marks.read(gpu)?.split_off(self.visibility.len()))
    }

    /// The list of the pixels that `classify` leaves, and as many workgroups as they need.
    pub(crate) fn unsettled(&self) -> (&Buffer<u32>, Groups<'_>) {
        (&self.asked, Groups::Indirect(self.asked_args.raw(), 0))
    }

    /// Memory for an image of `pixels` pixels and masks of `words` words.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, pixels: usize, words: usize) -> Result<Self> {
        let patterns = Buffer::uniform(device, "spsm_query.patterns", 512)?;
        patterns.write(queue, &BorderPattern::words());
        let request = dispatch_args::ArgsRequest::new(pixels, kernel::WORKGROUP, pixels, 0)?;
        Ok(Self {
            visibility: Buffer::storage(device, "spsm_query.visibility", pixels)?,
            lit: Buffer::storage(device, "spsm_query.lit", pixels * words)?,
            marks: Buffer::storage(device, "spsm_query.marks", 2 * pixels)?,
            list: Buffer::storage(device, "spsm_query.list", pixels + 2)?,
            asked: Buffer::storage(device, "spsm_query.asked", pixels + 2)?,
            patterns,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            asked_args: Buffer::indirect(device, "spsm_query.asked_args", 3)?,
            args: Buffer::indirect(device, "spsm_query.args", 3)?,
            scratch: Compact::scratch(device, pixels)?,
        })
    }
}

impl SpsmQuery {
    /// Builds the pipelines that ask `texels`; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, options: SpsmQueryOptions, texels: &SpsmTexels) -> Self {
        let constants = kernel::Constants {
            encoding: options.encoding,
            split: u32::from(texels.is_split()),
            words: options.words,
            many: u32::from(options.many),
            radius: options.radius as i32,
            stretch: options.stretch as i32,
            recovery: u32::from(options.recovery),
            bias: options.bias,
            // A paraboloid has no straight border to reconstruct.
            paraboloids: 0,
        };
        Self {
            classify: kernel::ClassifyProgram::new(device, constants),
            settle: kernel::SettleProgram::new(device, constants),
            paint: kernel::PaintProgram::new(device, constants),
            recover: kernel::RecoverProgram::new(device, constants),
            compact: Compact::new(device, scan),
            fold: DispatchArgs::new(device),
        }
    }

    /// Records the classes that planes and a pixel's own texel tell, and the list of the other pixels.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_classify(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) -> Result<()> {
        let SpsmPixels { asked, scratch, .. } = pixels;
        let count = pixels.visibility.len();
        let bindings = Self::bindings(frame, seen, texels, pixels, asked);
        stage.run(&self.classify, bindings, Groups::Items(count as u64));
        let flags = Flags::Words(&pixels.marks);
        self.compact.record(stage, flags, None, asked, (asked, count), scratch, Count::Exactly(count))?;
        self.fold.record(stage, asked, &pixels.requests, &pixels.asked_args)
    }

    /// Records the classes of the pixels so listed, the list of the uncertain ones, and what the classes say.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_settle(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) -> Result<()> {
        let SpsmPixels { asked, list, scratch, .. } = pixels;
        let count = pixels.visibility.len();
        let bindings = Self::bindings(frame, seen, texels, pixels, asked);
        stage.run(&self.settle, bindings, pixels.unsettled().1);
        let flags = Flags::Words(&pixels.marks);
        self.compact.record(stage, flags, Some(asked), list, (list, count), scratch, Count::At(asked, count))?;
        self.fold.record(stage, list, &pixels.requests, &pixels.args)?;
        stage.run(&self.paint, bindings, Groups::Items(count as u64));
        Ok(())
    }

    /// Records the recovery of the uncertain pixels, whose list must have been taken
    /// ([`TexelMarks::take_list`](super::seen_texels::TexelMarks::take_list)).
    pub fn record_recover(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) {
        let bindings = Self::bindings(frame, seen, texels, pixels, &pixels.list);
        stage.run(&self.recover, bindings, Groups::Indirect(pixels.args.raw(), 0));
    }

    fn bindings<'a>(
        frame: &'a Buffer<Frame>,
        seen: PrimaryHits<'a>,
        texels: &'a SpsmTexels,
        pixels: &'a SpsmPixels,
        kept: &'a Buffer<u32>,
    ) -> kernel::Texels<'a> {
        kernel::Texels {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            slopes: texels.slopes.as_uniform(),
            patterns: pixels.patterns.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            upper_records: texels.records[0].as_read(),
            lower_records: texels.records[1].as_read(),
            visibility: pixels.visibility.as_write(),
            lit: pixels.lit.as_write(),
            marks: pixels.marks.as_write(),
            kept: kept.as_read(),
            seen: texels.marks.words.as_write(),
        }
    }
}
