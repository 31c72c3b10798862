//! Alias-free hard shadows: the samples, sorted by the texel they project to, against every caster that touches it.
//!
//! - **Reads** undecided facets with their coverage masks, sample offsets, triangles, positions, the casters' blocks of texels.
//! - **Writes** the occluded mask of each undecided facet, and overwrites its invalid mask: whoever wants that makes it
//!   afterwards.
//! - **Guarantee.** Bit-equal from run to run, whatever the order in a bin. A sample farther than 1/256 pixel from every shadow
//!   edge is decided as in exact arithmetic. There is no bias, and the size of the map changes the time alone. Casters that
//!   the light's map cannot hold, behind a point light or beside its view, cast nothing.
//! - **Capacity.** One place a sample of a band, and a quarter as many for doubts; facets are taken in bands of at most 2^21
//!   samples. With less room for doubts the masks are the same; to make them takes longer.
//! - **Cost.** For each band two dispatches over its samples, one indirect one over the casters' blocks, and one over doubts; 20
//!   bytes a sample.
//! - **Source.** Aila and Laine, *Alias-Free Shadow Maps*, EGSR 2004; Johnson, Lee, Burns, Mark, *The Irregular Z-Buffer*, ACM
//!   TOG 2005; Sintorn, Eisemann, Assarsson, *Sample Based Visibility for Soft Shadows using Alias-free Shadow Maps*, EGSR 2008.

use super::camera_visibility::{Blocks, Pass};
use super::facet_classify::Facets;
use super::{Count, PrefixScan, dispatch_args, holds, prefix_scan};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::sample_bins as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct SampleBins {
    bin: Program,
    occlude: Program,
    refine: Program,
    refine_all: Program,
    occlude_crowds: Program,
    refine_crowds: Program,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// The samples of one band, by texel.
#[derive(Debug)]
pub struct Bins {
    /// Point of each sample relative to the eye, and which it is; then doubts.
    pub list: Buffer<[u32; 4]>,
    /// Samples of each texel, then where they end; and how many doubts and crowded texels there are.
    pub texel_ends: Buffer<u32>,
    /// First sample of each texel, the end, and 0.
    pub texel_offsets: Buffer<u32>,
    scratch: prefix_scan::Scratch,
    /// Facets of a band; the last may have fewer.
    pub facets: usize,
    /// The frame of each band.
    pub frames: Vec<Buffer<Frame>>,
}

impl Bins {
    /// Memory for `facets` facets of `samples` samples in as many bands as it takes, and a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: usize, facets: usize, samples: u32) -> Result<Self> {
        Self::with_band(device, size, facets, samples, kernel::MOST_SAMPLES as usize / samples as usize)
    }

    /// As [`Bins::new`] with bands of at most so many facets.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn with_band(device: &wgpu::Device, size: usize, facets: usize, samples: u32, most: usize) -> Result<Self> {
        let band = facets.min(most.min(kernel::MOST_SAMPLES as usize / samples as usize)).max(1);
        let frames = (0..facets.div_ceil(band)).map(|_| Buffer::uniform(device, "sample_bins.frame", 1));
        Ok(Self {
            list: Buffer::storage(device, "sample_bins.list", 5 * (band * samples as usize).div_ceil(4))?,
            texel_ends: Buffer::storage(device, "sample_bins.texel_ends", size * size + 2)?,
            texel_offsets: Buffer::storage(device, "sample_bins.texel_offsets", size * size + 2)?,
            scratch: PrefixScan::scratch(device, size * size)?,
            facets: band,
            frames: frames.collect::<Result<_>>()?,
        })
    }

    /// Writes the frame of each band; `frame.facets_total` facets in all.
    pub fn prepare(&self, queue: &wgpu::Queue, frame: &Frame) {
        for (band, buffer) in self.frames.iter().enumerate() {
            let first = ((band * self.facets) as u32).min(frame.facets_total);
            let count = (self.facets as u32).min(frame.facets_total - first);
            buffer.write(queue, &[Frame { first_facet: first, facet_count: count, ..*frame }]);
        }
    }
}

