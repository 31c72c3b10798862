//! The peers of `facet-masks` that are exact at their samples, from end to end: held against facet truth.

use lab::report::{FacetErrors, FacetSet};
use lab::scene::{Scene, SceneOptions};
use oracle::truth::Tracer;
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, RayTracedSettings, Settings};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::facet_classify::{FacetState, Facets};
use test_support::gpu;
use test_support::gpu_test;

const SIZE: [u32; 2] = [120, 90];

fn settings(samples: u32) -> Settings {
    let samples = Samples::new(Pattern::default(), samples).expect("a pattern");
    Settings { facets: FacetMode::One, ..Settings::new(SIZE, 128, samples) }
}

/// A built-in scene under its own light, or under a point where its directional light comes from.
fn scene(name: &str, point: bool) -> Scene {
    let mut scene = Scene::open(name, &SceneOptions::default()).expect("a built-in scene");
    let (lo, hi) = scene.mesh.bounds().expect("a mesh");
    let l = scene.light.homogeneous();
    if point && l.w == 0.0 {
        let at = (lo + hi) * 0.5 + l.truncate().normalize() * (hi - lo).length();
        scene.light = Light::Point { position: at.as_vec3().into() };
    }
    scene
}

fn errors(facets: &Facets, scene: &Scene, prepared: &Prepared, settings: &Settings) -> (FacetSet, FacetErrors) {
    let set = FacetSet::read(gpu(), facets, settings.samples.words()).expect("readback");
    let errors = errors_of(&set, scene, prepared, settings);
    (set, errors)
}

fn errors_of(set: &FacetSet, scene: &Scene, prepared: &Prepared, settings: &Settings) -> FacetErrors {
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    FacetErrors::of(set, &tracer, &scene.camera, &scene.light, settings, None).expect("a comparison")
}

fn same(what: &str, a: &Output, b: &Output) {
    assert!(a.lit == b.lit && a.visibility == b.visibility, "{what}: another picture");
}

/// Renders twice, holds the frame against truth, and spoils it.
fn check(name: &str, method: MethodName, point: bool, settings: &Settings) -> Output {
    let what = format!("{name}, {}, {settings:?}", method.name());
    let scene = scene(name, point);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let new = || Renderer::of_method(gpu(), &prepared, method, settings, Budget::default()).expect("a renderer");
    let mut renderer = new();
    let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
    let (mut set, right) = errors(renderer.facets().expect("facets"), &scene, &prepared, settings);
    assert_eq!(right.facet_wrong_outside_band, 0, "{what}: {right:?}");
    assert!(right.facet_samples > 100_000, "{what}: {right:?}");
    same(&what, &output, &renderer.render(&scene.camera, &scene.light).expect("a frame"));
    same(&what, &output, &new().render(&scene.camera, &scene.light).expect("a frame"));
    // One facet turned over is noticed.
    let words = set.words as usize;
    let undecided = |f: &usize| set.facets[*f].state == FacetState::Undecided as u32;
    let f =
        (0..set.facets.len()).filter(undecided).find(|f| set.masks[3 * f * words + words] == 0).expect("a lit facet");
    (0..words).for_each(|w| set.masks[(3 * f + 1) * words + w] = u32::MAX);
    assert!(errors_of(&set, &scene, &prepared, settings).facet_wrong_outside_band > 0, "{what}: not noticed");
    output
}

/// `facet-masks` answers the same question: the pictures differ nowhere but at samples within rounding of an edge.
fn check_against_facet_masks(name: &str, settings: &Settings, output: &Output) {
    let scene = scene(name, false);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let budget = Budget::default();
    let mut flagship =
        Renderer::of_method(gpu(), &prepared, MethodName::FacetMasks, settings, budget).expect("a renderer");
    let frame = flagship.render(&scene.camera, &scene.light).expect("a frame");
    let off = frame.visibility.iter().zip(&output.visibility).filter(|(a, b)| a != b).count();
    assert!(off <= 2, "{name}: {off} pixels differ from facet-masks");
}

/// Triangles at an edge that face the light alike do not shadow each other: no pixel is dark whose centre rounding puts beyond the edge.
#[gpu_test]
fn creases_are_lit() {
    let scene = scene("bumpy", false);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    for samples in [1, 8] {
        let settings = Settings { size: [800, 600], map: 256, ..settings(samples) };
        let render = |method| {
            let mut renderer =
                Renderer::of_method(gpu(), &prepared, method, &settings, Budget::default()).expect("a renderer");
            renderer.render(&scene.camera, &scene.light).expect("a frame").visibility
        };
        let flagship = render(MethodName::FacetMasks);
        assert!((100_000.0..470_000.0).contains(&flagship.iter().sum::<f32>()), "all lit or all dark");
        for method in [MethodName::RayTraced, MethodName::Supersampled] {
            let off = flagship.iter().zip(render(method)).filter(|(a, b)| (*a - b).abs() > 0.2).count();
            assert_eq!(off, 0, "{}, {samples} samples: pixels differ from facet-masks", method.name());
        }
    }
}

#[gpu_test]
fn ray_traced() {
    for name in ["plane", "windmill", "knot"] {
        let all = check(name, MethodName::RayTraced, false, &settings(32));
        check_against_facet_masks(name, &settings(32), &all);
        let silhouettes = Settings { ray_traced: RayTracedSettings { silhouettes: true }, ..settings(32) };
        let fewer = check(name, MethodName::RayTraced, false, &silhouettes);
        assert!(all.visibility == fewer.visibility, "{name}: another picture from silhouettes alone");
        assert!(all.counts.visibility_evaluations > fewer.counts.visibility_evaluations, "{name}: as many rays");
    }
}

#[gpu_test]
fn ray_traced_otherwise() {
    check("knot", MethodName::RayTraced, true, &settings(128));
    check("plane", MethodName::RayTraced, true, &Settings { validity: false, settle: false, ..settings(64) });
}

/// The same question a third time, whatever the size of the map.
#[gpu_test]
fn supersampled() {
    for name in ["plane", "windmill"] {
        let frame = check(name, MethodName::Supersampled, false, &settings(32));
        check_against_facet_masks(name, &settings(32), &frame);
    }
    let coarse = check("plane", MethodName::Supersampled, true, &Settings { map: 20, ..settings(16) });
    let fine = check("plane", MethodName::Supersampled, true, &Settings { map: 400, ..settings(16) });
    same("plane, map 20 and 400", &coarse, &fine);
    check("spheres", MethodName::Supersampled, false, &Settings { validity: false, ..settings(128) });
}
