//! The sort of pairs: texel keys of a 512² map (18 bits), whole words, and keys that are all equal.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::radix_sort::{Pairs, digits};
use subpixel_shadows::stages::{Count, PrefixScan, RadixSort};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let scan = PrefixScan::new(&gpu.device);
    let mut cases = Vec::new();
    for (name, key_bits, equal) in
        [("radix_sort 18 bits", 18, false), ("radix_sort 32 bits", 32, false), ("radix_sort 18, equal", 18, true)]
    {
        let stage = RadixSort::new(&gpu.device, &scan);
        let keys = if equal { vec![12_345; size] } else { words(size) };
        let keys = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.keys", &keys)?;
        let list = |label| Buffer::<u32>::storage(&gpu.device, label, size);
        let (values, keys_out, values_out) = (list("bench.values")?, list("bench.keys")?, list("bench.values")?);
        let scratch = RadixSort::scratch(&gpu.device, size)?;
        cases.push(Case {
            name: name.to_owned(),
            size,
            bytes: size * 16 * digits(key_bits).count(),
            atomics: 0,
            flops: 0,
            record: Box::new(move |s| {
                let pairs = Pairs { keys: &keys, values: &values };
                let sorted = Pairs { keys: &keys_out, values: &values_out };
                stage.record(s, pairs, sorted, &scratch, key_bits, Count::Exactly(size))
            }),
        });
    }
    Ok(cases)
}
