//! Edges of a ball: which are silhouettes, and the texels of a map of 512 × 512 that those touch.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::silhouette_mask::SilhouetteMask;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = SilhouetteMask::new(&gpu.device);
    let count = setup.casters.edges.len();
    Ok(vec![Case {
        name: "silhouette_mask".to_owned(),
        size: count,
        bytes: count * 36 + setup.edge_work.items * 48,
        atomics: 0,
        flops: count * 24,
        record: Box::new(move |s| {
            let (frame, edges, map) = (&setup.frame, &setup.casters.edges, &setup.map_points);
            let (rects, items, facing) = (&setup.edge_rects, &setup.edge_items, &setup.facts.facing);
            let requested = &setup.requested;
            stage.record_classify(s, frame, edges, facing, map, requested, rects, items, &setup.status, count)?;
            let work = &setup.edge_work;
            stage.record_raster(s, frame, edges, map, rects, work.offsets(), work.args(), &setup.layers);
            Ok(())
        }),
    }])
}
