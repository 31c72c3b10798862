//! The worst case of `--facets all`: every sample of every pixel sees a surface of its own.
//! `cargo run --release --example worst_case -- [--size WxH] [--samples N] [--map N]`
//!
//! The scene is a cloud of triangles, one a sample, each a fiftieth of a pixel wide, tilted and at a depth of its own, before a wall;
//! the light comes through the cloud from the side. The facets then are as many as the samples, which bounds the list and all work
//! on facets. One facet a pixel is measured in turns with it; each time is the median of five frames.

#[path = "shared/median.rs"]
mod median;

use lab::arguments::Arguments;
use lab::report::{TracedScene, or_dash, percent_or_dash};
use median::median;
use oracle::truth::Tracer;
use std::collections::BTreeMap;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::{Gpu, StageTime};
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};
use subpixel_shadows::{Error, Result};

const CAMERA: Camera = Camera {
    eye: [0.0; 3],
    target: [0.0, 0.0, -1.0],
    up: [0.0, 1.0, 0.0],
    vertical_fov_degrees: 40.0,
    near: 0.1,
    far: 100.0,
    lens: Lens::CENTRED,
    near_plane: None,
};
const LIGHT: Light = Light::Directional { direction: [0.3, 0.5, 1.0] };
const TURNS: usize = 5;
/// Stages that find what the camera sees.
const CAMERA_STAGES: [&str; 6] =
    ["cluster_culling", "triangle_setup", "camera_visibility", "pixel_triangles", "pixel_coverage", "sample_surfaces"];

/// Numbers from 0 to 1 that look random, the same on every machine.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }
}

/// A triangle around the ray of each sample, and a wall behind them.
fn cloud(size: [u32; 2], samples: &Samples) -> Mesh {
    let rays = CAMERA.rays(size[0], size[1]);
    let mut mesh = Mesh::default();
    let mut dice = Dice(1);
    let mut add = |corners: [DVec3; 3]| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|p| p.as_vec3().to_array()));
        mesh.triangles.push([first, first + 1, first + 2]);
    };
    for y in 0..size[1] {
        for x in 0..size[0] {
            for [u, v] in samples.offsets() {
                let at = [f64::from(x) + f64::from(*u), f64::from(y) + f64::from(*v)];
                let depth = 4.0 + 2.0 * dice.roll();
                let corner = |dx: f64, dy: f64, tilt: f64| {
                    rays.direction(at[0] + 0.02 * dx, at[1] + 0.02 * dy) * (depth * (1.0 + 1e-4 * (tilt - 0.5)))
                };
                let [a, b, c] = [dice.roll(), dice.roll(), dice.roll()];
                add([corner(-0.9, 0.5, a), corner(0.9, 0.5, b), corner(0.0, -1.0, c)]);
            }
        }
    }
    let wall = |x: f64, y: f64| DVec3::new(x, y, -8.0);
    add([wall(-30.0, -30.0), wall(30.0, -30.0), wall(0.0, 60.0)]);
    mesh
}

/// Sum of the stages that find what the camera sees, or of all others.
fn sum(stages: &[StageTime], camera: bool) -> f64 {
    stages.iter().filter(|s| CAMERA_STAGES.contains(&s.name) == camera).map(|s| s.gpu_ms).sum()
}

fn main() -> Result<()> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    if !words.contains(&"--size".to_owned()) {
        words.extend(["--size".to_owned(), "160x120".to_owned()]);
    }
    let arguments = Arguments::of(words.into_iter())?;
    let size = arguments.size;
    let samples = Samples::new(Pattern::default(), arguments.samples.unwrap_or(32))?;
    let gpu = Gpu::open(None)?;
    let prepared = Prepared::new(&cloud(size, &samples))?;
    let all_samples = u64::from(size[0]) * u64::from(size[1]) * u64::from(samples.count());
    println!(
        "{}; {} x {} pixels, {} samples, map {}; {} triangles\n",
        gpu.adapter.name,
        size[0],
        size[1],
        samples.count(),
        arguments.map,
        prepared.mesh().triangles.len()
    );
    let settings = Settings::new(size, arguments.map, samples);
    let tracer = Tracer::of(&prepared)?;
    let traced = TracedScene::new(&tracer, &CAMERA, &LIGHT, &settings, None)?;
    let modes = [FacetMode::One, FacetMode::All];
    let mut renderers = Vec::new();
    for facets in modes {
        let settings = Settings { facets, ..settings.clone() };
        renderers.push(Renderer::new(&gpu, &prepared, &settings, Budget::default())?);
    }
    let mut frames: [Vec<Output>; 2] = Default::default();
    for turn in 0..=TURNS {
        for (renderer, frames) in renderers.iter_mut().zip(&mut frames) {
            let frame = renderer.render(&CAMERA, &LIGHT)?;
            // The first finds how long the lists are.
            if turn > 0 {
                frames.push(frame);
            }
        }
    }
    println!(
        "| facets | facets listed | a pixel | pairs | evaluations | camera, ms | shadow, ms | band RMSE | within 1/N |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (label, frames) in ["one", "all"].iter().zip(&frames) {
        let Some(last) = frames.last() else { continue };
        let errors = traced.errors(&last.visibility)?;
        let of = |camera| median(&frames.iter().map(|f| sum(&f.stages, camera)).collect::<Vec<_>>());
        println!(
            "| {label} | {} | {:.1} | {} | {} | {:.0} | {:.0} | {} | {} |",
            last.counts.facets,
            last.counts.facets as f64 / f64::from(size[0] * size[1]),
            last.counts.pixel_texel_pairs,
            last.counts.visibility_evaluations,
            of(true),
            of(false),
            or_dash(errors.scene_band_rmse, 5),
            percent_or_dash(errors.scene_pixel_match),
        );
    }
    println!("\n| stage | one, ms | all, ms |\n|---|---|---|");
    let mut stages: BTreeMap<&str, [Vec<f64>; 2]> = BTreeMap::new();
    for (k, frames) in frames.iter().enumerate() {
        for stage in frames.iter().flat_map(|f| &f.stages) {
            stages.entry(stage.name).or_default()[k].push(stage.gpu_ms);
        }
    }
    for (name, times) in &stages {
        let [one, all] =
            times.each_ref().map(|t| if t.is_empty() { "–".to_owned() } else { format!("{:.1}", median(t)) });
        println!("| `{name}` | {one} | {all} |");
    }
    let listed = frames[1].last().map_or(0, |f| f.counts.facets);
    if listed != all_samples {
        return Err(Error::Config(format!(
            "{listed} facets, {all_samples} expected: not every sample sees its own surface"
        )));
    }
    Ok(())
}
