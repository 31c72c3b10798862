//! Several views of a light: a cube of views around one that stands among its casters against traced rays, against one view where
//! one is enough, parts of a map against the whole, and changes that must not change a bit.

mod rooms;

use lab::report::{FacetErrors, FacetSet};
use lab::scene::{Scene, builtin};
use oracle::engine;
use oracle::truth::{SceneTruth, Tracer, join_mask};
use rooms::{point, room, scenes, wide};
use std::collections::HashMap;
use std::num::NonZeroU32;
use std::sync::{Arc, OnceLock};
use subpixel_shadows::gpu::Recorder;
use subpixel_shadows::light_view::{LightView, MapTiles, OmniMaps, PartBy, SplitPlan, Warp};
use subpixel_shadows::methods::facet_masks::{Capacities, FacetMasks, FacetMode, Pipelines, Settings, Strip};
use subpixel_shadows::methods::{MethodName, PageSettings, Prepared, RayTracedSettings};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light};
use test_support::{gpu, gpu_test};

const SIZE: [u32; 2] = [64, 48];

fn settings(facets: FacetMode, samples: u32) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, samples).expect("a pattern");
    Settings { facets, cull_back: true, ..Settings::new(SIZE, 64, samples) }
}

fn render(scene: &Scene, settings: &Settings) -> Output {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let mut renderer = Renderer::new(gpu(), &prepared, settings, Budget::default()).expect("a renderer");
    renderer.render(&scene.camera, &scene.light).expect("a frame")
}

/// The picture through given views, whatever the light would have.
fn through(scene: &Scene, settings: &Settings, views: &[LightView]) -> (Vec<f32>, Vec<u32>) {
    let gpu = gpu();
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let casters = prepared.upload(&gpu.device, &gpu.queue).expect("memory");
    static MADE: [OnceLock<Arc<Pipelines>>; 2] = [const { OnceLock::new() }; 2];
    let made = &MADE[usize::from(settings.facets == FacetMode::All)];
    let pipelines = made.get_or_init(|| Arc::new(Pipelines::new(&gpu.device, settings))).clone();
    let capacities = Capacities {
        pixel_pairs: 1 << 18,
        triangle_pairs: 1 << 20,
        candidates: 1 << 20,
        bands: 1,
        views: views.len() as u32,
        most_at_place: 1 << 15,
        facets: 1 << 14,
        pixel_triangles: 1 << 18,
        complex_pixels: settings.pixels(),
        most_at_pixel: 1 << 11,
    };
    let method =
        FacetMasks::new(&gpu.device, &gpu.queue, pipelines, &casters, settings, capacities).expect("the method");
    let bounds = prepared.mesh().bounds().expect("a mesh");
    let strip = Strip::whole(SIZE);
    method.prepare(&gpu.queue, &casters, &scene.camera, &scene.light, views, bounds, strip, 1).expect("prepared");
    let mut encoder = gpu.encoder();
    method.record(&mut Recorder::new(&gpu.device, &mut encoder, None), &casters).expect("recorded");
    gpu.submit_and_wait(encoder).expect("a frame");
    (method.visibility().read(gpu).expect("readback"), method.lit().read(gpu).expect("readback"))
}

fn picture(output: &Output) -> (Vec<f32>, Vec<u32>) {
    (output.visibility.clone(), output.lit.clone())
}

fn fitted(scene: &Scene) -> LightView {
    LightView::fit(&scene.mesh, &scene.light, 64).expect("a view")
}

/// Views that the method takes by itself.
fn taken(scene: &Scene, settings: &Settings) -> usize {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    settings.light_views(&prepared, &scene.light).expect("views").len()
}

fn cube(scene: &Scene) -> Vec<LightView> {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    LightView::cube(prepared.mesh(), &scene.light, 64).expect("a cube")
}

