//! Truth against brute force, against closed forms, and against itself.

use subpixel_shadows::glam::{DVec3, DVec4, Vec3};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::truth::{
    AMBIGUITY, FacetInput, FacetResult, FacetTruth, SceneTruth, Tracer, join_mask, split_mask,
};

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

/// A ground square and a smaller square above it, parallel to it; camera above, looking down at an angle.
fn square_over_plane() -> (Mesh, Camera) {
    let mut mesh = Mesh::default();
    for (half, y) in [(4.0f32, 0.0f32), (0.75, 1.0)] {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend([[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]]);
        mesh.triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
    }
    let camera = Camera {
        eye: [1.5, 5.0, 4.0],
        target: [0.2, 0.0, 0.1],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 50.0,
        near: 0.01,
        far: 100.0,
    };
    (mesh, camera)
}

const LIGHTS: [Light; 2] =
    [Light::Directional { direction: [0.5, 1.0, 0.25] }, Light::Point { position: [0.7, 3.0, -0.4] }];

/// Answer at an image position, from the formulas of the scene: `(sees a surface, lit)`.
fn square_formula(camera: &Camera, light: &Light, w: u32, h: u32, x: f64, y: f64) -> (bool, bool) {
    let rays = camera.rays(w, h);
    let r = rays.direction(x, y);
    let at = |height: f64| rays.eye + r * ((height - rays.eye.y) / r.y);
    let within = |p: DVec3, half: f64| p.x.abs() <= half && p.z.abs() <= half;
    if r.y >= 0.0 {
        return (false, false);
    }
    if within(at(1.0), 0.75) {
        return (true, true);
    }
    let p = at(0.0);
    if !within(p, 4.0) {
        return (false, false);
    }
    let to_light = light.towards(p);
    (true, !within(p + to_light / to_light.y, 0.75))
}

/// Samples outside the ambiguity band that differ from the formula for `formula_light`, and the share outside.
fn against_formula(light: &Light, formula_light: &Light, count: u32) -> (u64, f64) {
    let (mesh, camera) = square_over_plane();
    let tracer = Tracer::new(&mesh).unwrap();
    let (w, h) = (120, 90);
    let samples = Samples::new(Pattern::LowDiscrepancy, count).unwrap();
    let truth = SceneTruth::new(&tracer, &camera, light, &samples, w, h).unwrap();
    let mut image = truth.image(None);
    let shares = truth.mark_ambiguous(&mut image, None).expect("of the same size");
    assert!(image.pixels.iter().any(|p| p.visibility == 0.0));
    assert!(image.pixels.iter().any(|p| p.seen_count == 0 && p.visibility == 1.0 && !p.centre_hit));
    let (mut wrong, mut outside) = (0, 0u64);
    for (pixel, t) in image.pixels.iter().enumerate() {
        let (i, j) = (pixel as u32 % w, pixel as u32 / w);
        for (k, o) in samples.offsets().iter().enumerate() {
            let (x, y) = (f64::from(i) + f64::from(o[0]), f64::from(j) + f64::from(o[1]));
            let bit = |words: [u32; 4]| join_mask(words) >> k & 1 != 0;
            if !bit(t.ambiguous) {
                outside += 1;
                let formula = square_formula(&camera, formula_light, w, h, x, y);
                wrong += u64::from((bit(t.seen), bit(t.lit)) != formula);
            }
        }
    }
    (wrong, outside as f64 / shares.all as f64)
}

#[test]
fn a_square_over_a_plane_matches_its_formula() {
    for light in LIGHTS {
        for count in [1, 32, 128] {
            let (wrong, outside) = against_formula(&light, &light, count);
            assert_eq!(wrong, 0, "{light:?} with {count} samples");
            assert!(outside > 0.99, "{outside} outside the band");
        }
    }
    let tilted = Light::Directional { direction: [0.5, 1.0, 0.26] };
    assert!(against_formula(&LIGHTS[0], &tilted, 32).0 > 0, "a light turned by half a degree goes unnoticed");
}

