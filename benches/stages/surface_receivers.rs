//! A plane seen as depth over no casters: the lists of all pixels.

use crate::harness::{Case, texture};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu, Groups};
use subpixel_shadows::stages::pixel_coverage::PairCoverage;
use subpixel_shadows::stages::pixel_receivers::{GivenTexture, PixelReceiversParams, unread_samples};
use subpixel_shadows::stages::pixel_triangles::PixelLists;
use subpixel_shadows::stages::surface_receivers::{GivenSurfaces, ListedPixels, ReceiverPlaces, SurfaceReceivers};
use subpixel_shadows::wgpu::{TextureFormat, TextureUsages};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let usage = TextureUsages::TEXTURE_BINDING;
    let Some((place, image_size)) = texture(gpu, size, TextureFormat::R32Float, usage) else { return Ok(Vec::new()) };
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
            sample_count: 32,
            ..Frame::default()
        }],
    );
    let samples = Buffer::uniform(device, "samples", 64)?;
    let corners: Vec<[f32; 4]> =
        [[-4.0, -4.0], [4.0, -4.0], [0.0, 4.0]].repeat(pixels).iter().map(|&[x, y]| [x, y, 1.0, 0.0]).collect();
    let positions = Buffer::with_room(device, queue, "bench.positions", &[], 3 * pixels)?;
    queue.write_buffer(positions.raw(), 0, bytemuck::cast_slice(&corners));
    let points = Buffer::with_room(device, queue, "bench.points", &[], 3 * pixels)?;
    let keys: Vec<u32> = (0..pixels as u32).map(|pixel| !pixel).collect();
    let keys = Buffer::from_slice(device, queue, "bench.keys", &keys)?;
    let id_keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let (lists, chosen) = (PixelLists::new(device, pixels, 4)?, SurfaceReceivers::memory(device, pixels)?);
    let coverage = PairCoverage::new(device, 4, 1)?;
    let (complex, total) =
        (Buffer::storage(device, "bench.complex", pixels)?, Buffer::storage(device, "bench.total", 4)?);
    let (stage, unread) = (SurfaceReceivers::new(device, 32), unread_samples(device));
    let params = PixelReceiversParams {
        depth: [1.0, -1.0, 1.0, 0.0],
        nothing: 1.0,
        tolerance: 1e-4,
        ..PixelReceiversParams::at_centres()
    };
    Ok(vec![Case {
        name: "surface_receivers".to_owned(),
        size: pixels,
        bytes: pixels * 140,
        atomics: 0,
        flops: pixels * 250,
        record: Box::new(move |s| {
            let place = GivenTexture { single: &place, samples: &unread };
            let given = GivenSurfaces { params, place, keys: &keys };
            let places = ReceiverPlaces { positions: &positions, points: &points };
            stage.record_own(s, &frame, given, places, &lists, &id_keys, &chosen)?;
            stage.record_choose(s, &frame, given, &points, &lists, &id_keys, &chosen)?;
            stage.record_list(s, &frame, &lists, &chosen);
            let listed = ListedPixels { pixels: &complex, total: &total, groups: Groups::Items(1) };
            stage.record_cover(s, &frame, &samples, given, &points, listed, &lists, (&coverage, &chosen))
        }),
    }])
}
