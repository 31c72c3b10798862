//! A thousand moving instances of a mesh over a floor, by transforms alone, beside the same as vertices that the CPU has moved.
//!
//! `cargo run --release --example instances -- [INSTANCES]` prints what a frame takes of the CPU and of the GPU, medians over interleaved
//! frames, and whether both pictures agree.

#[path = "shared/median.rs"]
mod median;
#[path = "shared/read.rs"]
mod read;

use lab::scene::{Camera, Light, Mesh, builtin};
use median::median;
use read::read;
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{CasterMesh, Casters, Inputs, Moved, PassConfig, Placed, Target, Transforms, Vertices};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::wgpu::BufferUsages;
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

/// Rounds of which the medians are taken, after some in which lists find their lengths.
const ROUNDS: usize = 9;
const FIRST: usize = 4;

/// Rows of a matrix whose fourth column is added.
type Transform = [[f32; 4]; 3];

/// Instance `k` of a square of `side`, at a moment; the last is the floor.
fn transform(k: usize, side: usize, moment: f32) -> Transform {
    if k == side * side {
        return [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    }
    let place = |at: usize| (at as f32 + 0.5) / side as f32 * 2.0 - 1.0;
    let ((s, c), scale) = ((moment + 0.37 * k as f32).sin_cos(), 0.7 / side as f32);
    let height = 0.02 + 0.01 * (3.0 * moment + k as f32).sin();
    [
        [c * scale, 0.0, s * scale, place(k % side)],
        [0.0, scale, 0.0, height],
        [-s * scale, 0.0, c * scale, place(k / side)],
    ]
}

fn buffer(gpu: &Gpu, bytes: usize) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("instances"),
        size: bytes as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Centred over the floor, of extent 1.
fn unit(mesh: &Mesh) -> Mesh {
    let (low, high) = mesh.bounds().unwrap_or_default();
    let (centre, size) = ((low + high) * 0.5, (high - low).max_element().max(1e-9));
    let place = |p: &[f32; 3]| {
        let p = subpixel_shadows::glam::Vec3::from(*p).as_dvec3();
        [(p.x - centre.x) / size, (p.y - low.y) / size, (p.z - centre.z) / size].map(|c| c as f32)
    };
    Mesh { positions: mesh.positions.iter().map(place).collect(), triangles: mesh.triangles.clone() }
}

fn main() -> Result<()> {
    let given = std::env::args().nth(1).unwrap_or_else(|| "1000".to_owned());
    let wanted: usize = given.parse().map_err(|_| Error::Config(format!("'{given}' is no number of instances")))?;
    let side = (wanted as f64).sqrt().ceil().max(1.0) as usize;
    let gpu = Gpu::open(None)?;
    let scene = |name: &str| builtin(name).ok_or_else(|| Error::Scene(format!("no {name}")));
    let mesh = unit(&scene("plane")?.mesh);
    let positions = vec![[-1.2, 0.0, -1.2], [1.2, 0.0, -1.2], [1.2, 0.0, 1.2], [-1.2, 0.0, 1.2]];
    let floor = Mesh { positions, triangles: vec![[0, 2, 1], [0, 3, 2]] };
    let meshes = [mesh, floor];
    let instances: Vec<u32> = (0..side * side).map(|_| 0).chain([1]).collect();
    let mut rest = Mesh::default();
    for (k, of) in instances.iter().enumerate() {
        let (mesh, first) = (&meshes[*of as usize], rest.positions.len() as u32);
        // Apart: vertices at one place would be taken as one.
        rest.positions.extend(mesh.positions.iter().map(|p| moved(p, &transform(k, side, 0.0))));
        rest.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let settings =
        Settings { facets: FacetMode::All, ..Settings::new([640, 480], 1024, Samples::new(Pattern::default(), 8)?) };
    let given = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let started = Instant::now();
    let by_transforms = Casters::Instanced { meshes: &given, instances: &instances };
    let mut by_transforms = ShadowPass::new(
        &gpu.device,
        &gpu.queue,
        &PassConfig { timing: true, ..PassConfig::new(settings.clone(), by_transforms) },
    )?;
    let made = started.elapsed().as_secs_f64();
    let by_vertices = Casters::Moving { rest: &rest.positions, triangles: &rest.triangles };
    let mut by_vertices = ShadowPass::new(
        &gpu.device,
        &gpu.queue,
        &PassConfig { timing: true, ..PassConfig::new(settings, by_vertices) },
    )?;
    let (transforms, vertices) = (buffer(&gpu, 48 * instances.len()), buffer(&gpu, 12 * rest.positions.len()));
    let camera =
        Camera { eye: [0.9, 0.8, 1.3], target: [0.0, 0.0, 0.0], far: 100.0, near: 0.01, ..scene("cage")?.camera };
    let light = Light::Directional { direction: [0.5, 0.7, 0.2] };
    let bounds = [[-1.3, -0.1, -1.3], [1.3, 1.0, 1.3]];
    println!(
        "{} ({}), 640 x 480, 8 samples, map 1024: {} instances, {} triangles; the pass was made in {made:.1} s\n",
        gpu.adapter.name,
        gpu.adapter.driver,
        instances.len() - 1,
        rest.triangles.len()
    );
    let mut times = [const { [const { Vec::new() }; 3] }; 2];
    let mut apart = 0;
    for round in 0..ROUNDS + FIRST {
        let now: Vec<Transform> = (0..instances.len()).map(|k| transform(k, side, 0.01 * round as f32)).collect();
        let mut pictures = Vec::new();
        for (way, times) in times.iter_mut().enumerate() {
            let pass = if way == 0 { &mut by_transforms } else { &mut by_vertices };
            let start = Instant::now();
            let inputs = Inputs::new(&camera, &light);
            let inputs = if way == 0 {
                gpu.queue.write_buffer(&transforms, 0, bytemuck::cast_slice(&now));
                Inputs {
                    placed: Some(Placed { transforms: Transforms { buffer: &transforms, offset: 0 }, bounds }),
                    ..inputs
                }
            } else {
                let all = instances
                    .iter()
                    .zip(&now)
                    .flat_map(|(of, t)| meshes[*of as usize].positions.iter().map(|p| moved(p, t)));
                gpu.queue.write_buffer(&vertices, 0, bytemuck::cast_slice(&all.collect::<Vec<[f32; 3]>>()));
                Inputs { moved: Some(Moved { vertices: Vertices::packed(&vertices), bounds }), ..inputs }
            };
            let mut encoder = gpu.encoder();
            pass.record(&mut encoder, &inputs, &Target::default())?;
            let recorded = start.elapsed().as_secs_f64() * 1e3;
            gpu.submit_and_wait(encoder)?;
            let status = status_of(pass);
            if round >= FIRST {
                if !status.complete {
                    return Err(Error::Gpu(format!("round {round}: a frame is not complete: {status:?}")));
                }
                let places = ["instance_positions", "caster_positions"][way];
                let of = |name: Option<&str>| {
                    status.stages.iter().filter(|s| name.is_none_or(|n| n == s.name)).map(|s| s.gpu_ms).sum::<f64>()
                };
                for (times, ms) in times.iter_mut().zip([recorded, of(Some(places)), of(None)]) {
                    times.push(ms);
                }
            }
            let visibility = pass.visibility().clone();
            pictures.push(read(&gpu, &visibility)?);
        }
        apart = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| (*a - *b).abs() > 0.13).count();
    }
    println!("| | CPU, ms a frame | its vertices, GPU ms | frame, GPU ms |\n|---|---|---|---|");
    for (name, times) in
        ["transforms (`Casters::Instanced`)", "vertices moved on the CPU (`Casters::Moving`)"].iter().zip(times)
    {
        let [cpu, own, all] = times.map(|times| median(&times));
        println!("| {name} | {cpu:.2} | {own:.2} | {all:.0} |");
    }
    println!("\n{apart} pixels are apart by more than a sample in the last frame.");
    Ok(())
}

fn moved(p: &[f32; 3], t: &Transform) -> [f32; 3] {
    t.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3])
}
