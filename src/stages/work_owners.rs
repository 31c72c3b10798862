//! Owners of work items: which triangle, edge or facet every eighth item of a list belongs to.
//!
//! - **Purpose.** The items of a list (the 8 × 8 blocks of triangles, edges and facets) are known by the scan of their counts
//!   alone. A kernel that goes through them finds the owner of each by a search; with the table it searches among few.
//! - **Reads** the scan of the items of each owner, with its total.
//! - **Writes** a table and its length behind the scan, in the same buffer, as far as there is room ([`WorkOwners::words`]); what
//!   has no room is searched among all owners (`kernels/shared/raster/work_items.wgsl`), and all is where the length is 0.
//! - **Guarantee.** Exact: an owner is found with the table where it is without.
//! - **Cost.** One dispatch, a search for every eighth item.

use super::dispatch_args::{DispatchArgs, Requests};
use super::prefix_scan::{PrefixScan, PrefixScanScratch};
use super::{Count, holds};
use crate::gpu::kernels::work_owners as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

pub use kernel::STRIDE;

shared_struct! {
    /// Parameters of the kernel.
    "work_owners" => pub struct WorkOwnersParams {
        /// Owners.
        pub owners: u32,
        /// Places that the table has room for.
        pub room: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct WorkOwners {
    list: kernel::ListProgram,
    uniforms: Uniforms,
}

impl WorkOwners {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { list: kernel::ListProgram::new(device, ()), uniforms: Uniforms::default() }
    }

    /// Words of a buffer for the scan of `owners` counts and a table as long as it takes for owners of small extent on a grid of
    /// `cells` pixels or texels: four items an owner, or 16 for each block of the grid.
    pub fn words(owners: usize, cells: usize) -> usize {
        owners + kernel::HEAD as usize + (4 * owners + cells / 4) / STRIDE as usize + 2
    }

    /// Records the table behind the scan of `owners` counts.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `offsets` does not hold the scan.
    pub fn record(&self, stage: &mut Stage, offsets: &Buffer<u32>, owners: usize) -> Result<()> {
        let head = owners + kernel::HEAD as usize;
        holds("work_owners", "work_offsets", offsets.len(), head)?;
        let room = offsets.len() - head;
        let params = WorkOwnersParams { owners: owners as u32, room: room as u32, ..WorkOwnersParams::default() };
        let params = self.uniforms.get(stage.device, &params)?;
        let bindings = kernel::List { params: params.as_uniform(), work_offsets: offsets.as_write() };
        stage.run(&self.list, bindings, Groups::Items(room.max(1) as u64));
        Ok(())
    }
}

/// Brings a list of counts to a dispatch over all that they count: scan, table of owners, arguments.
#[derive(Debug)]
pub struct ListWork {
    scan: PrefixScan,
    owners: WorkOwners,
    fold: DispatchArgs,
}

impl ListWork {
    /// Builds the pipelines, but for those of the scan.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self { scan: scan.clone(), owners: WorkOwners::new(device), fold: DispatchArgs::new(device) }
    }

    /// Records the scan of the first `count` of `items` with the table behind it into `offsets`, and the arguments that `requests`
    /// ask for, whose count is the word behind the scan.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too short.
    pub fn record(
        &self,
        stage: &mut Stage,
        (items, count): (&Buffer<u32>, usize),
        offsets: &Buffer<u32>,
        scratch: &PrefixScanScratch,
        (requests, args): (&Requests, &Buffer<u32>),
    ) -> Result<()> {
        self.scan.record(stage, items, offsets, (offsets, count), scratch, Count::Exactly(count))?;
        self.owners.record(stage, offsets, count)?;
        self.fold.record(stage, offsets, requests, args)
    }
}
