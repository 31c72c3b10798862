//! Alpha-tested casters, from end to end: each sample lit or dark as rays say that go through the holes.

use lab::report::{FacetErrors, FacetSet};
use lab::scene::{Scene, builtin};
use oracle::engine::{self, CpuRequest};
use oracle::truth::{SceneTruth, Tracer, TruthImage, join_mask};
use subpixel_shadows::Error;
use subpixel_shadows::ShadowPass;
use subpixel_shadows::light_view::{OmniMaps, SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::names::TexelQuery;
use subpixel_shadows::methods::{FacetMode, MethodName, PairVariant, Prepared, ProjectionVariant, Settings};
use subpixel_shadows::pass::{CasterMesh, Casters, PassConfig};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{
    AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Camera, Light, Mesh, Roles, TestedTriangle,
};
use test_support::{gpu, gpu_test};

const SIZE: [u32; 2] = [120, 90];

fn settings(facets: FacetMode, samples: u32) -> Settings {
    let samples = Samples::new(Pattern::default(), samples).expect("a pattern");
    Settings { facets, masks: MaskVariant::Exact, cull_back: true, ..Settings::new(SIZE, 128, samples) }
}

/// Numbers in 0 to 1 that look random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Triangles every which way over a floor, of which every third is whole, the others have holes by maps of all kinds: of one texel, of sizes
/// that are no powers of two, of both filters and all wraps, with coordinates far from 0.
fn world(seed: u64) -> Scene {
    let mut n = Numbers(seed * 977 + 5);
    let mut scene = builtin("plane").expect("a built-in scene");
    let mut mesh = Mesh {
        positions: vec![[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let mut alpha = AlphaTested::default();
    for k in 0..12usize {
        let size = [[1, 1], [5, 3], [8, 8], [2, 7]][k % 4];
        let alpha_of = |n: &mut Numbers| (n.next() * 256.0) as u8;
        alpha.maps.push(AlphaMap {
            size,
            alpha: (0..size[0] * size[1]).map(|_| alpha_of(&mut n)).collect(),
            cutoff: n.between(0.3, 0.6),
            filter: if k % 2 == 0 { AlphaFilter::Bilinear } else { AlphaFilter::Nearest },
            wrap: [
                [AlphaWrap::Repeat, AlphaWrap::Mirror, AlphaWrap::Clamp][k % 3],
                [AlphaWrap::Repeat, AlphaWrap::Mirror, AlphaWrap::Clamp][(k / 3) % 3],
            ],
        });
    }
    for k in 0..24u32 {
        let first = mesh.positions.len() as u32;
        let middle = [n.between(-2.0, 2.0), n.between(0.2, 2.0), n.between(-2.0, 2.0)];
        for _ in 0..3 {
            mesh.positions.push(middle.map(|c| c + n.between(-1.0, 1.0)));
        }
        if k % 3 != 0 {
            let away = [[0.0, 0.0], [-7.0, 12.0]][k as usize % 2];
            let uv = [(); 3].map(|()| away.map(|c| c + n.between(-1.5, 1.5)));
            alpha.triangles.push(TestedTriangle {
                triangle: mesh.triangles.len() as u32,
                map: k % 12,
                uv,
                roles: Roles::ALL,
            });
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let eye = [n.between(-3.0, 3.0), n.between(1.5, 3.0), 4.5];
    scene.camera = Camera { eye, target: [0.0, 0.5, 0.0], ..scene.camera };
    scene.light = match seed % 3 {
        0 => Light::Point { position: [n.between(-1.0, 1.0), 1.0, n.between(-1.0, 1.0)] },
        1 => Light::Point { position: [n.between(-3.0, 3.0), 4.5, n.between(-3.0, 3.0)] },
        _ => Light::Directional { direction: [n.between(-1.0, 1.0), 1.0, n.between(-1.0, 1.0)] },
    };
    Scene { mesh, alpha, ground: None, ..scene }
}

/// Scene truth with its ambiguity band.
fn truth(scene: &Scene, prepared: &Prepared, settings: &Settings) -> TruthImage {
    let tracer = Tracer::of(prepared).expect("a tracer");
    let [w, h] = SIZE;
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, w, h).expect("a truth");
    let mut image = truth.image(None);
    for (pixel, p) in image.pixels.iter_mut().enumerate() {
        let around = truth.ambiguous_mask(pixel as u32);
        p.ambiguous = std::array::from_fn(|k| p.ambiguous[k] | around[k]);
    }
    image
}

fn lit(output: &Output, pixel: usize) -> u128 {
    let words = output.words as usize;
    output.lit[pixel * words..][..words].iter().rev().fold(0, |mask, &word| mask << 32 | u128::from(word))
}

/// Samples that differ outside the ambiguity band.
fn wrong(output: &Output, truth: &TruthImage) -> u32 {
    let off = |(pixel, p): (usize, &oracle::truth::PixelTruth)| match p.seen_count {
        0 => 0,
        _ => ((lit(output, pixel) ^ join_mask(p.lit)) & !join_mask(p.ambiguous)).count_ones(),
    };
    truth.pixels.iter().enumerate().map(off).sum()
}

fn planned(scene: &Scene, prepared: &Prepared, settings: &Settings) -> Plan {
    Plan::of(prepared, &scene.camera, &scene.light, settings, false).expect("a plan")
}

fn rendered(scene: &Scene, prepared: &Prepared, settings: &Settings) -> Output {
    let plan = planned(scene, prepared, settings);
    let mut renderer = Renderer::new(gpu(), prepared, &plan.settings, Budget::default()).expect("a renderer");
    renderer.render(&scene.camera, &scene.light).expect("a frame")
}

/// The scene with every card whole, and with another cutoff: its truth is another one.
fn spoilt(scene: &Scene) -> [Scene; 2] {
    let mut higher = scene.clone();
    higher.alpha.maps.iter_mut().for_each(|map| map.cutoff = (map.cutoff + 0.15).min(1.0));
    [Scene { alpha: AlphaTested::default(), ..scene.clone() }, higher]
}

/// Every sample of the built-in scene with leaves and of random worlds, by 8, 32 and 128 samples.
#[gpu_test]
fn holes_let_light_and_eye_through() {
    let leaves = builtin("leaves").expect("a built-in scene");
    let worlds = (0..4).map(|seed| (world(seed), [32, 8, 128][seed as usize % 3]));
    for (scene, samples) in std::iter::once((leaves, 32)).chain(worlds) {
        let prepared = scene.prepared().expect("a sound mesh");
        let settings = settings(FacetMode::All, samples);
        let truth = truth(&scene, &prepared, &settings);
        let output = rendered(&scene, &prepared, &settings);
        let band: u32 = truth.pixels.iter().map(|p| join_mask(p.ambiguous).count_ones()).sum();
        let share = f64::from(band) / f64::from(samples) / truth.pixels.len() as f64;
        eprintln!("{}, {:?}: {} wrong, {share:.4} in the band", scene.name, scene.light, wrong(&output, &truth));
        assert_eq!(wrong(&output, &truth), 0, "{:?}", scene.light);
        assert!(share < 0.06, "{share}");
        let dark = output.visibility.iter().filter(|v| **v < 0.5).count();
        assert!(dark > 200 && dark < output.visibility.len() - 200, "{dark}");
        for other in spoilt(&scene) {
            let prepared = other.prepared().expect("a sound mesh");
            assert!(wrong(&rendered(&other, &prepared, &settings), &truth) > 100);
        }
    }
}

/// Pairs by texels and sorted, everything the exact way, slices: the lit masks are the same. The paper's two projections are near.
#[gpu_test]
fn the_ways_to_the_answer_agree() {
    let scene = world(2);
    let prepared = scene.prepared().expect("a sound mesh");
    let settings = settings(FacetMode::All, 32);
    let first = rendered(&scene, &prepared, &settings);
    let slices = SplitPlan { splits: 3, warp: Warp::Fitted, focus: 0.3, ..SplitPlan::default() };
    for other in [
        Settings { pairs: PairVariant::Grouped, ..settings.clone() },
        Settings { pairs: PairVariant::Sorted, ..settings.clone() },
        Settings { settle: false, ..settings.clone() },
        Settings { partition: Some(slices), ..settings.clone() },
        Settings { map: 16, ..settings.clone() },
    ] {
        let got = rendered(&scene, &prepared, &other);
        let apart = (0..got.visibility.len()).map(|p| (lit(&first, p) ^ lit(&got, p)).count_ones()).sum::<u32>();
        assert_eq!(apart, 0, "{other:?}");
    }
    let projection = ProjectionVariant::TwoStep;
    let got = rendered(&scene, &prepared, &Settings { projection, ..settings.clone() });
    let apart = (0..got.visibility.len()).map(|p| (lit(&first, p) ^ lit(&got, p)).count_ones()).sum::<u32>();
    assert!(apart < 200, "{apart}");
}

/// With one facet a pixel, against the truth of these facets; and its pixels' surfaces.
#[gpu_test]
fn one_facet_a_pixel_looks_through_holes() {
    for scene in [world(1), world(3), builtin("leaves").expect("a built-in scene")] {
        let prepared = scene.prepared().expect("a sound mesh");
        let settings = planned(&scene, &prepared, &settings(FacetMode::One, 32)).settings;
        let mut renderer = Renderer::new(gpu(), &prepared, &settings, Budget::default()).expect("a renderer");
        let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
        let facets = renderer.facets().expect("facets");
        let set = FacetSet::read(gpu(), Some(facets), 1).expect("readback");
        let judged = |prepared: &Prepared| {
            let tracer = Tracer::of(prepared).expect("a tracer");
            FacetErrors::of(&set, &tracer, &scene.camera, &scene.light, &settings, None).expect("a truth")
        };
        let errors = judged(&prepared);
        assert!(errors.facet_samples > 100_000);
        assert_eq!(errors.facet_wrong_outside_band, 0, "{errors:?}");
        let [whole, _] = spoilt(&scene);
        assert!(judged(&whole.prepared().expect("a sound mesh")).facet_wrong_outside_band > 100);
        let one = Samples::new(Pattern::default(), 1).expect("a pattern");
        let centres = truth(&scene, &prepared, &Settings { samples: one, ..settings.clone() });
        let seen = |p: usize| output.triangles[p] != u32::MAX;
        let apart = centres.pixels.iter().enumerate().filter(|(p, t)| seen(*p) != (t.seen_count > 0));
        assert!(apart.count() <= 2);
    }
}

/// Rays, and every sample against every caster of its texel, have the lit masks of one facet a pixel, by light at a point and at infinity.
#[gpu_test]
fn rays_go_through_holes() {
    for (scene, samples) in [(world(7), 32), (world(8), 8), (builtin("leaves").expect("a built-in scene"), 64)] {
        let prepared = scene.prepared().expect("a sound mesh");
        let settings = Settings { validity: false, ..settings(FacetMode::One, samples) };
        let want = rendered(&scene, &prepared, &settings);
        let [whole, _] = spoilt(&scene);
        let without = rendered(&whole, &whole.prepared().expect("a sound mesh"), &settings);
        for method in [MethodName::RayTraced, MethodName::Supersampled] {
            let plan = Plan::of_method(method, &prepared, &scene.camera, &scene.light, &settings, false);
            let plan = plan.expect("a plan");
            let renderer = Renderer::of_plan(gpu(), &prepared, method, &plan, Budget::default());
            let got = renderer.and_then(|mut r| r.render(&scene.camera, &scene.light)).expect("a frame");
            let apart = |other: &Output| -> u32 {
                (0..got.visibility.len()).map(|p| (lit(&got, p) ^ lit(other, p)).count_ones()).sum()
            };
            eprintln!("{}, {}: {} samples apart", scene.name, method.name(), apart(&want));
            // At an alpha of the cutoff itself, rounding of a place decides.
            assert!(apart(&want) <= 8, "{}: {}", method.name(), apart(&want));
            assert!(apart(&without) > 500);
        }
    }
}

/// The CPU engine, which decides every sample in `f64`.
#[gpu_test]
fn the_cpu_engine_agrees() {
    for facets in [FacetMode::All, FacetMode::One] {
        let scene = world(5);
        let prepared = scene.prepared().expect("a sound mesh");
        let settings = planned(&scene, &prepared, &settings(facets, 32)).settings;
        let frame = engine::render(&prepared, &settings, &scene.camera, &scene.light, CpuRequest::default());
        let frame = frame.expect("a frame").output;
        let output = rendered(&scene, &prepared, &settings);
        let apart = |other: &Output| {
            let off = |p: usize| (lit(&output, p) ^ lit(other, p)).count_ones();
            (0..output.visibility.len()).map(off).sum::<u32>()
        };
        assert!(apart(&frame) < 60, "{facets:?}: {}", apart(&frame));
        let [whole, _] = spoilt(&scene);
        let other = rendered(&whole, &whole.prepared().expect("a sound mesh"), &settings);
        assert!(apart(&other) > 1000);
    }
}

/// Methods of depth maps come near to the truth with holes, and not to that without.
#[gpu_test]
fn depth_maps_have_holes() {
    let scene = builtin("leaves").expect("a built-in scene");
    let prepared = scene.prepared().expect("a sound mesh");
    let [whole, _] = spoilt(&scene);
    let settings = Settings { map: 512, ..settings(FacetMode::All, 8) };
    let truths = [&scene, &whole].map(|scene| truth(scene, &scene.prepared().expect("a sound mesh"), &settings));
    // Slices and warps of their own change no texel's question.
    let maps = |m: &MethodName| {
        matches!(
            m.row().query,
            TexelQuery::Map(_)
                | TexelQuery::Centres
                | TexelQuery::Polygons
                | TexelQuery::Silhouettes
                | TexelQuery::Deep
                | TexelQuery::Axes
        ) && m.row().partition.is_none()
    };
    for method in MethodName::ALL.into_iter().filter(maps) {
        let [with, without] = off_truths(&scene, &prepared, method, &settings, &truths);
        assert!(with < 0.6 * without, "{}: {with} {without}", method.name());
    }
    // On a paraboloid, of a lamp.
    let light = Light::Point { position: [2.0, 9.0, 1.5] };
    let [scene, whole] = [scene, whole].map(|scene| Scene { light, ..scene });
    let settings = Settings { omni: OmniMaps::Paraboloids, ..settings };
    let truths = [&scene, &whole].map(|scene| truth(scene, &scene.prepared().expect("a sound mesh"), &settings));
    let [with, without] = off_truths(&scene, &prepared, MethodName::ShadowMap, &settings, &truths);
    assert!(with < 0.6 * without, "a paraboloid: {with} {without}");
}

/// How far a method's picture is from each of two truths, root mean square.
fn off_truths(
    scene: &Scene,
    prepared: &Prepared,
    method: MethodName,
    settings: &Settings,
    truths: &[TruthImage; 2],
) -> [f64; 2] {
    let plan = Plan::of_method(method, prepared, &scene.camera, &scene.light, settings, false).expect("a plan");
    let mut renderer = Renderer::of_plan(gpu(), prepared, method, &plan, Budget::default()).expect("a renderer");
    let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
    let [with, without] = truths.each_ref().map(|truth| {
        let off = |(v, p): (&f32, &oracle::truth::PixelTruth)| f64::from(v - p.visibility).powi(2);
        let sum: f64 = output.visibility.iter().zip(&truth.pixels).map(off).sum();
        (sum / truth.pixels.len() as f64).sqrt()
    });
    eprintln!("{}: RMSE {with:.4}, {without:.4} from cards without holes", method.name());
    [with, without]
}

/// Wrong maps and triangles, methods that ask for no alpha, and passes made without are told of.
#[gpu_test]
fn what_cannot_be_used_is_an_error() {
    let scene = world(2);
    let Scene { mesh, alpha, .. } = &scene;
    let of = |casters: &Casters, method, alpha_tested| {
        let settings = Settings { alpha_tested, ..settings(FacetMode::All, 8) };
        let config = PassConfig { method, ..PassConfig::new(settings, *casters) };
        ShadowPass::new(&gpu().device, &gpu().queue, &config)
    };
    let whole = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let tested = Casters::AlphaTested { casters: &whole, tested: alpha };
    let told = |made: Result<ShadowPass, Error>| made.err().expect("an error").to_string();
    let refused = told(of(&tested, MethodName::Spsm, false));
    assert!(refused.contains("spsm") && refused.contains("alpha-tested"), "{refused}");
    let mut broken = alpha.clone();
    broken.triangles[3].map = 99;
    let spoilt = Casters::AlphaTested { casters: &whole, tested: &broken };
    assert!(told(of(&spoilt, MethodName::FacetMasks, false)).contains("map 99, there are 12"));
    let twice = Casters::AlphaTested { casters: &tested, tested: alpha };
    assert!(told(of(&twice, MethodName::FacetMasks, false)).contains("among alpha-tested ones"));
    let meshes = [CasterMesh::new(&mesh.positions, &mesh.triangles)];
    let placed = Casters::Instanced { meshes: &meshes, instances: &[0, 0] };
    let placed = Casters::AlphaTested { casters: &placed, tested: alpha };
    assert!(told(of(&placed, MethodName::FacetMasks, false)).contains("their meshes"));
    let mut without = of(&whole, MethodName::FacetMasks, false).expect("a pass");
    assert!(without.set_casters(&tested).expect_err("no alpha").to_string().contains("alpha_tested"));
    let mut with = of(&whole, MethodName::FacetMasks, true).expect("a pass");
    with.set_casters(&tested).expect("casters");
}
