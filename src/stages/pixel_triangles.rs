//! Pixel triangles: pixel by pixel, the triangles that samples in its square may see, and which pixels show one surface.
//!
//! - **Reads** triangles, projected vertices, the rectangles of pixels that triangles may touch and the scan of their blocks.
//! - **Writes** `complex_flags` (1 where the pixel may show several surfaces), `list` (triangles of such pixels, grouped by pixel)
//!   and `offsets`; `facet_counts` (1 where one triangle surely covers the pixel before all others: `id_keys` has its
//!   complement). `cover_keys` and `counts` must be 0 before; `counts` is so again after.
//! - **Guarantee.** Conservative: every triangle that a sample sees is listed at its pixel, and a pixel passes for single
//!   only if its one triangle covers its whole square by a margin far above rounding. Nothing is written beyond the capacity.
//!   The order inside a pixel is not defined; what is made of it does not depend on it.
//! - **Cost.** Four indirect dispatches over blocks (an invocation looks at up to 64 pixels, twice as long as
//!   [`PixelLists::touched`] has room for what it found; at none where triangles that cover all of them hide its own), one over blocks
//!   of the image, one over pixels, a scan.
//! - **Source.** The pair lists of Pan 2009, section 3.3, turned on the camera's view.

use super::camera_visibility::{Blocks, Pass};
use super::{Count, PrefixScan, prefix_scan};
use crate::frame::Frame;
use crate::gpu::kernels::pixel_triangles as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// A pixel that may show several surfaces, and a triangle that may be one of them.
    "shared/raster/pixel_pair" => pub struct PixelPair {
        /// The triangle.
        pub triangle: u32,
        /// The pixel.
        pub pixel: u32,
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct PixelTriangles {
    cover: kernel::CoverProgram,
    cover_blocks: kernel::CoverBlocksProgram,
    count: kernel::CountProgram,
    emit: kernel::EmitProgram,
    emit_rest: kernel::EmitRestProgram,
    judge: kernel::JudgeProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Lists of triangles by pixel.
#[derive(Debug)]
pub struct PixelLists {
    /// Complement of the nearest depth behind which a covering triangle hides everything; 0 where there is none. Behind those of pixels
    /// that of each block of 8 × 8.
    pub cover_keys: Buffer<u32>,
    /// Triangles of each pixel that is listed, while they are counted; later those that cover samples.
    pub counts: Buffer<u32>,
    /// Scan of the counts, their sum, and the overflow flag.
    pub offsets: Buffer<u32>,
    /// Triangles of pixels that may show several surfaces.
    pub list: Buffer<PixelPair>,
    /// Pixels of a block in which its triangle is listed, one bit each, from counting to emitting; what finds no room is
    /// found twice.
    pub touched: Buffer<[u32; 2]>,
    /// 1 for each pixel that may show several surfaces.
    pub complex_flags: Buffer<u32>,
    /// Facets of each pixel.
    pub facet_counts: Buffer<u32>,
}

impl PixelLists {
    /// Memory for `pixels` pixels and `triangles` entries of all lists.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, pixels: usize, triangles: usize) -> Result<Self> {
        Ok(Self {
            cover_keys: Buffer::storage(device, "pixel_triangles.cover_keys", pixels + pixels.div_ceil(8))?,
            counts: Buffer::storage(device, "pixel_triangles.counts", pixels)?,
            offsets: Buffer::storage(device, "pixel_triangles.offsets", pixels + 2)?,
            list: Buffer::storage(device, "pixel_triangles.list", triangles)?,
            touched: Buffer::storage(device, "pixel_triangles.touched", triangles / 4 + pixels / 2)?,
            complex_flags: Buffer::storage(device, "pixel_triangles.complex_flags", pixels)?,
            facet_counts: Buffer::storage(device, "pixel_triangles.facet_counts", pixels)?,
        })
    }
}

impl PixelTriangles {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            cover: kernel::CoverProgram::new(device, ()),
            cover_blocks: kernel::CoverBlocksProgram::new(device, ()),
            count: kernel::CountProgram::new(device, ()),
            emit: kernel::EmitProgram::new(device, ()),
            emit_rest: kernel::EmitRestProgram::new(device, ()),
            judge: kernel::JudgeProgram::new(device, ()),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Records all of it. `rest`: arguments for those blocks that find no room in [`PixelLists::touched`].
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too small for the image.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        rest: (&wgpu::Buffer, u64),
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
        scratch: &prefix_scan::PrefixScanScratch,
        status: &Buffer<u32>,
    ) -> Result<()> {
        self.record_counts(stage, frame, blocks, lists, id_keys)?;
        self.record_lists(stage, frame, blocks, rest, lists, id_keys, (scratch, status))
    }

    /// Records the counts alone. What adds to them runs next, then [`PixelTriangles::record_lists`].
    ///
    /// # Errors
    /// As [`PixelTriangles::record`].
    pub fn record_counts(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
    ) -> Result<()> {
        let (pixels, all) = (lists.counts.len(), blocks.args);
        let kept = self.kept(stage, lists)?;
        let raster = raster(frame, &kept, blocks, lists, id_keys);
        stage.run(&self.cover, raster, Groups::Indirect(all.0, all.1));
        let (of_frame, cover_keys) = (frame.as_uniform(), lists.cover_keys.as_write());
        // At most so many blocks, whatever the image's shape.
        let blocks = Groups::Items(pixels.div_ceil(8) as u64);
        stage.run(&self.cover_blocks, kernel::CoverBlocks { frame: of_frame, cover_keys }, blocks);
        stage.run(&self.count, raster, Groups::Indirect(all.0, all.1));
        Ok(())
    }

    /// Records which pixels are single, and the lists of the others.
    ///
    /// # Errors
    /// As [`PixelTriangles::record`].
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record_lists(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        rest: (&wgpu::Buffer, u64),
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
        (scratch, status): (&prefix_scan::PrefixScanScratch, &Buffer<u32>),
    ) -> Result<()> {
        let (pixels, all) = (lists.counts.len(), blocks.args);
        let kept = self.kept(stage, lists)?;
        let raster = raster(frame, &kept, blocks, lists, id_keys);
        let bindings = kernel::Judge {
            frame: frame.as_uniform(),
            cover_keys: lists.cover_keys.as_write(),
            pixel_counts: lists.counts.as_write(),
            complex_flags: lists.complex_flags.as_write(),
            facet_counts: lists.facet_counts.as_write(),
            status: status.as_write(),
        };
        stage.run(&self.judge, bindings, Groups::Items(pixels as u64));
        let total = (&lists.offsets, pixels);
        self.scan.record(stage, &lists.counts, &lists.offsets, total, scratch, Count::Exactly(pixels))?;
        stage.run(&self.emit, raster, Groups::Indirect(all.0, all.1));
        stage.run(&self.emit_rest, raster, Groups::Indirect(rest.0, rest.1));
        Ok(())
    }

    /// Number of blocks that have room in [`PixelLists::touched`].
    fn kept(&self, stage: &Stage, lists: &PixelLists) -> Result<Buffer<Pass>> {
        self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 })
    }
}

fn raster<'a>(
    frame: &'a Buffer<Frame>,
    kept: &'a Buffer<Pass>,
    blocks: Blocks<'a>,
    lists: &'a PixelLists,
    id_keys: &'a Buffer<u32>,
) -> kernel::Raster<'a> {
    kernel::Raster {
        frame: frame.as_uniform(),
        step: kept.as_uniform(),
        triangles: blocks.triangles.as_read(),
        points: blocks.points.as_read(),
        camera_rects: blocks.rects.as_read(),
        work_offsets: blocks.offsets.as_read(),
        cover_keys: lists.cover_keys.as_write(),
        pixel_counts: lists.counts.as_write(),
        pixel_offsets: lists.offsets.as_read(),
        pixel_list: lists.list.as_write(),
        touched: lists.touched.as_write(),
        id_keys: id_keys.as_write(),
    }
}
