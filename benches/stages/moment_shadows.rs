//! The footprints of the pixels of 800 × 600 against the moments of a map of 512 × 512.

use crate::harness::Case;
use crate::harness::geometry::{WithMoments, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::map_moments::MomentMeasures;
use subpixel_shadows::stages::moment_shadows::{MapWithMoments, MomentShadows, MomentShadowsOptions};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(map) = WithMoments::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 1)?;
    let options =
        MomentShadowsOptions { constant: 5e-5, bleeding: 0.0, grazing: 0.0, measures: MomentMeasures::Depths };
    let stage = MomentShadows::new(&gpu.device, options);
    let count = map.setup.id_keys.len();
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    Ok(vec![Case {
        name: "moment_shadows".to_owned(),
        size: map.setup.casters.triangles.len(),
        bytes: count * 8 + map.setup.layers.nearest_keys.len() * 4 + map.moments.len() * 8,
        atomics: 0,
        // The place of the pixel and eight cells.
        flops: count * 300,
        record: Box::new(move |s| {
            let nearest_keys = &map.setup.layers.nearest_keys;
            let with = MapWithMoments { levels: &map.levels, nearest_keys, moments: &map.moments };
            stage.record(s, &map.setup.frame, map.setup.seen_with(&samples), with, &visibility);
            Ok(())
        }),
    }])
}
