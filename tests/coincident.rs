//! Surfaces that almost coincide: every sample is given the one that it sees, however near the next one is. And lights that almost lie in
//! the plane of a surface: truths and engines agree on which side they are.

use lab::report::{FacetErrors, FacetSet, SceneErrors, SeenErrors, TracedScene};
use oracle::engine;
use oracle::truth::Tracer;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};
use test_support::gpu;
use test_support::gpu_test;

const SIZE: [u32; 2] = [48, 36];

fn settings(facets: FacetMode) -> Settings {
    Settings { facets, ..Settings::new(SIZE, 64, Samples::new(Pattern::default(), 32).expect("32 samples")) }
}

fn camera(eye: [f32; 3], target: [f32; 3], fov: f32) -> Camera {
    Camera {
        eye,
        target,
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: fov,
        near: 1e-3,
        far: 1e3,
        lens: Lens::CENTRED,
        near_plane: None,
    }
}

/// A mesh, and from where it is seen.
struct World {
    name: String,
    mesh: Mesh,
    camera: Camera,
    light: Light,
}

/// Closed plates of 2 x 2 units, 4 x 4 quads a side, the border welded, of some thickness, over a ground.
fn plate(thickness: f32) -> World {
    const N: u32 = 4;
    let mut mesh = Mesh::default();
    let at = |i: u32| 2.0 * i as f32 / N as f32 - 1.0;
    for y in [1.0, 1.0 - thickness] {
        for i in 0..=N {
            mesh.positions.extend((0..=N).map(|j| [at(i), y, at(j)]));
        }
    }
    let (side, under) = (N + 1, (N + 1) * (N + 1));
    let mut quad = |a: u32, b: u32, c: u32, d: u32| mesh.triangles.extend([[a, b, c], [a, c, d]]);
    for i in 0..N {
        for j in 0..N {
            let k = i * side + j;
            quad(k, k + 1, k + side + 1, k + side);
            quad(under + k, under + k + side, under + k + side + 1, under + k + 1);
        }
        // The rim: along x at both ends of z, along z at both ends of x.
        let (x, z) = (i * side, i);
        quad(x, x + side, under + x + side, under + x);
        quad(x + side + N, x + N, under + x + N, under + x + side + N);
        quad(z + 1, z, under + z, under + z + 1);
        quad(N * side + z, N * side + z + 1, under + N * side + z + 1, under + N * side + z);
    }
    let ground = mesh.ground_below().expect("a ground");
    mesh.add_ground(&mesh.ground_below().map(|g| subpixel_shadows::scene::Ground { y: 0.0, ..g }).unwrap_or(ground));
    World {
        name: format!("plate of {thickness:e}"),
        mesh,
        camera: camera([2.0, 4.0, 5.0], [0.0, 0.8, 0.0], 35.0),
        light: Light::Directional { direction: [0.4, 1.0, 0.3] },
    }
}

/// Two triangles with one common corner, the others `ulps` apart.
fn leaves(ulps: u32) -> World {
    let up = |y: f32| f32::from_bits(y.to_bits() + ulps);
    let mesh = Mesh {
        positions: vec![
            [0.65, 0.03, 0.35],
            [1.0, 0.08, 0.0],
            [1.0, 0.00125, 0.35],
            [0.65, up(0.03), 0.35],
            [1.0, up(0.00125), 0.35],
        ],
        triangles: vec![[0, 2, 1], [3, 4, 1]],
    };
    World {
        name: format!("leaves {ulps} ulps apart"),
        mesh,
        camera: camera([0.75, 0.3, 0.5], [0.85, 0.03, 0.25], 45.0),
        light: Light::Directional { direction: [0.47, 0.48, -0.04] },
    }
}

