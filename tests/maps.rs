//! What must not change a bit of a picture of `spsm` and of the methods of maps of depths: repetition, order of the mesh, duplicates,
//! scale.

use lab::scene::{Scene, builtin};
use subpixel_shadows::gpu::{Buffer, Recorder};
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::fixed_memory::{FixedMethod, MethodParts, OUTCOME_WORDS};
use subpixel_shadows::methods::spsm::Spsm;
use subpixel_shadows::methods::{
    HistorySettings, MethodName, Prepared, Settings, ShadowMapSettings, SmsrSettings, SmsrShape, SpsmEncoding,
    SpsmSettings,
};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::compared_depths::DepthRule;
use subpixel_shadows::stages::seen_texels::TexelMarks;
use subpixel_shadows::status::StatusHead;
use test_support::gpu;
use test_support::gpu_test;

const SCENES: [&str; 2] = ["windmill", "plane"];

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn settings(size: [u32; 2], samples: u32) -> Settings {
    Settings::new(size, 96, Samples::new(Pattern::LowDiscrepancy, samples).expect("a number of samples"))
}

/// The methods, in every encoding and search, with one sample and with several.
fn variants() -> Vec<(String, MethodName, Settings)> {
    use SpsmEncoding::{Lines, Paper};
    let spsm = [(Lines, 1, 2, 32), (Lines, 2, 0, 1), (Paper, 1, 0, 8)].map(|(encoding, radius, stretch, samples)| {
        let spsm = SpsmSettings { encoding, radius, stretch, ..SpsmSettings::default() };
        let label = format!("spsm {encoding:?} {radius} {stretch}, {samples} samples");
        (label, MethodName::Spsm, Settings { spsm, ..settings([72, 54], samples) })
    });
    let compared = [(MethodName::ShadowMap, 1), (MethodName::Pcf, 8), (MethodName::Smsr, 32)]
        .map(|(method, samples)| (method.name().to_owned(), method, settings([72, 54], samples)));
    let fitted = [
        (MethodName::Reconstructable, 8),
        (MethodName::PolygonIds, 8),
        (MethodName::SilhouetteMap, 8),
        (MethodName::Variance, 1),
        (MethodName::LayeredVariance, 8),
        (MethodName::Convolution, 1),
        (MethodName::Exponential, 1),
        (MethodName::ExponentialVariance, 8),
        (MethodName::FourMoments, 1),
        (MethodName::Deep, 8),
        (MethodName::Trapezoidal, 8),
        (MethodName::Lispsm, 1),
        (MethodName::Perspective, 8),
        (MethodName::ParallelSplit, 32),
        (MethodName::Remix, 1),
        (MethodName::ResolutionMatched, 8),
        (MethodName::Rectilinear, 8),
    ]
    .map(|(method, samples)| (method.name().to_owned(), method, settings([72, 54], samples)));
    let smsr = SmsrSettings { shape: SmsrShape::Corners, reach: 5, slope: 0.1 };
    let corners = ("smsr by corners".to_owned(), MethodName::Smsr, Settings { smsr, ..settings([72, 54], 8) });
    let rules =
        [(MethodName::ShadowMap, DepthRule::Midpoint), (MethodName::Smsr, DepthRule::Second)].map(|(method, rule)| {
            (format!("{} by {rule:?}", method.name()), method, by(Some(rule), &settings([72, 54], 8)))
        });
    spsm.into_iter().chain(compared).chain([corners]).chain(fitted).chain(rules).collect()
}

/// These settings, with another depth to compare in place of a bias; with none the nearest.
fn by(compared: Option<DepthRule>, settings: &Settings) -> Settings {
    let shadow_map = ShadowMapSettings { compared, ..settings.shadow_map };
    Settings { shadow_map, ..settings.clone() }
}

fn render(scene: &Scene, method: MethodName, settings: &Settings) -> Output {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let mut renderer = Renderer::of_method(gpu(), &prepared, method, settings, Budget::default()).expect("a renderer");
    renderer.render(&scene.camera, &scene.light).expect("a frame")
}

