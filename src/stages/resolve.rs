//! From masks to visibility (Pan 2009, section 3.4).
//!
//! - **Reads** facets, their masks, and which facets each pixel has.
//! - **Writes** `visibility` (lit share of the samples that count; 1 where the pixel sees nothing) and `lit` (mask of the lit
//!   samples, all ones where the pixel sees nothing); counts facets by state into words 16 to 20 of `status`, and writes
//!   [`Frame::stamp`](crate::frame::Frame) into word [`STATUS_FINISHED`]: it is the last stage of a frame.
//! - **Guarantee.** Exact quotients of small integers, rounded once.
//! - **Cost.** One dispatch over pixels.

use super::facet_classify::Facets;
use crate::Result;
use crate::gpu::kernels::resolve as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage};

pub use kernel::STATUS_FINISHED;

/// The pipeline for one number of mask words.
#[derive(Debug)]
pub struct Resolve {
    resolve: Program,
}

impl Resolve {
    /// Builds the pipeline for masks of `words` words.
    pub fn new(device: &wgpu::Device, words: u32) -> Self {
        Self { resolve: Program::new(device, kernel::ENTRY_RESOLVE, &[("WORDS", f64::from(words))]) }
    }

    /// Records the visibility of every pixel.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        facets: &Facets,
        visibility: &Buffer<f32>,
        lit: &Buffer<u32>,
        status: &Buffer<u32>,
    ) -> Result<()> {
        let buffers = [
            ("frame", frame),
            ("facets", facets.list.raw()),
            ("masks", facets.masks.raw()),
            ("pixel_facets", facets.pixel_facets.raw()),
            ("visibility", visibility.raw()),
            ("lit", lit.raw()),
            ("status", status.raw()),
        ];
        stage.run(&self.resolve, &buffers, Groups::Items(visibility.len() as u64))
    }
}
