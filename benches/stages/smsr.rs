//! Borders drawn anew for 32 samples a pixel on a map of 512 × 512, by midpoints and by corners.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::smsr::{Smsr, SmsrOptions};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (name, midpoints) in [("midpoints", true), ("corners", false)] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let stage = Smsr::new(&gpu.device, SmsrOptions { reach: 16, midpoints, constant: 5e-5, slope: 0.5 });
        let count = setup.id_keys.len();
        let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
        cases.push(Case {
            name: format!("smsr {name}"),
            size: setup.casters.triangles.len(),
            bytes: count * 8 + setup.layers.nearest_keys.len() * 4,
            atomics: 0,
            // The place of each sample, and four lines of which most are none.
            flops: count * 32 * 20,
            record: Box::new(move |s| {
                stage.record(s, &setup.frame, setup.seen_with(&samples), &setup.layers.nearest_keys, &visibility);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
