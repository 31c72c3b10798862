//! Which pages of the light's view the pixels need, and which of them are made: a quadtree with a hard budget of memory.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, the box of the samples.
//! - **Writes** of each pixel the level it asks for, in thirds of a level; of each node of the tree ([`PageTree`]) whether its page is made, and the levels with
//!   pages that hold it or lie in it; by how many thirds all had to be coarser, and how many pages were asked for.
//! - **Guarantee.** Bit-equal from run to run. A pixel asks for the coarsest level whose texels are no longer than its step on its
//!   receiver, to the right or down, whichever is longer, `finer` levels beyond it, as far as single precision tells texels apart. The pages that are made are those asked for, all by
//!   the least number of thirds of a level coarser by which they are no more than the budget. The coarsest page is always made.
//!   By [`PageRule::Fitted`] the view is cut into cells, the pages of level 5 or of the finest, and all pages of a cell are asked for
//!   at the finest level that any pixel in it asks for, which is then that of all its pixels. By [`PageRule::Edges`] pixels away from silhouettes ask for
//!   no finer texels than the map's. By [`PageRule::Tiled`] cells share the budget by the pixels in them, those near silhouettes before others.
//! - **Cost.** One dispatch over pixels, one over nodes, one more of each for cells; 20 bytes a node, 4 a pixel, and 8 a cell.
//! - **Source.** Lefohn, Sengupta, Owens 2007 ("Resolution-matched shadow maps"): all steps on the GPU. Marks in a tree take the place of
//!   its sort of requests. Cells: Giegl, Wimmer 2007 ("Fitted virtual shadow maps"), whose low-resolution buffer of required
//!   resolutions a CPU fills. Edges: Fernando, Fernandez, Bala, Greenberg 2001
//!   ("Adaptive shadow maps"), by marks of silhouettes where theirs looks for steps of depth, and not over several frames. Shares: Arvo 2004
//!   ("Tiled shadow maps").

use super::{PrefixScan, PrimaryHits, SummedArea, holds};
use crate::frame::Frame;
use crate::gpu::kernels::page_requests as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Stage};
use crate::stages::Count;
use crate::stages::prefix_scan::PrefixScanScratch;
use crate::stages::summed_area::{SummedAreaScratch, Texels};
use crate::{Error, Result};

/// The light's view as a quadtree of pages: level `l` has `2^l` a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageTree {
    /// The level whose texels are those of the frame's map.
    pub base: u32,
    /// The finest level.
    pub last: u32,
}

impl PageTree {
    /// Texels a side of a page.
    pub const PAGE: u32 = kernel::PAGE;
    /// Most pages that one binding holds.
    pub const MOST_PAGES: u32 = 32768;
    /// Levels beyond that of the map.
    const BEYOND: u32 = 5;
    /// The finest of all: boxes are 16 bits in halves of its texels.
    const FINEST: u32 = 9;

    /// The tree of a view whose map has `size` texels a side.
    pub fn new(size: u32) -> Self {
        let base = size.div_ceil(Self::PAGE).max(1).next_power_of_two().ilog2();
        Self { base, last: (base + Self::BEYOND).min(Self::FINEST) }
    }

    /// Columns and rows of the grid that holds the pages of all levels.
    pub fn grid(self) -> [usize; 2] {
        [3 << (self.last - 1), 1 << self.last]
    }

    /// Nodes of the grid, of which some are no pages.
    pub fn nodes(self) -> usize {
        self.grid().iter().product()
    }

    /// The node of a page.
    pub fn node(self, level: u32, [x, y]: [u32; 2]) -> usize {
        let side = 1 << self.last;
        let corner = if level == self.last { [0, 0] } else { [side, side - (2 << level)] };
        (corner[1] + y) as usize * self.grid()[0] + (corner[0] + x) as usize
    }

    /// The level whose pages are the cells of [`PageRule::Fitted`].
    pub fn cell_level(self) -> u32 {
        self.last.min(kernel::MOST_CELLS)
    }

    /// Cells of the view.
    pub fn cells(self) -> usize {
        1 << (2 * self.cell_level())
    }

    /// Pages that take as many texels as a map of `size` a side, as far as one binding holds them.
    pub fn pages_of_map(size: u32) -> u32 {
        size.div_ceil(Self::PAGE).pow(2).min(Self::MOST_PAGES)
    }
}

