use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::fixed::FixedRenderer;
use subpixel_shadows::methods::spsm::Spsm;
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Scene, SceneOptions};
use subpixel_shadows::truth::{SceneTruth, Tracer};
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::frame::Frame;
fn main() {
    let gpu = Gpu::open(None).unwrap();
    let scene = Scene::open(&std::env::args().nth(1).unwrap(), &SceneOptions { ground: true, ..Default::default() }).unwrap();
    let prepared = Prepared::new(&scene.mesh);
    let samples = Samples::new(Pattern::default(), 1).unwrap();
    let tracer = Tracer::new(&prepared.mesh).unwrap();
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, 1280, 720).unwrap().image(None).visibility();
    let settings = Settings::new([1280, 720], 2048, samples.clone());
    let mut r = FixedRenderer::new(&gpu, &prepared, &settings, |_| Spsm::new(&gpu, &settings)).unwrap();
    let out = r.render(&scene.camera, &scene.light).unwrap();
    let classes = r.method().pixels().classes.read(&gpu).unwrap();
    let ids = r.method().texels().id_keys.read(&gpu).unwrap();
    let view = LightView::fit(&prepared.mesh, &scene.light, 2048).unwrap();
    let frame = Frame::new(&scene.camera, &scene.light, &view, prepared.mesh.bounds().unwrap(), [1280, 720], &samples);
    println!("map_margin {} depth_margin {}", frame.map_margin, frame.depth_margin);
    let rays = scene.camera.rays(1280, 720);
    let mut shown = 0; let mut by = [0; 5];
    for (p, (&g, &t)) in out.visibility.iter().zip(&truth).enumerate() {
        if g < t { by[classes[p] as usize] += 1; }
        if g < t && shown < 12 && p % 7 == 0 {
            shown += 1;
            let (x, y) = (p % 1280, p / 1280);
            let dir = rays.direction(x as f64 + 0.5, y as f64 + 0.5);
            let hit = tracer.closest(rays.eye, dir, 0.0).unwrap();
            let at = rays.eye + dir * hit.t;
            let m = view.project(at).unwrap();
            println!("pixel {x} {y} class {} tri {} map {:?}", classes[p], out.triangles[p], m);
            for dy in -1..=1i64 { for dx in -1..=1i64 {
                let (tx, ty) = (m.x.floor() as i64 + dx, m.y.floor() as i64 + dy);
                let id = !ids[(ty * 2048 + tx) as usize];
                if id == u32::MAX { print!(" [none]"); continue; }
                let c = prepared.mesh.corners(id as usize).map(|p| view.project(p).unwrap());
                let f = subpixel_shadows::reference::view::Flat::new(c);
                let rf = subpixel_shadows::reference::view::Flat::new(prepared.mesh.corners(out.triangles[p] as usize).map(|p| view.project(p).unwrap()));
                let q = subpixel_shadows::glam::DVec2::new(m.x, m.y);
                let e = f.inside(q).iter().fold(9e9f64, |a, &b| a.min(b));
                let s = f.slope.unwrap_or_default();
                let z = c[0].z + s.dot(q - c[0].truncate());
                print!(" [{id} in {:.4} dz {:.6} slope {:.3?} {:.3?} rs {:.3?}]", e, z - m.z, s.x, s.y, rf.slope);
            } println!(); }
        }
    }
    println!("{by:?}");
}
