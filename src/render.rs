//! Frames that are rendered by themselves and read back: a device, a [`ShadowPass`] and readback.

use crate::gpu::{BufferMemory, Gpu, KeptPrograms, StageTime};
use crate::light_view::MapTiles;
#[cfg(feature = "baselines")]
use crate::methods::DebugViews;
use crate::methods::facet_masks::{Extent, Pipelines};
pub use crate::methods::output::{Budget, Counts, ListUse, Output};
use crate::methods::strip_method::{MethodPipelines, StripMethod};
pub use crate::methods::strips::{Rows, Strips};
use crate::methods::{HistorySettings, MethodName, Prepared, Settings};
use crate::pass::judge::depths_of_both;
use crate::pass::{FrameStatus, Inputs, ShadowPass, Target};
use crate::plan::Plan;
use crate::scene::{Camera, Light};
use crate::{Error, Result};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A method set up for one mesh and one setting, to be rendered again and again.
///
/// Each frame is that of a [`ShadowPass`] of casters that stand, run again with larger lists, more bands, rounds or strips until nothing
/// is left out. Strips of rows are submitted one by one.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    settings: Settings,
    extent: Extent,
    /// `None` where nothing is to be computed.
    pass: Option<ShadowPass>,
    /// The last camera, and between which depths it sees casters, where slices are cut there.
    depths: Option<(Camera, Option<[f32; 2]>)>,
}

/// Looks at the method after each strip.
pub type StripLook<'a> = &'a mut dyn FnMut(&StripMethod, Rows) -> Result<()>;

/// A strip that was rendered.
struct Strip {
    status: FrameStatus,
    wall_ms: f64,
    runs: u32,
}

