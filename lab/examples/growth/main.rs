//! Growth of a frame of `facet-masks`: time, memory and counters over samples, triangles, silhouettes, pixels, map, height of the light, sheets behind
//! each other, and views from within.
//!
//! `cargo run --release --example growth -- [--quick] [--axes NAME,...] [--out DIR] [FILE...]` writes `growth.md`, `rows.jsonl` and a plot for each
//! axis into `DIR` (`out/growth`). Frames that `rows.jsonl` has are not measured again. Files are views of their own; a `.toml` file holds camera and
//! light. Times are medians of three frames after one that is not timed.

mod axes;
mod page;
mod row;

#[path = "../shared/median.rs"]
mod median;

use axes::{Axis, Point, Sizes, axes};
use median::median;
use row::Row;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

/// Frames of which the medians are taken.
const FRAMES: usize = 3;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let Err(error) = Asked::of(&words).and_then(|asked| run(&asked)) {
        eprintln!("{error}");
        std::process::exit(if error.is_gpu() { 3 } else { 1 });
    }
}

/// The command line.
struct Asked {
    quick: bool,
    axes: Option<Vec<String>>,
    out: PathBuf,
    files: Vec<String>,
}

impl Asked {
    fn of(words: &[String]) -> Result<Self> {
        let mut asked = Self { quick: false, axes: None, out: "out/growth".into(), files: Vec::new() };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().cloned().ok_or_else(|| Error::Config(format!("'{word}' needs a value")));
            match word.as_str() {
                "--quick" => asked.quick = true,
                "--axes" => asked.axes = Some(value()?.split(',').map(str::to_owned).collect()),
                "--out" => asked.out = value()?.into(),
                _ if word.starts_with('-') => return Err(Error::Config(format!("unknown option '{word}'"))),
                _ => asked.files.push(word.clone()),
            }
        }
        Ok(asked)
    }
}

fn run(asked: &Asked) -> Result<()> {
    let axes = axes(Sizes::new(asked.quick), &asked.files);
    if let Some(wrong) = asked.axes.iter().flatten().find(|name| axes.iter().all(|axis| axis.name != **name)) {
        let names: Vec<_> = axes.iter().map(|axis| axis.name).collect();
        return Err(Error::Config(format!("no axis '{wrong}'; there are {}", names.join(", "))));
    }
    let wanted = |axis: &&Axis| asked.axes.as_ref().is_none_or(|names| names.iter().any(|name| name == axis.name));
    let axes: Vec<&Axis> = axes.iter().filter(wanted).collect();
    std::fs::create_dir_all(&asked.out).map_err(|e| Error::file(&asked.out, e.to_string()))?;
    let gpu = Gpu::open(None)?;
    let journal = asked.out.join("rows.jsonl");
    let mut rows = read(&journal)?;
    let count: usize = axes.iter().map(|axis| axis.points.len()).sum();
    let points = axes.iter().flat_map(|axis| axis.points.iter().map(move |point| (*axis, point)));
    for (k, (axis, point)) in points.enumerate() {
        let key = Row { axis: axis.name.to_owned(), label: point.label.clone(), ..Row::default() }.key();
        if rows.contains_key(&key) {
            continue;
        }
        eprintln!("growth: {} of {count}: {}, {}", k + 1, axis.name, point.label);
        let row = measure(&gpu, axis, point)?;
        append(&journal, &row)?;
        rows.insert(key, row);
    }
    page::write(&asked.out, &gpu, &axes, &rows)?;
    println!("wrote {}", asked.out.join("growth.md").display());
    Ok(())
}

/// Rows that an earlier run wrote; a last line that was cut off is none.
fn read(path: &Path) -> Result<BTreeMap<String, Row>> {
    let text = match std::fs::read_to_string(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        read => read.map_err(|e| Error::file(path, e.to_string()))?,
    };
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    if whole.len() + 1 < text.len() {
        std::fs::write(path, [whole, "\n"].concat()).map_err(|e| Error::file(path, e.to_string()))?;
    }
    let row = |(n, line): (usize, &str)| {
        let row: Row = serde_json::from_str(line).map_err(|e| {
            Error::file(path, format!("line {} is no row ({e}); without the file growth begins anew", n + 1))
        })?;
        Ok((row.key(), row))
    };
    whole.lines().enumerate().map(row).collect()
}

fn append(path: &Path, row: &Row) -> Result<()> {
    let fault = |e: std::io::Error| Error::file(path, e.to_string());
    let line = serde_json::to_string(row).map_err(|e| Error::file(path, e.to_string()))? + "\n";
    let mut file = std::fs::OpenOptions::new().append(true).create(true).open(path).map_err(fault)?;
    file.write_all(line.as_bytes()).map_err(fault)
}

fn measure(gpu: &Gpu, axis: &Axis, point: &Point) -> Result<Row> {
    let scene = point.scene()?;
    let (camera, light) = (&scene.camera, &scene.light);
    let start = Instant::now();
    let prepared = scene.prepared()?;
    let prepare_ms = start.elapsed().as_secs_f64() * 1e3;
    let samples = Samples::new(Pattern::LowDiscrepancy, point.samples)?;
    let wanted = Settings { cull_back: true, ..Settings::new(point.size, point.map, samples) };
    let start = Instant::now();
    let plan = Plan::of_method(MethodName::FacetMasks, &prepared, camera, light, &wanted, false)?;
    if plan.extent != Extent::Everything {
        return Err(Error::Scene(format!("{}, {}: nothing casts a shadow", axis.name, point.label)));
    }
    let mut renderer = Renderer::of_plan(gpu, &prepared, MethodName::FacetMasks, &plan, Budget::default())?;
    renderer.render(camera, light)?;
    let first_ms = start.elapsed().as_secs_f64() * 1e3;
    let frames = (0..FRAMES).map(|_| renderer.render(camera, light)).collect::<Result<Vec<_>>>()?;
    let memory = gpu.device.generate_allocator_report().map_or(0, |report| report.total_allocated_bytes);
    let of = |stages: &[&str]| {
        let sum = |frame: &Output| -> f64 {
            frame.stages.iter().filter(|stage| stages.contains(&stage.name)).map(|stage| stage.gpu_ms).sum()
        };
        median(&frames.iter().map(sum).collect::<Vec<_>>())
    };
    let triangles = prepared.mesh().triangles.len();
    Ok(Row {
        prepare_ms,
        first_ms,
        frame_ms: median(&frames.iter().map(|frame| frame.wall_ms).collect::<Vec<_>>()),
        surfaces_ms: of(&["camera_visibility", "pixel_triangles", "pixel_coverage", "sample_surfaces"]),
        light_ms: of(&[
            "cluster_culling",
            "triangle_setup",
            "requested_blocks",
            "light_layers",
            "silhouette_mask",
            "front_layer",
            "summed_area",
        ]),
        shadow_ms: of(&[
            "facet_classify",
            "pixel_texel_pairs",
            "triangle_texel_pairs",
            "candidate_pairs",
            "visibility_masks",
            "visibility_refine",
            "resolve",
        ]),
        memory,
        ..Row::counted(axis.name, point.x, &point.label, triangles, &frames[FRAMES - 1].counts)
    })
}
