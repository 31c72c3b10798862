//! `ray-traced`: any-hit rays from every sample to the light through a tree of casters (Whitted 1980; Ylitie, Karras, Laine
//! 2017), one page of calls to stages. The samples are those of `facet-masks` with one facet a pixel, and so is the model:
//! the two differ in how they find what lies between a sample and the light.
//!
//! With [`RayTracedSettings::silhouettes`](super::RayTracedSettings::silhouettes) only pixels that the proof of `facet-masks` leaves undecided are traced. Memory is
//! fixed: about 170 bytes a pixel, and the tree. The tree is built once on the CPU, which is part of no frame's time.

use super::fixed::{FixedMethod, Inputs};
use super::prepared::{CasterBuffers, Prepared};
use super::render::Counts;
use super::settings::Settings;
use super::settled::Settled;
use crate::caster_tree::CasterTree;
use crate::frame::Frame;
use crate::gpu::{Buffer, Gpu, Recorder, Stage};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::PrefixScan;
use crate::stages::facet_classify::Facets;
use crate::stages::shadow_rays::{Rays, Scene, ShadowRays, Step, TreeBuffers};
use crate::{Error, Result};
use glam::DVec3;

/// The method for one mesh, image and setting.
#[derive(Debug)]
pub struct RayTraced {
    settled: Settled,
    rays: ShadowRays,
    tree: CasterTree,
    tree_buffers: TreeBuffers,
    work: Rays,
    validity: bool,
}

impl RayTraced {
    /// Builds the tree, pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`CasterTree::new`] and [`Buffer::storage`].
    pub fn new(gpu: &Gpu, prepared: &Prepared, casters: &CasterBuffers, settings: &Settings) -> Result<Self> {
        settings.check()?;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let tree = CasterTree::new(&prepared.mesh)?;
        let scan = PrefixScan::new(device);
        let settle = settings.ray_traced.silhouettes && settings.settle;
        Ok(Self {
            rays: ShadowRays::new(device, &scan, settings.samples.words()),
            settled: Settled::new(gpu, &scan, casters, settings, settle)?,
            tree_buffers: TreeBuffers::new(device, queue, &tree)?,
            work: Rays::new(device, queue, settings.pixels(), settings.samples.count())?,
            validity: settings.validity && settings.samples.count() > 1,
            tree,
        })
    }

    /// The facets of the last frame.
    pub fn facets(&self) -> &Facets {
        self.settled.facets()
    }
}

impl FixedMethod for RayTraced {
    fn prepare(&mut self, gpu: &Gpu, camera: &Camera, _: &Light, _: &LightView, frame: &Frame) -> Result<()> {
        self.settled.prepare(gpu, frame, self.validity);
        let place = self.tree.place(DVec3::from(camera.eye.map(f64::from)), f64::from(frame.eye[3]));
        self.tree_buffers.place.write(&gpu.queue, &[place]);
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: Inputs) -> Result<()> {
        let (casters, facets) = (inputs.casters, self.settled.facets());
        rec.clear_words(self.work.work.raw(), 0, 4);
        self.settled.record_facets(rec, inputs)?;
        let frame = self.settled.frame();
        let scene = Scene {
            samples: inputs.samples,
            tree: &self.tree_buffers,
            triangles: casters.triangles.raw(),
            positions: casters.positions.raw(),
        };
        let record = |stage: &mut Stage, step| self.rays.record(stage, step, frame, scene, facets, &self.work);
        {
            let stage = &mut rec.stage("shadow_rays");
            self.rays.record_list(stage, facets, &self.work)?;
            record(stage, Step::Trace)?;
        }
        record(&mut rec.stage("shadow_rays_refine"), Step::Refine)?;
        if self.validity {
            record(&mut rec.stage("shadow_rays_cut"), Step::Cut)?;
        }
        self.settled.record_resolve(rec)
    }

    fn visibility(&self) -> &Buffer<f32> {
        self.settled.visibility()
    }

    fn lit(&self) -> Option<&Buffer<u32>> {
        Some(self.settled.lit())
    }

    fn counts(&self, gpu: &Gpu) -> Result<Counts> {
        let [traced, refined, early] = self.work.read(gpu)?;
        if early > 0 {
            let what = format!("steps of {early} shadow rays through the tree of casters");
            let limit = u64::from(crate::gpu::kernels::shadow_rays::MOST_STEPS);
            return Err(Error::Memory { what, needed: limit + 1, limit });
        }
        let counts = self.settled.counts(gpu)?;
        let rays = u64::from(traced) * u64::from(self.settled.samples());
        Ok(Counts { visibility_evaluations: rays, refined_evaluations: u64::from(refined), ..counts })
    }
}
