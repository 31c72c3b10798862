//! Kernels as they are for a GPU and for a driver that runs them on the CPU: the same pictures.

use lab::scene::builtin;
use subpixel_shadows::gpu::{Gpu, Profile, kernels};
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Light;
use test_support::gpu_test;

/// Bits of visibility, lit masks, and dispatches of a frame.
fn picture(
    gpu: &Gpu,
    scene: &str,
    light: Option<Light>,
    method: MethodName,
    settings: &Settings,
) -> (Vec<u32>, Vec<u32>) {
    let mut scene = builtin(scene).expect("a built-in scene");
    scene.light = light.unwrap_or(scene.light);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let made = Renderer::of_method(gpu, &prepared, method, settings, Budget::default());
    let output = made.and_then(|mut renderer| renderer.render(&scene.camera, &scene.light)).expect("a frame");
    (output.visibility.iter().map(|v| v.to_bits()).collect(), output.lit)
}

#[gpu_test]
fn both_profiles_give_one_picture() {
    let gpu = Gpu::open(None).expect("a GPU");
    let among = Light::Point { position: [0.8, 1.9, 0.9] };
    for (scene, light) in [("windmill", None), ("bicycle", None), ("spheres", Some(among))] {
        for (method, facets) in [
            (MethodName::FacetMasks, FacetMode::One),
            (MethodName::FacetMasks, FacetMode::All),
            (MethodName::RayTraced, FacetMode::All),
            (MethodName::Supersampled, FacetMode::One),
            (MethodName::Spsm, FacetMode::One),
            (MethodName::Remix, FacetMode::One),
        ] {
            let samples = Samples::new(Pattern::LowDiscrepancy, 64).expect("64 samples");
            let settings = Settings { facets, ..Settings::new([72, 54], 64, samples) };
            let [one, other] =
                Profile::ALL.map(|profile| profile.within(|| picture(&gpu, scene, light, method, &settings)));
            assert!(one == other, "{scene}, {}, {facets:?}: the profiles differ", method.name());
        }
    }
}

#[test]
fn a_gpu_copies_nothing_that_is_uniform() {
    let mut other = 0;
    for (stem, source, _) in kernels::ALL {
        let source = &source.text();
        let [gpu, software] = Profile::ALL.map(|profile| profile.text(source));
        assert_eq!(software, *source);
        assert!(!gpu.contains("_given") && !gpu.contains("var<private> frame:"), "{stem}");
        other += usize::from(gpu != software);
    }
    assert!(other > 10, "{other} kernels differ");
    assert_eq!([Profile::Gpu.turns(512), Profile::Software.turns(512)], [1 << 16, 512]);
}
