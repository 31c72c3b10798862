//! An image of visibility into a texture.

use crate::harness::{Case, texture};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::visibility_texture::VisibilityTexture;
use subpixel_shadows::wgpu::{TextureFormat, TextureUsages};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let (format, usage) = (TextureFormat::R32Float, TextureUsages::STORAGE_BINDING);
    let Some((view, image_size)) = texture(gpu, size, format, usage) else { return Ok(Vec::new()) };
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
        flops: 0,
        record: Box::new(move |s| {
            stage.record(s, &frame, &visibility, &view);
            Ok(())
        }),
    }])
}
