//! Pixel match of `spsm` and `shadow-map` against scene truth at the samples of each pixel, 1280 × 720, as a table:
//! `cargo run --release --example spsm_match -- [--samples N] [--map N] … [--ground] [--time] [--pictures DIR] [--crop X,Y,W,H] [SCENE …]`
//!
//! With `--crop` a picture is that part of the image, each pixel six times as large: truth, `shadow-map`, `spsm`, and what `spsm`
//! has too light (red) or too dark (blue).
//!
//! `+ 1` and `+ 2` are the texels that are searched beyond the square along the border's tangents (section 6.4). With `--time`
//! a last column holds GPU milliseconds of the query, the least of five frames.

use lab::report::{write_difference, write_png_grey, write_png_rgb};
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer};
use std::path::Path;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Settings, SpsmEncoding, SpsmSettings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [1280, 720];
/// The stages that ask the map.
const QUERY: [&str; 4] = ["spsm_classify", "spsm_settle", "spsm_recover", "shadow_map"];

/// What is compared: label, method, encoding, radius of the search and texels beyond along the border's tangents.
const VARIANTS: [(&str, MethodName, SpsmEncoding, [u32; 2]); 6] = [
    ("shadow-map", MethodName::ShadowMap, SpsmEncoding::Lines, [1, 0]),
    ("spsm paper", MethodName::Spsm, SpsmEncoding::Paper, [1, 0]),
    ("spsm lines", MethodName::Spsm, SpsmEncoding::Lines, [1, 0]),
    ("spsm lines 5x5", MethodName::Spsm, SpsmEncoding::Lines, [2, 0]),
    ("spsm lines 3x3 + 1", MethodName::Spsm, SpsmEncoding::Lines, [1, 1]),
    ("spsm lines 3x3 + 2", MethodName::Spsm, SpsmEncoding::Lines, [1, 2]),
];

/// `X,Y,W,H`, within the image.
fn part(text: &str) -> Result<[u32; 4]> {
    let numbers: Vec<u32> = text.split(',').filter_map(|n| n.parse().ok()).collect();
    match numbers[..] {
        [x, y, w, h] if w > 0 && h > 0 && x + w <= SIZE[0] && y + h <= SIZE[1] => Ok([x, y, w, h]),
        _ => Err(Error::Config(format!("'{text}' is no X,Y,W,H within {} x {}", SIZE[0], SIZE[1]))),
    }
}

fn grey(visibility: &[f32]) -> Vec<[u8; 3]> {
    visibility.iter().map(|v| [(255.0 * v.clamp(0.0, 1.0)).round() as u8; 3]).collect()
}

/// Grey where nothing is off, red where it is too light, blue where too dark.
fn signed(off: f32) -> [u8; 3] {
    let rest = (190.0 * (1.0 - off.abs().min(1.0))) as u8;
    if off > 0.0 { [190, rest, rest] } else { [rest, rest, 190] }
}