/// The pages of a frame, as far as they are known.
#[derive(Debug)]
pub struct PageNodes {
    /// The tree.
    pub tree: PageTree,
    /// Pages asked for by how much coarser all are, then bits of every node, then two words a cell: see the kernel.
    pub requests: Buffer<u32>,
    /// The level that each pixel asks for, in thirds, which round up.
    pub levels: Buffer<u32>,
    /// Of each node 1 if its page is made, else 0.
    pub flags: Buffer<u32>,
    /// Of each node the levels of which a page is made that holds it or lies in it.
    pub masks: Buffer<u32>,
    /// Summed-area table of the flags.
    pub sat: Buffer<u32>,
    /// Exclusive scan of the flags, their sum, a flag, by how many thirds of a level all are coarser than asked, how many pages were asked for.
    pub table: Buffer<u32>,
    scan_scratch: PrefixScanScratch,
    sat_scratch: SummedAreaScratch,
}

impl PageNodes {
    /// Words behind the nodes in [`PageNodes::table`].
    pub const TAIL: usize = kernel::TABLE_TAIL as usize + 2;

    /// Memory for a tree and an image of `pixels` pixels, to be used with `with`.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, with: &PageNumbers, tree: PageTree, pixels: usize) -> Result<Self> {
        let ([width, height], nodes, head) = (tree.grid(), tree.nodes(), kernel::REQUEST_HEAD as usize);
        Ok(Self {
            tree,
            requests: Buffer::storage(device, "page_requests.requests", head + nodes + 2 * tree.cells())?,
            levels: Buffer::storage(device, "page_requests.levels", pixels)?,
            flags: Buffer::storage(device, "page_requests.flags", nodes)?,
            masks: Buffer::storage(device, "page_requests.masks", nodes)?,
            sat: Buffer::storage(device, "page_requests.sat", nodes)?,
            table: Buffer::storage(device, "page_requests.table", nodes + Self::TAIL)?,
            scan_scratch: PrefixScan::scratch(device, nodes)?,
            sat_scratch: with.summed_area.scratch(device, width, height)?,
        })
    }

    /// Pages that were made, by how many thirds of a level all are coarser than asked for, and pages that were asked for.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    pub fn counts(&self, gpu: &Gpu) -> Result<[u32; 3]> {
        let table = self.table.read(gpu)?;
        let at = self.tree.nodes();
        Ok([0, 2, 3].map(|word| table.get(at + word).copied().unwrap_or_default()))
    }
}

/// Pipelines that number the pages that are made, and count those of a box of the grid.
#[derive(Debug)]
pub struct PageNumbers {
    scan: PrefixScan,
    summed_area: SummedArea,
}

impl PageNumbers {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { scan: PrefixScan::new(device), summed_area: SummedArea::new(device, Texels::Words) }
    }

    /// Records scan and summed-area table of [`PageNodes::flags`].
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record(&self, stage: &mut Stage, nodes: &PageNodes) -> Result<()> {
        let (flags, table, count) = (&nodes.flags, &nodes.table, nodes.tree.nodes());
        self.scan.record(stage, flags, table, (table, count), &nodes.scan_scratch, Count::Exactly(count))?;
        self.summed_area.record(stage, flags, &nodes.sat, &nodes.sat_scratch)
    }
}

/// Settings that the pipelines are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageRequestsOptions {
    /// The tree.
    pub tree: PageTree,
    /// Pages that may be made: 1 to [`PageTree::MOST_PAGES`].
    pub budget: u32,
    /// Levels beyond that whose texels are no longer than a pixel.
    pub finer: u32,
    /// Rule by which pages are asked for.
    pub rule: PageRule,
}

/// Rule by which pages are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PageRule {
    /// Those that a pixel's samples touch, at the level that matches it: resolution-matched shadow maps (Lefohn, Sengupta, Owens 2007).
    #[default]
    Matched,
    /// As `Matched` where a pixel's samples come near a silhouette in the map, elsewhere no finer than the map: adaptive shadow maps (Fernando,
    /// Fernandez, Bala, Greenberg 2001).
    Edges,
    /// All of a cell of the view, at the finest level that a pixel in it asks for: fitted virtual shadow maps (Giegl, Wimmer 2007).
    Fitted,
    /// All of a cell of the view, at the level of its share of the budget by the pixels in it, of which those near a silhouette in the map count
    /// eight times, where that is no finer than by `Fitted`: tiled shadow maps (Arvo 2004).
    Tiled,
    /// A level finer, from a whole coarse map on, wherever that changes what pixels see, no finer than they ask for by `Matched`: queried virtual
    /// shadow maps (Giegl, Wimmer 2007), by [`page_refinement`](super::page_refinement).
    Queried,
}

