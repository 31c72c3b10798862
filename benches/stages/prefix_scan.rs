//! The exclusive scan, of small values and of values whose sum saturates.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::{Count, PrefixScan};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let stage = PrefixScan::new(&gpu.device);
    let mut cases = Vec::new();
    for (name, shift) in [("prefix_scan", 28), ("prefix_scan saturated", 0)] {
        let values: Vec<u32> = words(size).iter().map(|w| w >> shift).collect();
        let input = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.input", &values)?;
        let output = Buffer::storage(&gpu.device, "bench.output", size)?;
        let total = Buffer::storage(&gpu.device, "bench.total", 2)?;
        let scratch = PrefixScan::scratch(&gpu.device, size)?;
        let stage = stage.clone();
        cases.push(Case {
            name: name.to_owned(),
            size,
            bytes: size * 8,
            atomics: 0,
            flops: 0,
            record: Box::new(move |s| stage.record(s, &input, &output, (&total, 0), &scratch, Count::Exactly(size))),
        });
    }
    Ok(cases)
}