impl<'a> Renderer<'a> {
    /// Uploads the mesh and builds pipelines and memory of `facet-masks`.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn new(gpu: &'a Gpu, prepared: &Prepared, settings: &Settings, budget: Budget) -> Result<Self> {
        Self::of_method(gpu, prepared, MethodName::FacetMasks, settings, budget)
    }

    /// Uploads the mesh and builds pipelines and memory of a method.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn of_method(
        gpu: &'a Gpu,
        prepared: &Prepared,
        method: MethodName,
        settings: &Settings,
        budget: Budget,
    ) -> Result<Self> {
        KeptPrograms::once(|| {
            let (omni, alpha_tested) = (method.omni(settings), !prepared.alpha().is_empty());
            let settings = &Settings { omni, alpha_tested, ..settings.clone() };
            settings.check()?;
            let pipelines = MethodPipelines::new(&gpu.device, method, settings, false)?;
            Self::with(gpu, prepared, settings, budget, pipelines, 1)
        })
    }

    /// As [`Renderer::of_method`], of no more than a plan asks for. Where nothing casts a shadow all methods are the facets of `facet-masks`,
    /// lit or dark.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn of_plan(gpu: &'a Gpu, prepared: &Prepared, method: MethodName, plan: &Plan, budget: Budget) -> Result<Self> {
        let Plan { extent, ref settings, .. } = *plan;
        match extent {
            Extent::Nothing => Ok(Self { gpu, settings: settings.clone(), extent, pass: None, depths: None }),
            Extent::Facing => Self::facing(gpu, prepared, settings),
            Extent::Everything => Self::of_method(gpu, prepared, method, settings, budget),
        }
    }

    /// Frames in which it is known that nothing casts a shadow: what pixels see and whether that faces the light.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn facing(gpu: &'a Gpu, prepared: &Prepared, settings: &Settings) -> Result<Self> {
        settings.check()?;
        // No caster is tested: neither map nor lists are asked.
        let alpha_tested = !prepared.alpha().is_empty();
        let settings = Settings { map: 1, facets: crate::methods::FacetMode::One, alpha_tested, ..settings.clone() };
        let budget = Budget { start: Some(1), ..Budget::default() };
        let pipelines = Pipelines::facing(&gpu.device, &settings);
        let made = Self::with_pipelines(gpu, prepared, &settings, budget, Arc::new(pipelines))?;
        Ok(Self { extent: Extent::Facing, ..made })
    }

    /// Uploads the mesh and makes memory of `facet-masks`, with pipelines that exist already.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn with_pipelines(
        gpu: &'a Gpu,
        prepared: &Prepared,
        settings: &Settings,
        budget: Budget,
        pipelines: Arc<Pipelines>,
    ) -> Result<Self> {
        Self::in_strips(gpu, prepared, settings, budget, pipelines, 1)
    }

    /// As [`Renderer::with_pipelines`], in at least so many strips of rows.
    ///
    /// # Errors
    /// As [`ShadowPass::new`].
    pub fn in_strips(
        gpu: &'a Gpu,
        prepared: &Prepared,
        settings: &Settings,
        budget: Budget,
        pipelines: Arc<Pipelines>,
        strips: u32,
    ) -> Result<Self> {
        Self::with(gpu, prepared, settings, budget, MethodPipelines::FacetMasks(pipelines), strips)
    }

    fn with(
        gpu: &'a Gpu,
        prepared: &Prepared,
        settings: &Settings,
        budget: Budget,
        pipelines: MethodPipelines,
        strips: u32,
    ) -> Result<Self> {
        let pass = ShadowPass::of_prepared(gpu, prepared, settings, pipelines, budget, strips)?;
        Ok(Self { gpu, settings: settings.clone(), extent: Extent::Everything, pass: Some(pass), depths: None })
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// [`Error::Scene`] for an impossible camera or light, [`Error::Memory`] if the lists fit in no way, [`Error::Limit`], [`Error::Gpu`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        self.render_and(camera, light, &mut |_, _| Ok(()))
    }

    /// As [`Renderer::render`], and lets `look` see the method after each strip of rows; from row 0 on once more, with other
    /// rows, where strips turned out too large.
    ///
    /// # Errors
    /// As [`Renderer::render`], and those of `look`.
    pub fn render_and(&mut self, camera: &Camera, light: &Light, look: StripLook) -> Result<Output> {
        self.render_points(camera, &[*light], look)
    }

    /// Renders the mean over some points of a light ([`AreaLight::points`](crate::scene::AreaLight::points)): its visibility. Lit masks and counts are of
    /// the last point, times and dispatches of all.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Config`] without a point.
    pub fn render_mean(&mut self, camera: &Camera, points: &[Light]) -> Result<Output> {
        self.render_points(camera, points, &mut |_, _| Ok(()))
    }

    fn render_points(&mut self, camera: &Camera, points: &[Light], look: StripLook) -> Result<Output> {
        let (gpu, settings, extent) = (self.gpu, &self.settings, self.extent);
        let Some(pass) = &mut self.pass else { return Ok(Output::nothing_seen(settings)) };
        let first = points.first().ok_or_else(|| Error::Config("a light without points".to_owned()))?;
        let mut inputs = Inputs::new(camera, first);
        if settings.tells_depths() && extent == Extent::Everything {
            if self.depths.is_none_or(|(of, _)| of != *camera) {
                // A frame runs again, cut by the depths that it found.
                self.depths = Some((*camera, seen_depths(gpu, pass, &inputs, points)?));
            }
            inputs.depths = self.depths.and_then(|(_, depths)| depths);
        }
        let history = settings.history.filter(|history| history.frames > 0 && pass.method().keeps_history());
        if let Some(HistorySettings { frames, .. }) = history {
            pass.forget_history();
            for _ in 1..frames {
                render_strip(gpu, pass, &inputs, points, (extent, 0))?;
            }
        }
        'image: loop {
            let mut image: Option<Output> = None;
            for (k, rows) in (0..).zip(pass.image_strips().rows()) {
                let Some(strip) = render_strip(gpu, pass, &inputs, points, (extent, k))? else { continue 'image };
                look(pass.method(), rows)?;
                let output = read(gpu, settings, pass.method(), strip)?;
                match &mut image {
                    None => image = Some(output),
                    Some(image) => image.add_rows(output, rows),
                }
            }
            return image.ok_or_else(|| Error::Config("an image without rows".to_owned()));
        }
    }

    /// As [`Renderer::render`], and what there is to look at besides the picture; `None` where the method keeps neither
    /// classes nor a map.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    #[cfg(feature = "baselines")]
    pub fn render_and_look(&mut self, camera: &Camera, light: &Light) -> Result<(Output, Option<DebugViews>)> {
        let (gpu, width, mut looks) = (self.gpu, self.settings.size[0], DebugViews::default());
        let output = self.render_and(camera, light, &mut |method, rows| looks.add_rows(gpu, method, width, rows))?;
        Ok((output, (looks != DebugViews::default()).then_some(looks)))
    }

    /// The method as the last strip left it; `None` where nothing is computed.
    pub fn method(&self) -> Option<&StripMethod> {
        self.pass.as_ref().map(ShadowPass::method)
    }

    /// The facets of the last strip, where the method has them.
    pub fn facets(&self) -> Option<&crate::stages::facet_classify::Facets> {
        self.method().and_then(StripMethod::facets)
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
        let of = |pass: &ShadowPass| pass.method().views() / pass.map_tiles().across().pow(2);
        self.pass.as_ref().map_or(0, of)
    }

    /// Parts into which the light's map is cut.
    pub fn parts(&self) -> MapTiles {
        let none = || MapTiles::new(self.settings.map, std::num::NonZeroU32::MIN);
        self.pass.as_ref().map_or_else(none, ShadowPass::map_tiles)
    }

    /// Strips of rows in which the image is rendered.
    pub fn strips(&self) -> u32 {
        self.pass.as_ref().map_or(1, ShadowPass::strips)
    }

    /// As [`ShadowPass::memory`].
    pub fn memory(&self) -> Vec<BufferMemory> {
        self.pass.as_ref().map_or_else(Vec::new, ShadowPass::memory)
    }
}

