//! 32 samples a pixel of a ball in a deep map of 128 × 128 texels of 4 × 4 sub-texels.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::stages::deep_map::{DeepMap, DeepMapOptions};
use subpixel_shadows::stages::deep_shadows::DeepShadows;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let options = DeepMapOptions { sub_texels: 4, nodes: 7, error: 1.0 / 16.0 };
    let make = DeepMap::new(&gpu.device, options);
    let (deep, worst) = (make.memory(&gpu.device, MAP)?, DeepMap::worst(&gpu.device)?);
    let mut encoder = gpu.encoder();
    let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
    make.record(&mut rec.stage("setup"), &setup.frame, &setup.layers.nearest_keys, (&deep, &worst), MAP);
    gpu.submit_and_wait(encoder)?;
    let stage = DeepShadows::new(&gpu.device, options, [5e-5, 1.05]);
    let count = setup.id_keys.len();
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    Ok(vec![Case {
        name: "deep_shadows".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: count * 8 + deep.len() * 4,
        atomics: 0,
        // A sample's place, and four texels.
        flops: count * 32 * (12 + 4 * 12),
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), &deep, &visibility);
            Ok(())
        }),
    }])
}
