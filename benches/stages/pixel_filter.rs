//! Visibility weighted over a pixel and those around it, one facet a pixel: a tent over 3 x 3, Mitchell over 5 x 5; all pixels in part lit.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::pixel_filter::PixelFilter;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::stages::facet_classify::{Facet, Facets};
use subpixel_shadows::stages::pixel_filter::{FilterMasks, FilterMemory};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for filter in [PixelFilter::Tent, PixelFilter::Mitchell] {
        let stage = FilterMasks::new(&gpu.device, 1, filter);
        let facets = Facets::new(&gpu.device, size, size, 1)?;
        facets.list.write(&gpu.queue, &vec![Facet { state: 4, ..Facet::default() }; size]);
        facets.masks.write(&gpu.queue, &words(size * 3));
        facets.pixel_facets.write(&gpu.queue, &(0..=size as u32).collect::<Vec<_>>());
        let width = 1 << (size.ilog2() / 2);
        let frame = Buffer::uniform(&gpu.device, "bench.frame", 1)?;
        let image_size = [width, size as u32 / width];
        frame.write(&gpu.queue, &[Frame { image_size, sample_count: 32, ..Frame::default() }]);
        let visibility = Buffer::storage(&gpu.device, "bench.visibility", size)?;
        let lit = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.lit", &words(size))?;
        let samples = Samples::new(Pattern::LowDiscrepancy, 32)?;
        let memory = FilterMemory::new(&gpu.device, &gpu.queue, filter, &samples, size)?;
        let around = (2 * filter.reach() as usize + 1).pow(2);
        cases.push(Case {
            name: format!("pixel_filter {filter:?}"),
            size,
            // State, masks, places and seen mask of a facet; lit and seen masks and the result of a pixel.
            bytes: size * (4 + 12 + 4 + 4 + 8 + 4),
            atomics: 0,
            // A quarter of the samples are seen, and half of these are lit.
            flops: size * around * (8 + 4),
            record: Box::new(move |s| {
                stage.record(s, &frame, &facets, &lit, &visibility, &memory);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
