//! A ball in an image of 800 × 600. The keys hold the result of the run before, so that no atomic changes them: what is
//! timed is the raster alone.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::camera_visibility::CameraVisibility;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (name, stage) in [
        ("camera_visibility", CameraVisibility::new(&gpu.device)),
        ("camera_visibility 32 bits", CameraVisibility::narrow(&gpu.device)),
    ] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let (count, pixels, runs) = (setup.casters.triangles.len(), setup.seen_keys.len(), stage.runs());
        cases.push(Case {
            name: name.to_owned(),
            size: count,
            bytes: runs * setup.in_camera.items * 96 + (runs + 1) * pixels * 8,
            atomics: 0,
            flops: runs * setup.cells_seen * 6,
            record: Box::new(move |s| {
                stage.record(s, setup.frame.raw(), setup.seen(), &setup.seen_keys, &setup.id_keys)
            }),
        });
    }
    Ok(cases)
}
