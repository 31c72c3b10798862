//! The nearest triangle at every pixel centre, by compute rasterization.
//!
//! - **Reads** triangles, projected vertices, their pixel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `keys`, two words a pixel, which must be 0 before (complement of the triangle, and complement of the bits of view
//!   depth in scaled units; 0 where nothing is seen), and the first of them as `id_keys`.
//! - **Guarantee.** Bit-equal from run to run: the nearest depth, and of equal depths the lowest index. A centre on a shared
//!   edge belongs to both triangles, so no closed surface has a hole there.
//! - **Cost.** One indirect dispatch, without [`Gpu::WIDE_ATOMICS`] two; one invocation looks at up to 64 pixels. One over the
//!   pixels.

use crate::Result;
use crate::gpu::kernels::{camera_visibility as kernel, camera_visibility_64 as wide};
use crate::gpu::{Buffer, Gpu, Groups, Program, Stage, Uniforms};
use crate::shared_struct;

shared_struct! {
    /// Which of a kernel's runs it is, or how many items a kernel keeps for a later run.
    "shared/pass" => pub struct Pass {
        /// The run, or the items.
        pub index: u32,
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct CameraVisibility {
    raster: Program,
    take: Program,
    runs: usize,
    uniforms: Uniforms,
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
        if !device.features().contains(Gpu::WIDE_ATOMICS) {
            return Self::narrow(device);
        }
        Self {
            raster: Program::new(device, wide::ENTRY_RASTER, &[]),
            take: Program::new(device, wide::ENTRY_TAKE, &[]),
            runs: 1,
            uniforms: Uniforms::default(),
        }
    }

    /// Likewise for atomics of 32 bits, whatever the device has.
    pub fn narrow(device: &wgpu::Device) -> Self {
        Self {
            raster: Program::new(device, kernel::ENTRY_RASTER, &[]),
            take: Program::new(device, kernel::ENTRY_TAKE, &[]),
            runs: 2,
            uniforms: Uniforms::default(),
        }
    }

    /// How often it goes through the casters.
    pub fn runs(&self) -> usize {
        self.runs
    }

    /// Records all runs.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        keys: &Buffer<[u32; 2]>,
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
                ("keys", keys.raw()),
                ("id_keys", id_keys.raw()),
            ]
        };
        let pass = |index| self.uniforms.get(stage.device, &Pass { index });
        let passes = [pass(0)?, pass(1)?];
        for pass in passes.iter().take(self.runs) {
            stage.run(&self.raster, &buffers(pass), Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        stage.run(&self.take, &buffers(&passes[0]), Groups::Items(id_keys.len() as u64))
    }
}
