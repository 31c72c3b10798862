//! Counts of pixels: one facet a pixel, a pair and a candidate each.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::facet_classify::{Facet, Facets, Undecided};
use subpixel_shadows::stages::pixel_counts::{CountedPairs, CountedPixels, PixelCounts};
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, TALLY_WORDS};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let facets = Facets::new(device, size, size, 1)?;
    let list: Vec<_> = words(size).iter().map(|w| Facet { state: w % 5, ..Facet::default() }).collect();
    facets.list.write(queue, &list);
    facets.pixel_facets.write(queue, &(0..=size as u32).collect::<Vec<_>>());
    let undecided: Vec<_> = (0..size as u32).map(|pixel| Undecided { pixel, ..Undecided::default() }).collect();
    facets.undecided.write(queue, &undecided);
    let lists = PairLists::new(device, 64, PairTiles::Tiles, size, 0, size, false)?;
    lists.pixel_pairs.write(queue, &(0..size as u32).map(|f| [f, 15]).collect::<Vec<_>>());
    let mut tally = vec![0; TALLY_WORDS];
    tally[..2].fill(size as u32);
    tally.extend((0..size as u32).flat_map(|f| [f, f]));
    lists.candidates.write(queue, &tally);
    let args = Buffer::indirect(device, "bench.args", 3)?;
    let groups = size.div_ceil(64) as u32;
    args.write(queue, &[groups.min(65_535), groups.div_ceil(65_535), 1]);
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    let capacities = [size as u32; 2];
    frame.write(
        queue,
        &[Frame {
            image_size: [size as u32, 1],
            pixel_texel_capacity: capacities[0],
            candidate_capacity: capacities[1],
            ..Frame::default()
        }],
    );
    let counts = Buffer::<PixelCounts>::storage(device, "bench.counts", size)?;
    let (pairs, pixels) = (CountedPairs::new(device, PairTiles::Tiles), CountedPixels::new(device));
    Ok(vec![Case {
        name: "pixel_counts".to_owned(),
        size,
        // Pairs and candidates with their facets' pixels; of a facet its state and which it is; counts.
        bytes: size * (2 * (8 + 4) + 4 + 8 + 16),
        atomics: 2 * size,
        flops: 0,
        record: Box::new(move |s| {
            let args = [(args.raw(), 0); 2];
            pairs.record(s, &frame, &facets, &lists, args, &counts);
            pixels.record_facets(s, &frame, &facets, &counts);
            Ok(())
        }),
    }])
}
