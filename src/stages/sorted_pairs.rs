//! Pairs brought together by texel with a radix sort, as the paper does (Pan 2009, section 3.3): the variant beside
//! counting, scanning and scattering, which it can be compared with.
//!
//! - **Reads** the pairs that `append` of [`pixel_texel_pairs`](super::pixel_texel_pairs) or
//!   [`triangle_texel_pairs`](super::triangle_texel_pairs) left in the scratch memory.
//! - **Writes** the items in the order of their texels, and `texel_counts`, which must be 0, the pairs of each texel.
//! - **Guarantee.** Exact. The order inside a texel is that of the list, which is the order in which the adapter ran the
//!   atomics: what is made of it must not depend on it.
//! - **Capacity.** That of the scratch; what was appended beyond it was not written.
//! - **Cost.** A [`RadixSort`] over the bits of the texels' numbers and one or two dispatches: over 512 × 512 texels 72
//!   bytes of traffic a pair for the sort and 12 or 24 more. 24 to 32 bytes of memory a pair.

use super::radix_sort::{self, Pairs};
use super::{Count, PrefixScan, RadixSort, holds};
use crate::gpu::kernels::sorted_pairs as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "sorted_pairs" => pub struct SortedPairsParams {
        /// Pairs.
        pub limit: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
    }
}

/// Where the sorted pairs go.
#[derive(Clone, Copy, Debug)]
pub enum Sorted<'a> {
    /// The items alone.
    Items(&'a Buffer<u32>),
    /// Item and texel.
    Pairs(&'a Buffer<[u32; 2]>),
}

/// The pipelines.
#[derive(Debug)]
pub struct SortedPairs {
    sort: RadixSort,
    bounds: kernel::BoundsProgram,
    join: kernel::JoinProgram,
    uniforms: Uniforms,
}

/// Pairs as they come, and memory to sort them.
#[derive(Debug)]
pub struct SortedPairsScratch {
    capacity: usize,
    /// Pairs appended, and not 0 if there are more than 2^32. Must be 0 before pairs are appended.
    pub appended: Buffer<u32>,
    /// Their texels.
    pub keys: Buffer<u32>,
    /// Their items.
    pub values: Buffer<u32>,
    sorted_keys: Buffer<u32>,
    sorted_values: Option<Buffer<u32>>,
    sort: radix_sort::RadixSortScratch,
}

impl SortedPairs {
    /// Bytes of memory a pair: items alone, and item and texel. The lists that they go to are not counted.
    pub const BYTES: [u64; 2] = [21, 25];

    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            sort: RadixSort::new(device, scan),
            bounds: kernel::BoundsProgram::new(device, ()),
            join: kernel::JoinProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Memory for up to `capacity` pairs, to be sorted into items alone or, `joined`, item and texel.
    ///
    /// # Errors
    /// As [`Buffer::storage`] and [`RadixSort::scratch`].
    pub fn scratch(device: &wgpu::Device, capacity: usize, joined: bool) -> Result<SortedPairsScratch> {
        let list = |label: &str| Buffer::storage(device, label, capacity);
        Ok(SortedPairsScratch {
            capacity,
            appended: Buffer::storage(device, "sorted_pairs.appended", 2)?,
            keys: list("sorted_pairs.keys")?,
            values: list("sorted_pairs.values")?,
            sorted_keys: list("sorted_pairs.sorted_keys")?,
            sorted_values: joined.then(|| list("sorted_pairs.sorted_values")).transpose()?,
            sort: RadixSort::scratch(device, capacity)?,
        })
    }

    /// Records the sort of what was appended to `scratch` into `to`, and the counts of each texel.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a list is too small, or the scratch memory was made for the other kind of list.
    pub fn record(
        &self,
        stage: &mut Stage,
        scratch: &SortedPairsScratch,
        to: Sorted,
        texel_counts: &Buffer<u32>,
    ) -> Result<()> {
        let limit = scratch.capacity;
        let values = match (to, &scratch.sorted_values) {
            (Sorted::Items(items), None) => items,
            (Sorted::Pairs(pairs), Some(values)) => {
                holds("sorted_pairs", "pairs", pairs.len(), limit)?;
                values
            }
            _ => return Err(crate::Error::Config("sorted_pairs: memory for the other kind of list".to_owned())),
        };
        let count = Count::At(&scratch.appended, 0);
        let key_bits = usize::BITS - texel_counts.len().saturating_sub(1).leading_zeros();
        let appended = Pairs { keys: &scratch.keys, values: &scratch.values };
        let sorted = Pairs { keys: &scratch.sorted_keys, values };
        self.sort.record(stage, appended, sorted, &scratch.sort, key_bits, count)?;
        let params = self
            .uniforms
            .get(stage.device, &SortedPairsParams { limit: limit as u32, ..SortedPairsParams::default() })?;
        let (params, counts, keys) = (params.as_uniform(), scratch.appended.as_read(), scratch.sorted_keys.as_read());
        let bounds = kernel::Bounds { params, counts, keys, texel_counts: texel_counts.as_write() };
        stage.run(&self.bounds, bounds, Groups::Items(limit as u64));
        if let Sorted::Pairs(pairs) = to {
            let join = kernel::Join { params, counts, keys, values: values.as_read(), pairs: pairs.as_write() };
            stage.run(&self.join, join, Groups::Items(limit as u64));
        }
        Ok(())
    }
}
