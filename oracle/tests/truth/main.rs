//! Truth against brute force, against closed forms, and against itself.

mod facets;
mod formula;

use oracle::truth::{AMBIGUITY, FacetInput, FacetResult, FacetTruth, SceneTruth, Tracer, join_mask, split_mask};
use subpixel_shadows::glam::{DVec3, DVec4, Vec3};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};

const LIGHTS: [Light; 2] =
    [Light::Directional { direction: [0.5, 1.0, 0.25] }, Light::Point { position: [0.7, 3.0, -0.4] }];

/// A small generator, so that a failing case can be named by its number.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) & 0x7fff_ffff) as f64 / f64::from(1u32 << 31)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

/// A grid of `n` × `n` squares in the plane y = 0, from -1 to 1.
fn grid(n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let at = |k: usize| k as f32 / n as f32 * 2.0 - 1.0;
            mesh.positions.push([at(i), 0.0, at(j)]);
        }
    }
    let row = n as u32 + 1;
    for j in 0..n as u32 {
        for i in 0..n as u32 {
            let a = i + j * row;
            mesh.triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
        }
    }
    mesh
}

/// A closed sphere of `n` × `n` patches whose radius jumps from vertex to vertex.
fn spiky_sphere(n: u32, spikes: f64) -> Mesh {
    let mut random = Random(11);
    let mut mesh = Mesh { positions: vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]], triangles: Vec::new() };
    let at = |i: u32, j: u32| 2 + i % n + (j - 1) * n;
    for j in 1..n {
        for i in 0..n {
            let (theta, phi) = (f64::from(j) / f64::from(n), f64::from(i) / f64::from(n));
            let (s, c) = (theta * std::f64::consts::PI).sin_cos();
            let (sp, cp) = (phi * std::f64::consts::TAU).sin_cos();
            let p = DVec3::new(s * cp, c, s * sp) * (1.0 + spikes * random.unit());
            mesh.positions.push(p.as_vec3().into());
        }
    }
    for i in 0..n {
        mesh.triangles.push([0, at(i + 1, 1), at(i, 1)]);
        mesh.triangles.push([1, at(i, n - 1), at(i + 1, n - 1)]);
        for j in 1..n - 1 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn soup(n: usize, size: f64, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..n as u32 {
        let at = random.vector();
        for _ in 0..3 {
            mesh.positions.push((at + random.vector() * size).as_vec3().into());
        }
        mesh.triangles.push([3 * k, 3 * k + 1, 3 * k + 2]);
    }
    mesh
}

fn moved(mesh: &Mesh, scale: f32, offset: [f32; 3]) -> Mesh {
    let place = |p: &[f32; 3]| (Vec3::from(*p) * scale + Vec3::from(offset)).into();
    Mesh { positions: mesh.positions.iter().map(place).collect(), triangles: mesh.triangles.clone() }
}

/// The same decisions over every triangle, one after the other: each triangle is a mesh of its own.
struct Brute(Vec<Tracer>);

impl Brute {
    fn new(mesh: &Mesh) -> Self {
        let single = |t: &[u32; 3]| Mesh { positions: mesh.positions.clone(), triangles: vec![*t] };
        Self(mesh.triangles.iter().map(|t| Tracer::new(&single(t)).unwrap()).collect())
    }

    fn closest(&self, origin: DVec3, direction: DVec3) -> Option<(f64, u32)> {
        let hit = |(k, t): (usize, &Tracer)| t.closest(origin, direction, 0.0).map(|h| (h.t, k as u32));
        self.0.iter().enumerate().filter_map(hit).min_by(|a, b| a.partial_cmp(b).unwrap())
    }

    fn occluded(&self, point: DVec3, light: DVec4) -> bool {
        self.0.iter().any(|t| t.occluded(point, light, &|_| false))
    }
}

/// A ray that is hard on a hierarchy: random, along an axis, at a vertex, at an edge, from far away.
fn ray(mesh: &Mesh, size: f64, k: usize, random: &mut Random) -> (DVec3, DVec3) {
    let (lo, _) = mesh.bounds().unwrap();
    let corners = mesh.corners(random.below(mesh.triangles.len()));
    let origin = lo + (random.vector() * 1.5 + 1.0) * size;
    match k % 6 {
        0 => (origin, random.vector()),
        1 => (origin, [DVec3::X, DVec3::Y, DVec3::Z][k / 6 % 3] * if k % 4 < 2 { 1.0 } else { -1.0 }),
        2 => (origin, corners[0] - origin),
        3 => (origin, corners[0] + (corners[1] - corners[0]) * random.unit() - origin),
        4 => (corners[0] + DVec3::Y * size, -DVec3::Y),
        _ => (origin + random.vector() * size * 1e3, corners[2] - origin),
    }
}

/// Where `closest` and `occluded` of the hierarchy and of brute force differ, over `count` rays.
fn differences(mesh: &Mesh, size: f64, count: usize, seed: u64) -> usize {
    compare(mesh, &Tracer::new(mesh).unwrap(), size, count, seed)
}

fn compare(mesh: &Mesh, tracer: &Tracer, size: f64, count: usize, seed: u64) -> usize {
    let brute = Brute::new(mesh);
    let mut random = Random(seed);
    let mut wrong = 0;
    for k in 0..count {
        let (origin, direction) = ray(mesh, size, k, &mut random);
        if k % 2 == 0 {
            let hit = tracer.closest(origin, direction, 0.0).map(|h| (h.t, h.triangle));
            wrong += usize::from(hit != brute.closest(origin, direction));
        } else {
            let light = if k % 4 == 1 { direction.extend(0.0) } else { (origin + direction).extend(1.0) };
            wrong += usize::from(tracer.occluded(origin, light, &|_| false) != brute.occluded(origin, light));
        }
    }
    wrong
}

#[test]
fn hierarchy_equals_brute_force_on_a_million_hard_rays() {
    let mut random = Random(3);
    let meshes = [grid(3), soup(24, 0.5, &mut random), spiky_sphere(4, 0.8)];
    let places = [(1.0, [0.0; 3]), (1.0, [1e6, -1e6, 1e6]), (1048576.0, [0.0; 3]), (1.0 / 1048576.0, [0.0; 3])];
    for (m, mesh) in meshes.iter().enumerate() {
        for (p, &(scale, offset)) in places.iter().enumerate() {
            let wrong = differences(&moved(mesh, scale, offset), f64::from(scale), 85_000, (m * 10 + p) as u64);
            assert_eq!(wrong, 0, "mesh {m}, place {p}");
        }
    }
    for seed in 0..4 {
        assert_eq!(differences(&soup(400, 0.1, &mut random), 1.0, 2_000, seed), 0);
    }
}

#[test]
fn the_comparison_notices_one_lost_triangle() {
    let mesh = spiky_sphere(4, 0.8);
    let mut lossy = mesh.clone();
    lossy.triangles.pop();
    assert!(compare(&mesh, &Tracer::new(&lossy).unwrap(), 1.0, 10_000, 1) > 100);
}

#[test]
fn closed_surfaces_have_no_gap_at_edges_and_vertices() {
    // Rays from inside a closed surface must meet it, whatever they are aimed at; also seen as shadow.
    let mut random = Random(5);
    for (scale, offset) in [(1.0, [0.0; 3]), (1.0, [148_376.0, 1234.0, -223_423.0]), (1.0 / 1048576.0, [0.0; 3])] {
        let mesh = moved(&spiky_sphere(16, 0.9), scale, offset);
        let tracer = Tracer::new(&mesh).unwrap();
        let middle = Vec3::from(offset).as_dvec3();
        for k in 0..60_000 {
            let corners = mesh.corners(random.below(mesh.triangles.len()));
            let origin = middle + random.vector() * f64::from(scale) * 0.2;
            let target = match k % 3 {
                0 => corners[k % 9 / 3],
                1 => corners[0] + (corners[1] - corners[0]) * random.unit(),
                _ => origin + random.vector(),
            };
            let direction = target - origin;
            assert!(tracer.closest(origin, direction, 0.0).is_some(), "case {k}");
            assert!(tracer.occluded(origin, direction.extend(0.0), &|_| false), "case {k}");
        }
    }
}

#[test]
fn fans_leak_no_light_at_their_edges() {
    let mut random = Random(9);
    for n in [4u32, 7, 32, 255, 1024] {
        let mut mesh = Mesh { positions: vec![[0.1, 1.0, -0.2]], triangles: Vec::new() };
        for k in 0..n {
            let (s, c) = (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
            let y = 0.8 + 0.3 * random.unit();
            mesh.positions.push(DVec3::new(c, y, s).as_vec3().into());
            mesh.triangles.push([0, 1 + (k + 1) % n, 1 + k]);
        }
        let tracer = Tracer::new(&mesh).unwrap();
        let point = DVec3::new(0.05, -1.0, 0.1);
        for k in 0..20 * n {
            let corners = mesh.corners((k % n) as usize);
            let target = corners[0] + (corners[1] - corners[0]) * random.unit() * 0.99;
            for light in [(target - point).extend(0.0), (point + (target - point) * 3.0).extend(1.0)] {
                assert!(tracer.occluded(point, light, &|_| false), "fan of {n}, case {k}");
            }
        }
        for light in [(corners_of(&mesh) - point).extend(0.0), (point + (corners_of(&mesh) - point) * 2.0).extend(1.0)]
        {
            assert!(tracer.occluded(point, light, &|_| false), "hub of the fan of {n}");
        }
    }
}

fn corners_of(fan: &Mesh) -> DVec3 {
    fan.corners(0)[0]
}

/// A terrain with spiky spheres over it, so that surfaces shadow each other and themselves.
fn busy_scene() -> (Mesh, Camera) {
    let mut mesh = grid(24);
    let mut random = Random(21);
    for p in &mut mesh.positions {
        *p = [p[0] * 3.0, (random.unit() * 0.3) as f32, p[2] * 3.0];
    }
    for at in [[0.0f32, 1.5, 0.0], [1.2, 0.9, 0.8], [-1.0, 0.7, 0.9]] {
        let ball = moved(&spiky_sphere(12, 0.7), 0.4, at);
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(ball.positions);
        mesh.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    let camera = Camera {
        eye: [2.0, 4.0, 5.0],
        target: [0.0, 0.5, 0.0],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 45.0,
        near: 0.01,
        far: 100.0,
        lens: Lens::CENTRED,
        near_plane: None,
    };
    (mesh, camera)
}

/// Samples where facet truth, given every surface that the samples see, differs from scene truth, outside and inside the
/// ambiguity bands.
fn facets_against_scene(mesh: &Mesh, camera: &Camera, light: &Light, corrupt: bool) -> (u32, u32, u32) {
    let tracer = Tracer::new(mesh).unwrap();
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).unwrap();
    let (w, h) = (100, 75);
    let scene = SceneTruth::new(&tracer, camera, light, &samples, w, h).unwrap();
    let mut image = scene.image(None);
    scene.mark_ambiguous(&mut image, None).expect("of the same size");
    let mut short = image.clone();
    short.pixels.pop();
    assert!(scene.mark_ambiguous(&mut short, None).is_err());
    let mut inputs = Vec::new();
    for pixel in 0..w * h {
        for (triangle, coverage) in scene.surfaces(pixel) {
            inputs.push(FacetInput { pixel, triangle, coverage });
        }
    }
    let truth = FacetTruth::new(&tracer, camera, light, &samples, w, h).unwrap();
    let judged = truth.judge(&inputs, None).unwrap();
    let bare = truth.without_validity().judge(&inputs, None).unwrap();
    assert!(judged.iter().zip(&bare).all(|(a, b)| a.occluded == b.occluded && b.valid != [0; 4]));
    // Lines of sharp tips reach far, so a wider list of candidates may doubt more, never less.
    let more = |a: &FacetResult, b: &FacetResult| join_mask(b.ambiguous_occluded) & !join_mask(a.ambiguous_occluded);
    assert!(judged.iter().zip(&bare).all(|(a, b)| more(a, b) == 0));
    let (mut outside, mut inside, mut all) = (0, 0, 0);
    for (input, result) in inputs.iter().zip(&judged) {
        let t = &image.pixels[input.pixel as usize];
        let coverage = join_mask(input.coverage);
        let mut occluded = join_mask(result.occluded);
        if corrupt && input.pixel == h / 2 * w + w / 2 {
            occluded ^= coverage;
        }
        let doubt = join_mask(t.ambiguous) | join_mask(result.ambiguous());
        let wrong = (coverage & !join_mask(t.lit)) ^ occluded;
        outside += (wrong & !doubt).count_ones();
        inside += (wrong & doubt).count_ones();
        all += coverage.count_ones();
    }
    (outside, inside, all)
}

#[test]
fn facet_truth_of_all_seen_surfaces_is_scene_truth() {
    let (mesh, camera) = busy_scene();
    for light in [LIGHTS[0], Light::Point { position: [0.5, 3.5, 1.5] }] {
        let (outside, inside, all) = facets_against_scene(&mesh, &camera, &light, false);
        assert_eq!(outside, 0, "{inside} inside of {all}");
        assert!(inside * 1000 < all, "{inside} inside of {all}");
        let (outside, _, _) = facets_against_scene(&mesh, &camera, &light, true);
        assert!(outside > 0, "a flipped pixel goes unnoticed");
    }
}

#[test]
fn the_truths_agree_far_away_at_other_scales_and_under_awkward_lights() {
    let (mesh, camera) = busy_scene();
    for (scale, offset) in [(1.0f32, 65536.0f32), (1048576.0, 0.0), (1.0 / 1048576.0, 0.0)] {
        let place = |p: [f32; 3]| p.map(|c| c * scale + offset);
        let camera = Camera {
            eye: place(camera.eye),
            target: place(camera.target),
            near: camera.near * scale,
            far: camera.far * scale,
            ..camera
        };
        let mesh = moved(&mesh, scale, [offset; 3]);
        // Inside a ball, behind the eye, on a corner of the floor, below the floor, and along the floor.
        let lights = [
            Light::Point { position: place([0.0, 1.5, 0.0]) },
            Light::Point { position: place([3.0, 6.0, 8.0]) },
            Light::Point { position: mesh.positions[40] },
            Light::Directional { direction: [0.1, -1.0, 0.2] },
            Light::Directional { direction: [1.0, 0.0, 0.0] },
        ];
        for light in lights {
            let (outside, inside, all) = facets_against_scene(&mesh, &camera, &light, false);
            assert_eq!(outside, 0, "{light:?} at {offset} times {scale}: {inside} inside of {all}");
            assert!(all > 100_000 && inside * 100 < all, "{light:?}: {inside} inside of {all}");
        }
    }
}

#[test]
fn packets_equal_single_rays() {
    let (mesh, camera) = busy_scene();
    let tracer = Tracer::new(&mesh).unwrap();
    let samples = Samples::new(Pattern::Rotated, 16).unwrap();
    let (w, h) = (100, 75);
    let rays = camera.rays(w, h);
    for light in LIGHTS {
        let truth = SceneTruth::new(&tracer, &camera, &light, &samples, w, h).unwrap();
        for pixel in 0..w * h {
            let t = truth.pixel(pixel);
            for (k, o) in samples.offsets().iter().enumerate() {
                let r = rays.direction(f64::from(pixel % w) + f64::from(o[0]), f64::from(pixel / w) + f64::from(o[1]));
                let hit = tracer.closest(rays.eye, r, f64::from(camera.near));
                let lit = hit.is_some_and(|hit| {
                    let p = rays.eye + r * hit.t;
                    let [a, b, c] = tracer.corners(hit.triangle);
                    let n = (b - a).cross(c - a);
                    let faces = n.dot(light.towards(p)) * n.dot(-r) > 0.0;
                    faces && !tracer.occluded(p, light.homogeneous(), &|t| t == hit.triangle)
                });
                let bit = |words: [u32; 4]| join_mask(words) >> k & 1 != 0;
                if (bit(t.seen), bit(t.lit)) != (hit.is_some(), lit) {
                    assert!(bit(t.ambiguous), "pixel {pixel} sample {k}");
                }
            }
        }
    }
}

#[test]
fn a_tessellated_floor_has_no_acne_anywhere() {
    // Tilted by odd angles, so that the corners lie on the plane only within f32; lit from above, nothing in between.
    for offset in [0.0f32, 1e3, 1e6] {
        let mut mesh = grid(64);
        let (u, v) = (Vec3::new(0.93, 0.31, 0.11), Vec3::new(-0.2, 0.17, 0.96));
        for p in &mut mesh.positions {
            *p = (u * p[0] * 8.0 + v * p[2] * 8.0 + Vec3::splat(offset)).into();
        }
        let camera = Camera {
            eye: [offset + 1.0, offset + 12.0, offset + 9.0],
            target: [offset; 3],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 40.0,
            near: 0.01,
            far: 100.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        let tracer = Tracer::new(&mesh).unwrap();
        let samples = Samples::new(Pattern::LowDiscrepancy, 8).unwrap();
        let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
        let image = SceneTruth::new(&tracer, &camera, &light, &samples, 80, 60).unwrap().image(None);
        assert!(image.pixels.iter().all(|p| p.lit == p.seen), "offset {offset}");
        assert!(image.pixels.iter().filter(|p| p.seen_count == 8).count() > 2000);
    }
}

#[test]
fn powers_of_two_leave_every_bit_as_it_is() {
    let (mesh, camera) = busy_scene();
    let view = |k: i32| {
        let s = 2.0f32.powi(k);
        let camera = Camera {
            eye: camera.eye.map(|c| c * s),
            target: camera.target.map(|c| c * s),
            near: camera.near * s,
            far: camera.far * s,
            ..camera
        };
        let tracer = Tracer::new(&moved(&mesh, s, [0.0; 3])).unwrap();
        let light = Light::Point { position: [0.5 * s, 3.5 * s, 1.5 * s] };
        let samples = Samples::new(Pattern::LowDiscrepancy, 8).unwrap();
        SceneTruth::new(&tracer, &camera, &light, &samples, 60, 45).unwrap().image(None)
    };
    let original = view(0);
    for k in [-40, -20, 20, 40] {
        assert_eq!(view(k), original, "scale 2^{k}");
    }
}
