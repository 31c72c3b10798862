//! Stable sort of (key, value) pairs by the low bits of their keys.
//!
//! - **Purpose.** Orders pairs by key: equal keys stay in their old order, so the result is one list whatever the adapter.
//! - **Reads** keys and values up to the count; they are not changed.
//! - **Writes** the sorted keys and values; beyond the count nothing.
//! - **Guarantee.** Exact and stable, the same bits on every run. Bits of a key above `key_bits` do not count, but are
//!   kept.
//! - **Capacity.** That of the scratch; a count in a buffer beyond it is cut to it.
//! - **Cost.** `p = ceil(key_bits / 6)` passes (at least one) of five dispatches and 24 bytes of traffic a pair: only the
//!   bits that are needed.
//! - **Source.** Reduce-then-scan least-significant-digit sort; per-thread 16-bit counters after Satish, Harris, Garland,
//!   *Designing efficient sorting algorithms for manycore GPUs*, 2009.

use super::{Count, PrefixScan, holds, prefix_scan};
use crate::gpu::kernels::radix_sort as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "radix_sort" => pub struct RadixSortParams {
        /// Pairs.
        pub limit: u32,
        /// Where in `counts` the number of pairs stands.
        pub count_word: u32,
        /// Lowest bit of the digit.
        pub shift: u32,
        /// Values of the digit.
        pub bins: u32,
        /// Blocks of `limit` pairs.
        pub blocks: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
    }
}

/// A list of pairs: keys and values of equal length.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<'a> {
    /// The keys.
    pub keys: &'a Buffer<u32>,
    /// The values.
    pub values: &'a Buffer<u32>,
}

/// The pipelines of the sort.
#[derive(Debug)]
pub struct RadixSort {
    count: kernel::CountProgram,
    scatter: kernel::ScatterProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Scratch memory for sorts of up to `capacity` pairs: 8.2 bytes a pair.
#[derive(Debug)]
pub struct RadixSortScratch {
    capacity: usize,
    keys: Buffer<u32>,
    values: Buffer<u32>,
    histogram: Buffer<u32>,
    offsets: Buffer<u32>,
    total: Buffer<u32>,
    scan: prefix_scan::PrefixScanScratch,
}

/// The digits of keys of `key_bits` bits, lowest first: as few as can be, of nearly equal width. (first bit, bits)
pub fn digits(key_bits: u32) -> impl Iterator<Item = (u32, u32)> {
    let passes = key_bits.div_ceil(kernel::DIGIT_BITS).max(1);
    let width = key_bits.div_ceil(passes).max(1);
    (0..passes).map(move |pass| pass * width).map(move |first| (first, width.min(key_bits.saturating_sub(first))))
}

impl RadixSort {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            count: kernel::CountProgram::new(device, ()),
            scatter: kernel::ScatterProgram::new(device, ()),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Scratch memory for up to `capacity` pairs.
    ///
    /// # Errors
    /// As [`Buffer::storage`] and [`PrefixScan::scratch`].
    pub fn scratch(device: &wgpu::Device, capacity: usize) -> Result<RadixSortScratch> {
        let counters = capacity.div_ceil(kernel::BLOCK as usize) * kernel::MAX_BINS as usize;
        Ok(RadixSortScratch {
            capacity,
            keys: Buffer::storage(device, "radix_sort.keys", capacity)?,
            values: Buffer::storage(device, "radix_sort.values", capacity)?,
            histogram: Buffer::storage(device, "radix_sort.histogram", counters)?,
            offsets: Buffer::storage(device, "radix_sort.offsets", counters)?,
            total: Buffer::storage(device, "radix_sort.total", 2)?,
            scan: PrefixScan::scratch(device, counters)?,
        })
    }

    /// Records the sort of `pairs` into `sorted` by the lowest `key_bits` bits of the keys (0 to 32).
    ///
    /// # Errors
    /// [`Error::Config`] if `key_bits` is above 32, a buffer is too small, or input and output share one.
    pub fn record(
        &self,
        stage: &mut Stage,
        pairs: Pairs,
        sorted: Pairs,
        scratch: &RadixSortScratch,
        key_bits: u32,
        count: Count,
    ) -> Result<()> {
        let limit = count.limit("radix_sort", scratch.capacity)?;
        if key_bits > 32 {
            return Err(Error::Config(format!("radix_sort: keys of {key_bits} bits, at most 32")));
        }
        for (what, list) in [("pairs", pairs), ("sorted", sorted)] {
            holds("radix_sort", what, list.keys.len().min(list.values.len()), limit)?;
        }
        for (input, output) in [(pairs.keys, sorted.keys), (pairs.values, sorted.values)] {
            if input.raw() == output.raw() {
                return Err(Error::Config("radix_sort: input and output are the same buffer".to_owned()));
            }
        }
        // Passes take turns between scratch and output, so that the last one writes the output.
        let between = Pairs { keys: &scratch.keys, values: &scratch.values };
        let passes = digits(key_bits).count();
        let mut from = pairs;
        for (pass, (shift, bits)) in digits(key_bits).enumerate() {
            let to = if (passes - pass) % 2 == 1 { sorted } else { between };
            self.pass(stage, from, to, scratch, (shift, bits), (limit, count))?;
            from = to;
        }
        Ok(())
    }

    /// One pass, over the digit of `bits` bits from bit `shift` on.
    fn pass(
        &self,
        stage: &mut Stage,
        from: Pairs,
        to: Pairs,
        scratch: &RadixSortScratch,
        (shift, bits): (u32, u32),
        (limit, count): (usize, Count),
    ) -> Result<()> {
        let blocks = limit.div_ceil(kernel::BLOCK as usize);
        let params = self.uniforms.get(
            stage.device,
            &RadixSortParams {
                limit: limit as u32,
                count_word: count.word(),
                shift,
                bins: 1 << bits,
                blocks: blocks as u32,
                ..RadixSortParams::default()
            },
        )?;
        let bindings = kernel::Digits {
            params: params.as_uniform(),
            counts: count.words(&params),
            keys_in: from.keys.as_read().cast(),
            values_in: from.values.as_read().cast(),
            histogram: scratch.histogram.as_write(),
            offsets: scratch.offsets.as_read(),
            keys_out: to.keys.as_write(),
            values_out: to.values.as_write(),
        };
        let groups = || Groups::Workgroups(blocks as u64);
        stage.run(&self.count, bindings, groups());
        let (histogram, offsets) = (&scratch.histogram, &scratch.offsets);
        let counters = Count::Exactly(blocks << bits);
        self.scan.record(stage, histogram, offsets, (&scratch.total, 0), &scratch.scan, counters)?;
        stage.run(&self.scatter, bindings, groups());
        Ok(())
    }
}
