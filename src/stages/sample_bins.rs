//! Alias-free hard shadows: the samples, sorted by the texel they project to, against every caster that touches it.
//!
//! - **Reads** undecided facets with their coverage masks, sample offsets, triangles, positions, the casters' blocks of texels.
//! - **Writes** the occluded mask of each undecided facet, and overwrites its invalid mask: whoever wants that makes it
//!   afterwards.
//! - **Guarantee.** Bit-equal from run to run, whatever the order in a bin. A sample farther than 1/256 pixel from every shadow
//!   edge is decided as in exact arithmetic. There is no bias, and the size of the map changes the time alone. Casters that
//!   the light's map cannot hold, behind a point light or beside its view, cast nothing.
//! - **Capacity.** One place a sample of a band, and a quarter as many for doubts; facets are taken in bands of at most 2^21
//!   samples, of which those beyond the last undecided facet do nothing. With less room for doubts the masks are the same; to make them takes longer.
//! - **Cost.** For each band two dispatches over its samples, one over the casters' blocks, one over doubts, and three that
//!   rarely find something to do and then have no workgroups; 20 bytes a sample.
//! - **Source.** Aila and Laine, *Alias-Free Shadow Maps*, EGSR 2004; Johnson, Lee, Burns, Mark, *The Irregular Z-Buffer*, ACM
//!   TOG 2005; Sintorn, Eisemann, Assarsson, *Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps*, EGSR 2008.

use super::camera_visibility::{Blocks, Pass};
use super::compact::{self, Compact, Flags};
use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::facet_classify::Facets;
use super::{Count, PrefixScan, holds, prefix_scan};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::sample_bins as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct SampleBins {
    bin: kernel::BinProgram,
    occlude: kernel::OccludeProgram,
    refine: kernel::RefineProgram,
    refine_all: kernel::RefineAllProgram,
    occlude_crowds: kernel::OccludeCrowdsProgram,
    refine_crowds: kernel::RefineCrowdsProgram,
    ask: kernel::AskProgram,
    fold: DispatchArgs,
    compact: Compact,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// The samples of one band, by texel.
#[derive(Debug)]
pub struct Bins {
    /// Point of each sample relative to the eye, and which it is; then doubts.
    pub list: Buffer<[u32; 4]>,
    /// Undecided facets, rising.
    pub listed: Buffer<u32>,
    /// How many there are, and 0.
    pub total: Buffer<u32>,
    /// Samples of each texel, then where they end; how many doubts and crowded texels there are; the facets of the band.
    pub texel_ends: Buffer<u32>,
    /// First sample of each texel, the end, and 0.
    pub texel_offsets: Buffer<u32>,
    wanted: Buffer<u32>,
    requests: Requests,
    args: Buffer<u32>,
    scratch: prefix_scan::PrefixScanScratch,
    compact_scratch: compact::CompactScratch,
    /// Facets of a band; the last may have fewer.
    pub facets: usize,
    /// The frame of each band.
    pub frames: Vec<Buffer<Frame>>,
}

/// Runs whose number of workgroups the GPU finds, and items of a workgroup: blocks of casters, or doubts.
const RUNS: [u32; 5] = [kernel::WORKGROUP / kernel::LANES, 1, kernel::WORKGROUP, kernel::WORKGROUP / kernel::LANES, 1];

impl Bins {
    /// Memory for `facets` facets of `samples` samples in as many bands as it takes, and a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: usize, facets: usize, samples: u32) -> Result<Self> {
        Self::with_band(device, queue, size, facets, samples, kernel::MOST_SAMPLES as usize / samples.max(1) as usize)
    }

    /// As [`Bins::new`] with bands of at most so many facets.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn with_band(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size: usize,
        facets: usize,
        samples: u32,
        most: usize,
    ) -> Result<Self> {
        let band = facets.min(most.min(kernel::MOST_SAMPLES as usize / samples.max(1) as usize)).max(1);
        let frames = (0..facets.div_ceil(band)).map(|_| Buffer::uniform(device, "sample_bins.frame", 1));
        let requests = RUNS.iter().enumerate();
        let requests = requests.map(|(k, &items)| ArgsRequest::new(k, items, ArgsRequest::MAX_LIMIT, 3 * k));
        Ok(Self {
            wanted: Buffer::storage(device, "sample_bins.wanted", RUNS.len())?,
            requests: DispatchArgs::requests(device, queue, &requests.collect::<Result<Vec<_>>>()?)?,
            args: Buffer::indirect(device, "sample_bins.args", 3 * RUNS.len())?,
            list: Buffer::storage(device, "sample_bins.list", 5 * (band * samples as usize).div_ceil(4))?,
            listed: Buffer::storage(device, "sample_bins.listed", facets)?,
            total: Buffer::storage(device, "sample_bins.total", 2)?,
            texel_ends: Buffer::storage(device, "sample_bins.texel_ends", size * size + 2 + band)?,
            texel_offsets: Buffer::storage(device, "sample_bins.texel_offsets", size * size + 2)?,
            scratch: PrefixScan::scratch(device, size * size)?,
            compact_scratch: Compact::scratch(device, facets)?,
            facets: band,
            frames: frames.collect::<Result<_>>()?,
        })
    }

    /// Workgroups of one of [`RUNS`].
    fn groups(&self, run: u64) -> Groups<'_> {
        Groups::Indirect(self.args.raw(), 3 * run)
    }

    /// Writes the frame of each band: which of the listed facets it takes, of `frame.facets_total` at most.
    pub fn prepare(&self, queue: &wgpu::Queue, frame: &Frame) {
        self.frames_of(frame).for_each(|(buffer, frame)| buffer.write(queue, &[frame]));
    }

    /// The uniform of each band, and what [`Bins::prepare`] writes there.
    pub fn frames_of(&self, frame: &Frame) -> impl Iterator<Item = (&Buffer<Frame>, Frame)> {
        self.frames.iter().enumerate().map(|(band, buffer)| {
            let first = ((band * self.facets) as u32).min(frame.facets_total);
            let count = (self.facets as u32).min(frame.facets_total - first);
            (buffer, Frame { first_facet: first, facet_count: count, ..*frame })
        })
    }
}

