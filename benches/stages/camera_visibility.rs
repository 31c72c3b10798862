//! A ball in an image of 800 × 600. The keys hold the result of the run before, so that no atomic changes them: what is
//! timed is the raster alone.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::camera_visibility::CameraVisibility;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = CameraVisibility::new(&gpu.device);
    let (count, pixels) = (setup.casters.triangles.len(), setup.centres.keys.len());
    Ok(vec![Case {
        name: "camera_visibility".to_owned(),
        size: count,
        bytes: 2 * setup.in_camera.items * 96 + 3 * pixels * 8,
        atomics: 0,
        flops: 2 * setup.cells_seen * 6,
        record: Box::new(move |s| {
            let positions = &setup.casters.positions;
            stage.record(s, &setup.frame, setup.seen(), positions, &setup.centres, &setup.id_keys)
        }),
    }])
}
