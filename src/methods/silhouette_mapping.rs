//! `silhouette-map`: Shadow Silhouette Maps (Sen, Cammarano, Hanrahan 2003), one page of calls to stages. Beside the nearest depth of each texel,
//! each cell between four of them keeps a point of the silhouette. Memory is fixed: 12 bytes a texel, and 20 an edge.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, StageInputs};
use crate::Result;
use crate::gpu::kernels::silhouette_mask;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::cluster_culling::ClusterPart;
use crate::stages::dispatch_args::{ArgsRequest, Requests};
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::silhouette_map::SilhouetteMap;
use crate::stages::silhouette_mask::SilhouetteMask;
use crate::stages::silhouette_points::{EdgeBlocks, SilhouetteCells, SilhouettePoints};
use crate::stages::work_owners::{ListWork, WorkOwners};
use crate::stages::{DispatchArgs, PrefixScan, PrimaryHits, prefix_scan};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct SilhouetteMapping {
    layers: LightLayers,
    map: Layers,
    silhouettes: SilhouetteMask,
    work: ListWork,
    raster: SilhouettePoints,
    ask: SilhouetteMap,
    cells: SilhouetteCells,
    edge_rects: Buffer<[u32; 2]>,
    edge_items: Buffer<u32>,
    edge_offsets: Buffer<u32>,
    scan_scratch: prefix_scan::PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
    visibility: Buffer<f32>,
}

impl SilhouetteMapping {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let (size, edges) = (settings.map as usize, casters.edges.len());
        let request = ArgsRequest::new(edges, silhouette_mask::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            layers: LightLayers::nearest_only(device, settings.alpha_tested),
            map: Layers::nearest_only(device, size)?,
            silhouettes: SilhouetteMask::new(device),
            work: ListWork::new(device, &PrefixScan::new(device)),
            raster: SilhouettePoints::new(device),
            ask: SilhouetteMap::new(device, settings.shadow_map.constant, settings.shadow_map.slope),
            cells: SilhouetteCells::new(device, size)?,
            edge_rects: Buffer::storage(device, "silhouette_mask.edge_rects", edges)?,
            edge_items: Buffer::storage(device, "silhouette_mask.edge_items", edges)?,
            edge_offsets: Buffer::storage(
                device,
                "silhouette_mask.edge_offsets",
                WorkOwners::words_of_clusters(edges, size * size),
            )?,
            scan_scratch: PrefixScan::scratch(device, edges)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "silhouette_mask.args", 3)?,
            visibility: Buffer::storage(device, "silhouette_map.visibility", settings.pixels())?,
        })
    }
}

impl FixedMethod for SilhouetteMapping {
    fn asks(&self) -> AskedViews {
        AskedViews::One(2.0)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let StageInputs { frame, geometry, casters, status, .. } = inputs;
        for zero in [&self.map.nearest_keys, &self.cells.edge_keys] {
            rec.clear(zero.raw());
        }
        self.layers.record(&mut rec.stage("light_layers"), frame, geometry.in_light(casters), &self.map);
        {
            let stage = &mut rec.stage("silhouette_mask");
            let (edges, points, facing) = (&casters.edges, &geometry.map_points, &geometry.facts.facing);
            let (rects, items, requested) = (&self.edge_rects, &self.edge_items, &geometry.requested);
            let of = geometry.of_light(ClusterPart::Edges, edges.len());
            self.silhouettes
                .record_classify(stage, frame, edges, facing, points, requested, rects, items, status, of)?;
            self.work.record(
                stage,
                (items, of),
                &self.edge_offsets,
                &self.scan_scratch,
                (&self.requests, &self.args),
            )?;
        }
        let blocks = EdgeBlocks {
            edges: &casters.edges,
            points: &geometry.map_points,
            rects: &self.edge_rects,
            offsets: &self.edge_offsets,
            args: (self.args.raw(), 0),
        };
        for _ in 0..2 {
            rec.clear(self.cells.point_keys.raw());
            let stage = &mut rec.stage("silhouette_points");
            self.raster.record(stage, frame, blocks, &self.map.nearest_keys, &self.cells);
        }
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &casters.triangles,
            points: &geometry.points,
        };
        let stage = &mut rec.stage("silhouette_map");
        self.ask.record(stage, frame, seen, &self.map.nearest_keys, &self.cells.point_keys, &self.visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_depths(gpu, &self.map).map(Some)
    }
}
