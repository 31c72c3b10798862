//! Measuring rows.

use super::row::{ListRow, Row, Timing};
use super::variant::ReportVariant;
use crate::report::course::{Course, Flicker, beside};
use crate::report::metrics::SHOWN;
use crate::report::{FacetSet, SceneErrors, TracedScene};
use crate::scene::Scene;
use oracle::truth::{Progress, SceneTruth, Tracer};
use std::collections::{BTreeMap, BTreeSet};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Prepared, Settings};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Output, Renderer};

/// A scene with its truths at one image size, each traced when it is first asked for.
pub struct SceneCase {
    /// The scene.
    pub scene: Scene,
    /// Options that it was opened with, for its rows to tell.
    pub view: String,
    /// How often its triangles were split into four.
    pub tessellation: u32,
    /// Its mesh as the methods take it.
    pub prepared: Prepared,
    /// Image size.
    pub size: [u32; 2],
    tracer: Tracer,
    traced: BTreeMap<u32, TracedScene>,
    converged: Option<Vec<f32>>,
}

impl SceneCase {
    /// Splits the triangles of `scene`, prepares its mesh and builds what rays need.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Mesh`] if the mesh cannot be used.
    pub fn new(mut scene: Scene, tessellation: u32, size: [u32; 2]) -> Result<Self> {
        scene.mesh.check(&scene.name)?;
        for _ in 0..tessellation {
            scene.mesh = scene.mesh.split_in_four();
            scene.mesh.check(&scene.name)?;
        }
        let prepared = scene.prepared()?;
        let tracer = Tracer::of(&prepared)?;
        Ok(Self {
            scene,
            view: String::new(),
            tessellation,
            prepared,
            size,
            tracer,
            traced: BTreeMap::new(),
            converged: None,
        })
    }

    /// Scene truth at the samples of `settings`.
    ///
    /// # Errors
    /// As [`TracedScene::new`].
    pub fn matched(&mut self, settings: &Settings, progress: Progress) -> Result<&TracedScene> {
        let n = settings.samples.count();
        if !self.traced.contains_key(&n) {
            let (camera, light) = (&self.scene.camera, &self.scene.light);
            let traced = TracedScene::new(&self.tracer, camera, light, settings, progress)?;
            self.traced.insert(n, traced);
        }
        Ok(&self.traced[&n])
    }

    /// Visibility of 1024 rays a pixel.
    ///
    /// # Errors
    /// As [`SceneTruth::new`].
    pub fn converged(&mut self, settings: &Settings, progress: Progress) -> Result<&[f32]> {
        let pixels = match self.converged.take() {
            Some(pixels) => pixels,
            None => {
                let [w, h] = self.size;
                let (camera, light) = (&self.scene.camera, &self.scene.light);
                let truth = SceneTruth::new(&self.tracer, camera, light, &settings.samples, w, h)?;
                truth.converged(progress).into_iter().map(|(v, _)| v).collect()
            }
        };
        Ok(self.converged.insert(pixels))
    }

    /// Key of a row, known before it is measured.
    pub fn row(&self, variant: &ReportVariant) -> Row {
        Row {
            scene: self.scene.name.clone(),
            view: self.view.clone(),
            tessellation: self.tessellation,
            triangles: self.prepared.mesh().triangles.len() as u64,
            size: variant.settings.size,
            map: variant.settings.map,
            method: variant.method.name().to_owned(),
            setting: variant.setting.clone(),
            samples: variant.settings.samples.count(),
            ..Row::default()
        }
    }

    /// The row of tracing as many rays as there are samples, as a method without time: the error that sampling leaves.
    ///
    /// # Errors
    /// As [`SceneCase::matched`].
    pub fn row_of_truth(&mut self, settings: &Settings, progress: Progress) -> Result<Row> {
        let picture = self.matched(settings, progress)?.visibility().to_vec();
        let (matched, converged) = self.errors(settings, &picture, progress)?;
        let like = ReportVariant { method: MethodName::FacetMasks, setting: String::new(), settings: settings.clone() };
        Ok(Row { method: Self::TRUTH.to_owned(), matched, converged, ..self.row(&like) })
    }

