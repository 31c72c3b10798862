//! A forest: trees whose leaves are cards with holes, each an instance of one mesh that sways by its transform, two million triangles in all.
//!
//! `cargo run --release --example forest -- [--trees N] [--size WxH] [--samples N] [--map N] [--out DIR]` renders some frames, tells what they
//! take, holds the last against rays through the same samples, and writes `forest.png` and `difference.png`.

#[path = "shared/read.rs"]
mod read;

use lab::report::shaded::{Shading, shade};
use lab::report::{TracedScene, write_difference, write_png_rgb};
use lab::scene::{Camera, Light, Mesh, builtin};
use oracle::truth::Tracer;
use read::read;
use std::path::{Path, PathBuf};
use std::time::Instant;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{CasterMesh, Casters, Inputs, PassConfig, Placed, Target, Transforms};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{AlphaMap, AlphaTested, PixelRays, Roles, TestedTriangle};
use subpixel_shadows::wgpu::BufferUsages;
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

/// Leaves of a tree, two triangles each.
const LEAVES: u32 = 1480;
/// Frames until the lists have found their lengths, and those that are timed.
const FRAMES: [u32; 2] = [4, 3];

/// Rows of a matrix whose fourth column is added.
type Transform = [[f32; 4]; 3];

struct Asked {
    trees: usize,
    size: [u32; 2],
    samples: u32,
    map: u32,
    out: PathBuf,
}

impl Asked {
    fn of(mut words: impl Iterator<Item = String>) -> Result<Self> {
        let mut asked = Self { trees: 676, size: [640, 480], samples: 8, map: 1024, out: "out/forest".into() };
        while let Some(word) = words.next() {
            let value = words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")))?;
            let number = || value.parse::<u32>().map_err(|e| Error::Config(format!("{word} {value}: {e}")));
            match word.as_str() {
                "--trees" => asked.trees = number()?.max(1) as usize,
                "--samples" => asked.samples = number()?,
                "--map" => asked.map = number()?,
                "--size" => asked.size = lab::options::size(&value).map_err(Error::Config)?,
                "--out" => asked.out = value.into(),
                _ => return Err(Error::Config(format!("'{word}' is not known"))),
            }
        }
        Ok(asked)
    }
}

/// Numbers from 0 to 1, the same every time.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::from([0; 3].map(|_| 2.0 * self.unit() - 1.0));
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// A trunk and a crown of cards, about two units high; each card is the whole of the map.
fn tree(map: AlphaMap) -> (Mesh, AlphaTested) {
    let mut mesh = Mesh::default();
    const SIDES: u32 = 9;
    for (height, radius) in [(-0.1, 0.06), (0.7, 0.045), (1.7, 0.012)] {
        for k in 0..SIDES {
            let (s, c) = (std::f32::consts::TAU * k as f32 / SIDES as f32).sin_cos();
            mesh.positions.push([radius * c, height, radius * s]);
        }
    }
    for (ring, k) in (0..2).flat_map(|ring| (0..SIDES).map(move |k| (ring, k))) {
        let at = |ring: u32, k: u32| ring * SIDES + k % SIDES;
        mesh.triangles.push([at(ring, k), at(ring + 1, k), at(ring, k + 1)]);
        mesh.triangles.push([at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)]);
    }
    let mut alpha = AlphaTested { maps: vec![map], triangles: Vec::new() };
    let mut random = Random(7);
    for _ in 0..LEAVES {
        let place = Vec3::new(0.0, 1.25, 0.0) + random.direction() * Vec3::new(0.55, 0.75, 0.55) * random.unit().cbrt();
        let along = random.direction();
        let across = along.any_orthonormal_vector();
        let (along, half) = (along * (0.09 + 0.05 * random.unit()), across * 0.04);
        let first = mesh.positions.len() as u32;
        for corner in [place - half, place + half, place + half + along, place - half + along] {
            mesh.positions.push(corner.into());
        }
        for (corners, uv) in
            [([0, 1, 2], [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), ([0, 2, 3], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]
        {
            alpha.triangles.push(TestedTriangle {
                triangle: mesh.triangles.len() as u32,
                map: 0,
                uv,
                roles: Roles::ALL,
            });
            mesh.triangles.push(corners.map(|k| first + k));
        }
    }
    (mesh, alpha)
}

/// Instance `k` of so many at a moment: turned, of a size of its own, leaning with the wind; the last is the floor.
fn transform(k: usize, trees: usize, moment: f32) -> Transform {
    if k == trees {
        return [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    }
    let side = (trees as f64).sqrt().ceil() as usize;
    let mut random = Random(99 + k as u64);
    random.unit();
    let place = |at: usize, off: f32| 2.8 * (at as f32 + 0.7 * off) - 1.4 * side as f32;
    let (x, z) = (place(k % side, random.unit()), place(k / side, random.unit()));
    let (size, (s, c)) = (0.75 + 0.6 * random.unit(), (std::f32::consts::TAU * random.unit()).sin_cos());
    let lean = 0.05 * (moment + 0.3 * x).sin();
    [[c * size, lean * size, s * size, x], [0.0, size, 0.0, 0.0], [-s * size, 0.0, c * size, z]]
}

fn moved(p: &[f32; 3], t: &Transform) -> [f32; 3] {
    t.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3])
}

