//! Computing one frame of `facet-masks` on the GPU and reading it back: records, submits, looks at what the lists needed,
//! grows them and runs again until nothing is left out.

use super::facet_masks::{Capacities, FacetMasks, FacetSource, MapSource, Pipelines, Settings};
use super::list_sizing::{self, Needs};
use super::prepared::{CasterBuffers, Prepared};
use super::settings::LastView;
use super::strips::{Rows, Strips};
use crate::gpu::{Gpu, Recorder, StageTime, Timer};
use crate::light_view::{LightView, MapTiles};
use crate::scene::{Camera, Light};
use crate::status::Status;
use crate::{Error, Result};
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;

/// Counts of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Pixels whose samples were searched one by one; 0 with one facet a pixel.
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
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
    /// Lit samples of each pixel, `words` words each; all ones where nothing is seen. Empty for methods that keep none
    /// ([`MethodName::keeps`](super::MethodName::keeps)). With one facet a pixel samples off the surface
    /// are lit where the pixel is settled as lit, and not where it is evaluated.
    pub lit: Vec<u32>,
    /// Words of a mask.
    pub words: u32,
    /// Triangle of the prepared mesh at each pixel centre; `u32::MAX` where there is none.
    pub triangles: Vec<u32>,
    /// Counters.
    pub counts: Counts,
    /// The lists.
    pub lists: Vec<ListUse>,
    /// GPU time of each stage of the last run, of all strips; empty without time stamps.
    pub stages: Vec<StageTime>,
    /// Milliseconds from submission to the end of the last run, of all strips.
    pub wall_ms: f64,
    /// Dispatches recorded for the last run, of all strips.
    pub dispatches: u32,
}

/// How long the lists are at first, and how much those of pairs may take at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Elements each list that may grow starts with, up to 2^32; `None`: a guess from the image size.
    pub start: Option<usize>,
    /// Bytes the lists of pairs and of candidates may take together, from the first frame on, with what it takes to sort them; a frame
    /// that needs more is split into bands of facets.
    pub bytes: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { start: None, bytes: 1 << 30 }
    }
}

/// A method set up for one mesh and one setting, to be rendered again and again.
///
/// An image whose facets do not fit what the device can bind is rendered in strips of rows, one after the other, with the
/// same samples as in one piece. What the light sees is found once, if it has one view. A map that does not fit is cut into
/// [`MapTiles`], each a view of its own, which all strips go through.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    prepared: &'a Prepared,
    casters: CasterBuffers,
    pipelines: Arc<Pipelines>,
    method: FacetMasks,
    strips: Strips,
    parts: MapTiles,
    budget: Budget,
    timer: Option<Timer>,
    settings: Settings,
    view: LastView,
    /// How often something was run: each run has a stamp of its own.
    runs: u32,
}

