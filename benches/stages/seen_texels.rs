//! Texels of a map of 512 × 512 that the pixels of a ball ask for, with one sample a pixel.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::seen_texels::SeenTexels;
use subpixel_shadows::stages::spsm_map::SpsmTexels;
use subpixel_shadows::stages::spsm_query::SpsmQueryOptions;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (device, queue) = (&gpu.device, &gpu.queue);
    let side = (setup.layers.splits.len() as f64).sqrt() as usize;
    let count = setup.id_keys.len();
    let texels = SpsmTexels::new(device, queue, side, count, 5)?;
    let samples = samples(gpu, 1)?;
    let options = SpsmQueryOptions { stretch: 2, ..SpsmQueryOptions::default() };
    let stage = SeenTexels::new(device, options, &texels);
    Ok(vec![Case {
        name: "seen_texels".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: count * (4 + 12 + 48),
        atomics: count,
        flops: 0,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), &texels);
            Ok(())
        }),
    }])
}
