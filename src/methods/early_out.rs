//! Parts shared by methods that test the samples of facets one by one: the facets, one a pixel or one for every surface, settled early where
//! that is proved, the tree of casters, and the way from the facets' masks to the picture.

use super::every_surface::{EverySurface, SurfacePipelines, SurfacesBy};
use super::facet_masks::Capacities;
use super::fixed_memory::{FrameInputs, MethodParts, StageInputs};
use super::light_maps::{LightMapPipelines, LightMaps};
use super::list_sizing;
use super::settings::{FacetMode, Settings};
use crate::Result;
use crate::caster_tree::CasterTree;
use crate::frame::Frame;
use crate::gpu::{Buffer, Groups, Profile, Recorder, Uploads};
use crate::stages::PrefixScan;
use crate::stages::facet_classify::{ClassifyInputs, FacetClassify, Facets};
use crate::stages::resolve::Resolve;
use crate::stages::shadow_rays::{RayInputs, TreeBuffers};
use crate::status::StatusHead;
use glam::DVec3;
use std::mem::offset_of;

/// Facets, the tree of casters, and the way from masks to the picture.
#[derive(Debug)]
pub struct EarlyOut {
    settings: Settings,
    frame: Buffer<Frame>,
    classify: FacetClassify,
    resolve: Resolve,
    facets: Facets,
    maps: Maps,
    visibility: Buffer<f32>,
    lit: Buffer<u32>,
    tree: CasterTree,
    tree_buffers: TreeBuffers,
    every: Option<Every>,
}

/// The search for every surface that samples see, and its lists, which grow from one frame to the next.
#[derive(Debug)]
struct Every {
    with: SurfacePipelines,
    memory: EverySurface,
    capacities: Capacities,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Every {
    fn new(parts: MethodParts, scan: &PrefixScan) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        let capacities = list_sizing::of_surfaces(settings.pixels()).in_turns(Profile::of(device));
        let (device, queue) = (device.clone(), queue.clone());
        Ok(Self {
            with: SurfacePipelines::new(&device, scan, settings.samples.count(), [settings.alpha_tested, false]),
            memory: EverySurface::new(&device, &queue, (casters.triangles.len(), false), settings, capacities)?,
            capacities,
            device,
            queue,
        })
    }
}

/// Light maps that prove facets lit or shadowed without tests of their casters.
#[derive(Debug)]
enum Maps {
    Made(Box<(LightMapPipelines, LightMaps)>),
    /// One texel, which nothing asks.
    Unused {
        sat: Buffer<u32>,
        splits: Buffer<f32>,
    },
}

impl Maps {
    fn made(parts: MethodParts, scan: &PrefixScan) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        let with = LightMapPipelines::new(device, scan);
        let maps = LightMaps::new(device, queue, &with, casters.edges.len(), settings.map as usize)?;
        Ok(Self::Made(Box::new((with, maps))))
    }

    fn unused(device: &wgpu::Device) -> Result<Self> {
        Ok(Self::Unused {
            sat: Buffer::storage(device, "settled.sat", 1)?,
            splits: Buffer::storage(device, "settled.splits", 1)?,
        })
    }
}

impl EarlyOut {
    /// Builds the tree, memory and pipelines for one mesh, image and map; with `settle` facets are settled early on proof.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`CasterTree::new`] and [`Buffer::storage`].
    pub fn new(parts: MethodParts, scan: &PrefixScan, settle: bool) -> Result<Self> {
        let MethodParts { device, queue, prepared, settings, .. } = parts;
        settings.check()?;
        let tree = CasterTree::with_alpha(&prepared.mesh, prepared.alpha())?;
        let (pixels, words) = (settings.pixels(), settings.samples.words());
        let clamp = settings.facets == FacetMode::All;
        let every = clamp.then(|| Every::new(parts, scan)).transpose()?;
        let facets = every.as_ref().map_or(pixels, |every| every.capacities.facets);
        Ok(Self {
            frame: Buffer::uniform(device, "settled.frame", 1)?,
            classify: FacetClassify::specialised(device, words, clamp, false),
            resolve: Resolve::new(device, words),
            facets: Facets::new(device, facets, pixels, words as usize)?,
            maps: if settle { Maps::made(parts, scan)? } else { Maps::unused(device)? },
            visibility: Buffer::storage(device, "settled.visibility", pixels)?,
            lit: Buffer::storage(device, "settled.lit", pixels * words as usize)?,
            tree_buffers: TreeBuffers::new(device, queue, &tree.nodes, &tree.triangles)?,
            tree,
            every,
            settings: settings.clone(),
        })
    }

