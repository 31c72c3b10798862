//! Computing one frame of `facet-masks` on the GPU and reading it back: records, submits, looks at what the lists needed,
//! grows them and runs again until nothing is left out.

use super::facet_masks::{Capacities, FacetMasks, FacetMode, Pipelines, Settings, status};
use super::prepared::{CasterBuffers, Prepared};
use crate::gpu::{Gpu, Recorder, StageTime, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::candidate_pairs::ROUND_LENGTH;
use crate::stages::facet_classify::{Facet, State};
use crate::stages::sample_surfaces;
use crate::{Error, Result};
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
    /// Most bands a frame may be split into.
    pub const MAX_BANDS: u32 = 4096;
    /// Most rounds of triangles a texel may take.
    pub const MAX_ROUNDS: u32 = 256;
    /// Most rounds of triangles a pixel may take.
    pub const MAX_CAMERA_ROUNDS: u32 = 2048;

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
        let pixels = settings.pixels();
        let start = budget.start.unwrap_or((pixels * 2).clamp(1 << 12, 1 << 24));
        let all = settings.facets == FacetMode::All;
        let camera = |guess: usize| if all { budget.start.unwrap_or(guess.max(64)) } else { 0 };
        let capacities = Capacities {
            pixel_pairs: start,
            triangle_pairs: start,
            candidates: start,
            bands: 1,
            rounds: 1,
            facets: if all { camera(pixels * 3 / 2) } else { pixels },
            pixel_triangles: camera(pixels * 3),
            complex_pixels: camera(pixels / 4).min(pixels),
            camera_rounds: 1,
        };
        let method = FacetMasks::new(&gpu.device, &gpu.queue, pipelines, &casters, settings, capacities)?;
        gpu.check()?;
        Ok(Self { gpu, prepared, casters, method, budget, timer: Timer::new(gpu), settings: settings.clone() })
    }

    /// Renders one frame, running it again with larger lists, more bands or more rounds until nothing is left out.
    ///
    /// # Errors
    /// [`Error::Scene`] for an impossible camera or light, [`Error::Memory`] if the lists fit in no way, [`Error::Gpu`].
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
            if let Some(wanted) = self.wanted(&words)? {
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

    /// The capacities with which nothing is left out, if they are not the ones in use.
    fn wanted(&self, words: &[u32]) -> Result<Option<Capacities>> {
        let now = self.method.capacities();
        if let Some(wanted) = self.wanted_of_camera(words)? {
            return Ok(Some(wanted));
        }
        let [pixel_pairs, triangle_pairs, candidates, longest] = needs(words, now.bands);
        let rounds = (longest as u32).div_ceil(ROUND_LENGTH).max(1);
        if rounds > Self::MAX_ROUNDS {
            return Err(Error::Memory {
                what: format!("triangles of one texel ({longest} of them)"),
                needed: u64::from(rounds),
                limit: u64::from(Self::MAX_ROUNDS),
            });
        }
        let fits = pixel_pairs <= now.pixel_pairs as u64
            && triangle_pairs <= now.triangle_pairs as u64
            && candidates <= now.candidates as u64;
        if fits && rounds <= now.rounds {
            return Ok(None);
        }
        let mut wanted = Capacities { rounds: rounds.max(now.rounds), ..now };
        let limits = self.gpu.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let grown = |need: u64, have: usize| if need > have as u64 { need + need / 8 } else { have as u64 };
        let (p, t) = (grown(pixel_pairs, now.pixel_pairs), grown(triangle_pairs, now.triangle_pairs));
        let c = grown(candidates, now.candidates);
        let bytes = p * 8 + t * 4 + c * 12;
        if bytes > self.budget.bytes || p * 8 > binding || t * 4 > binding || c * 8 > binding {
            if now.bands >= Self::MAX_BANDS {
                return Err(Error::Memory { what: "pair lists".to_owned(), needed: bytes, limit: self.budget.bytes });
            }
            // As many as it takes if the need spreads evenly; then twice as many each time.
            let share = bytes.div_ceil(self.budget.bytes.min(binding).max(1)).next_power_of_two().clamp(2, 64) as u32;
            wanted.bands = (now.bands * share).min(Self::MAX_BANDS);
        } else {
            (wanted.pixel_pairs, wanted.triangle_pairs, wanted.candidates) = (p as usize, t as usize, c as usize);
        }
        Ok(Some(wanted))
    }

    /// The capacities with which the camera's lists hold every surface, if they are not the ones in use. What comes after
    /// these lists has seen a part of them only.
    fn wanted_of_camera(&self, words: &[u32]) -> Result<Option<Capacities>> {
        let now = self.method.capacities();
        if self.settings.facets == FacetMode::One {
            return Ok(None);
        }
        let rounds = words[status::LONGEST_PIXEL].div_ceil(sample_surfaces::ROUND_LENGTH).max(1);
        if rounds > Self::MAX_CAMERA_ROUNDS {
            return Err(Error::Memory {
                what: format!("triangles of one pixel ({} of them)", words[status::LONGEST_PIXEL]),
                needed: u64::from(rounds),
                limit: u64::from(Self::MAX_CAMERA_ROUNDS),
            });
        }
        let needs = camera_needs(words);
        let have = [now.pixel_triangles, now.complex_pixels, now.facets];
        let fits = needs.iter().zip(have).all(|(&need, have)| need <= have as u64);
        if fits && rounds <= now.camera_rounds {
            return Ok(None);
        }
        let grown = |k: usize| {
            let need = needs[k];
            if need > have[k] as u64 { (need + need / 8) as usize } else { have[k] }
        };
        // No more slack than one binding holds.
        let limits = self.gpu.device.limits();
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) as usize;
        let most_facets = (binding / size_of::<Facet>()).max(needs[2] as usize);
        Ok(Some(Capacities {
            pixel_triangles: grown(0),
            complex_pixels: grown(1).min(self.settings.pixels()),
            facets: grown(2).min(most_facets),
            camera_rounds: rounds.max(now.camera_rounds),
            ..now
        }))
    }

    fn read(&self, words: &[u32], runs: u32, dispatches: u32, wall_ms: f64) -> Result<Output> {
        let capacities = self.method.capacities();
        let [pixel_pairs, triangle_pairs, candidates, _] = needs(words, capacities.bands);
        let sum = |offset: usize| {
            (0..capacities.bands as usize)
                .map(|b| u64::from(words[status::BANDS + status::BAND_WORDS * b + offset]))
                .sum::<u64>()
        };
        let state = |s: State| u64::from(words[status::STATES + s as usize]);
        let counts = Counts {
            silhouette_edges: u64::from(words[status::EDGES]),
            silhouette_texels: u64::from(words[status::TEXELS]),
            silhouette_pixels: state(State::Undecided),
            pixel_texel_pairs: sum(0),
            triangle_texel_pairs: sum(2),
            candidate_tests: u64::from(words[status::TESTS]) | u64::from(words[status::TESTS + 1]) << 32,
            visibility_evaluations: sum(4),
            refined_evaluations: sum(5),
            facets: State::ALL.iter().map(|&s| state(s)).sum(),
            complex_pixels: u64::from(words[status::COMPLEX_PIXELS]),
            empty_facets: state(State::Empty),
            dark_facets: state(State::Dark),
            lit_facets: state(State::Lit),
            shadowed_facets: state(State::Shadowed),
        };
        let list = |name, needed, capacity: usize| ListUse { name, needed, capacity: capacity as u64, runs };
        let mut lists = vec![
            list("pixel_texel_pairs", pixel_pairs, capacities.pixel_pairs),
            list("triangle_texel_pairs", triangle_pairs, capacities.triangle_pairs),
            list("candidate_pairs", candidates, capacities.candidates),
        ];
        if self.settings.facets == FacetMode::All {
            let [triangles, complex, facets] = camera_needs(words);
            lists.push(list("pixel_triangles", triangles, capacities.pixel_triangles));
            lists.push(list("complex_pixels", complex, capacities.complex_pixels));
            lists.push(list("facets", facets, capacities.facets));
        }
        Ok(Output {
            visibility: self.method.visibility().read(self.gpu)?,
            lit: self.method.lit().read(self.gpu)?,
            words: self.settings.samples.words(),
            triangles: self.method.id_keys().read(self.gpu)?.into_iter().map(|key| !key).collect(),
            counts,
            lists,
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

/// Elements that the lists of the camera's side needed: triangles of pixels, complex pixels, facets.
fn camera_needs(words: &[u32]) -> [u64; 3] {
    [status::PIXEL_TRIANGLES, status::COMPLEX_PIXELS, status::FACETS]
        .map(|at| if words[at + 1] != 0 { u64::from(u32::MAX) } else { u64::from(words[at]) })
}

/// Pixel-texel pairs, triangle-texel pairs and candidates that the largest band needed, and the longest list of a texel.
fn needs(words: &[u32], bands: u32) -> [u64; 4] {
    let mut most = [0; 4];
    for b in 0..bands as usize {
        let first = status::BANDS + status::BAND_WORDS * b;
        let band = &words[first..first + status::BAND_WORDS];
        // A set flag: more than 2^32 pairs. No list can hold them, but those of a part of the facets may fit.
        let of = |count: u32, flag: u32| if flag != 0 { u64::from(u32::MAX) } else { u64::from(count) };
        let needed = [of(band[0], band[1]), of(band[2], band[3]), u64::from(band[4]), u64::from(band[6])];
        for (most, needed) in most.iter_mut().zip(needed) {
            *most = needed.max(*most);
        }
    }
    most
}
