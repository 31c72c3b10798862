//! Owners of work items: which triangle, edge or facet every eighth item of a list belongs to.
//!
//! - **Purpose.** The items of a list (the 8 × 8 blocks of triangles, edges and facets) are known by the scan of their counts
//!   alone. A kernel that goes through them finds the owner of each by a search; with the table it searches among few.
//! - **Reads** the scan of the items of each owner, with its total.
//! - **Writes** a table and its length behind the scan, in the same buffer, as far as there is room ([`WorkOwners::words`]); what
//!   has no room is searched among all owners (`kernels/shared/raster/work_items.wgsl`), and all is where the length is 0. Of owners
//!   [some clusters](super::cluster_culling) of which are kept, these are listed behind the table.
//! - **Guarantee.** Exact: an owner is found with the table where it is without.
//! - **Cost.** One dispatch, a search for every eighth item; one more where clusters are left out.

use super::cluster_culling::{CLUSTER, ClusterParams, Elements};
use super::dispatch_args::{DispatchArgs, Requests};
use super::holds;
use super::prefix_scan::{PrefixScan, PrefixScanScratch};
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
        /// Where the list of clusters begins; 0: there is none.
        pub clusters: u32,
        /// Which kind of elements they are of.
        pub part: u32,
    }
}

/// Invocations that fill a table: few enough to cost little where a table is mostly empty, as its length is known to the GPU alone.
const MOST_INVOCATIONS: usize = 1 << 16;

/// The pipelines.
#[derive(Debug)]
pub struct WorkOwners {
    list: kernel::ListProgram,
    clusters: kernel::ListClustersProgram,
    uniforms: Uniforms,
}

impl WorkOwners {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            list: kernel::ListProgram::new(device, ()),
            clusters: kernel::ListClustersProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Words of a buffer for the scan of `owners` counts and a table as long as it takes for owners of small extent on a grid of
    /// `cells` pixels or texels: four items an owner, or 16 for each block of the grid.
    pub fn words(owners: usize, cells: usize) -> usize {
        owners + kernel::HEAD as usize + (4 * owners + cells / 4) / STRIDE as usize + 2
    }

    /// The same of owners of which clusters may be left out: with room for the list of those that are kept.
    pub fn words_of_clusters(owners: usize, cells: usize) -> usize {
        Self::words(owners, cells) + owners.div_ceil(CLUSTER)
    }

    /// Records the table behind the scan of the counts of `owners`, and where these are of a list of clusters, that at the end.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `offsets` does not hold the scan and the list.
    pub fn record<'a>(&self, stage: &mut Stage, offsets: &Buffer<u32>, owners: impl Into<Elements<'a>>) -> Result<()> {
        let of: Elements = owners.into();
        let owners = of.count;
        let listed = of.part().map_or(0, |_| owners.div_ceil(CLUSTER));
        let head = owners + kernel::HEAD as usize;
        holds("work_owners", "work_offsets", offsets.len(), head + listed)?;
        let room = offsets.len() - head - listed;
        let params = WorkOwnersParams {
            owners: owners as u32,
            room: room as u32,
            clusters: of.part().map_or(0, |_| (head + room) as u32),
            part: of.part().map_or(0, |part| part as u32),
        };
        let params = self.uniforms.get(stage.device, &params)?;
        let all = self.uniforms.get(stage.device, &ClusterParams::ALL)?;
        let bindings = kernel::Lists {
            params: params.as_uniform(),
            work_offsets: offsets.as_write(),
            kept_clusters: of.list(&all),
        };
        stage.run(&self.list, bindings, Groups::Items(room.clamp(1, MOST_INVOCATIONS) as u64));
        if of.part().is_some() {
            stage.run(&self.clusters, bindings, Groups::Items(listed as u64));
        }
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

    /// Records the scan of `items`, those of the elements that `of` says, with the table behind it into `offsets`, and the arguments that
    /// `requests` ask for, whose count is the word behind the scan.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too short.
    pub fn record<'a>(
        &self,
        stage: &mut Stage,
        (items, of): (&Buffer<u32>, impl Into<Elements<'a>>),
        offsets: &Buffer<u32>,
        scratch: &PrefixScanScratch,
        (requests, args): (&Requests, &Buffer<u32>),
    ) -> Result<()> {
        let of = of.into();
        self.scan.record(stage, items, offsets, (offsets, of.count), scratch, of.kept_count())?;
        self.owners.record(stage, offsets, of)?;
        self.fold.record(stage, offsets, requests, args)
    }
}
