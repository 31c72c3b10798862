//! Facet masks by a box and by the filters that reach a pixel's neighbours, each beside 1024 rays a pixel weighted alike.
//!
//! `cargo run --release --example filters -- [FILE [SCENE X Y]]` writes FILE (data/pictures/filters.png): a box, a tent, a Gaussian and
//! Mitchell's cubic from the left, by facet masks above and by rays below, 48 x 48 pixels around (X, Y) of a picture of 400 x 300, five times as large.
//! It prints how far each is from rays weighted alike, and what it takes.

use lab::report::write_png_grey;
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer};
use std::path::PathBuf;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{PixelFilter, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [400, 300];
/// Pixels a side of a close-up, of the picture for each, and between two.
const SIDE: u32 = 48;
const ZOOM: u32 = 5;
const GAP: u32 = 8;
/// Frames that are timed.
const FRAMES: usize = 9;

fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let file = PathBuf::from(given.first().map_or("data/pictures/filters.png", String::as_str));
    let name = given.get(1).map_or("bicycle", String::as_str);
    let place = |k: usize, usual: u32| match given.get(k) {
        None => Ok(usual),
        Some(text) => text.parse().map_err(|_| Error::Config(format!("'{text}' is no pixel"))),
    };
    let half = SIDE / 2;
    let [x, y] = [place(2, 316)?, place(3, 214)?].map(|at| at.max(half) - half);
    let corner = [x.min(SIZE[0] - SIDE), y.min(SIZE[1] - SIDE)];
    let gpu = Gpu::open(None)?;
    let scene = Scene::open(name, &SceneOptions::default())?;
    let prepared = scene.prepared()?;
    let tracer = Tracer::new(&scene.mesh)?;
    let samples = Samples::new(Pattern::LowDiscrepancy, 32)?;
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, SIZE[0], SIZE[1])?;
    let by_samples = truth.image(None);
    let plain = Settings { cull_back: true, ..Settings::new(SIZE, 512, samples.clone()) };
    let mut made = Vec::new();
    for filter in PixelFilter::ALL {
        let settings = Settings { filter, ..plain.clone() };
        made.push((filter, Renderer::new(&gpu, &prepared, &settings, Budget::default())?, Vec::new(), Vec::new()));
    }
    // Interleaved: what else the machine does meets all of them.
    for frame in 0..=FRAMES {
        for (_, renderer, times, visibility) in &mut made {
            let output = renderer.render(&scene.camera, &scene.light)?;
            let ms = |stage: Option<&str>| {
                output.stages.iter().filter(|s| stage.is_none_or(|name| s.name == name)).map(|s| s.gpu_ms).sum::<f64>()
            };
            if frame > 0 {
                times.push([ms(None), ms(Some("pixel_filter"))]);
            }
            *visibility = output.visibility;
        }
    }
    let median = |times: &[[f64; 2]], k: usize| {
        let mut all: Vec<f64> = times.iter().map(|t| t[k]).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    println!(
        "{} ({}), {name}, {} x {}, 32 samples, map 512, medians of {FRAMES} interleaved frames\n",
        gpu.adapter.name, gpu.adapter.driver, SIZE[0], SIZE[1]
    );
    println!(
        "| filter | pixels apart from the same 32 samples traced | root mean square from 1024 rays weighted alike | from 1024 rays in a box | frame, ms on the GPU | `pixel_filter` of it |"
    );
    println!("|---|---|---|---|---|---|");
    let in_box = truth.converged(None);
    let mut columns = Vec::new();
    for (filter, _, times, visibility) in made {
        let rays = truth.converged_by(filter, None);
        let seen: Vec<usize> = (0..rays.len()).filter(|p| rays[*p].1).collect();
        let rms = |to: &[(f32, bool)]| {
            let sum: f64 = seen.iter().map(|p| f64::from(visibility[*p] - to[*p].0).powi(2)).sum();
            (sum / seen.len().max(1) as f64).sqrt()
        };
        let alike = by_samples.filtered(filter, &samples);
        let apart = visibility.iter().zip(&alike).filter(|(a, b)| (*a - *b).abs() > 5e-5).count();
        let [frame, own] = [0, 1].map(|k| median(&times, k));
        println!("| {filter:?} | {apart} | {:.4} | {:.4} | {frame:.1} | {own:.1} |", rms(&rays), rms(&in_box));
        columns.push([visibility, rays.into_iter().map(|(share, _)| share).collect()]);
    }
    write(&file, &columns, corner)
}

/// Writes the close-ups whose top left pixel is `corner`: a column a filter, two rows.
fn write(file: &std::path::Path, columns: &[[Vec<f32>; 2]], [left, top]: [u32; 2]) -> Result<()> {
    let side = SIDE * ZOOM;
    let of = |count: u32| count * (side + GAP) - GAP;
    let (width, height) = (of(columns.len() as u32), of(2));
    let at = |k: u32| {
        let ([column, x], [row, y]) = (
            [k % width / (side + GAP), k % width % (side + GAP)],
            [k / width / (side + GAP), k / width % (side + GAP)],
        );
        if x >= side || y >= side {
            return 1.0;
        }
        columns[column as usize][row as usize][((top + y / ZOOM) * SIZE[0] + left + x / ZOOM) as usize]
    };
    write_png_grey(file, width, height, &(0..width * height).map(at).collect::<Vec<f32>>())
}
