//! Between which depths the pixels of an image see triangles.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::seen_depths::SeenDepths;
use subpixel_shadows::status::Status;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let pixels = setup.id_keys.len();
    let status = Buffer::<u32>::storage(&gpu.device, "bench.status", Status::words(1))?;
    let stage = SeenDepths::new(&gpu.device);
    Ok(vec![Case {
        name: "seen_depths".to_owned(),
        size: setup.casters.triangles.len(),
        // A key, and a triangle with its points once for a pixel at the most.
        bytes: pixels * 4,
        atomics: pixels / 32,
        // Two edges and their product, three corners from the ray, two products along it.
        flops: pixels * 60,
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), &status, pixels as u64);
            Ok(())
        }),
    }])
}
