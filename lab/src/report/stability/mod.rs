//! Numerical stability: stiff and extreme cases, each held against truth in every variant of every method.

pub mod cases;
mod page;
pub mod shapes;

pub use cases::{StiffCase, StiffFrame, cases};
pub use page::{HEAD, markdown, row, summary};

use crate::report::comparison::{Scope, variants as rows_of};
use crate::report::{FacetErrors, FacetSet, Promise, SceneErrors, SeenErrors, TracedScene};
use oracle::truth::Tracer;
use serde::Serialize;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, ProjectionVariant, Settings};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Output, Renderer};
use subpixel_shadows::{Error, Result};

/// A way to compute the shadows.
#[derive(Clone, Debug)]
pub struct StabilityVariant {
    /// Its name: of `facet-masks` the settings alone, of another method its name before them.
    pub name: String,
    /// The method.
    pub method: MethodName,
    /// Its promise for every sample.
    pub promise: Promise,
    settings: Settings,
}

impl StabilityVariant {
    fn new(name: String, method: MethodName, settings: Settings) -> Self {
        Self { name, method, promise: Promise::of(method, &settings), settings }
    }
}

/// The variants of some methods that are compared. Of `facet-masks` there are one facet a pixel, several, the table of masks, and the
/// paper's two projections; of another method its defaults.
///
/// # Errors
/// [`Error::Config`] for settings that cannot be.
pub fn variants(settings: &Settings, methods: &[MethodName]) -> Result<Vec<StabilityVariant>> {
    let [one, all] = [FacetMode::One, FacetMode::All].map(|facets| Settings { facets, ..settings.clone() });
    let table = Settings { masks: MaskVariant::TABLE, ..one.clone() };
    let two_step = Settings { projection: ProjectionVariant::TwoStep, ..one.clone() };
    let own = [
        ("facets=one", one),
        ("facets=all", all),
        ("facets=one masks=table", table),
        ("facets=one projection=two-step", two_step),
    ]
    .map(|(name, settings)| StabilityVariant::new(name.to_owned(), MethodName::FacetMasks, settings));
    let (wanted, others): (Vec<_>, Vec<_>) = methods.iter().partition(|m| **m == MethodName::FacetMasks);
    let (samples, maps) = (vec![settings.samples.count()], vec![settings.map]);
    let scope = Scope { methods: others, samples, maps, size: settings.size, all_settings: false };
    let others = rows_of(&scope)?.into_iter().map(|row| {
        let name = format!("{} {}", row.method.name(), row.setting).trim_end().to_owned();
        StabilityVariant::new(name, row.method, row.settings)
    });
    Ok(own.into_iter().filter(|_| !wanted.is_empty()).chain(others).collect())
}

/// How one step of a case went in one variant.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The case.
    pub case: &'static str,
    /// The step.
    pub step: String,
    /// The variant.
    pub variant: String,
    /// The method.
    pub method: &'static str,
    /// Its promise.
    pub promise: Promise,
    /// Triangles.
    pub triangles: usize,
    /// Why there is no picture: the one line that a user would see.
    pub refused: Option<String>,
    /// Against facet truth: the numeric error. Nothing is compared where the answer is of texels.
    pub facet: FacetErrors,
    /// Against seen truth: whether samples were given the surfaces they see. As `facet`.
    pub seen: SeenErrors,
    /// Against scene truth: the whole error.
    pub scene: SceneErrors,
    /// Values that are not finite or not in `[0, 1]`.
    pub not_a_share: usize,
    /// Whether a second frame has the same bits.
    pub repeats: bool,
    /// Whether the picture is that of the case's first step, bit for bit; `None` where it need not be.
    pub same_bits: Option<bool>,
    /// Sum of the stages' GPU time, milliseconds, of a second frame.
    pub gpu_ms: f64,
    /// Runs until all lists fitted.
    pub runs: u32,
    /// Evaluations, and those of them with 46 bits.
    pub evaluations: [u64; 2],
}

impl Outcome {
    fn new(case: &StiffCase, step: &StiffFrame, variant: &StabilityVariant) -> Self {
        Self {
            case: case.name,
            step: step.label.clone(),
            variant: variant.name.clone(),
            method: variant.method.name(),
            promise: variant.promise,
            triangles: step.mesh.triangles.len(),
            refused: None,
            facet: FacetErrors::default(),
            seen: SeenErrors::default(),
            scene: SceneErrors::default(),
            not_a_share: 0,
            repeats: true,
            same_bits: None,
            gpu_ms: 0.0,
            runs: 0,
            evaluations: [0; 2],
        }
    }

    /// Whether it is what it has to be: no sample wrong outside the ambiguity band where that is promised, none on another surface than it
    /// sees, shares that are shares, and the same bits where they must be.
    pub fn holds(&self) -> bool {
        let exact = self.promise != Promise::Exact || self.facet.facet_wrong_outside_band == 0;
        exact && self.seen.seen_wrong == 0 && self.not_a_share == 0 && self.repeats && self.same_bits != Some(false)
    }
}