/// The same part of each picture, side by side, each pixel six times as large, with a line between.
fn beside(pictures: &[Vec<[u8; 3]>], [x, y, w, h]: [u32; 4]) -> (u32, u32, Vec<[u8; 3]>) {
    let each = 6 * w + 4;
    let (width, height) = (each * pictures.len() as u32 - 4, 6 * h);
    let place = |at: u32| {
        let (column, row) = (at % width, at / width);
        let inside = column % each;
        if inside >= 6 * w {
            return [255, 160, 0];
        }
        pictures[(column / each) as usize][((y + row / 6) * SIZE[0] + x + inside / 6) as usize]
    };
    (width, height, (0..width * height).map(place).collect())
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (mut scenes, mut maps, mut samples, mut pictures, mut ground) = (Vec::new(), Vec::new(), 1, None, false);
    let (mut time, mut crop) = (false, None);
    let number = |text: Option<String>| {
        let text = text.unwrap_or_default();
        text.parse::<u32>().map_err(|e| Error::Config(format!("'{text}': {e}")))
    };
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--pictures" => pictures = arguments.next(),
            "--samples" => samples = number(arguments.next())?,
            "--map" => maps.push(number(arguments.next())?),
            "--ground" => ground = true,
            "--time" => time = true,
            "--crop" => crop = Some(part(&arguments.next().unwrap_or_default())?),
            _ => scenes.push(argument),
        }
    }
    if scenes.is_empty() {
        scenes = ["spheres", "knot", "city", "windmill"].map(str::to_owned).to_vec();
    }
    if maps.is_empty() {
        maps = vec![512, 1024, 2048, 4096];
    }
    let gpu = Gpu::open(None)?;
    println!("adapter: {}, {} x {} pixels, samples a pixel: {samples}\n", gpu.adapter.name, SIZE[0], SIZE[1]);
    let more = if time { [" query, ms |", "---|"] } else { [""; 2] };
    println!(
        "| scene | map | method | match | wrong | too dark | too light | fewer wrong | uncertain | RMSE |{}",
        more[0]
    );
    println!("|---|---|---|---|---|---|---|---|---|---|{}", more[1]);
    for name in &scenes {
        let scene = Scene::open(name, &SceneOptions { ground, ..SceneOptions::default() })?;
        let prepared = scene.prepared()?;
        let samples = Samples::new(Pattern::default(), samples)?;
        let tracer = Tracer::of(&prepared)?;
        let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, SIZE[0], SIZE[1])?.image(None);
        let wanted = truth.visibility();
        for &map in &maps {
            let mut baseline = 0;
            let mut shown = vec![grey(&wanted)];
            for (label, method, encoding, [radius, stretch]) in VARIANTS {
                let mut settings = Settings::new(SIZE, map, samples.clone());
                settings.spsm = SpsmSettings { encoding, radius, stretch, ..SpsmSettings::default() };
                let mut renderer = Renderer::of_method(&gpu, &prepared, method, &settings, Budget::default())?;
                let got = renderer.render(&scene.camera, &scene.light)?;
                let mut least = f64::INFINITY;
                for _ in 0..if time { 5 } else { 0 } {
                    let stages = renderer.render(&scene.camera, &scene.light)?.stages;
                    let query = stages.iter().filter(|s| QUERY.contains(&s.name));
                    least = least.min(query.map(|s| s.gpu_ms).sum());
                }
                let near = 1.0 / samples.count() as f32 - 1e-6;
                let (mut dark, mut light, mut square) = (0u32, 0u32, 0.0);
                for (g, w) in got.visibility.iter().zip(&wanted) {
                    dark += u32::from(w - g > near);
                    light += u32::from(g - w > near);
                    square += f64::from(g - w).powi(2);
                }
                let (pixels, wrong) = (wanted.len() as f64, dark + light);
                if method == MethodName::ShadowMap {
                    baseline = wrong;
                }
                println!(
                    "| {name} | {map} | {label} | {:.3} % | {wrong} | {dark} | {light} | {:.1} x | {:.2} % | {:.4} |{}",
                    100.0 * (1.0 - f64::from(wrong) / pixels),
                    f64::from(baseline) / f64::from(wrong.max(1)),
                    100.0 * got.counts.silhouette_pixels as f64 / pixels,
                    (square / pixels).sqrt(),
                    if time { format!(" {least:.1} |") } else { String::new() },
                );
                if crop.is_some() && (label == "shadow-map" || radius == 1 && stretch == 2) {
                    shown.push(grey(&got.visibility));
                    let off = got.visibility.iter().zip(&wanted).map(|(g, w)| signed(g - w));
                    if method == MethodName::Spsm {
                        shown.push(off.collect());
                    }
                }
                if let Some(folder) = pictures.as_ref().filter(|_| crop.is_none()) {
                    let file = |what: &str| {
                        Path::new(folder).join(format!("{name}-{map}-{}-{what}.png", label.replace(' ', "-")))
                    };
                    write_png_grey(&file("visibility"), SIZE[0], SIZE[1], &got.visibility)?;
                    write_difference(&file("difference"), SIZE[0], SIZE[1], &got.visibility, &wanted)?;
                }
            }
            if let (Some(folder), Some(crop)) = (&pictures, crop) {
                let (width, height, pixels) = beside(&shown, crop);
                write_png_rgb(&Path::new(folder).join(format!("{name}-{map}.png")), width, height, &pixels)?;
            }
        }
    }
    Ok(())
}
