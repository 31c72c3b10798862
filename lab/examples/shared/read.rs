//! Reading a buffer of the device back.

use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::wgpu::{self, BufferUsages};
use subpixel_shadows::{Error, Result};

/// Its words, as numbers.
pub fn read(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<f32>> {
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("example.read"),
        size: buffer.size(),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None)?;
    let bytes = staging.get_mapped_range(..).map_err(|e| Error::Gpu(e.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}
