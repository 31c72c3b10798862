//! Shadows by depth comparison whose borders are drawn anew: Shadow Map Silhouette Revectorization (Bondarev 2014).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the nearest depth at each texel
//!   centre (`nearest_keys` of `light_layers`).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is exact: borders are guessed from the map's steps, and the bias decides.
//! - **Cost.** One dispatch over pixels. Up to 64 texel reads settle a pixel around which all texels are alike; of others five for
//!   each texel that samples fall into, and where it lies at a border two for each texel that this is followed.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::smsr as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// Settings that the pipeline is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmsrOptions {
    /// Texels to either side that a border is followed (the paper's largest search distance, section 2.2): up to 64, beyond
    /// which llvmpipe's bound of an invocation's loops may end them.
    pub reach: u32,
    /// Draw lines through the middles of steps, on both sides of the border; else from the corners of dark texels, as in the paper.
    pub midpoints: bool,
    /// Depth that a receiver is moved towards the light; depth 1 is the extent of the casters along the light.
    pub constant: f32,
    /// Times the steeper slope of the receiver, for each texel away from the pixel: what it is moved besides, as surfaces bend.
    pub slope: f32,
}

/// The pipeline.
#[derive(Debug)]
pub struct Smsr {
    revectorize: kernel::RevectorizeProgram,
}

impl Smsr {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, options: SmsrOptions) -> Self {
        let constants = kernel::Constants {
            paraboloids: 1,
            reach: options.reach,
            midpoints: u32::from(options.midpoints),
            bias_constant: options.constant,
            bias_slope: options.slope,
        };
        Self { revectorize: kernel::RevectorizeProgram::new(device, constants) }
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        nearest_keys: &Buffer<u32>,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Revectorize {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            nearest_keys: nearest_keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.revectorize, bindings, Groups::Items(visibility.len() as u64));
    }
}