#[test]
fn converged_truth_approaches_the_samples() {
    let (mesh, camera) = square_over_plane();
    let tracer = Tracer::new(&mesh).unwrap();
    let samples = Samples::new(Pattern::LowDiscrepancy, 128).unwrap();
    let truth = SceneTruth::new(&tracer, &camera, &LIGHTS[0], &samples, 40, 30).unwrap();
    let rows = std::sync::atomic::AtomicUsize::new(0);
    let count = |_: usize, all: usize| {
        assert_eq!(all, 30);
        rows.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    let converged = truth.converged(Some(&count));
    assert_eq!(rows.into_inner(), 30);
    for (a, b) in truth.image(None).pixels.iter().zip(&converged) {
        assert!((a.visibility - b.0).abs() < 0.1, "{} {}", a.visibility, b.0);
    }
    assert!(converged.iter().any(|c| c.0 > 0.0 && c.0 < 1.0));
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

/// One facet of the pixel at the image centre, on the ground of a little scene.
fn judge_centre(mesh: &Mesh, camera: &Camera, light: &Light) -> (Vec<[f32; 2]>, FacetResult) {
    let tracer = Tracer::new(mesh).unwrap();
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).unwrap();
    let facet = FacetInput { pixel: 4 + 4 * 9, triangle: 0, coverage: [u32::MAX, 0, 0, 0] };
    let truth = FacetTruth::new(&tracer, camera, light, &samples, 9, 9).unwrap();
    (samples.offsets().to_vec(), truth.judge(&[facet], None).unwrap()[0])
}

/// A camera straight above, so that a pixel is 1/9 wide and the picture's down is +z; the centre pixel is around the
/// origin.
fn overhead() -> Camera {
    Camera {
        eye: [0.0, 1.0, 0.0],
        target: [0.0, 0.0, 0.0],
        up: [0.0, 0.0, -1.0],
        vertical_fov_degrees: 2.0 * 0.5f32.atan().to_degrees(),
        near: 0.01,
        far: 10.0,
    }
}

/// A ground triangle and a wall along z at `x` (in pixels from the centre of the middle pixel), from height `low` up.
fn ground_and_wall(x: f32, low: f32) -> Mesh {
    let x = x / 9.0;
    Mesh {
        positions: vec![
            [-9.0, 0.0, 9.0],
            [9.0, 0.0, 9.0],
            [0.0, 0.0, -9.0],
            [x, low, -1.0],
            [x, low, 1.0],
            [x, 0.5, 0.0],
        ],
        triangles: vec![[0, 1, 2], [3, 4, 5]],
    }
}

#[test]
fn a_wall_through_the_pixel_makes_its_far_side_invalid() {
    let light = Light::Directional { direction: [1.0, 1.0, 0.0] };
    let expect = |x: f32, keep: &dyn Fn(f32) -> bool| {
        let (offsets, result) = judge_centre(&ground_and_wall(x, -0.1), &overhead(), &light);
        for (k, o) in offsets.iter().enumerate() {
            let bit = |words: [u32; 4]| join_mask(words) >> k & 1 != 0;
            let from_line = f64::from(o[0] - 0.5 - x).abs();
            if from_line > 2.0 * AMBIGUITY && x.abs() > 0.01 && (x.abs() - 0.5).abs() > 0.01 {
                assert!(!bit(result.ambiguous()), "wall at {x}: sample {k}");
            }
            assert_eq!(bit(result.valid), keep(o[0] - 0.5), "wall at {x}: sample {k}");
            if !bit(result.ambiguous()) {
                // Light comes from +x: what lies to the left of the wall is in its shadow.
                assert_eq!(bit(result.occluded), o[0] - 0.5 < x, "wall at {x}: sample {k}");
            }
        }
        result
    };
    expect(0.2, &|x| x < 0.2);
    expect(-0.3, &|x| x > -0.3);
    expect(0.7, &|_| true);
    // A line through the centre marks nothing, and everything is in doubt.
    let tie = expect(0.0, &|_| true);
    assert_eq!(join_mask(tie.ambiguous_valid), 0xffff_ffff);
    // A line just outside or inside the pixel: what lies beyond it is in doubt.
    let (offsets, result) = judge_centre(&ground_and_wall(0.499, -0.1), &overhead(), &light);
    let beyond = |o: &[f32; 2]| o[0] - 0.5 > 0.499;
    let doubt = join_mask(result.ambiguous());
    assert!(offsets.iter().enumerate().all(|(k, o)| !beyond(o) || doubt >> k & 1 != 0));
}

#[test]
fn only_what_rises_through_the_facet_cuts_it() {
    let light = Light::Directional { direction: [1.0, 1.0, 0.0] };
    // Standing on the plane: touches, cuts. Hanging above: casts, does not cut. Below: neither.
    let (_, standing) = judge_centre(&ground_and_wall(0.2, 0.0), &overhead(), &light);
    assert!(join_mask(standing.valid) != 0xffff_ffff);
    let (_, hanging) = judge_centre(&ground_and_wall(0.2, 0.01), &overhead(), &light);
    assert_eq!(join_mask(hanging.valid), 0xffff_ffff);
    assert!(join_mask(hanging.occluded) != 0);
    let mut below = ground_and_wall(0.2, -0.5);
    below.positions[5][1] = 0.0;
    let (_, below) = judge_centre(&below, &overhead(), &light);
    assert_eq!((join_mask(below.valid), join_mask(below.occluded)), (0xffff_ffff, 0));
}

#[test]
fn dark_facets_and_horizons() {
    // Light from below: the seen side is dark.
    let (_, dark) =
        judge_centre(&ground_and_wall(5.0, 0.1), &overhead(), &Light::Directional { direction: [0.1, -1.0, 0.0] });
    assert_eq!((dark.occluded, dark.valid), (split_mask(0xffff_ffff), split_mask(0xffff_ffff)));
    // Looking along the ground: the horizon is the middle of the image, and above it rays miss the plane.
    let level = Camera { eye: [0.0, 1.0, 8.0], target: [0.0, 1.0, 0.0], up: [0.0, 1.0, 0.0], ..overhead() };
    let (offsets, horizon) = judge_centre(&ground_and_wall(5.0, 0.1), &level, &LIGHTS[0]);
    for (k, o) in offsets.iter().enumerate() {
        assert_eq!(join_mask(horizon.valid) >> k & 1 != 0, o[1] > 0.5, "sample {k}");
    }
}

#[test]
fn refuses_facets_that_do_not_exist() {
    let tracer = Tracer::new(&grid(1)).unwrap();
    let samples = Samples::new(Pattern::Grid, 8).unwrap();
    let truth = FacetTruth::new(&tracer, &overhead(), &LIGHTS[0], &samples, 9, 9).unwrap();
    assert!(truth.judge(&[FacetInput { pixel: 81, triangle: 0, coverage: [1, 0, 0, 0] }], None).is_err());
    assert!(truth.judge(&[FacetInput { pixel: 0, triangle: 2, coverage: [1, 0, 0, 0] }], None).is_err());
    assert!(truth.judge(&[], None).unwrap().is_empty());
    assert!(SceneTruth::new(&tracer, &overhead(), &LIGHTS[0], &samples, 0, 9).is_err());
}
