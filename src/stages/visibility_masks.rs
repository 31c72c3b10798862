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
use crate::frame::Frame;
use crate::gpu::kernels::visibility_masks as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines for one number of samples.
#[derive(Debug)]
pub struct VisibilityMasks {
    evaluate: kernel::EvaluateProgram,
    cut: Option<kernel::CutFacetsProgram>,
    refine: kernel::RefineProgram,
}

/// How casters are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Casting {
    /// By the two projections of the paper.
    pub two_step: bool,
    /// Frames may set [`Frame::VALIDITY`](crate::frame::Frame::VALIDITY).
    pub cuts: bool,
    /// Casters may be alpha-tested: they are asked at each sample's own point whether they have a hole there.
    pub alpha: bool,
}

/// Inputs of evaluation besides facets and lists.
#[derive(Clone, Copy, Debug)]
pub struct EvaluationInputs<'a> {
    /// Sample offsets.
    pub samples: &'a Buffer<[f32; 4]>,
    /// Lookup table of masks; not read if its size is 0.
    pub table: &'a Buffer<u32>,
    /// Vertex indices, 16 bytes a triangle: three, and a word that tells of holes.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a Buffer<[f32; 4]>,
}

impl VisibilityMasks {
    /// Builds the pipelines for `samples` samples a pixel, with a lookup table of `angles` by `offsets` masks or, if both are
    /// 0, without.
    pub fn new(device: &wgpu::Device, samples: u32, table: [u32; 2]) -> Self {
        Self::specialised(device, samples, table, Casting { cuts: true, ..Casting::default() })
    }

    /// As [`VisibilityMasks::new`], by the two projections of the paper: from the light onto the facet's plane, then onto the
    /// screen, in single precision. The guarantee is void: no rounding is bounded and nothing is left to refinement. For
    /// comparison.
    pub fn two_step(device: &wgpu::Device, samples: u32, table: [u32; 2]) -> Self {
        Self::specialised(device, samples, table, Casting { two_step: true, cuts: true, ..Casting::default() })
    }

    /// As [`VisibilityMasks::new`] or [`VisibilityMasks::two_step`], with no more code than some casters need.
    pub fn specialised(device: &wgpu::Device, samples: u32, [angles, offsets]: [u32; 2], casting: Casting) -> Self {
        let Casting { two_step, cuts, alpha } = casting;
        let constants = kernel::Constants {
            samples,
            words: samples.div_ceil(32),
            angles,
            offsets,
            cuts: u32::from(cuts),
            alpha: u32::from(alpha),
            ..Default::default()
        };
        let evaluate = kernel::Constants { two_step: u32::from(two_step), ..constants };
        Self {
            evaluate: kernel::EvaluateProgram::new(device, evaluate),
            cut: cuts.then(|| kernel::CutFacetsProgram::new(device, constants)),
            refine: kernel::RefineProgram::new(device, constants),
        }
    }

    /// Records the evaluation of all candidates in single precision.
    pub fn record_evaluate(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        casters: EvaluationInputs,
        facets: &Facets,
        lists: &PairLists,
        args: (&wgpu::Buffer, u64),
    ) {
        let bindings = Self::bindings(frame, casters, facets, lists);
        stage.run(&self.evaluate, bindings, Groups::Indirect(args.0, args.1));
        let Some(cut) = &self.cut else { return };
        // At most 256 an invocation: a device may cut loops off after 65,535 turns.
        let most = (lists.cuts.len() as u64).div_ceil(256 * u64::from(kernel::WORKGROUP));
        let groups = Groups::Strides(most.max(u64::from(kernel::CUT_GROUPS)));
        stage.run(cut, bindings, groups);
    }

    /// Records the evaluation of all doubtful candidates with 46 bits.
    pub fn record_refine(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        casters: EvaluationInputs,
        facets: &Facets,
        lists: &PairLists,
        args: (&wgpu::Buffer, u64),
    ) {
        let bindings = Self::bindings(frame, casters, facets, lists);
        stage.run(&self.refine, bindings, Groups::Indirect(args.0, args.1));
    }

    fn bindings<'a>(
        frame: &'a Buffer<Frame>,
        casters: EvaluationInputs<'a>,
        facets: &'a Facets,
        lists: &'a PairLists,
    ) -> kernel::Evaluate<'a> {
        kernel::Evaluate {
            frame: frame.as_uniform(),
            samples: casters.samples.as_uniform(),
            undecided: facets.undecided.as_read(),
            candidates: lists.candidates.as_write(),
            triangles: casters.triangles.as_read(),
            positions: casters.positions.as_read(),
            masks: facets.masks.as_write(),
            doubts: lists.doubts.as_write(),
            cuts: lists.cuts.as_write(),
            table: casters.table.as_read(),
        }
    }
}
