//! Beginning of every method: vertices in both views, where each triangle lies in them, and the nearest triangle at
//! every pixel centre.

use super::prepared::CasterBuffers;
use super::{Settings, TexelQuery};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::{camera_visibility, light_layers};
use crate::gpu::{Buffer, Recorder, Stage};
use crate::stages::camera_visibility::{Blocks, CameraVisibility, Centres};
use crate::stages::cluster_culling::{ClusterBox, ClusterCulling, ClusterList, ClusterPart, Elements};
use crate::stages::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use crate::stages::requested_blocks::RequestedBlocks;
use crate::stages::seen_depths::SeenDepths;
use crate::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use crate::stages::vertex_project::VertexProject;
use crate::stages::work_owners::{ListWork, WorkOwners};
use crate::stages::{PrefixScan, PrimaryHits, prefix_scan};

/// The pipelines.
#[derive(Debug)]
pub struct GeometryPipelines {
    project: VertexProject,
    setup: TriangleSetup,
    visibility: CameraVisibility,
    work: ListWork,
    depths: Option<SeenDepths>,
    culling: ClusterCulling,
}

impl GeometryPipelines {
    /// Builds the pipelines; `alpha`: triangles may be alpha-tested, `depths`: frames tell between which depths pixels see triangles.
    pub fn new(device: &wgpu::Device, alpha: bool, depths: bool) -> Self {
        let scan = PrefixScan::new(device);
        Self {
            depths: depths.then(|| SeenDepths::new(device)),
            culling: ClusterCulling::new(device, &scan),
            project: VertexProject::new(device),
            setup: TriangleSetup::new(device),
            visibility: CameraVisibility::specialised(device, alpha),
            work: ListWork::new(device, &scan),
        }
    }

    /// Whether frames tell between which depths pixels see triangles.
    pub fn tells_depths(&self) -> bool {
        self.depths.is_some()
    }
}

/// The memory for one mesh and image.
#[derive(Debug)]
pub struct Geometry {
    /// Vertices relative to the eye, scaled.
    pub points: Buffer<[f32; 4]>,
    /// Vertices in the light view.
    pub map_points: Buffer<[f32; 4]>,
    /// Blocks of the light's map in which casters are set up; clear: all.
    pub requested: Buffer<u32>,
    /// Facing, rectangles and block counts of each triangle.
    pub facts: TriangleFacts,
    /// The triangle that every pixel centre sees, and how sure that is.
    pub centres: Centres,
    /// Complement of the triangle at every pixel centre; 0 where there is none.
    pub id_keys: Buffer<u32>,
    camera_offsets: Buffer<u32>,
    light_offsets: Buffer<u32>,
    scan_scratch: prefix_scan::PrefixScanScratch,
    requests: [Requests; 2],
    args: Buffer<u32>,
    culling: Option<Culling>,
}

/// Boxes of clusters, and which of them camera and light keep.
#[derive(Debug)]
struct Culling {
    boxes: Buffer<ClusterBox>,
    camera: Option<ClusterList>,
    light: Option<ClusterList>,
}

/// Views in which casters are set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetupOf {
    /// Camera and light.
    Both,
    /// The camera's.
    Camera,
    /// The light's.
    Light,
}

/// Views out of which clusters are left where there are enough casters. A query that brings casters into maps of its own asks each one for its place in
/// the light's view.
pub fn culled_views(casters: &CasterBuffers, settings: &Settings, query: TexelQuery) -> Option<SetupOf> {
    let asks_all = matches!(query, TexelQuery::Pages | TexelQuery::Axes);
    let views = if asks_all { SetupOf::Camera } else { SetupOf::Both };
    (casters.triangles.len() >= settings.least_culled).then_some(views)
}

/// First words of the indirect arguments.
const CAMERA_ARGS: usize = 0;
const LIGHT_ARGS: usize = 3;

