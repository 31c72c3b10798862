//! The CPU engine against facet truth and traced rays, on small pictures of the built-in scenes.

use lab::report::comparison::SceneCase;
use lab::report::{FacetErrors, FacetSet};
use lab::scene::{Scene, builtin};
use oracle::engine::{self, CpuFrame, CpuRequest};
use oracle::reference::facet_classify::FacetState;
use oracle::truth::{SceneTruth, Tracer, join_mask};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{FacetMode, PixelClass, Prepared, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Light, Mesh};

const SCENES: [&str; 8] = ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "bumpy", "plane"];

fn settings(facets: FacetMode, pattern: Pattern, samples: u32) -> Settings {
    let samples = Samples::new(pattern, samples).expect("a pattern");
    Settings { facets, cull_back: true, ..Settings::new([64, 48], 64, samples) }
}

fn everything() -> CpuRequest<'static> {
    CpuRequest { facets: true, looks: true, ..CpuRequest::default() }
}

fn render(prepared: &Prepared, scene: &Scene, settings: &Settings) -> CpuFrame {
    engine::render(prepared, settings, &scene.camera, &scene.light, everything()).expect("a frame")
}

/// What facet truth finds in a frame.
fn errors(frame: &CpuFrame, tracer: &Tracer, scene: &Scene, settings: &Settings) -> FacetErrors {
    let set = FacetSet::of_cpu(&frame.facets, settings.samples.words());
    FacetErrors::of(&set, tracer, &scene.camera, &scene.light, settings, None).expect("judged")
}

/// The scene, or the same under a point where its directional light comes from.
fn lit(name: &str, point: bool) -> Scene {
    let mut scene = builtin(name).expect("a built-in scene");
    let light = scene.light.homogeneous();
    if point && light.w == 0.0 {
        let (lo, hi) = scene.mesh.bounds().expect("a mesh");
        let at = (lo + hi) * 0.5 + light.truncate().normalize() * (hi - lo).length();
        scene.light = Light::Point { position: at.as_vec3().into() };
    }
    scene
}

/// Facets without their masks, tables of masks of no size or of any, and meshes that are none.
#[test]
fn what_does_not_fit_is_refused() {
    let scene = builtin("plane").expect("a built-in scene");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let settings = settings(FacetMode::One, Pattern::LowDiscrepancy, 32);
    let frame = render(&prepared, &scene, &settings);
    let judged = |set: &FacetSet| {
        FacetErrors::of(set, &tracer, &scene.camera, &scene.light, &settings, None).map_err(|e| e.to_string())
    };
    let whole = FacetSet::of_cpu(&frame.facets, 1);
    assert!(judged(&whole).is_ok());
    let mut short = whole.clone();
    short.masks.pop();
    for set in [short, FacetSet { words: 0, ..whole.clone() }, FacetSet { words: 5, ..whole }] {
        assert!(judged(&set).is_err_and(|e| e.starts_with("config: ") && e.contains("words of masks")));
    }
    for (angles, offsets, fits) in [(0, 256, false), (256, 0, false), (u32::MAX, u32::MAX, false), (1, 2048, true)] {
        let checked = Settings { masks: MaskVariant::Table { angles, offsets }, ..settings.clone() }.check();
        assert_eq!(checked.is_ok(), fits, "{angles} x {offsets}");
    }
    let mut none = scene.clone();
    none.mesh.triangles.push([0, 1, u32::MAX]);
    for tessellation in [0, 1] {
        assert!(
            SceneCase::new(none.clone(), tessellation, [64, 48]).is_err_and(|e| e.to_string().starts_with("mesh "))
        );
    }
}

