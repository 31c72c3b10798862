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
use crate::frame::Frame;
use crate::gpu::kernels::front_layer as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// Value of a texel that holds silhouettes or uncertain layers.
pub const MARKED: f32 = -2.0;
/// Value of a texel that no caster touches.
pub const UNCOVERED: f32 = -1.0;

/// The pipelines.
#[derive(Debug)]
pub struct FrontLayer {
    check: kernel::CheckProgram,
    settle: kernel::SettleProgram,
}

impl FrontLayer {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { check: kernel::CheckProgram::new(device, ()), settle: kernel::SettleProgram::new(device, ()) }
    }

    /// Records the check of every caster against the layers.
    pub fn record_check(&self, stage: &mut Stage, frame: &Buffer<Frame>, blocks: Blocks, layers: &Layers) {
        let bindings = kernel::Check {
            frame: frame.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            facing: blocks.facing.as_read(),
            work_offsets: blocks.offsets.as_read(),
            nearest_keys: layers.nearest_keys.as_read(),
            second_keys: layers.second_keys.as_read(),
            mask: layers.mask.as_write(),
        };
        stage.run(&self.check, bindings, Groups::Indirect(blocks.args.0, blocks.args.1));
    }

    /// Records the writing of `splits`, after `silhouette_mask` has marked its edges.
    pub fn record_settle(&self, stage: &mut Stage, frame: &Buffer<Frame>, layers: &Layers) {
        let bindings = kernel::Settle {
            frame: frame.as_uniform(),
            nearest_keys: layers.nearest_keys.as_read(),
            second_keys: layers.second_keys.as_read(),
            mask: layers.mask.as_write(),
            splits: layers.splits.as_write(),
        };
        stage.run(&self.settle, bindings, Groups::Items(layers.splits.len() as u64));
    }
}
