//! Numerical stability: stiff and extreme cases, each held against both truths in every variant.

pub mod cases;
pub mod shapes;

pub use cases::{StiffCase, StiffFrame, cases};

use crate::report::{FacetErrors, FacetSet, SceneErrors, SeenErrors, TracedScene, or_dash};
use oracle::truth::Tracer;
use serde::Serialize;
use std::sync::Arc;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, ProjectionVariant, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Output, Renderer};
use subpixel_shadows::{Error, Result};

/// A way to compute the shadows.
#[derive(Clone, Debug)]
pub struct StabilityVariant {
    /// Its name.
    pub name: &'static str,
    /// Whether no sample may be wrong. The table of masks rounds, and the two projections of the paper bound no rounding.
    pub exact: bool,
    settings: Settings,
    pipelines: Arc<Pipelines>,
}

/// The variants of `facet-masks` that are compared, with the pipelines of each: one facet a pixel, several, the table of
/// masks, and the paper's two projections.
pub fn variants(gpu: &Gpu, settings: &Settings) -> Vec<StabilityVariant> {
    let [one, all] = [FacetMode::One, FacetMode::All].map(|facets| Settings { facets, ..settings.clone() });
    let table = Settings { masks: MaskVariant::TABLE, ..one.clone() };
    let two_step = Settings { projection: ProjectionVariant::TwoStep, ..one.clone() };
    let made = |(name, exact, settings)| {
        let pipelines = Arc::new(Pipelines::new(&gpu.device, &settings));
        StabilityVariant { name, exact, settings, pipelines }
    };
    [
        ("facets=one", true, one),
        ("facets=all", true, all),
        ("facets=one masks=table", false, table),
        ("facets=one projection=two-step", false, two_step),
    ]
    .map(made)
    .into()
}

/// How one step of a case went in one variant.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The case.
    pub case: &'static str,
    /// The step.
    pub step: String,
    /// The variant.
    pub variant: &'static str,
    /// Whether no sample may be wrong.
    pub exact: bool,
    /// Triangles.
    pub triangles: usize,
    /// Why there is no picture: the one line that a user would see.
    pub refused: Option<String>,
    /// Against facet truth: the numeric error.
    pub facet: FacetErrors,
    /// Against seen truth: whether samples were given the surfaces they see.
    pub seen: SeenErrors,
    /// Against scene truth: the whole error.
    pub scene: SceneErrors,
    /// Values that are not finite or not in `[0, 1]`.
    pub not_a_share: usize,
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
    /// Whether it is what it has to be: no sample wrong outside the ambiguity band (but in variants that are not exact) or on another
    /// surface than it sees, shares that are shares, and the same bits where they must be.
    pub fn holds(&self) -> bool {
        let exact = !self.exact || self.facet.facet_wrong_outside_band == 0;
        exact && self.seen.seen_wrong == 0 && self.not_a_share == 0 && self.same_bits != Some(false)
    }
}

/// Runs a case in a variant, all steps.
///
/// # Errors
/// [`Error::Gpu`] if the device fails. What the program refuses becomes an outcome that says so.
pub fn run(gpu: &Gpu, case: &StiffCase, variant: &StabilityVariant) -> Result<Vec<Outcome>> {
    let mut first: Option<Vec<u32>> = None;
    case.steps
        .iter()
        .map(|step| {
            let mut outcome = Outcome {
                case: case.name,
                step: step.label.clone(),
                variant: variant.name,
                exact: variant.exact,
                triangles: step.mesh.triangles.len(),
                refused: None,
                facet: FacetErrors::default(),
                seen: SeenErrors::default(),
                scene: SceneErrors::default(),
                not_a_share: 0,
                same_bits: None,
                gpu_ms: 0.0,
                runs: 0,
                evaluations: [0; 2],
            };
            match measure(gpu, step, variant, &mut outcome) {
                Ok(visibility) => {
                    let bits: Vec<u32> = visibility.iter().map(|v| v.to_bits()).collect();
                    if case.same_bits {
                        outcome.same_bits = Some(*first.get_or_insert_with(|| bits.clone()) == bits);
                    }
                }
                Err(error) if error.is_gpu() => return Err(error),
                Err(error) => outcome.refused = Some(error.to_string()),
            }
            Ok(outcome)
        })
        .collect()
}

