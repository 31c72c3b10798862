//! A picture that the device has drawn.

use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::wgpu::{self, BufferUsages};

/// The texels of a picture of four bytes each.
pub fn picture(gpu: &Gpu, image: &wgpu::Texture) -> Result<Vec<[u8; 3]>> {
    let row = (4 * image.width()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(image.height()),
        usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(image.as_image_copy(), to, image.size());
    gpu.submit_and_wait(encoder)?;
    let words: Vec<u32> = crate::read::read(gpu, &buffer)?.iter().map(|word| word.to_bits()).collect();
    let width = image.width() as usize;
    let texel = |word: &u32| [0, 8, 16].map(|by| (word >> by) as u8);
    Ok(words.chunks(row as usize / 4).flat_map(|row| row[..width].iter().map(texel)).collect())
}
