//! `render`: the main job.

use super::engine::{Engine, Rendered};
use super::explain::mesh_line;
use super::given::other_mesh;
use super::output::OutFolder;
use super::progress::Console;
use super::table::{Report, grouped, percent};
use super::{opened, planned};
use lab::options::RenderOptions;
use lab::report::frame_json::{AdapterReport, ErrorReport, MemoryReport, Sources};
use lab::report::looks::{CLASS_COLOURS, VIEW_COLOURS, write_classes, write_map, write_views};
use lab::report::shaded::Shading;
use lab::report::{
    ConvergedErrors, FacetErrors, FrameReport, SeenErrors, TracedScene, or_dash, percent_or_dash, shade,
    write_difference, write_exr, write_png_grey, write_png_rgb,
};
use lab::scene::Scene;
use oracle::truth::Tracer;
use std::path::PathBuf;
use std::time::Instant;
use subpixel_shadows::Result;
use subpixel_shadows::methods::{MethodName, Prepared};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::deep_map::ERROR_UNIT;

/// Renders, writes the files, prints the table.
pub fn run(scene: Option<&str>, options: &RenderOptions) -> Result<()> {
    let start = Instant::now();
    let console = Console::new(options.quiet);
    options.settings()?;
    OutFolder::check(&options.out)?;
    let scene = opened(options, scene, console)?;
    let from = Instant::now();
    let prepared = scene.prepared()?;
    let (points, plan) = planned(options, &scene, &prepared)?;
    let engine = Engine::open(options, console)?;
    let before = from.elapsed();
    let rendered = engine.render(options, options.frames, &plan, (&scene, &points), &prepared, console)?;
    let setup_ms = (before + rendered.setup).as_secs_f64() * 1e3;
    let compared = || compare(options, &rendered, &plan, (&scene, &points), &prepared, console);
    let truth = options.truth.then(compared).transpose()?;
    let error = truth.as_ref().map(|(error, _)| *error);
    let ((name, backend), asked) = (engine.adapter(), engine.recorded(options, &scene));
    let frame = FrameReport::new(Sources {
        adapter: AdapterReport { name: &name, backend: &backend },
        engine: engine.name(),
        method: options.method.name(),
        scene: &scene,
        prepared: &prepared,
        settings: &plan.settings,
        plan: &plan,
        output: &rendered.output,
        cpu_stages: rendered.cpu_stages.as_deref(),
        timed_frames: rendered.timed_frames,
        setup_ms,
        memory: &rendered.memory,
        asked: &asked,
        error,
    });
    if let Some(note) = other_mesh(options, &frame) {
        console.note(&note);
    }
    let files = write(options, &scene, &prepared, &rendered, truth.as_ref().map(|(_, traced)| traced), &frame)?;
    let mut report = Report::default();
    report.line("scene", &format!("{}: {}", scene.name, mesh_line(&prepared)));
    report.line("adapter", &engine.describe());
    let [w, h] = options.size;
    let n = options.samples;
    report.line("frame", &format!("{w} x {h} pixels, {n} samples a pixel, light-view map of {0} x {0}", options.map));
    if points.len() > 1 {
        let (n, radius) = (points.len(), options.light_radius);
        report.line("light", &format!("the mean of {n} points within a radius of {radius}; counts are of the last"));
    }
    stages(&mut report, &frame, &plan, &rendered);
    if frame.memory.bytes > 0 {
        memory(&mut report, &frame.memory);
    }
    counts(&mut report, &rendered, u64::from(w) * u64::from(h));
    if let Some(error) = &error {
        errors(&mut report, error, n, w);
    }
    if options.looks {
        looks(&mut report, options, &rendered);
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    report.text(&format!("\nwrote {}", names.join(", ")));
    report.text(&format!("in {:.1} s of wall time, writing and truth included", start.elapsed().as_secs_f64()));
    report.text(
        "look further: `explain` for the plan, `--truth` for the error, `--force-all` to leave nothing out, `--help`",
    );
    report.print()
}

/// The error against the truths, and scene truth.
fn compare(
    options: &RenderOptions,
    rendered: &Rendered,
    plan: &Plan,
    (scene, points): (&Scene, &[Light]),
    prepared: &Prepared,
    console: Console,
) -> Result<(ErrorReport, TracedScene)> {
    let settings = &plan.settings;
    let tracer = Tracer::of(prepared)?;
    let facet = match &rendered.facets {
        Some(set) => {
            let task = console.task("facet truth");
            let progress = |done, total| task.at(done, total);
            Some(FacetErrors::of(set, &tracer, &scene.camera, &scene.light, settings, Some(&progress))?)
        }
        None => None,
    };
    let task = console.task("seen surfaces");
    let progress = |done, total| task.at(done, total);
    let seen = match &rendered.facets {
        Some(set) => SeenErrors::of(set, &tracer, &scene.camera, settings, Some(&progress))?,
        None => SeenErrors::of_centres(&rendered.output.triangles, &tracer, &scene.camera, settings, Some(&progress))?,
    };
    let task = console.task("scene truth");
    let progress = |done, total| task.at(done, total);
    let visibility = &rendered.output.visibility;
    let camera = &scene.camera;
    let traced = TracedScene::of_points(&tracer, camera, points, settings, Some(&progress))?;
    let converged = || {
        let task = console.task("1024 rays a pixel");
        let progress = |done, total| task.at(done, total);
        ConvergedErrors::of(visibility, &tracer, camera, points, settings, Some(&progress))
    };
    let converged = options.converged.then(converged).transpose()?;
    Ok((ErrorReport { facet, seen, scene: traced.errors(visibility)?, converged }, traced))
}

/// Writes all files, or none.
fn write(
    options: &RenderOptions,
    scene: &Scene,
    prepared: &Prepared,
    rendered: &Rendered,
    truth: Option<&TracedScene>,
    frame: &FrameReport,
) -> Result<Vec<PathBuf>> {
    let [w, h] = options.size;
    let (visibility, triangles) = (&rendered.output.visibility, &rendered.output.triangles);
    let hits: Vec<bool> = triangles.iter().map(|&t| t != u32::MAX).collect();
    let shading = Shading {
        mesh: prepared.mesh(),
        camera: &scene.camera,
        light: &scene.light,
        size: options.size,
        triangles,
        visibility,
    };
    OutFolder::fill(&options.out, |out| {
        let shaded = shade(&shading);
        write_png_rgb(&out.file("shaded.png"), w, h, &shaded)?;
        write_png_grey(&out.file("visibility.png"), w, h, visibility)?;
        write_exr(&out.file("visibility.exr"), w, h, visibility, &hits)?;
        if let Some(truth) = truth {
            let values = truth.visibility();
            write_exr(&out.file("truth.exr"), w, h, values, &truth.image.centre_hits())?;
            write_difference(&out.file("difference.png"), w, h, visibility, values)?;
        }
        if let Some(looks) = &rendered.looks {
            if !looks.classes.is_empty() {
                write_classes(&out.file("classes.png"), w, h, &looks.classes)?;
            }
            if let Some(map) = &looks.map {
                write_map(&out.file("light-view.png"), map)?;
            }
            if !looks.views.is_empty() {
                write_views(&out.file("views.png"), options.size, &shaded, triangles, &looks.views)?;
            }
        }
        frame.write(&out.file("frame.json"))
    })
}

/// Stages with their time, and those left out.
fn stages(report: &mut Report, frame: &FrameReport, plan: &Plan, rendered: &Rendered) {
    let output = &rendered.output;
    let on_cpu = rendered.cpu_stages.is_some();
    let mut rows = vec![["stage", if on_cpu { "CPU ms" } else { "GPU ms" }, ""].map(String::from).to_vec()];
    for stage in &frame.stages {
        let (time, note) = match stage.left_out {
            Some(reason) => ("-".to_owned(), format!("left out: {reason}")),
            None if on_cpu => (format!("{:.3}", stage.cpu_ms), idle(stage.name, rendered)),
            None if output.stages.is_empty() => ("-".to_owned(), idle(stage.name, rendered)),
            None => (format!("{:.3}", stage.gpu_ms), idle(stage.name, rendered)),
        };
        rows.push(vec![stage.name.to_owned(), time, note]);
    }
    let all = if on_cpu { frame.stages.iter().map(|s| s.cpu_ms).sum() } else { frame.gpu_ms };
    rows.push(vec!["all".to_owned(), format!("{all:.3}"), String::new()]);
    let what = match (on_cpu, output.dispatches) {
        (false, 1..) => "before: mesh, device, pipelines, memory, a frame that is not timed",
        (false, 0) => "before: mesh, device",
        (true, _) => "before: mesh, tree",
    };
    rows.push(vec!["set-up".to_owned(), format!("{:.3}", frame.setup_ms), what.to_owned()]);
    report.table(&rows, &[1]);
    let left_out = plan.left_out().count();
    report.text(&if on_cpu {
        format!("{:.3} ms on the CPU, {left_out} steps left out", output.wall_ms)
    } else {
        let time = format!("{:.3} ms from submission to the end", output.wall_ms);
        let of_frames = match rendered.timed_frames {
            0 => String::new(),
            1 => "; times of one frame, after one that is not timed".to_owned(),
            n => format!("; times are medians of {n} frames, after one that is not timed"),
        };
        format!("{time}, {} dispatches, {left_out} steps left out{of_frames}", output.dispatches)
    });
}

/// Memory of the device, and the buffers that hold most of it.
fn memory(report: &mut Report, of: &MemoryReport) {
    let mebibytes = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
    let largest: Vec<String> =
        of.buffers.iter().take(3).map(|buffer| format!("{} ({})", buffer.label, mebibytes(buffer.bytes))).collect();
    let (all, count) = (mebibytes(of.bytes), of.buffers.len());
    report.text(&format!("{all} of GPU memory in {count} buffers, most in {}", largest.join(", ")));
}

/// Items of a stage that ran and had none.
fn idle(stage: &str, rendered: &Rendered) -> String {
    let c = &rendered.output.counts;
    let items = match stage {
        "silhouette_mask" => (c.silhouette_edges, "silhouette edges"),
        "pixel_texel_pairs" => (c.silhouette_pixels, "undecided facets"),
        "triangle_texel_pairs" | "candidate_pairs" => (c.pixel_texel_pairs, "pixel-texel pairs"),
        "visibility_masks" => (c.visibility_evaluations, "evaluations"),
        _ => return String::new(),
    };
    let ran = rendered.cpu_stages.is_some() || !rendered.output.stages.is_empty();
    if items.0 == 0 && ran { format!("ran on 0 {}", items.1) } else { String::new() }
}

fn counts(report: &mut Report, rendered: &Rendered, pixels: u64) {
    let c = &rendered.output.counts;
    let row = |name: &str, n: u64, note: String| vec![name.to_owned(), grouped(n), note];
    let (all, unit) = if c.complex_pixels > 0 { (c.facets, "facets") } else { (pixels, "pixels") };
    let of_pixels = |n: u64| format!("{} of the {unit}", percent(n, all));
    let mut rows = vec![
        row("silhouette edges", c.silhouette_edges, String::new()),
        row("silhouette texels", c.silhouette_texels, String::new()),
        row("undecided facets", c.silhouette_pixels, of_pixels(c.silhouette_pixels)),
        row("settled: lit", c.lit_facets, of_pixels(c.lit_facets)),
        row("settled: shadowed", c.shadowed_facets, of_pixels(c.shadowed_facets)),
        row("settled: dark", c.dark_facets, of_pixels(c.dark_facets)),
        row("no surface", c.empty_facets, of_pixels(c.empty_facets)),
        row("visibility evaluations", c.visibility_evaluations, String::new()),
    ];
    if c.complex_pixels > 0 {
        let note = format!("{} of the pixels", percent(c.complex_pixels, pixels));
        rows.insert(2, row("pixels looked at sample by sample", c.complex_pixels, note));
        rows.insert(3, row("facets", c.facets, format!("{:.2} a pixel", c.facets as f64 / pixels.max(1) as f64)));
    }
    if c.kept_triangles > 0 {
        let note = "in all views, without clusters that lie outside";
        rows.insert(0, row("triangles set up", c.kept_triangles, note.to_owned()));
    }
    rows.push(row("pixel-texel pairs", c.pixel_texel_pairs, String::new()));
    rows.push(row("triangle-texel pairs", c.triangle_texel_pairs, String::new()));
    if c.pages > 0 {
        let coarser = c.thirds_coarser as f64 / 3.0;
        rows.push(row("pages", c.pages, format!("{} asked for, {coarser:.2} levels coarser", grouped(c.pages_asked))));
    }
    if c.deep_error > 0 {
        let share = c.deep_error as f64 / f64::from(ERROR_UNIT);
        rows.push(row("texels beyond the error asked for", c.deep_raised, format!("{share:.4} of the light at most")));
    }
    report.table(&rows, &[1]);
    let lists = &rendered.output.lists;
    if !lists.is_empty() {
        let mut rows = vec![["list", "needed", "capacity", "runs"].map(String::from).to_vec()];
        for l in lists {
            rows.push(vec![l.name.to_owned(), grouped(l.needed), grouped(l.capacity), l.runs.to_string()]);
        }
        report.table(&rows, &[1, 2, 3]);
    }
}

/// Reports what the colours of the pictures mean, and which picture is missing.
fn looks(report: &mut Report, options: &RenderOptions, rendered: &Rendered) {
    let looks = rendered.looks.as_ref();
    let key = CLASS_COLOURS.map(|(class, colour, _)| format!("{colour} {}", format!("{class:?}").to_lowercase()));
    let map = match options.method {
        MethodName::FacetMasks => "the nearer the brighter, orange where marked, dark blue without a caster",
        MethodName::Spsm | MethodName::Reconstructable | MethodName::PolygonIds => {
            "a hue for each closest triangle, the nearer the brighter, dark blue without a caster or not made"
        }
        _ => "the nearer the brighter, dark blue without a caster",
    };
    let name = options.method.name();
    report.text(&match looks.filter(|l| !l.classes.is_empty()) {
        Some(_) => format!("\nclasses.png: {}", key.join(", ")),
        None => format!("\nno classes.png: {name} keeps no classes of pixels"),
    });
    report.text(&match looks.and_then(|l| l.map.as_ref()) {
        Some(_) => format!("light-view.png: {map}"),
        None => {
            "no light-view.png: the plan left the map out (--force-all makes it), or there are several, as notes say"
                .to_owned()
        }
    });
    if let Some(last) = looks.and_then(|l| l.views.iter().max()) {
        let key = (0..=*last as usize).map(|k| format!("{} {}", VIEW_COLOURS[k % VIEW_COLOURS.len()].0, k + 1));
        report.text(&format!(
            "views.png: the view of the light that each pixel asks, {}",
            key.collect::<Vec<_>>().join(", ")
        ));
    }
}

fn errors(report: &mut Report, error: &ErrorReport, samples: u32, width: u32) {
    let mut first_wrong = None;
    let mut rows = Vec::new();
    let mut row = |cells: &[&str]| rows.push(cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>());
    if let Some(f) = &error.facet {
        row(&["facet truth", "samples", "wrong", "wrong in band", "in band"]);
        let of_some = |n| if f.facet_samples == 0 { "–".to_owned() } else { grouped(n) };
        row(&[
            "all compared",
            &grouped(f.facet_samples),
            &of_some(f.facet_wrong_outside_band),
            &of_some(f.facet_wrong_in_band),
            &percent(f.facet_ambiguous, f.facet_samples),
        ]);
        if f.facet_wrong_outside_band > 0 {
            for (name, n) in [
                ("  settled", f.facet_wrong_settled),
                ("  dark", f.facet_wrong_dark),
                ("  occluded", f.facet_wrong_occluded),
                ("  invalid", f.facet_wrong_invalid),
            ] {
                row(&[name, "", &grouped(n)]);
            }
        }
        first_wrong = f.first_wrong;
    }
    report.table(&rows, &[1, 2, 3, 4]);
    if let Some([pixel, sample, triangle]) = first_wrong {
        let (x, y) = (pixel % width, pixel / width);
        report
            .text(&format!("first wrong: sample {sample} of pixel ({x}, {y}), whose facet is of triangle {triangle}"));
    }
    let seen = &error.seen;
    let of_some = |n| if seen.seen_samples == 0 { "–".to_owned() } else { grouped(n) };
    let mut rows = vec![["seen truth", "samples", "wrong", "tied"].map(String::from).to_vec()];
    rows.push(vec![
        "surface each sees".to_owned(),
        grouped(seen.seen_samples),
        of_some(seen.seen_wrong),
        of_some(seen.seen_tied),
    ]);
    report.table(&rows, &[1, 2, 3]);
    if let Some([pixel, sample, triangle]) = seen.first_wrong {
        let (x, y) = (pixel % width, pixel / width);
        let given = if triangle == u32::MAX { "no surface".to_owned() } else { format!("triangle {triangle}") };
        report.text(&format!("first on another surface: sample {sample} of pixel ({x}, {y}), given {given}"));
    }
    let s = &error.scene;
    let within = format!("within 1/{samples}");
    let mut rows = vec![["scene truth", "pixels", "RMSE", "mean", "max", &within].map(String::from).to_vec()];
    let line = |name: &str, pixels, rmse, mean, max, matching| {
        let [rmse, mean, max] = [(rmse, 5), (mean, 5), (max, 3)].map(|(figure, places)| or_dash(figure, places));
        vec![name.to_owned(), grouped(pixels), rmse, mean, max, percent_or_dash(matching)]
    };
    let [rmse, mean, max] = [s.scene_rmse, s.scene_mean, s.scene_max].map(Some);
    rows.push(line("whole image", s.scene_pixels, rmse, mean, max, s.scene_pixel_match));
    rows.push(line(
        "silhouette band",
        s.scene_band_pixels,
        s.scene_band_rmse,
        s.scene_band_mean,
        s.scene_band_max,
        s.scene_band_pixel_match,
    ));
    rows.push(vec![
        "one plane seen".to_owned(),
        grouped(s.scene_one_plane_pixels),
        String::new(),
        String::new(),
        String::new(),
        percent_or_dash(s.scene_one_plane_match),
    ]);
    report.table(&rows, &[1, 2, 3, 4, 5]);
    report.text(&format!(
        "acne pixels {}, leak pixels {}, mean FLIP {:.5}",
        grouped(s.scene_acne_pixels),
        grouped(s.scene_leak_pixels),
        s.scene_flip
    ));
    if let Some(c) = &error.converged {
        report.text(&format!(
            "against 1024 rays a pixel: RMSE {:.5}, in the silhouette band of {} pixels {}, mean FLIP {:.5}",
            c.converged_rmse,
            grouped(c.converged_band_pixels),
            or_dash(c.converged_band_rmse, 5),
            c.converged_flip
        ));
    }
}
