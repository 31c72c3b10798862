//! Surfaces that G-buffers miss, as a table: `facet-masks` in a `ShadowPass` that is given triangle numbers
//! at 4, 8 and 32 places of each pixel, or the depth of a ground that is no caster, beside one facet a pixel and beside the search for every surface.
//! `cargo run --release --example gbuffer_samples -- [--size WxH] [--map N] [SCENE …] > table.md`
//!
//! The picture has 32 samples of the low-discrepancy pattern. The G-buffers have other places: those of hardware's four
//! samples, and of the rotated grids of 8 and 32.

use lab::arguments::Arguments;
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer, TruthImage};
use subpixel_shadows::glam::Vec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, DepthTerms, GBuffer, Inputs, PassConfig, SampleTexture, SurfacePosition, SurfaceTextures, Target,
};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Mesh};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};

fn main() -> Result<()> {
    let arguments = Arguments::of(std::env::args().skip(1))?;
    let gpu = Gpu::open(None)?;
    let [w, h] = arguments.size;
    let given = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    println!("`cargo run --release --example gbuffer_samples -- {given}`\n");
    println!("{}; {w} x {h} pixels, 32 samples, map {}.\n", gpu.adapter.name, arguments.map);
    println!("| scene | what the pass is given | pixels off by more than 1/32 | by more than 1/8 | RMSE |");
    println!("|---|---|---|---|---|");
    for name in &arguments.scenes {
        let scene = Scene::open(name, &SceneOptions::default())?;
        table(&gpu, &scene, arguments.size, arguments.map)?;
    }
    Ok(())
}

fn table(gpu: &Gpu, scene: &Scene, size: [u32; 2], map: u32) -> Result<()> {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32)?;
    let prepared = scene.prepared()?;
    let tracer = Tracer::of(&prepared)?;
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, size[0], size[1])?.image(None);
    let settings = |facets| Settings { facets, ..Settings::new(size, map, samples.clone()) };
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let make = |facets| ShadowPass::new(&gpu.device, &gpu.queue, &PassConfig::new(settings(facets), casters));
    let (mut one, mut all) = (make(FacetMode::One)?, make(FacetMode::All)?);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let row = |what: &str, visibility: &[f32]| println!("| {} | {what} | {} |", scene.name, errors(visibility, &truth));
    row("nothing, one facet a pixel", &frame(gpu, &mut one, &plain)?);
    let rotated = |count| Samples::new(Pattern::Rotated, count).map(|samples| samples.offsets().to_vec());
    for places in [SampleTexture::STANDARD_4.to_vec(), rotated(8)?, rotated(32)?] {
        let layers = seen_at(gpu, scene, &prepared, &settings(FacetMode::One), &places)?;
        let texture = texture(gpu, size, &layers);
        let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, &places));
        let visibility = frame(gpu, &mut all, &Inputs { gbuffer, ..plain })?;
        row(&format!("triangles at {} places", places.len()), &visibility);
    }
    row("nothing, every surface", &frame(gpu, &mut all, &plain)?);
    let ground = Ground::new(gpu, scene, &prepared, &settings(FacetMode::One))?;
    for (facets, what) in [(FacetMode::One, "one facet a pixel"), (FacetMode::All, "every surface")] {
        let Mesh { positions, triangles } = &ground.casters;
        let casters = Casters::Static { positions, triangles };
        let config = PassConfig { receivers: true, ..PassConfig::new(settings(facets), casters) };
        let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
        for (given, normals) in [("depth", None), ("depth and normals", Some(&ground.normals))] {
            let gbuffer = GBuffer::Surfaces(SurfaceTextures { normals, ..SurfaceTextures::new(ground.place()) });
            let visibility = frame(gpu, &mut pass, &Inputs { gbuffer, ..plain })?;
            row(&format!("its ground, in {:.0} % of the pixels, by {given}, {what}", ground.percent), &visibility);
        }
    }
    Ok(())
}

/// A scene whose ground, all triangles at its lowest height or longer than a quarter of it, is no caster, and textures of all that is seen at pixel
/// centres.
struct Ground {
    casters: Mesh,
    percent: f64,
    depth: wgpu::Texture,
    normals: wgpu::Texture,
}

/// Depth terms of the texture.
fn terms() -> DepthTerms {
    DepthTerms::reversed_infinite(0.01)
}

