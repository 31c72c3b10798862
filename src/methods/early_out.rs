//! Parts shared by methods of one facet a pixel: the facets, settled early where that is proved, the tree of casters, and the way from the
//! facets' masks to the picture.

use super::fixed_memory::{FrameInputs, MethodParts, StageInputs};
use super::light_maps::{LightMapPipelines, LightMaps};
use super::settings::Settings;
use crate::Result;
use crate::caster_tree::CasterTree;
use crate::frame::Frame;
use crate::gpu::{Buffer, Groups, Recorder, Uploads};
use crate::stages::PrefixScan;
use crate::stages::facet_classify::{ClassifyInputs, FacetClassify, Facets};
use crate::stages::resolve::Resolve;
use crate::stages::shadow_rays::{RayInputs, TreeBuffers};
use glam::DVec3;

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
        Ok(Self {
            frame: Buffer::uniform(device, "settled.frame", 1)?,
            classify: FacetClassify::specialised(device, words, false, false),
            resolve: Resolve::new(device, words),
            facets: Facets::new(device, pixels, pixels, words as usize)?,
            maps: if settle { Maps::made(parts, scan)? } else { Maps::unused(device)? },
            visibility: Buffer::storage(device, "settled.visibility", pixels)?,
            lit: Buffer::storage(device, "settled.lit", pixels * words as usize)?,
            tree_buffers: TreeBuffers::new(device, queue, &tree.nodes, &tree.triangles)?,
            tree,
            settings: settings.clone(),
        })
    }

    /// Whether the masks tell which samples see another surface: with one sample a pixel none does.
    pub fn validity(&self) -> bool {
        self.settings.validity && self.samples() > 1
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
                maps.1.record(rec, &maps.0, frame, inputs.casters, inputs.geometry, inputs.status)?;
                (&maps.1.sat, &maps.1.layers.splits)
            }
            Maps::Unused { sat, splits } => (sat, splits),
        };
        let around =
            ClassifyInputs { triangles: &inputs.casters.triangles, positions: &inputs.casters.positions, sat, splits };
        let stage = &mut rec.stage("facet_classify");
        self.classify.record_one(stage, frame, inputs.id_keys, &self.facets);
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
