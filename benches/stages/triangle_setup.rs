//! Triangles of a ball.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::triangle_setup::TriangleSetup;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = TriangleSetup::new(&gpu.device);
    let count = setup.casters.triangles.len();
    Ok(vec![Case {
        name: "triangle_setup".to_owned(),
        size: count,
        bytes: count * 60 + setup.points.len() * 48,
        atomics: 0,
        flops: count * 60,
        record: Box::new(move |s| {
            let (triangles, map) = (&setup.casters.triangles, &setup.map_points);
            let (points, requested) = (&setup.points, &setup.requested);
            stage.record_camera(s, &setup.frame, triangles, points, &setup.facts, count)?;
            stage.record_light(s, &setup.frame, triangles, points, map, requested, &setup.facts, count)?;
            Ok(())
        }),
    }])
}
