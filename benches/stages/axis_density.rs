//! Pixels of a ball asking for the axes of a map of 512 × 512, and the densities and borders that follow.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::axis_density::{AxisDensity, AxisTables, DensityRule};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for (name, shape) in [("request", false), ("shape", true)] {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let stage = AxisDensity::new(&gpu.device, DensityRule::Requested, 64)?;
        let tables = AxisTables::new(&gpu.device, MAP)?;
        let count = setup.id_keys.len();
        let (words, cells, borders) = (tables.requests.len(), tables.densities.len(), tables.borders.len());
        cases.push(Case {
            name: format!("axis_density {name}"),
            size: setup.casters.triangles.len(),
            bytes: if shape { 4 * (words + cells) + 12 * cells + 8 * borders } else { count * (4 + 12 + 48) },
            atomics: 0,
            // Five rays to the plane and into the light's view.
            flops: if shape { 0 } else { count * 5 * 60 },
            record: Box::new(move |s| {
                if shape {
                    return stage.record_shape(s, &setup.frame, MAP, &tables);
                }
                stage.record_request(s, &setup.frame, setup.seen_with(&samples), &tables);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
