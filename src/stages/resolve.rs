//! From masks to visibility (Pan 2009, section 3.4).
//!
//! - **Reads** facets, their masks, and which facets each pixel has.
//! - **Writes** `visibility` (lit share of the samples that count; 1 where the pixel sees nothing) and `lit` (mask of the lit
//!   samples, all ones where the pixel sees nothing); counts facets by state into words 16 to 20 of `status`, and writes
//!   [`Frame::stamp`](crate::frame::Frame) into [`StatusHead::finished`](crate::status::StatusHead::finished): it is the last stage of a frame.
//! - **Guarantee.** Exact quotients of small integers, rounded once.
//! - **Cost.** One dispatch over pixels.

use super::facet_classify::Facets;
use crate::frame::Frame;
use crate::gpu::kernels::resolve as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline for one number of mask words.
#[derive(Debug)]
pub struct Resolve {
    resolve: kernel::ResolveProgram,
}

impl Resolve {
    /// Builds the pipeline for masks of `words` words.
    pub fn new(device: &wgpu::Device, words: u32) -> Self {
        Self { resolve: kernel::ResolveProgram::new(device, kernel::Constants { words }) }
    }

    /// Records the visibility of every pixel.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        facets: &Facets,
        visibility: &Buffer<f32>,
        lit: &Buffer<u32>,
        status: &Buffer<u32>,
    ) {
        let bindings = kernel::Resolve {
            frame: frame.as_uniform(),
            facets: facets.list.as_read(),
            masks: facets.masks.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            visibility: visibility.as_write(),
            lit: lit.as_write(),
            status: status.as_write(),
        };
        stage.run(&self.resolve, bindings, Groups::Items(visibility.len() as u64));
    }
}
