//! Shadows by depth comparison (Williams 1978), filtered over texels or not (Reeves, Salesin, Cook 1987).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the nearest depth at each texel
//!   centre (`nearest_keys` of `light_layers`).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is settled early and nothing is exact: the bias decides.
//! - **Cost.** One dispatch over pixels; per sample one texel read, or as many as the kernel has.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::shadow_map as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// Settings that the pipeline is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowMapOptions {
    /// Texels a side of the filter: 1 for none.
    pub kernel: u32,
    /// Depth that a receiver is moved towards the light; depth 1 is the extent of the casters along the light.
    pub constant: f32,
    /// Times the steeper slope of the receiver per texel: what it is moved besides.
    pub slope: f32,
    /// Take the receiver's depth at each texel of the filter rather than at the sample.
    pub receiver_plane: bool,
}

/// The pipeline.
#[derive(Debug)]
pub struct ShadowMap {
    compare: kernel::CompareProgram,
}

impl ShadowMap {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, options: ShadowMapOptions) -> Self {
        let constants = kernel::Constants {
            kernel: options.kernel,
            bias_constant: options.constant,
            bias_slope: options.slope,
            receiver_plane: u32::from(options.receiver_plane),
        };
        Self { compare: kernel::CompareProgram::new(device, constants) }
    }

    /// Records the comparison of every pixel.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        nearest_keys: &Buffer<u32>,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            nearest_keys: nearest_keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
