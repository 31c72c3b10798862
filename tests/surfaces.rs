//! A facet for every surface, from end to end: each sample lit or dark as traced rays say, on the built-in scenes.
//! (`city` is left out: its truth takes minutes.)

use lab::scene::{Scene, SceneOptions};
use oracle::truth::{FacetInput, FacetTruth, SceneTruth, Tracer, TruthImage, join_mask};
use std::sync::Arc;
use subpixel_shadows::glam::{DQuat, DVec3, Quat, Vec3};
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::methods::{MethodName, Prepared};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use test_support::gpu;
use test_support::gpu_test;

const SIZE: [u32; 2] = [120, 90];
const SCENES: [&str; 8] = ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "bumpy", "plane"];

fn settings(facets: FacetMode) -> Settings {
    let samples = Samples::new(Pattern::default(), 32).expect("a pattern");
    let masks = MaskVariant::Exact;
    Settings { facets, masks, cull_back: true, ..Settings::new(SIZE, 128, samples) }
}

/// A built-in scene, under its own light or under a point where a directional light comes from, and the other way round.
fn scene(name: &str, other_light: bool) -> Scene {
    let mut scene = Scene::open(name, &SceneOptions::default()).expect("a built-in scene");
    if other_light {
        let (lo, hi) = scene.mesh.bounds().expect("a mesh");
        let (centre, radius) = ((lo + hi) * 0.5, (hi - lo).length() * 0.5);
        let l = scene.light.homogeneous();
        scene.light = if l.w == 0.0 {
            let at = centre + l.truncate().normalize() * radius * 2.0;
            Light::Point { position: at.as_vec3().into() }
        } else {
            Light::Directional { direction: (l.truncate() - centre).as_vec3().into() }
        };
    }
    scene
}

/// Scene truth and its ambiguity band: samples whose answer is another within 1/256 pixel, and those within 1/256 pixel of
/// a shadow on the plane of the surface they see. The second differ at creases: beyond a crease that opens towards the
/// light the plane of either side runs on beneath the other, into its shadow. Which of the two a sample at the crease sees
/// is a matter of rounding, and both sides may be lit.
fn truth(scene: &Scene, prepared: &Prepared, settings: &Settings) -> TruthImage {
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let [w, h] = SIZE;
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, w, h).expect("a truth");
    let mut image = truth.image(None);
    let facets = FacetTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, w, h).expect("a truth");
    let surfaces = |pixel: u32| {
        truth.surfaces(pixel).into_iter().map(move |(triangle, coverage)| FacetInput { pixel, triangle, coverage })
    };
    let inputs: Vec<FacetInput> = (0..w * h).flat_map(surfaces).collect();
    for (input, result) in inputs.iter().zip(facets.without_validity().judge(&inputs, None).expect("facets")) {
        let band = &mut image.pixels[input.pixel as usize].ambiguous;
        *band = std::array::from_fn(|k| band[k] | result.ambiguous_occluded[k]);
    }
    for (pixel, p) in image.pixels.iter_mut().enumerate() {
        let around = truth.ambiguous_mask(pixel as u32);
        p.ambiguous = std::array::from_fn(|k| p.ambiguous[k] | around[k]);
    }
    image
}

/// The largest share of the samples that the band may take up.
const MOST_AMBIGUOUS: f64 = 0.05;

/// Samples of which is wrong whether they see a surface, outside the ambiguity band.
fn wrong_coverage(renderer: &Renderer, truth: &TruthImage) -> u32 {
    let facets = renderer.facets().expect("facets");
    let masks = facets.masks.read(gpu()).expect("readback");
    let first = facets.pixel_facets.read(gpu()).expect("readback");
    let off = |(pixel, p): (usize, &oracle::truth::PixelTruth)| {
        let of = |f: u32| masks[3 * f as usize];
        let twice = (first[pixel]..first[pixel + 1]).map(|f| of(f).count_ones()).sum::<u32>();
        let seen = (first[pixel]..first[pixel + 1]).fold(0, |seen, f| seen | of(f));
        assert_eq!(seen.count_ones(), twice, "a sample of pixel {pixel} lies in two facets");
        ((seen ^ p.seen[0]) & !p.ambiguous[0]).count_ones()
    };
    truth.pixels.iter().enumerate().map(off).sum()
}