/// Inputs of the stage besides its bins.
#[derive(Clone, Copy, Debug)]
pub struct BinInputs<'a> {
    /// Sample offsets.
    pub samples: &'a Buffer<[f32; 4]>,
    /// The casters' blocks of texels.
    pub blocks: Blocks<'a>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a Buffer<[f32; 4]>,
    /// Facets and masks.
    pub facets: &'a Facets,
}

impl SampleBins {
    /// Builds the pipelines for masks of `words` words and casters without holes; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, words: u32) -> Self {
        Self::specialised(device, scan, words, false)
    }

    /// As [`SampleBins::new`]; casters may be alpha-tested if `alpha` says so.
    pub fn specialised(device: &wgpu::Device, scan: &PrefixScan, words: u32, alpha: bool) -> Self {
        let constants = kernel::Constants { words, alpha: u32::from(alpha) };
        Self {
            bin: kernel::BinProgram::new(device, constants),
            occlude: kernel::OccludeProgram::new(device, constants),
            refine: kernel::RefineProgram::new(device, constants),
            refine_all: kernel::RefineAllProgram::new(device, constants),
            occlude_crowds: kernel::OccludeCrowdsProgram::new(device, constants),
            refine_crowds: kernel::RefineCrowdsProgram::new(device, constants),
            ask: kernel::AskProgram::new(device, constants),
            fold: DispatchArgs::new(device),
            compact: Compact::new(device, scan),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the list of undecided facets, from which bands are taken. There must be as many facets as `bins` is made for.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there are more.
    pub fn record_list(&self, stage: &mut Stage, facets: &Facets, bins: &Bins) -> Result<()> {
        holds("sample_bins", "listed", bins.listed.len(), facets.list.len())?;
        let (flags, count) = (Flags::Words(&facets.items), Count::Exactly(facets.list.len()));
        self.compact.record(stage, flags, None, &bins.listed, (&bins.total, 0), &bins.compact_scratch, count)
    }

    /// Records the bins of one band of the listed facets. `texel_ends` must be 0 before run 0, which counts, and begin with `texel_offsets` before
    /// run 1, which fills.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_bin(&self, stage: &mut Stage, run: u32, band: usize, scene: BinInputs, bins: &Bins) -> Result<()> {
        let pass = self.pass(stage.device, run)?;
        let bindings = Self::bindings(&pass, band, scene, bins)?;
        stage.run(&self.bin, bindings, Groups::Items(bins.list.len() as u64 / 5 * 4));
        if run == 1 {
            return Ok(());
        }
        let (counts, offsets) = (&bins.texel_ends, &bins.texel_offsets);
        let count = offsets.len() - 2;
        self.scan.record(stage, counts, offsets, (offsets, count), &bins.scratch, Count::Exactly(count))
    }

    /// Records the tests of one band in single precision.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_occlude(&self, stage: &mut Stage, band: usize, scene: BinInputs, bins: &Bins) -> Result<()> {
        let pass = self.pass(stage.device, 0)?;
        let bindings = Self::bindings(&pass, band, scene, bins)?;
        self.record_args(stage, bindings, bins)?;
        stage.run(&self.occlude, bindings, bins.groups(0));
        stage.run(&self.occlude_crowds, bindings, bins.groups(1));
        Ok(())
    }

    /// Records the tests that single precision left open.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_refine(&self, stage: &mut Stage, band: usize, scene: BinInputs, bins: &Bins) -> Result<()> {
        let pass = self.pass(stage.device, 0)?;
        let bindings = Self::bindings(&pass, band, scene, bins)?;
        self.record_args(stage, bindings, bins)?;
        stage.run(&self.refine, bindings, bins.groups(2));
        stage.run(&self.refine_all, bindings, bins.groups(3));
        stage.run(&self.refine_crowds, bindings, bins.groups(4));
        Ok(())
    }

    /// Records how many workgroups the runs over the casters' blocks have, and over the doubts.
    fn record_args(&self, stage: &mut Stage, bindings: kernel::Bins, bins: &Bins) -> Result<()> {
        stage.run(&self.ask, bindings, Groups::Workgroups(1));
        self.fold.record(stage, &bins.wanted, &bins.requests, &bins.args)
    }

    fn pass(&self, device: &wgpu::Device, run: u32) -> Result<Buffer<Pass>> {
        self.uniforms.get(device, &Pass { index: run })
    }

    fn bindings<'a>(
        pass: &'a Buffer<Pass>,
        band: usize,
        scene: BinInputs<'a>,
        bins: &'a Bins,
    ) -> Result<kernel::Bins<'a>> {
        holds("sample_bins", "bands", bins.frames.len(), band + 1)?;
        let BinInputs { samples, blocks, positions, facets } = scene;
        Ok(kernel::Bins {
            frame: bins.frames[band].as_uniform(),
            samples: samples.as_uniform(),
            step: pass.as_uniform(),
            undecided: facets.undecided.as_read(),
            triangles: blocks.triangles.as_read(),
            positions: positions.as_read(),
            masks: facets.masks.as_write(),
            texel_ends: bins.texel_ends.as_write(),
            bins: bins.list.as_write(),
            light_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            listed: bins.listed.as_read(),
            listed_total: bins.total.as_read(),
            wanted: bins.wanted.as_write(),
        })
    }
}