/// Bodies that stand twice, the second `ulps` of their largest coordinate off, far from the origin.
fn doubled(ulps: u32) -> World {
    let mut mesh = Mesh::default();
    let off = |x: f32| f32::from_bits(x.to_bits() + ulps);
    for copy in 0..2 {
        for body in 0..3 {
            let first = mesh.positions.len() as u32;
            for k in 0..8u32 {
                let side = |axis: u32| (k >> axis & 1) as f32;
                let x = 2500.0 + 3.0 * body as f32 + side(0) * 1.3;
                let p = [x, 40.0 + side(1) * (2.0 + body as f32), 900.0 + side(2) * 1.1 + 0.3 * side(1)];
                mesh.positions.push(if copy == 0 { p } else { p.map(off) });
            }
            for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
                mesh.triangles.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| first + v)));
            }
        }
    }
    World {
        name: format!("bodies twice, {ulps} ulps apart"),
        mesh,
        camera: camera([2496.0, 47.0, 910.0], [2503.0, 41.0, 900.5], 40.0),
        light: Light::Directional { direction: [0.3, 0.8, 0.5] },
    }
}

/// How a frame compares with the truths.
struct Held {
    facet: FacetErrors,
    seen: SeenErrors,
    scene: SceneErrors,
}

impl World {
    fn held(&self, set: &FacetSet, output: &Output, prepared: &Prepared, settings: &Settings) -> Held {
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let (camera, light) = (&self.camera, &self.light);
        let traced = TracedScene::new(&tracer, camera, light, settings, None).expect("a truth");
        Held {
            facet: FacetErrors::of(set, &tracer, camera, light, settings, None).expect("a truth"),
            seen: SeenErrors::of(set, &tracer, camera, settings, None).expect("a truth"),
            scene: traced.errors(&output.visibility).expect("one size"),
        }
    }

    /// On the GPU, and the facets of it.
    fn on_gpu(&self, prepared: &Prepared, settings: &Settings) -> (FacetSet, Output) {
        let mut renderer = Renderer::new(gpu(), prepared, settings, Budget::default()).expect("a renderer");
        let output = renderer.render(&self.camera, &self.light).expect("a frame");
        let set = FacetSet::read(gpu(), renderer.facets(), settings.samples.words()).expect("readback");
        (set, output)
    }

    /// Every sample has the surface it sees and the light that falls there, on both engines; more than `least_match` of the pixels are
    /// within a sample of scene truth.
    fn check(&self, least_match: f64) {
        let prepared = Prepared::new(&self.mesh).expect("a mesh");
        for facets in [FacetMode::One, FacetMode::All] {
            let wanted = settings(facets);
            let plan = Plan::of(&prepared, &self.camera, &self.light, &wanted, false).expect("a plan");
            let what = format!("{}, {facets:?}", self.name);
            let request = engine::CpuRequest { facets: true, ..engine::CpuRequest::default() };
            let frame = engine::render(&prepared, &plan.settings, &self.camera, &self.light, request).expect("a frame");
            let of_cpu = (FacetSet::of_cpu(&frame.facets, 1), frame.output);
            for (engine, (set, output)) in [("CPU", of_cpu), ("GPU", self.on_gpu(&prepared, &plan.settings))] {
                let held = self.held(&set, &output, &prepared, &plan.settings);
                assert_eq!(held.seen.seen_wrong, 0, "{engine}: {what}: {:?}", held.seen);
                assert_eq!(held.facet.facet_wrong_outside_band, 0, "{engine}: {what}: {:?}", held.facet);
                if facets == FacetMode::All {
                    assert_eq!(held.scene.scene_acne_pixels, 0, "{engine}: {what}: {:?}", held.scene);
                    assert!(
                        held.scene.scene_pixel_match.is_some_and(|m| m > least_match),
                        "{engine}: {what}: {:?}",
                        held.scene
                    );
                }
            }
        }
    }
}

#[gpu_test]
fn thin_plates_show_their_upper_side() {
    for thickness in [1e-7, 2e-7, 1e-6, 3e-6, 1e-5, 1e-4, 1e-3] {
        plate(thickness).check(0.998);
    }
}

#[gpu_test]
fn leaves_at_a_common_corner_are_told_apart() {
    for ulps in [1, 2, 5, 100] {
        leaves(ulps).check(0.998);
    }
}