/// The pipelines.
#[derive(Debug)]
pub struct PageRequests {
    request: kernel::RequestProgram,
    /// Weights of cells, their pages, and the levels of their pixels.
    cells: Option<(Option<kernel::WeighProgram>, kernel::SpreadProgram, kernel::FitProgram)>,
    /// Bound where no table is given.
    no_sat: Buffer<u32>,
    choose: kernel::ChooseProgram,
    numbers: PageNumbers,
}

impl PageRequests {
    /// Builds the pipelines.
    ///
    /// # Errors
    /// [`Error::Config`] for a budget that no memory holds.
    pub fn new(device: &wgpu::Device, options: PageRequestsOptions) -> Result<Self> {
        let PageRequestsOptions { tree, budget, finer, rule } = options;
        if rule == PageRule::Queried {
            return Err(Error::Config("page_requests: pages by what changes are those of page_refinement".to_owned()));
        }
        let (tiled, fitted) = (rule == PageRule::Tiled, rule == PageRule::Fitted);
        let most = PageTree::MOST_PAGES;
        if !(1..=most).contains(&budget) {
            return Err(Error::Config(format!("page_requests: {budget} pages; 1 to {most} are possible")));
        }
        let constants = kernel::Constants {
            paraboloids: 0,
            finer,
            fitted: (tiled || fitted).into(),
            tiled: tiled.into(),
            edges: (rule == PageRule::Edges).into(),
            budget,
            page_base: tree.base,
            page_last: tree.last,
        };
        let of_cells = || {
            let weigh = tiled.then(|| kernel::WeighProgram::new(device, constants));
            (weigh, kernel::SpreadProgram::new(device, constants), kernel::FitProgram::new(device, constants))
        };
        Ok(Self {
            request: kernel::RequestProgram::new(device, constants),
            cells: (tiled || fitted).then(of_cells),
            no_sat: Buffer::storage(device, "page_requests.no_sat", 1)?,
            choose: kernel::ChooseProgram::new(device, constants),
            numbers: PageNumbers::new(device),
        })
    }

    /// The pipelines that number the pages.
    pub fn numbers(&self) -> &PageNumbers {
        &self.numbers
    }

    /// Records which pages the pixels ask for. [`PageNodes::requests`] must be 0 before; `sat` is the summed-area table of the map's marks, which
    /// [`PageRule::Edges`] and `Tiled` ask.
    ///
    /// # Errors
    /// [`Error::Config`] if `nodes` is for fewer pixels.
    pub fn record_request(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        nodes: &PageNodes,
        sat: Option<&Buffer<u32>>,
    ) -> Result<()> {
        holds("page_requests", "levels", nodes.levels.len(), seen.id_keys.len())?;
        let bindings = kernel::Request {
            frame: frame.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            requests: nodes.requests.as_write(),
            levels: nodes.levels.as_write(),
            sat: sat.unwrap_or(&self.no_sat).as_read(),
        };
        let pixels = Groups::Items(seen.id_keys.len() as u64);
        stage.run(&self.request, bindings, pixels);
        if let Some((weigh, spread, fit)) = &self.cells {
            weigh.iter().for_each(|weigh| stage.run(weigh, bindings, Groups::Items(nodes.tree.cells() as u64)));
            stage.run(spread, bindings, Groups::Items(nodes.tree.nodes() as u64));
            stage.run(fit, bindings, pixels);
        }
        Ok(())
    }

    /// Records which of them are made, their numbers, and the table that counts them.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_choose(&self, stage: &mut Stage, nodes: &PageNodes) -> Result<()> {
        let count = nodes.tree.nodes();
        let bindings = kernel::Choose {
            requests: nodes.requests.as_write(),
            flags: nodes.flags.as_write(),
            masks: nodes.masks.as_write(),
            table: nodes.table.as_write(),
        };
        stage.run(&self.choose, bindings, Groups::Items(count as u64));
        self.numbers.record(stage, nodes)
    }
}