/// Frames of jittered maps come nearer to rays, the more the nearer, and the same bits come of the same frames.
#[gpu_test]
fn a_history_of_frames_comes_nearer_to_rays() {
    let scene = scene("spheres");
    let usual = settings([160, 120], 1);
    let rays = render(&scene, MethodName::RayTraced, &usual).visibility;
    for (method, splits) in
        [(MethodName::ShadowMap, None), (MethodName::Lispsm, None), (MethodName::ShadowMap, Some(3))]
    {
        let partition = splits.map(|splits| SplitPlan { splits, warp: Warp::Box, ..SplitPlan::default() });
        let of = |frames: u32| {
            let history = (frames > 1).then_some(HistorySettings { frames, ..HistorySettings::default() });
            render(&scene, method, &Settings { history, partition, ..usual.clone() })
        };
        let error = |frames: u32| {
            let differs = of(frames).visibility.iter().zip(&rays).map(|(v, r)| f64::from((v - r).powi(2))).sum::<f64>();
            differs.sqrt()
        };
        let errors = [1, 8, 48].map(error);
        assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.6 * errors[0], "{} {splits:?}: {errors:?}", method.name());
        let [one, other] = [5, 5].map(|frames| of(frames).visibility);
        assert!(one == other && one != of(6).visibility, "{} {splits:?}", method.name());
    }
}

/// Without a bias a surface shadows itself in the map of its nearest depths, and hardly where another depth is compared.
#[gpu_test]
fn another_depth_takes_the_place_of_the_bias() {
    let scene = scene("spheres");
    let usual = settings([160, 120], 8);
    let dark = |settings: &Settings, method| {
        let visibility = render(&scene, method, settings).visibility;
        visibility.iter().map(|v| f64::from(1.0 - v)).sum::<f64>()
    };
    let no_bias = ShadowMapSettings { constant: 0.0, slope: 0.0, ..usual.shadow_map };
    let bare = Settings { shadow_map: no_bias, ..usual.clone() };
    for method in [MethodName::ShadowMap, MethodName::Pcf] {
        let right = dark(&usual, method);
        let acne = dark(&bare, method) - right;
        for rule in [DepthRule::Midpoint, DepthRule::Second, DepthRule::DUAL] {
            let more = dark(&by(Some(rule), &bare), method) - right;
            assert!(
                more.abs() < 0.1 * acne && right > 100.0,
                "{method:?}, {rule:?}: {more} of {right} pixels, {acne} without"
            );
        }
    }
}

/// Where two pictures differ, to the bit.
fn difference(a: &Output, b: &Output) -> Option<String> {
    let words = |o: &Output| o.visibility.iter().map(|v| v.to_bits()).chain(o.lit.iter().copied()).collect::<Vec<_>>();
    let (a, b) = (words(a), words(b));
    if a.len() != b.len() {
        return Some(format!("{} and {} words", a.len(), b.len()));
    }
    let off = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    (off > 0).then(|| format!("{off} of {} words differ", a.len()))
}

