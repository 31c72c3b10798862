//! Pixels that show several surfaces, and what is known of their samples.

use super::PixelSlot;
use crate::Result;
use crate::gpu::Buffer;

/// Complex pixels, and what is left of their lists.
#[derive(Debug)]
pub struct ComplexPixels {
    /// The pixels.
    pub pixels: Buffer<u32>,
    /// How many there are, and 0.
    pub total: Buffer<u32>,
    /// Samples of each at which bounds leave several triangles, words of 32.
    pub contested: Buffer<u32>,
    /// Each, and where its list stands.
    pub slots: Buffer<PixelSlot>,
}

impl ComplexPixels {
    /// Memory for `count` pixels with masks of `words` words.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, count: usize, words: usize) -> Result<Self> {
        Ok(Self {
            pixels: Buffer::storage(device, "sample_surfaces.pixels", count)?,
            total: Buffer::storage(device, "sample_surfaces.total", 2)?,
            contested: Buffer::storage(device, "sample_surfaces.contested", count * words)?,
            slots: Buffer::storage(device, "sample_surfaces.slots", count)?,
        })
    }
}
