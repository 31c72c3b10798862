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

use super::Seen;
use super::compact::{self, Compact, Flags};
use super::spsm_map::SpsmTexels;
use super::{Count, DispatchArgs, PrefixScan, dispatch_args};
use crate::Result;
use crate::gpu::kernels::spsm_query as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Program, Stage};
use crate::spsm_code::Pattern;

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
pub struct Options {
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
    /// Depth by which a caster must lie before a receiver.
    pub bias: f32,
}

impl Default for Options {
    /// One sample, edge lines, 3 × 3 texels.
    fn default() -> Self {
        Self { encoding: 1, words: 1, many: false, radius: 1, stretch: 0, bias: 1e-5 }
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct SpsmQuery {
    classify: Program,
    settle: Program,
    paint: Program,
    recover: Program,
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
    /// Of each pixel whether it is uncertain; then of each its [`Class`].
    pub marks: Buffer<u32>,
    /// The uncertain pixels, rising, with space for all; then how many, and 0.
    pub list: Buffer<u32>,
    asked: Buffer<u32>,
    patterns: Buffer<[u32; 4]>,
    requests: dispatch_args::Requests,
    asked_args: Buffer<u32>,
    args: Buffer<u32>,
    scratch: compact::Scratch,
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
        patterns.write(queue, &Pattern::words());
        let request = dispatch_args::Request::new(pixels, kernel::WORKGROUP, pixels, 0)?;
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
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, options: Options, texels: &SpsmTexels) -> Self {
        let constants = [
            ("ENCODING", f64::from(options.encoding)),
            ("SPLIT", f64::from(u32::from(texels.is_split()))),
            ("WORDS", f64::from(options.words)),
            ("MANY", f64::from(u32::from(options.many))),
            ("RADIUS", f64::from(options.radius)),
            ("STRETCH", f64::from(options.stretch)),
            ("BIAS", f64::from(options.bias)),
        ];
        Self {
            classify: Program::new(device, kernel::ENTRY_CLASSIFY, &constants),
            settle: Program::new(device, kernel::ENTRY_SETTLE, &constants),
            paint: Program::new(device, kernel::ENTRY_PAINT, &constants),
            recover: Program::new(device, kernel::ENTRY_RECOVER, &constants),
            compact: Compact::new(device, scan),
            fold: DispatchArgs::new(device),
        }
    }

    /// Records the classes that planes and a pixel's own texel tell, and the list of the other pixels.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_classify(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        seen: Seen,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) -> Result<()> {
        let SpsmPixels { asked, scratch, .. } = pixels;
        let count = pixels.visibility.len();
        let buffers = Self::buffers(frame, seen, texels, pixels, asked);
        stage.run(&self.classify, &buffers, Groups::Items(count as u64))?;
        let flags = Flags::Words(&pixels.marks);
        self.compact.record(stage, flags, None, asked, (asked, count), scratch, Count::Exactly(count))?;
        self.fold.record(stage, asked, &pixels.requests, &pixels.asked_args)
    }

    /// Records the classes of the pixels so listed, the list of the uncertain ones, and what the classes say.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_settle(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        seen: Seen,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) -> Result<()> {
        let SpsmPixels { asked, list, scratch, .. } = pixels;
        let count = pixels.visibility.len();
        let buffers = Self::buffers(frame, seen, texels, pixels, asked);
        stage.run(&self.settle, &buffers, pixels.unsettled().1)?;
        let flags = Flags::Words(&pixels.marks);
        self.compact.record(stage, flags, Some(asked), list, (list, count), scratch, Count::At(asked, count))?;
        self.fold.record(stage, list, &pixels.requests, &pixels.args)?;
        stage.run(&self.paint, &buffers, Groups::Items(count as u64))
    }

    /// Records the recovery of the uncertain pixels, whose list must have been taken
    /// ([`TexelMarks::take_list`](super::seen_texels::TexelMarks::take_list)).
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_recover(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        seen: Seen,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) -> Result<()> {
        let buffers = Self::buffers(frame, seen, texels, pixels, &pixels.list);
        stage.run(&self.recover, &buffers, Groups::Indirect(pixels.args.raw(), 0))
    }

    fn buffers<'a>(
        frame: &'a wgpu::Buffer,
        seen: Seen<'a>,
        texels: &'a SpsmTexels,
        pixels: &'a SpsmPixels,
        kept: &'a Buffer<u32>,
    ) -> Vec<(&'static str, &'a wgpu::Buffer)> {
        let mut buffers = seen.buffers(frame);
        buffers.extend(texels.read_buffers());
        buffers.extend([
            ("patterns", pixels.patterns.raw()),
            ("visibility", pixels.visibility.raw()),
            ("lit", pixels.lit.raw()),
            ("marks", pixels.marks.raw()),
            ("kept", kept.raw()),
        ]);
        buffers
    }
}
