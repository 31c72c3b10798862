//! A ball in three maps of 512 × 512. The keys hold the result of the run before, so that nothing is beaten any more.

use crate::harness::Case;
use crate::harness::splits::{Splits, VIEWS};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(splits) = Splits::new(gpu, size)? else { return Ok(Vec::new()) };
    let count = splits.setup.casters.triangles.len();
    Ok(vec![Case {
        name: "split_maps".to_owned(),
        size: count,
        // Rectangles and counts of every triangle in every view, and the corners of the triangle of every block.
        bytes: VIEWS * count * (12 + 3 * 16) + splits.blocks * (12 + 3 * 16 + 8),
        atomics: 0,
        flops: VIEWS * count * 80 + splits.blocks * 32 * 15,
        record: Box::new(move |s| splits.record_maps(s)),
    }])
}
