//! Visibility mixed into that of a frame before, whose camera was the same.

use crate::harness::Case;
use crate::harness::geometry::{Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::history::{FrameBefore, History, HistoryBuffers};
use subpixel_shadows::stages::pixel_views::LightViews;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let samples = samples(gpu, 32)?;
    let count = setup.id_keys.len();
    let with = HistoryBuffers::new(&gpu.device, count)?;
    with.views.write(&gpu.queue, &[LightViews::new(&[setup.view])]);
    let (rays, scale) = &setup.rays;
    with.before.write(&gpu.queue, &[FrameBefore::new((rays, *scale), (rays, *scale))]);
    let visibility = Buffer::<f32>::storage(&gpu.device, "bench.visibility", count)?;
    let stage = History::new(&gpu.device, 1.0, 8);
    Ok(vec![Case {
        name: "history".to_owned(),
        size: setup.casters.triangles.len(),
        // Keys, visibility twice, the past and what is kept.
        bytes: count * (4 + 8 + 16 + 16),
        atomics: 0,
        // Five points on the plane, their places in a view, four pixels of the past.
        flops: count * (5 * 40 + 4 * 30),
        record: Box::new(move |s| {
            stage.record(s, &setup.frame, setup.seen_with(&samples), &with, &visibility);
            Ok(())
        }),
    }])
}