    /// The method name of [`SceneCase::row_of_truth`].
    pub const TRUTH: &'static str = "scene-truth";

    /// A picture against rays through its samples.
    ///
    /// # Errors
    /// As [`SceneCase::matched`].
    pub fn matched_errors(&mut self, settings: &Settings, visibility: &[f32]) -> Result<SceneErrors> {
        self.matched(settings, None)?.errors(visibility)
    }

    /// A picture against both truths.
    ///
    /// # Errors
    /// As [`SceneCase::matched`].
    pub fn errors(
        &mut self,
        settings: &Settings,
        visibility: &[f32],
        progress: Progress,
    ) -> Result<(SceneErrors, SceneErrors)> {
        let matched = self.matched(settings, progress)?.errors(visibility)?;
        let ([w, h], n) = (self.size, settings.samples.count());
        let converged = SceneErrors::against(w, h, n, self.converged(settings, progress)?, visibility)?;
        Ok((matched, converged))
    }
}

/// A method set up for one scene as the plan has it.
fn subject<'a>(gpu: &'a Gpu, case: &SceneCase, variant: &ReportVariant, budget: Budget) -> Result<Renderer<'a>> {
    let (scene, prepared) = (&case.scene, &case.prepared);
    let plan = Plan::of_method(variant.method, prepared, &scene.camera, &scene.light, &variant.settings, false)?;
    Renderer::of_plan(gpu, prepared, variant.method, &plan, budget)
}

fn render(subject: &mut Renderer, case: &SceneCase) -> Result<Output> {
    subject.render(&case.scene.camera, &case.scene.light)
}

/// How rows are measured.
pub struct Measuring<'a> {
    /// Where.
    pub gpu: &'a Gpu,
    /// Frames of each row that count; one more comes first and does not, whatever it takes: it compiles.
    pub repeats: u32,
    /// Milliseconds after which a row has frames enough, fewer than `repeats` but one at the least.
    pub row_ms: f64,
    /// Memory of lists.
    pub budget: Budget,
}

/// A row with its picture.
pub struct Measured {
    /// The row, without errors.
    pub row: Row,
    /// Visibility of each pixel; empty where the row failed.
    pub visibility: Vec<f32>,
}

