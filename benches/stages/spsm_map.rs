//! The closest triangle of a ball in each texel of a map of 512 × 512, in both encodings.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::seen_texels::SeenTexels;
use subpixel_shadows::stages::spsm_map::{SpsmMap, SpsmTexels};
use subpixel_shadows::stages::spsm_query::SpsmQueryOptions;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (encoding, name) in ["paper", "lines"].into_iter().enumerate() {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let side = (setup.layers.splits.len() as f64).sqrt() as usize;
        let texels = SpsmTexels::new(&gpu.device, &gpu.queue, side, 1, 5)?;
        let stage = SpsmMap::new(&gpu.device, encoding as u32, &texels);
        let marks = SeenTexels::new(&gpu.device, SpsmQueryOptions::default(), &texels);
        cases.push(Case {
            name: format!("spsm_map {name}"),
            size: setup.casters.triangles.len(),
            bytes: setup.in_light.items * 192 + side * side * 28,
            atomics: side * side * 2,
            flops: setup.cells_lit * 6,
            record: Box::new(move |s| {
                marks.record_all(s, &setup.frame, &texels.marks);
                stage.record(s, &setup.frame, setup.lit(), &texels)
            }),
        });
    }
    Ok(cases)
}