impl Ground {
    fn new(gpu: &Gpu, scene: &Scene, prepared: &Prepared, settings: &Settings) -> Result<Self> {
        let mesh = &scene.mesh;
        let (low, high) = mesh.bounds().unwrap_or_default();
        let is_low = |v: u32| f64::from(mesh.positions[v as usize][1]) < low.y + 1e-3 * (high.y - low.y);
        let place = |v: u32| Vec3::from(mesh.positions[v as usize]).as_dvec3();
        let is_long = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(place);
            (b - a).length().max((c - a).length()) > 0.25 * (high - low).length()
        };
        let casts = |t: &[u32; 3]| !t.iter().all(|&v| is_low(v)) && !is_long(*t);
        let triangles = mesh.triangles.iter().copied().filter(casts).collect();
        let mut renderer = Renderer::new(gpu, prepared, settings, Budget::default())?;
        let seen = renderer.render(&scene.camera, &scene.light)?.triangles;
        let [w, h] = settings.size;
        let rays = scene.camera.rays(w, h);
        let (mut depths, mut normals, mut count) = (Vec::new(), Vec::new(), 0);
        for pixel in 0..w * h {
            let ray = rays.direction(f64::from(pixel % w) + 0.5, f64::from(pixel / w) + 0.5);
            let plane = prepared.given.get(seen[pixel as usize] as usize).map(|&t| {
                let [a, b, c] = mesh.corners(t as usize);
                count += u32::from(!casts(&mesh.triangles[t as usize]));
                let normal = (b - a).cross(c - a);
                (normal.dot(a - rays.eye) / normal.dot(ray), normal.normalize())
            });
            depths.push(plane.map_or(0.0, |(depth, _)| terms().offset / depth as f32));
            normals.push(plane.map_or([0.0; 4], |(_, normal)| normal.as_vec3().extend(0.0).into()));
        }
        let normals = upload(gpu, settings.size, wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&normals));
        let depth = upload(gpu, settings.size, wgpu::TextureFormat::R32Float, bytemuck::cast_slice(&depths));
        let percent = 100.0 * f64::from(count) / f64::from(w * h);
        Ok(Self { percent, casters: Mesh { positions: mesh.positions.clone(), triangles }, depth, normals })
    }

    fn place(&self) -> SurfacePosition<'_> {
        SurfacePosition::Depth { texture: &self.depth, terms: terms(), nothing: 0.0 }
    }
}

fn upload(gpu: &Gpu, [width, height]: [u32; 2], format: wgpu::TextureFormat, bytes: &[u8]) -> wgpu::Texture {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("surfaces"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    let row = Some(bytes.len() as u32 / height);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: row, rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), bytes, layout, size);
    texture
}

/// Shares of all pixels that are off, and the error.
fn errors(visibility: &[f32], truth: &TruthImage) -> String {
    let off: Vec<f64> =
        visibility.iter().zip(&truth.pixels).map(|(v, t)| f64::from((v - t.visibility).abs())).collect();
    let count = off.len() as f64;
    let above = |least: f64| 100.0 * off.iter().filter(|&&d| d > least + 1e-6).count() as f64 / count;
    let rmse = (off.iter().map(|d| d * d).sum::<f64>() / count).sqrt();
    format!("{:.4} % | {:.4} % | {rmse:.5}", above(1.0 / 32.0), above(1.0 / 8.0))
}

/// The triangle at every pixel, for each of some places in the pixel, to which a lens moves its centre.
fn seen_at(
    gpu: &Gpu,
    scene: &Scene,
    prepared: &Prepared,
    settings: &Settings,
    places: &[[f32; 2]],
) -> Result<Vec<Vec<u32>>> {
    let one = Settings { samples: Samples::new(Pattern::Grid, 1)?, ..settings.clone() };
    let mut renderer = Renderer::new(gpu, prepared, &one, Budget::default())?;
    let mut seen = |&[x, y]: &[f32; 2]| {
        let lens = scene.camera.lens.jittered([x - 0.5, y - 0.5], one.size);
        let triangles = renderer.render(&Camera { lens, ..scene.camera }, &scene.light)?.triangles;
        Ok(triangles.iter().map(|&t| prepared.given.get(t as usize).copied().unwrap_or(u32::MAX)).collect())
    };
    places.iter().map(&mut seen).collect()
}

fn texture(gpu: &Gpu, [width, height]: [u32; 2], layers: &[Vec<u32>]) -> wgpu::Texture {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers.len() as u32 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("triangles"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: Some(height) };
    gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&layers.concat()), layout, size);
    texture
}

/// The visibility of the first complete frame.
fn frame(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs) -> Result<Vec<f32>> {
    let [w, h] = pass.settings().size;
    for _ in 0..6 {
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, inputs, &Target::default())?;
        gpu.submit_and_wait(encoder)?;
        if pass.status().is_some_and(|s| s.complete) {
            let visibility =
                subpixel_shadows::gpu::Buffer::<f32>::storage(&gpu.device, "visibility", (w * h) as usize)?;
            let mut encoder = gpu.encoder();
            encoder.copy_buffer_to_buffer(pass.visibility(), 0, visibility.raw(), 0, u64::from(w * h) * 4);
            gpu.submit_and_wait(encoder)?;
            return visibility.read(gpu);
        }
    }
    Err(Error::Gpu("no frame was complete".to_owned()))
}
