//! The GPU engine against the CPU engine on small pictures of the built-in scenes.

use lab::scene::{Scene, builtin};
use oracle::engine;
use oracle::truth::{AMBIGUITY, FacetInput, FacetTruth, SceneTruth, Tracer, full_mask, join_mask, split_mask};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use test_support::gpu;
use test_support::gpu_test;

const SCENES: [&str; 8] = ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "bumpy", "plane"];
const SIZE: [u32; 2] = [64, 48];

fn settings(settle: bool, validity: bool) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).expect("32 samples");
    Settings { facets: FacetMode::One, validity, settle, ..Settings::new(SIZE, 64, samples) }
}

/// A scene with what is known of its samples.
struct Case {
    scene: Scene,
    prepared: Prepared,
}

impl Case {
    fn gpu(&self, settings: &Settings) -> Output {
        let mut renderer = Renderer::new(gpu(), &self.prepared, settings, Budget::default()).expect("a renderer");
        renderer.render(&self.scene.camera, &self.scene.light).expect("a frame")
    }

    fn cpu(&self, settings: &Settings) -> Output {
        let request = engine::CpuRequest::default();
        engine::render(&self.prepared, settings, &self.scene.camera, &self.scene.light, request)
            .expect("a frame")
            .output
    }

    /// Samples of each pixel that count: not ambiguous, not within the band of an edge of the triangle seen at the centre,
    /// and, if asked for, on that triangle. Nothing of a pixel without a triangle.
    fn clear(&self, output: &Output, settings: &Settings, own_only: bool) -> Vec<u32> {
        let tracer = Tracer::new(self.prepared.mesh()).expect("a tracer");
        let (camera, light) = (&self.scene.camera, &self.scene.light);
        let truth = FacetTruth::new(&tracer, camera, light, &settings.samples, SIZE[0], SIZE[1]).expect("truth");
        let truth = if settings.validity { truth } else { truth.without_validity() };
        let rays = camera.rays(SIZE[0], SIZE[1]);
        let seen = (0u32..).zip(&output.triangles).filter(|(_, t)| **t != u32::MAX);
        let facets: Vec<_> = seen
            .map(|(pixel, &triangle)| FacetInput { pixel, triangle, coverage: split_mask(full_mask(32)) })
            .collect();
        let mut clear = vec![0; output.triangles.len()];
        for (facet, result) in facets.iter().zip(truth.judge(&facets, None).expect("judged")) {
            let [a, b, c] = tracer.corners(facet.triangle).map(|p| p - rays.eye);
            let edges = [a.cross(b), b.cross(c), c.cross(a)];
            let (x, y) = (f64::from(facet.pixel % SIZE[0]), f64::from(facet.pixel / SIZE[0]));
            let counts = |k: usize, o: &[f32; 2]| {
                let r = rays.direction(x + f64::from(o[0]), y + f64::from(o[1]));
                let v = edges.map(|e| e.dot(r) / e.dot(rays.step_x).hypot(e.dot(rays.step_y)));
                let own = v.iter().all(|&v| v > 0.0) || v.iter().all(|&v| v < 0.0);
                let near = v.iter().any(|v| v.abs() <= AMBIGUITY);
                !near && (own || !own_only) && join_mask(result.ambiguous()) >> k & 1 == 0
            };
            let samples = settings.samples.offsets().iter().enumerate();
            clear[facet.pixel as usize] = samples.fold(0, |m, (k, o)| m | u32::from(counts(k, o)) << k);
        }
        clear
    }
}

impl Case {
    /// Samples of each pixel whose answer is the same within the ambiguity band: by traced rays, and on the plane of the
    /// surface that each sees.
    fn clear_of_edges(&self, settings: &Settings) -> Vec<u32> {
        let tracer = Tracer::new(self.prepared.mesh()).expect("a tracer");
        let (camera, light) = (&self.scene.camera, &self.scene.light);
        let truth = SceneTruth::new(&tracer, camera, light, &settings.samples, SIZE[0], SIZE[1]).expect("truth");
        let planes = FacetTruth::new(&tracer, camera, light, &settings.samples, SIZE[0], SIZE[1]).expect("truth");
        let mut clear: Vec<u32> = (0..SIZE[0] * SIZE[1]).map(|p| !truth.ambiguous_mask(p)[0]).collect();
        let facets = |pixel: u32| {
            let surfaces = truth.surfaces(pixel).into_iter();
            surfaces.map(move |(triangle, coverage)| FacetInput { pixel, triangle, coverage })
        };
        let facets: Vec<FacetInput> = (0..SIZE[0] * SIZE[1]).flat_map(facets).collect();
        let judged = planes.without_validity().judge(&facets, None).expect("judged");
        for (facet, result) in facets.iter().zip(judged) {
            clear[facet.pixel as usize] &= !result.ambiguous_occluded[0];
        }
        clear
    }
}

/// Pixels at which two engines see the same triangle, and the samples among `clear` that differ there.
fn differing(a: &Output, b: &Output, clear: &[u32]) -> (usize, u32) {
    let same = |&p: &usize| a.triangles[p] == b.triangles[p];
    let differ = |p: usize| ((a.lit[p] ^ b.lit[p]) & clear[p]).count_ones();
    let pixels: Vec<usize> = (0..clear.len()).filter(same).collect();
    (pixels.len(), pixels.into_iter().map(differ).sum())
}

fn compare(own_only: bool, of_gpu: &Settings, of_cpu: &Settings) {
    let mut wrong = Vec::new();
    for name in SCENES {
        let scene = builtin(name).expect("a built-in scene");
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let case = Case { scene, prepared };
        let (gpu, cpu) = (case.gpu(of_gpu), case.cpu(of_cpu));
        let clear = match of_cpu.facets {
            FacetMode::One => case.clear(&cpu, of_cpu, own_only),
            FacetMode::All => case.clear_of_edges(of_cpu),
        };
        let looked_at: u32 = clear.iter().map(|c| c.count_ones()).sum();
        assert!(looked_at > 4_000, "{name}: only {looked_at} samples to look at");
        let (same, differ) = differing(&gpu, &cpu, &clear);
        if same * 1000 < clear.len() * 995 || differ > 0 {
            wrong.push(format!(
                "{name}: {differ} of {looked_at} samples differ, {same} of {} pixels alike",
                clear.len()
            ));
        }
        let mut corrupted = gpu;
        let p = clear.iter().position(|c| *c != 0).expect("a sample");
        corrupted.triangles[p] = cpu.triangles[p];
        corrupted.lit[p] = cpu.lit[p] ^ clear[p];
        assert!(differing(&corrupted, &cpu, &clear).1 > differ, "{name}: a corrupted picture passes");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[gpu_test]
fn engines_agree_where_all_is_evaluated() {
    compare(false, &settings(false, false), &settings(false, false));
}

#[gpu_test]
fn engines_agree_on_validity() {
    compare(false, &settings(false, true), &settings(false, true));
}

/// A settled facet stands for its sheet, and the engines may settle different facets: alike on the own triangle.
#[gpu_test]
fn engines_agree_on_settled_facets() {
    compare(true, &settings(true, false), &settings(false, false));
    compare(true, &settings(true, false), &settings(true, false));
}

#[gpu_test]
fn engines_agree_on_every_surface() {
    let all = |settle| Settings { facets: FacetMode::All, ..settings(settle, false) };
    compare(false, &all(true), &all(true));
    compare(false, &all(false), &all(true));
}
