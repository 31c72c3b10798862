//! The nearest caster at every texel centre of a map whose axes are warped: curved rasterization.
//!
//! - **Reads** triangles, light-view vertices, their rectangles, and the axes of [`axis_density`](super::axis_density).
//! - **Writes** the keys of the warped texels (complement of the bits of the depth, 0 where there is none), which must be 0 before.
//! - **Guarantee.** Bit-equal from run to run. A texel holds what [`light_layers`](super::light_layers) would find at the place that is its centre: half way
//!   between its borders. Triangles are tested where they lie, not between vertices that the warp moves: edges that it bends are no approximation.
//! - **Capacity.** As many blocks as an indirect dispatch covers, 2^31.
//! - **Cost.** One dispatch over triangles; scan and table of owners; one dispatch over 8 × 8 blocks of warped texels in the triangles' boxes.

use super::axis_density::AxisTables;
use super::camera_visibility::Blocks;
use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::prefix_scan::PrefixScanScratch;
use super::work_owners::{ListWork, WorkOwners};
use super::{PrefixScan, holds};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::warped_casters as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct WarpedCasters {
    count: kernel::CountProgram,
    raster: kernel::RasterProgram,
    work: ListWork,
}

/// Boxes and work of the triangles, and the texels.
#[derive(Debug)]
pub struct WarpedTexels {
    /// Keys of the texels, row by row.
    pub keys: Buffer<u32>,
    /// Of each triangle the texels whose centres its box holds, both corners included, packed.
    pub rects: Buffer<[u32; 2]>,
    items: Buffer<u32>,
    offsets: Buffer<u32>,
    scan_scratch: PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl WarpedTexels {
    /// Memory for a mesh of `triangles` triangles and a map of `map` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, triangles: usize, map: u32) -> Result<Self> {
        let texels = (map as usize).pow(2);
        let request = ArgsRequest::new(triangles, kernel::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            keys: Buffer::storage(device, "warped_casters.keys", texels)?,
            rects: Buffer::storage(device, "warped_casters.warped_rects", triangles)?,
            items: Buffer::storage(device, "warped_casters.warped_items", triangles)?,
            offsets: Buffer::storage(device, "warped_casters.offsets", WorkOwners::words(triangles, texels))?,
            scan_scratch: PrefixScan::scratch(device, triangles)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "warped_casters.args", 3)?,
        })
    }
}

impl WarpedCasters {
    /// Builds the pipelines; `alpha`: triangles may be alpha-tested.
    pub fn new(device: &wgpu::Device, alpha: bool) -> Self {
        let constants = kernel::Constants { alpha: u32::from(alpha) };
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
        tables: &AxisTables,
        texels: &WarpedTexels,
    ) -> Result<()> {
        let triangles = casters.rects.len();
        holds("warped_casters", "warped_rects", texels.rects.len(), triangles)?;
        let count = kernel::Count {
            frame: frame.as_uniform(),
            triangles: casters.triangles.as_read(),
            map_points: casters.points.as_read(),
            light_rects: casters.rects.as_read(),
            axes: tables.axes.as_read(),
            borders: tables.borders.as_read(),
            warped_rects: texels.rects.as_write(),
            warped_items: texels.items.as_write(),
        };
        stage.run(&self.count, count, Groups::Items(triangles as u64));
        let args = (&texels.requests, &texels.args);
        self.work.record(stage, (&texels.items, triangles), &texels.offsets, &texels.scan_scratch, args)?;
        let raster = kernel::Raster {
            frame: frame.as_uniform(),
            triangles: casters.triangles.as_read(),
            map_points: casters.points.as_read(),
            borders: tables.borders.as_read(),
            boxes: texels.rects.as_read(),
            work_offsets: texels.offsets.as_read(),
            keys: texels.keys.as_write(),
        };
        stage.run(&self.raster, raster, Groups::Indirect(texels.args.raw(), 0));
        Ok(())
    }
}
