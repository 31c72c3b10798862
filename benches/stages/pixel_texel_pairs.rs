//! The counting run, a ball of this many triangles on 800 × 600 pixels and 512 × 512 texels, all texels marked.

use crate::harness::Case;
use crate::harness::shadow::{PLACES, Shadow};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::pixel_texel_pairs::PixelTexelPairs;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = PixelTexelPairs::new(&gpu.device, PLACES);
    let (bytes, atomics) = (shadow.items * 128, shadow.counts[0]);
    Ok(vec![Case {
        name: "pixel_texel_pairs".to_owned(),
        size,
        bytes,
        atomics,
        flops: shadow.counts[0] * 16,
        record: Box::new(move |s| shadow.pixel_pairs(s, &stage, 0)),
    }])
}
