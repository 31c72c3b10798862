//! Rays of the world, by solving for the point, against those of the mapped world.

use super::*;
use crate::pass::DepthTerms;
use glam::camera::{lh::proj::directx as lh, lh::view as left_view, rh::proj::directx as rh, rh::view as right_view};
use glam::{DMat3, Mat4};

const SIZE: [u32; 2] = [40, 30];
const BOUNDS: [[f32; 3]; 2] = [[-3.0; 3], [3.0; 3]];
const SUN: Light = Light::Directional { direction: [0.5, 0.8, 0.3] };
const BEHIND: Light = Light::Directional { direction: [1.0, 0.9, 2.2] };
const LAMP: Light = Light::Point { position: [0.5, 5.0, 1.0] };
const FAR_LAMP: Light = Light::Point { position: [-2.0, 9.0, -20.0] };

fn camera() -> Orthographic {
    Orthographic::look_at([4.0, 3.0, 9.0], [0.1, 0.0, -0.2], [0.1, 1.0, 0.0], 5.0)
}

/// Distance along a ray of a triangle, if it is met.
fn met(from: DVec3, way: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let solved = DMat3::from_cols(b - a, c - a, -way).inverse() * (from - a);
    (solved.x >= 0.0 && solved.y >= 0.0 && solved.x + solved.y <= 1.0).then_some(solved.z)
}

/// The nearest triangle from `begin` on, and whether another lies between it and the light.
fn seen(world: &[[DVec3; 3]], (from, way): (DVec3, DVec3), begin: f64, light: &Light) -> Option<(usize, bool)> {
    let hits = world.iter().enumerate().filter_map(|(k, t)| met(from, way, *t).map(|at| (k, at)));
    let (nearest, at) = hits.filter(|(_, at)| *at >= begin).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let place = from + way * at;
    let end = if light.is_directional() { f64::INFINITY } else { 1.0 };
    let between =
        |k: usize| k != nearest && met(place, light.towards(place), world[k]).is_some_and(|at| at > 0.0 && at < end);
    Some((nearest, (0..world.len()).any(between)))
}

/// Triangles of any size in the box, around a place.
fn world(around: DVec3) -> Vec<[DVec3; 3]> {
    let mut state = 9u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24) * 2.0 - 1.0
    };
    let mut point = |size: f64| DVec3::new(unit(), unit(), unit()) * size;
    let near = |_| {
        let middle = point(1.8);
        [0; 3].map(|_| (around + middle + point(1.1)).as_vec3().as_dvec3())
    };
    (0..40).map(near).collect()
}

/// How many samples of an image see or are lit otherwise in the mapped world, rounded to single precision, of so many that see something.
fn other(camera: &Orthographic, view: &OrthographicView, light: &Light) -> (usize, usize) {
    others(&world(DVec3::ZERO), camera, view, light)
}

fn others(world: &[[DVec3; 3]], camera: &Orthographic, view: &OrthographicView, light: &Light) -> (usize, usize) {
    let mapped: Vec<[DVec3; 3]> =
        world.iter().map(|t| t.map(|p| view.homography.point(p).expect("a place").as_vec3().as_dvec3())).collect();
    let mapped_light = view.homography.light(light).expect("a light");
    let rays = view.camera.rays(SIZE[0], SIZE[1]);
    let (mut off, mut hit) = (0, 0);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let [x, y] = [pixel % SIZE[0], pixel / SIZE[0]].map(|at| f64::from(at) + 0.37);
        let wanted = seen(world, camera.ray([x, y], SIZE), f64::from(camera.near), light);
        let way = rays.direction(x, y);
        let got = seen(&mapped, (rays.eye, way), rays.begin(way), &mapped_light);
        hit += usize::from(wanted.is_some());
        off += usize::from(wanted != got);
    }
    (off, hit)
}

/// Every sample of the mapped world sees what that of the world sees, and is lit alike: from everywhere, with jitter, mirrored, cut open.
#[test]
fn a_mapped_world_looks_the_same() {
    let lens = Lens { shift: [0.3, -0.2], pixel_aspect: 1.3, mirrored: true };
    let against = Light::Directional { direction: [-0.9, -0.3, -2.0] };
    for (name, camera) in [
        ("straight", camera()),
        ("shifted and mirrored", Orthographic { lens, ..camera() }),
        ("cut open", Orthographic { near: 9.7, ..camera() }),
        ("from inside", Orthographic { eye: [0.0; 3], target: [0.0, -1.0, -1.0], ..camera() }),
        ("from above", Orthographic::look_at([0.0, 50.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0], 6.0)),
        ("close", Orthographic { height: 0.5, ..camera() }),
    ] {
        for light in [SUN, BEHIND, LAMP, FAR_LAMP, against] {
            let view = camera.in_world(BOUNDS, &[light], SIZE).expect(name);
            let (off, hit) = other(&camera, &view, &light);
            assert!(hit > 200 && off <= 1, "{name}, {light:?}: {off} of {hit}");
        }
        // Of several lights one world.
        let lights = [SUN, BEHIND, LAMP, Light::Directional { direction: [-0.6, 0.9, -0.1] }];
        let view = camera.in_world(BOUNDS, &lights, SIZE).expect(name);
        for light in lights {
            let (off, hit) = other(&camera, &view, &light);
            assert!(off <= 1, "{name}, {light:?} of several: {off} of {hit}");
        }
        let moved = Orthographic { height: camera.height * 1.05, ..camera };
        assert!(other(&moved, &view, &SUN).0 > 5, "{name}: the comparison knows another camera");
        let middle = Vec3::from(camera.eye).distance(Vec3::from(camera.target));
        assert!(
            other(&Orthographic { near: middle + 0.5, ..camera }, &view, &SUN).0 > 5,
            "{name}: and another near plane"
        );
    }
}