/// Samples that differ outside the ambiguity band, and pixels off by more than 1/32.
fn wrong(output: &Output, truth: &TruthImage) -> (u32, usize) {
    let mut samples = 0;
    let mut pixels = 0;
    for (pixel, p) in truth.pixels.iter().enumerate() {
        if p.seen_count > 0 {
            let off = (u128::from(output.lit[pixel]) ^ join_mask(p.lit)) & !join_mask(p.ambiguous);
            samples += off.count_ones();
        }
        pixels += usize::from((output.visibility[pixel] - p.visibility).abs() > 1.0 / 32.0 + 1e-6);
    }
    (samples, pixels)
}

fn render(prepared: &Prepared, scene: &Scene, settings: &Settings, budget: Budget) -> Output {
    let mut renderer = Renderer::new(gpu(), prepared, settings, budget).expect("a renderer");
    renderer.render(&scene.camera, &scene.light).expect("a frame")
}

fn check(name: &str) {
    for other_light in [false, true] {
        let scene = scene(name, other_light);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &settings(FacetMode::All), false).expect("a plan");
        assert!(!plan.settings.validity, "coverage replaces validity");
        let truth = truth(&scene, &prepared, &plan.settings);
        let mut renderer = Renderer::new(gpu(), &prepared, &plan.settings, Budget::default()).expect("a renderer");
        let mut output = renderer.render(&scene.camera, &scene.light).expect("a frame");
        assert_eq!(wrong_coverage(&renderer, &truth), 0, "{name}");
        let (samples, pixels) = wrong(&output, &truth);
        let in_band: u32 = truth.pixels.iter().map(|p| join_mask(p.ambiguous).count_ones()).sum();
        let share = f64::from(in_band) / (32 * truth.pixels.len()) as f64;
        eprintln!("{name}, {:?}: {samples} wrong, {pixels} pixels off, {share:.4} in the band", scene.light);
        assert_eq!(samples, 0, "{name}, {:?}: wrong samples", scene.light);
        assert!(share <= MOST_AMBIGUOUS, "{name}, {:?}: {share} of the samples are ambiguous", scene.light);
        let most = truth.pixels.len().div_ceil(10_000);
        assert!(pixels <= most, "{name}: {pixels} pixels off by more than 1/32, at most {most}");
        // One sample that is not at an edge, turned over, is noticed.
        let sure = truth.pixels.iter().position(|p| p.seen_count > 0 && p.ambiguous[0] & 1 == 0 && p.seen[0] & 1 == 1);
        output.lit[sure.expect("a sample that is sure")] ^= 1;
        assert_eq!(wrong(&output, &truth).0.abs_diff(samples), 1);
    }
}

macro_rules! scenes {
    ($($name:ident)*) => { $(
        #[gpu_test]
        fn $name() {
            assert!(SCENES.contains(&stringify!($name)));
            check(stringify!($name));
        }
    )* };
}
scenes! { windmill cage bicycle plant spheres knot bumpy plane }

/// With one facet a pixel the same comparison fails: it is not blind.
#[gpu_test]
fn one_facet_is_wrong() {
    let scene = scene("bicycle", false);
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let settings = settings(FacetMode::One);
    let (samples, pixels) =
        wrong(&render(&prepared, &scene, &settings, Budget::default()), &truth(&scene, &prepared, &settings));
    assert!(samples > 1000 && pixels > 100, "{samples} samples, {pixels} pixels");
}

