//! Shadows by depth comparison (Williams 1978), filtered over texels or not (Reeves, Salesin, Cook 1987): over a square of them, or at the taps
//! of a disc.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the nearest depth at each texel
//!   centre (`nearest_keys` of `light_layers`), the taps of a disc.
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is settled early and nothing is exact: the bias decides.
//! - **Cost.** One dispatch over pixels; per sample one texel read, or as many as the kernel or the disc has.

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
    /// Taps of a disc in place of the filter: 0 for none, up to [`MOST_TAPS`](crate::tap_disc::MOST_TAPS). The receiver's depth is taken at each.
    pub taps: u32,
    /// Turn the disc by an angle that follows from the pixel's place in the image.
    pub turned: bool,
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
            paraboloids: 1,
            kernel: options.kernel,
            bias_constant: options.constant,
            bias_slope: options.slope,
            receiver_plane: u32::from(options.receiver_plane),
            taps: options.taps,
            turned: u32::from(options.turned),
        };
        Self { compare: kernel::CompareProgram::new(device, constants) }
    }

    /// Records the comparison of every pixel; `disc`: its taps, read if there are any.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        (nearest_keys, disc): (&Buffer<u32>, &Buffer<[f32; 4]>),
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            nearest_keys: nearest_keys.as_read(),
            disc: disc.as_uniform(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
