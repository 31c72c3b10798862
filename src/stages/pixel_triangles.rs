//! Pixel triangles: pixel by pixel, the triangles that samples in its square may see, and which pixels show one surface.
//!
//! - **Reads** triangles, projected vertices, the rectangles of pixels that triangles may touch and the scan of their blocks.
//! - **Writes** `list` (triangles, grouped by pixel) and `offsets`; `complex_flags` (1 where the samples must be looked at one
//!   by one); `facet_counts` (1 where one triangle surely covers the pixel before all others). `cover_keys` and `counts` must
//!   be 0 before; `counts` is so again after.
//! - **Guarantee.** Conservative: every triangle that a sample sees is listed at its pixel, and a pixel passes for single
//!   only if its one triangle covers its whole square by a margin far above rounding. Nothing is written beyond the capacity.
//!   The order inside a pixel is not defined; what is made of it does not depend on it.
//! - **Cost.** Four indirect dispatches over blocks (an invocation looks at up to 64 pixels, twice as long as
//!   [`PixelLists::touched`] has room for what it found), one over pixels, a scan.
//! - **Source.** The pair lists of Pan 2009, section 3.3, turned on the camera's view.

use super::camera_visibility::{Blocks, Pass};
use super::{Count, PrefixScan, prefix_scan};
use crate::Result;
use crate::gpu::kernels::pixel_triangles as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};

/// The pipelines.
#[derive(Debug)]
pub struct PixelTriangles {
    cover: Program,
    count: Program,
    emit: Program,
    emit_rest: Program,
    judge: Program,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Lists of triangles by pixel.
#[derive(Debug)]
pub struct PixelLists {
    /// Complement of the nearest depth behind which a covering triangle hides everything; 0 where there is none.
    pub cover_keys: Buffer<u32>,
    /// Triangles of each pixel, while they are counted.
    pub counts: Buffer<u32>,
    /// Scan of the counts, their sum, and the overflow flag.
    pub offsets: Buffer<u32>,
    /// The triangles.
    pub list: Buffer<u32>,
    /// Pixels of a block in which its triangle is listed, one bit each, from counting to emitting; what finds no room is
    /// found twice.
    pub touched: Buffer<[u32; 2]>,
    /// 1 for each pixel that may show several surfaces.
    pub complex_flags: Buffer<u32>,
    /// Facets of each pixel.
    pub facet_counts: Buffer<u32>,
}

impl PixelLists {
    /// Memory for `pixels` pixels and `triangles` entries of all their lists.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, pixels: usize, triangles: usize) -> Result<Self> {
        Ok(Self {
            cover_keys: Buffer::storage(device, "pixel_triangles.cover_keys", pixels)?,
            counts: Buffer::storage(device, "pixel_triangles.counts", pixels)?,
            offsets: Buffer::storage(device, "pixel_triangles.offsets", pixels + 2)?,
            list: Buffer::storage(device, "pixel_triangles.list", triangles)?,
            touched: Buffer::storage(device, "pixel_triangles.touched", triangles / 4)?,
            complex_flags: Buffer::storage(device, "pixel_triangles.complex_flags", pixels)?,
            facet_counts: Buffer::storage(device, "pixel_triangles.facet_counts", pixels)?,
        })
    }
}

impl PixelTriangles {
    /// Word of `status` that takes the longest list of a pixel with several surfaces.
    pub const STATUS_LONGEST: usize = kernel::STATUS_LONGEST as usize;

    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            cover: Program::new(device, kernel::ENTRY_COVER, &[]),
            count: Program::new(device, kernel::ENTRY_COUNT, &[]),
            emit: Program::new(device, kernel::ENTRY_EMIT, &[]),
            emit_rest: Program::new(device, kernel::ENTRY_EMIT_REST, &[]),
            judge: Program::new(device, kernel::ENTRY_JUDGE, &[]),
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
        frame: &wgpu::Buffer,
        blocks: Blocks,
        rest: (&wgpu::Buffer, u64),
        lists: &PixelLists,
        scratch: &prefix_scan::Scratch,
        status: &Buffer<u32>,
    ) -> Result<()> {
        let (pixels, all) = (lists.counts.len(), blocks.args);
        self.raster(stage, &[(&self.cover, all), (&self.count, all)], frame, blocks, lists)?;
        let buffers = [
            ("frame", frame),
            ("cover_keys", lists.cover_keys.raw()),
            ("pixel_counts", lists.counts.raw()),
            ("complex_flags", lists.complex_flags.raw()),
            ("facet_counts", lists.facet_counts.raw()),
            ("status", status.raw()),
        ];
        stage.run(&self.judge, &buffers, Groups::Items(pixels as u64))?;
        let total = (&lists.offsets, pixels);
        self.scan.record(stage, &lists.counts, &lists.offsets, total, scratch, Count::Exactly(pixels))?;
        self.raster(stage, &[(&self.emit, all), (&self.emit_rest, rest)], frame, blocks, lists)
    }

    fn raster(
        &self,
        stage: &mut Stage,
        programs: &[(&Program, (&wgpu::Buffer, u64))],
        frame: &wgpu::Buffer,
        blocks: Blocks,
        lists: &PixelLists,
    ) -> Result<()> {
        let kept = self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 })?;
        let buffers = [
            ("frame", frame),
            ("step", &kept),
            ("triangles", blocks.triangles),
            ("points", blocks.points.raw()),
            ("camera_rects", blocks.rects.raw()),
            ("work_offsets", blocks.offsets.raw()),
            ("cover_keys", lists.cover_keys.raw()),
            ("pixel_counts", lists.counts.raw()),
            ("pixel_offsets", lists.offsets.raw()),
            ("pixel_list", lists.list.raw()),
            ("touched", lists.touched.raw()),
        ];
        programs.iter().try_for_each(|(program, args)| stage.run(program, &buffers, Groups::Indirect(args.0, args.1)))
    }
}
