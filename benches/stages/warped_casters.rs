//! Casters of a ball into a map of 512 × 512 whose axes its pixels warp.

use crate::harness::Case;
use crate::harness::geometry::{MAP, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::axis_density::{AxisDensity, AxisTables, DensityRule};
use subpixel_shadows::stages::warped_casters::{WarpedCasters, WarpedTexels};

/// Axes that the pixels of a ball warp.
pub fn tables(gpu: &Gpu, setup: &Setup) -> Result<AxisTables> {
    let samples = samples(gpu, 32)?;
    let density = AxisDensity::new(&gpu.device, DensityRule::Requested, 64)?;
    let tables = AxisTables::new(&gpu.device, MAP)?;
    let mut encoder = gpu.encoder();
    {
        let mut rec = Recorder::new(&gpu.device, &mut encoder, None);
        let s = &mut rec.stage("bench");
        density.record_request(s, &setup.frame, setup.seen_with(&samples), &tables);
        density.record_shape(s, &setup.frame, MAP, &tables)?;
    }
    gpu.submit_and_wait(encoder)?;
    Ok(tables)
}

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let tables = tables(gpu, &setup)?;
    let triangles = setup.casters.triangles.len();
    let texels = WarpedTexels::new(&gpu.device, &gpu.queue, triangles, MAP)?;
    let stage = WarpedCasters::new(&gpu.device, false);
    let made = (MAP * MAP) as usize;
    Ok(vec![Case {
        name: "warped_casters".to_owned(),
        size: triangles,
        bytes: triangles * (16 + 48 + 8 + 8 + 4 + 12) + made * 4,
        atomics: made,
        flops: made * 30,
        record: Box::new(move |s| stage.record(s, &setup.frame, setup.lit(), &tables, &texels)),
    }])
}
