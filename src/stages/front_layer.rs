//! Proves, texel by texel, that the nearest layer is one sheet that covers the texel.
//!
//! - **Reads** what `light_layers` found, and the blocks of the same casters again.
//! - **Writes** marks into `mask` where the proof fails, and `splits`: a depth that parts the covering sheet from everything
//!   behind it, [`MARKED`] or [`UNCOVERED`].
//! - **Guarantee.** Conservative: a texel is left unmarked only if every caster in it lies wholly before or wholly behind
//!   its split depth. With the silhouette edges marked too, the part before it is one sheet over the whole texel, and a
//!   receiver before the split is lit, behind it in shadow. This takes the place of a depth bias.
//! - **Cost.** One indirect dispatch over blocks, one over texels.

use super::camera_visibility::Blocks;
use super::light_layers::Layers;
use crate::Result;
use crate::gpu::kernels::front_layer as kernel;
use crate::gpu::{Groups, Program, Stage};

/// Value of a texel that holds silhouettes or uncertain layers.
pub const MARKED: f32 = -2.0;
/// Value of a texel that no caster touches.
pub const UNCOVERED: f32 = -1.0;

/// The pipelines.
#[derive(Debug)]
pub struct FrontLayer {
    check: Program,
    settle: Program,
}

impl FrontLayer {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            check: Program::new(device, kernel::ENTRY_CHECK, &[]),
            settle: Program::new(device, kernel::ENTRY_SETTLE, &[]),
        }
    }

    /// Records the check of every caster against the layers.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_check(&self, stage: &mut Stage, frame: &wgpu::Buffer, blocks: Blocks, layers: &Layers) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("triangles", blocks.triangles),
            ("map_points", blocks.points.raw()),
            ("light_rects", blocks.rects.raw()),
            ("facing", blocks.facing.raw()),
            ("work_offsets", blocks.offsets.raw()),
            ("nearest_keys", layers.nearest_keys.raw()),
            ("second_keys", layers.second_keys.raw()),
            ("mask", layers.mask.raw()),
        ];
        stage.run(&self.check, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))
    }

    /// Records the writing of `splits`, after `silhouette_mask` has marked its edges.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_settle(&self, stage: &mut Stage, frame: &wgpu::Buffer, layers: &Layers) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("nearest_keys", layers.nearest_keys.raw()),
            ("second_keys", layers.second_keys.raw()),
            ("mask", layers.mask.raw()),
            ("splits", layers.splits.raw()),
        ];
        stage.run(&self.settle, &buffers, Groups::Items(layers.splits.len() as u64))
    }
}
