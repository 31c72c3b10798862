//! The nearest triangle at every pixel centre, by compute rasterization.
//!
//! - **Reads** triangles, projected vertices and the positions they were made of, their pixel rectangles and the scan of the rectangles'
//!   8 × 8 blocks.
//! - **Writes** `keys`, two words a pixel, which must be 0 before (complement of the triangle, whose upper bit is 1 only where
//!   single precision left it open; and complement of the bits of view depth in scaled units; 0 where nothing is seen), and the complement
//!   of the triangle as `id_keys`.
//! - **Guarantee.** Bit-equal from run to run: the nearest triangle; of those that 46 bits do not tell apart the lowest index. A
//!   centre on a shared edge belongs to both triangles, so no closed surface has a hole there.
//! - **Cost.** Two indirect dispatches; one invocation looks at up to 64 pixels. Three over a list of what single precision leaves open, one
//!   invocation a pixel and triangle; or if that list, a quarter of the pixels long, has not the room, three over all blocks again. One over
//!   the pixels.

use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::camera_visibility as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::shared_struct;

shared_struct! {
    /// Number of a kernel's run, or of the items that a kernel keeps for a later run.
    "shared/frame/pass" => pub struct Pass {
        /// The run, or the items.
        pub index: u32,
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct CameraVisibility {
    raster: kernel::RasterProgram,
    ask: kernel::AskProgram,
    settle: kernel::SettleProgram,
    settle_all: kernel::SettleAllProgram,
    take: kernel::TakeProgram,
    fold: DispatchArgs,
    uniforms: Uniforms,
}

/// Outputs of the stage, one element a pixel.
#[derive(Debug)]
pub struct Centres {
    /// Complements of the triangle and of the bits of the view depth; 0 where nothing is seen.
    pub keys: Buffer<[u32; 2]>,
    /// Four words of counts, then pixel and triangle of what single precision leaves open.
    pub doubts: Buffer<u32>,
    args: Buffer<u32>,
    requests: Requests,
}

impl Centres {
    /// Words at the beginning of [`Centres::doubts`] that must be 0 before.
    pub const COUNTS: usize = 4;

    /// Memory for `pixels` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, pixels: usize) -> Result<Self> {
        let request = |word, args| ArgsRequest::new(word, kernel::WORKGROUP, ArgsRequest::MAX_LIMIT, args);
        let requests = [request(1, 0)?, request(2, 3)?];
        Ok(Self {
            keys: Buffer::storage(device, "camera_visibility.keys", pixels)?,
            doubts: Buffer::storage(device, "camera_visibility.doubts", Self::COUNTS + 2 * (pixels / 4 + 64))?,
            args: Buffer::indirect(device, "camera_visibility.args", 6)?,
            requests: DispatchArgs::requests(device, queue, &requests)?,
        })
    }
}

/// Inputs of the stage.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// Vertex indices, three a triangle, and 1 for one of a closed body.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Projected vertices of the view.
    pub points: &'a Buffer<[f32; 4]>,
    /// Rectangle of each triangle.
    pub rects: &'a Buffer<[u32; 2]>,
    /// Side of the light that each triangle turns to.
    pub facing: &'a Buffer<u32>,
    /// Exclusive scan of the blocks of each rectangle, and their number after the last.
    pub offsets: &'a Buffer<u32>,
    /// Arguments of a dispatch over all blocks: buffer and word.
    pub args: (&'a wgpu::Buffer, u64),
}

impl CameraVisibility {
    /// Builds the pipelines, for triangles without holes.
    pub fn new(device: &wgpu::Device) -> Self {
        Self::specialised(device, false)
    }

    /// As [`CameraVisibility::new`]; triangles may be alpha-tested if `alpha` says so.
    pub fn specialised(device: &wgpu::Device, alpha: bool) -> Self {
        let constants = kernel::Constants { alpha: u32::from(alpha) };
        Self {
            raster: kernel::RasterProgram::new(device, constants),
            ask: kernel::AskProgram::new(device, constants),
            settle: kernel::SettleProgram::new(device, constants),
            settle_all: kernel::SettleAllProgram::new(device, constants),
            take: kernel::TakeProgram::new(device, constants),
            fold: DispatchArgs::new(device),
            uniforms: Uniforms::default(),
        }
    }

    /// Records all runs. Keys of `centres` must be 0 before, and so must the first [`Centres::COUNTS`] words of its doubts, and `id_keys`.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        positions: &Buffer<[f32; 4]>,
        centres: &Centres,
        id_keys: &Buffer<u32>,
    ) -> Result<()> {
        let bindings = |step| kernel::SettleAll {
            frame: frame.as_uniform(),
            step,
            triangles: blocks.triangles.as_read(),
            points: blocks.points.as_read(),
            camera_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            keys: centres.keys.as_write().cast(),
            id_keys: id_keys.as_write(),
            doubts: centres.doubts.as_write(),
            positions: positions.as_read(),
        };
        let pass = |index| self.uniforms.get(stage.device, &Pass { index });
        let passes = [pass(0)?, pass(1)?, pass(2)?];
        for pass in &passes[..2] {
            stage.run(&self.raster, bindings(pass.as_uniform()), Groups::Indirect(blocks.args.0, blocks.args.1));
        }
        stage.run(&self.ask, bindings(passes[0].as_uniform()), Groups::Items(1));
        self.fold.record(stage, &centres.doubts, &centres.requests, &centres.args)?;
        for pass in &passes {
            stage.run(&self.settle, bindings(pass.as_uniform()), Groups::Indirect(centres.args.raw(), 0));
        }
        for pass in &passes {
            stage.run(&self.settle_all, bindings(pass.as_uniform()), Groups::Indirect(centres.args.raw(), 3));
        }
        stage.run(&self.take, bindings(passes[0].as_uniform()), Groups::Items(id_keys.len() as u64));
        Ok(())
    }
}
