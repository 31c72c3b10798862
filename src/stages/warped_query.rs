//! Shadows by depth comparison with a map whose axes are warped.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets; the axes of [`axis_density`](super::axis_density), the texels
//!   of [`warped_casters`](super::warped_casters).
//! - **Writes** `visibility`: the mean over the samples whose rays meet the receiver; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. A sample asks the texel between whose borders it lies. Nothing is settled early and nothing is exact: the
//!   bias decides, which is by the texel's own width and height.
//! - **Cost.** One dispatch over pixels; per sample three words of the scan and three borders along either axis, and a texel.

use super::PrimaryHits;
use super::axis_density::AxisTables;
use super::warped_casters::WarpedTexels;
use crate::frame::Frame;
use crate::gpu::kernels::warped_query as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct WarpedQuery {
    compare: kernel::CompareProgram,
}

impl WarpedQuery {
    /// Builds the pipeline for a bias: constant, and times the receiver's change of depth across its texel.
    pub fn new(device: &wgpu::Device, [bias_constant, bias_slope]: [f32; 2]) -> Self {
        let constants = kernel::Constants { paraboloids: 0, bias_constant, bias_slope };
        Self { compare: kernel::CompareProgram::new(device, constants) }
    }

    /// Records the comparison of every pixel.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        (tables, texels): (&AxisTables, &WarpedTexels),
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            axes: tables.axes.as_read(),
            borders: tables.borders.as_read(),
            keys: texels.keys.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
