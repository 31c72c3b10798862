//! Pairs of the 2^18 texels of a 512² map, sorted: spread over all texels, and all in one.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::sorted_pairs::Sorted;
use subpixel_shadows::stages::{PrefixScan, SortedPairs};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let scan = PrefixScan::new(&gpu.device);
    let texels = 1usize << 18;
    let mut cases = Vec::new();
    for (name, spread) in [("sorted_pairs", texels as u32), ("sorted_pairs, one texel", 1)] {
        let stage = SortedPairs::new(&gpu.device, &scan);
        let keys: Vec<u32> = words(size).iter().map(|w| w % spread).collect();
        let scratch = SortedPairs::scratch(&gpu.device, size, true)?;
        scratch.keys.write(&gpu.queue, &keys);
        scratch.appended.write(&gpu.queue, &[size as u32, 0]);
        let counts = Buffer::<u32>::storage(&gpu.device, "bench.counts", texels)?;
        let pairs = Buffer::<[u32; 2]>::storage(&gpu.device, "bench.pairs", size)?;
        cases.push(Case {
            name: name.to_owned(),
            size,
            // Three passes of six bits, then the bounds and the pairs.
            bytes: size * (72 + 24),
            atomics: 2 * size.min(spread as usize),
            flops: 0,
            record: Box::new(move |s| stage.record(s, &scratch, Sorted::Pairs(&pairs), &counts)),
        });
    }
    Ok(cases)
}
