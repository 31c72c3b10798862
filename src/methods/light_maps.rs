//! Maps of one view of the light, and what they prove: the two nearest layers, silhouettes, the split depth of each texel, and a table that
//! counts the marked texels of any rectangle.

use super::geometry::Geometry;
use super::prepared::CasterBuffers;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::silhouette_mask;
use crate::gpu::{Buffer, Recorder};
use crate::stages::cluster_culling::ClusterPart;
use crate::stages::dispatch_args::{ArgsRequest, Requests};
use crate::stages::front_layer::FrontLayer;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::silhouette_mask::SilhouetteMask;
use crate::stages::summed_area::Texels;
use crate::stages::work_owners::{ListWork, WorkOwners};
use crate::stages::{DispatchArgs, PrefixScan, SummedArea, prefix_scan, summed_area};
use crate::status_word;
use std::mem::offset_of;

/// The pipelines.
#[derive(Debug)]
pub struct LightMapPipelines {
    layers: LightLayers,
    silhouettes: SilhouetteMask,
    front: FrontLayer,
    summed_area: SummedArea,
    work: ListWork,
}

impl LightMapPipelines {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            layers: LightLayers::new(device),
            silhouettes: SilhouetteMask::new(device),
            front: FrontLayer::new(device),
            summed_area: SummedArea::new(device, Texels::Bits),
            work: ListWork::new(device, scan),
        }
    }
}

/// The memory for one mesh and map size.
#[derive(Debug)]
pub struct LightMaps {
    /// Layers, marks and split depths.
    pub layers: Layers,
    /// Summed-area table of the marks; the last word counts them all.
    pub sat: Buffer<u32>,
    /// Number of the maps and count of silhouette edges, for the frames after the one that made them.
    kept: Buffer<u32>,
    edge_rects: Buffer<[u32; 2]>,
    edge_items: Buffer<u32>,
    edge_offsets: Buffer<u32>,
    scan_scratch: prefix_scan::PrefixScanScratch,
    sat_scratch: summed_area::SummedAreaScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl LightMaps {
    /// Makes the memory for a mesh of `edges` edges and maps of `size` texels a side, to be used with these pipelines.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        with: &LightMapPipelines,
        edges: usize,
        size: usize,
    ) -> Result<Self> {
        let texels = size * size;
        let request = ArgsRequest::new(edges, silhouette_mask::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            layers: Layers::new(device, size)?,
            sat: Buffer::storage(device, "summed_area.sat", texels)?,
            kept: Buffer::storage(device, "light_maps.kept", 2)?,
            edge_rects: Buffer::storage(device, "silhouette_mask.edge_rects", edges)?,
            edge_items: Buffer::storage(device, "silhouette_mask.edge_items", edges)?,
            edge_offsets: Buffer::storage(
                device,
                "silhouette_mask.edge_offsets",
                WorkOwners::words_of_clusters(edges, texels),
            )?,
            scan_scratch: PrefixScan::scratch(device, edges)?,
            sat_scratch: with.summed_area.scratch(device, size, size)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "silhouette_mask.args", 3)?,
        })
    }

    /// Records the stages `light_layers` to `summed_area`, after [`Geometry::record_setup`]; `status` takes the count of silhouette edges. Their
    /// number is that of `frame` when they are made, 0 before. `cut`: whether the frame has [`Frame::CUT_LAYERS`] set.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        rec: &mut Recorder,
        with: &LightMapPipelines,
        frame: &Buffer<Frame>,
        (casters, geometry): (&CasterBuffers, &Geometry),
        status: &Buffer<u32>,
        cut: bool,
    ) -> Result<()> {
        let layers = &self.layers;
        for zero in [&layers.nearest_keys, &layers.second_keys, &layers.mask, &self.kept] {
            rec.clear(zero.raw());
        }
        let in_light = geometry.in_light(casters);
        {
            let stage = &mut rec.stage("light_layers");
            with.layers.record(stage, frame, in_light, layers);
            if cut {
                with.layers.record_cut(stage, frame, in_light, layers);
            }
        }
        {
            let stage = &mut rec.stage("silhouette_mask");
            let (edges, points, facing) = (&casters.edges, &geometry.map_points, &geometry.facts.facing);
            let (rects, items, offsets) = (&self.edge_rects, &self.edge_items, &self.edge_offsets);
            let (requested, of) = (&geometry.requested, geometry.of_light(ClusterPart::Edges, edges.len()));
            with.silhouettes
                .record_classify(stage, frame, edges, facing, points, requested, rects, items, status, of)?;
            with.work.record(stage, (items, of), offsets, &self.scan_scratch, (&self.requests, &self.args))?;
            let args = (self.args.raw(), 0);
            with.silhouettes.record_raster(stage, frame, edges, points, rects, offsets, args, layers);
        }
        {
            let stage = &mut rec.stage("front_layer");
            with.front.record_check(stage, frame, in_light, layers);
            with.front.record_settle(stage, frame, layers);
        }
        with.summed_area.record(&mut rec.stage("summed_area"), &layers.mask, &self.sat, &self.sat_scratch)?;
        rec.copy_words(frame.raw(), (offset_of!(Frame, maps) / 4) as u64, self.kept.raw(), 0, 1);
        rec.copy_words(status.raw(), status_word!(silhouette_edges) as u64, self.kept.raw(), 1, 1);
        Ok(())
    }

    /// Notes in `status` which maps there are, and what was counted when they were made; their marked texels from word `texels` on.
    pub fn record_kept(&self, rec: &mut Recorder, status: &Buffer<u32>, texels: usize) {
        rec.copy_words(self.kept.raw(), 0, status.raw(), status_word!(maps) as u64, 1);
        rec.copy_words(self.kept.raw(), 1, status.raw(), status_word!(silhouette_edges) as u64, 1);
        rec.copy_words(self.sat.raw(), self.sat.len() as u64 - 1, status.raw(), texels as u64, 1);
    }
}
