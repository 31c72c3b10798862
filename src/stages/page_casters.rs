//! The nearest caster at every texel centre of the pages that are made.
//!
//! - **Reads** triangles, light-view vertices, their rectangles, and what [`page_requests`](super::page_requests) made of the tree.
//! - **Writes** the keys of the pages' texels (complement of the bits of the depth, 0 where there is none), which must be 0 before.
//! - **Guarantee.** Bit-equal from run to run. A texel holds what [`light_layers`](super::light_layers) finds at the same place in a map of
//!   as many texels a side as the page's level has.
//! - **Capacity.** As many blocks as an indirect dispatch covers, 2^31.
//! - **Cost.** One dispatch over triangles, which looks at one node of the tree where a triangle lies in a page of the finest level that no
//!   pixel asks for; scan and table of owners; one dispatch over 8 × 8 blocks of made pages in the triangles' boxes.

use super::camera_visibility::Blocks;
use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::page_requests::{PageNodes, PageTree};
use super::prefix_scan::PrefixScanScratch;
use super::work_owners::{ListWork, WorkOwners};
use super::{PrefixScan, holds};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::page_casters as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct PageCasters {
    count: kernel::CountProgram,
    raster: kernel::RasterProgram,
    work: ListWork,
}

/// Boxes and work of the triangles, and the pages.
#[derive(Debug)]
pub struct PageTexels {
    /// Keys of the texels, page by page, row by row.
    pub keys: Buffer<u32>,
    rects: Buffer<[u32; 2]>,
    items: Buffer<u32>,
    offsets: Buffer<u32>,
    scan_scratch: PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl PageTexels {
    /// Memory for a mesh of `triangles` triangles and so many pages.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, triangles: usize, pages: u32) -> Result<Self> {
        let texels = pages as usize * PageTree::PAGE.pow(2) as usize;
        let request = ArgsRequest::new(triangles, kernel::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            keys: Buffer::storage(device, "page_casters.pages", texels)?,
            rects: Buffer::storage(device, "page_casters.page_rects", triangles)?,
            items: Buffer::storage(device, "page_casters.page_items", triangles)?,
            offsets: Buffer::storage(device, "page_casters.offsets", WorkOwners::words(triangles, texels))?,
            scan_scratch: PrefixScan::scratch(device, triangles)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "page_casters.args", 3)?,
        })
    }
}

impl PageCasters {
    /// Builds the pipelines for a tree and as many pages as it may make; `alpha`: triangles may be alpha-tested.
    pub fn new(device: &wgpu::Device, tree: PageTree, budget: u32, alpha: bool) -> Self {
        let constants =
            kernel::Constants { budget, page_base: tree.base, page_last: tree.last, alpha: u32::from(alpha) };
        Self {
            count: kernel::CountProgram::new(device, constants),
            raster: kernel::RasterProgram::new(device, constants),
            work: ListWork::new(device, &PrefixScan::new(device)),
        }
    }

    /// Records both: `casters` are the triangles' rectangles, whose list of blocks is not needed.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `texels` is for another mesh.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        casters: Blocks,
        nodes: &PageNodes,
        texels: &PageTexels,
    ) -> Result<()> {
        let triangles = casters.rects.len();
        holds("page_casters", "page_rects", texels.rects.len(), triangles)?;
        let count = kernel::Count {
            frame: frame.as_uniform(),
            triangles: casters.triangles.as_read(),
            map_points: casters.points.as_read(),
            light_rects: casters.rects.as_read(),
            masks: nodes.masks.as_read(),
            sat: nodes.sat.as_read(),
            page_rects: texels.rects.as_write(),
            page_items: texels.items.as_write(),
        };
        stage.run(&self.count, count, Groups::Items(triangles as u64));
        let args = (&texels.requests, &texels.args);
        self.work.record(stage, (&texels.items, triangles), &texels.offsets, &texels.scan_scratch, args)?;
        let raster = kernel::Raster {
            frame: frame.as_uniform(),
            triangles: casters.triangles.as_read(),
            map_points: casters.points.as_read(),
            masks: nodes.masks.as_read(),
            sat: nodes.sat.as_read(),
            boxes: texels.rects.as_read(),
            work_offsets: texels.offsets.as_read(),
            table: nodes.table.as_read(),
            pages: texels.keys.as_write(),
        };
        stage.run(&self.raster, raster, Groups::Indirect(texels.args.raw(), 0));
        Ok(())
    }
}
