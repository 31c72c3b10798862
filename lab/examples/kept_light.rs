//! Light maps that a pass keeps while light and casters stand: what it costs that they are made, and that no picture shows which.
//!
//! - `cargo run --release --example kept_light [-- SCENE...]`: for each scene (`windmill` and the street in `city` unless told otherwise) the stages of
//!   a frame, medians of rounds in turn: where the light moves, where the camera alone does, and where casters come in a vertex buffer.
//! - `cargo run --release --example kept_light -- worlds N [SEED]`: N random worlds, four cameras each; the exit status is 1 if a picture differs
//!   from that of a pass that makes its maps anew.

#[path = "shared/median.rs"]
mod median;

use lab::fuzz::FuzzCase;
use lab::scene::builtin;
use median::median;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, FrameStatus, Inputs, Moved, PassConfig, Target, Vertices};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::kept_light::Walks;
use test_support::status_of;

/// Rounds of which the medians are taken.
const ROUNDS: usize = 9;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match words.split_first() {
        Some((word, rest)) if word == "worlds" => worlds(rest),
        _ => frames(&words).map(|()| true),
    };
    match outcome {
        Ok(true) => {}
        Ok(false) => std::process::exit(1),
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(if error.is_gpu() { 3 } else { 2 });
        }
    }
}

fn worlds(words: &[String]) -> Result<bool> {
    let number = |k: usize, default: u64| match words.get(k) {
        Some(text) => text.parse().map_err(|_| Error::Config(format!("'{text}' is no number"))),
        None => Ok(default),
    };
    let (count, seed) = (number(0, 1000)?, number(1, 1)?);
    let (gpu, programs, mut walks) = (Gpu::open(None)?, KeptPrograms::default(), Walks::default());
    for k in 0..count {
        walks.take(&gpu, &programs, &FuzzCase::of(seed, k)?)?;
        if (k + 1) % 100 == 0 || k + 1 == count {
            let Walks { worlds, refused, pictures, kept, shadowed, faults } = &walks;
            println!(
                "{worlds} worlds of seed {seed}, {refused} refused: {pictures} pictures, {kept} with maps that were kept, {shadowed} with \
                 shadows; {} differ",
                faults.len()
            );
        }
    }
    walks.faults.iter().for_each(|fault| println!("{fault}"));
    Ok(walks.faults.is_empty())
}

/// Columns of the table: the part of a frame that is another in each.
const MOVES: [&str; 3] = ["the light", "the camera alone", "casters in a vertex buffer"];

struct Case {
    mesh: Mesh,
    camera: Camera,
    light: Light,
}

impl Case {
    fn of(name: &str) -> Result<Self> {
        let scene = builtin(name).ok_or_else(|| Error::Config(format!("no built-in scene {name}")))?;
        let camera = match name {
            // The street.
            "city" => Camera {
                eye: [43.5, 2.0, 200.0],
                target: [43.5, 8.0, -200.0],
                vertical_fov_degrees: 60.0,
                near: 0.05,
                ..scene.camera
            },
            _ => scene.camera,
        };
        Ok(Self { mesh: scene.mesh, camera, light: scene.light })
    }

    /// Camera and light of round `k` where `moves` is what moves.
    fn at(&self, moves: usize, k: usize) -> (Camera, Light) {
        let step = 0.002 * k as f32;
        let reach = self.camera.eye.iter().fold(0f32, |most, c| most.max(c.abs()));
        let camera = Camera { eye: self.camera.eye.map(|c| c + 0.1 * reach * step), ..self.camera };
        let light = match (moves, self.light) {
            (0, Light::Directional { direction: [x, y, z] }) => {
                Light::Directional { direction: [x + step, y, z - step] }
            }
            (0, Light::Point { position: [x, y, z] }) => Light::Point { position: [x + step, y, z - step] },
            _ => self.light,
        };
        (camera, light)
    }
}

