//! An image of triangle numbers, four pixels wide in proportion to one high.

use crate::harness::{Case, texture};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::triangle_ids::{TriangleIds, TriangleIdsParams};
use subpixel_shadows::wgpu::{TextureFormat, TextureUsages};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let (format, usage) = (TextureFormat::R32Uint, TextureUsages::TEXTURE_BINDING);
    let Some((view, image_size)) = texture(gpu, size, format, usage) else { return Ok(Vec::new()) };
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    frame.write(queue, &[Frame { image_size, triangle_count: 1, ..Frame::default() }]);
    let pixels = (image_size[0] * image_size[1]) as usize;
    let numbers = Buffer::from_slice(device, queue, "bench.numbers", &[0u32])?;
    let keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let faults = Buffer::storage(device, "bench.faults", 4)?;
    let stage = TriangleIds::new(device);
    Ok(vec![Case {
        name: "triangle_ids".to_owned(),
        size: pixels,
        bytes: pixels * 8,
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| {
            let counted = TriangleIdsParams { first: 0, none: u32::MAX };
            stage.record(s, &frame, &view, counted, &numbers, &keys, &faults)
        }),
    }])
}
