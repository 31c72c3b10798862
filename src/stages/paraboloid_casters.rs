//! The nearest caster at every texel centre of a paraboloid view of the light: curved rasterization.
//!
//! - **Reads** triangles, vertices relative to the eye; the frame's view is a [paraboloid](crate::light_view::LightView::paraboloids) one.
//! - **Writes** the keys of the texels (complement of the bits of the depth, 0 where there is none), which must be 0 before.
//! - **Guarantee.** Bit-equal from run to run. A texel holds the distance at which the ray of its centre meets the first triangle, over that of depth 1: no
//!   vertex is warped and no edge is taken for a straight one, so triangles need not be small.
//! - **Capacity.** As many blocks as an indirect dispatch covers, 2^31.
//! - **Cost.** One dispatch over triangles; scan and table of owners; one dispatch over 8 × 8 blocks of the boxes of their images.
//! - **Source.** Brabec, Annen, Seidel 2002 ("Shadow Mapping for Hemispherical and Omnidirectional Light Sources"), who project the vertices and have
//!   hardware draw straight edges between them.

use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::prefix_scan::PrefixScanScratch;
use super::work_owners::{ListWork, WorkOwners};
use super::{PrefixScan, holds};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::paraboloid_casters as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct ParaboloidCasters {
    count: kernel::CountProgram,
    raster: kernel::RasterProgram,
    work: ListWork,
}

/// Boxes and work of the triangles.
#[derive(Debug)]
pub struct CurvedWork {
    /// Of each triangle the texels that its image's box touches, both corners included, packed.
    pub rects: Buffer<[u32; 2]>,
    items: Buffer<u32>,
    offsets: Buffer<u32>,
    scan_scratch: PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl CurvedWork {
    /// Memory for a mesh of `triangles` triangles and a map of `map` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, triangles: usize, map: u32) -> Result<Self> {
        let texels = (map as usize).pow(2);
        let request = ArgsRequest::new(triangles, kernel::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            rects: Buffer::storage(device, "paraboloid_casters.curved_rects", triangles)?,
            items: Buffer::storage(device, "paraboloid_casters.curved_items", triangles)?,
            offsets: Buffer::storage(device, "paraboloid_casters.offsets", WorkOwners::words(triangles, texels))?,
            scan_scratch: PrefixScan::scratch(device, triangles)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "paraboloid_casters.args", 3)?,
        })
    }
}

impl ParaboloidCasters {
    /// Builds the pipelines; `alpha`: triangles may be alpha-tested.
    pub fn new(device: &wgpu::Device, alpha: bool) -> Self {
        let constants = kernel::Constants { paraboloids: 1, alpha: u32::from(alpha) };
        Self {
            count: kernel::CountProgram::new(device, constants),
            raster: kernel::RasterProgram::new(device, constants),
            work: ListWork::new(device, &PrefixScan::new(device)),
        }
    }

    /// Records both, of `triangles` and their vertices, the first `work.rects.len()`.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `nearest_keys` is for another map than `size` texels a side.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        (triangles, points): (&Buffer<[u32; 4]>, &Buffer<[f32; 4]>),
        work: &CurvedWork,
        (nearest_keys, size): (&Buffer<u32>, u32),
    ) -> Result<()> {
        holds("paraboloid_casters", "nearest_keys", nearest_keys.len(), (size as usize).pow(2))?;
        let count = work.rects.len();
        let boxes = kernel::Count {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            points: points.as_read(),
            curved_rects: work.rects.as_write(),
            curved_items: work.items.as_write(),
        };
        stage.run(&self.count, boxes, Groups::Items(count as u64));
        let args = (&work.requests, &work.args);
        self.work.record(stage, (&work.items, count), &work.offsets, &work.scan_scratch, args)?;
        let raster = kernel::Raster {
            frame: frame.as_uniform(),
            triangles: triangles.as_read(),
            points: points.as_read(),
            boxes: work.rects.as_read(),
            work_offsets: work.offsets.as_read(),
            nearest_keys: nearest_keys.as_write(),
        };
        stage.run(&self.raster, raster, Groups::Indirect(work.args.raw(), 0));
        Ok(())
    }
}
