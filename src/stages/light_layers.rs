//! The nearest and the second nearest caster at every texel centre of the light view.
//!
//! - **Reads** triangles, light-view vertices, their texel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `nearest_keys`, `second_keys` (complement of the bits of depth, 0 where there is none), `tie_counts`, and marks in
//!   `mask` every texel whose layers are not certain. All must be 0 before.
//! - **Guarantee.** Bit-equal from run to run. A texel left unmarked has exactly one caster at its nearest depth, and every
//!   edge passes its centre at a distance far above rounding.
//! - **Cost.** Two indirect dispatches; one invocation looks at up to 64 texels.

use super::camera_visibility::{Blocks, Pass};
use crate::Result;
use crate::gpu::kernels::light_layers as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};

/// The pipeline.
#[derive(Debug)]
pub struct LightLayers {
    raster: Program,
    uniforms: Uniforms,
}

/// What is known of every texel.
#[derive(Debug)]
pub struct Layers {
    /// Key of the nearest depth.
    pub nearest_keys: Buffer<u32>,
    /// Key of the second depth.
    pub second_keys: Buffer<u32>,
    /// Casters at the nearest depth.
    pub tie_counts: Buffer<u32>,
    /// Marked texels, one bit each, rows padded to 32.
    pub mask: Buffer<u32>,
    /// What `front_layer` makes of it all.
    pub splits: Buffer<f32>,
}

impl Layers {
    /// Memory for a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: usize) -> Result<Self> {
        Ok(Self {
            nearest_keys: Buffer::storage(device, "light_layers.nearest_keys", size * size)?,
            second_keys: Buffer::storage(device, "light_layers.second_keys", size * size)?,
            tie_counts: Buffer::storage(device, "light_layers.tie_counts", size * size)?,
            mask: Buffer::storage(device, "light_layers.mask", size * size.div_ceil(32))?,
            splits: Buffer::storage(device, "light_layers.splits", size * size)?,
        })
    }
}

impl Layers {
    /// Memory for the nearest depth alone.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn nearest_only(device: &wgpu::Device, size: usize) -> Result<Self> {
        Ok(Self {
            nearest_keys: Buffer::storage(device, "light_layers.nearest_keys", size * size)?,
            ..Self::new(device, 1)?
        })
    }
}

impl LightLayers {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { raster: Program::new(device, kernel::ENTRY_RASTER, &[]), uniforms: Uniforms::default() }
    }

    /// Records both runs.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(&self, stage: &mut Stage, frame: &wgpu::Buffer, blocks: Blocks, layers: &Layers) -> Result<()> {
        self.record_runs(stage, frame, blocks, layers, 2)
    }

    /// Records the first run alone, which leaves `nearest_keys`: a shadow map.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_nearest(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        layers: &Layers,
    ) -> Result<()> {
        self.record_runs(stage, frame, blocks, layers, 1)
    }

    fn record_runs(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        layers: &Layers,
        runs: u32,
    ) -> Result<()> {
        for index in 0..runs {
            let pass = self.uniforms.get(stage.device, &Pass { index });
            let buffers = [
                ("frame", frame),
                ("step", &pass),
                ("triangles", blocks.triangles),
                ("map_points", blocks.points.raw()),
                ("light_rects", blocks.rects.raw()),
                ("work_offsets", blocks.offsets.raw()),
                ("nearest_keys", layers.nearest_keys.raw()),
                ("second_keys", layers.second_keys.raw()),
                ("tie_counts", layers.tie_counts.raw()),
                ("mask", layers.mask.raw()),
            ];
            stage.run(&self.raster, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        Ok(())
    }
}
