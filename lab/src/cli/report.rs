//! `report`: error against run time.

use super::args::{ReportOptions, or_all};
use super::command_line;
use super::held::FolderLock;
use super::progress::Console;
use super::rows::{Job, JobRows, JobSheet, RowPart, journal_of};
use super::table::Report;
use lab::report::comparison::figures::{error, figures, measured, pareto_front, scenes, slug};
use lab::report::comparison::html::{PictureSheet, html};
use lab::report::comparison::page::{Page, csv, markdown};
use lab::report::comparison::pictures::PanelCut;
use lab::report::comparison::{Machine, Measuring, ReportVariant, Row, Scope, variants};
use lab::report::{or_dash, write_text};
use lab::scene::{Scene, SceneOptions};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::render::Budget;
use subpixel_shadows::{Error, Result};

/// How long a run waits for another one to leave the folder.
const PATIENCE: Duration = Duration::from_secs(2);

/// Measures every row that is missing, then writes tables and plots.
pub fn run(options: &ReportOptions) -> Result<()> {
    let start = Instant::now();
    let console = Console::new(options.rows.quiet);
    let scope = options.scope()?;
    FolderLock::check(&options.out)?;
    let gpu = Gpu::open(options.rows.adapter.as_deref())?;
    let machine = Machine::of(&gpu.adapter);
    let jobs = jobs(options, &scope)?;
    // A scene that cannot be opened is found before hours are spent on the others.
    for scene in options.scenes() {
        open(options, &scene)?.1.iter().for_each(|note| console.note(note));
    }
    // Until the end: rows of two runs at once would be measured twice, and their times be those of a machine that does
    // both.
    let _held = FolderLock::open(&options.out, PATIENCE)?;
    let mut journal = journal_of(&options.out, options.fresh, &machine)?;
    let bench =
        Measuring { gpu: &gpu, repeats: options.repeats(), row_ms: options.row_ms(), budget: Budget::default() };
    let rows = {
        let task = console.task("report");
        JobRows::of_all((&bench, &mut journal), scope.reference()?, options.rows.part, &task, &jobs)?
    };
    if RowPart::lacks(options.rows.part) {
        return told_of_part(&rows, &options.out);
    }
    let written = write(&options.out, options.ground, &machine, &rows)?;
    summary(&machine, &rows, &written, start)
}

fn open(options: &ReportOptions, scene: &str) -> Result<(Scene, Option<String>)> {
    Scene::open_and_note(scene, &SceneOptions { ground: options.ground, ..SceneOptions::default() })
}

/// Jobs to measure, in order.
fn jobs<'a>(options: &'a ReportOptions, scope: &'a Scope) -> Result<Vec<Job<'a>>> {
    let all = variants(scope)?;
    let usual = scope.reference()?;
    let truths: Vec<ReportVariant> = {
        let mut seen = Vec::new();
        let first = |v: &&ReportVariant| {
            let n = v.settings.samples.count();
            let new = !seen.contains(&n);
            seen.push(n);
            new
        };
        all.iter().filter(first).cloned().collect()
    };
    let like_usual = |(samples, map): (u32, u32)| {
        move |v: &ReportVariant| v.settings.samples.count() == samples && v.settings.map == map
    };
    let opened = |scene: String| Box::new(move || Ok(open(options, &scene)?.0));
    let view = if options.ground { "--ground" } else { "" };
    let mut jobs: Vec<Job> = Vec::new();
    for scene in options.scenes() {
        jobs.push(Job {
            view,
            tessellation: 0,
            variants: all.clone(),
            truths: truths.clone(),
            converged: true,
            steps: 0,
            sheet: Some(JobSheet {
                path: picture_path(&options.out, &scene),
                cut: PanelCut::middle(scope.size),
                shown: Box::new(like_usual((usual.settings.samples.count(), usual.settings.map))),
            }),
            open: opened(scene),
        });
    }
    let ladder: Vec<ReportVariant> = all
        .into_iter()
        .filter(|v| v.method == usual.method && v.settings.samples == usual.settings.samples)
        .filter(|v| v.settings.map == usual.settings.map && ["facets=one", "facets=all"].contains(&v.setting.as_str()))
        .collect();
    for tessellation in 1..=options.tessellation() {
        if let Some(scene) = options.scenes().into_iter().next() {
            let (open, variants) = (opened(scene), ladder.clone());
            jobs.push(Job {
                view,
                open,
                tessellation,
                variants,
                truths: Vec::new(),
                converged: true,
                steps: 0,
                sheet: None,
            });
        }
    }
    Ok(jobs)
}

