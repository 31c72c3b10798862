//! Compaction of indices, half of them kept, by words and by bits.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::compact::Flags;
use subpixel_shadows::stages::{Compact, Count, PrefixScan};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let scan = PrefixScan::new(&gpu.device);
    let mut cases = Vec::new();
    for (name, packed) in [("compact words", false), ("compact bits", true)] {
        let stage = Compact::new(&gpu.device, &scan);
        let len = if packed { size.div_ceil(32) } else { size };
        let marks: Vec<u32> = if packed { words(len) } else { words(len).iter().map(|w| w & 1).collect() };
        let flags = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.flags", &marks)?;
        let kept = Buffer::storage(&gpu.device, "bench.kept", size)?;
        let total = Buffer::storage(&gpu.device, "bench.total", 2)?;
        let scratch = Compact::scratch(&gpu.device, size)?;
        cases.push(Case {
            name: name.to_owned(),
            size,
            bytes: len * 4 + size / 2 * 4,
            atomics: 0,
            flops: 0,
            record: Box::new(move |s| {
                let flags = if packed { Flags::Bits(&flags) } else { Flags::Words(&flags) };
                stage.record(s, flags, None, &kept, (&total, 0), &scratch, Count::Exactly(size))
            }),
        });
    }
    Ok(cases)
}
