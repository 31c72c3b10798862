//! Four lights in one frame beside one: `ShadowPass::record_lights`, and one `record` a light.
//!
//! `cargo run --release --example several_lights -- [SCENE...]` prints medians over interleaved frames, milliseconds from submission to the end.

#[path = "shared/median.rs"]
mod median;

use lab::scene::{Scene, SceneOptions};
use median::median;
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, Inputs, LightTarget, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Light;
use subpixel_shadows::{Error, Result, ShadowPass};
use test_support::status_of;

/// Rounds of which the medians are taken.
const ROUNDS: usize = 7;

fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let names = if given.is_empty() { vec!["windmill".to_owned(), "spheres".to_owned()] } else { given };
    let gpu = Gpu::open(None)?;
    println!("{} ({}), 800 x 600, 32 samples, map 512, {ROUNDS} rounds\n", gpu.adapter.name, gpu.adapter.driver);
    println!("| scene | one light | four, `record_lights` | four, `record` each | four / one |\n|---|---|---|---|---|");
    for name in names {
        let scene = Scene::open(&name, &SceneOptions::default())?;
        let samples = Samples::new(Pattern::LowDiscrepancy, 32)?;
        let settings = Settings { facets: FacetMode::All, ..Settings::new([800, 600], 512, samples) };
        let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
        // As in a frame of several lights, none finds its maps of the frame before.
        let config = PassConfig { keep_maps: false, ..PassConfig::new(settings, casters) };
        let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
        let others = [[-0.6, 1.0, 0.1], [0.1, 1.0, -0.8], [0.7, 1.0, 0.6]];
        let lights: Vec<Light> =
            std::iter::once(scene.light).chain(others.map(|direction| Light::Directional { direction })).collect();
        let mut times = [const { Vec::new() }; 3];
        for round in 0..ROUNDS + 4 {
            let took = [
                frame(&gpu, &mut pass, &scene, &lights[..1], true)?,
                frame(&gpu, &mut pass, &scene, &lights, true)?,
                frame(&gpu, &mut pass, &scene, &lights, false)?,
            ];
            // The first frames find out how long lists must be.
            if round >= 4 {
                for (times, took) in times.iter_mut().zip(took) {
                    times.push(took.ok_or_else(|| Error::Gpu(format!("{name}: a frame is not complete")))?);
                }
            }
        }
        let [one, together, apart] = times.map(|times| median(&times));
        println!("| {name} | {one:.0} | {together:.0} | {apart:.0} | {:.2} |", together / one);
    }
    Ok(())
}

/// Milliseconds of the lights of a frame, `together` or one after the other; `None` if one is not complete.
fn frame(gpu: &Gpu, pass: &mut ShadowPass, scene: &Scene, lights: &[Light], together: bool) -> Result<Option<f64>> {
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let mut encoder = gpu.encoder();
    if together {
        let asked: Vec<LightTarget> = lights.iter().map(|light| LightTarget::new(*light, Target::default())).collect();
        pass.record_lights(&mut encoder, &inputs, &asked)?;
    } else {
        for light in lights {
            pass.record(&mut encoder, &Inputs { light, ..inputs }, &Target::default())?;
        }
    }
    let start = Instant::now();
    gpu.submit_and_wait(encoder)?;
    let took = start.elapsed().as_secs_f64() * 1e3;
    let complete = lights.iter().filter(|_| status_of(pass).complete).count() == lights.len();
    Ok(complete.then_some(took))
}
