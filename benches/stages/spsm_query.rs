//! Classes of all pixels, and the recovery of the uncertain ones with 32 samples, of a ball on a map of 512 × 512.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::seen_texels::SeenTexels;
use subpixel_shadows::stages::spsm_map::{SpsmMap, SpsmTexels};
use subpixel_shadows::stages::spsm_query::{SpsmPixels, SpsmQuery, SpsmQueryOptions};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (device, queue) = (&gpu.device, &gpu.queue);
    let side = (setup.layers.splits.len() as f64).sqrt() as usize;
    let count = setup.id_keys.len();
    let texels = SpsmTexels::new(device, queue, side, count, 5)?;
    let samples = samples(gpu, 32)?;
    let pixels = SpsmPixels::new(device, queue, count, 1)?;
    let options = SpsmQueryOptions { many: true, ..SpsmQueryOptions::default() };
    let stage = SpsmQuery::new(device, &PrefixScan::new(device), options, &texels);
    let frame = &setup.frame.clone();
    // The list of the uncertain pixels lies beside the marks, as a frame leaves it.
    let mut encoder = gpu.encoder();
    let mut rec = Recorder::new(device, &mut encoder, None);
    let seen = setup.seen_with(&samples);
    let mut all = rec.stage("setup");
    SeenTexels::new(device, options, &texels).record_all(&mut all, frame, &texels.marks);
    SpsmMap::new(device, 1, &texels).record(&mut all, frame, setup.lit(), &texels)?;
    stage.record_classify(&mut all, frame, seen, &texels, &pixels)?;
    stage.record_settle(&mut all, frame, seen, &texels, &pixels)?;
    drop(all);
    texels.marks.take_list(&mut rec, &pixels);
    gpu.submit_and_wait(encoder)?;
    Ok(vec![Case {
        name: "spsm_query".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: count * (4 + 16 + 4 + 4 + 4),
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| {
            stage.record_classify(s, &setup.frame, setup.seen_with(&samples), &texels, &pixels)?;
            stage.record_settle(s, &setup.frame, setup.seen_with(&samples), &texels, &pixels)?;
            stage.record_recover(s, &setup.frame, setup.seen_with(&samples), &texels, &pixels);
            Ok(())
        }),
    }])
}
