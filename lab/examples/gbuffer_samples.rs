//! Surfaces that a G-buffer of several samples a pixel misses, as a table: `facet-masks` in a `ShadowPass` that is given triangle numbers
//! at 4, 8 and 32 places of each pixel, beside one facet a pixel and beside the search for every surface.
//! `cargo run --release --example gbuffer_samples -- [--size WxH] [--map N] [SCENE …] > table.md`
//!
//! The picture has 32 samples of the low-discrepancy pattern. The G-buffers have other places: those of hardware's four
//! samples, and of the rotated grids of 8 and 32.

use lab::arguments::Arguments;
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer, TruthImage};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{Casters, GBuffer, Inputs, PassConfig, SampleTexture, Target};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};

/// Places in the pixel, and of each of them the triangle at every pixel.
type Layers = (Vec<[f32; 2]>, Vec<Vec<u32>>);

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
    let rotated = |count| -> Result<Layers> {
        let samples = Samples::new(Pattern::Rotated, count)?;
        let layers =
            seen_by_samples(gpu, scene, &prepared, Settings { samples: samples.clone(), ..settings(FacetMode::All) })?;
        Ok((samples.offsets().to_vec(), layers))
    };
    let four = (SampleTexture::STANDARD_4.to_vec(), seen_by_four(gpu, scene, &prepared, settings(FacetMode::One))?);
    for (places, layers) in [four, rotated(8)?, rotated(32)?] {
        let texture = texture(gpu, size, &layers);
        let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, &places));
        let visibility = frame(gpu, &mut all, &Inputs { gbuffer, ..plain })?;
        row(&format!("triangles at {} places", places.len()), &visibility);
    }
    row("nothing, every surface", &frame(gpu, &mut all, &plain)?);
    Ok(())
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

/// The triangle that each sample of a pattern sees, by the search for every surface.
fn seen_by_samples(gpu: &Gpu, scene: &Scene, prepared: &Prepared, settings: Settings) -> Result<Vec<Vec<u32>>> {
    let (samples, pixels) = (settings.samples.clone(), settings.pixels());
    let mut renderer = Renderer::new(gpu, prepared, &settings, Budget::default())?;
    renderer.render(&scene.camera, &scene.light)?;
    let facets = renderer.facets().ok_or_else(|| Error::Config("no facets".to_owned()))?;
    let (list, masks, ends) = (facets.list.read(gpu)?, facets.masks.read(gpu)?, facets.pixel_facets.read(gpu)?);
    let words = samples.words() as usize;
    let mut layers = vec![vec![u32::MAX; pixels]; samples.count() as usize];
    for (f, facet) in list.iter().enumerate().take(ends[pixels] as usize) {
        for (k, layer) in layers.iter_mut().enumerate() {
            if masks[3 * words * f + k / 32] >> (k % 32) & 1 == 1 {
                layer[facet.pixel as usize] = prepared.given[facet.triangle as usize];
            }
        }
    }
    Ok(layers)
}

/// The triangles at hardware's four places: they are pixel centres of an image of four times the size.
fn seen_by_four(gpu: &Gpu, scene: &Scene, prepared: &Prepared, settings: Settings) -> Result<Vec<Vec<u32>>> {
    let [w, h] = settings.size;
    let fine = Settings { size: [4 * w, 4 * h], samples: Samples::new(Pattern::Grid, 1)?, ..settings };
    let mut renderer = Renderer::new(gpu, prepared, &fine, Budget::default())?;
    let triangles = renderer.render(&scene.camera, &scene.light)?.triangles;
    let at = |x: u32, y: u32, [px, py]: [f32; 2]| {
        let (x, y) = (4 * x + (px * 4.0) as u32, 4 * y + (py * 4.0) as u32);
        prepared.given.get(triangles[(y * 4 * w + x) as usize] as usize).copied().unwrap_or(u32::MAX)
    };
    let layer = |place| (0..w * h).map(|p| at(p % w, p / w, place)).collect();
    Ok(SampleTexture::STANDARD_4.into_iter().map(layer).collect())
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