fn frames(words: &[String]) -> Result<()> {
    let asked: Vec<&str> =
        if words.is_empty() { vec!["windmill", "city"] } else { words.iter().map(String::as_str).collect() };
    let gpu = Gpu::open(None)?;
    println!("{} ({}), 640 x 480, 32 samples, map 1024, {ROUNDS} rounds\n", gpu.adapter.name, gpu.adapter.driver);
    for name in asked {
        let case = Case::of(name)?;
        let samples = Samples::new(Pattern::LowDiscrepancy, 32)?;
        let settings = Settings { facets: FacetMode::All, cull_back: true, ..Settings::new([640, 480], 1024, samples) };
        let vertices = vertices(&gpu, &case.mesh);
        let (low, high) = case.mesh.bounds().ok_or_else(|| Error::Config("an empty scene".to_owned()))?;
        let bounds = [low.as_vec3().into(), high.as_vec3().into()];
        let moved = Moved { vertices: Vertices { buffer: &vertices, offset: 0, stride: 12 }, bounds };
        let (positions, triangles) = (&case.mesh.positions[..], &case.mesh.triangles[..]);
        let mut passes = Vec::new();
        for moves in 0..MOVES.len() {
            let casters = match moves {
                2 => Casters::Moving { rest: positions, triangles },
                _ => Casters::Static { positions, triangles },
            };
            let config = PassConfig { timing: true, ..PassConfig::new(settings.clone(), casters) };
            passes.push((ShadowPass::new(&gpu.device, &gpu.queue, &config)?, Vec::new()));
        }
        for k in 0..ROUNDS + 3 {
            for (moves, (pass, statuses)) in passes.iter_mut().enumerate() {
                let (camera, light) = case.at(moves, k);
                let moved = (moves == 2).then_some(moved);
                let status = frame(&gpu, pass, &Inputs { moved, ..Inputs::new(&camera, &light) })?;
                // The first frames find out how long lists must be.
                if k >= 3 {
                    statuses.push(status);
                }
            }
        }
        table(name, &passes.into_iter().map(|(_, statuses)| statuses).collect::<Vec<_>>());
    }
    Ok(())
}

fn vertices(gpu: &Gpu, mesh: &Mesh) -> wgpu::Buffer {
    let words: Vec<u8> = mesh.positions.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("vertices"),
        size: words.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, &words);
    buffer
}

fn frame(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs) -> Result<FrameStatus> {
    let mut encoder = gpu.encoder();
    pass.record(&mut encoder, inputs, &Target::default())?;
    gpu.submit_and_wait(encoder)?;
    Ok(status_of(pass))
}

/// Medians in ms of each stage, and of the whole; incomplete frames do not count.
fn table(name: &str, all: &[Vec<FrameStatus>]) {
    let mut stages: Vec<&str> = Vec::new();
    for stage in all.iter().flatten().flat_map(|status| &status.stages) {
        if !stages.contains(&stage.name) {
            stages.push(stage.name);
        }
    }
    println!("| {name}, ms where … moves | {} | camera / light |", MOVES.join(" | "));
    println!("|---|---|---|---|---|");
    let of = |statuses: &Vec<FrameStatus>, stage: Option<&str>| {
        let times: Vec<f64> = statuses
            .iter()
            .filter(|status| status.complete)
            .map(|status| {
                status.stages.iter().filter(|s| stage.is_none_or(|name| s.name == name)).map(|s| s.gpu_ms).sum()
            })
            .collect();
        if times.is_empty() { f64::NAN } else { median(&times) }
    };
    let row = |what: &str, stage: Option<&str>| {
        let times: Vec<f64> = all.iter().map(|statuses| of(statuses, stage)).collect();
        // A stage that a frame does without has no time.
        let cell = |ms: f64| if ms == 0.0 { "-".to_owned() } else { format!("{ms:.1}") };
        let cells: Vec<String> = times.iter().copied().map(cell).collect();
        let ratio = if times[0] == 0.0 { String::new() } else { format!("{:.2}", times[1].abs() / times[0]) };
        println!("| {what} | {} | {ratio} |", cells.join(" | "));
    };
    stages.iter().for_each(|stage| row(stage, Some(stage)));
    row("all stages", None);
    let dispatches: Vec<String> = all
        .iter()
        .map(|statuses| statuses.last().map_or_else(String::new, |status| status.dispatches.to_string()))
        .collect();
    println!("| dispatches | {} | |", dispatches.join(" | "));
    let kept: Vec<String> = all
        .iter()
        .map(|statuses| format!("{} of {}", statuses.iter().filter(|s| s.maps_kept).count(), statuses.len()))
        .collect();
    println!("| frames whose maps were kept | {} | |\n", kept.join(" | "));
}
