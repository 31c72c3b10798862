//! Depth comparison of 32 samples a pixel with a map whose axes the pixels of a ball warp.

use super::warped_casters::tables;
use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::warped_casters::WarpedTexels;
use subpixel_shadows::stages::warped_query::WarpedQuery;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (samples, tables) = (samples(gpu, 32)?, tables(gpu, &setup)?);
    let count = setup.id_keys.len();
    let triangles = setup.casters.triangles.len();
    let texels = WarpedTexels::new(&gpu.device, &gpu.queue, triangles, MAP)?;
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    let stage = WarpedQuery::new(&gpu.device, [5e-5, 1.05]);
    Ok(vec![Case {
        name: "warped_query".to_owned(),
        size: triangles,
        bytes: count * 8 + (MAP * MAP) as usize * 4,
        atomics: 0,
        // The sample's place and depth, its texel along either axis, the bias.
        flops: count * 32 * 40,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), (&tables, &texels), &visibility);
            Ok(())
        }),
    }])
}
