//! Depth comparison of 32 samples a pixel on a map of 512 × 512, a point in each cell.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::silhouette_map::SilhouetteMap;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let stage = SilhouetteMap::new(&gpu.device, 5e-5, 1.05);
    let count = setup.id_keys.len();
    let cells = (setup.layers.splits.len().isqrt() + 1).pow(2);
    let points = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.points", &vec![0x6000_a000; cells])?;
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    Ok(vec![Case {
        name: "silhouette_map".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: count * 8 + setup.layers.nearest_keys.len() * 8,
        atomics: 0,
        // A sample's place, and the receiver's depth at four texels.
        flops: count * 32 * (12 + 4 * 4),
        record: Box::new(move |s| {
            let nearest = &setup.layers.nearest_keys;
            stage.record(s, &setup.frame, setup.seen_with(&samples), nearest, &points, &visibility);
            Ok(())
        }),
    }])
}
