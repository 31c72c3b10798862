//! The nearest triangle at every pixel centre, by compute rasterization.
//!
//! - **Reads** triangles, projected vertices and the positions they were made of, their pixel rectangles and the scan of the rectangles'
//!   8 × 8 blocks.
//! - **Writes** `keys`, two words a pixel, which must be 0 before (complement of the triangle, whose upper bit is 1 only where
//!   single precision left it open; and complement of the bits of view depth in scaled units; 0 where nothing is seen), and the complement
//!   of the triangle as `id_keys`.
//! - **Guarantee.** Bit-equal from run to run: the nearest triangle; of those that 46 bits do not tell apart the lowest index. A
//!   centre on a shared edge belongs to both triangles, so no closed surface has a hole there.
//! - **Cost.** Four indirect dispatches; one invocation looks at up to 64 pixels. The last two have nothing to do unless single precision
//!   leaves open which of two triangles is nearer. One over the pixels.

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
    settle: Program,
    take: Program,
    fold: DispatchArgs,
    uniforms: Uniforms,
}

/// Outputs of the stage, one element a pixel.
#[derive(Debug)]
pub struct Centres {
    /// Complements of the triangle and of the bits of the view depth; 0 where nothing is seen.
    pub keys: Buffer<[u32; 2]>,
    /// Blocks to go through again, then one bit for each pixel that single precision leaves open, two words for each 8 × 8 pixels.
    pub doubts: Buffer<u32>,
    args: Buffer<u32>,
    requests: Requests,
}

impl Centres {
    /// Memory for `pixels` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, pixels: usize) -> Result<Self> {
        // No image of so many pixels has more blocks, whatever its width.
        let blocks = pixels.div_ceil(8) + 1;
        let request = Request::new(0, kernel::WORKGROUP, Request::MAX_LIMIT, 0)?;
        Ok(Self {
            keys: Buffer::storage(device, "camera_visibility.keys", pixels)?,
            doubts: Buffer::storage(device, "camera_visibility.doubts", 1 + 2 * blocks)?,
            args: Buffer::indirect(device, "camera_visibility.args", 3)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
        })
    }
}

/// What the stage reads.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// Vertex indices, three a triangle, and 1 for one of a closed body.
    pub triangles: &'a wgpu::Buffer,
    /// Projected vertices of the view.
    pub points: &'a Buffer<[f32; 4]>,
    /// Rectangle of each triangle.
    pub rects: &'a Buffer<[u32; 2]>,
    /// What each triangle is to the light.
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
            settle: Program::new(device, kernel::ENTRY_SETTLE, &[]),
            take: Program::new(device, kernel::ENTRY_TAKE, &[]),
            fold: DispatchArgs::new(device),
            uniforms: Uniforms::default(),
        }
    }

    /// Records all runs. Keys and doubts of `centres` must be 0 before, and so must `id_keys`.
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
        let passes = [pass(0)?, pass(1)?];
        for pass in &passes {
            stage.run(&self.raster, &buffers(pass), Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        self.fold.record(stage, &centres.doubts, &centres.requests, &centres.args)?;
        for pass in &passes {
            stage.run(&self.settle, &buffers(pass), Groups::Indirect(centres.args.raw(), 0))?;
        }
        stage.run(&self.take, &buffers(&passes[0]), Groups::Items(id_keys.len() as u64))
    }
}
