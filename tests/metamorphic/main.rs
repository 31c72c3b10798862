//! Changes of the input or of the memory that must not change a bit of the picture: order, duplicates, scale, list
//! sizes, bands, map size, number of samples, repetition, what the plan leaves out, how pairs are brought together.

mod extremes;
mod strips;

use lab::scene::{Scene, builtin};
use std::sync::{Arc, Mutex};
use subpixel_shadows::Error;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::methods::facet_masks::{FacetMode, PairVariant, Pipelines, Settings};
use subpixel_shadows::methods::{DebugViews, Prepared};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::wgpu::Limits;
use test_support::gpu;
use test_support::gpu_test;

const SCENES: [&str; 9] = ["plane", "spheres", "windmill", "cage", "bicycle", "plant", "knot", "bumpy", "city"];
const SIZE: [u32; 2] = [80, 60];

/// Three scenes; all of them with `SUBPIXEL_SHADOWS_ALL_SCENES=1`, or those that it names, as in `bumpy,city`: most of the time
/// goes into building pipelines.
fn scenes() -> impl Iterator<Item = &'static str> {
    let asked = std::env::var("SUBPIXEL_SHADOWS_ALL_SCENES").unwrap_or_default();
    let named = move |name: &str| asked == "1" || asked.split(',').any(|n| n == name);
    let some = all_scenes();
    SCENES
        .into_iter()
        .enumerate()
        .filter(move |(k, name)| if some { named(name) } else { *k < 3 })
        .map(|(_, name)| name)
}

/// Whether scenes are asked for beyond the first three.
fn all_scenes() -> bool {
    std::env::var("SUBPIXEL_SHADOWS_ALL_SCENES").is_ok_and(|v| !v.is_empty())
}

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn settings(settle: bool) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).expect("32 samples");
    Settings { facets: FacetMode::One, settle, ..Settings::new(SIZE, 64, samples) }
}

/// Pipelines are made once for each number of mask words.
fn renderer<'a>(prepared: &'a Prepared, settings: &Settings, budget: Budget) -> Renderer<'a> {
    static MADE: Mutex<Vec<Arc<Pipelines>>> = Mutex::new(Vec::new());
    let mut made = MADE.lock().expect("no test panicked while making pipelines");
    let pipelines = made.iter().find(|p| p.serve(settings)).cloned().unwrap_or_else(|| {
        let new = Arc::new(Pipelines::new(&gpu().device, settings));
        made.push(new.clone());
        new
    });
    Renderer::with_pipelines(gpu(), prepared, settings, budget, pipelines).expect("a renderer")
}

fn render_with(mesh: &Mesh, camera: &Camera, light: &Light, settings: &Settings, budget: Budget) -> Output {
    let prepared = Prepared::new(mesh).expect("a sound mesh");
    renderer(&prepared, settings, budget).render(camera, light).expect("a frame")
}

fn try_render(scene: &Scene, settings: &Settings, budget: Budget) -> Result<Output, Error> {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    Renderer::new(gpu(), &prepared, settings, budget)?.render(&scene.camera, &scene.light)
}

fn render(scene: &Scene, settings: &Settings) -> Output {
    render_with(&scene.mesh, &scene.camera, &scene.light, settings, Budget::default())
}

/// Words of one picture: visibility and lit masks, to the bit.
fn picture(output: &Output) -> Vec<u32> {
    output.visibility.iter().map(|v| v.to_bits()).chain(output.lit.iter().copied()).collect()
}

/// How many words differ, and the first; `None` if none does.
fn difference(a: &[u32], b: &[u32]) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} and {} words", a.len(), b.len()));
    }
    let first = a.iter().zip(b).position(|(a, b)| a != b)?;
    let count = a.iter().zip(b).filter(|(a, b)| a != b).count();
    Some(format!("{count} of {} words differ, first {first}: {:#x} and {:#x}", a.len(), a[first], b[first]))
}

/// Collects what differs, so that one run names every scene.
#[derive(Default)]
struct Failures(Vec<String>);

impl Failures {
    fn compare(&mut self, what: &str, a: &Output, b: &Output) {
        let (a, b) = (picture(a), picture(b));
        if let Some(difference) = difference(&a, &b) {
            self.0.push(format!("{what}: {difference}"));
        }
        // The comparison must notice one bit.
        let mut corrupted = b;
        let middle = corrupted.len() / 2;
        corrupted[middle] ^= 1;
        assert!(difference(&a, &corrupted).is_some(), "{what}: a corrupted picture passes");
    }

    fn report(self) {
        assert!(self.0.is_empty(), "{}", self.0.join("\n"));
    }
}

/// A small generator, the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n as u64) as usize
    }

    fn shuffle<T>(&mut self, list: &mut [T]) {
        (1..list.len()).rev().for_each(|i| list.swap(i, self.below(i + 1)));
    }
}

