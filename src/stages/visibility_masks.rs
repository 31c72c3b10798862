//! Occlusion and validity masks: which samples of each undecided facet are occluded, and which do not count (Pan 2009,
//! section 3.4).
//!
//! - **Reads** facets, candidates, triangles, positions.
//! - **Writes** the occluded and the invalid mask of each facet, by `atomicOr`; counts in `tally` the candidates that single
//!   precision could not decide.
//! - **Guarantee.** Bit-equal from run to run, whatever the order of the candidates. A sample farther than 1/256 pixel from
//!   every shadow edge is decided as in exact arithmetic: what `f32` does not place that well is computed with 46 bits.
//! - **Cost.** Two indirect dispatches; per candidate about 250 flop and 25 a sample, in one pass over the samples, one atomic a
//!   word that changes.

use super::facet_classify::Facets;
use super::pixel_texel_pairs::PairLists;
use crate::Result;
use crate::gpu::kernels::visibility_masks as kernel;
use crate::gpu::{Groups, Program, Stage};

/// The pipelines for one number of samples.
#[derive(Debug)]
pub struct VisibilityMasks {
    evaluate: Program,
    cut: Option<Program>,
    refine: Program,
}

/// Inputs of evaluation besides facets and lists.
#[derive(Clone, Copy, Debug)]
pub struct Casters<'a> {
    /// Sample offsets.
    pub samples: &'a wgpu::Buffer,
    /// Lookup table of masks; not read if its size is 0.
    pub table: &'a wgpu::Buffer,
    /// Vertex indices, 16 bytes a triangle: three, and a word that this stage does not read.
    pub triangles: &'a wgpu::Buffer,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a wgpu::Buffer,
}

impl VisibilityMasks {
    /// Builds the pipelines for `samples` samples a pixel, with a lookup table of `angles` by `offsets` masks or, if both are
    /// 0, without.
    pub fn new(device: &wgpu::Device, samples: u32, table: [u32; 2]) -> Self {
        Self::specialised(device, samples, table, false, true)
    }

    /// As [`VisibilityMasks::new`], by the two projections of the paper: from the light onto the facet's plane, then onto the
    /// screen, in single precision. The guarantee is void: no rounding is bounded and nothing is left to refinement. For
    /// comparison.
    pub fn two_step(device: &wgpu::Device, samples: u32, table: [u32; 2]) -> Self {
        Self::specialised(device, samples, table, true, true)
    }

    /// As [`VisibilityMasks::new`] or [`VisibilityMasks::two_step`], for frames that set
    /// [`Frame::VALIDITY`](crate::frame::Frame::VALIDITY) only with `cuts`: less code to run without.
    pub fn specialised(
        device: &wgpu::Device,
        samples: u32,
        [angles, offsets]: [u32; 2],
        two_step: bool,
        cuts: bool,
    ) -> Self {
        let constants = [
            ("SAMPLES", f64::from(samples)),
            ("WORDS", f64::from(samples.div_ceil(32))),
            ("ANGLES", f64::from(angles)),
            ("OFFSETS", f64::from(offsets)),
            ("CUTS", f64::from(u8::from(cuts))),
            ("TWO_STEP", f64::from(u8::from(two_step))),
        ];
        Self {
            evaluate: Program::new(device, kernel::ENTRY_EVALUATE, &constants),
            cut: cuts.then(|| Program::new(device, kernel::ENTRY_CUT_FACETS, &constants[..5])),
            refine: Program::new(device, kernel::ENTRY_REFINE, &constants[..5]),
        }
    }

    /// Records the evaluation of all candidates in single precision.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_evaluate(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        casters: Casters,
        facets: &Facets,
        lists: &PairLists,
        args: (&wgpu::Buffer, u64),
    ) -> Result<()> {
        Self::run(stage, &self.evaluate, frame, casters, facets, lists, Groups::Indirect(args.0, args.1))?;
        let Some(cut) = &self.cut else { return Ok(()) };
        // At most 256 an invocation: a device may cut loops off after 65,535 turns.
        let most = (lists.doubts.len() as u64).div_ceil(256 * u64::from(kernel::WORKGROUP));
        let groups = Groups::Strides(most.max(u64::from(kernel::CUT_GROUPS)));
        Self::run(stage, cut, frame, casters, facets, lists, groups)
    }

    /// Records the evaluation of all doubtful candidates with 46 bits.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_refine(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        casters: Casters,
        facets: &Facets,
        lists: &PairLists,
        args: (&wgpu::Buffer, u64),
    ) -> Result<()> {
        Self::run(stage, &self.refine, frame, casters, facets, lists, Groups::Indirect(args.0, args.1))
    }

    fn run(
        stage: &mut Stage,
        program: &Program,
        frame: &wgpu::Buffer,
        casters: Casters,
        facets: &Facets,
        lists: &PairLists,
        groups: Groups,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("samples", casters.samples),
            ("undecided", facets.undecided.raw()),
            ("candidates", lists.candidates.raw()),
            ("table", casters.table),
            ("triangles", casters.triangles),
            ("positions", casters.positions),
            ("masks", facets.masks.raw()),
            ("doubts", lists.doubts.raw()),
        ];
        stage.run(program, &buffers, groups)
    }
}
