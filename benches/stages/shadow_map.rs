//! Depth comparison of 32 samples a pixel on a map of 512 × 512, unfiltered, with a filter of 3 × 3 texels, and with a disc of 9 taps.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::shadow_map::{ShadowMap, ShadowMapOptions};
use subpixel_shadows::tap_disc::disc_words;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (kernel, taps, slope) in [(1, 0, 1.05), (3, 0, 0.0), (1, 9, 0.0)] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let options =
            ShadowMapOptions { kernel, constant: 5e-5, slope, receiver_plane: kernel > 1, taps, turned: taps > 0 };
        let disc = Buffer::<[f32; 4]>::uniform(&gpu.device, "bench.disc", 32)?;
        disc.write(&gpu.queue, &disc_words(taps, 1.5));
        let stage = ShadowMap::new(&gpu.device, options);
        let count = setup.id_keys.len();
        let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
        cases.push(Case {
            name: if taps > 0 { format!("shadow_map {taps} taps") } else { format!("shadow_map {kernel} x {kernel}") },
            size: setup.casters.triangles.len(),
            bytes: count * 8 + setup.layers.nearest_keys.len() * 4,
            atomics: 0,
            // Two products and sums for each texel of the filter, and the sample's place and depth.
            flops: count * 32 * (12 + (kernel * kernel).max(8 * taps) as usize),
            record: Box::new(move |s| {
                let map = (&setup.layers.nearest_keys, &disc);
                stage.record(s, &setup.frame, setup.seen_with(&samples), map, &visibility);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
