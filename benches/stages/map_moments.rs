//! Mean and variance of all squares of a map of 512 × 512.

use crate::harness::Case;
use crate::harness::geometry::WithMoments;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(map) = WithMoments::new(gpu, size)? else { return Ok(Vec::new()) };
    Ok(vec![Case {
        name: "map_moments".to_owned(),
        size: map.setup.casters.triangles.len(),
        bytes: map.setup.layers.nearest_keys.len() * 4 + map.moments.len() * 8,
        atomics: 0,
        flops: map.moments.len() * 20,
        record: Box::new(move |s| {
            map.record(s);
            Ok(())
        }),
    }])
}