/// Two triangles at an edge that face the light alike do not shadow each other, whichever of them rounding gives a sample near the
/// edge to: where every facet is evaluated no sample is lost at a crease.
#[gpu_test]
fn creases_are_lit() {
    for (name, facets) in [("knot", FacetMode::All), ("bumpy", FacetMode::All), ("bumpy", FacetMode::One)] {
        let scene = scene(name, false);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let wanted = Settings { size: [640, 480], map: 256, ..settings(facets) };
        let [planned, forced] = [false, true].map(|force| {
            let plan = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, force).expect("a plan");
            render(&prepared, &scene, &plan.settings, Budget::default())
        });
        let settled = planned.counts.lit_facets;
        assert!(settled > 40_000 && forced.counts.lit_facets < settled / 2, "{name}: {settled} facets settled");
        // Not of masks: that of a facet which was settled holds what an evaluated one drops as another's.
        let off = planned.visibility.iter().zip(&forced.visibility).filter(|(a, b)| a != b).count();
        assert_eq!(off, 0, "{name}, {facets:?}: pixels differ where every facet is evaluated");
    }
}

/// From inside a closed body all is dark, by every method, and with a facet for every surface without evaluation; also if the mesh
/// as a whole is open, and casters that turn away are left out.
#[gpu_test]
fn seen_from_inside_a_body() {
    let given = scene("spheres", false);
    let prepared = Prepared::new(&given.mesh).expect("a sound mesh");
    assert!(prepared.closed);
    let look = |eye: [f32; 3], light| {
        let camera = Camera { eye, target: [eye[0] + 0.3, eye[1] + 0.9, eye[2] + 0.2], near: 1e-3, ..given.camera };
        Scene { camera, light, ..given.clone() }
    };
    // A sheet far below opens the mesh, and casts nothing on the rest.
    let mut mesh = given.mesh.clone();
    let base = mesh.positions.len() as u32;
    mesh.positions.extend([[-50.0, -60.0, -50.0], [-49.0, -60.0, -50.0], [-50.0, -60.0, -49.0]]);
    mesh.triangles.push([base, base + 1, base + 2]);
    let open = Prepared::new(&mesh).expect("a sound mesh");
    assert!(!open.closed && open.bodies.iter().filter(|body| !**body).count() == 1);
    // In the slab, away from the balls, and in the largest ball.
    for eye in [[5.0, -0.25, 5.0], [0.0, 1.0, 0.0]] {
        for light in [given.light, Light::Directional { direction: [0.3, 1.0, 0.2] }] {
            let scene = look(eye, light);
            for facets in [FacetMode::One, FacetMode::All] {
                let settings = settings(facets);
                let truth = truth(&scene, &prepared, &settings);
                let output = render(&prepared, &scene, &settings, Budget::default());
                let seen = truth.pixels.iter().filter(|p| p.seen_count > 0).count();
                assert!(seen * 2 > truth.pixels.len(), "{seen} pixels see something");
                assert_eq!(
                    (wrong(&output, &truth).1, output.counts.lit_facets),
                    (0, 0),
                    "{eye:?} {light:?} {facets:?}"
                );
                let evaluated = output.counts.silhouette_pixels;
                assert!(evaluated == 0 || facets == FacetMode::One, "{eye:?} {light:?}: something is evaluated");
            }
            let settings = settings(FacetMode::All);
            let output = render(&open, &scene, &settings, Budget::default());
            let found = (wrong(&output, &truth(&scene, &open, &settings)).1, output.counts.lit_facets);
            assert_eq!(found, (0, 0), "{eye:?} {light:?}: beside a sheet");
            for method in [MethodName::Spsm, MethodName::ShadowMap, MethodName::RayTraced] {
                let settings = Settings { facets: FacetMode::One, ..settings.clone() };
                let mut any = Renderer::of_method(gpu(), &prepared, method, &settings, Budget::default()).expect("one");
                let output = any.render(&scene.camera, &scene.light).expect("a frame");
                let lit = output.visibility.iter().zip(&output.triangles).filter(|(v, t)| **t != u32::MAX && **v > 0.0);
                assert_eq!(lit.count(), 0, "{eye:?} {light:?} {method:?}");
            }
        }
    }
}

