//! Shadow rays: from every sample of the undecided facets a ray to the light through a tree of casters.
//!
//! - **Reads** facets with their coverage masks, sample offsets, the [`CasterTree`], triangles, positions.
//! - **Writes** the occluded mask of each undecided facet, and with `Frame::VALIDITY` the invalid mask.
//! - **Guarantee.** Bit-equal from run to run. A sample farther than 1/256 pixel from every shadow edge is decided as in exact
//!   arithmetic: what `f32` cannot decide is followed again with 46 bits. There is no bias and no self-hit: sides decide.
//! - **Capacity.** Fixed by the number of facets. A walk through more than 60,000 nodes and triangles ends early and is
//!   counted ([`Rays::read`]); 0 means that every answer stands.
//! - **Cost.** Five dispatches to list the undecided facets, three indirect ones over them; a ray takes about as many steps as
//!   the tree has levels, each 80 bytes and eight boxes.
//! - **Source.** Whitted 1980; tree and traversal of Ylitie, Karras, Laine 2017, section 4; the facets of Pan 2009, section 3.1.

use super::facet_classify::Facets;
use super::{Compact, Count, DispatchArgs, PrefixScan, compact, dispatch_args};
use crate::Result;
use crate::caster_tree::{CasterTree, TreePlace};
use crate::gpu::kernels::shadow_rays as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Program, Stage};
use crate::stages::compact::Flags;

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct ShadowRays {
    trace: Program,
    refine: Program,
    refine_all: Program,
    cut: Program,
    compact: Compact,
    fold: DispatchArgs,
}

/// The tree on the GPU.
#[derive(Debug)]
pub struct TreeBuffers {
    /// Where it lies in the frame.
    pub place: Buffer<TreePlace>,
    /// Nodes.
    pub nodes: Buffer<[[u32; 4]; 5]>,
    /// Triangles in the order of its leaves.
    pub casters: Buffer<[[f32; 4]; 3]>,
}

impl TreeBuffers {
    /// Uploads a tree.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, tree: &CasterTree) -> Result<Self> {
        Ok(Self {
            place: Buffer::uniform(device, "shadow_rays.tree", 1)?,
            nodes: Buffer::from_slice(device, queue, "shadow_rays.nodes", &tree.nodes)?,
            casters: Buffer::from_slice(device, queue, "shadow_rays.casters", &tree.triangles)?,
        })
    }
}

/// Which facets are traced, and what was left open of them.
#[derive(Debug)]
pub struct Rays {
    /// The undecided facets, rising.
    pub listed: Buffer<u32>,
    /// How many; the same or 0; walks that ended early; doubts; then the samples of each facet to be followed again; then as
    /// many doubts as there is room for.
    pub work: Buffer<u32>,
    /// Groups of the dispatches over rays, facets, doubts, and rays to be followed again: three words each.
    pub args: Buffer<u32>,
    facets: usize,
    requests: dispatch_args::Requests,
    scratch: compact::Scratch,
}

/// Arguments, by word.
const TRACE_ARGS: usize = 0;
const FACET_ARGS: usize = 3;
const DOUBT_ARGS: usize = 6;
const AGAIN_ARGS: usize = 9;

impl Rays {
    /// Memory for `facets` facets of `samples` samples.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, facets: usize, samples: u32) -> Result<Self> {
        Self::with_doubts(device, queue, facets, samples, facets * (samples as usize / 16).max(1) + 1024)
    }

    /// As [`Rays::new`], with room for this many doubts. The masks are the same with less; to make them takes longer.
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
            dispatch_args::Request::new(0, together, facets, TRACE_ARGS)?,
            dispatch_args::Request::new(0, kernel::WORKGROUP, facets, FACET_ARGS)?,
            dispatch_args::Request::new(3, kernel::WORKGROUP, doubts, DOUBT_ARGS)?,
            dispatch_args::Request::new(1, together, facets, AGAIN_ARGS)?,
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
        Ok([words[0], words[3], words[2]])
    }
}

/// Inputs of the stage besides the facets.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Sample offsets.
    pub samples: &'a wgpu::Buffer,
    /// The tree.
    pub tree: &'a TreeBuffers,
    /// Vertex indices, 16 bytes a triangle: three, and a word that this stage does not read.
    pub triangles: &'a wgpu::Buffer,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a wgpu::Buffer,
}

/// Work on the listed facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Their rays in single precision.
    Trace,
    /// The rays that single precision left open, with 46 bits.
    Refine,
    /// Their invalid masks.
    Cut,
}

impl ShadowRays {
    /// Builds the pipelines for masks of `words` words; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, words: u32) -> Self {
        let program = |entry| Program::new(device, entry, &[("WORDS", f64::from(words))]);
        Self {
            trace: program(kernel::ENTRY_TRACE),
            refine: program(kernel::ENTRY_REFINE),
            refine_all: program(kernel::ENTRY_REFINE_ALL),
            cut: program(kernel::ENTRY_CUT_FACETS),
            compact: Compact::new(device, scan),
            fold: DispatchArgs::new(device),
        }
    }

    /// Records the list of the undecided facets: those with blocks ([`Facets::items`]). Words 1 to 3 of `work` must be 0.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `rays` were made for fewer facets.
    pub fn record_list(&self, stage: &mut Stage, facets: &Facets, rays: &Rays) -> Result<()> {
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
        step: Step,
        frame: &wgpu::Buffer,
        scene: Scene,
        facets: &Facets,
        rays: &Rays,
    ) -> Result<()> {
        super::holds("shadow_rays", "listed", rays.facets, facets.list.len())?;
        let programs: &[(&Program, usize)] = match step {
            Step::Trace => &[(&self.trace, TRACE_ARGS)],
            Step::Refine => {
                self.fold.record(stage, &rays.work, &rays.requests, &rays.args)?;
                &[(&self.refine, DOUBT_ARGS), (&self.refine_all, AGAIN_ARGS)]
            }
            Step::Cut => &[(&self.cut, FACET_ARGS)],
        };
        let buffers = [
            ("frame", frame),
            ("samples", scene.samples),
            ("tree", scene.tree.place.raw()),
            ("undecided", facets.undecided.raw()),
            ("listed", rays.listed.raw()),
            ("work", rays.work.raw()),
            ("nodes", scene.tree.nodes.raw()),
            ("casters", scene.tree.casters.raw()),
            ("triangles", scene.triangles),
            ("positions", scene.positions),
            ("masks", facets.masks.raw()),
        ];
        let run = |&(program, args): &(&Program, usize)| {
            stage.run(program, &buffers, Groups::Indirect(rays.args.raw(), args as u64))
        };
        programs.iter().try_for_each(run)
    }
}