/// Far from the origin, and at a ten-thousandth of the height: what single precision holds of places is as exact as the world's own.
#[test]
fn far_worlds_and_close_views_look_the_same() {
    let at = Vec3::new(1e4, -3e4, 2e4);
    let far = world(at.as_dvec3());
    let moved = |p: [f32; 3]| (Vec3::from(p) + at).to_array();
    let camera = camera();
    let camera = Orthographic { eye: moved(camera.eye), target: moved(camera.target), ..camera };
    let view = camera.in_world(BOUNDS.map(moved), &[SUN], SIZE).expect("a view");
    let (off, hit) = others(&far, &camera, &view, &SUN);
    assert!(hit > 200 && off == 0, "far: {off} of {hit}");
    let [from, way] = [camera.ray([20.0, 15.0], SIZE).0, camera.ray([20.0, 15.0], SIZE).1];
    let (nearest, _) = seen(&far, (from, way), 0.0, &SUN).expect("a triangle in the middle");
    let close = Orthographic { height: 5e-4 * camera.height, ..camera };
    let view = close.in_world(BOUNDS.map(moved), &[SUN], SIZE).expect("a view");
    let (off, hit) = others(&far, &close, &view, &SUN);
    assert!(hit > 1000 && off == 0, "close to triangle {nearest}: {off} of {hit}");
}

/// Where along the view the eye of an application's matrices is, is free: from afar the image is as exact.
#[test]
fn an_eye_far_away_costs_nothing() {
    let target = Vec3::new(0.1, 0.0, -0.2);
    let ahead = Vec3::new(-0.48, -0.6, -0.64);
    let of = |far: f32| {
        let view = right_view::look_to_mat4(target - far * ahead, ahead, Vec3::Y);
        let projection = rh::orthographic(-3.0, 2.5, -2.0, 2.1, 0.9 * far, 1.1 * far);
        let [view, projection] = [view, projection].map(|m| m.to_cols_array_2d());
        (view, Orthographic::of_matrices(&view, &projection, false, SIZE).expect("a camera"))
    };
    for far in [10.0, 1e3, 1e5] {
        let (view, camera) = of(far);
        assert!(Vec3::from(camera.eye).length() < 0.3, "{far}: {:?}", camera.eye);
        // The place as the matrix itself holds it.
        let view = Mat4::from_cols_array_2d(&view).as_dmat4();
        let (from, way) = camera.ray([20.0, 15.0], SIZE);
        let at = view.transform_point3(from);
        assert!((at.x + 0.25).abs() < 1e-6 && (at.y - 0.05).abs() < 1e-6, "{far}: {at}");
        let near = view.transform_point3(from + way * f64::from(camera.near)).z;
        assert!((near / f64::from(-far) - 0.9).abs() < 1e-6, "{far}: {near}");
    }
}

/// A light behind the camera's back, exactly on the view, comes to the eye: all that is seen is lit.
#[test]
fn a_light_along_the_view_is_at_the_eye() {
    let camera = Orthographic::look_at([0.0, 0.0, 8.0], [0.0; 3], [0.0, 1.0, 0.0], 5.0);
    let light = Light::Directional { direction: [0.0, 0.0, 1.0] };
    let view = camera.in_world(BOUNDS, &[light], SIZE).expect("a view");
    assert_eq!(view.homography.light(&light).expect("a light"), Light::Point { position: [0.0; 3] });
}

