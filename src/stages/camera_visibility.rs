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

use super::dispatch_args::{DispatchArgs, Request, Requests};
use crate::Result;
use crate::gpu::kernels::camera_visibility as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};
use crate::shared_struct;

shared_struct! {
    /// Which of a kernel's runs it is, or how many items a kernel keeps for a later run.
    "shared/pass" => pub struct Pass {
        /// The run, or the items.
        pub index: u32,
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct CameraVisibility {
    raster: Program,
    ask: Program,
    settle: Program,
    settle_all: Program,
    take: Program,
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
        let request = |word, args| Request::new(word, kernel::WORKGROUP, Request::MAX_LIMIT, args);
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
    pub triangles: &'a wgpu::Buffer,
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
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            raster: Program::new(device, kernel::ENTRY_RASTER, &[]),
            ask: Program::new(device, kernel::ENTRY_ASK, &[]),
            settle: Program::new(device, kernel::ENTRY_SETTLE, &[]),
            settle_all: Program::new(device, kernel::ENTRY_SETTLE_ALL, &[]),
            take: Program::new(device, kernel::ENTRY_TAKE, &[]),
            fold: DispatchArgs::new(device),
            uniforms: Uniforms::default(),
        }
    }

    /// Records all runs. Keys of `centres` must be 0 before, and so must the first [`Centres::COUNTS`] words of its doubts, and `id_keys`.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        positions: &wgpu::Buffer,
        centres: &Centres,
        id_keys: &Buffer<u32>,
    ) -> Result<()> {
        let buffers = |pass| {
            [
                ("frame", frame),
                ("step", pass),
                ("triangles", blocks.triangles),
                ("points", blocks.points.raw()),
                ("camera_rects", blocks.rects.raw()),
                ("work_offsets", blocks.offsets.raw()),
                ("keys", centres.keys.raw()),
                ("id_keys", id_keys.raw()),
                ("doubts", centres.doubts.raw()),
                ("positions", positions),
            ]
        };
        let pass = |index| self.uniforms.get(stage.device, &Pass { index });
        let passes = [pass(0)?, pass(1)?, pass(2)?];
        for pass in &passes[..2] {
            stage.run(&self.raster, &buffers(pass), Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        stage.run(&self.ask, &buffers(&passes[0]), Groups::Items(1))?;
        self.fold.record(stage, &centres.doubts, &centres.requests, &centres.args)?;
        for (program, args) in [(&self.settle, 0), (&self.settle_all, 3)] {
            for pass in &passes {
                stage.run(program, &buffers(pass), Groups::Indirect(centres.args.raw(), args))?;
            }
        }
        stage.run(&self.take, &buffers(&passes[0]), Groups::Items(id_keys.len() as u64))
    }
}
