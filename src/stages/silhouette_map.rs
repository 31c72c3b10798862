//! Shadows by depths, and between them by the silhouette: Shadow Silhouette Maps (Sen, Cammarano, Hanrahan 2003).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the nearest depth at each texel
//!   centre (`nearest_keys` of `light_layers`), the silhouette's point in each cell between them (`silhouette_points`).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is exact: a cell has one point, and the bias decides.
//! - **Cost.** One dispatch over pixels; per sample four texel reads, and five of points where these do not agree.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::silhouette_map as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct SilhouetteMap {
    compare: kernel::CompareProgram,
}

impl SilhouetteMap {
    /// Builds the pipeline; a receiver is moved towards the light by the depth `constant` and by `slope` times its steeper slope per texel.
    pub fn new(device: &wgpu::Device, constant: f32, slope: f32) -> Self {
        let constants = kernel::Constants { paraboloids: 0, bias_constant: constant, bias_slope: slope };
        Self { compare: kernel::CompareProgram::new(device, constants) }
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        nearest_keys: &Buffer<u32>,
        point_keys: &Buffer<u32>,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            nearest_keys: nearest_keys.as_read(),
            point_keys: point_keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