/// Renders every scene in every variant as it is and as `change` makes it, and names all that differ.
fn unchanged_by(what: &str, of: impl Fn(MethodName) -> bool, change: impl Fn(&Scene) -> Scene) {
    let mut failures = Vec::new();
    for name in SCENES {
        let plain = scene(name);
        let other = change(&plain);
        for (label, method, settings) in variants().into_iter().filter(|v| of(v.1)) {
            let first = render(&plain, method, &settings);
            assert!(name == "plane" || first.visibility.iter().any(|v| *v < 1.0), "{name}, {label}: no shadow");
            let mut second = render(&other, method, &settings);
            failures.extend(difference(&first, &second).map(|d| format!("{name}, {label}, {what}: {d}")));
            second.visibility[7] += 1.0;
            assert!(difference(&first, &second).is_some(), "{name}, {label}: a spoilt picture passes");
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The same triangles in another order, of other vertex numbers, each begun at another corner.
fn disordered(mesh: &Mesh) -> Mesh {
    let mut state = 5u64;
    let mut below = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % n as u64) as usize
    };
    let mut out = mesh.clone();
    let mut place: Vec<usize> = (0..mesh.positions.len()).collect();
    (1..place.len()).rev().for_each(|i| place.swap(i, below(i + 1)));
    for (from, &to) in place.iter().enumerate() {
        out.positions[to] = mesh.positions[from];
    }
    for triangle in &mut out.triangles {
        *triangle = triangle.map(|v| place[v as usize] as u32);
        triangle.rotate_left(below(3));
    }
    (1..out.triangles.len()).rev().for_each(|i| out.triangles.swap(i, below(i + 1)));
    out
}

#[gpu_test]
fn frames_repeat() {
    let plain = scene("windmill");
    let prepared = Prepared::new(&plain.mesh).expect("a sound mesh");
    for (label, method, settings) in variants() {
        let mut renderer =
            Renderer::of_method(gpu(), &prepared, method, &settings, Budget::default()).expect("a renderer");
        let mut frame = || renderer.render(&plain.camera, &plain.light).expect("a frame");
        let first = frame();
        for n in 1..20 {
            assert_eq!(difference(&first, &frame()), None, "{label}, frame {n}");
        }
    }
}

#[gpu_test]
fn order_does_not_matter() {
    unchanged_by("in another order", |_| true, |scene| Scene { mesh: disordered(&scene.mesh), ..scene.clone() });
}

#[gpu_test]
fn duplicates_do_not_matter() {
    // An edge of four triangles is a silhouette, whatever they are.
    unchanged_by(
        "doubled",
        |method| method != MethodName::SilhouetteMap,
        |scene| {
            let mut other = scene.clone();
            other.mesh.triangles.extend(scene.mesh.triangles.iter().copied());
            other
        },
    );
}

#[gpu_test]
fn scale_does_not_matter() {
    unchanged_by(
        "scaled",
        |_| true,
        |scene| {
            let mut other = scene.clone();
            let scale = |p: &mut [f32; 3]| p.iter_mut().for_each(|c| *c *= 0.125);
            other.mesh.positions.iter_mut().for_each(scale);
            scale(&mut other.camera.eye);
            scale(&mut other.camera.target);
            other.camera.near *= 0.125;
            other.camera.far *= 0.125;
            match &mut other.light {
                Light::Directional { .. } => {}
                Light::Point { position } => scale(position),
                Light::Spot { position, target, .. } => [position, target].into_iter().for_each(scale),
            }
            other
        },
    );
}

/// That `spsm` makes only the texels that are asked for changes nothing, with maps finer and coarser than the image; a texel that is
/// missed has the frame run again with all.
#[gpu_test]
fn unseen_texels_do_not_matter() {
    for name in SCENES {
        let plain = scene(name);
        for (label, method, settings) in variants().into_iter().filter(|v| v.1 == MethodName::Spsm) {
            for map in [96, 700] {
                let of = |seen_only| {
                    let spsm = SpsmSettings { seen_only, ..settings.spsm };
                    render(&plain, method, &Settings { map, spsm, ..settings.clone() })
                };
                let (few, all) = (of(true), of(false));
                assert_eq!(difference(&few, &all), None, "{name}, {label}, {map}");
                assert!(few.dispatches > all.dispatches, "{name}, {label}, {map}: nothing was left out");
            }
        }
    }
    let spsm = Settings { map: 700, ..settings([72, 54], 1) };
    let (device, queue) = (&gpu().device, &gpu().queue);
    let prepared = Prepared::new(&scene("plane").mesh).expect("a sound mesh");
    let casters = prepared.upload(device, queue).expect("memory");
    let parts = MethodParts { device, queue, prepared: &prepared, casters: &casters, settings: &spsm };
    let mut method = Spsm::new(parts).expect("memory");
    let mut left_out = |missed| {
        let mut words = vec![0; TexelMarks::HEADER];
        words[TexelMarks::MISSED] = missed;
        method.texels().marks.words.write(queue, &words);
        let outcome = Buffer::<u32>::storage(device, "outcome", 1 + OUTCOME_WORDS).expect("memory");
        let mut encoder = gpu().encoder();
        method.record_outcome(&mut Recorder::new(device, &mut encoder, None), &outcome, 1);
        queue.submit([encoder.finish()]);
        let told = outcome.read(gpu()).expect("readback");
        method.outcome([told[1], told[2], told[3], told[4]], &StatusHead::default()).expect("an outcome").left_out
    };
    assert!(!left_out(0));
    assert!(left_out(1), "a missed texel is overlooked");
    assert!(left_out(1), "a frame recorded before the first told that it lacks some is taken for whole");
}

/// Images and maps of one cell and of a few, and a scene without anything in it.
#[gpu_test]
fn small_and_empty() {
    let plain = scene("spheres");
    let bare = Scene { mesh: Mesh::default(), ..plain.clone() };
    for (label, method, settings) in variants() {
        for (size, map) in [([1, 1], 1), ([3, 5], 2), ([65, 1], 7)] {
            let settings = Settings { size, map, ..settings.clone() };
            let (first, second) = (render(&plain, method, &settings), render(&plain, method, &settings));
            assert_eq!(first.visibility.len(), (size[0] * size[1]) as usize);
            assert_eq!(difference(&first, &second), None, "{label}, {size:?}");
            assert!(first.visibility.iter().all(|v| (0.0..=1.0).contains(v)), "{label}, {size:?}");
            let empty = render(&bare, method, &settings);
            assert!(empty.visibility.iter().all(|v| *v == 1.0), "{label}, {size:?}: an empty scene is lit");
        }
    }
}