/// No sample is wrong against facet truth, with one facet and with all; a picture that lacks a view is noticed.
#[gpu_test]
fn no_sample_is_wrong() {
    let (mut found, mut settled) = (Vec::new(), 0);
    for (name, scene) in scenes() {
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        for (facets, samples, map) in
            [(FacetMode::One, 32, 64), (FacetMode::One, 1, 64), (FacetMode::All, 32, 64), (FacetMode::One, 32, 512)]
        {
            // In fine maps more lies nearer to the light than single precision places.
            if map > 64 && !["room", "hall", "plant"].contains(&name) {
                continue;
            }
            let settings = Settings { map, ..settings(facets, samples) };
            assert!(taken(&scene, &settings) > 1, "{name} {facets:?} {samples}: one view is enough");
            let mut renderer = Renderer::new(gpu(), &prepared, &settings, Budget::default()).expect("a renderer");
            let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
            settled += output.counts.lit_facets.min(output.counts.shadowed_facets);
            let set = FacetSet::read(gpu(), renderer.facets(), settings.samples.words()).expect("readback");
            let errors = FacetErrors::of(&set, &tracer, &scene.camera, &scene.light, &settings, None).expect("judged");
            assert!(errors.facet_samples > 1000, "{name}: {errors:?}");
            if errors.facet_wrong_outside_band > 0 {
                found.push(format!("{name} {facets:?} {samples}: {errors:?}"));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(settled > 1000, "{settled} facets settled both ways: what reaches behind a view settles nothing");
}

/// With a facet for every surface each sample is what a traced ray says. A picture without one of the views is not.
#[gpu_test]
fn every_sample_is_what_rays_say() {
    let settings = settings(FacetMode::All, 32);
    let mut missed = 0;
    for (name, scene) in scenes() {
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, SIZE[0], SIZE[1]);
        let truth = truth.expect("a truth");
        let wrong = |lit: &[u32]| {
            let pixels = (0..SIZE[0] * SIZE[1]).filter(|&p| truth.pixel(p).seen_count > 0);
            let off = |&p: &u32| {
                let off = u128::from(lit[p as usize]) ^ join_mask(truth.pixel(p).lit);
                off != 0 && off & !join_mask(truth.ambiguous_mask(p)) != 0
            };
            pixels.filter(off).count()
        };
        let output = render(&scene, &settings);
        // Beneath a crease that opens towards the light a plane runs on into the shadow of its neighbour.
        let off = wrong(&output.lit);
        assert!(off <= 2, "{name}: {off} pixels differ from rays");
        let all_casters = render(&scene, &Settings { cull_back: false, ..settings.clone() });
        assert!(all_casters.lit == output.lit, "{name}: another picture with all casters");
        let evaluations = [&output, &all_casters].map(|o| o.counts.visibility_evaluations);
        // How often a pair is met by two tiles at a time, and so listed twice, is not the same in each frame.
        let culls = ["hall", "cage", "plant", "knot"].contains(&name);
        assert_eq!(10 * evaluations[0] < 9 * evaluations[1], culls, "{name}: {evaluations:?}");
        let views = cube(&scene);
        for left_out in 0..views.len() {
            let mut fewer = views.clone();
            fewer.remove(left_out);
            missed += usize::from(wrong(&through(&scene, &settings, &fewer).1) > off + 5);
        }
    }
    assert!(missed >= 8, "leaving out a view shows {missed} times only");
}

/// Where one view holds all casters, six tell the same, to the bit. So do they in another order, and each of them twice.
#[gpu_test]
fn views_tell_the_same_in_any_number_and_order() {
    for name in ["spheres", "cage", "plane"] {
        let mut scene = builtin(name).expect("a built-in scene");
        let (lo, hi) = scene.mesh.bounds().expect("a mesh");
        let towards = scene.light.towards((lo + hi) * 0.5).normalize();
        scene.light = point(((lo + hi) * 0.5 + towards * (hi - lo).length()).as_vec3().into());
        assert!(fitted(&scene).complete, "{name}");
        let settings = settings(FacetMode::All, 32);
        let one = picture(&render(&scene, &settings));
        let lit: u32 = one.1.iter().map(|m| m.count_ones()).sum();
        assert!(lit > 1000 && lit < 32 * one.1.len() as u32 - 1000, "{name}: {lit} samples are lit");
        let mut views = cube(&scene);
        assert!(through(&scene, &settings, &views) == one, "{name}: {} views", views.len());
        views.reverse();
        assert!(through(&scene, &settings, &views) == one, "{name}: in another order");
        views.extend(views.clone());
        assert!(through(&scene, &settings, &views) == one, "{name}: each twice");
    }
}

/// Visibility in `method`; `None` where the light is nearer to a caster than the method can do with.
fn visibility(scene: &Scene, method: MethodName, settings: &Settings) -> Option<Vec<f32>> {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let mut renderer = Renderer::of_method(gpu(), &prepared, method, settings, Budget::default()).expect("a renderer");
    match renderer.render(&scene.camera, &scene.light) {
        Ok(output) => Some(output.visibility),
        Err(error) => {
            assert!(error.to_string().contains("nearer to a caster"), "{}: {error}", method.name());
            None
        }
    }
}

fn mean_difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>() / a.len() as f32
}

/// Methods that ask one view a pixel and have no slices of their own, but `exponential` and `convolution`: what leaks beneath casters that are near outweighs all else
/// (`tests/stages/moment_shadows.rs` holds it in slices against its definition).
fn ask_one() -> impl Iterator<Item = MethodName> {
    use MethodName::{Convolution, Exponential, FacetMasks, Supersampled};
    let own = |m: &MethodName| m.takes("warp") && m.row().partition.is_none();
    let left_out = |m: &MethodName| matches!(m, FacetMasks | Supersampled | Convolution | Exponential);
    MethodName::ALL.into_iter().filter(move |m| own(m) && !left_out(m))
}

/// By how much more a picture is off that tells nothing but moments.
fn blur(method: MethodName) -> f32 {
    use MethodName::{ExponentialVariance, FourMoments, LayeredVariance, Variance};
    let of_moments = matches!(method, Variance | LayeredVariance | ExponentialVariance | FourMoments);
    if of_moments { 2.0 } else { 1.0 }
}

/// Those of the other methods whose answer is exact tell what `facet-masks` does of a light among its casters, to the bit; those with a map
/// come as near to it as elsewhere, and nearer than to the picture of a lamp beside it, and on paraboloids as on planes.
#[gpu_test]
fn other_methods_take_a_cube() {
    let mut exact = 0;
    for (k, (name, scene)) in scenes().into_iter().enumerate() {
        let pages = PageSettings { pages: Some(16384), finer: 3, ..PageSettings::default() };
        let settings = Settings { map: 512, pages, ..settings(FacetMode::One, 8) };
        let want = visibility(&scene, MethodName::FacetMasks, &settings).expect("a frame");
        let coarse = Settings { map: 64, ..settings.clone() };
        let silhouettes = Settings { ray_traced: RayTracedSettings { silhouettes: true }, ..coarse.clone() };
        for (method, settings) in [
            (MethodName::RayTraced, &coarse),
            (MethodName::RayTraced, &silhouettes),
            (MethodName::Supersampled, &coarse),
        ] {
            if let Some(got) = visibility(&scene, method, settings) {
                assert!(got == want, "{name}, {}: another picture", method.name());
                exact += 1;
            }
        }
        let beside = match scene.light {
            Light::Spot { position: [x, y, z], target, angle_degrees } => {
                Light::Spot { position: [x + 0.4, y - 0.4, z + 0.2], target, angle_degrees }
            }
            _ => {
                let at = scene.light.homogeneous().as_vec4();
                point([at.x + 0.2, at.y - 0.1, at.z])
            }
        };
        let moved = Scene { light: beside, ..scene.clone() };
        let maps = [OmniMaps::Planes, OmniMaps::Paraboloids];
        let with = |method: MethodName| maps.into_iter().filter(move |omni| *omni == maps[0] || method.takes("omni"));
        let all = ask_one().flat_map(|method| with(method).map(move |omni| (method, omni)));
        for (n, (method, omni)) in all.enumerate() {
            let settings = Settings { omni, ..settings.clone() };
            let off = |s: &Scene| mean_difference(&visibility(s, method, &settings).expect("a frame"), &want);
            // The lamp is moved in two of the scenes for each.
            let (off, away) = (off(&scene), if n % 3 == k % 3 { off(&moved) } else { f32::INFINITY });
            let name = format!("{name}, {} on {omni:?}", method.name());
            // Two maps have a third of the texels of six.
            let most = if omni == OmniMaps::Paraboloids { 0.05 } else { 0.03 };
            // Half a pixel of all is no other picture.
            let nearer = 1.2 * off < away || off < 2e-4;
            assert!(off < most * blur(method) && nearer, "{name}: {off}, moved {away}");
        }
    }
    assert!(exact >= 16, "{exact} exact pictures");
}

/// The same methods in slices of what the camera sees: from near by, with most of the scene behind, their maps tell more than one view does.
#[gpu_test]
fn other_methods_take_slices() {
    let mut near = builtin("windmill").expect("a built-in scene");
    near.camera = Camera { eye: [0.9, 0.35, 1.6], target: [0.2, 0.2, 0.4], near: 0.01, ..near.camera };
    let pages = PageSettings { pages: Some(16384), finer: 3, ..PageSettings::default() };
    let settings = Settings { map: 96, pages, ..settings(FacetMode::One, 8) };
    let want = visibility(&near, MethodName::FacetMasks, &settings).expect("a frame");
    let mut whole = HashMap::new();
    use PartBy::{Depth, FrustumFaces as Faces, ReceiverClusters as Clusters, SeenDepth as Seen};
    use Warp::{Box, Fitted, Trapezoid};
    for (by, splits, warp) in
        [(Depth, 1, Box), (Seen, 2, Fitted), (Depth, 4, Trapezoid), (Faces, 1, Fitted), (Clusters, 1, Fitted)]
    {
        let plan = SplitPlan { by, splits, warp, focus: 0.3, ..SplitPlan::default() };
        let sliced = Settings { partition: Some(plan), ..settings.clone() };
        let exact = visibility(&near, MethodName::Supersampled, &sliced);
        assert!(exact.expect("a frame") == want, "{by:?} {splits} {warp:?}: another picture");
        for method in ask_one() {
            // The first misses triangles smaller than texels; what is wrong with the second is not of texels in finer maps.
            let maps = [(MethodName::Reconstructable, 768), (MethodName::PolygonIds, 32)];
            let map = maps.iter().find(|(m, _)| *m == method).map_or(settings.map, |(_, map)| *map);
            let off = |s: &Settings| {
                let picture = visibility(&near, method, &Settings { map, ..s.clone() }).expect("a frame");
                mean_difference(&picture, &want)
            };
            let (one, several) = (*whole.entry(method).or_insert_with(|| off(&settings)), off(&sliced));
            // A trapezoid by focus alone may stretch what is far away, pages are as fine as pixels in any view, and the box in sight ends where depths do.
            // So do clusters of what is one object for the most part.
            let matched = method == MethodName::ResolutionMatched || matches!(by, Seen | Clusters);
            let (better, most) = if warp == Trapezoid { (true, 0.009) } else { (several < one || matched, 0.007) };
            assert!(
                several < most * blur(method) && better,
                "{by:?} {splits} {warp:?}, {}: {several}, {one} in one view",
                method.name()
            );
        }
    }
}

/// Slices of what the camera sees, warped or not, tell what one view does, to the bit, from outside and from within, with one facet and
/// with all. Without the slice that holds most, something is missing.
#[gpu_test]
fn slices_tell_what_the_whole_view_does() {
    let mut inside = builtin("windmill").expect("a built-in scene");
    inside.camera = Camera { eye: [0.4, 0.5, 1.1], target: [0.0, 0.8, 0.0], near: 0.01, ..inside.camera };
    let mut lamp = builtin("plant").expect("a built-in scene");
    lamp.light = point([1.0, 2.0, 1.0]);
    let [windmill, city] = ["windmill", "sparse-city"].map(|name| (name, builtin(name).expect("a built-in scene")));
    let scenes = [windmill, ("inside", inside), ("lamp", lamp), city];
    // Of slices, and of clusters, of whose pixels many lie in another one's view, too.
    let ([mut missed, mut left_out], mut denser) = ([[0; 2]; 2], 0);
    for (name, scene) in scenes {
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let bounds = prepared.mesh().bounds().expect("a mesh");
        for facets in [FacetMode::One, FacetMode::All] {
            let wanted = settings(facets, 32);
            // Of one facet a pixel, which samples are cut off by other surfaces is not looked at once it is settled as lit.
            let seen = |(visibility, lit)| (visibility, if facets == FacetMode::All { lit } else { Vec::new() });
            let output = render(&scene, &wanted);
            let whole = seen(picture(&output));
            use Warp::{Box, Fitted, Perspective, Stable, Trapezoid};
            let slices = [(1, Box), (1, Fitted), (2, Trapezoid), (3, Perspective), (4, Fitted), (2, Stable)]
                .map(|(splits, warp)| (if splits == 3 { PartBy::SeenDepth } else { PartBy::Depth }, splits, warp));
            let faces = [Box, Trapezoid, Fitted].map(|warp| (PartBy::FrustumFaces, 1, warp));
            let clusters = [Box, Trapezoid, Fitted].map(|warp| (PartBy::ReceiverClusters, 1, warp));
            for (by, splits, warp) in slices.into_iter().chain(faces).chain(clusters) {
                // Its objects lie apart.
                if name == "sparse-city" && by != PartBy::ReceiverClusters {
                    continue;
                }
                let plan = SplitPlan { by, splits, warp, focus: 0.3, ..SplitPlan::default() };
                let sliced = render(&scene, &Settings { partition: Some(plan), ..wanted.clone() });
                assert!(seen(picture(&sliced)) == whole, "{name} {facets:?}: {plan:?}");
                denser += usize::from(sliced.counts.candidate_tests < output.counts.candidate_tests);
                let views = wanted.light_views(&prepared, &scene.light).expect("views");
                let slices = match by {
                    PartBy::ReceiverClusters => {
                        views[0].clusters(&scene.camera, SIZE, bounds, &plan, prepared.objects())
                    }
                    _ => views[0].slices(&scene.camera, SIZE, bounds, &plan, 0.0, None),
                };
                assert!(slices.len() == splits as usize || by != PartBy::Depth && by != PartBy::SeenDepth);
                if facets == FacetMode::All && slices.len() > 1 && warp != Stable {
                    assert!(seen(through(&scene, &wanted, &slices)) == whole, "{name}: {plan:?} by themselves");
                    for k in 0..slices.len() {
                        let mut fewer = slices.clone();
                        fewer.remove(k);
                        let kind = usize::from(by == PartBy::ReceiverClusters);
                        left_out[kind] += 1;
                        missed[kind] += usize::from(seen(through(&scene, &wanted, &fewer)) != whole);
                    }
                }
            }
        }
    }
    println!("leaving out slices and clusters shows {missed:?} times of {left_out:?}");
    assert!(3 * missed[0] > left_out[0] && missed[1] > 2, "leaving out one shows {missed:?} times of {left_out:?}");
    assert!(denser > 5, "{denser} frames have fewer tests");
}

/// Parts of a map tell what the whole does, to the bit. Without one of them something is missing.
#[gpu_test]
fn parts_of_a_map_tell_the_same() {
    let scenes = ["windmill", "spheres", "plane"].map(|name| builtin(name).expect("a built-in scene"));
    let [mut missed, mut left_out] = [0; 2];
    for scene in scenes.into_iter().chain([room()]) {
        for facets in [FacetMode::One, FacetMode::All] {
            let wanted = settings(facets, 32);
            // Of one facet a pixel, which samples are cut off by other surfaces is not looked at once it is settled as lit.
            let seen = |(visibility, lit)| (visibility, if facets == FacetMode::All { lit } else { Vec::new() });
            let whole = seen(picture(&render(&scene, &wanted)));
            let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
            let views = wanted.light_views(&prepared, &scene.light).expect("views");
            for across in [2, 3] {
                let parts = MapTiles::new(wanted.map, NonZeroU32::new(across).expect("some"));
                let wanted = Settings { map: parts.texels(), ..wanted.clone() };
                let mut cut = parts.of(views.clone());
                assert!(
                    seen(through(&scene, &wanted, &cut)) == whole,
                    "{} {facets:?}: {across} parts a side",
                    scene.name
                );
                cut.remove(cut.len() / 2);
                left_out += 1;
                missed += usize::from(seen(through(&scene, &wanted, &cut)) != whole);
            }
        }
    }
    assert!(2 * missed > left_out, "leaving out a part shows {missed} times of {left_out}");
}

/// Not even size of map, lists and strips, nor what is settled, show.
#[gpu_test]
fn how_it_is_computed_does_not_matter() {
    let scene = room();
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let wanted = settings(FacetMode::All, 32);
    let plain = picture(&render(&scene, &wanted));
    let lit = plain.1.iter().map(|m| m.count_ones()).sum::<u32>() as usize;
    assert!(lit > 5000 && lit + 5000 < 32 * plain.1.len(), "{lit} samples are lit");
    let with = |settings: Settings, budget: Budget, strips: u32| {
        let pipelines = Arc::new(Pipelines::new(&gpu().device, &settings));
        let mut renderer =
            Renderer::in_strips(gpu(), &prepared, &settings, budget, pipelines, strips).expect("a renderer");
        picture(&renderer.render(&scene.camera, &scene.light).expect("a frame"))
    };
    let (start, bytes) = (Some(1), Budget::default().bytes);
    for (what, settings, budget, strips) in [
        ("lists begun at 1", wanted.clone(), Budget { start, bytes }, 1),
        ("little memory", wanted.clone(), Budget { start, bytes: 1 << 20 }, 1),
        ("strips", wanted.clone(), Budget::default(), 3),
        ("another map", Settings { map: 33, ..wanted.clone() }, Budget::default(), 1),
        ("nothing settled", Settings { settle: false, ..wanted.clone() }, Budget::default(), 1),
    ] {
        assert!(with(settings, budget, strips) == plain, "{what}");
    }
    // A light that goes in and out, with the same renderer.
    let mut renderer = Renderer::new(gpu(), &prepared, &wanted, Budget::default()).expect("a renderer");
    let outside = point([0.3, 9.0, 0.2]);
    let before = renderer.render(&scene.camera, &outside).expect("a frame");
    assert!(picture(&renderer.render(&scene.camera, &scene.light).expect("a frame")) == plain, "after one outside");
    assert!(picture(&renderer.render(&scene.camera, &outside).expect("a frame")) == picture(&before), "outside again");
}

/// The CPU engine takes the same views.
#[gpu_test]
fn engines_agree() {
    for (name, scene) in scenes().into_iter().take(4) {
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let settings = settings(FacetMode::All, 32);
        let (camera, light) = (&scene.camera, &scene.light);
        let on_cpu =
            engine::render(&prepared, &settings, camera, light, engine::CpuRequest::default()).expect("a frame").output;
        let on_gpu = render(&scene, &settings);
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let truth = SceneTruth::new(&tracer, camera, light, &settings.samples, SIZE[0], SIZE[1]).expect("a truth");
        let differ = |p: usize| {
            let off = on_cpu.lit[p] ^ on_gpu.lit[p];
            off != 0 && off & !truth.ambiguous_mask(p as u32)[0] != 0
        };
        let wrong = (0..on_cpu.lit.len()).filter(|&p| differ(p)).count();
        assert!(wrong <= 2, "{name}: {wrong} pixels differ");
        let texels = [on_cpu.counts.silhouette_texels, on_gpu.counts.silhouette_texels];
        assert!(texels[0] > 0 && texels[1] >= texels[0] / 2, "{name}: {texels:?}");
    }
}

/// The same parts together are the same picture, to the bit: in a cube, in slices that are told and in those of its own.
#[gpu_test]
fn methods_are_their_parts_together() {
    let mut lamp = builtin("plant").expect("a built-in scene");
    lamp.light = point([1.0, 2.0, 1.0]);
    let scenes = [("windmill", builtin("windmill").expect("a built-in scene")), ("lamp", lamp), ("room", room())];
    let settings = Settings { map: 96, ..settings(FacetMode::One, 8) };
    let told = SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() };
    let mut pictures = Vec::new();
    for (name, scene) in &scenes {
        for (method, parts) in [
            (MethodName::Trapezoidal, MethodName::ShadowMap),
            (MethodName::Lispsm, MethodName::ShadowMap),
            (MethodName::Perspective, MethodName::ShadowMap),
            (MethodName::ParallelSplit, MethodName::ShadowMap),
            (MethodName::Remix, MethodName::Variance),
        ] {
            let own = method.row().partition;
            let kept = method.partition(&Settings { partition: Some(told), ..settings.clone() });
            for (left, right) in [(None, own), (Some(told), kept)] {
                let [left, right] = [(method, left), (parts, right)].map(|(method, partition)| {
                    visibility(scene, method, &Settings { partition, ..settings.clone() }).expect("a frame")
                });
                assert!(left == right, "{name}, {}: another picture than of its parts", method.name());
                pictures.push(left);
            }
        }
    }
    // Of the first scene: each is another; told are the slices of the last two alone.
    let shadow_map = visibility(&scenes[0].1, MethodName::ShadowMap, &settings).expect("a frame");
    assert!((0..10).all(|k| pictures[k] != shadow_map && (0..k).all(|j| pictures[j] != pictures[k] || k - j == 1)));
    assert_eq!([0, 2, 4, 6, 8].map(|k| pictures[k] == pictures[k + 1]), [true, true, true, false, false]);
}

/// Next to a lamp in a wide world facets and casters touch few texels: their places there are known as well as the lamp's.
#[gpu_test]
fn a_lamp_in_a_wide_world_costs_few_pairs() {
    let scene = wide();
    let of = |map| render(&scene, &Settings { map, ..settings(FacetMode::All, 32) });
    let [coarse, fine] = [64, 512].map(of);
    assert_eq!(coarse.lit, fine.lit, "another picture by a finer map");
    let counts = [coarse, fine].map(|o| [o.counts.pixel_texel_pairs, o.counts.triangle_texel_pairs]);
    println!("{counts:?} pairs");
    assert!(counts[1].iter().sum::<u64>() < 1_000_000, "{counts:?} pairs");
}