/// The same triangles in another order, of other vertex numbers, each begun at another corner.
fn disordered(mesh: &Mesh, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut out = mesh.clone();
    let mut place: Vec<usize> = (0..mesh.positions.len()).collect();
    random.shuffle(&mut place);
    for (from, &to) in place.iter().enumerate() {
        out.positions[to] = mesh.positions[from];
    }
    for triangle in &mut out.triangles {
        *triangle = triangle.map(|v| place[v as usize] as u32);
        triangle.rotate_left(random.below(3));
    }
    random.shuffle(&mut out.triangles);
    out
}

fn scaled(scene: &Scene, factor: f32) -> Scene {
    let mut out = scene.clone();
    let scale = |p: &mut [f32; 3]| p.iter_mut().for_each(|c| *c *= factor);
    out.mesh.positions.iter_mut().for_each(scale);
    scale(&mut out.camera.eye);
    scale(&mut out.camera.target);
    out.camera.near *= factor;
    out.camera.far *= factor;
    match &mut out.light {
        Light::Directional { .. } => {}
        Light::Point { position } => scale(position),
        Light::Spot { position, target, .. } => {
            scale(position);
            scale(target);
        }
    }
    out
}

/// A hundred frames of the first scene and five of the others; of every scene a hundred, with one facet a pixel and with all,
/// with `SUBPIXEL_SHADOWS_ALL_SCENES=1`.
#[gpu_test]
fn frames_repeat() {
    let mut failures = Failures::default();
    let modes = if all_scenes() { vec![FacetMode::One, FacetMode::All] } else { vec![FacetMode::One] };
    for (k, (name, &facets)) in scenes().flat_map(|name| modes.iter().map(move |m| (name, m))).enumerate() {
        let scene = scene(name);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let settings = Settings { facets, ..settings(true) };
        let mut renderer = renderer(&prepared, &settings, Budget::default());
        let mut frame = || renderer.render(&scene.camera, &scene.light).expect("a frame");
        let first = frame();
        assert!(first.counts.silhouette_pixels > 0 || name == "plane", "{name}: nothing to evaluate");
        let frames = if k == 0 || all_scenes() { 100 } else { 5 };
        for n in 1..frames {
            failures.compare(&format!("{name}, {facets:?}, frame {n}"), &first, &frame());
        }
        let evaluations = first.counts.visibility_evaluations;
        println!("{name}, {facets:?}: {frames} frames of {evaluations} evaluations");
    }
    failures.report();
}

/// A renderer keeps the light's view while the light is the same, and no longer.
#[gpu_test]
fn earlier_lights_do_not_matter() {
    let mut failures = Failures::default();
    let scene = scene("spheres");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let settings = settings(true);
    let lights =
        [scene.light, Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Point { position: [2.0, 6.0, 1.0] }];
    let fresh = lights.map(|light| render_with(&scene.mesh, &scene.camera, &light, &settings, Budget::default()));
    assert!(fresh[0].visibility != fresh[1].visibility && fresh[1].visibility != fresh[2].visibility);
    let mut renderer = renderer(&prepared, &settings, Budget::default());
    for k in [0, 1, 1, 0, 2, 2, 1] {
        let frame = renderer.render(&scene.camera, &lights[k]).expect("a frame");
        failures.compare(&format!("light {k}"), &fresh[k], &frame);
    }
    failures.report();
}

#[gpu_test]
fn order_does_not_matter() {
    let mut failures = Failures::default();
    for name in scenes() {
        let scene = scene(name);
        let first = render(&scene, &settings(true));
        for seed in [1, 2] {
            let mesh = disordered(&scene.mesh, seed);
            assert_ne!(mesh, scene.mesh);
            let other = render_with(&mesh, &scene.camera, &scene.light, &settings(true), Budget::default());
            failures.compare(&format!("{name}, order {seed}"), &first, &other);
        }
    }
    failures.report();
}

/// Every triangle twice. Where a sheet is doubled its texels are marked, so fewer facets are settled; all are evaluated
/// here. (A settled facet of a pixel stands for its sheet, an evaluated one for its plane.)
#[gpu_test]
fn duplicates_do_not_matter() {
    let mut failures = Failures::default();
    for name in scenes() {
        let mut scene = scene(name);
        let first = render(&scene, &settings(false));
        let once = scene.mesh.triangles.clone();
        scene.mesh.triangles.extend(once);
        failures.compare(&format!("{name}, doubled"), &first, &render(&scene, &settings(false)));
    }
    failures.report();
}