fn picture_path(out: &Path, scene: &str) -> PathBuf {
    out.join(format!("pictures-{}.png", slug(scene)))
}

/// Tells that a part was measured.
pub fn told_of_part(rows: &[Row], out: &Path) -> Result<()> {
    let mut report = Report::default();
    report.text(&format!("{} rows are in {}; `report merge` makes pages of all parts", rows.len(), out.display()));
    report.print()
}

/// Rows scene by scene, each as they are measured; those that are not known last.
pub fn in_order(rows: &[Row]) -> Result<Vec<Row>> {
    let first = |of: &dyn Fn(&Row) -> u32| {
        let mut found: Vec<u32> = Vec::new();
        rows.iter().map(of).for_each(|value| {
            if !found.contains(&value) {
                found.push(value)
            }
        });
        found
    };
    let (samples, mut maps) = (first(&|r| r.samples), first(&|r| r.map));
    // The first of the maps is the one that has every number of samples.
    maps.sort_by_key(|map| usize::MAX - rows.iter().filter(|r| r.map == *map).count());
    let size = rows.first().map_or([1; 2], |r| r.size);
    let all = variants(&Scope { methods: or_all(&[]), samples, maps, size, all_settings: true })?;
    let mut known = Vec::new();
    rows.iter().for_each(|r| {
        if !known.contains(&&r.scene) {
            known.push(&r.scene)
        }
    });
    let place = |row: &Row| {
        let scene = known.iter().position(|scene| **scene == row.scene);
        (row.tessellation, scene, all.iter().position(|v| v.made(row)).unwrap_or(usize::MAX), row.samples)
    };
    let mut sorted = rows.to_vec();
    sorted.sort_by_key(place);
    Ok(sorted)
}

/// Writes tables, plots and the page; returns their paths.
pub fn write(out: &Path, ground: bool, machine: &Machine, rows: &[Row]) -> Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    let mut plots = Vec::new();
    for (name, plot) in figures(rows) {
        let path = out.join(format!("{name}.svg"));
        if plot.write(&path)? {
            written.push(path);
            plots.push(name);
        }
    }
    let measured = measured(rows);
    let mut sheets = Vec::new();
    for scene in scenes(&measured) {
        let path = picture_path(out, &scene);
        if path.exists() {
            let png = std::fs::read(&path).map_err(|e| Error::file(&path, e.to_string()))?;
            sheets.push(PictureSheet { scene, png });
        }
    }
    let pictured = sheets.iter().map(|sheet| sheet.scene.clone()).collect();
    let page = Page { command: command_line(), machine: machine.clone(), plots, pictured };
    let json = serde_json::to_string_pretty(&serde_json::json!({ "machine": machine, "rows": rows }));
    let json = json.map_err(|e| Error::file(out, e.to_string()))?;
    let index = html(&page, rows, &sheets, ground);
    let texts =
        [("rows.csv", csv(rows)), ("rows.json", json), ("report.md", markdown(&page, rows)), ("index.html", index)];
    for (name, text) in texts {
        let path = out.join(name);
        write_text(&path, &text)?;
        written.push(path);
    }
    Ok(written)
}

/// Prints what people want to see first: the front of each scene.
fn summary(machine: &Machine, rows: &[Row], written: &[PathBuf], start: Instant) -> Result<()> {
    let mut report = Report::default();
    report.line("adapter", &machine.line());
    let plain: Vec<&Row> = measured(rows).into_iter().filter(|r| r.tessellation == 0).collect();
    let mut lines = vec![["scene", "front", "samples", "ms", "band RMSE"].map(String::from).to_vec()];
    for scene in scenes(&plain) {
        let of_scene: Vec<&Row> = plain.iter().copied().filter(|r| r.scene == scene).collect();
        for row in pareto_front(&of_scene) {
            let (time, error) = (format!("{:.2}", row.time()), or_dash(error(row), 5));
            lines.push(vec![scene.clone(), row.series(), row.samples.to_string(), time, error]);
        }
    }
    report.table(&lines, &[2, 3, 4]);
    let failed = rows.iter().filter(|r| r.failed.is_some()).count();
    if failed > 0 {
        report.text(&format!("{failed} rows have no figures; report.md says why"));
    }
    let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
    report.text(&format!("\nwrote {}", names.join(", ")));
    report.text(&format!("in {:.0} s", start.elapsed().as_secs_f64()));
    report.print()
}
