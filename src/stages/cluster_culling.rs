//! Clusters of triangles, edges and vertices that a view may hold something of.
//!
//! - **Purpose.** Leaves out, 64 elements at a time, what lies outside a view, before any of it is set up.
//! - **Reads** a box a cluster ([`cluster_boxes`]: elements with numbers in a row, so what lies near each other should be numbered so), and
//!   which blocks of texels are [requested](super::requested_blocks).
//! - **Writes** a [`ClusterList`]: the clusters that are kept, in order, and arguments of dispatches over them.
//! - **Guarantee.** A cluster is kept if one of its elements has work in the view: a triangle with pixels or texels, an edge with texels,
//!   a vertex of a triangle or an edge of a cluster that is kept. The same bits on every run.
//! - **Cost.** Six dispatches; half a byte an element.
//! - **Source.** Cluster culling: Wihlidal, *Optimizing the Graphics Pipeline with Compute*, GDC 2016; Haar, Aaltonen, *GPU-Driven Rendering
//!   Pipelines*, SIGGRAPH 2015.

mod boxes;

pub use boxes::cluster_boxes;

use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::prefix_scan::{PrefixScan, PrefixScanScratch};
use super::{Count, holds};
use crate::frame::Frame;
use crate::gpu::bindings::Read;
use crate::gpu::kernels::cluster_culling as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

/// Elements of a cluster.
pub const CLUSTER: usize = kernel::CLUSTER_SIZE as usize;

shared_struct! {
    /// Parameters of the kernel.
    "cluster_culling" => pub struct ClusterParams {
        /// Clusters of triangles, edges and vertices.
        pub clusters: [u32; 4],
        /// Where the marks of each begin, and where all end.
        pub first_words: [u32; 4],
        /// Elements of each.
        pub elements: [u32; 4],
    }
}

shared_struct! {
    /// Box around the elements of a cluster, world units.
    "shared/raster/cluster_box" => pub struct ClusterBox {
        /// Lowest corner; the fourth number is not read.
        pub low: [f32; 4],
        /// Highest corner.
        pub high: [f32; 4],
    }
}

impl ClusterParams {
    /// Says, where a list of clusters would begin, that there is none.
    pub(crate) const ALL: Self = Self { clusters: [kernel::ALL_CLUSTERS; 4], first_words: [0; 4], elements: [0; 4] };
}

/// A kind of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClusterPart {
    /// Triangles.
    Triangles = kernel::PART_TRIANGLES as isize,
    /// Edges.
    Edges = kernel::PART_EDGES as isize,
    /// Vertices.
    Vertices = kernel::PART_VERTICES as isize,
}

/// Clusters of one mesh on the GPU, and how many elements of each kind it has. A clone is the same memory.
#[derive(Clone, Debug)]
pub struct Clusters {
    /// Their boxes.
    pub boxes: Buffer<ClusterBox>,
    /// Triangles, edges and vertices; of casters that move no vertices, which are all brought into a view.
    pub elements: [usize; 3],
}

/// The clusters that one view keeps.
#[derive(Debug)]
pub struct ClusterList {
    params: ClusterParams,
    marks: Buffer<u32>,
    mark_counts: Buffer<u32>,
    offsets: Buffer<u32>,
    /// A head, then the clusters of each part.
    pub kept: Buffer<u32>,
    scan: PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl ClusterList {
    /// Memory for the clusters of so many triangles, edges and vertices; a part with no elements is not looked at.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, elements: [usize; 3]) -> Result<Self> {
        let clusters = elements.map(|n| n.div_ceil(CLUSTER));
        let mut first_words = [0; 4];
        for (part, &count) in clusters.iter().enumerate() {
            // Whole workgroups, each of one part.
            first_words[part + 1] =
                first_words[part] + count.div_ceil(kernel::WORKGROUP as usize) * kernel::WORDS as usize;
        }
        let [.., words] = first_words;
        let request = |part: usize| ArgsRequest::new(part, 1, ArgsRequest::MAX_LIMIT, 3 * part);
        let requests = [request(0)?, request(1)?, request(2)?];
        let all: usize = clusters.iter().sum();
        let of_parts = |[a, b, c]: [usize; 3]| [a as u32, b as u32, c as u32, 0];
        Ok(Self {
            params: ClusterParams {
                clusters: of_parts(clusters),
                first_words: first_words.map(|word| word as u32),
                elements: of_parts(elements),
            },
            marks: Buffer::storage(device, "cluster_culling.marks", words)?,
            mark_counts: Buffer::storage(device, "cluster_culling.mark_counts", words)?,
            offsets: Buffer::storage(device, "cluster_culling.offsets", words + 2)?,
            kept: Buffer::storage(device, "cluster_culling.kept", kernel::KEPT_HEAD as usize + all)?,
            scan: PrefixScan::scratch(device, words)?,
            requests: DispatchArgs::requests(device, queue, &requests)?,
            args: Buffer::indirect(device, "cluster_culling.args", 9)?,
        })
    }

    /// Words of marks.
    fn words(&self) -> usize {
        self.params.first_words[3] as usize
    }