/// Looks at the method after each strip.
pub type StripLook<'a> = &'a mut dyn FnMut(&FacetMasks, Rows) -> Result<()>;

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
        Self::in_strips(gpu, prepared, settings, budget, pipelines, 1)
    }

    /// As [`Renderer::with_pipelines`], in at least so many strips of rows.
    ///
    /// # Errors
    /// As [`FacetMasks::new`].
    pub fn in_strips(
        gpu: &'a Gpu,
        prepared: &'a Prepared,
        settings: &Settings,
        budget: Budget,
        pipelines: Arc<Pipelines>,
        strips: u32,
    ) -> Result<Self> {
        settings.check()?;
        let casters = prepared.upload(&gpu.device, &gpu.queue)?;
        let strips = Strips::new(settings.size, strips);
        let parts = MapTiles::within(settings.map, &gpu.device.limits());
        let (strips, method) = fitting(gpu, &casters, &settings.of_part(parts), budget, &pipelines, strips)?;
        gpu.check()?;
        let (timer, settings) = (Timer::new(gpu)?, settings.clone());
        let view = LastView::default();
        Ok(Self { gpu, prepared, casters, pipelines, method, strips, parts, budget, timer, settings, view, runs: 0 })
    }

    /// Renders one frame, running it again with larger lists, more bands, rounds or strips until nothing is left out.
    ///
    /// # Errors
    /// [`Error::Scene`] for an impossible camera or light, [`Error::Memory`] if the lists fit in no way, [`Error::Gpu`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        self.render_and(camera, light, &mut |_, _| Ok(()))
    }

    /// As [`Renderer::render`], and lets `look` see the method after each strip of rows; from row 0 on once more, with other
    /// rows, where strips turned out too large.
    ///
    /// # Errors
    /// As [`Renderer::render`], and those of `look`.
    pub fn render_and(&mut self, camera: &Camera, light: &Light, look: StripLook) -> Result<Output> {
        let views = self.parts.of(self.view.all_of(&self.settings, self.prepared, light)?);
        'image: loop {
            let mut image: Option<Output> = None;
            for rows in self.strips.rows() {
                let Some(output) = self.strip(camera, light, &views, rows)? else { continue 'image };
                look(&self.method, rows)?;
                match &mut image {
                    None => image = Some(output),
                    Some(image) => image.add_rows(output, rows),
                }
            }
            return image.ok_or_else(|| Error::Config("an image without rows".to_owned()));
        }
    }

    /// One strip; `None` if its lists fit no binding, and there are more strips now.
    fn strip(&mut self, camera: &Camera, light: &Light, views: &[LightView], rows: Rows) -> Result<Option<Output>> {
        let bounds = self.prepared.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut runs = 0;
        let now = self.method.capacities();
        if now.views as usize != views.len() {
            self.method.resize(device, queue, Capacities { views: views.len() as u32, ..now })?;
        }
        loop {
            runs += 1;
            self.runs = self.runs.checked_add(1).unwrap_or(1);
            let (casters, strip, stamp) = (&self.casters, self.strips.strip(rows), self.runs);
            self.method.prepare(queue, casters, camera, light, views, bounds, strip, stamp)?;
            let maps = if rows.first == 0 { MapSource::Made } else { MapSource::Kept };
            let (dispatches, wall_ms) = self.run_once(maps)?;
            let status = Status::of(&self.method.status().read(self.gpu)?);
            if status.head.finished != self.runs {
                return Err(Error::Gpu("a frame was submitted, and did not run to its end".to_owned()));
            }
            let (now, limits) = (self.method.capacities(), device.limits());
            let needs = Needs::of(&status);
            let Some(wanted) = list_sizing::wanted(&needs, now, &self.settings, &limits, self.budget.bytes)? else {
                return self.read(&status, runs, dispatches, wall_ms).map(Some);
            };
            let triangles = self.prepared.mesh.triangles.len();
            let wanted = list_sizing::in_reach(&needs, now, wanted, &self.settings, self.budget.bytes, triangles)?;
            log::info!("lists overflowed: running again with {wanted:?}");
            match self.method.resize(device, queue, wanted) {
                Err(error @ Error::Memory { .. }) => {
                    let (more, settings) = (self.strips.more().ok_or(error)?, self.settings.of_part(self.parts));
                    (self.strips, self.method) =
                        fitting(self.gpu, &self.casters, &settings, self.budget, &self.pipelines, more)?;
                    log::info!("lists fit no binding: {} strips of rows", self.strips.count());
                    return Ok(None);
                }
                resized => resized?,
            }
            self.gpu.check()?;
        }
    }

    /// Records, submits and waits; returns dispatches and milliseconds.
    fn run_once(&mut self, maps: MapSource) -> Result<(u32, f64)> {
        let mut encoder = self.gpu.encoder();
        if let Some(timer) = &mut self.timer {
            timer.reset();
        }
        let mut recorder = Recorder::new(&self.gpu.device, &mut encoder, self.timer.as_mut());
        self.method.record_seen(&mut recorder, &self.casters, FacetSource::Found, maps)?;
        let dispatches = recorder.dispatches();
        if let Some(timer) = &self.timer {
            timer.resolve(&mut encoder);
        }
        let start = Instant::now();
        self.gpu.submit_and_wait(encoder)?;
        Ok((dispatches, start.elapsed().as_secs_f64() * 1e3))
    }

    fn read(&self, status: &Status, runs: u32, dispatches: u32, wall_ms: f64) -> Result<Output> {
        let now = self.method.capacities();
        Ok(Output {
            visibility: self.method.visibility().read(self.gpu)?,
            lit: self.method.lit().read(self.gpu)?,
            words: self.settings.samples.words(),
            triangles: self.method.id_keys().read(self.gpu)?.into_iter().map(|key| !key).collect(),
            counts: list_sizing::counts(status),
            lists: list_sizing::lists(&Needs::of(status), now, self.settings.facets, runs),
            stages: self.timer.as_ref().map_or(Ok(Vec::new()), |t| t.read(self.gpu))?,
            wall_ms,
            dispatches,
        })
    }

    /// The method as the last strip left it, for looking at its buffers.
    pub fn method(&self) -> &FacetMasks {
        &self.method
    }

    /// Where it runs.
    pub fn gpu(&self) -> &'a Gpu {
        self.gpu
    }

    /// Settings it is made for.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Views of the light in the last frame, not counting parts.
    pub fn views(&self) -> u32 {
        self.method.capacities().views / self.parts.across().pow(2)
    }

    /// Parts into which the light's map is cut.
    pub fn parts(&self) -> MapTiles {
        self.parts
    }

    /// Strips of rows in which the image is rendered.
    pub fn strips(&self) -> u32 {
        self.strips.count()
    }
}

/// The method with memory for one strip, of as many as it takes, but not fewer than `strips`.
fn fitting(
    gpu: &Gpu,
    casters: &CasterBuffers,
    settings: &Settings,
    budget: Budget,
    pipelines: &Arc<Pipelines>,
    mut strips: Strips,
) -> Result<(Strips, FacetMasks)> {
    loop {
        let settings = Settings { size: strips.size(), ..settings.clone() };
        let capacities = list_sizing::first(&settings, budget);
        match FacetMasks::new(&gpu.device, &gpu.queue, pipelines.clone(), casters, &settings, capacities) {
            Err(error @ Error::Memory { .. }) => strips = strips.more().ok_or(error)?,
            made => return made.map(|method| (strips, method)),
        }
    }
}
