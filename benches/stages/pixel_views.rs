//! Which of three views each pixel asks, and what is kept and taken for one of them.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::pixel_views::{LightViews, PixelChoice, PixelViews, TakeWords};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let count = setup.id_keys.len();
    let choice = PixelChoice::new(&gpu.device, count)?;
    choice.views.write(&gpu.queue, &[LightViews::new(&[setup.view; 3])]);
    let stage = PixelViews::new(&gpu.device, 1.0);
    let take = TakeWords::new(&gpu.device, 1, 0);
    let [left, taken] = [0, 1].map(|_| Buffer::<u32>::storage(&gpu.device, "bench.words", count));
    let (left, taken) = (left?, taken?);
    Ok(vec![Case {
        name: "pixel_views".to_owned(),
        size: setup.casters.triangles.len(),
        // Keys twice, choices three times, kept, left and taken.
        bytes: count * 32,
        atomics: 0,
        // Five points on the plane, and where they lie in one view at least.
        flops: count * 5 * 40,
        record: Box::new(move |s| {
            stage.record_choose(s, &setup.frame, setup.seen_with(&samples), &choice);
            stage.record_keep(s, &setup.frame, 0, &setup.id_keys, &choice)?;
            take.record(s, &setup.frame, 0, &choice, (left.as_read(), &taken))
        }),
    }])
}
