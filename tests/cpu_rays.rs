//! `ray-traced` of the CPU engine against scene truth, on small pictures. It works in single precision and proves nothing: few samples off
//! the ambiguity band may be wrong.

use lab::scene::{Scene, builtin};
use oracle::engine::{self, CpuRays};
use oracle::truth::{SceneTruth, Tracer, join_mask};
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::render::Output;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};

/// Odd, so that tiles of pixels end early on two sides.
const SIZE: [u32; 2] = [61, 43];

/// Wrong samples of a million that are let pass: what single precision costs.
const PER_MILLION: u64 = 20;

fn settings(samples: u32) -> Settings {
    Settings::new(SIZE, 64, Samples::new(Pattern::LowDiscrepancy, samples).expect("a pattern"))
}

/// A built-in scene under its own light, or under a point where its directional light comes from.
fn scene(name: &str, point: bool) -> Scene {
    let mut scene = builtin(name).expect("a built-in scene");
    let (lo, hi) = scene.mesh.bounds().expect("a mesh");
    let light = scene.light.homogeneous();
    if point && light.w == 0.0 {
        let at = (lo + hi) * 0.5 + light.truncate().normalize() * (hi - lo).length();
        scene.light = Light::Point { position: at.as_vec3().into() };
    }
    scene
}

fn render(scene: &Scene, prepared: &Prepared, samples: u32) -> Output {
    let rays = CpuRays::new(prepared).expect("a tree");
    rays.render(&settings(samples), &scene.camera, &scene.light, None).expect("a frame")
}

/// Samples that see a surface, and those of them that are wrong outside the ambiguity band.
fn wrong(scene: &Scene, prepared: &Prepared, samples: u32, output: &Output) -> (u64, u64) {
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let of = settings(samples);
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &of.samples, SIZE[0], SIZE[1]).expect("a truth");
    let words = output.words as usize;
    let (mut seen, mut wrong) = (0, 0);
    for p in 0..SIZE[0] * SIZE[1] {
        let (here, at) = (truth.pixel(p), p as usize * words);
        let lit = output.lit[at..at + words].iter().rev().fold(0u128, |all, &word| all << 32 | u128::from(word));
        if here.seen_count == 0 {
            // All bits are set where a pixel sees nothing; a sample within the band may see something.
            wrong += u64::from(output.visibility[p as usize] != 1.0 && join_mask(truth.ambiguous_mask(p)) == 0);
            continue;
        }
        seen += u64::from(here.seen_count);
        let lit = if output.visibility[p as usize] == 1.0 { lit & join_mask(here.seen) } else { lit };
        let off = lit ^ join_mask(here.lit);
        if off != 0 {
            wrong += u64::from((off & !join_mask(truth.ambiguous_mask(p))).count_ones());
        }
    }
    (seen, wrong)
}

/// Holds a frame against truth; with one sample of every 50 pixels turned over it no longer passes. Returns seen and wrong samples.
fn check(what: &str, scene: &Scene, samples: u32) -> (u64, u64) {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let output = render(scene, &prepared, samples);
    let (seen, off) = wrong(scene, &prepared, samples, &output);
    let all = u64::from(SIZE[0] * SIZE[1] * samples);
    assert!(seen > all / 20, "{what}: {seen} of {all} samples see something");
    let lit: u32 = output.visibility.iter().map(|&v| u32::from(v < 1.0)).sum();
    assert!(lit > 20, "{what}: no shadow");
    let mut spoiled = output.clone();
    for pixel in spoiled.lit.chunks_exact_mut(output.words as usize).step_by(50) {
        pixel[0] ^= 1;
    }
    let noticed = wrong(scene, &prepared, samples, &spoiled).1;
    assert!(noticed > off + 5, "{what}: {noticed} wrong samples in a spoiled frame, {off} before");
    (seen, off)
}

#[test]
fn samples_are_as_truth_says() {
    let (mut seen, mut off, mut list) = (0, 0, Vec::new());
    for (k, name) in ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "bumpy", "plane"].iter().enumerate() {
        for samples in [1, 8, 32, 128] {
            let what = format!("{name} {samples}");
            let found = check(&what, &scene(name, k % 2 == 1), samples);
            (seen, off) = (seen + found.0, off + found.1);
            if found.1 > 0 {
                list.push(format!("{what}: {} of {}", found.1, found.0));
            }
        }
    }
    assert!(seen > 1_000_000, "{seen}");
    assert!(off * 1_000_000 <= PER_MILLION * seen, "{off} of {seen}: {list:?}");
}

