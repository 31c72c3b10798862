//! `stability`: stiff and extreme cases.

use super::args::StabilityOptions;
use super::output::OutFolder;
use super::progress::Console;
use super::table::Report;
use lab::report::comparison::Machine;
use lab::report::stability::{Outcome, markdown, named, row, run as run_case, variants};
use lab::report::{or_dash, write_text};
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::{Error, Result};

/// Runs the cases, writes the page and the rows, prints what is not as it must be.
pub fn run(options: &StabilityOptions) -> Result<()> {
    let start = Instant::now();
    let console = Console::new(options.quiet);
    let settings = options.settings()?;
    let cases = named(&options.cases)?;
    OutFolder::check(&options.out)?;
    let gpu = Gpu::open(options.adapter.as_deref())?;
    let machine = Machine::of(&gpu.adapter);
    let variants = variants(&gpu, &settings);
    let mut outcomes: Vec<Outcome> = Vec::new();
    {
        let task = console.task("stability");
        let all = cases.len() * variants.len();
        for (k, (case, variant)) in cases.iter().flat_map(|c| variants.iter().map(move |v| (c, v))).enumerate() {
            outcomes.extend(run_case(&gpu, case, variant)?);
            task.at(k + 1, all);
        }
    }
    let order = |o: &Outcome| {
        cases.iter().find(|c| c.name == o.case).and_then(|c| c.steps.iter().position(|s| s.label == o.step))
    };
    let mut sorted = outcomes;
    sorted.sort_by_key(|o| (cases.iter().position(|c| c.name == o.case), order(o)));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let command = format!("cargo run --release -- {}", arguments.join(" "));
    let json = serde_json::to_string_pretty(&serde_json::json!({ "machine": machine, "outcomes": sorted }));
    let json = json.map_err(|e| Error::file(&options.out, e.to_string()))?;
    let files = OutFolder::fill(&options.out, |out| {
        write_text(&out.file("stability.md"), &markdown(&command, &machine.line(), &cases, &sorted))?;
        write_text(&out.file("stability.json"), &json)
    })?;
    let mut report = Report::default();
    report.line("adapter", &machine.line());
    let mut rows = vec![
        ["case", "frames", "wrong samples", "two-step", "refused", "worst RMSE one", "worst RMSE all", "ms"]
            .map(String::from)
            .to_vec(),
    ];
    for case in &cases {
        let of_case: Vec<&Outcome> = sorted.iter().filter(|o| o.case == case.name).collect();
        let wrong = |which: &dyn Fn(&Outcome) -> bool| {
            let chosen = of_case.iter().filter(|o| which(o));
            chosen.map(|o| o.facet.facet_wrong_outside_band).sum::<u64>().to_string()
        };
        let worst = |variant: &str| {
            let errors = of_case.iter().filter(|o| o.variant == variant).filter_map(|o| o.scene.scene_band_rmse);
            or_dash(errors.reduce(f64::max), 4)
        };
        rows.push(vec![
            case.name.to_owned(),
            of_case.len().to_string(),
            wrong(&|o| o.exact),
            wrong(&|o| o.variant.ends_with("two-step")),
            of_case.iter().filter(|o| o.refused.is_some()).count().to_string(),
            worst("facets=one"),
            worst("facets=all"),
            format!("{:.0}", of_case.iter().map(|o| o.gpu_ms).fold(0.0, f64::max)),
        ]);
    }
    report.table(&rows, &[1, 2, 3, 4, 5, 6, 7]);
    let bad: Vec<Vec<String>> =
        sorted.iter().filter(|o| !o.holds()).map(|o| [vec![o.case.to_owned()], row(o)].concat()).collect();
    if bad.is_empty() {
        report.text("\nall frames are as they must be: no wrong sample, the same bits where the scene is the same");
    } else {
        report.text("\nnot as they must be:");
        report.table(&bad, &[]);
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    report.text(&format!("\nwrote {}\nin {:.0} s", names.join(", "), start.elapsed().as_secs_f64()));
    report.print()
}
