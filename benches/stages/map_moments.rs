//! Mean and variance of all squares of three maps of 512 × 512.

use crate::harness::Case;
use crate::harness::splits::Splits;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(splits) = Splits::new(gpu, size)? else { return Ok(Vec::new()) };
    Ok(vec![Case {
        name: "map_moments".to_owned(),
        size: splits.setup.casters.triangles.len(),
        bytes: splits.maps.keys.len() * 4 + splits.moments.len() * 8,
        atomics: 0,
        flops: splits.moments.len() * 20,
        record: Box::new(move |s| splits.record_moments(s)),
    }])
}