#[gpu_test]
fn scale_does_not_matter() {
    let mut failures = Failures::default();
    for name in scenes() {
        let scene = scene(name);
        let first = render(&scene, &settings(true));
        for power in [-20, 20] {
            let other = scaled(&scene, 2f32.powi(power));
            failures.compare(&format!("{name}, times 2^{power}"), &first, &render(&other, &settings(true)));
        }
    }
    failures.report();
}

#[gpu_test]
fn list_sizes_do_not_matter() {
    let mut failures = Failures::default();
    let mut short_of_memory = 0;
    for name in scenes() {
        let scene = scene(name);
        let with = |budget| render_with(&scene.mesh, &scene.camera, &scene.light, &settings(true), budget);
        let first = with(Budget::default());
        let grown = with(Budget { start: Some(1), ..Budget::default() });
        failures.compare(&format!("{name}, lists begun at 1"), &first, &grown);
        let bytes: u64 = first.lists.iter().zip([8, 4, 12]).map(|(l, size)| l.needed * size).sum();
        match try_render(&scene, &settings(true), Budget { bytes: bytes / 2, ..Budget::default() }) {
            Ok(short) => {
                failures.compare(&format!("{name}, half of the memory from the beginning"), &first, &short);
                short_of_memory += 1;
            }
            Err(Error::Memory { .. }) => {}
            Err(other) => failures.0.push(format!("{name}, half of the memory from the beginning: {other}")),
        }
        if bytes < 64 {
            continue;
        }
        // A facet that reaches the horizon needs the casters of the whole map at once: a share may be too little, and is
        // then refused. Of these shares one must do.
        let mut fitted = 0;
        for share in [8, 2] {
            match try_render(&scene, &settings(true), Budget { start: Some(1), bytes: bytes / share }) {
                Ok(banded) => {
                    assert!(banded.lists[0].needed < first.lists[0].needed, "{name}: the budget asked for no bands");
                    failures.compare(&format!("{name}, 1/{share} of the memory"), &first, &banded);
                    fitted += 1;
                }
                Err(Error::Memory { .. }) => {}
                Err(other) => failures.0.push(format!("{name}, 1/{share} of the memory: {other}")),
            }
        }
        if fitted == 0 {
            failures.0.push(format!("{name}: half of the memory does not do"));
        }
    }
    assert!(short_of_memory > 0, "no scene did with half of the memory from the beginning");
    failures.report();
}

/// By tiles or by texels, sorted or grouped, what comes of the pairs is the same, with room for all from the start, with none, and
/// in bands.
#[gpu_test]
fn how_pairs_are_brought_together_does_not_matter() {
    let mut failures = Failures::default();
    for (name, facets) in scenes().flat_map(|name| [(name, FacetMode::One), (name, FacetMode::All)]) {
        let scene = scene(name);
        let with = |pairs, budget| {
            let settings = Settings { pairs, facets, ..settings(true) };
            render_with(&scene.mesh, &scene.camera, &scene.light, &settings, budget)
        };
        let tiled = with(PairVariant::Tiled, Budget::default());
        let grouped = with(PairVariant::Grouped, Budget::default());
        let sorted = with(PairVariant::Sorted, Budget::default());
        assert!(grouped.counts.visibility_evaluations > 0, "{name}: nothing was evaluated");
        // Evaluations are not compared: a facet that is covered takes no more, and that depends on the order.
        let pairs = |o: &Output| (o.counts.pixel_texel_pairs, o.counts.triangle_texel_pairs, o.counts.candidate_tests);
        assert_eq!(pairs(&sorted), pairs(&grouped), "{name}");
        assert!(pairs(&tiled).0 < pairs(&grouped).0, "{name}: tiles do not bring texels together");
        failures.compare(&format!("{name}, {facets:?}, sorted"), &grouped, &sorted);
        failures.compare(&format!("{name}, {facets:?}, tiled"), &grouped, &tiled);
        for variant in [PairVariant::Tiled, PairVariant::Sorted] {
            let grown = with(variant, Budget { start: Some(1), ..Budget::default() });
            assert!(grown.lists[0].runs > 1, "{name}: the lists did not grow");
            failures.compare(&format!("{name}, {facets:?}, {variant:?}, lists begun at 1"), &grouped, &grown);
        }
    }
    failures.report();
}

/// What the plan leaves out of a scene changes no pixel. (The mask of a facet that was settled holds all of its samples, of
/// one that was evaluated those that are valid.)
#[gpu_test]
fn what_is_left_out_does_not_matter() {
    let mut failures = Failures::default();
    let mut left_out = 0;
    for (name, facets) in scenes().flat_map(|name| [(name, FacetMode::One), (name, FacetMode::All)]) {
        let scene = scene(name);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let wanted = Settings { facets, cull_back: true, ..settings(true) };
        let [planned, forced] = [false, true].map(|force| {
            let plan = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, force).expect("a plan");
            assert_eq!(plan.extent, Extent::Everything, "{name}");
            left_out += if force { 0 } else { plan.left_out().count() };
            let mut renderer = renderer(&prepared, &plan.settings, Budget::default());
            let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
            assert!(output.counts.visibility_evaluations > 0, "{name}: nothing was evaluated");
            Output { lit: Vec::new(), ..output }
        });
        failures.compare(&format!("{name}, {facets:?}"), &forced, &planned);
    }
    assert!(left_out > 0, "nothing was left out");
    failures.report();
}