/// Between which depths a camera sees casters, of a frame that is not looked at otherwise.
fn seen_depths(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs, points: &[Light]) -> Result<Option<[f32; 2]>> {
    'image: loop {
        let mut all = None;
        for (k, _) in (0..).zip(pass.image_strips().rows()) {
            let strip = render_strip(gpu, pass, inputs, &points[..1], (Extent::Everything, k))?;
            let Some(Strip { status, .. }) = strip else { continue 'image };
            all = depths_of_both(all, status.depths);
        }
        return Ok(all);
    }
}

/// One strip; `None` if its lists fit no binding, and there are more strips now.
fn render_strip(
    gpu: &Gpu,
    pass: &mut ShadowPass,
    inputs: &Inputs,
    points: &[Light],
    (extent, strip): (Extent, u32),
) -> Result<Option<Strip>> {
    let (mut runs, mut wall_ms) = (0, 0.0);
    loop {
        runs += 1;
        let mut encoder = gpu.encoder();
        let part = (Some(strip), Some(extent));
        let frames = pass.record_points(&mut encoder, inputs, points, &Target::default(), part)?;
        let start = Instant::now();
        gpu.submit_and_wait(encoder)?;
        let took = start.elapsed().as_secs_f64() * 1e3;
        // Of a method without lists a second run is a part of the frame.
        wall_ms = if pass.method().is_fixed() { wall_ms + took } else { took };
        let status = status_of(pass, &frames)?;
        if let Some(error) = pass.take_failure() {
            return Err(error);
        }
        if status.complete {
            return Ok(Some(Strip { status, wall_ms, runs }));
        }
        if let Some(error) = status.error {
            return Err(Error::Gpu(error));
        }
        let strips = pass.image_strips();
        let grown = pass.grow()?;
        if !grown && !pass.method().is_fixed() {
            return Err(Error::Gpu(format!("frame {} is incomplete, and no list is to grow", status.frame)));
        }
        gpu.check()?;
        if grown {
            log::info!("lists overflowed: running again with {:?}", pass.capacities());
        }
        if pass.image_strips() != strips {
            log::info!("lists fit no binding: {} strips of rows", pass.strips());
            return Ok(None);
        }
    }
}

/// How frames came out that have run, taken together. Another thread that polls the device may still be telling.
fn status_of(pass: &mut ShadowPass, frames: &[u64]) -> Result<FrameStatus> {
    let mut all: Option<FrameStatus> = None;
    for &frame in frames {
        let mut own = status_of_one(pass, frame)?;
        if let Some(before) = all {
            own.complete &= before.complete;
            own.error = before.error.or(own.error);
            own.dispatches += before.dispatches;
            for stage in &mut own.stages {
                stage.gpu_ms += before.stages.iter().filter(|s| s.name == stage.name).map(|s| s.gpu_ms).sum::<f64>();
            }
            // Stages that ran for the first alone, which found the surfaces of all.
            let found = |s: &&StageTime| own.stages.iter().all(|own| own.name != s.name);
            let found: Vec<StageTime> = before.stages.iter().filter(found).cloned().collect();
            own.stages.splice(0..0, found);
        }
        all = Some(own);
    }
    all.ok_or_else(|| Error::Gpu("no frame was recorded".to_owned()))
}

fn status_of_one(pass: &mut ShadowPass, frame: u64) -> Result<FrameStatus> {
    for _ in 0..5000 {
        match pass.status() {
            Some(status) if status.frame == frame => return Ok(status),
            Some(_) => {}
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    Err(Error::Gpu(format!("nothing is known of frame {frame}, which was submitted")))
}

fn read(gpu: &Gpu, settings: &Settings, method: &StripMethod, strip: Strip) -> Result<Output> {
    let Strip { status, wall_ms, runs } = strip;
    let FrameStatus { counts, mut lists, stages, dispatches, .. } = status;
    lists.iter_mut().for_each(|list| list.runs = runs);
    #[cfg(feature = "baselines")]
    let counts = match method.fixed().map_or(Ok(None), |fixed| fixed.method().counts(gpu))? {
        Some(own) => Counts { kept_triangles: counts.kept_triangles, ..own },
        None => counts,
    };
    Ok(Output {
        visibility: method.visibility().read(gpu)?,
        lit: method.lit().map_or(Ok(Vec::new()), |lit| lit.read(gpu))?,
        words: settings.samples.words(),
        triangles: method.id_keys().read(gpu)?.into_iter().map(|key| !key).collect(),
        counts,
        lists,
        stages,
        wall_ms,
        dispatches,
    })
}
