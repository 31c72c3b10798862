//! Vertices of a ball, about half as many as the size says.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::vertex_project::VertexProject;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = VertexProject::new(&gpu.device);
    let count = setup.casters.positions.len();
    Ok(vec![Case {
        name: "vertex_project".to_owned(),
        size: count,
        bytes: count * 60,
        atomics: 0,
        flops: count * 42,
        record: Box::new(move |s| {
            stage.record_place(s, &setup.frame, &setup.casters.positions, &setup.points);
            stage.record_project(s, &setup.frame, &setup.points, &setup.map_points, count)?;
            Ok(())
        }),
    }])
}
