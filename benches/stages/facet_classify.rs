//! The facets of 800 × 600 pixels that see a ball of this many triangles, none settled.

use crate::harness::Case;
use crate::harness::shadow::Shadow;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, Groups};
use subpixel_shadows::stages::facet_classify::{ClassifyInputs, FacetClassify};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = FacetClassify::new(&gpu.device, 1);
    let (bytes, atomics) = (800 * 600 * 250, 0);
    Ok(vec![Case {
        name: "facet_classify".to_owned(),
        size,
        bytes,
        atomics,
        // Four corners on the plane and in the light view.
        flops: 800 * 600 * 160,
        record: Box::new(move |s| {
            let around = ClassifyInputs {
                triangles: shadow.triangles(),
                positions: &shadow.setup.casters.positions,
                sat: &shadow.sat,
                splits: &shadow.splits,
            };
            let count = shadow.facets.list.len();
            stage.record_classify(
                s,
                &shadow.frame,
                &shadow.samples,
                around,
                &shadow.facets,
                Groups::Items(count as u64),
            );
            Ok(())
        }),
    }])
}
