//! A square over a plane, whose shadow is known by a formula.

use super::*;

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
        lens: subpixel_shadows::scene::Lens::CENTRED,
        near_plane: None,
    };
    (mesh, camera)
}

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
