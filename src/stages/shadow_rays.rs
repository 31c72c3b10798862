//! Shadow rays: from every sample of the undecided facets a ray to the light through a tree of casters.
//!
//! - **Reads** facets with their coverage masks, sample offsets, the [`CasterTree`](crate::caster_tree::CasterTree), triangles, positions.
//! - **Writes** the occluded mask of each undecided facet, and with `Frame::VALIDITY` the invalid mask.
//! - **Guarantee.** Bit-equal from run to run. A sample farther than 1/256 pixel from every shadow edge is decided as in exact
//!   arithmetic: what `f32` cannot decide is followed again with 46 bits. There is no bias and no self-hit: sides decide.
//! - **Capacity.** Fixed by the number of facets. A walk through more than 60,000 nodes and triangles ends early and is
//!   counted ([`RayLists::read`]); 0 means that every answer stands.
//! - **Cost.** Five dispatches to list the undecided facets, three indirect ones over them; a ray takes about as many steps as
//!   the tree has levels, each 80 bytes and eight boxes.
//! - **Source.** Whitted 1980; tree and traversal of Ylitie, Karras, Laine 2017, section 4; the facets of Pan 2009, section 3.1.

use super::facet_classify::Facets;
use super::{Compact, Count, DispatchArgs, PrefixScan, compact, dispatch_args};
use crate::frame::Frame;
use crate::gpu::kernels::shadow_rays as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Stage};
use crate::stages::compact::Flags;
use crate::{Result, shared_struct};

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct ShadowRays {
    trace: kernel::TraceProgram,
    refine: kernel::RefineProgram,
    refine_all: kernel::RefineAllProgram,
    cut: kernel::CutFacetsProgram,
    compact: Compact,
    fold: DispatchArgs,
}

shared_struct! {
    /// Where the tree lies in a frame: a point `p` of the frame is `p * place.w + place.xyz` in the unit cube.
    "shadow_rays/caster_tree" => pub struct TreePlace {
        /// Offset, and scale.
        pub place: [f32; 4],
        /// Distance by which rounding may move a point in the cube, with room to spare.
        pub slack: f32,
        /// Nodes; 0 if there is no caster.
        pub node_count: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
    }
}

/// The tree on the GPU.
#[derive(Debug)]
pub struct TreeBuffers {
    /// Where it lies in the frame.
    pub place: Buffer<TreePlace>,
    /// Nodes: eight boxes of 8 bits each (Ylitie, Karras, Laine 2017).
    pub nodes: Buffer<[[u32; 4]; 5]>,
    /// Triangles in the order of its leaves.
    pub casters: Buffer<[[f32; 4]; 3]>,
}

impl TreeBuffers {
    /// Uploads a tree: nodes of five vectors each, as [`TreeBuffers::nodes`] holds them, and the triangles of its leaves.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        nodes: &[[[u32; 4]; 5]],
        triangles: &[[[f32; 4]; 3]],
    ) -> Result<Self> {
        Ok(Self {
            place: Buffer::uniform(device, "shadow_rays.tree", 1)?,
            nodes: Buffer::from_slice(device, queue, "shadow_rays.nodes", nodes)?,
            casters: Buffer::from_slice(device, queue, "shadow_rays.casters", triangles)?,
        })
    }
}

/// Facets that are traced, and what was left open of them.
#[derive(Debug)]
pub struct RayLists {
    /// The undecided facets, rising.
    pub listed: Buffer<u32>,
    /// How many; the same or 0; walks that ended early; doubts; then the samples of each facet to be followed again; then as
    /// many doubts as there is room for.
    pub work: Buffer<u32>,
    /// Groups of the dispatches over rays, facets, doubts, and rays to be followed again: three words each.
    pub args: Buffer<u32>,
    facets: usize,
    requests: dispatch_args::Requests,
    scratch: compact::CompactScratch,
}

/// Arguments, by word.
const TRACE_ARGS: usize = 0;
const FACET_ARGS: usize = 3;
const DOUBT_ARGS: usize = 6;
const AGAIN_ARGS: usize = 9;