/// From the street, from within a hollow body, from far off; and worlds as small as grains and as large as planets.
#[test]
fn any_place_and_any_size_will_do() {
    let mut city = scene("city", false);
    let from = |eye: [f32; 3], target: [f32; 3], fov, near, far| Camera {
        far,
        ..Camera::look_at(eye, target, [0.0, 1.0, 0.0], fov, near)
    };
    city.camera = from([43.5, 2.0, 200.0], [43.5, 8.0, -200.0], 60.0, 0.1, 1000.0);
    let mut far = scene("windmill", false);
    let towards = far.camera;
    let away = |k: usize| towards.target[k] + 1e4 * (towards.eye[k] - towards.target[k]);
    far.camera = from([away(0), away(1), away(2)], towards.target, 43.0 / 1e4, 1.0, 1e7);
    let mut within = scene("spheres", true);
    let (lo, hi) = within.mesh.bounds().expect("a mesh");
    let middle = ((lo + hi) * 0.5).as_vec3();
    within.camera = from([middle.x, middle.y, middle.z], [middle.x + 1.0, middle.y - 0.6, middle.z], 90.0, 1e-3, 1e3);
    let mut star = scene("bicycle", false);
    let direction = star.light.homogeneous().truncate().normalize();
    star.light = Light::Point { position: (direction * 3e38).as_vec3().into() };
    let mut all = vec![("street", city), ("far off", far), ("within", within), ("star", star)];
    for (what, scale) in [("grain", 1e-6f32), ("planet", 1e6)] {
        let mut scene = scene("cage", false);
        scene.mesh.positions.iter_mut().flatten().for_each(|c| *c *= scale);
        let camera = &mut scene.camera;
        [&mut camera.eye, &mut camera.target].into_iter().flatten().for_each(|c| *c *= scale);
        (camera.near, camera.far) = (camera.near * scale, camera.far * scale);
        all.push((what, scene));
    }
    for (what, scene) in all {
        let (seen, off) = check(what, &scene, 32);
        assert!(off * 1_000_000 <= 5 * PER_MILLION * seen, "{what}: {off} of {seen}");
    }
}

#[test]
fn the_same_bits_from_one_thread_and_from_many() {
    let scene = scene("bicycle", true);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for samples in [1, 32] {
        let many = render(&scene, &prepared, samples);
        let one = alone.install(|| render(&scene, &prepared, samples));
        let differing = |b: &Output| many.lit.iter().zip(&b.lit).filter(|(a, b)| a != b).count();
        assert_eq!((differing(&one), many.visibility == one.visibility), (0, true), "{samples} samples");
        assert!(
            many.triangles == one.triangles && differing(&render(&self::scene("cage", true), &prepared, samples)) > 0
        );
    }
}

#[test]
fn what_cannot_be_rendered_is_refused() {
    let scene = scene("plane", false);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let rays = CpuRays::new(&prepared).expect("a tree");
    let mut camera = scene.camera;
    camera.near = -1.0;
    let refused = rays.render(&settings(8), &camera, &scene.light, None).map(|_| ());
    assert!(refused.is_err_and(|e| e.to_string().contains("near")));
    let light = Light::Directional { direction: [0.0; 3] };
    assert!(rays.render(&settings(8), &scene.camera, &light, None).is_err());
    let none = Settings { size: [0, 4], ..settings(8) };
    assert!(rays.render(&none, &scene.camera, &scene.light, None).is_err());
    let nothing = Prepared::new(&Mesh::default()).map(|empty| {
        let rays = CpuRays::new(&empty).expect("a tree");
        rays.render(&settings(8), &scene.camera, &scene.light, None).expect("a frame")
    });
    if let Ok(nothing) = nothing {
        assert!(nothing.visibility.iter().all(|&v| v == 1.0) && nothing.triangles.iter().all(|&t| t == u32::MAX));
    }
    let ran = [engine::CpuTime { name: engine::RAYS, ms: 1.0 }];
    assert!(engine::merged("resolve", &ran).is_some() && engine::merged(engine::RAYS, &ran).is_none());
}
