//! A frame of an orthographic camera, held against parallel rays of the world itself.
//!
//! `cargo run --release --example orthographic -- [--size WxH] [--samples N] [--out DIR]` writes the visibility of `windmill`, seen isometrically, as the
//! pass and as rays have it, and where they differ; it prints how far they are apart.

#[path = "shared/asked.rs"]
mod asked;
#[path = "shared/read.rs"]
mod read;

use asked::Asked;
use lab::report::{write_difference, write_png_grey};
use lab::scene::builtin;
use oracle::truth::Tracer;
use read::read;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{CasterMesh, Casters, Inputs, PassConfig, Placed, Target, Transforms};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Light, Orthographic};
use subpixel_shadows::{Error, Result, ShadowPass};
use test_support::status_of;

/// Where the one instance is: rows of a matrix whose fourth column is added.
const SAME: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

fn main() -> Result<()> {
    let asked = Asked::of(std::env::args().skip(1), "target/orthographic")?;
    let scene = builtin("windmill").ok_or_else(|| Error::Scene("no windmill".to_owned()))?;
    let (mesh, light) = (&scene.mesh, scene.light);
    let (low, high) = mesh.bounds().unwrap_or_default();
    let bounds = [low, high].map(|p| p.as_vec3().into());
    let (target, far) = (Vec3::from(scene.camera.target), (high - low).length() as f32);
    let height = 0.6 * target.distance(Vec3::from(scene.camera.eye));
    let camera = Orthographic::look_at((target + Vec3::ONE * far).into(), target.into(), [0.0, 1.0, 0.0], height);

    let gpu = Gpu::open(None)?;
    let samples = Samples::new(Pattern::default(), asked.samples)?;
    let settings = Settings { facets: FacetMode::All, ..Settings::new(asked.size, 512, samples) };
    let given = [CasterMesh::new(&mesh.positions, &mesh.triangles)];
    let casters = Casters::Instanced { meshes: &given, instances: &[0] };
    let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &PassConfig::new(settings, casters))?;
    let transforms = Buffer::from_slice(&gpu.device, &gpu.queue, "transforms", &[SAME])?;
    let view = camera.in_world(bounds, &[light], asked.size)?;
    let placed = Placed { transforms: Transforms { buffer: transforms.raw(), offset: 0 }, bounds };
    let inputs = Inputs { placed: Some(placed), ..Inputs::orthographic(&view, &light) };
    for round in 1.. {
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &inputs, &Target::default())?;
        gpu.submit_and_wait(encoder)?;
        let status = status_of(&mut pass);
        if status.complete {
            println!("{}: complete in round {round}", gpu.adapter.name);
            break;
        }
        if round == 6 {
            return Err(Error::Gpu(format!("no complete frame: {status:?}")));
        }
    }
    let mut got = read(&gpu, pass.visibility())?;
    let pixels = asked.size[0] * asked.size[1];
    got.truncate(pixels as usize);

    let tracer = Tracer::new(mesh)?;
    let offsets = pass.settings().samples.offsets();
    let wanted: Vec<f32> = (0..pixels)
        .map(|pixel| {
            let [x, y] = [pixel % asked.size[0], pixel / asked.size[0]].map(f64::from);
            let at = |o: &[f32; 2]| camera.ray([x + f64::from(o[0]), y + f64::from(o[1])], asked.size);
            let lit: Vec<bool> = offsets.iter().filter_map(|o| is_lit(&tracer, &light, at(o))).collect();
            if lit.is_empty() { 1.0 } else { lit.iter().filter(|l| **l).count() as f32 / lit.len() as f32 }
        })
        .collect();
    let off: Vec<f64> = got.iter().zip(&wanted).map(|(a, b)| f64::from((a - b).abs())).collect();
    let rmse = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
    let apart = off.iter().filter(|d| **d > 1.5 / f64::from(asked.samples)).count();
    let ([w, h], out) = (asked.size, &asked.out);
    std::fs::create_dir_all(out).map_err(|e| Error::file(out, e.to_string()))?;
    for (name, picture) in [("visibility.png", &got), ("rays.png", &wanted)] {
        write_png_grey(&out.join(name), w, h, picture)?;
    }
    write_difference(&out.join("difference.png"), w, h, &got, &wanted)?;
    println!(
        "checked against parallel rays through the same {} samples: RMSE {rmse:.5}, {apart} of {pixels} pixels off by more than a sample; wrote {}",
        u64::from(pixels) * u64::from(asked.samples),
        out.display()
    );
    if rmse > 0.01 {
        return Err(Error::Config(format!("the picture is not that of rays: RMSE {rmse}")));
    }
    Ok(())
}

/// Whether what a ray sees is lit; `None` where it sees nothing.
fn is_lit(tracer: &Tracer, light: &Light, (from, way): (DVec3, DVec3)) -> Option<bool> {
    let hit = tracer.closest(from, way, 0.0)?;
    let [a, b, c] = tracer.corners(hit.triangle);
    let (normal, place) = ((b - a).cross(c - a), from + way * hit.t);
    let faces = normal.dot(-way) * normal.dot(light.towards(place)) > 0.0;
    let shade = tracer.shade(place, hit.error, light.homogeneous(), &|t| t == hit.triangle);
    Some(faces && !shade.occluded)
}