/// The matrices of an application put points where the camera sees them, left-handed and right-handed, off-centre, with either order of depth.
#[test]
fn matrices_are_cameras() {
    let (eye, target, up) = (Vec3::new(4.0, 3.0, 9.0), Vec3::new(0.1, 0.0, -0.2), Vec3::new(0.1, 1.0, 0.0));
    let (right, left) = (right_view::look_at_mat4(eye, target, up), left_view::look_at_mat4(eye, target, up));
    let turned = Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
    let backwards =
        Mat4::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
    let of_right = rh::orthographic(-3.0, 2.5, -2.0, 2.1, -1.0, 20.0);
    for (name, view, projection, reversed) in [
        ("right-handed", right, of_right, false),
        ("left-handed", left, lh::orthographic(-3.0, 2.5, -2.0, 2.1, 2.0, 20.0), false),
        ("reversed", right, backwards * of_right, true),
        ("turned over", right, turned * of_right, false),
        ("scaled", right * Mat4::from_scale(Vec3::splat(2.0)), of_right, false),
    ] {
        let [view, projection] = [view, projection].map(|m| m.to_cols_array_2d());
        let camera = Orthographic::of_matrices(&view, &projection, reversed, SIZE).expect(name);
        let [view, projection] = [view, projection].map(|m| Mat4::from_cols_array_2d(&m).as_dmat4());
        let clip = |p: DVec3| projection * (view * p.extend(1.0));
        for [x, y] in [[3.0, 2.0], [20.0, 15.0], [39.0, 7.0]] {
            let (from, way) = camera.ray([x, y], SIZE);
            for at in [1.0, 5.0, 12.0] {
                let at = clip(from + way * at);
                let off = DVec2::new(at.x - (2.0 * x / 40.0 - 1.0), at.y - (1.0 - 2.0 * y / 30.0));
                assert!(off.length() < 1e-5, "{name}: {off}");
            }
            let near = clip(from + way * f64::from(camera.near)).z;
            assert!((near - f64::from(u8::from(reversed))).abs() < 1e-5, "{name}: depth {near} at the near plane");
        }
        // Depth, as the mapped world has it.
        let of = camera.in_world(BOUNDS, &[SUN], SIZE).expect(name);
        let terms = DepthTerms::orthographic(&of, reversed);
        for p in [DVec3::new(0.3, 0.2, -1.0), DVec3::new(-1.0, 1.5, 2.0)] {
            let (at, to) = (clip(p), of.homography.point(p).expect("a place"));
            let scale = f64::from(terms.scale) + at.x * f64::from(terms.tilt[0]) + at.y * f64::from(terms.tilt[1]);
            let depth = scale + f64::from(terms.offset) / -to.z;
            assert!((depth - at.z).abs() < 1e-5, "{name}: depth {} comes as {depth}", at.z);
        }
        let refused =
            Camera::of_matrices(&view.as_mat4().to_cols_array_2d(), &projection.as_mat4().to_cols_array_2d(), SIZE);
        assert!(refused.is_err_and(|e| e.to_string().contains("Orthographic")), "{name}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let camera = camera();
    let told = |camera: Orthographic, bounds, lights: &[Light], word: &str| {
        let told = camera.in_world(bounds, lights, SIZE).map_err(|e| e.to_string());
        assert!(told.as_ref().is_err_and(|e| e.contains(word) && !e.contains('\n')), "{word}: {told:?}");
    };
    told(Orthographic { height: 0.0, ..camera }, BOUNDS, &[], "height of 0");
    told(Orthographic { near: f32::NAN, ..camera }, BOUNDS, &[], "NaN");
    told(Orthographic { far: -1.0, ..camera }, BOUNDS, &[], "far -1");
    told(camera, [[-3e38; 3], [3e38; 3]], &[], "in a world of size");
    assert!(camera.in_world(BOUNDS, &[], [40, 0]).is_err_and(|e| e.to_string().contains("40 x 0")));
    told(Orthographic { up: [0.0; 3], ..camera }, BOUNDS, &[], "up (0, 0, 0)");
    told(camera, [[1.0; 3], [0.0; 3]], &[], "no box");
    told(camera, BOUNDS, &[Light::Directional { direction: [0.0; 3] }], "length 0");
    let ahead = [-4.0, -3.0, -9.2];
    told(camera, BOUNDS, &[Light::Directional { direction: ahead }], "no map of the world");
    let opposite = [[1.0, 0.01, -1.0], [-1.0, 0.01, -1.0]].map(|direction| Light::Directional { direction });
    let along = Orthographic::look_at([0.0, 0.0, 8.0], [0.0; 3], [0.0, 1.0, 0.0], 5.0);
    told(along, BOUNDS, &opposite, "no map of the world");
    told(along, BOUNDS, &[Light::Directional { direction: [0.0, 0.0, -1.0] }; 9], "5 more");
    let around = [[5.0, 0.0, -4.0], [-5.0, 0.0, -4.0], [0.0, 5.0, -4.0], [0.0, -5.0, -4.0]];
    told(camera, BOUNDS, &around.map(|direction| Light::Directional { direction }), "no map of the world");
    told(camera, BOUNDS, &[Light::Point { position: ahead.map(|c| c * 1e3) }], "times as far ahead");
    let of =
        |m: Mat4| Orthographic::of_matrices(&Mat4::IDENTITY.to_cols_array_2d(), &m.to_cols_array_2d(), false, SIZE);
    let sound = rh::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0);
    assert!(of(sound).is_ok());
    for (m, word) in [
        (rh::perspective(0.9, 1.5, 0.1, 10.0), "divisor"),
        (sound * Mat4::from_rotation_z(0.1), "turned"),
        (sound * Mat4::from_rotation_x(0.1), "oblique"),
        (sound * f32::NAN, "not finite"),
        (Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0)) * sound, "flat"),
    ] {
        assert!(of(m).is_err_and(|e| e.to_string().contains(word)), "{word}");
    }
}
