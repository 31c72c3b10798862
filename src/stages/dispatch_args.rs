//! Arguments of indirect dispatches, made from counts on the GPU.
//!
//! - **Purpose.** Runs a kernel over a list whose length only the GPU knows.
//! - **Reads** any words of a buffer of counts, and one [`ArgsRequest`] a dispatch.
//! - **Writes** three words a request ([`Groups::Indirect`] reads them).
//! - **Guarantee.** `min(count, limit)` items, but for the first `skip`, are covered by as few workgroups as the fold over two
//!   dimensions allows; a kernel finds its flat index with `kernels/shared/frame/dispatch.wgsl` and must check it against the count.
//! - **Capacity.** Lists of up to 2^31 items: no flat index wraps.
//! - **Cost.** One dispatch, 32 bytes in and 12 out a request.
//! - **Source.** wgpu replaces an indirect dispatch of more than 65,535 groups along a dimension by none, silently; hence
//!   the fold.

use super::holds;
use crate::gpu::kernels::dispatch_args as kernel;
use crate::gpu::recorder::MAX_GROUPS;
use crate::gpu::{Buffer, Groups, Stage};
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// Items that one dispatch is to cover.
    "dispatch_args" => pub struct ArgsRequest {
        /// Index into the counts.
        pub count_word: u32,
        /// Items that one workgroup handles.
        pub per_group: u32,
        /// The list's capacity: counts beyond it are not processed.
        pub limit: u32,
        /// Where the three words go.
        pub args_word: u32,
        /// Items at the beginning that another dispatch takes.
        pub skip: u32,
        /// Not read.
        pub pad_1: u32,
        /// Not read.
        pub pad_2: u32,
        /// Not read.
        pub pad_3: u32,
    }
}

impl ArgsRequest {
    /// Most items of a list: their flat indices, spare ones included, fit in 32 bits.
    pub const MAX_LIMIT: usize = 1 << 31;

    /// Groups of `per_group` items for the list of at most `limit` whose length is word `count_word`, as the arguments at
    /// word `args_word`.
    ///
    /// # Errors
    /// [`Error::Config`] if `per_group` is 0 or `limit` is above [`ArgsRequest::MAX_LIMIT`].
    pub fn new(count_word: usize, per_group: u32, limit: usize, args_word: usize) -> Result<Self> {
        if per_group == 0 || limit > Self::MAX_LIMIT {
            return Err(Error::Config(format!("dispatch_args: {limit} items in groups of {per_group}")));
        }
        let (count_word, limit, args_word) = (count_word as u32, limit as u32, args_word as u32);
        Ok(Self { count_word, per_group, limit, args_word, ..Self::default() })
    }

    /// The part of the list after the first `skip` items.
    #[must_use]
    pub fn after(self, skip: usize) -> Self {
        Self { skip: u32::try_from(skip).unwrap_or(u32::MAX), ..self }
    }
}

/// Requests, and the check that they fit their buffers.
#[derive(Debug)]
pub struct Requests {
    list: Buffer<ArgsRequest>,
    counts: usize,
    args: usize,
}

/// The pipeline that folds counts into arguments.
#[derive(Debug)]
pub struct DispatchArgs {
    fold: kernel::FoldProgram,
}

impl DispatchArgs {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let most = device.limits().max_compute_workgroups_per_dimension.min(MAX_GROUPS);
        Self { fold: kernel::FoldProgram::new(device, kernel::Constants { max_groups: most }) }
    }

    /// The requests as the GPU reads them, uploaded once.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn requests(device: &wgpu::Device, queue: &wgpu::Queue, requests: &[ArgsRequest]) -> Result<Requests> {
        // A buffer is padded with nothing that could be taken for a request: each is 32 bytes.
        Ok(Requests {
            list: Buffer::from_slice(device, queue, "dispatch_args.requests", requests)?,
            counts: requests.iter().map(|r| r.count_word as usize + 1).max().unwrap_or(0),
            args: requests.iter().map(|r| r.args_word as usize + 3).max().unwrap_or(0),
        })
    }

    /// Records the arguments of all `requests`. `args` is an indirect buffer ([`Buffer::indirect`]) of its own: WebGPU
    /// forbids reading arguments from a buffer that the same dispatch binds for writing.
    ///
    /// # Errors
    /// [`Error::Config`] if a request lies outside `counts` or `args`.
    pub fn record(
        &self,
        stage: &mut Stage,
        counts: &Buffer<u32>,
        requests: &Requests,
        args: &Buffer<u32>,
    ) -> Result<()> {
        holds("dispatch_args", "counts", counts.len(), requests.counts)?;
        holds("dispatch_args", "args", args.len(), requests.args)?;
        let bindings =
            kernel::Fold { counts: counts.as_read(), requests: requests.list.as_read(), args: args.as_write() };
        stage.run(&self.fold, bindings, Groups::Items(requests.list.len() as u64));
        Ok(())
    }
}
