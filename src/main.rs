//! The program.
use subpixel_shadows as ss;
fn main() -> Result<(), ss::Error> {
    use ss::methods::{Prepared, facet_masks::Settings, render::*};
    let name = std::env::args().nth(1).unwrap_or("windmill".into());
    let n: u32 = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(32);
    let settle = std::env::args().nth(3).is_none_or(|s| s != "all");
    let t0 = std::time::Instant::now();
    let scene = ss::scene::Scene::open(&name, &Default::default())?;
    eprintln!("open {:?}", t0.elapsed());
    let prepared = Prepared::new(&scene.mesh);
    eprintln!(
        "prepared {:?} tris {} edges {} closed {}",
        t0.elapsed(),
        prepared.mesh.triangles.len(),
        prepared.edges.len(),
        prepared.closed
    );
    let gpu = ss::gpu::Gpu::open(None)?;
    eprintln!("{:?} {:?}", gpu.adapter, t0.elapsed());
    let settings = Settings {
        size: [800, 600],
        map: 512,
        samples: ss::samples::Samples::new(Default::default(), n)?,
        validity: true,
        cull_back: false,
        settle,
    };
    let mut r = Renderer::new(&gpu, &prepared, &settings, Budget::default())?;
    eprintln!("built {:?}", t0.elapsed());
    let mut out = r.render(&scene.camera, &scene.light)?;
    for _ in 0..3 {
        out = r.render(&scene.camera, &scene.light)?;
    }
    eprintln!("rendered {:?}", t0.elapsed());
    println!("{:#?}", out.counts);
    println!("{:?}", out.lists);
    for s in &out.stages {
        println!("{:24} {:8.3}", s.name, s.gpu_ms);
    }
    println!(
        "sum {:.3} wall {:.3} dispatches {}",
        out.stages.iter().map(|s| s.gpu_ms).sum::<f64>(),
        out.wall_ms,
        out.dispatches
    );
    let img = image_of(&out.visibility);
    std::fs::create_dir_all("out").ok();
    image::GrayImage::from_raw(800, 600, img).unwrap().save(format!("out/{name}.png")).unwrap();
    let mask = r.method().layers().splits.read(&gpu)?;
    let m = mask
        .iter()
        .map(|&v| {
            if v == -2.0 {
                255
            } else if v == -1.0 {
                0
            } else {
                100
            }
        })
        .collect();
    image::GrayImage::from_raw(512, 512, m).unwrap().save(format!("out/{name}_mask.png")).unwrap();
    Ok(())
}
fn image_of(v: &[f32]) -> Vec<u8> {
    v.iter().map(|x| (x * 255.0).round() as u8).collect()
}
