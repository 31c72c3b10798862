//! The pixels of 800 × 600 against three maps of 512 × 512: 32 samples by depth, and footprints by moments.

use crate::harness::Case;
use crate::harness::geometry::samples;
use crate::harness::splits::Splits;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::split_shadows::{OfMaps, SplitQuery, SplitShadows};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let depths = SplitQuery::Depths { constant: 5e-5, slope: 1.05 };
    let moments = SplitQuery::Moments { constant: 5e-5, bleeding: 0.0, grazing: 0.0 };
    let mut cases = Vec::new();
    for (name, ask) in [("depths", depths), ("moments", moments)] {
        let Some(splits) = Splits::new(gpu, size)? else { return Ok(Vec::new()) };
        let samples = samples(gpu, 32)?;
        let stage = SplitShadows::new(&gpu.device, ask);
        let count = splits.setup.id_keys.len();
        let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
        cases.push(Case {
            name: format!("split_shadows {name}"),
            size: splits.setup.casters.triangles.len(),
            bytes: count * 8 + splits.maps.keys.len() * 4 + if ask == moments { splits.moments.len() * 8 } else { 0 },
            atomics: 0,
            // The place of each sample, or that of the pixel and eight cells.
            flops: count * if ask == depths { 32 * 60 } else { 300 },
            record: Box::new(move |s| {
                let (frame, seen) = (&splits.setup.frame, splits.setup.seen_with(&samples));
                let maps = OfMaps { splits: &splits.views, keys: &splits.maps.keys, moments: &splits.moments };
                stage.record(s, frame, seen, maps, &visibility);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
