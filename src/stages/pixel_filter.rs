//! Visibility weighted over the samples of a pixel and of those around it (Pan 2009, section 5.1, left there as future work).
//!
//! - **Reads** facets and their masks, then which samples are lit; weights of a [`PixelFilter`].
//! - **Writes** `seen` (mask of the samples that see a surface and count), and `visibility` anew: weight of the lit samples over that of the
//!   seen ones, of the pixel and those around it in the image. Where these weigh less than 1/8 of all weight, the share of the pixel's own; 1
//!   where nothing is seen.
//! - **Guarantee.** 0 to 1; exactly 0 or 1 where all seen samples around are dark or lit. Sums of `f32` in one order.
//! - **Cost.** Two dispatches over pixels. A word whose samples are all lit or all dark costs one weight, others one a lit sample.

use super::facet_classify::Facets;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::{pixel_filter as kernel, resolve};
use crate::gpu::{Buffer, Groups, Stage};
use crate::pixel_filter::PixelFilter;
use crate::samples::Samples;

/// The pipelines for one number of mask words and one reach.
#[derive(Debug)]
pub struct FilterMasks {
    seen: resolve::SeenSamplesProgram,
    filter: kernel::PixelFilterProgram,
}

/// Memory of an image: which samples see a surface, and the weights.
#[derive(Debug)]
pub struct FilterMemory {
    /// Mask words of each pixel.
    pub seen: Buffer<u32>,
    weights: Buffer<f32>,
}

impl FilterMemory {
    /// That of `pixels` pixels.
    ///
    /// # Errors
    /// [`crate::Error::Memory`] and [`crate::Error::Gpu`] if there is none.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        filter: PixelFilter,
        samples: &Samples,
        pixels: usize,
    ) -> Result<Self> {
        Ok(Self {
            seen: Buffer::storage(device, "pixel_filter.seen", pixels * samples.words() as usize)?,
            weights: Buffer::from_slice(device, queue, "pixel_filter.weights", &filter.weights(samples))?,
        })
    }
}

impl FilterMasks {
    /// Builds the pipelines for masks of `words` words.
    pub fn new(device: &wgpu::Device, words: u32, filter: PixelFilter) -> Self {
        Self {
            seen: resolve::SeenSamplesProgram::new(device, resolve::Constants { words }),
            filter: kernel::PixelFilterProgram::new(device, kernel::Constants { words, reach: filter.reach() }),
        }
    }

    /// Records both; `lit` is as [`Resolve`](super::resolve::Resolve) left it.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        facets: &Facets,
        lit: &Buffer<u32>,
        visibility: &Buffer<f32>,
        memory: &FilterMemory,
    ) {
        let groups = Groups::Items(visibility.len() as u64);
        let bindings = resolve::SeenSamples {
            frame: frame.as_uniform(),
            facets: facets.list.as_read(),
            masks: facets.masks.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            seen: memory.seen.as_write(),
        };
        stage.run(&self.seen, bindings, groups);
        self.record_filter(stage, frame, lit, visibility, memory);
    }

    /// Records the second alone, of samples whose masks are known.
    pub fn record_filter(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        lit: &Buffer<u32>,
        visibility: &Buffer<f32>,
        memory: &FilterMemory,
    ) {
        let bindings = kernel::PixelFilter {
            frame: frame.as_uniform(),
            lit: lit.as_read(),
            seen: memory.seen.as_read(),
            weights: memory.weights.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.filter, bindings, Groups::Items(visibility.len() as u64));
    }
}
