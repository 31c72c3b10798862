//! Filters over the samples of a pixel and of its neighbours.

use super::*;
use oracle::engine;
use oracle::truth::{SceneTruth, Tracer, TruthImage};
use subpixel_shadows::methods::{MethodName, PixelFilter};

const FILTERS: [PixelFilter; 3] = [PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::Mitchell];

fn traced(scene: &Scene, samples: &Samples) -> TruthImage {
    let tracer = Tracer::new(&scene.mesh).expect("a tracer");
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, samples, SIZE[0], SIZE[1]).expect("a view");
    truth.image(None)
}

/// How many pixels are farther from traced samples, weighted alike, than rounding takes them.
fn wrong(visibility: &[u32], truth: &[f32]) -> usize {
    assert_eq!(visibility.len(), truth.len());
    visibility.iter().zip(truth).filter(|(v, t)| (f32::from_bits(**v) - **t).abs() > 5e-5).count()
}

/// Traced samples weighted by the same filter are the picture; lit masks are those of a box, and strips change no bit.
#[gpu_test]
fn filters_are_those_of_traced_samples() {
    let pixels = (SIZE[0] * SIZE[1]) as usize;
    for name in ["spheres", "knot"] {
        let scene = scene(name);
        let inputs = Inputs::new(&scene.camera, &scene.light);
        let plain = settings(FacetMode::All);
        let (by_box, _) = complete(&mut pass(plain.clone(), casters(&scene.mesh)), &inputs);
        let truth = traced(&scene, &plain.samples);
        // An edge within rounding of a sample decides it otherwise: what a filter makes of that is known.
        let own = wrong(&by_box.0[..pixels], &truth.visibility());
        assert!(own <= 2, "{name}: {own} pixels differ by samples of their own");
        for filter in FILTERS {
            let settings = Settings { filter, ..plain.clone() };
            let config = PassConfig::new(settings.clone(), casters(&scene.mesh));
            let (got, status) = complete(&mut pass(settings, casters(&scene.mesh)), &inputs);
            assert!(got.0[pixels..] == by_box.0[pixels..], "{name}, {filter:?}: lit masks");
            let filtered = truth.filtered(filter, &plain.samples);
            let far = wrong(&got.0[..pixels], &filtered);
            let around = (2 * filter.reach() as usize + 1).pow(2);
            assert!(far <= own * around, "{name}, {filter:?}: {far} pixels");
            assert!(wrong(&by_box.0[..pixels], &filtered) > 300, "{name}, {filter:?}: another picture than a box's");
            assert!(status.complete && status.counts.facets > 0);
            let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
            let on_cpu = engine::render(&prepared, &config.settings, &scene.camera, &scene.light, Default::default());
            let on_cpu = on_cpu.expect("a frame of the CPU").output.visibility;
            let apart = wrong(&got.0[..pixels], &on_cpu);
            assert!(apart <= own * around, "{name}, {filter:?}: {apart} pixels apart from the CPU engine");
            for strips in [3, 61] {
                let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &PassConfig { strips, ..config.clone() });
                let pass = pass.as_mut().expect("a pass");
                let (in_strips, _) = complete(pass, &inputs);
                assert_same(&format!("{name}, {filter:?}, {strips} strips"), &in_strips, &got);
                assert!(pass.strips() > 1);
            }
        }
    }
}

/// With one facet a pixel, in another size and back, and where nothing casts a shadow or nothing is seen.
#[gpu_test]
fn filters_work_wherever_the_pass_does() {
    let scene = scene("spheres");
    let filter = PixelFilter::Mitchell;
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let of = |facets, filter| {
        let settings = Settings { filter, ..settings(facets) };
        ShadowPass::new(&gpu().device, &gpu().queue, &PassConfig::new(settings, casters(&scene.mesh))).expect("a pass")
    };
    let mut one = of(FacetMode::One, filter);
    let (first, _) = complete(&mut one, &inputs);
    let (by_box, _) = complete(&mut of(FacetMode::One, PixelFilter::Box), &inputs);
    let changed = first.0.iter().zip(&by_box.0).filter(|(a, b)| a != b).count();
    assert!((300..3000).contains(&changed), "{changed} pixels are changed by the filter");
    one.set_size([31, 90]).expect("another size");
    one.set_size(SIZE).expect("the first size");
    assert_same("back", &complete(&mut one, &inputs).0, &first);
    let away =
        Camera { target: [scene.camera.eye[0], scene.camera.eye[1] + 9.0, scene.camera.eye[2] + 0.1], ..scene.camera };
    let (sky, _) = complete(&mut of(FacetMode::All, filter), &Inputs::new(&away, &scene.light));
    assert!(sky.0[..(SIZE[0] * SIZE[1]) as usize].iter().all(|v| *v == 1.0f32.to_bits()), "nothing is seen");
    // From below the ground nothing is lit.
    let under = Light::Directional { direction: [0.1, -1.0, 0.2] };
    let (dark, _) = complete(&mut of(FacetMode::All, filter), &Inputs::new(&scene.camera, &under));
    assert!(dark.0[..(SIZE[0] * SIZE[1]) as usize].iter().filter(|v| **v == 0).count() > 1000);
}

/// A method that keeps no masks takes a box.
#[gpu_test]
fn methods_without_masks_read_no_filter() {
    let scene = scene("plane");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for method in [MethodName::Pcf, MethodName::RayTraced] {
        let picture = |filter| {
            let settings = Settings { filter, ..settings(FacetMode::One) };
            let config = PassConfig { method, ..PassConfig::new(settings, casters(&scene.mesh)) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            let targets = Targets::new();
            let mut encoder = gpu().encoder();
            let target = Target { lit: None, ..targets.target() };
            pass.record(&mut encoder, &inputs, &target).expect("recorded");
            gpu().queue.submit([encoder.finish()]);
            gpu().wait(None).expect("the frame runs");
            assert!(status_of(&mut pass).complete, "{method:?}");
            targets.read().0[..(SIZE[0] * SIZE[1]) as usize].to_vec()
        };
        let by_box = picture(PixelFilter::Box);
        assert!(picture(PixelFilter::Tent) == by_box, "{method:?}");
        assert!(by_box.iter().filter(|v| **v == 0).count() > 50, "{method:?}");
    }
}
