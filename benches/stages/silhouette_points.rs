//! The silhouette edges of a ball in a map of 512 × 512, one of two runs. The keys hold the result of the run before.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::silhouette_points::{EdgeBlocks, SilhouetteCells, SilhouettePoints};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = SilhouettePoints::new(&gpu.device);
    let cells = SilhouetteCells::new(&gpu.device, setup.layers.splits.len().isqrt())?;
    Ok(vec![Case {
        name: "silhouette_points".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: setup.edge_work.items * (8 + 32 + 16) + cells.point_keys.len() * 8,
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| {
            let blocks = EdgeBlocks {
                edges: &setup.casters.edges,
                points: &setup.map_points,
                rects: &setup.edge_rects,
                offsets: setup.edge_work.offsets(),
                args: setup.edge_work.args(),
            };
            stage.record(s, &setup.frame, blocks, &setup.layers.nearest_keys, &cells);
            Ok(())
        }),
    }])
}
