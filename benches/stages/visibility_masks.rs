//! The candidates of a ball of this many triangles in single precision, 32 samples.

use crate::harness::Case;
use crate::harness::shadow::Shadow;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::visibility_masks::{EvaluationInputs, VisibilityMasks};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = VisibilityMasks::new(&gpu.device, 32, [0, 0]);
    let (bytes, atomics) = (shadow.counts[2] * 200, 0);
    Ok(vec![Case {
        name: "visibility_masks".to_owned(),
        size,
        bytes,
        atomics,
        // Four half-planes at 32 samples.
        flops: shadow.counts[2] * 32 * 16,
        record: Box::new(move |s| {
            let casters = EvaluationInputs {
                samples: &shadow.samples,
                table: &shadow.facets.items,
                triangles: shadow.triangles(),
                positions: &shadow.setup.casters.positions,
            };
            let args = (shadow.candidate_args.raw(), 0);
            stage.record_evaluate(s, &shadow.frame, casters, &shadow.facets, &shadow.lists, args);
            Ok(())
        }),
    }])
}
