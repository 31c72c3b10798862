//! A shadow map that is made finer page by page for as long as that changes what pixels see.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the box of the samples; the texels of the pages
//!   of the round, by [`page_casters`](super::page_casters).
//! - **Writes**, in rounds of one level of the tree each, of each pixel its level; of each node whether its page is made, the levels with pages that
//!   may hold it or lie in it, and how many pixels changed there; `visibility`, the mean over the samples whose rays meet the receiver, 1 where
//!   the pixel sees nothing; how many pages all rounds made and asked for.
//! - **Guarantee.** Bit-equal from run to run. The first round makes the finest level of which the budget takes all pages, or the map's. A pixel goes on to the
//!   next level, no finer than by [`PageRule::Matched`](super::page_requests::PageRule), where it touches a page in which as many pixels
//!   changed as make it worth it; in the first round all do. Each round makes no more pages than the budget, those with the most changes, in
//!   classes of a quarter of a double; a pixel without a page stays as it is.
//! - **Cost.** A round: two dispatches over pixels, one over nodes, scan and table of these, and [`page_casters`](super::page_casters).
//!   24 bytes a node, 8 a pixel, and the texels of one round.
//! - **Source.** Giegl, Wimmer 2007 ("Queried virtual shadow maps"): occlusion queries of a tile at a time there, atomic counts of
//!   all pages of a level at once here.

use super::page_casters::PageTexels;
use super::page_requests::{PageNodes, PageNumbers, PageTree};
use super::{PrimaryHits, holds};
use crate::frame::Frame;
use crate::gpu::kernels::page_refinement as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Recorder, Stage, Uniforms};
use crate::stages::camera_visibility::Pass;
use crate::{Error, Result};
use std::ops::RangeInclusive;

/// Settings that the pipelines are compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageRefinementOptions {
    /// The tree.
    pub tree: PageTree,
    /// Pages that a round may make: 1 to [`PageTree::MOST_PAGES`].
    pub budget: u32,
    /// Levels beyond that whose texels are no longer than a pixel.
    pub finer: u32,
    /// Pixels that have to change in a page for a finer one.
    pub changed: u32,
    /// Constant bias, and times the steeper slope of the receiver per texel of the page.
    pub bias: [f32; 2],
}

impl PageRefinementOptions {
    /// The levels of the rounds.
    pub fn rounds(&self) -> RangeInclusive<u32> {
        let first = (self.budget.max(1).ilog2() / 2).min(self.tree.base);
        first..=self.tree.last
    }
}

/// Findings of the rounds.
#[derive(Debug)]
pub struct PageChanges {
    /// Pixels that changed in each node's page.
    pub changes: Buffer<u32>,
    /// Pages that all rounds made, and those that they asked for.
    totals: Buffer<u32>,
}

impl PageChanges {
    /// Memory for a tree.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, tree: PageTree) -> Result<Self> {
        Ok(Self {
            changes: Buffer::storage(device, "page_refinement.changes", tree.nodes())?,
            totals: Buffer::storage(device, "page_refinement.totals", 2)?,
        })
    }

    /// Records that nothing has changed yet.
    pub fn clear(&self, rec: &mut Recorder) {
        rec.clear(self.changes.raw());
        rec.clear(self.totals.raw());
    }

    /// Pages that all rounds made, and those that they asked for.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    pub fn counts(&self, gpu: &Gpu) -> Result<[u32; 2]> {
        let totals = self.totals.read(gpu)?;
        Ok([0, 1].map(|word| totals.get(word).copied().unwrap_or_default()))
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct PageRefinement {
    ask: kernel::AskProgram,
    choose: kernel::ChooseProgram,
    compare: kernel::CompareProgram,
    numbers: PageNumbers,
    rounds: RangeInclusive<u32>,
    uniforms: Uniforms,
}

impl PageRefinement {
    /// Classes of numbers of changed pixels: words before the nodes in [`PageNodes::requests`].
    pub const CLASSES: u32 = kernel::CLASSES;

    /// Builds the pipelines.
    ///
    /// # Errors
    /// [`Error::Config`] for a budget that no memory holds.
    pub fn new(device: &wgpu::Device, options: PageRefinementOptions) -> Result<Self> {
        let (rounds, most) = (options.rounds(), PageTree::MOST_PAGES);
        let PageRefinementOptions { tree, budget, finer, changed, bias: [bias_constant, bias_slope] } = options;
        if !(1..=most).contains(&budget) {
            return Err(Error::Config(format!("page_refinement: {budget} pages; 1 to {most} are possible")));
        }
        let constants = kernel::Constants {
            paraboloids: 0,
            finer,
            first: *rounds.start(),
            changed: changed.max(1),
            budget,
            bias_constant,
            bias_slope,
            page_base: tree.base,
            page_last: tree.last,
        };
        Ok(Self {
            ask: kernel::AskProgram::new(device, constants),
            choose: kernel::ChooseProgram::new(device, constants),
            compare: kernel::CompareProgram::new(device, constants),
            numbers: PageNumbers::new(device),
            rounds,
            uniforms: Uniforms::default(),
        })
    }

    /// The pipelines that number the pages.
    pub fn numbers(&self) -> &PageNumbers {
        &self.numbers
    }

    /// The levels of the rounds, one after the other.
    pub fn rounds(&self) -> RangeInclusive<u32> {
        self.rounds.clone()
    }

    /// Records which pages of a round's level are made. [`PageNodes::requests`] must be 0 before, and before the first round `found`.
    ///
    /// # Errors
    /// [`Error::Config`] if `nodes` or `found` is for fewer pixels or another tree; [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_choice(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        (nodes, found): (&PageNodes, &PageChanges),
        level: u32,
    ) -> Result<()> {
        holds("page_refinement", "levels", nodes.levels.len(), seen.id_keys.len())?;
        holds("page_refinement", "changes", found.changes.len(), nodes.tree.nodes())?;
        let step = self.uniforms.get(stage.device, &Pass { index: level })?;
        let ask = kernel::Ask {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            requests: nodes.requests.as_write(),
            levels: nodes.levels.as_write(),
            changes: found.changes.as_write(),
        };
        stage.run(&self.ask, ask, Groups::Items(seen.id_keys.len() as u64));
        let choose = kernel::Choose {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            requests: nodes.requests.as_write(),
            flags: nodes.flags.as_write(),
            masks: nodes.masks.as_write(),
            totals: found.totals.as_write(),
        };
        stage.run(&self.choose, choose, Groups::Items(nodes.tree.nodes() as u64));
        self.numbers.record(stage, nodes)
    }

    /// Records the comparison of every pixel of a round's level, whose pages are made, and counts what changed.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_compare(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        (nodes, texels, found): (&PageNodes, &PageTexels, &PageChanges),
        level: u32,
        visibility: &Buffer<f32>,
    ) -> Result<()> {
        let step = self.uniforms.get(stage.device, &Pass { index: level })?;
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            step: step.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            levels: nodes.levels.as_write(),
            changes: found.changes.as_write(),
            table: nodes.table.as_read(),
            pages: texels.keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
        Ok(())
    }
}
