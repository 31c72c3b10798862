//! Shadows by the maps of slices of what the camera sees: by depth comparison (Williams 1978), or by mean and variance of the depths
//! in a pixel's footprint (Donnelly and Lauritzen 2006).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, the maps of
//!   [`split_maps`](super::split_maps), for the second their [moments](super::map_moments).
//! - **Writes** `visibility`: of `compare` the mean over the samples whose rays meet the receiver, of `filter_moments` that of one
//!   lookup, whatever the samples; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is exact: the bias decides, and the moments of what lies behind each other
//!   leak light.
//! - **Cost.** One dispatch over pixels; per sample one texel, or per pixel up to 16 lookups of eight cells.

use super::PrimaryHits;
use super::split_maps::SplitViews;
use crate::frame::Frame;
use crate::gpu::kernels::split_shadows as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// How the maps are asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplitQuery {
    /// By depth comparison with the nearest texel, for every sample.
    Depths {
        /// Depth that a receiver is moved towards the light; depth 1 is the extent of the casters along the light.
        constant: f32,
        /// Times the steeper slope of the receiver per texel: what it is moved besides.
        slope: f32,
    },
    /// By mean and variance.
    Moments {
        /// As of [`SplitQuery::Depths`].
        constant: f32,
        /// Share of light that is taken off, against leaks: 0 for none, below 1.
        bleeding: f32,
        /// Sine of the elevation of the light over a receiver below which half of it is lit; 0 for none.
        grazing: f32,
    },
}

/// The pipeline.
#[derive(Debug)]
pub struct SplitShadows(Program);

/// The kernel's entry point for an [`SplitQuery`].
#[derive(Debug)]
enum Program {
    Compare(kernel::CompareProgram),
    FilterMoments(kernel::FilterMomentsProgram),
}

/// The maps and what is made of them.
#[derive(Clone, Copy, Debug)]
pub struct OfMaps<'a> {
    /// The slices.
    pub splits: &'a Buffer<SplitViews>,
    /// Keys of the nearest depths, view after view.
    pub keys: &'a Buffer<u32>,
    /// Their moments, which [`SplitQuery::Depths`] does not read.
    pub moments: &'a Buffer<[f32; 2]>,
}

impl SplitShadows {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, ask: SplitQuery) -> Self {
        Self(match ask {
            SplitQuery::Depths { constant, slope } => {
                let constants = kernel::Constants { bias_constant: constant, bias_slope: slope, ..Default::default() };
                Program::Compare(kernel::CompareProgram::new(device, constants))
            }
            SplitQuery::Moments { constant, bleeding, grazing } => {
                let constants = kernel::Constants { bias_constant: constant, bleeding, grazing, ..Default::default() };
                Program::FilterMoments(kernel::FilterMomentsProgram::new(device, constants))
            }
        })
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        maps: OfMaps,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Ask {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            splits: maps.splits.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            map_keys: maps.keys.as_read(),
            moments: maps.moments.as_read(),
            visibility: visibility.as_write(),
        };
        let groups = Groups::Items(visibility.len() as u64);
        match &self.0 {
            Program::Compare(compare) => stage.run(compare, bindings, groups),
            Program::FilterMoments(filter) => stage.run(filter, bindings, groups),
        }
    }
}
