//! Casters in parts: what the CPU does to add one of a hundred and to remove it, beside a new pass and beside all casters given again.
//!
//! `cargo run --release --example parts -- [PARTS]` prints medians, and whether the pictures agree.

#[path = "shared/median.rs"]
mod median;
#[path = "shared/read.rs"]
mod read;

use lab::scene::{Camera, Light, Mesh, builtin};
use median::median;
use read::read;
use std::time::Instant;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::methods::Settings;
use subpixel_shadows::pass::{CasterMesh, CasterPart, Casters, Inputs, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

const ROUNDS: usize = 7;

/// Part `k` of a square of `side`.
fn placed(mesh: &Mesh, k: usize, side: usize) -> Mesh {
    let [x, z] = [k % side, k / side].map(|at| 8.0 * at as f32);
    let place = |p: &[f32; 3]| [p[0] + x, p[1], p[2] + z];
    Mesh { positions: mesh.positions.iter().map(place).collect(), triangles: mesh.triangles.clone() }
}

fn of(mesh: &Mesh) -> CasterPart<'_> {
    CasterPart::standing(CasterMesh::new(&mesh.positions, &mesh.triangles))
}

/// A complete frame.
fn frame(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs) -> Result<Vec<f32>> {
    for _ in 0..9 {
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, inputs, &Target::default())?;
        gpu.submit_and_wait(encoder)?;
        if status_of(pass).complete {
            let visibility: wgpu::Buffer = pass.visibility().clone();
            return read(gpu, &visibility);
        }
    }
    Err(Error::Gpu("no frame is complete".to_owned()))
}

fn main() -> Result<()> {
    let given = std::env::args().nth(1).unwrap_or_else(|| "100".to_owned());
    let count: usize = given.parse().map_err(|_| Error::Config(format!("'{given}' is no number of parts")))?;
    let side = (count as f64).sqrt().ceil().max(1.0) as usize;
    let gpu = Gpu::open(None)?;
    let scene = builtin("spheres").ok_or_else(|| Error::Scene("no spheres".to_owned()))?;
    let meshes: Vec<Mesh> = (0..count.max(2)).map(|k| placed(&scene.mesh, k, side)).collect();
    let parts: Vec<CasterPart> = meshes.iter().map(of).collect();
    let (last, rest) = parts.split_last().ok_or_else(|| Error::Config("no parts".to_owned()))?;
    let settings = Settings::new([320, 240], 1024, Samples::new(Pattern::default(), 8)?);
    let programs = KeptPrograms::default();
    let room = last.mesh.triangles.len();
    let config = |parts, room| PassConfig {
        programs: Some(&programs),
        ..PassConfig::new(settings.clone(), Casters::Parts { parts, room })
    };
    let new = |config: &PassConfig| ShadowPass::new(&gpu.device, &gpu.queue, config);
    let mut pass = new(&config(rest, room))?;
    let ms = |since: Instant| since.elapsed().as_secs_f64() * 1e3;
    let middle = 4.0 * side as f32;
    let camera = Camera {
        eye: [-0.6 * middle, 1.2 * middle, -0.6 * middle],
        target: [middle, 0.0, middle],
        far: 100.0 * middle,
        ..scene.camera
    };
    let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let inputs = Inputs::new(&camera, &light);
    println!(
        "{} ({}): {} parts of {room} triangles, 320 x 240, map 1024\n",
        gpu.adapter.name,
        gpu.adapter.driver,
        parts.len()
    );
    let mut times = [const { Vec::new() }; 4];
    let mut apart = 0;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let added = pass.add_part(last)?;
        times[0].push(ms(start));
        let got = frame(&gpu, &mut pass, &inputs)?;
        let start = Instant::now();
        pass.remove_part(added)?;
        times[1].push(ms(start));
        frame(&gpu, &mut pass, &inputs)?;
        let start = Instant::now();
        let mut other = new(&config(&parts, 0))?;
        times[2].push(ms(start));
        let want = frame(&gpu, &mut other, &inputs)?;
        apart += got.iter().zip(&want).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        let start = Instant::now();
        other.set_casters(&Casters::Parts { parts: &parts, room: 0 })?;
        times[3].push(ms(start));
    }
    println!("| | CPU, ms |\n|---|---|");
    let names = ["`add_part`", "`remove_part`", "a new pass of the same store", "`set_casters` with all parts"];
    for (name, times) in names.iter().zip(&times) {
        println!("| {name} | {:.2} |", median(times));
    }
    println!("\n{apart} pixels differ from the new pass's.");
    Ok(())
}
