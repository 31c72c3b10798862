//! Stream compaction: keeps the flagged items of a list, in order.
//!
//! - **Purpose.** Makes a dense list of what a flag or a mask bit marks.
//! - **Reads** flags ([`Flags::Words`]: one `u32` an item, kept if not 0; [`Flags::Bits`]: bit `i % 32` of word
//!   `i / 32`), and the values, if values rather than indices are to be kept.
//! - **Writes** the kept list; `total[word]`, the number of marked items, and `total[word + 1]`, which is 0.
//! - **Guarantee.** Exact, in the order of the input, the same bits on every run.
//! - **Capacity.** The length of the kept list. Marked items beyond it are counted, not written.
//! - **Cost.** Five dispatches; bits: about 0.6 bytes an item and 8 a kept one, words: 4 bytes more an item.
//! - **Source.** Blelloch, *Prefix sums and their applications*, 1990; one scanned count per 32 items.

use super::{Count, PrefixScan, holds, prefix_scan};
use crate::gpu::bindings::Read;
use crate::gpu::kernels::compact as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "compact" => pub struct CompactParams {
        /// Items.
        pub limit: u32,
        /// Where in `counts` the number of items stands.
        pub count_word: u32,
        /// Items that `kept` can hold.
        pub capacity: u32,
        /// 1: flags are bits.
        pub packed: u32,
        /// 1: keep indices, not values.
        pub indices: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
    }
}

/// Marks of the items to keep.
#[derive(Clone, Copy, Debug)]
pub enum Flags<'a> {
    /// One word an item; not 0 marks it.
    Words(&'a Buffer<u32>),
    /// One bit an item.
    Bits(&'a Buffer<u32>),
}

/// The pipelines of the compaction.
#[derive(Debug)]
pub struct Compact {
    count: kernel::CountProgram,
    emit: kernel::EmitProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Marks and offsets for lists of up to `capacity` items: 12 bytes per 32 items.
#[derive(Debug)]
pub struct CompactScratch {
    capacity: usize,
    marks: Buffer<u32>,
    mark_counts: Buffer<u32>,
    offsets: Buffer<u32>,
    scan: prefix_scan::PrefixScanScratch,
}

impl Compact {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            count: kernel::CountProgram::new(device, ()),
            emit: kernel::EmitProgram::new(device, ()),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Scratch memory for lists of up to `capacity` items.
    ///
    /// # Errors
    /// As [`PrefixScan::scratch`].
    pub fn scratch(device: &wgpu::Device, capacity: usize) -> Result<CompactScratch> {
        let marks = capacity.div_ceil(kernel::ITEMS as usize);
        Ok(CompactScratch {
            capacity,
            marks: Buffer::storage(device, "compact.marks", marks)?,
            mark_counts: Buffer::storage(device, "compact.mark_counts", marks)?,
            offsets: Buffer::storage(device, "compact.offsets", marks)?,
            scan: PrefixScan::scratch(device, marks)?,
        })
    }

    /// Records the compaction of the marked `values`, or of the marked indices if there are none, into `kept`, and the
    /// number of marked items into `total` (buffer and first of two words).
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too small.
    #[expect(clippy::too_many_arguments, reason = "inputs, outputs, scratch, count: the order of every stage")]
    pub fn record(
        &self,
        stage: &mut Stage,
        flags: Flags,
        values: Option<&Buffer<u32>>,
        kept: &Buffer<u32>,
        total: (&Buffer<u32>, usize),
        scratch: &CompactScratch,
        count: Count,
    ) -> Result<()> {
        let limit = count.limit("compact", scratch.capacity)?;
        let marks = limit.div_ceil(kernel::ITEMS as usize);
        let (flags, packed) = match flags {
            Flags::Words(flags) => (flags, false),
            Flags::Bits(flags) => (flags, true),
        };
        holds("compact", "flags", flags.len(), if packed { marks } else { limit })?;
        if let Some(values) = values {
            holds("compact", "values", values.len(), limit)?;
        }
        let params = self.uniforms.get(
            stage.device,
            &CompactParams {
                limit: limit as u32,
                count_word: count.word(),
                capacity: kept.len() as u32,
                packed: packed.into(),
                indices: values.is_none().into(),
                ..CompactParams::default()
            },
        )?;
        let bindings = kernel::Lists {
            params: params.as_uniform(),
            counts: count.words(&params),
            flags: flags.as_read(),
            marks: scratch.marks.as_write(),
            mark_counts: scratch.mark_counts.as_write(),
            offsets: scratch.offsets.as_read(),
            kept_from: values.map_or_else(|| Read::of(params.raw()), Buffer::as_read),
            kept: kept.as_write(),
        };
        let groups = || Groups::Items(marks as u64);
        stage.run(&self.count, bindings, groups());
        let (counts, offsets) = (&scratch.mark_counts, &scratch.offsets);
        self.scan.record(stage, counts, offsets, total, &scratch.scan, Count::Exactly(marks))?;
        stage.run(&self.emit, bindings, groups());
        Ok(())
    }
}
