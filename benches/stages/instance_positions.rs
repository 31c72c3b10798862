//! Vertices of a thousand instances of one mesh.

use crate::harness::Case;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::scene::Homography;
use subpixel_shadows::stages::instance_positions::{InstancePositions, Transforms};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let instances = 1000.min(size);
    let of_mesh = size.div_ceil(instances) as u32;
    let sources: Vec<[u32; 2]> = (0..size as u32).map(|v| [v % of_mesh, v / of_mesh]).collect();
    let sources = Buffer::from_slice(device, queue, "bench.sources", &sources)?;
    let vertices = Buffer::storage(device, "bench.vertices", of_mesh as usize)?;
    let transforms: Buffer<f32> = Buffer::storage(device, "bench.transforms", 12 * instances)?;
    let positions = Buffer::storage(device, "bench.positions", size)?;
    let faults = Buffer::storage(device, "bench.faults", 4)?;
    let stage = InstancePositions::new(device);
    Ok(vec![Case {
        name: format!("instance_positions {instances}"),
        size,
        // The vertices of the mesh and the transforms stay near.
        bytes: size * (8 + 12) + of_mesh as usize * 16 + instances * 48,
        atomics: 0,
        flops: size * 21,
        record: Box::new(move |s| {
            let given = (Transforms { buffer: transforms.raw(), offset: 0 }, instances);
            stage.record(
                s,
                given,
                &sources,
                &vertices,
                ([[-1.0; 3], [1.0; 3]], Homography::default()),
                (&positions, 0),
                &faults,
            )
        }),
    }])
}