impl Geometry {
    /// Makes the memory for an image of `pixels` pixels and a map of `map` texels a side, with room behind the casters' points for those of so many
    /// `receivers`, triangles of their own. Clusters of the casters are left out of the views that `culls` names, where there are clusters: what is
    /// made of light-view triangles is then of those that [Geometry::of_light] tells.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (casters, receivers): (&CasterBuffers, usize),
        pixels: usize,
        map: usize,
        culls: Option<SetupOf>,
    ) -> Result<Self> {
        let (vertices, triangles) = (casters.positions.len(), casters.triangles.len());
        let request = |group: u32, at: usize| {
            DispatchArgs::requests(device, queue, &[ArgsRequest::new(triangles, group, ArgsRequest::MAX_LIMIT, at)?])
        };
        let words = |cells: usize| WorkOwners::words_of_clusters(triangles, cells);
        let offsets = |label: &str, cells: usize| Buffer::storage(device, label, words(cells));
        let culling = casters.clusters.as_ref().zip(culls).map(|(clusters, culls)| -> Result<Culling> {
            let [triangles, ..] = clusters.elements;
            let list = |of, elements| {
                let culled = culls == SetupOf::Both || culls == of;
                culled.then(|| ClusterList::new(device, queue, elements)).transpose()
            };
            Ok(Culling {
                boxes: clusters.boxes.clone(),
                camera: list(SetupOf::Camera, [triangles, 0, 0])?,
                light: list(SetupOf::Light, clusters.elements)?,
            })
        });
        Ok(Self {
            culling: culling.transpose()?,
            points: Buffer::storage_with_room(device, "vertex_project.points", vertices, 3 * receivers)?,
            map_points: Buffer::storage(device, "vertex_project.map_points", vertices)?,
            requested: RequestedBlocks::memory(device, map)?,
            facts: TriangleFacts::new(device, triangles)?,
            centres: Centres::new(device, queue, pixels)?,
            id_keys: Buffer::storage(device, "camera_visibility.id_keys", pixels)?,
            camera_offsets: offsets("triangle_setup.camera_offsets", pixels)?,
            light_offsets: offsets("triangle_setup.light_offsets", map * map)?,
            scan_scratch: PrefixScan::scratch(device, triangles)?,
            requests: [
                request(camera_visibility::WORKGROUP, CAMERA_ARGS)?,
                request(light_layers::WORKGROUP, LIGHT_ARGS)?,
            ],
            args: Buffer::indirect(device, "dispatch_args.args", 6)?,
        })
    }

    /// Records the stage `triangle_setup`: vertices, rectangles, and the lists of their blocks, of both views or of one. That of the light follows
    /// that of the camera, and is of the blocks that are [requested](Geometry::requested).
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_setup(
        &self,
        rec: &mut Recorder,
        with: &GeometryPipelines,
        frame: &Buffer<Frame>,
        (casters, status): (&CasterBuffers, &Buffer<u32>),
        of: SetupOf,
    ) -> Result<()> {
        if let Some(Culling { boxes, camera, light }) = &self.culling {
            let stage = &mut rec.stage("cluster_culling");
            if let Some(list) = camera.as_ref().filter(|_| of != SetupOf::Light) {
                with.culling.record_camera(stage, frame, boxes, list, status)?;
            }
            if let Some(list) = light.as_ref().filter(|_| of != SetupOf::Camera) {
                with.culling.record_light(stage, frame, boxes, &self.requested, list, status)?;
            }
        }
        let stage = &mut rec.stage("triangle_setup");
        let (positions, triangles) = (&casters.positions, &casters.triangles);
        let (count, points, facts) = (triangles.len(), &self.points, &self.facts);
        let list =
            |stage: &mut Stage, of: Elements, items: &Buffer<u32>, offsets: &Buffer<u32>, requests: &Requests| {
                with.work.record(stage, (items, of), offsets, &self.scan_scratch, (requests, &self.args))
            };
        let [camera, light] = &self.requests;
        if of != SetupOf::Light {
            with.project.record_place(stage, frame, positions, points);
            let seen = self.culling.as_ref().and_then(|culling| culling.camera.as_ref());
            let seen = seen.map_or(count.into(), |list| list.elements(ClusterPart::Triangles, count));
            with.setup.record_camera(stage, frame, triangles, points, facts, seen)?;
            list(stage, seen, &facts.camera_items, &self.camera_offsets, camera)?;
        }
        if of != SetupOf::Camera {
            let map_points = &self.map_points;
            let vertices = self.of_light(ClusterPart::Vertices, positions.len());
            with.project.record_project(stage, frame, points, map_points, vertices)?;
            let lit = self.of_light(ClusterPart::Triangles, count);
            with.setup.record_light(stage, frame, triangles, points, map_points, &self.requested, facts, lit)?;
            list(stage, lit, &facts.light_items, &self.light_offsets, light)?;
        }
        Ok(())
    }

    /// The triangles, edges or vertices, `count` in all, of which [`Geometry::record_setup`] makes something in the light's view.
    pub fn of_light(&self, part: ClusterPart, count: usize) -> Elements<'_> {
        let light = self.culling.as_ref().and_then(|culling| culling.light.as_ref());
        light.map_or(count.into(), |list| list.elements(part, count))
    }

    /// Records the stage `camera_visibility`, after [`Geometry::record_setup`].
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera(
        &self,
        rec: &mut Recorder,
        with: &GeometryPipelines,
        frame: &Buffer<Frame>,
        casters: &CasterBuffers,
    ) -> Result<()> {
        rec.clear(self.centres.keys.raw());
        rec.clear(self.id_keys.raw());
        rec.clear_words(self.centres.doubts.raw(), 0, Centres::COUNTS as u64);
        let stage = &mut rec.stage("camera_visibility");
        let positions = &casters.positions;
        with.visibility.record(stage, frame, self.in_camera(casters), positions, &self.centres, &self.id_keys)
    }

    /// Records that the counters tell so, where it is wanted, after the triangles at pixel centres were found.
    pub fn record_depths(
        &self,
        rec: &mut Recorder,
        with: &GeometryPipelines,
        (frame, samples): (&Buffer<Frame>, &Buffer<[f32; 4]>),
        casters: &CasterBuffers,
        status: &Buffer<u32>,
    ) {
        if let Some(depths) = &with.depths {
            let Self { id_keys, points, .. } = self;
            let seen = PrimaryHits { samples, id_keys, triangles: &casters.triangles, points };
            depths.record(&mut rec.stage("seen_depths"), frame, seen, status, id_keys.len() as u64);
        }
    }

    /// The triangles' blocks of pixels.
    pub fn in_camera<'a>(&'a self, casters: &'a CasterBuffers) -> Blocks<'a> {
        Blocks {
            triangles: &casters.triangles,
            points: &self.points,
            rects: &self.facts.camera_rects,
            facing: &self.facts.facing,
            offsets: &self.camera_offsets,
            args: (self.args.raw(), CAMERA_ARGS as u64),
        }
    }

    /// The triangles' blocks of texels.
    pub fn in_light<'a>(&'a self, casters: &'a CasterBuffers) -> Blocks<'a> {
        Blocks {
            triangles: &casters.triangles,
            points: &self.map_points,
            rects: &self.facts.light_rects,
            facing: &self.facts.facing,
            offsets: &self.light_offsets,
            args: (self.args.raw(), LIGHT_ARGS as u64),
        }
    }
}
