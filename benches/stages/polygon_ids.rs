//! The polygon of 32 samples a pixel of a ball on a map of 512 × 512, asked of one texel and of 3 × 3.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::stages::light_layers::{Layers, LightLayers};
use subpixel_shadows::stages::polygon_ids::{PolygonIds, PolygonMap};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for lookups in [1, 3] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let count = setup.id_keys.len();
        let map = Layers::without_marks(&gpu.device, setup.layers.splits.len().isqrt())?;
        let layers = LightLayers::with_triangles(&gpu.device, false);
        let mut encoder = gpu.encoder();
        let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
        for _ in 0..2 {
            rec.clear(map.second_keys.raw());
            layers.record(&mut rec.stage("setup"), &setup.frame, setup.lit(), &map);
        }
        gpu.submit_and_wait(encoder)?;
        let stage = PolygonIds::new(&gpu.device, lookups);
        let names: Vec<u32> = (0..setup.casters.triangles.len() as u32).collect();
        let surfaces = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.surfaces", &names)?;
        let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
        cases.push(Case {
            name: format!("polygon_ids {lookups} x {lookups}"),
            size: setup.casters.triangles.len(),
            bytes: count * 8 + map.second_keys.len() * 4,
            atomics: 0,
            // A sample's place.
            flops: count * 32 * 12,
            record: Box::new(move |s| {
                let map = PolygonMap { triangle_keys: &map.second_keys, surfaces: &surfaces };
                stage.record(s, &setup.frame, setup.seen_with(&samples), map, &visibility);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
