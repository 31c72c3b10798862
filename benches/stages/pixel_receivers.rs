//! A plane seen as depth, without normals and triangle numbers, over no casters.

use crate::harness::{Case, texture};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::pixel_receivers::{
    GivenTexture, PixelReceivers, PixelReceiversParams, ReceiverKeys, ReceiverRoom, SeenCasters, Textures,
    unread_samples,
};
use subpixel_shadows::wgpu::{TextureFormat, TextureUsages};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let usage = TextureUsages::TEXTURE_BINDING;
    let Some((place, image_size)) = texture(gpu, size, TextureFormat::R32Float, usage) else { return Ok(Vec::new()) };
    let Some((ids, _)) = texture(gpu, 1, TextureFormat::R32Uint, usage) else { return Ok(Vec::new()) };
    let pixels = (image_size[0] * image_size[1]) as usize;
    let per_pixel = 1.0 / image_size[0] as f32;
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    frame.write(
        queue,
        &[Frame {
            image_size,
            eye: [0.0, 0.0, 0.0, 1.0],
            ray_corner: [-0.5, -0.5, 1.0, 0.0],
            ray_x: [per_pixel, 0.0, 0.0, 0.0],
            ray_y: [0.0, per_pixel, 0.0, 0.0],
            forward: [0.0, 0.0, 1.0, 0.001],
            ..Frame::default()
        }],
    );
    let numbers = Buffer::from_slice(device, queue, "bench.numbers", &[0u32])?;
    let triangles = Buffer::with_room(device, queue, "bench.triangles", &[], pixels)?;
    let positions = Buffer::with_room(device, queue, "bench.positions", &[], 3 * pixels)?;
    let id_keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let to = ReceiverKeys::new(device, pixels)?;
    // No casters: no blocks.
    let empty = Buffer::storage(device, "bench.points", 1)?;
    let (rects, facing, offsets) = (
        Buffer::storage(device, "bench.rects", 1)?,
        Buffer::storage(device, "bench.facing", 1)?,
        Buffer::storage(device, "bench.offsets", 4)?,
    );
    let args = Buffer::indirect(device, "bench.args", 4)?;
    args.write(queue, &[0, 1, 1, 0]);
    let faults = Buffer::storage(device, "bench.faults", 4)?;
    let stage = PixelReceivers::new(device, false);
    let unread = unread_samples(device);
    // The texture holds 0, which is a depth of 1.
    let params = PixelReceiversParams {
        depth: [1.0, -1.0, 1.0, 0.0],
        nothing: 1.0,
        tolerance: 1e-4,
        ..PixelReceiversParams::at_centres()
    };
    Ok(vec![Case {
        name: "pixel_receivers".to_owned(),
        size: pixels,
        bytes: pixels * 72,
        atomics: 0,
        flops: pixels * 150,
        record: Box::new(move |s| {
            let place = GivenTexture { single: &place, samples: &unread };
            let textures = Textures { place, normals: place, ids: &ids };
            let surfaces = ReceiverRoom { numbers: &numbers, triangles: &triangles, positions: &positions };
            let blocks = Blocks {
                triangles: &triangles,
                points: &empty,
                rects: &rects,
                facing: &facing,
                offsets: &offsets,
                args: (args.raw(), 0),
            };
            let casters = SeenCasters { blocks, id_keys: &id_keys };
            stage.record(s, &frame, params, textures, surfaces, casters, &to, &faults)
        }),
    }])
}