/// No sample is wrong outside the ambiguity band, whatever is asked for; and a flipped mask or state is noticed. Each scene with two of
/// six settings, so that each setting meets two scenes or three.
#[test]
fn no_sample_is_wrong_against_facet_truth() {
    let mut wrong = Vec::new();
    let turned = [
        (FacetState::Lit, FacetState::Shadowed),
        (FacetState::Shadowed, FacetState::Lit),
        (FacetState::Dark, FacetState::Lit),
    ];
    let mut states = [0; 3];
    for (k, name) in SCENES.into_iter().enumerate() {
        let scene = lit(name, k % 2 == 1);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let asked = [
            (FacetMode::One, Pattern::LowDiscrepancy, 32, false, true),
            (FacetMode::One, Pattern::Grid, 8, true, true),
            (FacetMode::One, Pattern::Rotated, 16, false, false),
            (FacetMode::One, Pattern::LowDiscrepancy, 1, false, true),
            (FacetMode::All, Pattern::LowDiscrepancy, 128, false, true),
            (FacetMode::All, Pattern::LowDiscrepancy, 32, true, true),
        ];
        for (facets, pattern, samples, force, validity) in [asked[k % 6], asked[(k + 3) % 6]] {
            let wanted = Settings { validity, ..settings(facets, pattern, samples) };
            let plan = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, force).expect("a plan");
            assert_eq!(plan.extent, Extent::Everything, "{name}");
            let frame = render(&prepared, &scene, &plan.settings);
            let found = errors(&frame, &tracer, &scene, &plan.settings);
            let label = format!("{name} {facets:?} {samples} force {force} validity {validity}");
            assert!(found.facet_samples > 1000, "{label}: {found:?}");
            assert!(frame.output.counts.visibility_evaluations > 0, "{label}: nothing was evaluated");
            if found.facet_wrong_outside_band > 0 {
                wrong.push(format!("{label}: {found:?}"));
            }
            // Few are flipped: of each sample that is wrong the band is asked for, which is dear.
            let mut corrupted = frame.clone();
            for facet in corrupted.facets.iter_mut().step_by(8) {
                facet.masks.occluded = !facet.masks.occluded;
            }
            let noticed = errors(&corrupted, &tracer, &scene, &plan.settings).facet_wrong_outside_band;
            assert!(noticed > 10, "{label}: flipped masks pass");
            if force || !validity || pattern != Pattern::LowDiscrepancy {
                continue;
            }
            for (k, (from, to)) in turned.iter().enumerate() {
                let mut other = frame.clone();
                let changed = other.facets.iter_mut().filter(|f| f.masks.state == *from);
                let changed = changed.map(|f| f.masks.state = *to).count();
                let noticed = errors(&other, &tracer, &scene, &plan.settings);
                let faults = noticed.facet_wrong_settled + noticed.facet_wrong_dark;
                assert!(changed < 20 || faults > 0, "{label}: {changed} {from:?} as {to:?} pass");
                states[k] += changed;
            }
        }
    }
    assert!(states.iter().all(|&n| n > 100), "states turned over: {states:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Samples that both drop have no answer that could be wrong; all others have.
#[test]
fn what_is_dropped_is_not_wrong() {
    let scene = lit("windmill", false);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let settings = settings(FacetMode::One, Pattern::LowDiscrepancy, 32);
    let frame = render(&prepared, &scene, &settings);
    let with = |change: &dyn Fn(u128) -> u128| {
        let mut changed = frame.clone();
        changed.facets.iter_mut().for_each(|f| f.masks.occluded ^= change(f.masks.invalid) & f.masks.coverage);
        errors(&changed, &tracer, &scene, &settings).facet_wrong_outside_band
    };
    let dropped: u32 = frame.facets.iter().map(|f| (f.masks.invalid & f.masks.coverage).count_ones()).sum();
    assert!(dropped > 100, "{dropped} samples are dropped");
    assert_eq!((with(&|_| 0), with(&|invalid| invalid)), (0, 0));
    assert!(with(&|invalid| !invalid) > 100, "flipped samples that count pass");
}

/// With a facet for every surface each sample is what a traced ray says, outside the band of either edge.
#[test]
fn every_surface_is_what_rays_say() {
    for (k, name) in SCENES.into_iter().enumerate() {
        let scene = lit(name, k % 2 == 0);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let settings = settings(FacetMode::All, Pattern::LowDiscrepancy, 32);
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &settings, false).expect("a plan");
        let frame = render(&prepared, &scene, &plan.settings);
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, 64, 48).expect("a truth");
        let (mut wrong, mut looked_at, mut tried, mut noticed) = (Vec::new(), 0, 0, 0);
        for p in 0..64 * 48u32 {
            let here = truth.pixel(p);
            if here.seen_count == 0 {
                assert_eq!(frame.output.visibility[p as usize], 1.0, "{name}: pixel {p} sees nothing");
                continue;
            }
            let (lit, differs) = (u128::from(frame.output.lit[p as usize]), |lit: u128| lit ^ join_mask(here.lit));
            looked_at += here.seen_count;
            // The band is dear, so it is asked for only where there is something to excuse.
            let off = differs(lit);
            if off != 0 && off & !join_mask(truth.ambiguous_mask(p)) != 0 {
                wrong.push((p, off));
            }
            // One sample turned over is noticed, unless it lies in the band.
            if p % 61 == 0 {
                let seen = join_mask(here.seen);
                let off = differs(lit ^ (seen & seen.wrapping_neg()));
                noticed += u32::from(off & !join_mask(truth.ambiguous_mask(p)) != 0);
                tried += 1;
            }
        }
        assert!(tried > 10 && noticed > tried / 2, "{name}: {noticed} of {tried} samples turned over are noticed");
        assert!(looked_at > 20_000, "{name}: {looked_at}");
        // Beneath a crease that opens towards the light a plane runs on into the shadow of its neighbour.
        assert!(wrong.len() <= 2, "{name}: {wrong:?}");
    }
}

