//! A map of 512 × 512 with two depths in every texel. The depths are those that the run before left.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::compared_depths::{ComparedDepths, DepthRule};
use subpixel_shadows::stages::light_layers::Layers;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let texels = setup.layers.splits.len();
    let side = texels.isqrt();
    let layers = Layers::without_marks(&gpu.device, side)?;
    layers.nearest_keys.write(&gpu.queue, &vec![!0.25f32.to_bits(); texels]);
    layers.second_keys.write(&gpu.queue, &vec![!0.75f32.to_bits(); texels]);
    let stage = ComparedDepths::new(&gpu.device, DepthRule::Midpoint);
    Ok(vec![Case {
        name: "compared_depths".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: texels * 12,
        atomics: 0,
        flops: texels * 3,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, &layers, side as u32);
            Ok(())
        }),
    }])
}