/// With nothing settled, the light-view map only lists candidates: its size changes no answer.
#[gpu_test]
fn map_size_does_not_matter() {
    let mut failures = Failures::default();
    for name in scenes() {
        let scene = scene(name);
        let first = render(&scene, &settings(false));
        for map in if name == "plane" { [1, 33] } else { [2, 33] } {
            let other = render(&scene, &Settings { map, ..settings(false) });
            failures.compare(&format!("{name}, map of {map}"), &first, &other);
        }
    }
    failures.report();
}

/// The samples of a shorter pattern are the first of a longer one, and each is decided by itself.
#[gpu_test]
fn samples_do_not_influence_each_other() {
    for name in scenes() {
        let scene = scene(name);
        let with = |count| {
            let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("a pattern");
            render(&scene, &Settings { samples, ..settings(true) })
        };
        let all = with(128);
        for count in [1u32, 8, 32, 64] {
            let few = with(count);
            let differing = |few: &Output| {
                let words = few.words as usize;
                (0..few.visibility.len())
                    .filter(|&pixel| {
                        (0..count as usize).any(|k| {
                            let bit = |o: &Output, words: usize| o.lit[pixel * words + k / 32] >> (k % 32) & 1;
                            bit(few, words) != bit(&all, 4)
                        })
                    })
                    .count()
            };
            assert_eq!(differing(&few), 0, "{name}: pixels whose first {count} samples differ from those of 128");
            let mut corrupted = few;
            corrupted.lit[7 * corrupted.words as usize] ^= 1;
            assert_eq!(differing(&corrupted), 1, "{name}: a corrupted picture passes");
        }
    }
}

/// Samples of a pixel that lie inside the triangle seen at its centre, farther than a hundredth of a pixel from its edges.
fn own_samples(prepared: &Prepared, output: &Output, scene: &Scene, samples: &Samples) -> Vec<u32> {
    let rays = scene.camera.rays(SIZE[0], SIZE[1]);
    let own = |pixel: usize| -> u32 {
        let t = output.triangles[pixel];
        if t == u32::MAX {
            return u32::MAX;
        }
        let [a, b, c] = prepared.mesh().corners(t as usize).map(|p| p - rays.eye);
        let edges = [a.cross(b), b.cross(c), c.cross(a)];
        let (x, y) = ((pixel % SIZE[0] as usize) as f64, (pixel / SIZE[0] as usize) as f64);
        samples.offsets().iter().enumerate().fold(0, |mask, (k, o)| {
            let r = rays.direction(x + f64::from(o[0]), y + f64::from(o[1]));
            let inside = |turn: f64| {
                edges.iter().all(|e| {
                    let slope = e.dot(rays.step_x).hypot(e.dot(rays.step_y));
                    turn * e.dot(r) > 0.01 * slope
                })
            };
            mask | u32::from(inside(1.0) || inside(-1.0)) << k
        })
    };
    (0..output.triangles.len()).map(own).collect()
}

/// Settled facets are answered as evaluation would, at the samples on the triangle itself, whatever the size of the map.
/// A settled facet stands for its sheet and keeps no validity mask, so elsewhere the two may differ.
#[gpu_test]
fn settling_does_not_matter_on_the_own_triangle() {
    let mut failures = Failures::default();
    for name in scenes() {
        let scene = scene(name);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let without = |settle| Settings { validity: false, ..settings(settle) };
        let exact = render(&scene, &without(false));
        let own = own_samples(&prepared, &exact, &scene, &settings(true).samples);
        let masked = |o: &Output| o.lit.iter().zip(&own).map(|(l, m)| l & m).collect::<Vec<_>>();
        for map in [2, 33, 256] {
            let settled = render(&scene, &Settings { map, ..without(true) });
            if map == 256 && settled.counts.lit_facets + settled.counts.shadowed_facets == 0 {
                failures.0.push(format!("{name}: nothing was settled"));
            }
            let (a, mut b) = (masked(&exact), masked(&settled));
            if let Some(difference) = difference(&a, &b) {
                failures.0.push(format!("{name}, map of {map}: {difference}"));
            }
            b[11] ^= 1;
            assert!(difference(&a, &b).is_some());
        }
    }
    failures.report();
}
