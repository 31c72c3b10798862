//! Computing one frame of `facet-masks` on the GPU and reading it back: records, submits, looks at what the lists needed,
//! grows them and runs again until nothing is left out.

use super::facet_masks::{FacetMasks, Pipelines, Settings};
use super::growth;
use super::prepared::{CasterBuffers, Prepared};
use crate::Result;
use crate::gpu::{Gpu, Recorder, StageTime, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// What was counted in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Edges that are silhouettes from the light.
    pub silhouette_edges: u64,
    /// Texels marked in the silhouette mask map: silhouettes, and texels whose front layer could not be proved.
    pub silhouette_texels: u64,
    /// Pixels whose facet needed evaluation.
    pub silhouette_pixels: u64,
    /// Pairs of facets and texels.
    pub pixel_texel_pairs: u64,
    /// Pairs of triangles and texels.
    pub triangle_texel_pairs: u64,
    /// Triangles tested against facets in the light view.
    pub candidate_tests: u64,
    /// Triangles evaluated against facets: those that the test kept.
    pub visibility_evaluations: u64,
    /// Evaluations that single precision could not decide and 46 bits did.
    pub refined_evaluations: u64,
    /// Facets of all pixels.
    pub facets: u64,
    /// Pixels whose samples were looked at one by one; 0 with one facet a pixel.
    pub complex_pixels: u64,
    /// Facets without a surface.
    pub empty_facets: u64,
    /// Facets turned away from the light.
    pub dark_facets: u64,
    /// Facets settled as lit.
    pub lit_facets: u64,
    /// Facets settled as shadowed.
    pub shadowed_facets: u64,
}

/// How one list fared.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ListUse {
    /// The list.
    pub name: &'static str,
    /// Elements it needed, the largest band.
    pub needed: u64,
    /// Elements it could hold in the end.
    pub capacity: u64,
    /// Runs of the frame until it fitted.
    pub runs: u32,
}

/// A frame, read back.
#[derive(Clone, Debug)]
pub struct Output {
    /// Visibility of each pixel, row by row from the top.
    pub visibility: Vec<f32>,
    /// Lit samples of each pixel, `words` words each; all ones where nothing is seen.
    pub lit: Vec<u32>,
    /// Words of a mask.
    pub words: u32,
    /// Triangle of the prepared mesh at each pixel centre; `u32::MAX` where there is none.
    pub triangles: Vec<u32>,
    /// Counters.
    pub counts: Counts,
    /// The lists.
    pub lists: Vec<ListUse>,
    /// GPU time of each stage of the last run; empty without time stamps.
    pub stages: Vec<StageTime>,
    /// Milliseconds from submission to the end of the last run.
    pub wall_ms: f64,
    /// Dispatches recorded for the last run.
    pub dispatches: u32,
}

/// How much the lists may take at first, and at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Elements each list starts with; `None`: a guess from image and map size.
    pub start: Option<usize>,
    /// Bytes the two pair lists may take together; what needs more is split into bands of facets.
    pub bytes: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { start: None, bytes: 1 << 30 }
    }
}

/// A method set up for one mesh and one setting, to be rendered again and again.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    prepared: &'a Prepared,
    casters: CasterBuffers,
    method: FacetMasks,
    budget: Budget,
    timer: Option<Timer>,
    settings: Settings,
}

impl<'a> Renderer<'a> {
    /// Uploads the mesh and builds pipelines and memory.
    ///
    /// # Errors
    /// As [`FacetMasks::new`].
    pub fn new(gpu: &'a Gpu, prepared: &'a Prepared, settings: &Settings, budget: Budget) -> Result<Self> {
        let pipelines = Arc::new(Pipelines::new(&gpu.device, settings));
        Self::with_pipelines(gpu, prepared, settings, budget, pipelines)
    }

    /// Uploads the mesh and makes memory, with pipelines that exist already.
    ///
    /// # Errors
    /// As [`FacetMasks::new`].
    pub fn with_pipelines(
        gpu: &'a Gpu,
        prepared: &'a Prepared,
        settings: &Settings,
        budget: Budget,
        pipelines: Arc<Pipelines>,
    ) -> Result<Self> {
        let casters = prepared.upload(&gpu.device, &gpu.queue)?;
        let capacities = growth::first(settings, budget);
        let method = FacetMasks::new(&gpu.device, &gpu.queue, pipelines, &casters, settings, capacities)?;
        gpu.check()?;
        Ok(Self { gpu, prepared, casters, method, budget, timer: Timer::new(gpu), settings: settings.clone() })
    }

    /// Renders one frame, running it again with larger lists, more bands or more rounds until nothing is left out.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for an impossible camera or light, [`crate::Error::Memory`] if the lists fit in no way, [`crate::Error::Gpu`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        let view = LightView::fit(&self.prepared.mesh, light, self.settings.map)?;
        view.check()?;
        let bounds = self.prepared.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let mut runs = 0;
        loop {
            runs += 1;
            self.method.prepare(&self.gpu.queue, &self.casters, camera, light, &view, bounds)?;
            let (dispatches, wall_ms) = self.run_once()?;
            let words = self.method.status().read(self.gpu)?;
            let limits = self.gpu.device.limits();
            let wanted = growth::wanted(&words, self.method.capacities(), &self.settings, &limits, self.budget.bytes)?;
            if let Some(wanted) = wanted {
                log::info!("lists overflowed: running again with {wanted:?}");
                self.method.resize(&self.gpu.device, &self.gpu.queue, wanted)?;
                self.gpu.check()?;
                continue;
            }
            return self.read(&words, runs, dispatches, wall_ms);
        }
    }

    /// Records, submits and waits; returns dispatches and milliseconds.
    fn run_once(&mut self) -> Result<(u32, f64)> {
        let mut encoder = self.gpu.encoder();
        if let Some(timer) = &mut self.timer {
            timer.reset();
        }
        let mut recorder = Recorder::new(&self.gpu.device, &mut encoder, self.timer.as_mut());
        self.method.record(&mut recorder, &self.casters)?;
        let dispatches = recorder.dispatches();
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder);
        }
        let start = Instant::now();
        self.gpu.submit_and_wait(encoder)?;
        Ok((dispatches, start.elapsed().as_secs_f64() * 1e3))
    }

    fn read(&self, words: &[u32], runs: u32, dispatches: u32, wall_ms: f64) -> Result<Output> {
        let now = self.method.capacities();
        Ok(Output {
            visibility: self.method.visibility().read(self.gpu)?,
            lit: self.method.lit().read(self.gpu)?,
            words: self.settings.samples.words(),
            triangles: self.method.id_keys().read(self.gpu)?.into_iter().map(|key| !key).collect(),
            counts: growth::counts(words, now),
            lists: growth::lists(words, now, self.settings.facets, runs),
            stages: self.timer.as_ref().map_or(Ok(Vec::new()), |t| t.read(self.gpu))?,
            wall_ms,
            dispatches,
        })
    }

    /// The method, for looking at its buffers.
    pub fn method(&self) -> &FacetMasks {
        &self.method
    }
}