fn measure(gpu: &Gpu, step: &StiffFrame, variant: &StabilityVariant, outcome: &mut Outcome) -> Result<Vec<f32>> {
    step.mesh.check(&step.label)?;
    let prepared = Prepared::new(&step.mesh)?;
    let wanted = Settings { map: step.map.unwrap_or(variant.settings.map), ..variant.settings.clone() };
    let plan = Plan::of(&prepared, &step.camera, &step.light, &wanted, false)?;
    let settings = &plan.settings;
    let words = settings.samples.words();
    let mut renderer = match plan.extent {
        Extent::Everything => {
            Renderer::with_pipelines(gpu, &prepared, settings, step.budget, variant.pipelines.clone())?
        }
        _ => Renderer::of_plan(gpu, &prepared, MethodName::FacetMasks, &plan, step.budget)?,
    };
    let (mut facets, width) = (FacetSet { words, ..FacetSet::default() }, settings.size[0]);
    let output = renderer.render_and(&step.camera, &step.light, &mut |method, rows| {
        if rows.first == 0 {
            facets = FacetSet { words, ..FacetSet::default() };
        }
        facets.add(gpu, method.facets(), words, width, rows)
    })?;
    // The first frame, which compiles, is not timed.
    let Output { stages, .. } = renderer.render(&step.camera, &step.light)?;
    let output = Output { stages, ..output };
    let tracer = Tracer::of(&prepared)?;
    let (camera, light) = (&step.camera, &step.light);
    outcome.facet = FacetErrors::of(&facets, &tracer, camera, light, settings, None)?;
    outcome.seen = SeenErrors::of(&facets, &tracer, camera, settings, None)?;
    let traced = TracedScene::new(&tracer, camera, light, settings, None)?;
    outcome.scene = traced.errors(&output.visibility)?;
    outcome.not_a_share = output.visibility.iter().filter(|v| !(0.0..=1.0).contains(*v)).count();
    outcome.gpu_ms = output.stages.iter().map(|s| s.gpu_ms).sum();
    outcome.runs = output.lists.iter().map(|l| l.runs).max().unwrap_or(1);
    outcome.evaluations = [output.counts.visibility_evaluations, output.counts.refined_evaluations];
    Ok(output.visibility)
}

/// The outcomes as a page of Markdown: a table a case.
pub fn markdown(command: &str, machine: &str, cases: &[StiffCase], outcomes: &[Outcome]) -> String {
    use std::fmt::Write;
    let mut out = format!("# Numerical stability\n\n`{command}`\n\n{machine}.\n\n");
    out += "Wrong samples are those farther than 1/256 pixel from every edge, against the method's own model in `f64` (facet \
            truth): there must be none, but with the table of masks, which rounds, and with the paper's two projections (two-step: from the \
            light onto the facet's plane, then onto the screen, in single precision), which bound no rounding. Band: samples within it. Elsewhere: samples that were given another surface \
            than they see (seen truth), which there must be none of; with one facet a pixel its centre is asked. RMSE and largest \
            error are of visibility against rays through the same samples, in the silhouette band: with one facet a pixel that \
            is the model's own error. Refined: evaluations that needed 46 bits.\n\n";
    let bad = outcomes.iter().filter(|o| !o.holds()).count();
    let refused = outcomes.iter().filter(|o| o.refused.is_some()).count();
    let _ = writeln!(out, "{} frames: {bad} not as they must be, {refused} refused.\n", outcomes.len());
    for case in cases {
        let _ = writeln!(out, "## {}\n\n{}.\n", case.name, case.about);
        let _ = writeln!(
            out,
            "| step | variant | triangles | wrong | band | elsewhere | RMSE | max | ms | evaluations | refined | runs | |"
        );
        let _ = writeln!(out, "|---|---|---|---|---|---|---|---|---|---|---|---|---|");
        for o in outcomes.iter().filter(|o| o.case == case.name) {
            let _ = writeln!(out, "| {} |", row(o).join(" | "));
        }
        out.push('\n');
    }
    out
}

