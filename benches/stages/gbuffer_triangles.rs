//! A G-buffer of four samples a pixel that all show one triangle: every texel is read twice.

use crate::harness::Case;
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::gbuffer_triangles::{GbufferTriangles, GbufferTrianglesParams, SampleGbuffer, Texture};
use subpixel_shadows::stages::pixel_triangles::PixelLists;
use subpixel_shadows::wgpu;

const PLACES: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let width = (2.0 * (size as f64).sqrt()) as u32;
    let height = (size as u32 / width).max(1);
    if width > device.limits().max_texture_dimension_2d {
        return Ok(Vec::new());
    }
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("bench.texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: PLACES.len() as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let pixels = (width * height) as usize;
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    let pixel_triangle_capacity = pixels as u32;
    frame.write(
        queue,
        &[Frame { image_size: [width, height], triangle_count: 1, pixel_triangle_capacity, ..Frame::default() }],
    );
    let numbers = Buffer::from_slice(device, queue, "bench.numbers", &[0u32])?;
    let lists = PixelLists::new(device, pixels, pixels)?;
    let (status, faults) = (Buffer::storage(device, "bench", 32)?, Buffer::storage(device, "bench", 4)?);
    let id_keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let scan = PrefixScan::new(device);
    let scratch = PrefixScan::scratch(device, pixels)?;
    let stage = GbufferTriangles::new(device, &scan);
    let params = GbufferTrianglesParams::new(&[[0.5; 2]], &PLACES, 0, u32::MAX)?;
    Ok(vec![Case {
        name: "gbuffer_triangles".to_owned(),
        size: pixels,
        bytes: pixels * (2 * 4 * PLACES.len() + 28),
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| {
            let given = SampleGbuffer { texture: Texture::Layers(&view), params, numbers: &numbers };
            stage.record(s, &frame, &given, &lists, &id_keys, &scratch, &status, &faults)
        }),
    }])
}
