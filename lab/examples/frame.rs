//! The smallest frame with shadows: triangles drawn forward, lit by one light, whose visibility comes from a pass of two functions.
//!
//! `cargo run --release --example frame -- [--scene NAME] [--size WxH] [--samples N] [--out DIR]` draws until a frame is complete, holds its visibility
//! against rays, and writes `frame.png` and `difference.png`; with `--features subpixel-shadows-lab/window` and `--window` it turns in a window.

#[path = "shared/draw.rs"]
mod draw;
#[path = "shared/picture.rs"]
mod picture;
#[path = "shared/read.rs"]
mod read;
#[cfg(feature = "window")]
#[path = "shared/window.rs"]
mod window;

use draw::Draw;
use lab::report::{TracedScene, write_difference, write_png_rgb};
use lab::scene::{Camera, Light, Mesh, Scene, builtin};
use oracle::truth::Tracer;
use picture::picture;
use read::read;
use std::path::PathBuf;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::pass::{Casters, Inputs, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::wgpu::TextureFormat;
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

// The shadow part begins.
fn shadows(gpu: &Gpu, mesh: &Mesh, size: [u32; 2], samples: u32) -> Result<ShadowPass> {
    let settings = Settings::new(size, 512, Samples::new(Pattern::LowDiscrepancy, samples)?);
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    ShadowPass::new(&gpu.device, &gpu.queue, &PassConfig::new(settings, casters))
}

fn record_shadows(
    pass: &mut ShadowPass,
    encoder: &mut wgpu::CommandEncoder,
    (camera, light): (&Camera, &Light),
    visibility: &wgpu::Texture,
) -> Result<u64> {
    pass.record(encoder, &Inputs::new(camera, light), &Target::texture(visibility))
}
// The shadow part ends.

struct Asked {
    scene: String,
    size: [u32; 2],
    samples: u32,
    window: bool,
    out: PathBuf,
}

impl Asked {
    fn of(mut words: impl Iterator<Item = String>) -> Result<Self> {
        let mut asked =
            Self { scene: "windmill".into(), size: [640, 480], samples: 32, window: false, out: "out/frame".into() };
        while let Some(word) = words.next() {
            if word == "--window" {
                asked.window = true;
                continue;
            }
            let value = words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")))?;
            match word.as_str() {
                "--scene" => asked.scene = value,
                "--samples" => {
                    asked.samples = value.parse().map_err(|e| Error::Config(format!("{word} {value}: {e}")))?;
                }
                "--size" => asked.size = lab::options::size(&value).map_err(Error::Config)?,
                "--out" => asked.out = value.into(),
                _ => return Err(Error::Config(format!("'{word}' is not known"))),
            }
        }
        Ok(asked)
    }
}

fn main() -> Result<()> {
    let asked = Asked::of(std::env::args().skip(1))?;
    let scene =
        builtin(&asked.scene).ok_or_else(|| Error::Config(format!("no built-in scene is called '{}'", asked.scene)))?;
    match asked.window {
        #[cfg(feature = "window")]
        true => turning(asked, scene),
        #[cfg(not(feature = "window"))]
        true => Err(Error::Config("--window: built without the feature window".to_owned())),
        false => headless(&asked, &scene),
    }
}

fn headless(asked: &Asked, scene: &Scene) -> Result<()> {
    let gpu = Gpu::open(None)?;
    let mut pass = shadows(&gpu, &scene.mesh, asked.size, asked.samples)?;
    let draw = Draw::new(&gpu.device, &scene.mesh, asked.size, TextureFormat::Rgba8Unorm)?;
    let image = draw.target(&gpu.device);
    for round in 1.. {
        let mut encoder = gpu.encoder();
        record_shadows(&mut pass, &mut encoder, (&scene.camera, &scene.light), &draw.visibility)?;
        draw.record(&gpu, &mut encoder, (&scene.camera, &scene.light), &image.create_view(&Default::default()))?;
        gpu.submit_and_wait(encoder)?;
        let status = status_of(&mut pass);
        if status.complete {
            println!("{}: {}, complete in round {round}", gpu.adapter.name, asked.scene);
            break;
        }
        if round == 6 {
            return Err(Error::Gpu(format!("no complete frame: {status:?}")));
        }
    }
    let lines = include_str!("frame.rs")
        .split("// The shadow part")
        .nth(1)
        .map_or(0, |text| text.lines().skip(1).filter(|line| !line.trim().is_empty()).count());
    println!("the shadow part has {lines} lines");
    check(asked, scene, &gpu, &pass, &image)
}

/// Holds the picture against rays and writes it.
fn check(asked: &Asked, scene: &Scene, gpu: &Gpu, pass: &ShadowPass, image: &wgpu::Texture) -> Result<()> {
    let visibility = read(gpu, pass.visibility())?;
    let tracer = Tracer::of(&Prepared::new(&scene.mesh)?)?;
    let truth = TracedScene::new(&tracer, &scene.camera, &scene.light, pass.settings(), None)?;
    let errors = truth.errors(&visibility)?;
    let ([w, h], out) = (asked.size, &asked.out);
    std::fs::create_dir_all(out).map_err(|e| Error::file(out, e.to_string()))?;
    write_png_rgb(&out.join("frame.png"), w, h, &picture(gpu, image)?)?;
    write_difference(&out.join("difference.png"), w, h, &visibility, truth.visibility())?;
    println!(
        "checked against rays through the same {} samples: RMSE {:.5}, largest difference {:.3}, {:.3} % of {} pixels within one sample; wrote {}",
        u64::from(w) * u64::from(h) * u64::from(asked.samples),
        errors.scene_rmse,
        errors.scene_max,
        100.0 * errors.scene_pixel_match.unwrap_or(1.0),
        errors.scene_pixels,
        out.display()
    );
    if errors.scene_rmse > 0.01 {
        return Err(Error::Config(format!("the picture is not that of rays: RMSE {}", errors.scene_rmse)));
    }
    Ok(())
}

/// The same in a window, the camera going around.
#[cfg(feature = "window")]
fn turning(asked: Asked, scene: Scene) -> Result<()> {
    struct Turning {
        scene: Scene,
        pass: ShadowPass,
        draw: Draw,
    }
    impl window::Drawn for Turning {
        fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<()> {
            self.pass.set_size(size)?;
            self.draw.resize(&gpu.device, size);
            Ok(())
        }

        fn record(
            &mut self,
            gpu: &Gpu,
            encoder: &mut wgpu::CommandEncoder,
            seconds: f32,
            to: &wgpu::TextureView,
        ) -> Result<()> {
            let camera = draw::around(&self.scene.camera, 0.3 * seconds);
            let seen = (&camera, &self.scene.light);
            record_shadows(&mut self.pass, encoder, seen, &self.draw.visibility)?;
            self.draw.record(gpu, encoder, seen, to)
        }
    }
    window::run("frame", asked.size, move |gpu, size, format| {
        let pass = shadows(gpu, &scene.mesh, size, asked.samples)?;
        let draw = Draw::new(&gpu.device, &scene.mesh, size, format)?;
        Ok(Turning { scene, pass, draw })
    })
}
