//! Grouping into the 2^18 texels of a 512² map: pairs spread over all texels, and all in one.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::texel_group::Grouping;
use subpixel_shadows::stages::{Count, PrefixScan, TexelGroup};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let scan = PrefixScan::new(&gpu.device);
    let texels = 1usize << 18;
    let mut cases = Vec::new();
    for (name, spread) in [("texel_group", texels as u32), ("texel_group, one texel", 1)] {
        let stage = TexelGroup::new(&gpu.device, &scan);
        let keys: Vec<u32> = words(size).iter().map(|w| w % spread).collect();
        let keys = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.keys", &keys)?;
        let list = |label, len| Buffer::<u32>::storage(&gpu.device, label, len);
        let (values, grouped) = (list("bench.values", size)?, list("bench.grouped", size)?);
        let (offsets, total) = (list("bench.offsets", texels + 1)?, list("bench.total", 2)?);
        let scratch = TexelGroup::scratch(&gpu.device, size, texels)?;
        cases.push(Case {
            name: name.to_owned(),
            size,
            bytes: size * 24 + texels * 16,
            atomics: size,
            flops: 0,
            record: Box::new(move |s| {
                let to = Grouping { offsets: &offsets, grouped: &grouped, total: (&total, 0) };
                stage.record(s, &keys, Some(&values), to, &scratch, Count::Exactly(size))
            }),
        });
    }
    Ok(cases)
}
