//! The nearest triangle at every pixel centre, by compute rasterization.
//!
//! - **Reads** triangles, projected vertices, their pixel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `depth_keys` (complement of the bits of view depth in scaled units, 0 where nothing is seen) and `id_keys`
//!   (complement of the triangle, 0 where nothing is seen). Both must be 0 before.
//! - **Guarantee.** Bit-equal from run to run: the nearest depth, and of equal depths the lowest index. A centre on a shared
//!   edge belongs to both triangles, so no closed surface has a hole there.
//! - **Cost.** Two indirect dispatches; one invocation looks at up to 64 pixels.

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

/// The pipeline.
#[derive(Debug)]
pub struct CameraVisibility {
    raster: Program,
    uniforms: Uniforms,
}

/// What the stage reads.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// Vertex indices, three a triangle.
    pub triangles: &'a wgpu::Buffer,
    /// Projected vertices of the view.
    pub points: &'a Buffer<[f32; 4]>,
    /// Rectangle of each triangle.
    pub rects: &'a Buffer<[u32; 2]>,
    /// Exclusive scan of the blocks of each rectangle, and their number after the last.
    pub offsets: &'a Buffer<u32>,
    /// Arguments of a dispatch over all blocks: buffer and word.
    pub args: (&'a wgpu::Buffer, u64),
}

impl CameraVisibility {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { raster: Program::new(device, kernel::ENTRY_RASTER, &[]), uniforms: Uniforms::default() }
    }

    /// Records both runs.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        depth_keys: &Buffer<u32>,
        id_keys: &Buffer<u32>,
    ) -> Result<()> {
        for index in 0..2 {
            let pass = self.uniforms.get(stage.device, &Pass { index });
            let buffers = [
                ("frame", frame),
                ("step", &pass),
                ("triangles", blocks.triangles),
                ("points", blocks.points.raw()),
                ("camera_rects", blocks.rects.raw()),
                ("work_offsets", blocks.offsets.raw()),
                ("depth_keys", depth_keys.raw()),
                ("id_keys", id_keys.raw()),
            ];
            stage.run(&self.raster, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        Ok(())
    }
}
