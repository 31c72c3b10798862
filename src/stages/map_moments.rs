//! Mean and variance of the depths of ever larger squares of texels: what filtering a map of depths takes.
//!
//! - **Purpose.** Variance shadow maps (Donnelly and Lauritzen 2006), prefiltered as mip maps are (Oliveira 2009, section 3.4). Mean and
//!   variance stand for the two moments: the same numbers, of which nothing cancels in single precision.
//! - **Reads** the maps of [`split_maps`](super::split_maps).
//! - **Writes** `moments`, view after view, level after level from the first above the texels, row by row. A cell of level `k` is the
//!   square of `2^k` texels a side, cut at the map's border; a texel without a caster is as deep as [`SplitViews::far`].
//! - **Guarantee.** Bit-equal from run to run.
//! - **Cost.** A third of 8 bytes a texel; a dispatch for every five levels, which go through workgroup memory.

use super::split_maps::SplitViews;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::map_moments as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct MapMoments {
    reduce: [kernel::ReduceProgram; 3],
}

impl MapMoments {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let from = |first: u32| kernel::ReduceProgram::new(device, kernel::Constants { first });
        Self { reduce: [0, 1, 2].map(|k| from(k * kernel::LEVELS)) }
    }

    /// Memory for the moments of `views` maps of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn memory(device: &wgpu::Device, views: usize, size: u32) -> Result<Buffer<[f32; 2]>> {
        Buffer::storage(device, "map_moments.moments", views * SplitViews::moments_of(size))
    }

    /// Records it, for `views` maps of `size` texels a side.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        splits: &Buffer<SplitViews>,
        keys: &Buffer<u32>,
        moments: &Buffer<[f32; 2]>,
        views: usize,
        size: u32,
    ) {
        let levels = SplitViews::levels_of(size);
        let bindings = kernel::Reduce {
            frame: frame.as_uniform(),
            splits: splits.as_uniform(),
            map_keys: keys.as_read(),
            moments: moments.as_write(),
        };
        for (program, first) in self.reduce.iter().zip((0..levels).step_by(kernel::LEVELS as usize)) {
            let tiles = SplitViews::side_of(size, first).div_ceil(kernel::TILE);
            stage.run(program, bindings, Groups::Workgroups(views as u64 * u64::from(tiles).pow(2)));
        }
    }
}