impl RayLists {
    /// Memory for `facets` facets of `samples` samples.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, facets: usize, samples: u32) -> Result<Self> {
        Self::with_doubts(device, queue, facets, samples, facets * (samples as usize / 16).max(1) + 1024)
    }

    /// As [`RayLists::new`], with room for this many doubts. The masks are the same with less; to make them takes longer.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn with_doubts(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        facets: usize,
        samples: u32,
        doubts: usize,
    ) -> Result<Self> {
        let words = samples.div_ceil(32) as usize;
        let together = kernel::WORKGROUP / samples.clamp(1, 32);
        // Whole quads of words: the kernel takes its room from `arrayLength`, which counts padding, and all of it must be gone through.
        let head = kernel::WORK_HEAD as usize + facets * words;
        let len = (head + 2 * doubts).next_multiple_of(4);
        let doubts = (len - head) / 2;
        let requests = [
            dispatch_args::ArgsRequest::new(0, together, facets, TRACE_ARGS)?,
            dispatch_args::ArgsRequest::new(0, kernel::WORKGROUP, facets, FACET_ARGS)?,
            dispatch_args::ArgsRequest::new(3, kernel::WORKGROUP, doubts, DOUBT_ARGS)?,
            dispatch_args::ArgsRequest::new(1, together, facets, AGAIN_ARGS)?,
        ];
        Ok(Self {
            listed: Buffer::storage(device, "shadow_rays.listed", facets)?,
            work: Buffer::storage(device, "shadow_rays.work", len)?,
            facets,
            args: Buffer::indirect(device, "shadow_rays.args", 12)?,
            requests: DispatchArgs::requests(device, queue, &requests)?,
            scratch: Compact::scratch(device, facets)?,
        })
    }

    /// Facets traced in the last frame, doubts, and walks that ended early.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    pub fn read(&self, gpu: &Gpu) -> Result<[u32; 3]> {
        let words = self.work.read_first(gpu, kernel::WORK_HEAD as usize)?;
        Ok(Self::counts([words[0], words[1], words[2], words[3]]))
    }

    /// The same of the first words of [`RayLists::work`].
    pub fn counts(work: [u32; 4]) -> [u32; 3] {
        [work[0], work[3], work[2]]
    }
}

/// Inputs of the stage besides the facets.
#[derive(Clone, Copy, Debug)]
pub struct RayInputs<'a> {
    /// Sample offsets.
    pub samples: &'a Buffer<[f32; 4]>,
    /// The tree.
    pub tree: &'a TreeBuffers,
    /// Vertex indices, 16 bytes a triangle: three, and a word that tells of holes.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a Buffer<[f32; 4]>,
}

/// Work on the listed facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayStep {
    /// Their rays in single precision.
    Trace,
    /// The rays that single precision left open, with 46 bits.
    Refine,
    /// Their invalid masks.
    Cut,
}

impl ShadowRays {
    /// Builds the pipelines for masks of `words` words and casters without holes; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, words: u32) -> Self {
        Self::specialised(device, scan, words, false)
    }

    /// As [`ShadowRays::new`]; casters may be alpha-tested if `alpha` says so.
    pub fn specialised(device: &wgpu::Device, scan: &PrefixScan, words: u32, alpha: bool) -> Self {
        let constants = kernel::Constants { words, alpha: u32::from(alpha) };
        Self {
            trace: kernel::TraceProgram::new(device, constants),
            refine: kernel::RefineProgram::new(device, constants),
            refine_all: kernel::RefineAllProgram::new(device, constants),
            cut: kernel::CutFacetsProgram::new(device, constants),
            compact: Compact::new(device, scan),
            fold: DispatchArgs::new(device),
        }
    }

    /// Records the list of the undecided facets: those with blocks ([`Facets::items`]). Words 1 to 3 of `work` must be 0.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `rays` were made for fewer facets.
    pub fn record_list(&self, stage: &mut Stage, facets: &Facets, rays: &RayLists) -> Result<()> {
        let (flags, count) = (Flags::Words(&facets.items), Count::Exactly(facets.list.len()));
        self.compact.record(stage, flags, None, &rays.listed, (&rays.work, 0), &rays.scratch, count)?;
        self.fold.record(stage, &rays.work, &rays.requests, &rays.args)
    }

    /// Records a step for the listed facets.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `rays` were made for fewer facets.
    pub fn record(
        &self,
        stage: &mut Stage,
        step: RayStep,
        frame: &Buffer<Frame>,
        scene: RayInputs,
        facets: &Facets,
        rays: &RayLists,
    ) -> Result<()> {
        super::holds("shadow_rays", "listed", rays.facets, facets.list.len())?;
        let bindings = kernel::Trace {
            frame: frame.as_uniform(),
            samples: scene.samples.as_uniform(),
            tree: scene.tree.place.as_uniform(),
            undecided: facets.undecided.as_read(),
            listed: rays.listed.as_read(),
            work: rays.work.as_write(),
            nodes: scene.tree.nodes.as_read().cast(),
            casters: scene.tree.casters.as_read().cast(),
            triangles: scene.triangles.as_read(),
            positions: scene.positions.as_read(),
            masks: facets.masks.as_write(),
        };
        let groups = |args: usize| Groups::Indirect(rays.args.raw(), args as u64);
        match step {
            RayStep::Trace => stage.run(&self.trace, bindings, groups(TRACE_ARGS)),
            RayStep::Refine => {
                self.fold.record(stage, &rays.work, &rays.requests, &rays.args)?;
                stage.run(&self.refine, bindings, groups(DOUBT_ARGS));
                stage.run(&self.refine_all, bindings, groups(AGAIN_ARGS));
            }
            RayStep::Cut => stage.run(&self.cut, bindings, groups(FACET_ARGS)),
        }
        Ok(())
    }
}
