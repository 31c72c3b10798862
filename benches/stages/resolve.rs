//! Masks to visibility, one facet a pixel, 32 and 128 samples.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::facet_classify::{Facet, Facets};
use subpixel_shadows::stages::resolve::Resolve;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let mut cases = Vec::new();
    for count in [32u32, 128] {
        let width = count as usize / 32;
        let stage = Resolve::new(&gpu.device, width as u32);
        let facets = Facets::new(&gpu.device, size, size, width)?;
        let list: Vec<_> = words(size).iter().map(|w| Facet { state: w % 5, ..Facet::default() }).collect();
        facets.list.write(&gpu.queue, &list);
        facets.masks.write(&gpu.queue, &words(size * 3 * width));
        facets.pixel_facets.write(&gpu.queue, &(0..=size as u32).collect::<Vec<_>>());
        let frame = Buffer::uniform(&gpu.device, "bench.frame", 1)?;
        frame.write(&gpu.queue, &[Frame { image_size: [size as u32, 1], sample_count: count, ..Frame::default() }]);
        let visibility = Buffer::storage(&gpu.device, "bench.visibility", size)?;
        let lit = Buffer::storage(&gpu.device, "bench.lit", size * width)?;
        let status = Buffer::storage(&gpu.device, "bench.status", 32)?;
        cases.push(Case {
            name: format!("resolve {count}"),
            size,
            // A facet's state alone is read of it.
            bytes: size * (4 + 8 + 4 + 16 * width),
            atomics: size.div_ceil(64) * 5,
            flops: 0,
            record: Box::new(move |s| {
                stage.record(s, &frame, &facets, &visibility, &lit, &status);
                Ok(())
            }),
        });
    }
    Ok(cases)
}
