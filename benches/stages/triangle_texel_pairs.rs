//! The counting run, a ball of this many triangles on 512 × 512 texels.

use crate::harness::Case;
use crate::harness::shadow::{PLACES, Shadow};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::triangle_texel_pairs::TriangleTexelPairs;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = TriangleTexelPairs::new(&gpu.device, PLACES);
    let (bytes, atomics) = (shadow.setup.in_light.items * 96, shadow.counts[1]);
    Ok(vec![Case {
        name: "triangle_texel_pairs".to_owned(),
        size,
        bytes,
        atomics,
        flops: shadow.counts[1] * 12,
        record: Box::new(move |s| shadow.triangle_pairs(s, &stage, 0)),
    }])
}