/// A box over a floor far below, seen from inside it: its bottom, which is no caster, lies nearer to its top than to the floor, and is
/// in shadow all the same.
#[gpu_test]
fn the_bottom_of_a_box_from_inside() {
    let corners = (0..8u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|c| 4.0 * f32::from(c) - 2.0));
    let mut mesh = Mesh { positions: corners.collect(), triangles: Vec::new() };
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.add_ground(&subpixel_shadows::scene::Ground { y: -40.0, half_width: 12.0, center: [0.0; 2] });
    let given = Scene::of_mesh("box", mesh).expect("a sound mesh");
    let prepared = Prepared::new(&given.mesh).expect("a sound mesh");
    let camera = Camera { eye: [0.1, 1.0, 0.2], target: [0.0, -2.0, 0.1], near: 1e-3, ..given.camera };
    for light in [
        Light::Directional { direction: [0.05, 1.0, 0.02] },
        Light::Point { position: [1.0, 90.0, 0.5] },
        Light::Spot { position: [1.0, 90.0, 0.5], target: [0.0; 3], angle_degrees: 40.0 },
    ] {
        let scene = Scene { camera, light, ..given.clone() };
        let plan = Plan::of(&prepared, &camera, &light, &settings(FacetMode::All), false).expect("a plan");
        assert!(plan.settings.cull_back && plan.settings.settle);
        let output = render(&prepared, &scene, &plan.settings, Budget::default());
        let seen = output.triangles.iter().filter(|t| **t != u32::MAX).count();
        let lit = output.visibility.iter().zip(&output.triangles).filter(|(v, t)| **t != u32::MAX && **v > 0.0).count();
        assert!(seen > output.triangles.len() / 2 && lit == 0, "{light:?}: {lit} of {seen} pixels lit");
        let outside = Scene { camera: Camera { eye: [5.0, 9.0, 6.0], ..camera }, ..scene };
        let lit: f32 = render(&prepared, &outside, &plan.settings, Budget::default()).visibility.iter().sum();
        assert!(lit > 1000.0, "{light:?}: {lit} pixels lit from outside");
    }
}

/// Sheets that lie on each other within the rounding of single precision, tilted so that their vertices round: of two such
/// sheets the one that is seen is lit, and the other would be in its shadow.
#[gpu_test]
fn touching_surfaces() {
    let (x, y) = (DVec3::new(0.8, 0.23, -0.31), DVec3::new(0.17, 0.41, 0.83));
    let up = x.cross(y).normalize() * -1.0;
    let (mut off, mut seen) = (0, 0);
    for (sheets, lift) in [(2, 0.0), (2, 1e-7), (2, -2e-7), (2, 4e-7), (6, 0.0), (6, 1e-7), (6, -1e-7), (6, 4e-7)] {
        let mut mesh = Mesh::default();
        for k in 0..sheets {
            let turn = DQuat::from_axis_angle(up, 0.7 * f64::from(k));
            let base = mesh.positions.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let at = turn * (x * u + y * v) + up * lift * f64::from(k) + DVec3::new(0.3, 0.7, -0.2);
                mesh.positions.push(at.as_vec3().into());
            }
            mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
        let camera = Camera::framing(DVec3::splat(-1.0), DVec3::ONE);
        let camera = Camera { eye: (up * 4.0 + x).as_vec3().into(), target: [0.3, 0.7, -0.2], ..camera };
        let light = Light::Directional { direction: (up + x * 0.4).as_vec3().into() };
        let scene = Scene { mesh, camera, light, ..scene("plane", false) };
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let truth = truth(&scene, &prepared, &settings(FacetMode::All));
        let frame = render(&prepared, &scene, &settings(FacetMode::All), Budget::default());
        off += wrong(&frame, &truth).1;
        seen += truth.pixels.iter().filter(|p| p.seen_count == 32).count();
    }
    eprintln!("{off} of {seen}");
    assert!(seen > 8000, "{seen} pixels to see");
    assert!(off * 100 <= seen, "{off} of {seen} pixels off by more than 1/32");
}

