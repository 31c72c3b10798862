//! The functions of a deep map of 128 × 128 texels, of the 4 × 4 sub-texels of a map of 512 × 512 each, and of 64 × 64 of 8 × 8.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::deep_map::{DeepMap, DeepMapOptions};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (sub_texels, nodes) in [(4, 7), (8, 7)] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let options = DeepMapOptions { sub_texels, nodes, error: 1.0 / 16.0 };
        let stage = DeepMap::new(&gpu.device, options);
        let (deep, worst) = (stage.memory(&gpu.device, MAP)?, DeepMap::worst(&gpu.device)?);
        let texels = setup.layers.nearest_keys.len();
        cases.push(Case {
            name: format!("deep_map {sub_texels} x {sub_texels}"),
            size: setup.casters.triangles.len(),
            bytes: (texels + deep.len()) * 4,
            atomics: 0,
            // A sub-texel's rank among those of its texel, and two corners of each of them.
            flops: texels * (sub_texels as usize).pow(2) * (5 + 2 * 12),
            record: Box::new(move |s| {
                stage.record(s, &setup.frame, &setup.layers.nearest_keys, (&deep, &worst), MAP);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