    fn workgroups(&self) -> Groups<'static> {
        Groups::Workgroups(self.words() as u64 / u64::from(kernel::WORDS))
    }

    /// The elements of one kind that it keeps, of `count`: all of a kind of which it has no clusters.
    pub fn elements(&self, part: ClusterPart, count: usize) -> Elements<'_> {
        let has_some = self.params.clusters[part as usize] > 0;
        Elements { count, of: has_some.then_some((self, part)) }
    }
}

/// Elements that a stage takes.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'a> {
    /// How many there are.
    pub count: usize,
    of: Option<(&'a ClusterList, ClusterPart)>,
}

impl From<usize> for Elements<'_> {
    /// All.
    fn from(count: usize) -> Self {
        Self { count, of: None }
    }
}

impl<'a> Elements<'a> {
    /// Workgroups of [`CLUSTER`] invocations, one a cluster.
    pub fn groups(&self) -> Groups<'a> {
        match self.of {
            None => Groups::Items(self.count as u64),
            Some((list, part)) => Groups::Indirect(list.args.raw(), 3 * part as u64),
        }
    }

    /// How many are kept, for a scan of what is written of them.
    pub(crate) fn kept_count(&self) -> Count<'a> {
        match self.of {
            None => Count::Exactly(self.count),
            Some((list, part)) => Count::Only(&list.kept, 2 * kernel::PARTS as usize + part as usize),
        }
    }

    /// Which kind they are of, if they are those of a list.
    pub(crate) fn part(&self) -> Option<ClusterPart> {
        self.of.map(|(_, part)| part)
    }

    /// The list as kernels read it; `all` holds [`ClusterParams::ALL`].
    pub(crate) fn list<'b>(&self, all: &'b Buffer<ClusterParams>) -> Read<'b, u32>
    where
        'a: 'b,
    {
        self.of.map_or_else(|| all.as_read().cast(), |(list, _)| list.kept.as_read())
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct ClusterCulling {
    camera: kernel::TestCameraProgram,
    light: kernel::TestLightProgram,
    emit: kernel::EmitProgram,
    scan: PrefixScan,
    fold: DispatchArgs,
    uniforms: Uniforms,
}

impl ClusterCulling {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            camera: kernel::TestCameraProgram::new(device, ()),
            light: kernel::TestLightProgram::new(device, ()),
            emit: kernel::EmitProgram::new(device, ()),
            scan: scan.clone(),
            fold: DispatchArgs::new(device),
            uniforms: Uniforms::default(),
        }
    }

    /// Records which clusters the camera's view keeps, of the list's parts; adds their triangles to those of `status`.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `boxes` has too few, [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        boxes: &Buffer<ClusterBox>,
        list: &ClusterList,
        status: &Buffer<u32>,
    ) -> Result<()> {
        let params = self.params(stage, boxes, list)?;
        let bindings = kernel::TestCamera {
            frame: frame.as_uniform(),
            params: params.as_uniform(),
            boxes: boxes.as_read(),
            marks: list.marks.as_write(),
            mark_counts: list.mark_counts.as_write(),
        };
        stage.run(&self.camera, bindings, list.workgroups());
        self.record_list(stage, &params, list, status)
    }

    /// Records which clusters the light's view keeps, of those that may touch blocks of texels that are `requested`; adds their triangles to those of
    /// `status`.
    ///
    /// # Errors
    /// As [`ClusterCulling::record_camera`].
    pub fn record_light(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        boxes: &Buffer<ClusterBox>,
        requested: &Buffer<u32>,
        list: &ClusterList,
        status: &Buffer<u32>,
    ) -> Result<()> {
        let params = self.params(stage, boxes, list)?;
        let bindings = kernel::TestLight {
            frame: frame.as_uniform(),
            params: params.as_uniform(),
            boxes: boxes.as_read(),
            requested: requested.as_read(),
            marks: list.marks.as_write(),
            mark_counts: list.mark_counts.as_write(),
        };
        stage.run(&self.light, bindings, list.workgroups());
        self.record_list(stage, &params, list, status)
    }

    fn params(
        &self,
        stage: &mut Stage,
        boxes: &Buffer<ClusterBox>,
        list: &ClusterList,
    ) -> Result<Buffer<ClusterParams>> {
        let needed = list.params.clusters.iter().sum::<u32>() as usize;
        holds("cluster_culling", "boxes", boxes.len(), needed)?;
        self.uniforms.get(stage.device, &list.params)
    }

    fn record_list(
        &self,
        stage: &mut Stage,
        params: &Buffer<ClusterParams>,
        list: &ClusterList,
        status: &Buffer<u32>,
    ) -> Result<()> {
        let (counts, offsets, words) = (&list.mark_counts, &list.offsets, list.words());
        self.scan.record(stage, counts, offsets, (offsets, words), &list.scan, Count::Exactly(words))?;
        let bindings = kernel::Emit {
            params: params.as_uniform(),
            marks: list.marks.as_write(),
            offsets: offsets.as_read(),
            kept_clusters: list.kept.as_write(),
            status: status.as_write(),
        };
        stage.run(&self.emit, bindings, Groups::Items(words.max(kernel::PARTS as usize) as u64));
        self.fold.record(stage, &list.kept, &list.requests, &list.args)
    }
}
