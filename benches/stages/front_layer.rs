//! The check of a ball against the layers of a map of 512 × 512, and the settling of every texel.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::front_layer::FrontLayer;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = FrontLayer::new(&gpu.device);
    let (count, texels) = (setup.casters.triangles.len(), setup.layers.splits.len());
    Ok(vec![Case {
        name: "front_layer".to_owned(),
        size: count,
        bytes: setup.in_light.items * 96 + texels * 20,
        atomics: 0,
        flops: setup.cells_lit * 6,
        record: Box::new(move |s| {
            stage.record_check(s, &setup.frame, setup.lit(), &setup.layers);
            stage.record_settle(s, &setup.frame, &setup.layers);
            Ok(())
        }),
    }])
}