#[gpu_test]
fn bodies_that_stand_twice_are_told_apart() {
    for ulps in [1, 2, 7] {
        doubled(ulps).check(0.998);
    }
}

/// A light within 2^-40 of the ground's plane lies in it, and the ground is dark; a light above shines along it.
#[gpu_test]
fn a_light_along_the_ground_is_in_it_or_above() {
    for (height, lit) in [(0.0, false), (1e-15, false), (1e-14, false), (1e-13, false), (1e-11, true), (1e-9, true)] {
        let light = Light::Directional { direction: [0.3e-3, height, 1.0] };
        let scene = lab::scene::builtin("plane").expect("a scene");
        let world = World { name: format!("light {height:e} above"), mesh: scene.mesh, camera: scene.camera, light };
        // Along the walls' lower edges rays run within rounding of both wall and ground.
        world.check(0.99);
        let prepared = Prepared::new(&world.mesh).expect("a mesh");
        let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
        let traced =
            TracedScene::new(&tracer, &world.camera, &world.light, &settings(FacetMode::All), None).expect("a truth");
        let bright = traced.visibility().iter().filter(|&&v| v == 1.0).count();
        assert_eq!(bright > 600, lit, "{height:e}: {bright} of {} pixels are lit", traced.visibility().len());
    }
}

/// A sample that is put on the surface behind its own is noticed, though facet truth finds nothing wrong with it.
#[gpu_test]
fn another_surface_is_noticed() {
    let world = doubled(7);
    let prepared = Prepared::new(&world.mesh).expect("a mesh");
    let settings = settings(FacetMode::All);
    let (set, output) = world.on_gpu(&prepared, &settings);
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let camera = &world.camera;
    let seen = |set: &FacetSet| SeenErrors::of(set, &tracer, camera, &settings, None).expect("a truth");
    assert_eq!((seen(&set).seen_wrong, seen(&set).seen_samples), (0, 48 * 36 * 32));
    // The triangle whose corners are each nearest to those of the one that is seen: its copy.
    let corners = |t: u32| tracer.corners(t);
    let copy = |t: u32| {
        let off = |u: u32| corners(u).iter().zip(corners(t)).map(|(a, b)| (*a - b).length()).sum::<f64>();
        let others = (0..tracer.triangle_count() as u32).filter(|&u| u != t);
        others.min_by(|&a, &b| off(a).total_cmp(&off(b))).expect("another triangle")
    };
    let mut swapped = set.clone();
    let full = |f: usize| set.masks[3 * f] == u32::MAX;
    let at = (0..set.facets.len()).find(|&f| full(f) && set.facets[f].state == 4).expect("a facet of a whole pixel");
    swapped.facets[at].triangle = copy(set.facets[at].triangle);
    let errors = seen(&swapped);
    assert!(errors.seen_wrong > 16, "{errors:?}");
    assert_eq!(
        errors.first_wrong.map(|[pixel, _, t]| [pixel, t]),
        Some([set.facets[at].pixel, swapped.facets[at].triangle])
    );
    // A sample that is given nothing, and the centres alone.
    let mut dropped = set.clone();
    dropped.masks[3 * at] = !1;
    assert_eq!(seen(&dropped).seen_wrong, 1);
    let centres =
        |triangles: &[u32]| SeenErrors::of_centres(triangles, &tracer, camera, &settings, None).expect("a truth");
    let mut triangles = output.triangles.clone();
    assert_eq!((centres(&triangles).seen_wrong, centres(&triangles).seen_samples), (0, 48 * 36));
    let pixel = set.facets[at].pixel as usize;
    triangles[pixel] = copy(triangles[pixel]);
    assert_eq!(centres(&triangles).seen_wrong, 1);
    // A number that is no triangle of the mesh is an error.
    triangles[pixel] = tracer.triangle_count() as u32;
    assert!(SeenErrors::of_centres(&triangles, &tracer, camera, &settings, None).is_err());
}