/// Bands of rows and parts of facets do not show: a picture of more pixels than one band holds is that of its rows alone.
#[test]
fn bands_do_not_matter() {
    let scene = builtin("spheres").expect("a built-in scene");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let samples = Samples::new(Pattern::Grid, 1).expect("a pattern");
    let wide = Settings { size: [900, 600], ..Settings { map: 32, ..settings(FacetMode::One, Pattern::Grid, 1) } };
    let wide = Settings { samples, ..wide };
    let frame = render(&prepared, &scene, &wide);
    assert!(wide.pixels() > 1 << 19, "one band holds all");
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    assert_eq!(errors(&frame, &tracer, &scene, &wide).facet_wrong_outside_band, 0);
    let pixels: Vec<u32> = frame.facets.iter().map(|f| f.pixel).collect();
    assert!(pixels.is_sorted() && *pixels.last().expect("facets") >= 1 << 19, "the last rows see nothing");
    let seen = frame.output.triangles.iter().filter(|t| **t != u32::MAX).count();
    assert_eq!(pixels.len(), seen);
}

/// What nothing shadows is lit where it faces the light, without looking at casters; an empty scene is lit.
#[test]
fn without_shadows_only_facing_counts() {
    let mesh =
        Mesh { positions: vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 0.0, 1.5]], triangles: vec![[0, 1, 2]] };
    let scene = Scene::of_mesh("test", mesh).expect("a scene");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let settings = settings(FacetMode::One, Pattern::LowDiscrepancy, 32);
    for (y, lit) in [(1.0, true), (-1.0, false)] {
        let eye_above = scene.camera.eye[1] > 0.0;
        let light = Light::Directional { direction: [0.1, y, 0.2] };
        let plan = Plan::of(&prepared, &scene.camera, &light, &settings, false).expect("a plan");
        assert_eq!(plan.extent, Extent::Facing);
        let request = CpuRequest { unshadowed: true, ..everything() };
        let frame = engine::render(&prepared, &plan.settings, &scene.camera, &light, request).expect("a frame");
        let shown = if lit == eye_above { PixelClass::Lit } else { PixelClass::Dark };
        let looks = frame.looks.expect("looks");
        assert!(looks.map.is_none() && looks.classes.contains(&shown));
        assert!(looks.classes.iter().all(|&c| c == shown || c == PixelClass::Empty));
        let share = |p: usize| if looks.classes[p] == PixelClass::Dark { 0.0 } else { 1.0 };
        assert!((0..64 * 48).all(|p| frame.output.visibility[p] == share(p)));
    }
    let nothing = Prepared::new(&Mesh::default()).expect("a sound mesh");
    let frame = engine::render(&nothing, &settings, &scene.camera, &scene.light, everything()).expect("a frame");
    assert!(frame.output.visibility.iter().all(|&v| v == 1.0) && frame.facets.is_empty());
}

/// Progress ends at all pixels, stages are told apart, looks are there.
#[test]
fn stages_progress_and_looks() {
    let scene = builtin("windmill").expect("a built-in scene");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let settings = settings(FacetMode::All, Pattern::LowDiscrepancy, 32);
    let most = std::sync::Mutex::new((0, 0));
    let progress = |done: usize, all: usize| {
        let mut most = most.lock().expect("no panic");
        *most = (most.0.max(done), all);
    };
    let request = CpuRequest { progress: Some(&progress), ..everything() };
    let frame = engine::render(&prepared, &settings, &scene.camera, &scene.light, request).expect("a frame");
    assert_eq!(*most.lock().expect("no panic"), (64 * 48, 64 * 48));
    let plan = Plan::of(&prepared, &scene.camera, &scene.light, &settings, false).expect("a plan");
    for step in plan.steps.iter().filter(|s| s.left_out.is_none() && !s.name.contains('.')) {
        let ran = frame.stages.iter().any(|s| s.name == step.name && s.ms >= 0.0);
        assert!(ran != engine::merged(step.name, &frame.stages).is_some(), "{}", step.name);
    }
    let looks = frame.looks.expect("looks");
    let count = |class: PixelClass| looks.classes.iter().filter(|c| **c == class).count() as u64;
    for class in [PixelClass::Empty, PixelClass::Dark, PixelClass::Lit, PixelClass::Undecided] {
        assert!(count(class) > 0, "{class:?}: {:?}", PixelClass::ALL.map(count));
    }
    assert_eq!(count(PixelClass::Empty), frame.output.counts.empty_facets);
    let map = looks.map.expect("a map");
    assert_eq!((map.depths.len(), map.marks.len()), (64 * 64, 64 * 64));
    let marked = map.marks.iter().filter(|m| **m).count() as u64;
    assert!(marked > 0 && marked == frame.output.counts.silhouette_texels);
}
