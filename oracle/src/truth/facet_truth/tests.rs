//! Tests of segments and of what hardly rises.

use super::*;

#[test]
fn crossings_are_segments_points_and_edges() {
    let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
    assert_eq!(crossing(t, [0.0, 0.0, 1.0]), [DVec3::ZERO, DVec3::X]);
    assert_eq!(crossing(t, [0.0, 1.0, 1.0]), [DVec3::ZERO; 2]);
    assert_eq!(crossing(t, [-1.0, 1.0, 1.0]), [DVec3::X * 0.5, DVec3::Y * 0.5]);
    assert_eq!(crossing(t, [0.0, -1.0, 1.0]), [DVec3::ZERO, DVec3::new(0.5, 0.5, 0.0)]);
}

/// A neighbour that lies in the facet's plane but for 3e-12 of the distance (two triangles of `bicycle`) leaves open what is valid
/// beyond their edge; one that clearly rises cuts, one that falls away does nothing.
#[test]
fn what_hardly_rises_is_ambiguous() {
    let judged = |moved: f32| {
        let positions = vec![
            [-0.8957466, 0.3435681, -0.05061803],
            [-0.8942471, 0.34360868, -0.050621286],
            [-0.89511025, 0.32021797, -0.048746023],
            [-0.89361084, 0.32025856, -0.04874928 + moved],
        ];
        let tracer =
            Tracer::new(&subpixel_shadows::scene::Mesh { positions, triangles: vec![[0, 1, 2], [2, 1, 3]] }).unwrap();
        let camera = Camera {
            eye: [1.0647434, 1.5, -1.6144502],
            target: [0.07, 0.27, 0.24],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 39.0,
            near: 1e-3,
            far: 1e3,
            lens: subpixel_shadows::scene::Lens::CENTRED,
            near_plane: None,
        };
        let light = Light::Directional { direction: [-0.22, 0.78, -0.55] };
        let samples = Samples::new(subpixel_shadows::samples::Pattern::LowDiscrepancy, 32).unwrap();
        let truth = FacetTruth::new(&tracer, &camera, &light, &samples, 400, 300).unwrap();
        let facet = FacetInput { pixel: 362 + 400 * 123, triangle: 0, coverage: split_mask(full_mask(32)) };
        truth.judge(&[facet], None).unwrap()[0]
    };
    let [hardly, rises, falls] = [0.0, -1e-5, 1e-5].map(judged);
    let lost = !rises.valid[0];
    assert!(lost != 0 && lost & !rises.ambiguous_valid[0] != 0);
    assert_eq!((hardly.valid[0], hardly.ambiguous_valid[0] & lost), (u32::MAX, lost));
    assert_eq!((falls.valid[0], falls.ambiguous_valid[0]), (u32::MAX, 0));
}

/// Two casters side by side that leave a gap of a thousandth of a pixel: a sample in the shadow of one may be lit. Where they meet
/// it may not.
#[test]
fn a_gap_far_thinner_than_the_band_is_ambiguous() {
    let camera = Camera {
        eye: [0.0, 10.0, 0.0],
        target: [0.0; 3],
        up: [0.0, 0.0, -1.0],
        vertical_fov_degrees: 40.0,
        near: 1e-3,
        far: 1e3,
        lens: subpixel_shadows::scene::Lens::CENTRED,
        near_plane: None,
    };
    let samples = Samples::new(subpixel_shadows::samples::Pattern::LowDiscrepancy, 8).unwrap();
    let rays = camera.rays(64, 64);
    let [x, y] = samples.offsets()[3].map(f64::from);
    let hit = |x: f64| -10.0 / rays.direction(x, 32.0 + y).y * rays.direction(x, 32.0 + y).x;
    let judged = |gap: f64| {
        let [left, right] = [x - 5e-4 - gap, x - 5e-4].map(|x| hit(32.0 + x) as f32);
        let positions = vec![
            [-9.0, 0.0, 9.0],
            [9.0, 0.0, 9.0],
            [0.0, 0.0, -9.0],
            [left, 1.0, 2.0],
            [left, 1.0, -2.0],
            [-2.0, 1.0, 0.0],
            [right, 1.0, 2.0],
            [right, 1.0, -2.0],
            [2.0, 1.0, 0.0],
        ];
        let triangles = vec![[0, 1, 2], [4, 3, 5], [6, 7, 8]];
        let tracer = Tracer::new(&subpixel_shadows::scene::Mesh { positions, triangles }).unwrap();
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let truth = FacetTruth::new(&tracer, &camera, &light, &samples, 64, 64).unwrap();
        let facet = FacetInput { pixel: 32 + 64 * 32, triangle: 0, coverage: [8, 0, 0, 0] };
        let result = truth.judge(&[facet], None).unwrap()[0];
        (result.occluded[0], result.ambiguous_occluded[0])
    };
    assert_eq!([0.0, 1e-3].map(judged), [(8, 0), (8, 8)]);
}
