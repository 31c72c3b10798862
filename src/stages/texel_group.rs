//! Grouping of (key, value) pairs by key, without sorting.
//!
//! - **Purpose.** Brings together what belongs to one texel: group `k` is `grouped[offsets[k]..offsets[k + 1]]`.
//! - **Reads** keys, and values (or takes the pairs' indices), up to the count. Pairs whose key is not below the number of
//!   groups are left out, so any such key is a sentinel for "none".
//! - **Writes** `offsets` (one more than groups), `grouped`, and `total[word]`, the number of grouped values
//!   (`total[word + 1]` is 0).
//! - **Guarantee.** Offsets, total, and the *set* of values in each group are exact and the same on every run. The order
//!   inside a group is not: it is the order in which the adapter ran the atomics. Use it where order does not matter
//!   (masks that are or-ed together), else [`RadixSort`](super::RadixSort).
//! - **Capacity.** The length of `grouped`. Values beyond it are counted in offsets and total, not written; which values
//!   of the group that straddles the capacity those are is not defined.
//! - **Cost.** Six dispatches; 24 bytes of traffic and one atomic a pair, 16 bytes a group.
//! - **Source.** Counting sort with the rank kept from the counting atomic; Pan et al. 2009 sort instead.

use super::{Count, PrefixScan, holds, prefix_scan};
use crate::gpu::bindings::Read;
use crate::gpu::kernels::texel_group as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "texel_group" => pub struct TexelGroupParams {
        /// Pairs.
        pub limit: u32,
        /// Where in `counts` the number of pairs stands.
        pub count_word: u32,
        /// Keys are below it.
        pub groups: u32,
        /// Values that `grouped` can hold.
        pub capacity: u32,
        /// 1: group indices, not values.
        pub indices: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
    }
}

/// Where a grouping goes.
#[derive(Clone, Copy, Debug)]
pub struct Grouping<'a> {
    /// Where each group begins, and where the last one ends: one more than groups.
    pub offsets: &'a Buffer<u32>,
    /// The values, group after group.
    pub grouped: &'a Buffer<u32>,
    /// Buffer, and first of the two words, for the number of values.
    pub total: (&'a Buffer<u32>, usize),
}

/// The pipelines of the grouping.
#[derive(Debug)]
pub struct TexelGroup {
    clear: kernel::ClearProgram,
    count: kernel::CountProgram,
    scatter: kernel::ScatterProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

/// Counters and ranks for up to `capacity` pairs in a fixed number of groups.
#[derive(Debug)]
pub struct TexelGroupScratch {
    capacity: usize,
    groups: usize,
    ranks: Buffer<u32>,
    key_counts: Buffer<u32>,
    scan: prefix_scan::PrefixScanScratch,
}

impl TexelGroup {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            clear: kernel::ClearProgram::new(device, ()),
            count: kernel::CountProgram::new(device, ()),
            scatter: kernel::ScatterProgram::new(device, ()),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Scratch memory for up to `capacity` pairs with keys below `groups`: 4 bytes a pair and 4 a group.
    ///
    /// # Errors
    /// As [`Buffer::storage`] and [`PrefixScan::scratch`].
    pub fn scratch(device: &wgpu::Device, capacity: usize, groups: usize) -> Result<TexelGroupScratch> {
        Ok(TexelGroupScratch {
            capacity,
            groups,
            ranks: Buffer::storage(device, "texel_group.ranks", capacity)?,
            // One count more, always 0: its offset is the end of the last group.
            key_counts: Buffer::storage(device, "texel_group.key_counts", groups + 1)?,
            scan: PrefixScan::scratch(device, groups + 1)?,
        })
    }

    /// Records the grouping of `values`, or of the pairs' indices if there are none, by `keys`.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too small.
    pub fn record(
        &self,
        stage: &mut Stage,
        keys: &Buffer<u32>,
        values: Option<&Buffer<u32>>,
        to: Grouping,
        scratch: &TexelGroupScratch,
        count: Count,
    ) -> Result<()> {
        let limit = count.limit("texel_group", scratch.capacity)?;
        holds("texel_group", "keys", keys.len(), limit)?;
        if let Some(values) = values {
            holds("texel_group", "values", values.len(), limit)?;
        }
        let params = self.uniforms.get(
            stage.device,
            &TexelGroupParams {
                limit: limit as u32,
                count_word: count.word(),
                groups: scratch.groups as u32,
                capacity: to.grouped.len() as u32,
                indices: values.is_none().into(),
                ..TexelGroupParams::default()
            },
        )?;
        let bindings = kernel::Group {
            params: params.as_uniform(),
            counts: count.words(&params),
            keys: keys.as_read().cast(),
            values: values.map_or_else(|| Read::of(params.raw()), |values| values.as_read().cast()),
            ranks: scratch.ranks.as_write().cast(),
            key_counts: scratch.key_counts.as_write(),
            offsets: to.offsets.as_read(),
            grouped: to.grouped.as_write(),
        };
        let counters = scratch.groups + 1;
        let cleared = (kernel::WORKGROUP * kernel::CLEARED) as usize;
        let quads = || Groups::Items(limit.div_ceil(kernel::QUAD as usize) as u64);
        let clear = kernel::Clear { cleared: scratch.key_counts.as_write().cast() };
        stage.run(&self.clear, clear, Groups::Workgroups(counters.div_ceil(cleared) as u64));
        stage.run(&self.count, bindings, quads());
        let counted = Count::Exactly(counters);
        self.scan.record(stage, &scratch.key_counts, to.offsets, to.total, &scratch.scan, counted)?;
        stage.run(&self.scatter, bindings, quads());
        Ok(())
    }
}
