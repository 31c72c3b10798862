//! `facet-masks` beside a ray tracer on the CPU, at equal error: `cargo run --release --example rays -- [--size WxH] SCENE...` prints a table.
//!
//! Both give every sample the surface that it sees and ask whether light reaches it. Three views a scene: its own, closer, and from low down. Times are medians of rounds in which the two take turns, after a frame that is not timed: of
//! `facet-masks` from submission to the end, of the rays the whole frame; building the tree is told apart.

#[path = "shared/median.rs"]
mod median;

use glam::{DVec3, Vec3};
use lab::scene::{Scene, SceneOptions};
use median::median;
use oracle::engine::CpuRays;
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Prepared, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Camera;
use subpixel_shadows::{Error, Result};

/// Rounds of which the medians are taken.
const ROUNDS: usize = 3;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let Err(error) = run(&words) {
        eprintln!("{error}");
        std::process::exit(if error.is_gpu() { 3 } else { 1 });
    }
}

fn run(words: &[String]) -> Result<()> {
    let (size, names) = match words {
        [option, size, names @ ..] if option == "--size" => (size_of(size)?, names),
        names => ([800, 600], names),
    };
    let gpu = Gpu::open(None)?;
    println!("{}, {}; {} threads; {} x {}\n", gpu.adapter.name, gpu.adapter.backend, threads(), size[0], size[1]);
    println!(
        "| scene | view | samples | facet-masks ms | rays ms | rays / facet-masks | pixels in part shadow | differing | camera |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    let mut trees = Vec::new();
    for name in names {
        let ground = !name.ends_with(".toml");
        let scene = Scene::open(name, &SceneOptions { ground, ..SceneOptions::default() })?;
        let prepared = scene.prepared()?;
        let start = Instant::now();
        let rays = CpuRays::new(&prepared)?;
        let triangles = prepared.mesh().triangles.len();
        trees.push(format!("{}: {triangles} triangles, {:.0} ms", scene.name, start.elapsed().as_secs_f64() * 1e3));
        for (view, camera) in views(&scene) {
            for count in [1, 8, 32, 128] {
                let scene = Scene { camera, ..scene.clone() };
                row(&gpu, &prepared, &rays, &scene, view, size, count)?;
            }
        }
    }
    println!("\nTrees: {}.", trees.join("; "));
    Ok(())
}

fn threads() -> usize {
    rayon::current_num_threads()
}

fn size_of(text: &str) -> Result<[u32; 2]> {
    let parse = || Some([text.split_once('x')?.0.parse().ok()?, text.split_once('x')?.1.parse().ok()?]);
    parse().ok_or_else(|| Error::Config(format!("'{text}' is no size")))
}

/// Times both, and prints the row.
fn row(
    gpu: &Gpu,
    prepared: &Prepared,
    rays: &CpuRays,
    scene: &Scene,
    view: &str,
    size: [u32; 2],
    count: u32,
) -> Result<()> {
    let samples = Samples::new(Pattern::LowDiscrepancy, count)?;
    let wanted = Settings { cull_back: true, ..Settings::new(size, 512, samples) };
    let Scene { camera, light, .. } = scene;
    let plan = Plan::of_method(MethodName::FacetMasks, prepared, camera, light, &wanted, false)?;
    if plan.extent == Extent::Nothing {
        return Err(Error::Scene(format!("{}, {view}: nothing is seen", scene.name)));
    }
    let mut renderer = Renderer::of_plan(gpu, prepared, MethodName::FacetMasks, &plan, Budget::default())?;
    let masks = renderer.render(camera, light)?;
    let traced = rays.render(&plan.settings, camera, light, None)?;
    let (mut of_masks, mut of_rays) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        of_masks.push(renderer.render(camera, light)?.wall_ms);
        of_rays.push(rays.render(&plan.settings, camera, light, None)?.wall_ms);
    }
    let (of_masks, of_rays) = (median(&of_masks), median(&of_rays));
    let partly = masks.visibility.iter().filter(|&&v| v > 0.0 && v < 1.0).count();
    let text = |v: [f32; 3]| v.map(|c| c.to_string()).join(",");
    let (eye, target) = (text(camera.eye), text(camera.target));
    println!(
        "| {} | {view} | {count} | {of_masks:.0} | {of_rays:.0} | {:.2} | {partly} | {} | `eye={eye};target={target};fov={}` |",
        scene.name,
        of_rays / of_masks,
        differing(&masks, &traced),
        camera.vertical_fov_degrees
    );
    Ok(())
}

/// Pixels whose visibility differs.
fn differing(a: &Output, b: &Output) -> usize {
    a.visibility.iter().zip(&b.visibility).filter(|(a, b)| (*a - *b).abs() > 1e-6).count()
}

/// The scene's own view, one from a third of the distance, and one from low down.
fn views(scene: &Scene) -> [(&'static str, Camera); 3] {
    let own = scene.camera;
    let (low, high) = scene.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
    let (eye, target, up) = (Vec3::from(own.eye), Vec3::from(own.target), Vec3::from(own.up).normalize_or(Vec3::Y));
    let from = |eye: Vec3| Camera { eye: eye.into(), near: own.near.min((high - low).length() as f32 * 1e-3), ..own };
    let (middle, half) = (((low + high) * 0.5).as_vec3(), ((high - low) * 0.5).as_vec3());
    let reach = up.abs().dot(half);
    let way = target + (eye - target) * 0.5;
    let lowered = way + up * (up.dot(middle) - 0.94 * reach - up.dot(way));
    [("own", own), ("close", from(target + (eye - target) * 0.35)), ("low", from(lowered))]
}