/// The same bits from lists that start at one element, from bands, in later frames, with nothing settled early, and with
/// casters culled or not.
#[gpu_test]
fn every_way_gives_the_same_bits() {
    for name in ["plane", "spheres", "knot", "windmill"] {
        let scene = scene(name, false);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let wanted = settings(FacetMode::All);
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, false).expect("a plan");
        let mut renderer = Renderer::new(gpu(), &prepared, &plan.settings, Budget::default()).expect("a renderer");
        let first = renderer.render(&scene.camera, &scene.light).expect("a frame");
        let same = |what: &str, output: &Output| {
            assert!(output.lit == first.lit, "{name}: other masks {what}");
            assert!(output.visibility == first.visibility, "{name}: another picture {what}");
            assert!(output.triangles == first.triangles, "{name}: other triangles {what}");
        };
        same("in the next frame", &renderer.render(&scene.camera, &scene.light).expect("a frame"));
        let small = Budget { start: Some(1), ..Budget::default() };
        let grown = render(&prepared, &scene, &plan.settings, small);
        assert!(grown.lists.iter().all(|l| l.runs > 1), "{name}: {:?}", grown.lists);
        same("from lists of one element", &grown);
        let bands = Budget { bytes: 1 << 18, ..small };
        same("in bands", &render(&prepared, &scene, &plan.settings, bands));
        let forced = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, true).expect("a plan");
        assert!(!forced.settings.settle && !forced.settings.cull_back);
        same("with nothing left out", &render(&prepared, &scene, &forced.settings, Budget::default()));
        assert_eq!(plan.settings.cull_back, prepared.bodies.contains(&true), "{name}");
        if plan.settings.cull_back {
            let culled = Settings { cull_back: true, ..forced.settings.clone() };
            let output = render(&prepared, &scene, &culled, Budget::default());
            same("with casters culled", &output);
            let all = render(&prepared, &scene, &Settings { cull_back: false, ..culled }, Budget::default()).counts;
            let few = output.counts;
            assert!(5 * few.triangle_texel_pairs < 4 * all.triangle_texel_pairs, "{name}: {few:?} of {all:?}");
        }
    }
}

/// Bodies that stick in a floor and in each other, a torn one and one turned inside out among them: casters of whole bodies that
/// turn away are left out, those of the others are not.
#[gpu_test]
fn bodies_in_sheets_and_in_each_other() {
    let body = Scene::open("spheres", &SceneOptions::default()).expect("a built-in scene").mesh;
    let (lo, hi) = body.bounds().expect("a mesh");
    let mut random = 1u64;
    let mut unit = || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 40) as f64 / (1u64 << 24) as f64
    };
    for round in 0..3 {
        let mut mesh = Mesh::default();
        let mut of_whole = 0;
        for k in 0..6 {
            let at = DVec3::new(unit(), 0.3 * unit(), unit()) * 3.0 - DVec3::new(1.5, 0.6, 1.5);
            let turn = DQuat::from_axis_angle(DVec3::new(unit(), unit(), unit() + 0.1).normalize(), 6.0 * unit());
            let base = mesh.positions.len() as u32;
            let moved = body.positions.iter().map(|p| {
                let p = (DVec3::from(p.map(f64::from)) - (lo + hi) * 0.5) * (1.6 / (hi - lo).max_element());
                (at + turn * p).as_vec3().to_array()
            });
            mesh.positions.extend(moved);
            let mut triangles = body.triangles.clone();
            match k {
                0 => drop(triangles.drain(..triangles.len() / 20)),
                1 => triangles.iter_mut().for_each(|t| t.reverse()),
                _ => of_whole += triangles.len(),
            }
            mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + base)));
        }
        // A sheet that turns away from the light.
        let base = mesh.positions.len() as u32;
        mesh.positions.extend([[-0.9f32, 1.3, -0.9], [0.2, 1.4, -0.9], [-0.3, 1.2, 0.8]]);
        mesh.triangles.push([base, base + 1, base + 2]);
        mesh.add_ground(&subpixel_shadows::scene::Ground { y: -0.2, half_width: 3.0, center: [0.0; 2] });
        let mut scene = Scene::of_mesh("bodies", mesh).expect("a sound mesh");
        scene.light = match round {
            0 => Light::Directional { direction: [0.5, 1.0, 0.3] },
            1 => Light::Point { position: [4.0, 5.0, 1.0] },
            _ => Light::Spot { position: [-3.0, 6.0, 2.0], target: [0.0; 3], angle_degrees: 60.0 },
        };
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        assert!(prepared.bodies.iter().filter(|b| **b).count() >= of_whole && !prepared.closed);
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &settings(FacetMode::All), false).expect("a plan");
        assert!(plan.settings.cull_back);
        let truth = truth(&scene, &prepared, &plan.settings);
        let output = render(&prepared, &scene, &plan.settings, Budget::default());
        let (samples, _) = wrong(&output, &truth);
        assert_eq!(samples, 0, "round {round}: wrong samples");
        let all = Settings { cull_back: false, ..plan.settings.clone() };
        assert!(output.lit == render(&prepared, &scene, &all, Budget::default()).lit, "round {round}: other masks");
        // Had the sheet been taken for part of a body, its shadow would be missing.
        let mut mistaken = prepared.clone();
        Arc::make_mut(&mut mistaken.bodies).fill(true);
        let (samples, _) = wrong(&render(&mistaken, &scene, &plan.settings, Budget::default()), &truth);
        assert!(samples > 0, "round {round}: all triangles as of bodies, and nothing is wrong");
    }
}