/// All instances as one mesh, as they stand.
fn expanded(meshes: &[(Mesh, AlphaTested); 2], instances: &[u32], places: &[Transform]) -> (Mesh, AlphaTested) {
    let (mut all, mut holes) = (Mesh::default(), AlphaTested { maps: meshes[0].1.maps.clone(), triangles: Vec::new() });
    for (of, t) in instances.iter().zip(places) {
        let (mesh, alpha) = &meshes[*of as usize];
        let (vertices, triangles) = (all.positions.len() as u32, all.triangles.len() as u32);
        let placed = alpha.triangles.iter().map(|of| TestedTriangle { triangle: of.triangle + triangles, ..*of });
        holes.triangles.extend(placed);
        all.positions.extend(mesh.positions.iter().map(|p| moved(p, t)));
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + vertices)));
    }
    (all, holes)
}

fn main() -> Result<()> {
    let asked = Asked::of(std::env::args().skip(1))?;
    let leaves = builtin("leaves").ok_or_else(|| Error::Scene("no leaves".to_owned()))?;
    let map = leaves.alpha.maps.first().cloned().ok_or_else(|| Error::Scene("leaves without a map".to_owned()))?;
    let reach = 1.45 * (asked.trees as f64).sqrt().ceil() as f32 + 3.0;
    let corners = [[-reach, 0.0, -reach], [reach, 0.0, -reach], [reach, 0.0, reach], [-reach, 0.0, reach]];
    let floor = Mesh { positions: corners.to_vec(), triangles: vec![[0, 2, 1], [0, 3, 2]] };
    let meshes = [tree(map), (floor, AlphaTested::default())];
    let instances: Vec<u32> = (0..asked.trees).map(|_| 0).chain([1]).collect();
    let places =
        |moment: f32| -> Vec<Transform> { (0..=asked.trees).map(|k| transform(k, asked.trees, moment)).collect() };
    let gpu = Gpu::open(None)?;
    let samples = Samples::new(Pattern::default(), asked.samples)?;
    let settings = Settings { facets: FacetMode::All, ..Settings::new(asked.size, asked.map, samples) };
    let given = [
        CasterMesh { alpha: Some(&meshes[0].1), ..CasterMesh::new(&meshes[0].0.positions, &meshes[0].0.triangles) },
        CasterMesh::new(&meshes[1].0.positions, &meshes[1].0.triangles),
    ];
    let started = Instant::now();
    let casters = Casters::Instanced { meshes: &given, instances: &instances };
    let config = PassConfig { timing: true, ..PassConfig::new(settings.clone(), casters) };
    let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
    let count = asked.trees * meshes[0].0.triangles.len() + 2;
    println!(
        "{} ({}): {} trees, {count} triangles; the pass was made in {:.1} s",
        gpu.adapter.name,
        gpu.adapter.driver,
        asked.trees,
        started.elapsed().as_secs_f64()
    );
    let transforms = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("forest.transforms"),
        size: 48 * instances.len() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let camera = Camera {
        eye: [0.0, 7.0, 0.55 * reach],
        target: [0.0, 0.3, 0.05 * reach],
        far: 100.0 * reach,
        near: 0.01,
        ..leaves.camera
    };
    let light = Light::Directional { direction: [-0.7, 0.75, 0.35] };
    let bounds = [[-reach, -0.3, -reach], [reach, 3.2, reach]];
    let mut now = places(0.0);
    let mut times = Vec::new();
    for frame in 0..FRAMES[0] + FRAMES[1] {
        now = places(0.4 * frame as f32);
        gpu.queue.write_buffer(&transforms, 0, bytemuck::cast_slice(&now));
        let placed = Some(Placed { transforms: Transforms { buffer: &transforms, offset: 0 }, bounds });
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &Inputs { placed, ..Inputs::new(&camera, &light) }, &Target::default())?;
        gpu.submit_and_wait(encoder)?;
        let status = status_of(&mut pass);
        if frame >= FRAMES[0] {
            if !status.complete {
                return Err(Error::Gpu(format!("frame {frame} is not complete: {status:?}")));
            }
            times.push(status.stages.iter().map(|s| s.gpu_ms).sum::<f64>());
        }
    }
    times.sort_by(f64::total_cmp);
    println!(
        "a frame takes {:.0} ms of the GPU; {} MiB are held",
        times[times.len() / 2],
        pass.memory().iter().map(|b| b.bytes).sum::<u64>() >> 20
    );
    let visibility = read(&gpu, &pass.visibility().clone())?;
    check(&asked, &settings, (&camera, &light), expanded(&meshes, &instances, &now), &visibility)
}

