//! What methods of one facet a pixel share around their own work: the facets, settled early where that is proved, the tree
//! of casters, and from the facets' masks the picture.

use super::fixed::Inputs;
use super::prepared::{CasterBuffers, Prepared};
use super::render::Counts;
use super::settings::Settings;
use crate::Result;
use crate::caster_tree::CasterTree;
use crate::frame::Frame;
use crate::gpu::kernels::silhouette_mask;
use crate::gpu::{Buffer, Gpu, Groups, Recorder};
use crate::scene::Camera;
use crate::stages::dispatch_args::{Request, Requests};
use crate::stages::facet_classify::{FacetClassify, Facets, State, Surroundings};
use crate::stages::front_layer::FrontLayer;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::resolve::Resolve;
use crate::stages::shadow_rays::{Scene, TreeBuffers};
use crate::stages::silhouette_mask::SilhouetteMask;
use crate::stages::summed_area::Texels;
use crate::stages::work_owners::{ListWork, WorkOwners};
use crate::stages::{DispatchArgs, PrefixScan, SummedArea, prefix_scan, summed_area};
use glam::DVec3;

/// Facets, the tree of casters, and the way from masks to the picture.
#[derive(Debug)]
pub struct Settled {
    settings: Settings,
    frame: Buffer<Frame>,
    classify: FacetClassify,
    resolve: Resolve,
    facets: Facets,
    sat: Buffer<u32>,
    layers: Layers,
    status: Buffer<u32>,
    visibility: Buffer<f32>,
    lit: Buffer<u32>,
    proof: Option<Proof>,
    tree: CasterTree,
    tree_buffers: TreeBuffers,
}

/// What proves facets lit or shadowed without looking at their casters: stages of `facet-masks`.
#[derive(Debug)]
struct Proof {
    layers: LightLayers,
    silhouettes: SilhouetteMask,
    front: FrontLayer,
    summed_area: SummedArea,
    work: ListWork,
    edge_rects: Buffer<[u32; 2]>,
    edge_items: Buffer<u32>,
    edge_offsets: Buffer<u32>,
    scan_scratch: prefix_scan::Scratch,
    sat_scratch: summed_area::Scratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl Settled {
    /// Builds the tree, memory and pipelines for one mesh, image and map; with `settle` facets are settled early on proof.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`CasterTree::new`] and [`Buffer::storage`].
    pub fn new(
        gpu: &Gpu,
        scan: &PrefixScan,
        prepared: &Prepared,
        casters: &CasterBuffers,
        settings: &Settings,
        settle: bool,
    ) -> Result<Self> {
        settings.check()?;
        let tree = CasterTree::new(&prepared.mesh)?;
        let (device, pixels, words) = (&gpu.device, settings.pixels(), settings.samples.words());
        let map = if settle { settings.map as usize } else { 1 };
        Ok(Self {
            frame: Buffer::uniform(device, "settled.frame", 1)?,
            classify: FacetClassify::specialised(device, words, false, false),
            resolve: Resolve::new(device, words),
            facets: Facets::new(device, pixels, pixels, words as usize)?,
            sat: Buffer::storage(device, "settled.sat", map * map)?,
            layers: Layers::new(device, map)?,
            status: Buffer::storage(device, "settled.status", 32)?,
            visibility: Buffer::storage(device, "settled.visibility", pixels)?,
            lit: Buffer::storage(device, "settled.lit", pixels * words as usize)?,
            proof: if settle { Some(Proof::new(gpu, scan, casters, map)?) } else { None },
            tree_buffers: TreeBuffers::new(device, &gpu.queue, &tree)?,
            tree,
            settings: settings.clone(),
        })
    }

    /// Whether the masks tell which samples see another surface: with one sample a pixel none does.
    pub fn validity(&self) -> bool {
        self.settings.validity && self.samples() > 1
    }

    /// Takes in the frame, with what this way of settling changes of it, and where the tree lies in it.
    pub fn prepare(&self, gpu: &Gpu, camera: &Camera, frame: &Frame) {
        let mut own = *frame;
        own.flags |= if self.validity() { Frame::VALIDITY } else { 0 };
        own.flags |= if self.proof.is_none() { Frame::ALL_UNDECIDED } else { 0 };
        self.frame.write(&gpu.queue, &[own]);
        let place = self.tree.place(DVec3::from(camera.eye.map(f64::from)), f64::from(frame.eye[3]));
        self.tree_buffers.place.write(&gpu.queue, &[place]);
    }

    /// The frame uniform with those changes.
    pub fn frame(&self) -> &Buffer<Frame> {
        &self.frame
    }

    /// Inputs of rays through the tree.
    pub fn scene<'a>(&'a self, inputs: Inputs<'a>) -> Scene<'a> {
        Scene {
            samples: inputs.samples,
            tree: &self.tree_buffers,
            triangles: &inputs.casters.triangles,
            positions: &inputs.casters.positions,
        }
    }

    /// The facets of the last frame.
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// Samples a pixel.
    pub fn samples(&self) -> u32 {
        self.settings.samples.count()
    }

    /// Visibility of each pixel.
    pub fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    /// Lit samples of each pixel.
    pub fn lit(&self) -> &Buffer<u32> {
        &self.lit
    }

    /// Records the facets and their states.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_facets(&self, rec: &mut Recorder, inputs: Inputs) -> Result<()> {
        let frame = &self.frame;
        rec.clear(self.status.raw());
        if let Some(proof) = &self.proof {
            proof.record(rec, frame, inputs, &self.layers, &self.sat, &self.status)?;
        }
        let around = Surroundings {
            triangles: &inputs.casters.triangles,
            positions: &inputs.casters.positions,
            sat: &self.sat,
            splits: &self.layers.splits,
        };
        let stage = &mut rec.stage("facet_classify");
        self.classify.record_one(stage, frame, &inputs.geometry.id_keys, &self.facets);
        self.classify.record_classify(
            stage,
            frame,
            inputs.samples,
            around,
            &self.facets,
            Groups::Items(self.facets.list.len() as u64),
        );
        Ok(())
    }

