//! All pixel-texel pairs of a ball of this many triangles. The list is full after the first runs: what is tested stays.

use crate::harness::Case;
use crate::harness::shadow::{PLACES, Shadow};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::candidate_pairs::CandidatePairs;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = CandidatePairs::new(&gpu.device, 1, PLACES, true);
    let (bytes, atomics) = (shadow.counts[0] * 136, shadow.counts[2]);
    Ok(vec![Case {
        name: "candidate_pairs".to_owned(),
        size,
        bytes,
        atomics,
        flops: shadow.tests * 12,
        record: Box::new(move |s| shadow.candidates(s, &stage)),
    }])
}
