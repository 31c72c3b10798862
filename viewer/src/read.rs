//! Pictures read back.

use futures::channel::oneshot;
use subpixel_shadows::wgpu;

/// Bytes that rows begin at a multiple of.
const ALIGNMENT: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// Begins to read a texture of 4 bytes a pixel: the rows from the top, once the GPU is done with all that was submitted. Outside a browser the
/// device has to be polled for that.
pub fn texture(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    texture: &wgpu::Texture,
) -> impl Future<Output = Result<Vec<u8>, String>> + use<> {
    let size = texture.size();
    let row = (4 * size.width).next_multiple_of(ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("viewer.read"),
        size: u64::from(row) * u64::from(size.height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        size,
    );
    queue.submit([encoder.finish()]);
    let (send, mapped) = oneshot::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody may wait for it any more.
        let _ = send.send(result);
    });
    async move {
        let answer = mapped.await.map_err(|_| "the GPU gave no answer".to_owned())?;
        answer.map_err(|e| e.to_string())?;
        let bytes = buffer.get_mapped_range(..).map_err(|e| e.to_string())?;
        let rows = bytes.chunks_exact(row as usize).flat_map(|all| &all[..4 * size.width as usize]);
        Ok(rows.copied().collect())
    }
}
