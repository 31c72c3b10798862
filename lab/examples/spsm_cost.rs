//! GPU time of `spsm` over that of `shadow-map`, stage by stage, 1280 × 720 pixels, the frames of both in turns:
//! `cargo run --release --example spsm_cost -- [--samples N] [--map N] … [--repeats N] [--stretch N] [SCENE …]`
//!
//! Each time is the median of the repeats, each ratio the median of the ratios of the turns. *Map and query*: what the
//! methods do after `triangle_setup` and `camera_visibility`, which are the same stages in both. *Frame*: those included.

#[path = "shared/median.rs"]
mod median;

use lab::scene::{Scene, SceneOptions};
use median::median;
use std::collections::BTreeMap;
use subpixel_shadows::gpu::{Gpu, StageTime};
use subpixel_shadows::methods::{MethodName, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [1280, 720];
/// Stages that both methods begin with.
const SHARED: [&str; 3] = ["cluster_culling", "triangle_setup", "camera_visibility"];
/// Name, method, whether only the texels of the map that pixels ask for are made.
const ROWS: [(&str, MethodName, bool); 3] = [
    ("`shadow-map`", MethodName::ShadowMap, false),
    ("`spsm`, all texels", MethodName::Spsm, false),
    ("`spsm`, texels asked for", MethodName::Spsm, true),
];

/// Times of one method over the turns: of each stage, of map and query, of the frame.
#[derive(Default)]
struct Times {
    stages: BTreeMap<&'static str, Vec<f64>>,
    own: Vec<f64>,
    frame: Vec<f64>,
}

impl Times {
    fn add(&mut self, stages: &[StageTime]) {
        for stage in stages {
            self.stages.entry(stage.name).or_default().push(stage.gpu_ms);
        }
        let sum = |own: bool| stages.iter().filter(|s| !own || !SHARED.contains(&s.name)).map(|s| s.gpu_ms).sum();
        self.own.push(sum(true));
        self.frame.push(sum(false));
    }
}

fn ratio(over: &[f64], under: &[f64]) -> f64 {
    median(&over.iter().zip(under).map(|(a, b)| a / b).collect::<Vec<_>>())
}

fn main() -> Result<()> {
    let (mut scenes, mut maps, mut samples, mut repeats, mut stretch) = (Vec::new(), Vec::new(), 1, 9, None);
    let mut arguments = std::env::args().skip(1);
    let number = |text: Option<String>| {
        let text = text.unwrap_or_default();
        text.parse::<u32>().map_err(|e| Error::Config(format!("'{text}': {e}")))
    };
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--samples" => samples = number(arguments.next())?,
            "--map" => maps.push(number(arguments.next())?),
            "--repeats" => repeats = number(arguments.next())?,
            "--stretch" => stretch = Some(number(arguments.next())?),
            _ => scenes.push(argument),
        }
    }
    if scenes.is_empty() {
        scenes.push("knot".to_owned());
    }
    if maps.is_empty() {
        maps = vec![512, 1024, 2048, 4096];
    }
    let gpu = Gpu::open(None)?;
    println!(
        "adapter: {}, {} x {} pixels, samples a pixel: {samples}, {repeats} turns\n",
        gpu.adapter.name, SIZE[0], SIZE[1]
    );
    for name in &scenes {
        let scene = Scene::open(name, &SceneOptions::default())?;
        let prepared = scene.prepared()?;
        println!("| {name}, map | method | stages, ms | map and query, ms | ratio | frame, ms | ratio |");
        println!("|---|---|---|---|---|---|---|");
        for &map in &maps {
            let mut settings = Settings::new(SIZE, map, Samples::new(Pattern::default(), samples)?);
            settings.spsm.stretch = stretch.unwrap_or(settings.spsm.stretch);
            let mut renderers = Vec::new();
            for (name, method, seen_only) in ROWS {
                settings.spsm.seen_only = seen_only;
                let mut renderer = Renderer::of_method(&gpu, &prepared, method, &settings, Budget::default())?;
                let first = renderer.render(&scene.camera, &scene.light)?;
                let hash = first
                    .visibility
                    .iter()
                    .fold(0xcbf2_9ce4_8422_2325u64, |h, v| (h ^ u64::from(v.to_bits())).wrapping_mul(0x0100_0000_01b3));
                eprintln!("{name}, {map}: {hash:016x}, {} uncertain", first.counts.silhouette_pixels);
                renderers.push((renderer, Times::default()));
            }
            for _ in 0..repeats {
                for (renderer, times) in &mut renderers {
                    times.add(&renderer.render(&scene.camera, &scene.light)?.stages);
                }
            }
            let base = &renderers[0].1;
            for ((row, ..), (_, times)) in ROWS.iter().zip(&renderers) {
                let stages = times.stages.iter().filter(|(name, _)| !SHARED.contains(name));
                let stages: Vec<_> = stages.map(|(name, all)| format!("`{name}` {:.1}", median(all))).collect();
                println!(
                    "| {map} | {row} | {} | {:.1} | {:.2} | {:.1} | {:.2} |",
                    stages.join(", "),
                    median(&times.own),
                    ratio(&times.own, &base.own),
                    median(&times.frame),
                    ratio(&times.frame, &base.frame),
                );
            }
        }
        println!();
    }
    Ok(())
}
