//! `report figure`: the experiments of the papers.

use super::args::FigureOptions;
use super::held::FolderLock;
use super::progress::Console;
use super::rows::{Job, JobRows, JobSheet, RowPart, journal_of};
use super::table::Report;
use lab::report::comparison::figures::slug;
use lab::report::comparison::pictures::PanelCut;
use lab::report::comparison::{Machine, Measuring, Row};
use lab::report::experiments::{Experiment, Place, experiments, markdown, views_file};
use lab::report::write_text;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::render::Budget;

/// How long a run waits for another one to leave a folder.
const PATIENCE: Duration = Duration::from_secs(2);

/// Measures what is missing of each experiment, then writes its page; without a name, lists all.
pub fn run(options: &FigureOptions) -> Result<()> {
    let start = Instant::now();
    let asked = options.experiments()?;
    if asked.is_empty() {
        return list();
    }
    for experiment in &asked {
        FolderLock::check(&options.out.join(experiment.name))?;
        experiment.variants(options.size)?.iter().try_for_each(|v| v.settings.check())?;
    }
    let console = Console::new(options.rows.quiet);
    let gpu = Gpu::open(options.rows.adapter.as_deref())?;
    let mut report = Report::default();
    report.line("adapter", &Machine::of(&gpu.adapter).line());
    for experiment in asked {
        let page = measure(options, experiment, &gpu, &console)?;
        report.text(&format!("{}, {}: {}", experiment.name, experiment.title, page.display()));
    }
    report.text(&format!("in {:.0} s", start.elapsed().as_secs_f64()));
    report.print()
}

fn list() -> Result<()> {
    let mut report = Report::default();
    let mut lines = vec![["figure", "source", "shows"].map(String::from).to_vec()];
    lines.extend(experiments().map(|e| [e.name, e.source, e.title].map(String::from).to_vec()));
    report.table(&lines, &[]);
    report.text("\n`report figure NAME…` measures some again, `report figure all` every one.");
    report.print()
}

/// Measures an experiment and writes its page; returns the page's path.
fn measure(options: &FigureOptions, experiment: &Experiment, gpu: &Gpu, console: &Console) -> Result<PathBuf> {
    let out = options.out.join(experiment.name);
    let machine = Machine::of(&gpu.adapter);
    // Until the end: rows of two runs at once would be measured twice, and their times be those of a machine that does both.
    let _held = FolderLock::open(&out, PATIENCE)?;
    let mut journal = journal_of(&out, options.fresh, &machine)?;
    let row_ms = 1e3 * f64::from(options.row_seconds);
    let bench = Measuring { gpu, repeats: options.repeats, row_ms, budget: Budget::default() };
    let jobs = jobs(options, experiment, &out)?;
    let rows = {
        let (task, reference) = (console.task(experiment.name), experiment.reference(options.size)?);
        JobRows::of_all((&bench, &mut journal), reference, options.rows.part, &task, &jobs)?
    };
    if RowPart::lacks(options.rows.part) {
        return Ok(out);
    }
    experiment.write_views(gpu, options.size, &out)?;
    let [w, h] = options.size;
    let command = format!(
        "cargo run --release -- report figure {} --size {w}x{h} --repeats {} --row-seconds {}",
        experiment.name, options.repeats, options.row_seconds
    );
    write(experiment, &command, &machine, &rows, &out)
}

fn jobs<'a>(options: &FigureOptions, experiment: &'a Experiment, out: &Path) -> Result<Vec<Job<'a>>> {
    let mut jobs = Vec::new();
    for place in experiment.places {
        for tessellation in 0..=experiment.tessellation {
            let sheet = experiment.sheet.filter(|_| tessellation == 0).map(|sheet| JobSheet {
                path: sheet_path(out, place),
                cut: PanelCut::part(options.size, sheet.part, sheet.zoom, sheet.gain),
                shown: Box::new(|v| v.settings.map == experiment.maps[0]),
            });
            let variants = experiment.variants(options.size)?;
            let open = Box::new(|| Experiment::open(place));
            let steps = experiment.moves.map_or(0, |(label, steps)| if label == place.label { steps } else { 0 });
            let converged = experiment.converged;
            let view = place.options;
            jobs.push(Job { view, open, tessellation, variants, truths: Vec::new(), converged, steps, sheet });
        }
    }
    Ok(jobs)
}

fn sheet_path(out: &Path, place: &Place) -> PathBuf {
    out.join(format!("pictures-{}.png", slug(place.label)))
}

/// Writes the page of an experiment and its plots; returns the page's path.
pub fn write(experiment: &Experiment, command: &str, machine: &Machine, rows: &[Row], out: &Path) -> Result<PathBuf> {
    let rows = experiment.in_order(rows)?;
    let measured: Vec<&Row> = rows.iter().filter(|r| r.failed.is_none()).collect();
    let mut plots = Vec::new();
    for (name, plot) in (experiment.plots)(&measured) {
        if plot.write(&out.join(format!("{name}.svg")))? {
            plots.push(name);
        }
    }
    let many = experiment.samples.len() > 1;
    let name = |r: &&&Row| if many { format!("{}, {} samples", r.series(), r.samples) } else { r.series() };
    let pictured: Vec<(&str, Vec<String>)> = experiment
        .places
        .iter()
        .filter(|place| sheet_path(out, place).exists())
        .map(|place| {
            let own = measured.iter().filter(|r| r.scene == place.label && r.tessellation == 0);
            let names = own.filter(|r| r.map == experiment.maps[0]).map(|r| name(&r));
            (place.label, names.chain(["rays".to_owned()]).collect())
        })
        .collect();
    let tinted: Vec<(String, String)> = experiment
        .places
        .iter()
        .flat_map(|place| measured.iter().filter(|row| row.scene == place.label).map(move |row| (place, row.series())))
        .map(|(place, series)| (views_file(place, &series), format!("{series}, {}", place.label)))
        .filter(|(file, _)| out.join(file).exists())
        .collect();
    let page = out.join("page.md");
    write_text(&page, &markdown(experiment, command, machine, &rows, &plots, &pictured, &tinted))?;
    Ok(page)
}
