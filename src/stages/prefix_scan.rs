//! Exclusive scan of `u32` values with saturating sums.
//!
//! - **Purpose.** Turns counts into offsets: output `i` is the sum of all inputs before `i`.
//! - **Reads** the input; values from the count on are taken as 0.
//! - **Writes** the output up to the count (host-known count) or up to the capacity (count in a buffer; what is beyond
//!   the count then holds the total, or with [`Count::Only`] anything), `total[word]` (the sum) and `total[word + 1]` (1 if it exceeds `u32::MAX`, else 0).
//! - **Guarantee.** Exact; sums above `u32::MAX` are `u32::MAX` and the flag is set; the same bits on every run.
//! - **Capacity.** Whatever the buffers hold. Lists above the binding limit ([`Buffer::banded`]) are bound in segments
//!   of whole blocks, so 2^26 values work where one binding holds 2^25.
//! - **Cost.** Three dispatches (two more per further segment); 12 bytes of traffic a value.
//! - **Source.** Reduce-then-scan after Dotsenko et al., *Fast Scan Algorithms on Graphics Processors*, ICS 2008. No
//!   look-back: WebGPU promises no forward progress between workgroups.

use super::{Count, holds};
use crate::gpu::kernels::prefix_scan as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "prefix_scan" => pub struct PrefixScanParams {
        /// Values to scan.
        pub limit: u32,
        /// Where in `counts` the number of values stands.
        pub count_word: u32,
        /// First value of the bound segment.
        pub first: u32,
        /// Values of the bound segment.
        pub length: u32,
        /// Block of `first`.
        pub first_block: u32,
        /// Blocks of all segments.
        pub blocks: u32,
        /// Where the sum goes.
        pub total_word: u32,
        /// 1: nothing need be written beyond the count.
        pub only_counted: u32,
    }
}

/// The pipelines of the scan. A clone shares them, so that stages built on the scan compile it once.
#[derive(Clone, Debug)]
pub struct PrefixScan {
    reduce: kernel::ReduceProgram,
    spine: kernel::SpineProgram,
    downsweep: kernel::DownsweepProgram,
    uniforms: Uniforms,
}

/// Block sums of a scan of up to `capacity` values.
#[derive(Debug)]
pub struct PrefixScanScratch {
    capacity: usize,
    sums: Buffer<[u32; 2]>,
}

impl PrefixScanScratch {
    /// Most values that a scan with it can have.
    pub fn capacity(&self) -> usize {
        self.capacity
    }
}

impl PrefixScan {
    /// Most values of one scan: beyond it the loop of the spine would come near the 65,535 iterations after which some
    /// software adapters silently stop.
    pub const MAX_VALUES: usize = 1 << 30;

    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            reduce: kernel::ReduceProgram::new(device, ()),
            spine: kernel::SpineProgram::new(device, ()),
            downsweep: kernel::DownsweepProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Scratch memory for up to `capacity` values: 8 bytes per 4,096 of them.
    ///
    /// # Errors
    /// [`Error::Config`] above [`PrefixScan::MAX_VALUES`], else as [`Buffer::storage`].
    pub fn scratch(device: &wgpu::Device, capacity: usize) -> Result<PrefixScanScratch> {
        if capacity > Self::MAX_VALUES {
            return Err(Error::Config(format!("prefix_scan: {capacity} values, at most {}", Self::MAX_VALUES)));
        }
        let sums = Buffer::storage(device, "prefix_scan.sums", capacity.div_ceil(kernel::BLOCK as usize))?;
        Ok(PrefixScanScratch { capacity, sums })
    }

    /// Records the scan of `input` into `output`, and its sum and overflow flag into two words of `total` (buffer and
    /// first word). `total` may be the buffer that holds the count, and may be `output` beyond the values.
    ///
    /// # Errors
    /// [`Error::Config`] if a buffer is too small, or input and output are one buffer (WebGPU lets no dispatch read and
    /// write a buffer through two bindings).
    pub fn record(
        &self,
        stage: &mut Stage,
        input: &Buffer<u32>,
        output: &Buffer<u32>,
        total: (&Buffer<u32>, usize),
        scratch: &PrefixScanScratch,
        count: Count,
    ) -> Result<()> {
        let limit = count.limit("prefix_scan", scratch.capacity)?;
        holds("prefix_scan", "input", input.len(), limit)?;
        holds("prefix_scan", "output", output.len(), limit)?;
        holds("prefix_scan", "total", total.0.len(), total.1 + 2)?;
        if input.raw() == output.raw() {
            return Err(Error::Config("prefix_scan: input and output are the same buffer".to_owned()));
        }
        let block = kernel::BLOCK as usize;
        let binding = stage.device.limits().max_storage_buffer_binding_size as usize / size_of::<u32>();
        let segment = (binding / block).max(1) * block;
        let segments = |stage: &mut Stage, down: bool| -> Result<()> {
            for first in (0..limit).step_by(segment) {
                let length = segment.min(limit - first);
                let params = self.uniforms.get(
                    stage.device,
                    &PrefixScanParams {
                        limit: limit as u32,
                        count_word: count.word(),
                        first: first as u32,
                        length: length as u32,
                        first_block: (first / block) as u32,
                        only_counted: matches!(count, Count::Only(..)).into(),
                        ..PrefixScanParams::default()
                    },
                )?;
                let bindings = kernel::Downsweep {
                    params: params.as_uniform(),
                    counts: count.words(&params),
                    input: input.read_range(first, length).cast(),
                    sums: scratch.sums.as_write(),
                    output: output.write_range(first, length).cast(),
                };
                let blocks = Groups::Workgroups(length.div_ceil(block) as u64);
                if down {
                    stage.run(&self.downsweep, bindings, blocks);
                } else {
                    stage.run(&self.reduce, bindings, blocks);
                }
            }
            Ok(())
        };
        segments(stage, false)?;
        let params = self.uniforms.get(
            stage.device,
            &PrefixScanParams {
                blocks: limit.div_ceil(block) as u32,
                total_word: total.1 as u32,
                ..PrefixScanParams::default()
            },
        )?;
        let bindings =
            kernel::Spine { params: params.as_uniform(), sums: scratch.sums.as_write(), total: total.0.as_write() };
        stage.run(&self.spine, bindings, Groups::Workgroups(1));
        segments(stage, true)
    }
}