    /// Whether the masks tell which samples see another surface: with one sample a pixel, and with a facet for every surface, none does.
    pub fn validity(&self) -> bool {
        self.settings.keeps_validity()
    }

    /// Whether every surface that samples see has a facet.
    pub fn finds_every_surface(&self) -> bool {
        self.every.is_some()
    }

    /// How long the lists of what the camera sees are.
    pub fn capacities(&self) -> Capacities {
        self.every.as_ref().map_or(Capacities::NONE, |every| every.capacities)
    }

    /// Records the copy of what [`EarlyOut::judge`] asks: how many facets the frame had room for.
    pub fn record_outcome(&self, rec: &mut Recorder, to: &Buffer<u32>, at: u64) {
        rec.copy_words(self.frame.raw(), offset_of!(Frame, facets_total) as u64 / 4, to.raw(), at, 1);
    }

    /// Whether a frame lacks facets, given what it had room for (0: a view that was not there) and its counters. Then lists of another length, longer than it needed, wait
    /// for the next, and `true` stands behind.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] for lists that no memory holds; as [`Facets::new`].
    pub fn judge(&mut self, facets: u32, head: &StatusHead) -> Result<(bool, bool)> {
        let Some(every) = self.every.as_mut().filter(|_| facets > 0) else { return Ok((false, false)) };
        let now = every.capacities;
        if facets as usize != now.facets {
            // It was recorded before they grew.
            return Ok((true, false));
        }
        let Some(more) = list_sizing::more_surfaces(head, now)? else { return Ok((false, false)) };
        let (pixels, words) = (self.settings.pixels(), self.settings.samples.words() as usize);
        let facets = Facets::new(&every.device, more.facets, pixels, words)?;
        every.memory.resize(&every.device, &every.queue, &self.settings, (now, more))?;
        (self.facets, every.capacities) = (facets, more);
        Ok((true, true))
    }

    /// Adds the frame, with what this way of settling changes of it, and where the tree lies in it.
    pub fn upload(&self, uploads: &mut Uploads, of: FrameInputs) {
        let FrameInputs { camera, frame, several, .. } = of;
        let mut own = *frame;
        own.flags |= if self.validity() { Frame::VALIDITY } else { 0 };
        // One of several views proves nothing.
        own.flags |= if several { Frame::NO_VIEW } else { 0 };
        own.flags |= if several || matches!(self.maps, Maps::Unused { .. }) { Frame::ALL_UNDECIDED } else { 0 };
        uploads.write(&self.frame, &[own]);
        let place = self.tree.place(DVec3::from(camera.eye.map(f64::from)), f64::from(frame.eye[3]));
        uploads.write(&self.tree_buffers.place, &[place]);
    }

    /// The frame uniform with those changes.
    pub fn frame(&self) -> &Buffer<Frame> {
        &self.frame
    }

    /// Inputs of rays through the tree.
    pub fn scene<'a>(&'a self, inputs: StageInputs<'a>) -> RayInputs<'a> {
        RayInputs {
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
    pub fn record_facets(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let frame = &self.frame;
        let (sat, splits) = match &self.maps {
            Maps::Made(maps) => {
                let casters = (inputs.casters, inputs.geometry);
                maps.1.record(rec, &maps.0, frame, casters, inputs.status, false)?;
                (&maps.1.sat, &maps.1.layers.splits)
            }
            Maps::Unused { sat, splits } => (sat, splits),
        };
        let around =
            ClassifyInputs { triangles: &inputs.casters.triangles, positions: &inputs.casters.positions, sat, splits };
        if let Some(Every { with, memory, .. }) = &self.every {
            rec.clear(inputs.id_keys.raw());
            let casters = inputs.casters;
            memory.record(
                rec,
                with,
                frame,
                inputs.samples,
                inputs.geometry.in_camera(casters),
                &casters.positions,
                casters.surfaces.as_ref(),
                &self.facets,
                inputs.id_keys,
                inputs.status,
                SurfacesBy::Search,
            )?;
            // Those beyond the last are not classified.
            rec.clear_words(self.facets.items.raw(), 0, self.facets.list.len() as u64);
        }
        let stage = &mut rec.stage("facet_classify");
        if self.every.is_none() {
            self.classify.record_one(stage, frame, inputs.id_keys, &self.facets);
        }
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

    /// Records the picture, and counts facets in `status`.
    pub fn record_resolve(&self, rec: &mut Recorder, status: &Buffer<u32>) {
        let stage = &mut rec.stage("resolve");
        self.resolve.record(stage, &self.frame, &self.facets, &self.visibility, &self.lit, status);
    }
}
