//! Pixels that show several surfaces, and what is known of their samples.

use super::{SurfaceStep, WORKGROUP};
use crate::Result;
use crate::gpu::Buffer;
use crate::stages::{DispatchArgs, dispatch_args};

/// Complex pixels and what their samples see.
#[derive(Debug)]
pub struct ComplexPixels {
    /// The pixels.
    pub pixels: Buffer<u32>,
    /// How many there are, and 0.
    pub total: Buffer<u32>,
    /// Complement of the triangle of each sample, one buffer for each band of them.
    pub keys: Vec<Buffer<u32>>,
    /// Another one that almost touches it there, of the band at work, and which samples have one, and may have more.
    pub rivals: Buffer<u32>,
    /// How many pixels of the band have samples that may have more; slot and pixel of each.
    pub crowds: Buffer<u32>,
    pub(super) crowd_requests: dispatch_args::Requests,
    pub(super) crowd_args: Buffer<u32>,
    /// Pixels of a band.
    pub(super) band: usize,
}

impl ComplexPixels {
    /// Memory for `count` pixels with masks of `words` words, in as few bands as the device's bindings allow.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, count: usize, words: usize) -> Result<Self> {
        let limits = device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        Self::in_bands(device, queue, count, words, (binding / (136 * words.max(1) as u64)) as usize)
    }

    /// As [`ComplexPixels::new`], in bands of at most `most` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn in_bands(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        count: usize,
        words: usize,
        most: usize,
    ) -> Result<Self> {
        let bands = count.div_ceil(most.max(1)).max(1);
        let band = count.div_ceil(bands);
        let request = dispatch_args::ArgsRequest::new(0, WORKGROUP, band, 0)?;
        Ok(Self {
            pixels: Buffer::storage(device, "sample_surfaces.pixels", count)?,
            total: Buffer::storage(device, "sample_surfaces.total", 2)?,
            keys: (0..bands)
                .map(|_| Buffer::storage(device, "sample_surfaces.keys", band * 32 * words))
                .collect::<Result<_>>()?,
            rivals: Buffer::storage(device, "sample_surfaces.rivals", band * 34 * words)?,
            crowds: Buffer::storage(device, "sample_surfaces.crowds", 2 * band + 1)?,
            crowd_requests: DispatchArgs::requests(device, queue, &[request])?,
            crowd_args: Buffer::indirect(device, "sample_surfaces.crowd_args", 3)?,
            band,
        })
    }

    /// The bands: what all dispatches but those of further rounds are told, and the triangles of the samples.
    pub(super) fn bands(&self) -> impl Iterator<Item = (SurfaceStep, &Buffer<u32>)> {
        let step = |n: usize| SurfaceStep {
            first_slot: (n * self.band) as u32,
            slots: self.band as u32,
            ..SurfaceStep::default()
        };
        self.keys.iter().enumerate().map(move |(n, keys)| (step(n), keys))
    }
}
