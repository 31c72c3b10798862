//! A ball in a map of 512 × 512. The keys hold the result of the run before, so that nothing is beaten any more.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::light_layers::LightLayers;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = LightLayers::new(&gpu.device);
    let (count, texels) = (setup.casters.triangles.len(), setup.layers.splits.len());
    Ok(vec![Case {
        name: "light_layers".to_owned(),
        size: count,
        bytes: setup.in_light.items * 96 + texels * 8,
        atomics: 0,
        flops: setup.cells_lit * 6,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.lit(), &setup.layers);
            Ok(())
        }),
    }])
}
