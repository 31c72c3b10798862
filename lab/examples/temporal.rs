//! Light or camera moved in small steps: error against truth of each frame, and flicker, of every method, as a table and two plots a scene:
//! `cargo run --release --example temporal -- [--plots FOLDER] [--pictures FOLDER] [--frames N] [--size WxH] [--samples N]
//! [--map N] [--ground] [SCENE …]`
//!
//! 64 frames each, or as many as are asked for. With `--pictures` one picture a scene of where `shadow-map` (above) and `spsm`
//! flicker while the light moves: the mean of |change of ours - change of truth| of each pixel, white at 1/16. The light is turned, in each step by an angle that moves a shadow by a tenth of a texel where it falls half
//! the light view's width behind its caster (0.2 / map). The camera is moved to the right, in each step by a tenth of a pixel
//! at its target. Truth is scene truth at the same samples.

use lab::arguments::Arguments;
use lab::options::{FrameArguments, RenderOptions};
use lab::report::comparison::plots::{Axis, Plot, Series};
use lab::report::course::{Course, beside, turned};
use lab::report::write_png_grey;
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer};
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

/// Every method, and how texels lie that stand or do not, as `render` takes them.
const VARIANTS: [&str; 26] = [
    "shadow-map",
    "spsm",
    "shadow-map --splits 3 --warp even",
    "shadow-map --splits 3 --warp stable",
    "spsm --splits 3 --warp stable",
    "pcf",
    "smsr",
    "variance",
    "layered-variance",
    "convolution",
    "exponential",
    "exponential-variance",
    "four-moments",
    "trapezoidal",
    "lispsm",
    "perspective",
    "parallel-split",
    "remix",
    "remix --warp stable",
    "resolution-matched",
    "rectilinear",
    "rectilinear --density logarithmic",
    "ray-traced",
    "supersampled",
    "facet-masks --facets one",
    "facet-masks",
];

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn main() -> Result<()> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let given = words.join(" ");
    let mut take = |name: &str| {
        let at = words.iter().position(|w| w == name)?;
        words.drain(at..(at + 2).min(words.len())).nth(1)
    };
    let (plots, pictures) = (take("--plots").map(PathBuf::from), take("--pictures").map(PathBuf::from));
    let frames = take("--frames").map_or(Ok(64), |n| n.parse::<u32>());
    let frames = frames.map_err(|e| Error::Config(format!("--frames: {e}")))?;
    let arguments = Arguments::of(words.into_iter())?;
    let (size, map) = (arguments.size, arguments.map);
    let samples = Samples::new(Pattern::default(), arguments.samples.unwrap_or(8))?;
    let gpu = Gpu::open(None)?;
    println!("`cargo run --release --example temporal -- {given}`\n");
    println!("{}; {} x {} pixels, {} samples, map {map}.\n", gpu.adapter.name, size[0], size[1], samples.count());
    println!(
        "| scene | moved | method | RMSE | of the worst frame | mean error | flicker | worst step | changed while truth stands |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let start = Instant::now();
    for name in &arguments.scenes {
        let scene = Scene::open(name, &SceneOptions { ground: arguments.ground, ..SceneOptions::default() })?;
        let prepared = scene.prepared()?;
        let tracer = Tracer::of(&prepared)?;
        let mut series = Vec::new();
        for moved in ["light", "camera"] {
            let mut renderers = Vec::new();
            for variant in VARIANTS {
                let options = FrameArguments::of_line(&format!("render --method {variant}"))?.options;
                let settings = RenderOptions { size, map, samples: samples.count(), ..options.clone() }.settings()?;
                renderers.push(Renderer::of_method(&gpu, &prepared, options.method, &settings, Budget::default())?);
            }
            let mut courses: Vec<Course> = VARIANTS.iter().map(|_| Course::default()).collect();
            let (mut before, mut change) = (Vec::new(), Vec::new());
            for k in 0..frames {
                let (camera, light) = match moved {
                    "light" => (scene.camera, turned(&scene.light, map, k)?),
                    _ => (beside(&scene.camera, size[1], k), scene.light),
                };
                let truth = SceneTruth::new(&tracer, &camera, &light, &samples, size[0], size[1])?.image(None);
                let truth = truth.visibility();
                if k > 0 {
                    let sum: f64 = truth.iter().zip(&before).map(|(a, b): (&f32, &f32)| f64::from(a - b).abs()).sum();
                    change.push(sum / truth.len() as f64);
                }
                for (renderer, course) in renderers.iter_mut().zip(&mut courses) {
                    course.add(renderer.render(&camera, &light)?.visibility, &truth, &before);
                }
                before = truth;
            }
            for (label, course) in VARIANTS.iter().zip(&courses) {
                println!(
                    "| {name} | {moved} | `{label}` | {:.4} | {:.4} | {:.5} | {:.5} | {:.5} | {:.3} % |",
                    mean(&course.squares).sqrt(),
                    most(&course.squares).sqrt(),
                    mean(&course.errors),
                    mean(&course.flicker),
                    most(&course.flicker),
                    100.0 * mean(&course.still),
                );
                let point = |(k, v): (usize, &f64)| (k as f64 + 1.0, *v, String::new());
                let points = course.flicker.iter().enumerate().map(point).collect();
                series.push(Series { name: (*label).to_owned(), points, joined: true, guide: false });
            }
            if let Some(folder) = pictures.as_ref().filter(|_| moved == "light") {
                let steps = frames.saturating_sub(1).max(1) as f32;
                let both = courses[..2].iter().flat_map(|c| c.sums.iter().map(|s| 16.0 * s / steps));
                let both: Vec<f32> = both.collect();
                write_png_grey(&folder.join(format!("flicker-{}.png", scene.name)), size[0], 2 * size[1], &both)?;
            }
            if let Some(folder) = &plots {
                let plot = Plot {
                    title: format!("{name}, {moved} moved: flicker, {} x {} pixels, map {map}", size[0], size[1]),
                    x: Axis::linear("step of a tenth of a texel (light) or pixel (camera)"),
                    y: Axis::log("mean of |change of ours - change of truth|"),
                    series: std::mem::take(&mut series),
                };
                plot.write(&folder.join(format!("temporal-{}-{moved}.svg", scene.name)))?;
            }
            println!("| {name} | {moved} | truth's own change | | | | {:.5} | {:.5} | |", mean(&change), most(&change));
            let _ = std::io::stdout().flush();
            eprintln!("{name}, {moved} moved: {:.0} s", start.elapsed().as_secs_f64());
        }
    }
    Ok(())
}