/// Blocks of the light's map that no facet asks for may be left out: the pictures are the same, to the bit, of one renderer whose camera turns, with
/// one view of the light and with several; and marked texels are fewer.
#[gpu_test]
fn blocks_that_nobody_requests_change_nothing() {
    let lamp = Light::Point { position: [0.3, 1.7, 0.2] };
    let inside = |name: &str, light: Option<Light>| {
        let scene = Scene::open(name, &SceneOptions::default()).expect("a built-in scene");
        Scene { light: light.unwrap_or(scene.light), ..scene }
    };
    let scenes = [inside("windmill", None), inside("plant", None), inside("spheres", Some(lamp))];
    let [mut fewer, mut darker, mut frames] = [0; 3];
    for scene in scenes {
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let (low, high) = prepared.mesh().bounds().expect("a mesh");
        let middle = (low * 0.6 + high * 0.4).as_vec3();
        let slices = SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.3, ..SplitPlan::default() };
        for (facets, samples, partition) in
            [(FacetMode::All, 32, None), (FacetMode::One, 8, None), (FacetMode::All, 32, Some(slices))]
        {
            let samples = Samples::new(Pattern::LowDiscrepancy, samples).expect("a pattern");
            let all = Settings { facets, partition, request_blocks: false, ..Settings::new([56, 40], 160, samples) };
            let part = Settings { request_blocks: true, ..all.clone() };
            let [mut whole, mut requesting] = [&all, &part]
                .map(|settings| Renderer::new(gpu(), &prepared, settings, Budget::default()).expect("a renderer"));
            for turn in 0..4u8 {
                let towards = Quat::from_rotation_y(1.5 * f32::from(turn)) * Vec3::new(1.0, -0.2, 0.3);
                let camera = Camera {
                    eye: middle.into(),
                    target: (middle + towards).into(),
                    vertical_fov_degrees: 50.0,
                    near: 1e-2,
                    ..scene.camera
                };
                let [a, b] = [&mut whole, &mut requesting].map(|r| r.render(&camera, &scene.light).expect("a frame"));
                let picture = |o: &Output| o.visibility.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                // Of one facet a pixel, which samples are cut off by other surfaces is not looked at once it is settled.
                let lit = facets == FacetMode::One || a.lit == b.lit;
                assert!(picture(&a) == picture(&b) && lit, "{}, {facets:?}, {partition:?}, turn {turn}", scene.name);
                let [of_whole, of_part] = [&a, &b].map(|output| output.counts.silhouette_texels);
                assert!(of_part <= of_whole, "{}: {of_part} marked texels, {of_whole} of the whole map", scene.name);
                fewer += u32::from(2 * of_part < of_whole);
                darker += a.visibility.iter().filter(|v| **v < 1.0).count() as u32;
                frames += 1;
            }
        }
    }
    assert!(3 * fewer > frames && darker > 5000, "{fewer} of {frames} frames make half of the marks; {darker} pixels");
}