/// Truth of a step, traced once for all variants.
struct Traced {
    prepared: Prepared,
    tracer: Tracer,
    scene: TracedScene,
}

impl Traced {
    fn new(step: &StiffFrame, settings: &Settings) -> Result<Self> {
        step.mesh.check(&step.label)?;
        let prepared = Prepared::new(&step.mesh)?;
        let tracer = Tracer::of(&prepared)?;
        let scene = TracedScene::new(&tracer, &step.camera, &step.light, settings, None)?;
        Ok(Self { prepared, tracer, scene })
    }
}

/// Runs a case in all variants, step by step. Programs are taken from `kept`.
///
/// # Errors
/// [`Error::Gpu`] if the device fails. What the program refuses becomes an outcome that says so.
pub fn run(gpu: &Gpu, kept: &KeptPrograms, case: &StiffCase, variants: &[StabilityVariant]) -> Result<Vec<Outcome>> {
    let mut first: Vec<Option<Vec<f32>>> = vec![None; variants.len()];
    let mut outcomes = Vec::new();
    for step in &case.steps {
        let Some(any) = variants.first() else { break };
        let traced = Traced::new(step, &any.settings);
        for (variant, first) in variants.iter().zip(&mut first) {
            let mut outcome = Outcome::new(case, step, variant);
            let done = match &traced {
                Ok(traced) => kept.within(|| measure(gpu, step, traced, variant, &mut outcome)),
                Err(error) => Err(Error::Config(error.to_string())),
            };
            match done {
                Ok(visibility) if case.same_bits => {
                    let first = first.get_or_insert_with(|| visibility.clone());
                    outcome.same_bits = Some(same_bits(first, &visibility));
                }
                Ok(_) => {}
                Err(error) if error.is_gpu() => return Err(error),
                Err(error) => outcome.refused = Some(error.to_string()),
            }
            outcomes.push(outcome);
        }
    }
    Ok(outcomes)
}

fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

fn measure(
    gpu: &Gpu,
    step: &StiffFrame,
    traced: &Traced,
    variant: &StabilityVariant,
    outcome: &mut Outcome,
) -> Result<Vec<f32>> {
    let StiffFrame { camera, light, .. } = step;
    let wanted = Settings { map: step.map.unwrap_or(variant.settings.map), ..variant.settings.clone() };
    let plan = Plan::of_method(variant.method, &traced.prepared, camera, light, &wanted, false)?;
    let settings = &plan.settings;
    let words = settings.samples.words();
    let mut renderer = Renderer::of_plan(gpu, &traced.prepared, variant.method, &plan, step.budget)?;
    let (mut facets, width) = (FacetSet { words, ..FacetSet::default() }, settings.size[0]);
    let asked = variant.promise != Promise::Texels;
    let output = renderer.render_and(camera, light, &mut |method, rows| {
        if rows.first == 0 {
            facets = FacetSet { words, ..FacetSet::default() };
        }
        if asked { facets.add(gpu, method.facets(), words, width, rows) } else { Ok(()) }
    })?;
    if asked
        && variant.method != MethodName::FacetMasks
        && let Some(list) = renderer.facets()
    {
        facets = FacetSet::read(gpu, list, words)?;
    }
    // The first frame, which compiles, is not timed.
    let again = renderer.render(camera, light)?;
    outcome.repeats = same_bits(&output.visibility, &again.visibility);
    let output = Output { stages: again.stages, ..output };
    if asked {
        outcome.facet = FacetErrors::of(&facets, &traced.tracer, camera, light, settings, None)?;
        outcome.seen = SeenErrors::of(&facets, &traced.tracer, camera, settings, None)?;
    }
    outcome.scene = traced.scene.errors(&output.visibility)?;
    outcome.not_a_share = output.visibility.iter().filter(|v| !(0.0..=1.0).contains(*v)).count();
    outcome.gpu_ms = output.stages.iter().map(|s| s.gpu_ms).sum();
    outcome.runs = output.lists.iter().map(|l| l.runs).max().unwrap_or(1);
    outcome.evaluations = [output.counts.visibility_evaluations, output.counts.refined_evaluations];
    Ok(output.visibility)
}

