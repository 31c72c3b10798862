//! Shadows of the triangles that a light-view map keeps: Reconstructable Geometry Shadow Maps (Dai, Yang, Feng 2008).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, and of each texel the complement of the triangle
//!   that is nearest at its centre ([`LightLayers::with_triangles`](super::light_layers::LightLayers::with_triangles)).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. A sample is in shadow only of triangles that are there; it is lit of those that no texel around
//!   it keeps.
//! - **Cost.** One dispatch over pixels: for each texel that samples of a pixel fall into, as many texel reads as there are look-ups, and for
//!   each other triangle among these a test of each of the samples.
//! - **Source.** Lecocq 2013, section 2 and figure 13, describes the method, whose own paper is a poster.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::kept_triangles as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// Settings that the pipeline is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptTrianglesOptions {
    /// Texels a side that are asked around a sample's: 1, 3, 5 or 7.
    pub lookups: u32,
    /// Depth by which a triangle must lie before a sample to shadow it.
    pub bias: f32,
    /// Words of 32 samples.
    pub words: u32,
    /// Whether triangles may be alpha-tested.
    pub alpha: bool,
}

/// The pipeline.
#[derive(Debug)]
pub struct KeptTriangles {
    look_up: kernel::LookUpProgram,
}

impl KeptTriangles {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, options: KeptTrianglesOptions) -> Self {
        let KeptTrianglesOptions { lookups, bias, words, alpha } = options;
        let constants = kernel::Constants { paraboloids: 0, lookups, bias, words, alpha: u32::from(alpha) };
        Self { look_up: kernel::LookUpProgram::new(device, constants) }
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        triangle_keys: &Buffer<u32>,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::LookUp {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            triangle_keys: triangle_keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.look_up, bindings, Groups::Items(visibility.len() as u64));
    }
}