impl Measuring<'_> {
    /// Rows that are measured together: so many that memory suffices.
    pub const GROUP: usize = 5;

    /// Measures a group of variants in interleaved rounds, with `reference` in each of them. A variant that the scene or
    /// the memory does not allow becomes a row that says so.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Gpu`] if the device fails, and what the reference fails of.
    pub fn measure(
        &self,
        case: &SceneCase,
        reference: &ReportVariant,
        group: &[ReportVariant],
    ) -> Result<Vec<Measured>> {
        let mut first = subject(self.gpu, case, reference, self.budget)?;
        render(&mut first, case)?;
        let mut subjects = Vec::new();
        let mut rows = Vec::new();
        for variant in group {
            let mut row = case.row(variant);
            let mut visibility = Vec::new();
            match self.set_up(case, variant, &mut row) {
                Ok((subject, output)) => {
                    visibility = output.visibility;
                    subjects.push((rows.len(), subject, Vec::new()));
                }
                Err(error) if error.is_gpu() => return Err(error),
                Err(error) => row.failed = Some(error.to_string()),
            }
            rows.push(Measured { row, visibility });
        }
        let mut of_reference = Vec::new();
        for round in 0..self.repeats {
            of_reference.push(timing(render(&mut first, case)?));
            // Each other round the other way about, so that no row always follows the same one.
            let mut order: Vec<usize> = (0..subjects.len()).collect();
            if round % 2 == 1 {
                order.reverse();
            }
            for k in order {
                let (_, subject, times) = &mut subjects[k];
                if times.is_empty() || spent(times) < self.row_ms {
                    times.push(timing(render(subject, case)?));
                }
            }
        }
        for (row, _, times) in &subjects {
            rows[*row].row.take_times(times, &of_reference);
        }
        Ok(rows)
    }

    /// Flicker of a group of variants while the camera goes aside by `steps` pixels at its target, one a frame; `None` where the scene or the memory does not allow one.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Gpu`] if the device fails, and as [`SceneTruth::new`].
    pub fn flicker(&self, case: &SceneCase, group: &[ReportVariant], steps: u32) -> Result<Vec<Option<Flicker>>> {
        let light = &case.scene.light;
        let mut found = Vec::new();
        for variant in group {
            match subject(self.gpu, case, variant, self.budget) {
                Ok(subject) => found.push(Some((subject, Course::default()))),
                Err(error) if error.is_gpu() => return Err(error),
                Err(_) => found.push(None),
            }
        }
        let [w, h] = case.size;
        // Of each number of samples the last truth and the one before.
        let mut truths: BTreeMap<u32, [Vec<f32>; 2]> = BTreeMap::new();
        for k in 0..=steps {
            let camera = beside(&case.scene.camera, h, 10 * k);
            let mut traced = BTreeSet::new();
            for (place, variant) in found.iter_mut().zip(group) {
                let Some((subject, course)) = place else { continue };
                let samples = &variant.settings.samples;
                let [truth, before] = truths.entry(samples.count()).or_default();
                if traced.insert(samples.count()) {
                    let now = SceneTruth::new(&case.tracer, &camera, light, samples, w, h)?.image(None);
                    *before = std::mem::replace(truth, now.visibility());
                }
                match subject.render(&camera, light) {
                    Ok(output) => course.add(output.visibility, truth, before),
                    Err(error) if error.is_gpu() => return Err(error),
                    Err(_) => *place = None,
                }
            }
        }
        Ok(found.into_iter().map(|place| place.and_then(|(_, course)| course.flickers())).collect())
    }

    /// One frame of a variant, unmeasured; `None` where the scene or the memory does not allow it.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Gpu`] if the device fails.
    pub fn picture(&self, case: &SceneCase, variant: &ReportVariant) -> Result<Option<Vec<f32>>> {
        match subject(self.gpu, case, variant, self.budget).and_then(|mut s| render(&mut s, case)) {
            Ok(output) => Ok(Some(output.visibility)),
            Err(error) if error.is_gpu() => Err(error),
            Err(_) => Ok(None),
        }
    }

    /// Sets up a variant and renders its first frame, in which lists grow.
    fn set_up<'c>(
        &'c self,
        case: &'c SceneCase,
        variant: &ReportVariant,
        row: &mut Row,
    ) -> Result<(Renderer<'c>, Output)> {
        let before = self.allocated();
        let mut subject = subject(self.gpu, case, variant, self.budget)?;
        let output = render(&mut subject, case)?;
        row.memory = before.zip(self.allocated()).map(|(before, after)| after.saturating_sub(before));
        row.counts = output.counts;
        row.views = subject.views();
        let partly = output.visibility.iter().filter(|v| (SHOWN..=1.0 - SHOWN).contains(*v)).count();
        row.partly_lit = partly as f64 / output.visibility.len().max(1) as f64;
        row.lists = output.lists.iter().map(ListRow::from).collect();
        let facets = FacetSet::read(self.gpu, subject.facets(), variant.settings.samples.words())?;
        row.boundary = facets.boundary();
        Ok((subject, output))
    }

    /// Bytes of GPU memory in use, where the driver says.
    fn allocated(&self) -> Option<u64> {
        self.gpu.device.generate_allocator_report().map(|report| report.total_allocated_bytes)
    }
}

fn spent(times: &[Timing]) -> f64 {
    times.iter().map(|t| t.wall_ms).sum()
}

fn timing(output: Output) -> Timing {
    Timing { stages: output.stages, wall_ms: output.wall_ms }
}