/// What the stage reads besides its bins.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Sample offsets.
    pub samples: &'a wgpu::Buffer,
    /// The casters' blocks of texels.
    pub blocks: Blocks<'a>,
    /// Positions, world units, three words a vertex.
    pub positions: &'a wgpu::Buffer,
    /// Facets and masks.
    pub facets: &'a Facets,
}

impl SampleBins {
    /// Builds the pipelines for masks of `words` words; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, words: u32) -> Self {
        let program = |entry| Program::new(device, entry, &[("WORDS", f64::from(words))]);
        Self {
            bin: program(kernel::ENTRY_BIN),
            occlude: program(kernel::ENTRY_OCCLUDE),
            refine: program(kernel::ENTRY_REFINE),
            refine_all: program(kernel::ENTRY_REFINE_ALL),
            occlude_crowds: program(kernel::ENTRY_OCCLUDE_CROWDS),
            refine_crowds: program(kernel::ENTRY_REFINE_CROWDS),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the bins of one band. `texel_ends` must be 0 before run 0, which counts, and begin with `texel_offsets` before
    /// run 1, which fills.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_bin(&self, stage: &mut Stage, run: u32, band: usize, scene: Scene, bins: &Bins) -> Result<()> {
        self.run(stage, &self.bin, run, band, scene, bins, Groups::Items(bins.list.len() as u64 / 5 * 4))?;
        if run == 1 {
            return Ok(());
        }
        let (counts, offsets) = (&bins.texel_ends, &bins.texel_offsets);
        let count = counts.len() - 2;
        self.scan.record(stage, counts, offsets, (offsets, count), &bins.scratch, Count::Exactly(count))
    }

    /// Records the tests of one band in single precision. The arguments of the blocks are those of [`SampleBins::requests`].
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_occlude(&self, stage: &mut Stage, band: usize, scene: Scene, bins: &Bins) -> Result<()> {
        let (args, at) = scene.blocks.args;
        self.run(stage, &self.occlude, 0, band, scene, bins, Groups::Indirect(args, at))?;
        self.run(stage, &self.occlude_crowds, 0, band, scene, bins, Groups::Indirect(args, at + 3))
    }

    /// Records the tests that single precision left open.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if there is no such band.
    pub fn record_refine(&self, stage: &mut Stage, band: usize, scene: Scene, bins: &Bins) -> Result<()> {
        self.run(stage, &self.refine, 0, band, scene, bins, Groups::Items(bins.list.len() as u64 / 5))?;
        let (args, at) = scene.blocks.args;
        self.run(stage, &self.refine_all, 0, band, scene, bins, Groups::Indirect(args, at))?;
        self.run(stage, &self.refine_crowds, 0, band, scene, bins, Groups::Indirect(args, at + 3))
    }

    /// What folds the number of blocks, which is word `count_word` of a buffer, into arguments: eight blocks a workgroup, and
    /// one.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn requests(count_word: usize) -> Result<[dispatch_args::Request; 2]> {
        let most = dispatch_args::Request::MAX_LIMIT;
        let together = kernel::WORKGROUP / kernel::LANES;
        let of = |per, at| dispatch_args::Request::new(count_word, per, most, at);
        Ok([of(together, 0)?, of(1, 3)?])
    }

    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    fn run(
        &self,
        stage: &mut Stage,
        program: &Program,
        run: u32,
        band: usize,
        scene: Scene,
        bins: &Bins,
        groups: Groups,
    ) -> Result<()> {
        holds("sample_bins", "bands", bins.frames.len(), band + 1)?;
        let Scene { samples, blocks, positions, facets } = scene;
        let pass = self.uniforms.get(stage.device, &Pass { index: run });
        let buffers = [
            ("frame", bins.frames[band].raw()),
            ("samples", samples),
            ("step", &pass),
            ("facets", facets.list.raw()),
            ("triangles", blocks.triangles),
            ("positions", positions),
            ("masks", facets.masks.raw()),
            ("texel_ends", bins.texel_ends.raw()),
            ("bins", bins.list.raw()),
            ("light_rects", blocks.rects.raw()),
            ("work_offsets", blocks.offsets.raw()),
        ];
        stage.run(program, &buffers, groups)
    }
}
