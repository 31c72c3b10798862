//! Cameras that are jittered, off-centre, mirrored or of oblong pixels, each held against facet truth, scene truth and seen truth.

use glam::Vec3;
use lab::fuzz::{FuzzCase, FuzzDevice, How, Kind, World, judge};
use lab::scene::{CameraOverride, Lens, builtin};
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Camera;
use test_support::gpu;
use test_support::gpu_test;

const SIZE: [u32; 2] = [48, 36];

fn case(name: &str, facets: FacetMode, lens: Lens) -> FuzzCase {
    let scene = builtin(name).expect("a built-in scene");
    let samples = Samples::new(Pattern::LowDiscrepancy, 8).expect("samples");
    let settings = Settings { facets, cull_back: true, ..Settings::new(SIZE, 64, samples) };
    let how = How {
        method: MethodName::FacetMasks,
        setting: String::new(),
        pattern: Pattern::LowDiscrepancy,
        settings,
        budget: Budget::default(),
        force_all: false,
        both: true,
    };
    let mut camera = CameraOverride::from(scene.camera);
    (camera.shift, camera.pixel_aspect, camera.mirrored) =
        (Some(lens.shift), Some(lens.pixel_aspect), Some(lens.mirrored));
    let world = World { mesh: scene.mesh, alpha: Default::default(), ground: false, camera, light: scene.light };
    FuzzCase { seed: 0, number: 0, kind: Kind::ALL[0], world, how }
}

/// No sample is wrong, of the GPU or of the CPU engine, and there is something to be wrong about.
fn holds(bench: &FuzzDevice, name: &str, case: &FuzzCase) {
    let (camera, facets) = (&case.world.camera, case.how.settings.facets);
    let shot = bench.render(case).expect("a frame");
    let verdict = judge(case, &shot).expect("a judgement");
    assert!(verdict.figures.compared > 1000, "{name}, {facets:?}, {camera}: {:?}", verdict.figures);
    assert!(!verdict.fails(), "{name}, {facets:?}, {camera}: {:?}", verdict.faults);
}

/// Sixteen offsets within a pixel, as temporal antialiasing takes them (the first points of a (2, 3) Halton sequence).
#[gpu_test]
fn jitter_of_any_offset_is_exact() {
    let bench = FuzzDevice::new(gpu());
    let halton = |mut k: u32, base: u32| {
        let (mut share, mut value) = (1.0f32, 0.0);
        while k > 0 {
            share /= base as f32;
            value += share * (k % base) as f32;
            k /= base;
        }
        value - 0.5
    };
    for k in 1..=16 {
        let lens = Lens::CENTRED.jittered([halton(k, 2), halton(k, 3)], SIZE);
        let name = ["windmill", "knot"][k as usize % 2];
        holds(&bench, name, &case(name, FacetMode::All, lens));
    }
}

#[gpu_test]
fn lenses_of_any_shape_are_exact() {
    let bench = FuzzDevice::new(gpu());
    let lens = |shift, pixel_aspect, mirrored| Lens { shift, pixel_aspect, mirrored };
    for (name, lens) in [
        ("windmill", lens([0.6, -0.4], 1.0, false)),
        ("bicycle", lens([-0.3, 0.2], 1.0, true)),
        ("cage", lens([0.0, 0.0], 2.0, false)),
        ("spheres", lens([0.5, 0.5], 0.4, true)),
    ] {
        for facets in [FacetMode::All, FacetMode::One] {
            holds(&bench, name, &case(name, facets, lens));
        }
    }
}

/// The built-in scene with its camera behind an oblique near plane through a place between eye and target.
fn behind(name: &str, facets: FacetMode, share: f32, tilt: [f32; 3]) -> FuzzCase {
    let mut case = case(name, facets, Lens::CENTRED);
    let [eye, target] = [case.world.camera.eye, case.world.camera.target].map(|p| Vec3::from(p.expect("a place")));
    let normal = (target - eye).normalize() + Vec3::from(tilt);
    let at = eye + share * (target - eye);
    case.world.camera.near_plane = Some(normal.extend(-normal.dot(at)).into());
    case
}

/// Surfaces before an oblique near plane are not seen and cast shadows all the same, whether the plane cuts a little off, much, or all in a
/// part of the image.
#[gpu_test]
fn oblique_near_planes_are_exact() {
    let bench = FuzzDevice::new(gpu());
    for (name, share, tilt) in [
        ("windmill", 0.9, [0.3, 0.2, 0.0]),
        ("bicycle", 0.95, [0.0, -0.4, 0.1]),
        ("cage", 1.0, [0.5, 0.5, -0.5]),
        ("spheres", 0.8, [-1.5, 1.5, 0.3]),
    ] {
        for facets in [FacetMode::All, FacetMode::One] {
            holds(&bench, name, &behind(name, facets, share, tilt));
        }
    }
}

/// Every method shows behind an oblique near plane what facet masks do, whose surfaces are held against truth.
#[gpu_test]
fn every_method_sees_behind_an_oblique_near_plane() {
    let FuzzCase { world, how, .. } = behind("windmill", FacetMode::One, 0.9, [0.3, 0.2, 0.0]);
    let scene = world.scene().expect("a scene");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let seen = |method: MethodName, camera: &Camera| {
        let made = Renderer::of_method(gpu(), &prepared, method, &how.settings, Budget::default());
        let mut renderer = made.unwrap_or_else(|e| panic!("{}: {e}", method.name()));
        renderer.render(camera, &scene.light).unwrap_or_else(|e| panic!("{}: {e}", method.name())).triangles
    };
    let wanted = seen(MethodName::FacetMasks, &scene.camera);
    let plain = seen(MethodName::FacetMasks, &Camera { near_plane: None, ..scene.camera });
    let cut = wanted.iter().zip(&plain).filter(|(a, b)| a != b).count();
    assert!(cut > 100, "{cut} pixels are cut open");
    for method in MethodName::ALL {
        assert!(seen(method, &scene.camera) == wanted, "{}", method.name());
    }
}

/// With the truth of the camera without its oblique near plane, or of one that is a little off, a frame is wrong.
#[gpu_test]
fn the_oblique_near_plane_is_looked_at() {
    let bench = FuzzDevice::new(gpu());
    let case = behind("windmill", FacetMode::All, 0.9, [0.3, 0.2, 0.0]);
    let mut shot = bench.render(&case).expect("a frame");
    assert!(judge(&case, &shot).is_ok_and(|verdict| !verdict.fails()));
    let own = shot.scene.camera.near_plane.expect("a plane");
    for plane in [None, Some([own[0], own[1], own[2], own[3] * 0.99])] {
        shot.scene.camera.near_plane = plane;
        assert!(judge(&case, &shot).is_ok_and(|verdict| verdict.fails()), "{plane:?}");
    }
}

/// A frame through one lens is not that of another: held against the truth of the centred camera a jittered one is wrong.
#[gpu_test]
fn the_lens_is_looked_at() {
    let bench = FuzzDevice::new(gpu());
    let jittered = case("windmill", FacetMode::All, Lens::CENTRED.jittered([0.3, -0.2], SIZE));
    let mut shot = bench.render(&jittered).expect("a frame");
    assert!(judge(&jittered, &shot).is_ok_and(|verdict| !verdict.fails()));
    shot.scene.camera.lens = Lens::CENTRED;
    assert!(judge(&jittered, &shot).is_ok_and(|verdict| verdict.fails()));
}