/// Holds the picture against rays and writes it.
fn check(
    asked: &Asked,
    settings: &Settings,
    (camera, light): (&Camera, &Light),
    (mesh, alpha): (Mesh, AlphaTested),
    visibility: &[f32],
) -> Result<()> {
    let prepared = Prepared::with_alpha(&mesh, &alpha)?;
    let tracer = Tracer::of(&prepared)?;
    let truth = TracedScene::new(&tracer, camera, light, settings, None)?;
    let errors = truth.errors(visibility)?;
    let [w, h] = asked.size;
    let rays: PixelRays = camera.rays(w, h);
    let triangle = |pixel: u32| {
        let direction: DVec3 = rays.direction(f64::from(pixel % w) + 0.5, f64::from(pixel / w) + 0.5);
        tracer.closest(rays.eye, direction, 0.0).map_or(u32::MAX, |hit| hit.triangle)
    };
    let triangles: Vec<u32> = (0..w * h).map(triangle).collect();
    let picture =
        shade(&Shading { mesh: prepared.mesh(), camera, light, size: asked.size, triangles: &triangles, visibility });
    std::fs::create_dir_all(&asked.out).map_err(|e| Error::file(&asked.out, e.to_string()))?;
    let file = |name: &str| -> PathBuf { Path::new(&asked.out).join(name) };
    write_png_rgb(&file("forest.png"), w, h, &picture)?;
    write_difference(&file("difference.png"), w, h, visibility, truth.visibility())?;
    println!(
        "checked against rays through the same {} samples: RMSE {:.5}, largest difference {:.3}, {:.3} % of {} pixels within one sample; wrote {}",
        u64::from(w) * u64::from(h) * u64::from(asked.samples),
        errors.scene_rmse,
        errors.scene_max,
        100.0 * errors.scene_pixel_match.unwrap_or(1.0),
        errors.scene_pixels,
        asked.out.display()
    );
    if errors.scene_rmse > 0.01 {
        return Err(Error::Config(format!("the picture is not that of rays: RMSE {}", errors.scene_rmse)));
    }
    Ok(())
}