/// The cases of these names; all without any.
///
/// # Errors
/// [`Error::Config`] for a name that no case has.
pub fn named(names: &[String]) -> Result<Vec<StiffCase>> {
    let all = cases();
    if let Some(unknown) = names.iter().find(|n| all.iter().all(|c| c.name != **n)) {
        let known: Vec<&str> = all.iter().map(|c| c.name).collect();
        return Err(Error::Config(format!("no case '{}'; there are {}", unknown.escape_debug(), known.join(", "))));
    }
    Ok(all.into_iter().filter(|c| names.is_empty() || names.iter().any(|n| n == c.name)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome() -> Outcome {
        let case = &named(&["contact".to_owned()]).unwrap()[0];
        let samples = subpixel_shadows::samples::Samples::new(Default::default(), 8).unwrap();
        let variants = variants(&Settings::new([8, 6], 8, samples), &[MethodName::FacetMasks]).unwrap();
        Outcome { step: "0".to_owned(), triangles: 2, runs: 1, ..Outcome::new(case, &case.steps[0], &variants[1]) }
    }

    fn page(o: Outcome) -> String {
        markdown("c", "m", &named(&["contact".to_owned()]).unwrap(), &[o])
    }

    #[test]
    fn each_fault_is_noticed() {
        assert!(outcome().holds() && Outcome { same_bits: Some(true), ..outcome() }.holds());
        let wrong = FacetErrors { facet_wrong_outside_band: 1, ..FacetErrors::default() };
        assert!(!Outcome { facet: wrong, ..outcome() }.holds());
        assert!(Outcome { facet: wrong, promise: Promise::Rounded, ..outcome() }.holds());
        let elsewhere = SeenErrors { seen_wrong: 1, ..SeenErrors::default() };
        assert!(!Outcome { seen: elsewhere, promise: Promise::Rounded, ..outcome() }.holds());
        for promise in [Promise::Exact, Promise::Rounded, Promise::Texels] {
            assert!(!Outcome { not_a_share: 1, promise, ..outcome() }.holds());
            assert!(!Outcome { repeats: false, promise, ..outcome() }.holds());
            assert!(!Outcome { same_bits: Some(false), promise, ..outcome() }.holds());
        }
        assert!(page(Outcome { same_bits: Some(false), ..outcome() }).contains("**other bits**"));
        // Of no samples and no band there is no figure.
        assert!(page(outcome()).contains("| 2 | – | – | – | – | 0.000 |"), "{}", page(outcome()));
        let some = FacetErrors { facet_samples: 5, ..FacetErrors::default() };
        assert!(page(Outcome { facet: some, ..outcome() }).contains("| 2 | 0 | 0.00 % | – | – | 0.000 |"));
        assert!(page(Outcome { refused: Some("why".to_owned()), ..outcome() }).contains("refused: why"));
    }

    /// Methods of texels have a row a variant, whose cells tell errors and faults.
    #[test]
    fn other_methods_have_a_row_a_variant() {
        let case = &named(&["contact".to_owned()]).unwrap()[0];
        let scene = SceneErrors { scene_band_rmse: Some(0.25), ..SceneErrors::default() };
        let step = case.steps[0].label.clone();
        let other = Outcome { method: "pcf", variant: "pcf kernel=3".to_owned(), scene, step, ..outcome() };
        let rows =
            |o: Outcome| page(o).lines().filter(|l| l.starts_with("| pcf")).map(str::to_owned).collect::<Vec<_>>();
        let [all, steps] = &rows(other.clone())[..] else { panic!("{}", page(other)) };
        assert!(all.starts_with("| pcf kernel=3 | 1 | – | – | 0 | 0 | 0.2500 | contact "), "{all}");
        assert!(steps.starts_with("| pcf kernel=3 | 0.2500 | "), "{steps}");
        let faulty = rows(Outcome { repeats: false, ..other.clone() });
        assert!(faulty[0].contains("| 1 | 0 | 0.2500 |") && faulty[1].contains("| **other bits** |"), "{faulty:?}");
        assert!(rows(Outcome { refused: Some("why".to_owned()), ..other })[1].contains("| refused |"));
    }

    /// All methods are there, and what is exact says so.
    #[test]
    fn every_method_promises_something() {
        let samples = subpixel_shadows::samples::Samples::new(Default::default(), 8).unwrap();
        let all = variants(&Settings::new([8, 6], 8, samples), &MethodName::ALL).unwrap();
        for method in MethodName::ALL {
            assert!(all.iter().any(|v| v.method == method), "{}", method.name());
        }
        let exact: Vec<&str> = all.iter().filter(|v| v.promise == Promise::Exact).map(|v| v.name.as_str()).collect();
        let wanted = [
            "facets=one",
            "facets=all",
            "ray-traced facets=one rays=all",
            "ray-traced facets=one rays=silhouettes",
            "ray-traced facets=all rays=all",
            "ray-traced facets=all rays=silhouettes",
            "supersampled facets=one",
            "supersampled facets=all",
        ];
        assert_eq!(exact, wanted);
        assert!(all.iter().enumerate().all(|(k, v)| all[..k].iter().all(|w| w.name != v.name)));
    }

    #[test]
    fn every_case_can_be_used_and_has_a_name_of_its_own() {
        let all = cases();
        for (k, case) in all.iter().enumerate() {
            assert!(all[..k].iter().all(|c| c.name != case.name), "{}", case.name);
            assert!(case.steps.len() >= 3, "{}", case.name);
            let labels: std::collections::BTreeSet<&str> = case.steps.iter().map(|s| s.label.as_str()).collect();
            assert_eq!(labels.len(), case.steps.len(), "{}", case.name);
            for step in &case.steps {
                step.mesh.check(case.name).unwrap();
                step.camera.check().unwrap();
                step.light.check().unwrap();
            }
        }
        assert!(named(&["nothing".to_owned()]).is_err());
    }
}
