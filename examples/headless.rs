//! Shadows of a mesh without a window: triangles in, visibility of each pixel out.
//!
//! `cargo run --release --example headless`

use lab::report::write_png_grey;
use std::path::Path;
use subpixel_shadows::Error;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};

fn main() -> subpixel_shadows::Result<()> {
    // A ground square with a triangle standing on it.
    let mesh = Mesh {
        positions: vec![
            [-3.0, 0.0, -3.0],
            [3.0, 0.0, -3.0],
            [3.0, 0.0, 3.0],
            [-3.0, 0.0, 3.0],
            [-1.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.5, 0.0],
        ],
        triangles: vec![[0, 2, 1], [0, 3, 2], [4, 5, 6]],
    };
    mesh.check("example")?;
    let camera = Camera {
        eye: [2.0, 3.0, 5.0],
        target: [0.0, 0.4, 0.0],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 45.0,
        near: 0.01,
        far: 100.0,
        lens: Lens::CENTRED,
        near_plane: None,
    };
    let light = Light::Directional { direction: [0.9, 1.0, 0.5] };
    let settings = Settings::new([320, 240], 128, Samples::new(Pattern::LowDiscrepancy, 32)?);

    // The mesh is prepared and uploaded once, pipelines and memory are made once; frames are rendered as often as wanted.
    let gpu = Gpu::open(None)?;
    let prepared = Prepared::new(&mesh)?;
    let mut renderer = Renderer::new(&gpu, &prepared, &settings, Budget::default())?;
    let frame = renderer.render(&camera, &light)?;

    let partly = frame.visibility.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
    println!("{}: {partly} of {} pixels lie partly in shadow", gpu.adapter.name, frame.visibility.len());
    let path = Path::new("out/headless.png");
    std::fs::create_dir_all("out").map_err(|e| Error::file("out", e.to_string()))?;
    write_png_grey(path, settings.size[0], settings.size[1], &frame.visibility)?;
    println!("wrote {}", path.display());
    Ok(())
}
