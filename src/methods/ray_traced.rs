//! `ray-traced`: any-hit rays from every sample to the light through a tree of casters (Whitted 1980; Ylitie, Karras, Laine
//! 2017), one page of calls to stages. The samples are those of `facet-masks`, with one facet a pixel or one for every surface, and so
//! is the model: the two differ in how they find what lies between a sample and the light.
//!
//! With [`RayTracedSettings::silhouettes`](super::RayTracedSettings::silhouettes) only facets that the proof of `facet-masks` leaves undecided are traced. Memory is
//! fixed with one facet a pixel: about 190 bytes a pixel, and the tree; with all of them the lists grow. The tree is built once on the CPU, which is part of no frame's time.

use super::early_out::EarlyOut;
use super::facet_masks::Capacities;
use super::fixed_memory::{
    AskedViews, FixedMethod, FrameInputs, MethodParts, OUTCOME_WORDS, StageInputs, StripOutcome,
};
use crate::gpu::{Buffer, Recorder, Stage, Uploads};
use crate::stages::PrefixScan;
use crate::stages::facet_classify::Facets;
use crate::stages::shadow_rays::{RayLists, RayStep, ShadowRays};
use crate::status::StatusHead;
use crate::{Error, Result};

/// The method for one mesh, image and setting.
#[derive(Debug)]
pub struct RayTraced {
    settled: EarlyOut,
    rays: ShadowRays,
    work: RayLists,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl RayTraced {
    /// Builds the tree, pipelines and memory.
    ///
    /// # Errors
    /// As [`EarlyOut::new`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, settings, .. } = parts;
        let scan = PrefixScan::new(device);
        let settle = settings.ray_traced.silhouettes && settings.settle;
        let settled = EarlyOut::new(parts, &scan, settle)?;
        Ok(Self {
            rays: ShadowRays::specialised(device, &scan, settings.samples.words(), settings.alpha_tested),
            work: RayLists::new(device, queue, settled.facets().list.len(), settings.samples.count())?,
            settled,
            device: device.clone(),
            queue: queue.clone(),
        })
    }
}

impl FixedMethod for RayTraced {
    fn beyond(&self) -> bool {
        true
    }

    fn finds_surfaces(&self) -> bool {
        self.settled.finds_every_surface()
    }

    fn capacities(&self) -> Capacities {
        self.settled.capacities()
    }

    fn asks(&self) -> AskedViews {
        AskedViews::None
    }

    fn upload(&self, uploads: &mut Uploads, of: FrameInputs) -> Result<()> {
        self.settled.upload(uploads, of);
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let facets = self.settled.facets();
        rec.clear_words(self.work.work.raw(), 0, 4);
        self.settled.record_facets(rec, inputs)?;
        let (frame, scene) = (self.settled.frame(), self.settled.scene(inputs));
        let record = |stage: &mut Stage, step| self.rays.record(stage, step, frame, scene, facets, &self.work);
        {
            let stage = &mut rec.stage("shadow_rays");
            self.rays.record_list(stage, facets, &self.work)?;
            record(stage, RayStep::Trace)?;
        }
        record(&mut rec.stage("shadow_rays_refine"), RayStep::Refine)?;
        if self.settled.validity() {
            record(&mut rec.stage("shadow_rays_cut"), RayStep::Cut)?;
        }
        self.settled.record_resolve(rec, inputs.status);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        self.settled.visibility()
    }

    fn lit(&self) -> Option<&Buffer<u32>> {
        Some(self.settled.lit())
    }

    fn facets(&self) -> Option<&Facets> {
        Some(self.settled.facets())
    }

    fn record_outcome(&self, rec: &mut Recorder, to: &Buffer<u32>, at: u64) {
        rec.copy_words(self.work.work.raw(), 0, to.raw(), at, OUTCOME_WORDS as u64);
        // In place of a word that says how many rays are followed again.
        self.settled.record_outcome(rec, to, at + 1);
    }

    fn outcome(&mut self, words: [u32; OUTCOME_WORDS], head: &StatusHead) -> Result<StripOutcome> {
        let [traced, refined, early] = RayLists::counts(words);
        let (left_out, grown) = self.settled.judge(words[1], head)?;
        if grown {
            let (facets, samples) = (self.settled.facets().list.len(), self.settled.samples());
            self.work = RayLists::new(&self.device, &self.queue, facets, samples)?;
        }
        if early > 0 {
            let what = format!("steps or more, as {early} shadow rays take through the tree of casters");
            let limit = u64::from(crate::gpu::kernels::shadow_rays::MOST_STEPS);
            return Err(Error::Limit { what, needed: limit + 1, limit });
        }
        let rays = u64::from(traced) * u64::from(self.settled.samples());
        Ok(StripOutcome { left_out, evaluations: [rays, u64::from(refined)] })
    }
}
