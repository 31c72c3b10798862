//! Facet truth of single facets.

use super::*;

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
        lens: subpixel_shadows::scene::Lens::CENTRED,
        near_plane: None,
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
