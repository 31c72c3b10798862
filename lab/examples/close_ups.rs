//! Close-ups of one place by a shadow map, PCF, SPSM, one facet a pixel, a facet for every surface, and 1024 rays, with what each takes and how wrong it is.
//!
//! `cargo run --release --example close_ups -- [DIR [SCENE X Y]]` writes `close-up-*.png` into DIR (data/pictures), 48 x 48 pixels around (X, Y) of a picture of
//! 800 x 600, five times as large, and prints a table. Error: root mean square in the silhouette band of the whole picture, against 1024 rays a pixel.

use lab::report::comparison::{Measuring, ReportVariant, SceneCase, Scope, figures, variants};
use lab::report::{or_dash, write_png_grey};
use lab::scene::{Scene, SceneOptions};
use std::path::{Path, PathBuf};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::render::Budget;
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [800, 600];
/// Pixels a side of a close-up, and of the picture for each.
const SIDE: u32 = 48;
const ZOOM: u32 = 5;

/// Each picture's file, what it is called, and the setting of its method.
const SHOWN: [(&str, &str, MethodName, &str); 5] = [
    ("shadow-map", "shadow map", MethodName::ShadowMap, ""),
    ("pcf", "PCF, 3 x 3", MethodName::Pcf, "kernel=3"),
    ("spsm", "SPSM", MethodName::Spsm, "encoding=lines"),
    ("one-facet", "facet masks, one facet", MethodName::FacetMasks, "facets=one"),
    ("facets", "facet masks, every surface", MethodName::FacetMasks, "facets=all"),
];

fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let out = PathBuf::from(given.first().map_or("data/pictures", String::as_str));
    let name = given.get(1).map_or("bicycle", String::as_str);
    let place = |k: usize, usual: u32| match given.get(k) {
        None => Ok(usual),
        Some(text) => text.parse().map_err(|_| Error::Config(format!("'{text}' is no pixel"))),
    };
    let half = SIDE / 2;
    let [x, y] = [place(2, 632)?, place(3, 428)?].map(|at| at.max(half) - half);
    let corner = [x.min(SIZE[0] - SIDE), y.min(SIZE[1] - SIDE)];
    let gpu = Gpu::open(None)?;
    let mut case = SceneCase::new(Scene::open(name, &SceneOptions::default())?, 0, SIZE)?;
    let methods = vec![MethodName::ShadowMap, MethodName::Pcf, MethodName::Spsm, MethodName::FacetMasks];
    let scope = Scope { methods, samples: vec![32], maps: vec![512], size: SIZE, all_settings: false };
    let known = variants(&scope)?;
    let wanted = |method: MethodName, setting: &str| {
        let found = known.iter().find(|v| v.method == method && v.setting == setting);
        found.cloned().ok_or_else(|| Error::Config(format!("no setting '{setting}' of {}", method.name())))
    };
    let group: Vec<ReportVariant> =
        SHOWN.iter().map(|&(.., method, setting)| wanted(method, setting)).collect::<Result<_>>()?;
    let measuring = Measuring { gpu: &gpu, repeats: 9, row_ms: f64::INFINITY, budget: Budget::default() };
    let measured = measuring.measure(&case, &scope.reference()?, &group)?;
    println!("{} ({}), {name}, {} x {}, 32 samples, map 512\n", gpu.adapter.name, gpu.adapter.driver, SIZE[0], SIZE[1]);
    println!("| | error | ms | over a shadow map |\n|---|---|---|---|");
    let first = measured.first().map_or(f64::NAN, |first| first.row.time());
    for ((file, title, ..), mut measured) in SHOWN.iter().zip(measured) {
        if let Some(failed) = &measured.row.failed {
            return Err(Error::Config(format!("{title}: {failed}")));
        }
        let settings = &scope.reference()?.settings;
        (measured.row.matched, measured.row.converged) = case.errors(settings, &measured.visibility, None)?;
        write(&out.join(format!("close-up-{file}.png")), &measured.visibility, corner)?;
        let (error, time) = (or_dash(figures::error(&measured.row), 3), measured.row.time());
        println!("| {title} | {error} | {time:.0} | {:.2} |", time / first);
    }
    let rays = case.converged(&scope.reference()?.settings, None)?.to_vec();
    write(&out.join("close-up-rays.png"), &rays, corner)
}

/// Writes the close-up whose top left pixel is `corner`.
fn write(path: &Path, visibility: &[f32], [left, top]: [u32; 2]) -> Result<()> {
    let side = SIDE * ZOOM;
    let pixels: Vec<f32> = (0..side * side)
        .map(|k| visibility[((top + k / side / ZOOM) * SIZE[0] + left + k % side / ZOOM) as usize])
        .collect();
    write_png_grey(path, side, side, &pixels)
}
