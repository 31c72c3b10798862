//! The depth by which each texel of a shadow map is compared, from its two nearest.
//!
//! - **Reads** `second_keys`, of [`LightLayers::without_marks`](super::light_layers::LightLayers::without_marks).
//! - **Changes** `nearest_keys` in place (complement of the bits of depth, 0 where nothing shadows).
//! - **Guarantee.** Bit-equal from run to run; a texel without a caster stays so.
//! - **Cost.** One dispatch; 12 bytes a texel.
//! - **Source.** Woo 1992 ("The shadow depth map revisited"), Wang and Molnar 1994 ("Second-depth shadow mapping"), Weiskopf and Ertl 2003
//!   ("Shadow mapping based on dual depth layers"); Scherzer 2011, section 5.1.

use super::light_layers::Layers;
use crate::frame::Frame;
use crate::gpu::kernels::compared_depths as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The depth by which a texel is compared, of its nearest and its second nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DepthRule {
    /// Half way between the two; without a second the texel shadows nothing.
    Midpoint,
    /// The second; without it the texel shadows nothing.
    Second,
    /// Half way between the two, but no more than this beyond the nearest.
    Dual(f32),
}

impl DepthRule {
    /// The last as the program has it: a twentieth of the casters' extent along the light.
    pub const DUAL: Self = Self::Dual(0.05);
}

/// The pipeline.
#[derive(Debug)]
pub struct ComparedDepths {
    settle: kernel::SettleProgram,
}

impl ComparedDepths {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, rule: DepthRule) -> Self {
        let (rule, farthest) = match rule {
            DepthRule::Midpoint => (kernel::MIDPOINT, 0.0),
            DepthRule::Second => (kernel::SECOND, 0.0),
            DepthRule::Dual(farthest) => (kernel::DUAL, farthest),
        };
        Self { settle: kernel::SettleProgram::new(device, kernel::Constants { rule, farthest }) }
    }

    /// Records it, for a map of `size` texels a side.
    pub fn record(&self, stage: &mut Stage, frame: &Buffer<Frame>, layers: &Layers, size: u32) {
        let bindings = kernel::Settle {
            frame: frame.as_uniform(),
            second_keys: layers.second_keys.as_read(),
            nearest_keys: layers.nearest_keys.as_write(),
        };
        let texels = u64::from(size).pow(2);
        stage.run(&self.settle, bindings, Groups::Workgroups(texels.div_ceil(u64::from(kernel::WORKGROUP))));
    }
}
