//! What it costs on the CPU that a light moves: fitting its views anew, as `ShadowPass` and `Renderer` do in a frame whose light is
//! not that of the frame before. `cargo run --release --example moving_light [-- SCENE...]`
//!
//! For each built-in scene, with a ground: what is done once (the mesh brought in order, its tree), and the median of eleven moves of a
//! light far away, of one above the scene, and of one in its middle, low, for which a cube of views is made.

#[path = "shared/median.rs"]
mod median;

use lab::scene::{BUILTIN_NAMES, builtin};
use median::median;
use std::time::Instant;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Light;
use subpixel_shadows::{Error, Result};

const MOVES: u32 = 11;

/// Milliseconds of some work, and what it made.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let made = work();
    (start.elapsed().as_secs_f64() * 1e3, made)
}

fn main() -> Result<()> {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let names: Vec<&str> =
        if asked.is_empty() { BUILTIN_NAMES.to_vec() } else { asked.iter().map(String::as_str).collect() };
    println!(
        "| scene | triangles | once: order, edges | once: tree | directional | point above | point among (views) |"
    );
    println!("|---|---|---|---|---|---|---|");
    for name in names {
        let mut mesh = builtin(name).ok_or_else(|| Error::Config(format!("no built-in scene {name}")))?.mesh;
        let (low, high) = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        if let Some(ground) = mesh.ground_below() {
            mesh.add_ground(&ground);
        }
        let (order, prepared) = timed(|| Prepared::new(&mesh));
        let prepared = prepared?;
        let settings = Settings {
            facets: FacetMode::All,
            cull_back: true,
            ..Settings::new([800, 600], 512, Samples::new(Pattern::LowDiscrepancy, 32)?)
        };
        // The first view of all makes the tree.
        let (tree, _) = timed(|| settings.light_views(&prepared, &Light::Directional { direction: [0.0, 1.0, 0.0] }));
        let mut row = format!("| {name} | {} | {order:.1} | {tree:.1} |", mesh.triangles.len());
        let at = |share: DVec3| Light::Point { position: (low + (high - low) * share).as_vec3().into() };
        for kind in 0..3 {
            let (mut times, mut views) = (Vec::new(), 0);
            for k in 0..MOVES {
                let turn = f64::from(k) * 0.13;
                let (x, z) = (0.5 + 0.2 * turn.sin(), 0.5 + 0.2 * turn.cos());
                let light = match kind {
                    0 => Light::Directional { direction: [x as f32 - 0.5, 0.8, z as f32 - 0.5] },
                    1 => at(DVec3::new(x, 2.0, z)),
                    _ => at(DVec3::new(x, 0.3, z)),
                };
                let (time, found) = timed(|| settings.light_views(&prepared, &light));
                times.push(time);
                views = found?.len();
            }
            let time = median(&times);
            row += &if kind < 2 { format!(" {time:.2} |") } else { format!(" {time:.2} ({views}) |") };
        }
        println!("{row}");
    }
    println!("\nMilliseconds of wall time, {} threads.", std::thread::available_parallelism().map_or(1, usize::from));
    Ok(())
}
