//! Shadows by a deep shadow map (Lokovic and Veach 2000).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, and the visibility functions of
//!   [`deep_map`](super::deep_map).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver of the light that the four texels around each let pass to it,
//!   bilinearly; 1 where the pixel sees nothing. Outside the map all is lit.
//! - **Guarantee.** Bit-equal from run to run. A bare plane is not dark; where all four texels are lit to a receiver's depth its sample is 1.
//! - **Cost.** One dispatch over pixels; per sample four texels, of each as many words as nodes lie before the receiver, and two.
//! - **Source.** Lokovic and Veach 2000, section 3.2, whose filter is this of a sample and the mean over samples.

use super::PrimaryHits;
use super::deep_map::DeepMapOptions;
use crate::frame::Frame;
use crate::gpu::kernels::deep_shadows as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct DeepShadows {
    ask: kernel::AskProgram,
}

impl DeepShadows {
    /// Builds the pipeline, for maps of these options. `bias`: the depth that a receiver is moved towards the light, depth 1 being the extent of the
    /// casters along it, and times what its plane rises from a texel's middle to its corner.
    pub fn new(device: &wgpu::Device, options: DeepMapOptions, [constant, slope]: [f32; 2]) -> Self {
        let DeepMapOptions { sub_texels: sub, nodes, .. } = options;
        let constants = kernel::Constants { paraboloids: 0, sub, nodes, bias_constant: constant, bias_slope: slope };
        Self { ask: kernel::AskProgram::new(device, constants) }
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        deep: &Buffer<u32>,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Ask {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            deep: deep.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.ask, bindings, Groups::Items(visibility.len() as u64));
    }
}