/// The cells of an outcome.
pub fn row(o: &Outcome) -> Vec<String> {
    if let Some(why) = &o.refused {
        let mut cells = vec![o.step.clone(), o.variant.to_owned(), o.triangles.to_string()];
        cells.extend(std::iter::repeat_n("–".to_owned(), 9));
        cells.push(format!("refused: {why}"));
        return cells;
    }
    let of_some = |wrong: u64, whole: u64| if whole == 0 { "–".to_owned() } else { wrong.to_string() };
    let share = |part: u64, whole: u64, places: usize| match whole {
        0 => "–".to_owned(),
        _ => format!("{:.places$} %", 100.0 * part as f64 / whole as f64),
    };
    let note = match (o.holds(), o.same_bits) {
        (false, Some(false)) => "**other bits**",
        (false, _) => "**wrong**",
        (true, Some(_)) => "same bits",
        _ => "",
    };
    vec![
        o.step.clone(),
        o.variant.to_owned(),
        o.triangles.to_string(),
        of_some(o.facet.facet_wrong_outside_band, o.facet.facet_samples),
        share(o.facet.facet_ambiguous, o.facet.facet_samples, 2),
        of_some(o.seen.seen_wrong, o.seen.seen_samples),
        or_dash(o.scene.scene_band_rmse, 4),
        format!("{:.3}", o.scene.scene_max),
        format!("{:.1}", o.gpu_ms),
        o.evaluations[0].to_string(),
        share(o.evaluations[1], o.evaluations[0], 1),
        o.runs.to_string(),
        note.to_owned(),
    ]
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
        Outcome {
            case: "contact",
            step: "0".to_owned(),
            variant: "facets=all",
            exact: true,
            triangles: 2,
            refused: None,
            facet: FacetErrors::default(),
            seen: SeenErrors::default(),
            scene: SceneErrors::default(),
            not_a_share: 0,
            same_bits: None,
            gpu_ms: 0.0,
            runs: 1,
            evaluations: [0; 2],
        }
    }

    #[test]
    fn each_fault_is_noticed() {
        assert!(outcome().holds() && Outcome { same_bits: Some(true), ..outcome() }.holds());
        let wrong = FacetErrors { facet_wrong_outside_band: 1, ..FacetErrors::default() };
        assert!(!Outcome { facet: wrong, ..outcome() }.holds());
        assert!(Outcome { facet: wrong, exact: false, ..outcome() }.holds());
        let elsewhere = SeenErrors { seen_wrong: 1, ..SeenErrors::default() };
        assert!(!Outcome { seen: elsewhere, exact: false, ..outcome() }.holds());
        assert!(!Outcome { not_a_share: 1, ..outcome() }.holds());
        assert!(!Outcome { same_bits: Some(false), ..outcome() }.holds());
        let page = |o: Outcome| markdown("c", "m", &named(&["contact".to_owned()]).unwrap(), &[o]);
        assert!(page(Outcome { same_bits: Some(false), ..outcome() }).contains("**other bits**"));
        // Of no samples and no band there is no figure.
        assert!(page(outcome()).contains("| 2 | – | – | – | – | 0.000 |"), "{}", page(outcome()));
        let some = FacetErrors { facet_samples: 5, ..FacetErrors::default() };
        assert!(page(Outcome { facet: some, ..outcome() }).contains("| 2 | 0 | 0.00 % | – | – | 0.000 |"));
        assert!(page(Outcome { refused: Some("why".to_owned()), ..outcome() }).contains("refused: why"));
    }

    #[test]
    fn every_case_can_be_used_and_has_a_name_of_its_own() {
        let all = cases();
        for (k, case) in all.iter().enumerate() {
            assert!(all[..k].iter().all(|c| c.name != case.name), "{}", case.name);
            assert!(case.steps.len() >= 3, "{}", case.name);
            for step in &case.steps {
                step.mesh.check(case.name).unwrap();
                step.camera.check().unwrap();
                step.light.check().unwrap();
            }
        }
        assert!(named(&["nothing".to_owned()]).is_err());
    }
}
