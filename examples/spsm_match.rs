//! Pixel match of `spsm` against scene truth at the pixel centre, 1280 × 720, for both encodings:
//! `cargo run --release --example spsm_match -- [--pictures DIR] [--samples N] [--map N] SCENE …`

use std::path::Path;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::any::AnyRenderer;
use subpixel_shadows::methods::render::Budget;
use subpixel_shadows::methods::{MethodName, Prepared, Settings, SpsmEncoding, SpsmSettings};
use subpixel_shadows::report::{write_difference, write_png_grey};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Scene, SceneOptions};
use subpixel_shadows::truth::{SceneTruth, Tracer};
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [1280, 720];

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (mut scenes, mut maps, mut samples, mut pictures) = (Vec::new(), Vec::new(), 1, None);
    let number = |text: Option<String>| {
        let text = text.unwrap_or_default();
        text.parse::<u32>().map_err(|e| Error::Config(format!("'{text}': {e}")))
    };
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--pictures" => pictures = arguments.next(),
            "--samples" => samples = number(arguments.next())?,
            "--map" => maps.push(number(arguments.next())?),
            _ => scenes.push(argument),
        }
    }
    if scenes.is_empty() {
        scenes = vec!["spheres".to_owned(), "knot".to_owned()];
    }
    if maps.is_empty() {
        maps.push(2048);
    }
    let gpu = Gpu::open(None)?;
    println!("adapter: {}", gpu.adapter.name);
    for name in &scenes {
        let scene = Scene::open(name, &SceneOptions { ground: true, ..SceneOptions::default() })?;
        let prepared = Prepared::new(&scene.mesh);
        let samples = Samples::new(Pattern::default(), samples)?;
        let tracer = Tracer::new(&prepared.mesh)?;
        let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, SIZE[0], SIZE[1])?.image(None);
        let wanted = truth.visibility();
        for &map in &maps {
            for (encoding, radius) in [(SpsmEncoding::Paper, 1), (SpsmEncoding::Lines, 1), (SpsmEncoding::Lines, 2)] {
                let mut settings = Settings::new(SIZE, map, samples.clone());
                settings.spsm = SpsmSettings { encoding, radius, ..SpsmSettings::default() };
                let mut renderer = AnyRenderer::new(&gpu, &prepared, MethodName::Spsm, &settings, Budget::default())?;
                let got = renderer.render(&scene.camera, &scene.light)?;
                let near = 1.0 / samples.count() as f32 - 1e-6;
                let off = got.visibility.iter().zip(&wanted).filter(|(g, w)| (*g - *w).abs() > near);
                let (mut acne, mut leaks, mut wrong) = (0, 0, 0);
                off.for_each(|(g, w)| {
                    wrong += 1;
                    acne += u32::from(g < w);
                    leaks += u32::from(g > w);
                });
                let pixels = wanted.len();
                let square: f64 = got.visibility.iter().zip(&wanted).map(|(g, w)| f64::from(g - w).powi(2)).sum();
                println!(
                    "{name} map {map} {encoding:?} radius {radius}: match {:.4} %, wrong {wrong} (too dark {acne}, too light {leaks}), rmse {:.5}, uncertain {:.2} %, {:.0} ms",
                    100.0 * (1.0 - f64::from(wrong) / pixels as f64),
                    (square / pixels as f64).sqrt(),
                    100.0 * got.counts.silhouette_pixels as f64 / pixels as f64,
                    got.wall_ms,
                );
                if let Some(folder) = &pictures {
                    let file = |what: &str| Path::new(folder).join(format!("{name}-{encoding:?}-{radius}-{what}.png"));
                    write_png_grey(&file("visibility"), SIZE[0], SIZE[1], &got.visibility)?;
                    write_difference(&file("difference"), SIZE[0], SIZE[1], &got.visibility, &wanted)?;
                }
            }
        }
    }
    Ok(())
}
