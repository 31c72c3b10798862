//! An image of visibility into a texture.

use crate::harness::Case;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::visibility_texture::VisibilityTexture;
use subpixel_shadows::{Result, wgpu};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let width = (2.0 * (size as f64).sqrt()) as u32;
    let image_size = [width, (size as u32 / width).max(1)];
    if width > device.limits().max_texture_dimension_2d {
        return Ok(Vec::new());
    }
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("bench.visibility"),
        size: wgpu::Extent3d { width, height: image_size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    frame.write(queue, &[Frame { image_size, ..Frame::default() }]);
    let pixels = (image_size[0] * image_size[1]) as usize;
    let visibility = Buffer::storage(device, "bench.visibility", pixels)?;
    let stage = VisibilityTexture::new(device);
    Ok(vec![Case {
        name: "visibility_texture".to_owned(),
        size: pixels,
        bytes: pixels * 8,
        atomics: 0,
        record: Box::new(move |s| stage.record(s, frame.raw(), &visibility, &view)),
    }])
}
