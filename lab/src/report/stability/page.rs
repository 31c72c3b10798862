//! Outcomes as a page and as tables.

use super::{Outcome, StiffCase};
use crate::report::or_dash;
use std::fmt::Write;
use subpixel_shadows::methods::MethodName;

const ABOUT: &str = "Wrong samples are those farther than 1/256 pixel from every edge, against the method's own model in `f64` (facet \
    truth): of `facet-masks`, rays and `supersampled` there must be none, but with the table of masks, which rounds, and with the paper's two \
    projections (two-step: from the light onto the facet's plane, then onto the screen, in single precision), which bound no rounding. Other \
    methods answer by texels and promise no sample; of them, as of all, what is promised is a share from 0 to 1 in every pixel, the same bits in \
    a second frame, and where the scene is the same. Band: samples within 1/256 pixel. Elsewhere: samples that were given another surface than \
    they see (seen truth), which there must be none of; with one facet a pixel its centre is asked. RMSE and largest error are of visibility \
    against rays through the same samples, in the silhouette band: with one facet a pixel that is the model's own error. Acne: pixels lit in \
    truth and not wholly here, away from the band; leaks: dark in truth and lit here; either by half a step of 8 bits or more. Refined: evaluations that needed 46 bits.";

fn is_own(o: &Outcome) -> bool {
    o.method == MethodName::FacetMasks.name()
}

/// The outcomes as a page of Markdown: a table of all variants, then a case at a time.
pub fn markdown(command: &str, machine: &str, cases: &[StiffCase], outcomes: &[Outcome]) -> String {
    let mut out = format!("# Numerical stability\n\n`{command}`\n\n{machine}.\n\n{ABOUT}\n\n");
    let bad = outcomes.iter().filter(|o| !o.holds()).count();
    let refused = outcomes.iter().filter(|o| o.refused.is_some()).count();
    let _ = writeln!(out, "{} frames: {bad} not as they must be, {refused} refused.\n", outcomes.len());
    table(&mut out, &summary(outcomes));
    for case in cases {
        let _ = writeln!(out, "## {}\n\n{}.\n", case.name, case.about);
        let of_case: Vec<&Outcome> = outcomes.iter().filter(|o| o.case == case.name).collect();
        let (own, others): (Vec<_>, Vec<_>) = of_case.into_iter().partition(|o| is_own(o));
        if !own.is_empty() {
            table(&mut out, &[vec![HEAD.map(String::from).to_vec()], own.into_iter().map(row).collect()].concat());
        }
        if !others.is_empty() {
            out += "RMSE of the other methods:\n\n";
            table(&mut out, &by_step(case, &others));
        }
    }
    out
}

fn table(out: &mut String, rows: &[Vec<String>]) {
    for (k, cells) in rows.iter().enumerate() {
        let _ = writeln!(out, "| {} |", cells.join(" | "));
        if k == 0 {
            let _ = writeln!(out, "|{}", "---|".repeat(cells.len()));
        }
    }
    out.push('\n');
}

/// A row a variant: frames, samples that are wrong and on another surface, frames that are refused or not as they must be, and where it is
/// the worst. Its head comes first.
pub fn summary(outcomes: &[Outcome]) -> Vec<Vec<String>> {
    let head =
        ["variant", "frames", "wrong", "elsewhere", "faults", "refused", "worst RMSE", "in", "acne", "leaks", "ms"];
    let mut variants: Vec<&str> = Vec::new();
    for o in outcomes {
        if !variants.contains(&o.variant.as_str()) {
            variants.push(&o.variant);
        }
    }
    let row = |variant: &str| {
        let all: Vec<&Outcome> = outcomes.iter().filter(|o| o.variant == variant).collect();
        let sum = |of: &dyn Fn(&Outcome) -> u64| all.iter().map(|o| of(o)).sum::<u64>();
        let asked = |count: u64, whole: u64| if whole == 0 { "–".to_owned() } else { count.to_string() };
        let worst = all.iter().filter_map(|o| o.scene.scene_band_rmse.map(|e| (e, o)));
        let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
        vec![
            variant.to_owned(),
            all.len().to_string(),
            asked(sum(&|o| o.facet.facet_wrong_outside_band), sum(&|o| o.facet.facet_samples)),
            asked(sum(&|o| o.seen.seen_wrong), sum(&|o| o.seen.seen_samples)),
            sum(&|o| u64::from(!o.holds())).to_string(),
            sum(&|o| u64::from(o.refused.is_some())).to_string(),
            or_dash(worst.as_ref().map(|w| w.0), 4),
            worst.map_or_else(|| "–".to_owned(), |(_, o)| format!("{} {}", o.case, o.step)),
            sum(&|o| o.scene.scene_acne_pixels).to_string(),
            sum(&|o| o.scene.scene_leak_pixels).to_string(),
            format!("{:.1}", all.iter().map(|o| o.gpu_ms).fold(0.0, f64::max)),
        ]
    };
    std::iter::once(head.map(String::from).to_vec()).chain(variants.into_iter().map(row)).collect()
}

/// A row a variant, a column a step: the error, or what is not as it must be.
fn by_step(case: &StiffCase, outcomes: &[&Outcome]) -> Vec<Vec<String>> {
    let head = std::iter::once("variant".to_owned()).chain(case.steps.iter().map(|s| s.label.clone()));
    let mut rows = vec![head.collect::<Vec<_>>()];
    let mut variants: Vec<&str> = Vec::new();
    for o in outcomes {
        if !variants.contains(&o.variant.as_str()) {
            variants.push(&o.variant);
        }
    }
    for variant in variants {
        let cell = |label: &str| {
            let found = outcomes.iter().find(|o| o.variant == variant && o.step == label);
            found.map_or_else(String::new, |o| match (&o.refused, fault(o)) {
                (Some(_), _) => "refused".to_owned(),
                (None, "") => or_dash(o.scene.scene_band_rmse, 4),
                (None, fault) => format!("**{fault}**"),
            })
        };
        rows.push(std::iter::once(variant.to_owned()).chain(case.steps.iter().map(|s| cell(&s.label))).collect());
    }
    rows
}

/// The fault of a frame in a word or two, empty if there is none.
fn fault(o: &Outcome) -> &'static str {
    match (o.holds(), o.same_bits == Some(false) || !o.repeats) {
        (true, _) => "",
        (false, true) => "other bits",
        (false, false) => "wrong",
    }
}

/// Names of the cells of [`row`].
pub const HEAD: [&str; 13] = [
    "step",
    "variant",
    "triangles",
    "wrong",
    "band",
    "elsewhere",
    "RMSE",
    "max",
    "ms",
    "evaluations",
    "refined",
    "runs",
    "",
];

/// The cells of an outcome.
pub fn row(o: &Outcome) -> Vec<String> {
    if let Some(why) = &o.refused {
        let mut cells = vec![o.step.clone(), o.variant.clone(), o.triangles.to_string()];
        cells.extend(std::iter::repeat_n("–".to_owned(), 9));
        cells.push(format!("refused: {why}"));
        return cells;
    }
    let of_some = |wrong: u64, whole: u64| if whole == 0 { "–".to_owned() } else { wrong.to_string() };
    let share = |part: u64, whole: u64, places: usize| match whole {
        0 => "–".to_owned(),
        _ => format!("{:.places$} %", 100.0 * part as f64 / whole as f64),
    };
    let note = match (fault(o), o.same_bits) {
        ("", Some(_)) => "same bits".to_owned(),
        ("", None) => String::new(),
        (fault, _) => format!("**{fault}**"),
    };
    vec![
        o.step.clone(),
        o.variant.clone(),
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
        note,
    ]
}
