//! Positions of a tight vertex buffer, and of one with normals and texture coordinates.

use crate::harness::Case;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::scene::Homography;
use subpixel_shadows::stages::caster_positions::{CasterPositions, Vertices};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut cases = Vec::new();
    for words in [3, 8] {
        if size * words * 4 > device.limits().max_storage_buffer_binding_size as usize {
            continue;
        }
        let vertices: Buffer<f32> = Buffer::storage(device, "bench.vertices", size * words)?;
        let places: Vec<[u32; 2]> = (0..size as u32).map(|v| [v, v]).collect();
        let places = Buffer::from_slice(device, queue, "bench.places", &places)?;
        let positions = Buffer::storage(device, "bench.positions", size)?;
        let faults = Buffer::storage(device, "bench.faults", 4)?;
        let stage = CasterPositions::new(device);
        cases.push(Case {
            name: format!("caster_positions {words} words"),
            size,
            bytes: size * (4 * words + 8 + 12),
            atomics: 0,
            flops: 0,
            record: Box::new(move |s| {
                let from = Vertices { buffer: vertices.raw(), offset: 0, stride: 4 * words as u64 };
                stage.record(s, from, &places, ([[-1.0; 3], [1.0; 3]], Homography::default()), &positions, &faults)
            }),
        });
    }
    Ok(cases)
}