    /// Records the picture.
    pub fn record_resolve(&self, rec: &mut Recorder) {
        let stage = &mut rec.stage("resolve");
        self.resolve.record(stage, &self.frame, &self.facets, &self.visibility, &self.lit, &self.status);
    }

    /// How many facets have each state.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    pub fn counts(&self, gpu: &Gpu) -> Result<Counts> {
        let words = self.status.read(gpu)?;
        let of = |state: State| u64::from(words[16 + state as usize]);
        Ok(Counts {
            silhouette_edges: u64::from(words[8]),
            silhouette_pixels: of(State::Undecided),
            facets: State::ALL.iter().map(|&s| of(s)).sum(),
            empty_facets: of(State::Empty),
            dark_facets: of(State::Dark),
            lit_facets: of(State::Lit),
            shadowed_facets: of(State::Shadowed),
            ..Counts::default()
        })
    }
}

impl Proof {
    fn new(gpu: &Gpu, scan: &PrefixScan, casters: &CasterBuffers, map: usize) -> Result<Self> {
        let (device, queue, edges) = (&gpu.device, &gpu.queue, casters.edges.len());
        let summed_area = SummedArea::new(device, Texels::Bits);
        let request = Request::new(edges, silhouette_mask::WORKGROUP, u32::MAX as usize >> 1, 0)?;
        Ok(Self {
            layers: LightLayers::new(device),
            silhouettes: SilhouetteMask::new(device),
            front: FrontLayer::new(device),
            work: ListWork::new(device, scan),
            edge_rects: Buffer::storage(device, "settled.edge_rects", edges)?,
            edge_items: Buffer::storage(device, "settled.edge_items", edges)?,
            edge_offsets: Buffer::storage(device, "settled.edge_offsets", WorkOwners::words(edges, map * map))?,
            scan_scratch: PrefixScan::scratch(device, edges)?,
            sat_scratch: summed_area.scratch(device, map, map)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "settled.args", 3)?,
            summed_area,
        })
    }

    fn record(
        &self,
        rec: &mut Recorder,
        frame: &Buffer<Frame>,
        inputs: Inputs,
        layers: &Layers,
        sat: &Buffer<u32>,
        status: &Buffer<u32>,
    ) -> Result<()> {
        for zero in [&layers.nearest_keys, &layers.second_keys, &layers.mask] {
            rec.clear(zero.raw());
        }
        let (casters, geometry) = (inputs.casters, inputs.geometry);
        let (in_light, count) = (geometry.in_light(casters), casters.edges.len());
        self.layers.record(&mut rec.stage("light_layers"), frame, in_light, layers);
        {
            let stage = &mut rec.stage("silhouette_mask");
            let (edges, points) = (&casters.edges, &geometry.map_points);
            let (rects, items, offsets) = (&self.edge_rects, &self.edge_items, &self.edge_offsets);
            let facing = &geometry.facts.facing;
            self.silhouettes.record_classify(stage, frame, edges, facing, points, rects, items, status, count);
            self.work.record(stage, (items, items.len()), offsets, &self.scan_scratch, (&self.requests, &self.args))?;
            let args = (self.args.raw(), 0);
            self.silhouettes.record_raster(stage, frame, edges, points, rects, offsets, args, layers);
        }
        {
            let stage = &mut rec.stage("front_layer");
            self.front.record_check(stage, frame, in_light, layers);
            self.front.record_settle(stage, frame, layers);
        }
        self.summed_area.record(&mut rec.stage("summed_area"), &layers.mask, sat, &self.sat_scratch)
    }
}
