//! Requests of the facets of 800 × 600 pixels that see a ball of this many triangles, in a map of 512 × 512.

use crate::harness::Case;
use crate::harness::shadow::Shadow;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, Groups};
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = RequestedBlocks::new(&gpu.device);
    Ok(vec![Case {
        name: "requested_blocks".to_owned(),
        size,
        bytes: 800 * 600 * 28,
        atomics: 0,
        // Four corners on the plane and in the light view.
        flops: 800 * 600 * 150,
        record: Box::new(move |s| {
            let (setup, facets) = (&shadow.setup, &shadow.facets.list);
            let (triangles, positions) = (shadow.triangles(), &setup.casters.positions);
            let groups = Groups::Items(facets.len() as u64);
            stage.record(s, &shadow.frame, triangles, positions, facets, &setup.requested, groups);
            Ok(())
        }),
    }])
}
