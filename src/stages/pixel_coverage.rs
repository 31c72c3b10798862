//! Pixel coverage: which samples of its pixel each listed triangle covers, and bounds of its depth there.
//!
//! - **Reads** the lists of [`super::pixel_triangles`], triangles, projected vertices, positions.
//! - **Writes** a list of the triangles that cover samples ([`Covering`]), pixel by pixel, each where the list of all its
//!   triangles begins, with masks of the samples; [`PixelLists::counts`], which must be 0 before, has their lengths.
//! - **Guarantee.** A sample is covered if its ray meets the triangle beyond the near distance, where it is solid. Edges belong to
//!   both sides, and around a vertex all edges agree on where the sample is: no sample inside a closed surface is missed. The near
//!   distance is decided with 46 bits. The bounds of depth hold at every sample that is covered. The order inside a pixel is not defined;
//!   what is made of it does not depend on it.
//! - **Cost.** One invocation a listed triangle: about 14 flop a sample and 300 besides; a sample within rounding of an edge, at the
//!   near distance or in an alpha-tested triangle costs about 150 more. Writes 20 bytes, and 4 for each 32 samples, for a triangle
//!   that covers any.
//! - **Source.** Masks of samples as in Pan 2009, section 3.4, here of what the eye sees; edge functions (Pineda 1988).

use super::pixel_triangles::PixelLists;
use super::sample_surfaces::SurfaceInputs;
use crate::frame::Frame;
use crate::gpu::kernels::pixel_coverage as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::{Result, shared_struct};

pub use kernel::WORKGROUP;

shared_struct! {
    /// A triangle that covers samples of a pixel, with linear bounds of its inverse depth there.
    "shared/raster/covering" => pub struct Covering {
        /// The triangle.
        pub triangle: u32,
        /// Upper bound at the pixel centre.
        pub high: f32,
        /// Lower bound.
        pub low: f32,
        /// Added to both by a pixel right.
        pub slope_x: f32,
        /// Added to both by a pixel down.
        pub slope_y: f32,
    }
}

/// The triangles that cover samples of their pixels.
#[derive(Debug)]
pub struct PairCoverage {
    /// The triangles.
    pub list: Buffer<Covering>,
    /// Samples that each covers, words of 32.
    pub masks: Buffer<u32>,
}

impl PairCoverage {
    /// Memory for `triangles` listed ones with masks of `words` words.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, triangles: usize, words: usize) -> Result<Self> {
        Ok(Self {
            list: Buffer::storage(device, "pixel_coverage.list", triangles)?,
            masks: Buffer::storage(device, "pixel_coverage.masks", triangles * words)?,
        })
    }
}

/// The pipeline for one number of samples.
#[derive(Debug)]
pub struct PixelCoverage {
    cover: kernel::CoverProgram,
}

impl PixelCoverage {
    /// Builds it for `samples` samples a pixel; `alpha`: triangles may be alpha-tested.
    pub fn new(device: &wgpu::Device, samples: u32, alpha: bool) -> Self {
        let constants =
            kernel::Constants { words: samples.div_ceil(32), samples: samples.min(32), alpha: u32::from(alpha) };
        Self { cover: kernel::CoverProgram::new(device, constants) }
    }

    /// Records it, with `groups` of [`WORKGROUP`] listed triangles.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        mesh: SurfaceInputs,
        lists: &PixelLists,
        coverage: &PairCoverage,
        groups: Groups,
    ) {
        let bindings = kernel::Cover {
            frame: frame.as_uniform(),
            samples: mesh.samples.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            positions: mesh.positions.as_read(),
            pixel_offsets: lists.offsets.as_read(),
            pixel_list: lists.list.as_read(),
            pixel_counts: lists.counts.as_write(),
            coverings: coverage.list.as_write(),
            covering_masks: coverage.masks.as_write(),
        };
        stage.run(&self.cover, bindings, groups);
    }
}
