//! `supersampled`: alias-free hard shadows, every sample against every caster before it (Aila and Laine 2004; Johnson et al.
//! 2005; Sintorn et al. 2008), one page of calls to stages. The brute force that Pan 2009 compares with; the samples are those
//! of `facet-masks`, with one facet a pixel or one for every surface, and so is the model.
//!
//! Memory is fixed with one facet a pixel: about 180 bytes a pixel, 8 a texel, and 40 MiB for a band of samples. Which samples see another surface
//! (with [`Settings::validity`](super::Settings::validity)) is found through the tree of casters of `ray-traced`.

use super::early_out::EarlyOut;
use super::facet_masks::Capacities;
use super::fixed_memory::{
    AskedViews, FixedMethod, FrameInputs, MethodParts, OUTCOME_WORDS, StageInputs, StripOutcome,
};
use crate::gpu::{Buffer, Recorder, Stage, Uploads};
use crate::stages::PrefixScan;
use crate::stages::facet_classify::Facets;
use crate::stages::sample_bins::{self, Bins, SampleBins};
use crate::stages::shadow_rays::{RayLists, RayStep, ShadowRays};
use crate::status::StatusHead;
use crate::{Error, Result};

/// The method for one mesh, image, map and setting.
#[derive(Debug)]
pub struct Supersampled {
    settled: EarlyOut,
    test: SampleBins,
    bins: Bins,
    cut: ShadowRays,
    cut_work: RayLists,
    device: wgpu::Device,
    queue: wgpu::Queue,
    map: usize,
}

impl Supersampled {
    /// Builds pipelines and memory, and the tree.
    ///
    /// # Errors
    /// As [`EarlyOut::new`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, settings, .. } = parts;
        let count = settings.samples.count();
        let scan = PrefixScan::new(device);
        let settled = EarlyOut::new(parts, &scan, false)?;
        let facets = settled.facets().list.len();
        Ok(Self {
            test: SampleBins::specialised(device, &scan, settings.samples.words(), settings.alpha_tested),
            bins: Bins::new(device, queue, settings.map as usize, facets, count)?,
            cut: ShadowRays::specialised(device, &scan, settings.samples.words(), settings.alpha_tested),
            cut_work: RayLists::with_doubts(device, queue, facets, count, 0)?,
            settled,
            device: device.clone(),
            queue: queue.clone(),
            map: settings.map as usize,
        })
    }
}

impl Supersampled {
    /// Which samples see another surface; also where none does: invalid masks are cleared.
    fn record_cut(&self, stage: &mut Stage, inputs: StageInputs) -> Result<()> {
        let (facets, scene) = (self.settled.facets(), self.settled.scene(inputs));
        self.cut.record_list(stage, facets, &self.cut_work)?;
        self.cut.record(stage, RayStep::Cut, self.settled.frame(), scene, facets, &self.cut_work)
    }
}

impl FixedMethod for Supersampled {
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
        AskedViews::All
    }

    fn upload(&self, uploads: &mut Uploads, of: FrameInputs) -> Result<()> {
        let frame = of.frame;
        let [nearest, clear] = [frame.light_low[3], frame.eye_low[3]];
        // A sample that is not before one slice of the view of a directional light is before another.
        if frame.light[3] != 0.0 && nearest > clear {
            return Err(Error::Scene(format!(
                "the light is nearer to a caster ({:.3} of the nearest distance that its view tells) than supersampled can sort samples; \
                 facet-masks and ray-traced can",
                clear / nearest
            )));
        }
        self.settled.upload(uploads, of);
        self.bins.frames_of(frame).for_each(|(buffer, frame)| uploads.write(buffer, &[frame]));
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (casters, facets, samples) = (inputs.casters, self.settled.facets(), inputs.samples);
        let positions = &casters.positions;
        let blocks = inputs.geometry.in_light(casters);
        let [view, views] = inputs.view;
        let binned = sample_bins::BinInputs { samples, blocks, positions, facets };
        if view == 0 {
            rec.clear_words(self.cut_work.work.raw(), 0, 4);
            self.settled.record_facets(rec, inputs)?;
            self.test.record_list(&mut rec.stage("sample_bins"), facets, &self.bins)?;
        }
        let (ends, starts) = (&self.bins.texel_ends, &self.bins.texel_offsets);
        for band in 0..self.bins.frames.len() {
            rec.clear(ends.raw());
            self.test.record_bin(&mut rec.stage("sample_bins"), 0, band, binned, &self.bins)?;
            rec.copy_words(starts.raw(), 0, ends.raw(), 0, starts.len() as u64 - 2);
            self.test.record_bin(&mut rec.stage("sample_bins"), 1, band, binned, &self.bins)?;
            self.test.record_occlude(&mut rec.stage("sample_tests"), band, binned, &self.bins)?;
            self.test.record_refine(&mut rec.stage("sample_tests_refine"), band, binned, &self.bins)?;
        }
        if view + 1 == views {
            self.record_cut(&mut rec.stage("shadow_rays_cut"), inputs)?;
            self.settled.record_resolve(rec, inputs.status);
        }
        Ok(())
    }

    fn record_outcome(&self, rec: &mut Recorder, to: &Buffer<u32>, at: u64) {
        self.settled.record_outcome(rec, to, at);
    }

    fn outcome(&mut self, words: [u32; OUTCOME_WORDS], head: &StatusHead) -> Result<StripOutcome> {
        let (left_out, grown) = self.settled.judge(words[0], head)?;
        if grown {
            let (device, queue) = (&self.device, &self.queue);
            let (facets, count) = (self.settled.facets().list.len(), self.settled.samples());
            let bins = Bins::new(device, queue, self.map, facets, count)?;
            self.cut_work = RayLists::with_doubts(device, queue, facets, count, 0)?;
            self.bins = bins;
        }
        Ok(StripOutcome { left_out, ..StripOutcome::default() })
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
}
