//! Slices and warps against their definitions.

use super::*;
use crate::light_view::unit_scale;
use crate::scene::{Camera, Light, Mesh};
use crate::test_scenes::{Scene, builtin};

const WARPS: [Warp; 7] =
    [Warp::Whole, Warp::Box, Warp::Stable, Warp::Trapezoid, Warp::LightSpace, Warp::Perspective, Warp::Fitted];

/// A view and what a camera sees, in the camera's space.
fn setup(light: &Light, camera: &Camera, mesh: &Mesh, size: u32) -> (LightView, SeenBox) {
    let view = LightView::fit(mesh, light, size).unwrap();
    let rays = camera.rays(64, 48);
    let bounds = mesh.bounds().unwrap();
    let scale = unit_scale(rays.eye, bounds);
    let seen = SeenBox::new(&rays, [64, 48], f64::from(camera.near), bounds, scale);
    (view.relative_to(rays.eye, scale), seen)
}

fn lights() -> [Light; 3] {
    [
        Light::Directional { direction: [0.3, 1.0, 0.2] },
        Light::Directional { direction: [-0.8, 0.3, 0.6] },
        Light::Point { position: [1.0, 9.0, 2.0] },
    ]
}

fn cameras(scene: &Scene) -> [Camera; 4] {
    let c = scene.camera;
    let inside = Camera { eye: [0.1, 0.4, 0.2], target: [1.0, 0.2, -1.0], near: 1e-3, ..c };
    // Along the first light, and nearly so.
    let along = Camera { eye: [0.9, 3.0, 0.6], target: [0.0; 3], up: [0.0, 0.0, 1.0], ..c };
    [c, inside, along, Camera { eye: [1.1, 3.0, 0.5], ..along }]
}

/// Points of the box that are seen and in the view, and their depths.
fn seen_points(view: &LightView, seen: &SeenBox) -> Vec<DVec3> {
    let (lo, hi) = seen.bounds;
    let side = f64::from(view.map_size);
    let mut out = Vec::new();
    for k in 0..24 * 24 * 24 {
        let share = DVec3::new(f64::from(k % 24), f64::from(k / 24 % 24), f64::from(k / 576)) / 23.0;
        let p = lo + (hi - lo) * share;
        let on_map =
            view.project(p).is_some_and(|t| t.truncate().cmpge(DVec2::ZERO).all() && t.x <= side && t.y <= side);
        let side_of = |k: usize| {
            let n = seen.corners[k].cross(seen.corners[(k + 1) % 4]);
            n.dot(p) * n.dot(seen.forward)
        };
        if on_map && p.dot(seen.forward) >= seen.near && (0..4).all(|k| side_of(k) >= 0.0) {
            out.push(p);
        }
    }
    out
}

fn place(split: &SplitView, p: DVec3) -> DVec3 {
    let [x, y, w] = split.rows.map(|r| r.dot(p.extend(1.0)));
    DVec3::new(x / w, y / w, w)
}

#[test]
fn all_that_is_seen_lies_in_the_map_of_its_slice() {
    let scene = builtin("windmill");
    let mut count = 0;
    for light in lights() {
        for camera in cameras(&scene) {
            let (view, seen) = setup(&light, &camera, &scene.mesh, 64);
            let points = seen_points(&view, &seen);
            for (warp, splits) in WARPS.into_iter().flat_map(|w| [(w, 1), (w, 3), (w, 4)]) {
                let views =
                    view.split(&seen, &SplitPlan { splits, warp, focus: 0.3, ..SplitPlan::default() }, 0.0, None);
                assert_eq!(views.len(), splits as usize);
                for &p in &points {
                    let depth = p.dot(seen.forward);
                    let split = views.iter().find(|s| depth < s.end).expect("a slice");
                    let at = place(split, p);
                    let border = if warp == Warp::Whole { 0.0 } else { 1.4 };
                    let held = |v: f64| (border..=64.0 - border).contains(&v);
                    assert!(held(at.x) && held(at.y) && at.z > 0.0, "{warp:?} of {splits}: {p} at {at}");
                    // The warp says the same as the rows.
                    let by = split.warp * view.project(p).unwrap().truncate().extend(1.0);
                    assert!((by.truncate() / by.z - at.truncate()).length() < 1e-6);
                    assert!(by.z > 0.9, "{warp:?}: a divisor of {}", by.z);
                    count += 1;
                }
            }
        }
    }
    assert!(count > 10_000, "{count} points");
}

#[test]
fn slices_end_by_the_practical_scheme() {
    let found = ends(1.0, 100.0, 3, 0.5);
    let want = |i: f64| 0.5 * (100f64.powf(i / 3.0) + 1.0 + 33.0 * i);
    assert!((found[0] - want(1.0)).abs() < 1e-9 && (found[1] - want(2.0)).abs() < 1e-9 && found[2] == 100.0);
    assert_eq!(ends(2.0, 7.0, 1, 0.5), [7.0]);
    assert_eq!(ends(1.0, 7.0, 3, 0.0), [3.0, 5.0, 7.0]);
    let grown = ends(1.0, 1000.0, 3, 1.0);
    assert!((grown[0] - 10.0).abs() < 1e-9 && (grown[1] - 100.0).abs() < 1e-9);
}

/// The steps of Oliveira's section 3.2.2, in two dimensions: T1, R, T2, H, S1, N, T3, S2. `t0` and `t1` are the base, `t2` and
/// `t3` the top, `q` where the sides meet.
fn by_steps([t0, t1, t2, t3]: [DVec2; 4], q: DVec2) -> DMat3 {
    let apply = |m: DMat3, p: DVec2| m * p.extend(1.0);
    let shift = |v: DVec2| rows(DVec3::new(1.0, 0.0, -v.x), DVec3::new(0.0, 1.0, -v.y), DVec3::Z);
    let _ = t1;
    let mut m = shift((t2 + t3) * 0.5);
    let u = (t2 - t3).normalize();
    m = rows(DVec3::new(u.x, u.y, 0.0), DVec3::new(u.y, -u.x, 0.0), DVec3::Z) * m;
    m = shift(apply(m, q).truncate()) * m;
    let u = (apply(m, t2) + apply(m, t3)) * 0.5;
    m = rows(DVec3::new(1.0, -u.x / u.y, 0.0), DVec3::Y, DVec3::Z) * m;
    let u = apply(m, t2);
    m = rows(DVec3::X / u.x, DVec3::Y / u.y, DVec3::Z) * m;
    m = rows(DVec3::X, DVec3::new(0.0, 1.0, 1.0), DVec3::Y) * m;
    let (u, v) = (apply(m, t0), apply(m, t2));
    let middle = -0.5 * (u.y / u.z + v.y / v.z);
    m = rows(DVec3::X, DVec3::new(0.0, 1.0, middle), DVec3::Z) * m;
    let u = apply(m, t0);
    rows(DVec3::X, DVec3::new(0.0, -u.z / u.y, 0.0), DVec3::Z) * m
}

#[test]
fn the_trapezoid_is_that_of_the_paper() {
    let texels: Vec<DVec2> =
        [[10.0, 12.0], [14.0, 9.0], [40.0, 30.0], [22.0, 45.0], [20.0, 20.0]].map(DVec2::from_array).to_vec();
    let along = Along::new(&texels, DVec2::new(12.0, 11.0), DVec2::new(31.0, 37.0)).unwrap();
    let focus = DVec2::new(18.0, 19.0);
    let distance = along.by_focus(focus);
    let m = along.trapezoid(&texels, distance);
    let at = |p: DVec2| (m * p.extend(1.0)).truncate() / (m * p.extend(1.0)).z;
    // The focus lies on the 80 % line, and everything within the square, which it touches on all sides.
    assert!((at(focus).y - 0.8).abs() < 1e-9);
    let places: Vec<DVec2> = texels.iter().map(|&p| at(p)).collect();
    let (lo, hi) = places.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    assert!(lo.length() < 1e-9 && (hi - DVec2::ONE).length() < 1e-9, "{lo} to {hi}");
    // The paper's steps take its corners, and so everything, to the same places of the square from -1 to 1, mirrored.
    let back = m.inverse();
    let corner = |x: f64, y: f64| (back * DVec3::new(x, y, 1.0)).truncate() / (back * DVec3::new(x, y, 1.0)).z;
    let corners = [corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0)];
    let q = along.dir * (along.low - distance) + along.dir.perp() * along.across;
    let theirs = by_steps(corners, q);
    for &p in texels.iter().chain(&corners) {
        let t = (theirs * p.extend(1.0)).truncate() / (theirs * p.extend(1.0)).z;
        let ours = at(p) * 2.0 - 1.0;
        assert!((t.x.abs() - ours.x.abs()).abs() < 1e-9 && (t.y.abs() - ours.y.abs()).abs() < 1e-9, "{t} and {ours}");
    }
}

#[test]
fn camera_and_light_along_one_line_fall_back_to_a_box() {
    let scene = builtin("windmill");
    let [.., along, beside] = cameras(&scene);
    let [light, ..] = lights();
    for (camera, warps) in [(along, false), (beside, false), (scene.camera, true)] {
        let (view, seen) = setup(&light, &camera, &scene.mesh, 64);
        for split in view.split(
            &seen,
            &SplitPlan { splits: 2, warp: Warp::Trapezoid, focus: 0.3, ..SplitPlan::default() },
            0.0,
            None,
        ) {
            assert_eq!(split.warp.row(2) != DVec3::Z, warps, "{:?}", split.warp);
        }
    }
}

/// Every point that is seen and in the whole view is on the map of some slice and in front of its light; along a ray of light the texel stays
/// and depth grows.
#[test]
fn slices_hold_what_is_seen() {
    let scene = builtin("windmill");
    let bounds = scene.mesh.bounds().unwrap();
    let mut points = 0;
    for light in lights() {
        for camera in cameras(&scene) {
            let (moved, seen) = setup(&light, &camera, &scene.mesh, 64);
            let view = LightView::fit(&scene.mesh, &light, 64).unwrap();
            let rays = camera.rays(64, 48);
            let scale = unit_scale(rays.eye, bounds);
            for (warp, splits) in WARPS.into_iter().flat_map(|warp| [(warp, 1), (warp, 3)]) {
                let plan = SplitPlan { splits, warp, focus: 0.3, ..SplitPlan::default() };
                let slices = view.slices(&camera, [64, 48], bounds, &plan, 0.0, None);
                assert_eq!(slices.len(), splits as usize);
                assert!(slices.iter().all(|slice| slice.one_of_several && slice.perspective));
                for p in seen_points(&moved, &seen) {
                    let p = rays.eye + p / scale;
                    let on = |slice: &&LightView| {
                        slice.project(p).is_some_and(|t| {
                            t.truncate().min_element() > -1e-6 && t.truncate().max_element() < 64.0 + 1e-6
                        })
                    };
                    let Some(slice) = slices.iter().find(on) else { panic!("{p} is on no map of {plan:?}") };
                    let towards = light.towards(p).normalize() * 1e-3;
                    let [here, nearer] = [p, p + towards].map(|p| slice.project(p).unwrap());
                    assert!(nearer.z < here.z && (nearer - here).truncate().length() < 1e-6, "{here} {nearer}");
                    points += 1;
                }
            }
        }
    }
    assert!(points > 10_000, "{points}");
}

/// Slices of seen depths are cut between these: with an overlap they hold what lies there on smaller maps than slices of the whole box do,
/// without one all that is seen.
#[test]
fn seen_depths_cut_slices() {
    let scene = builtin("windmill");
    let (bounds, [_, light, ..]) = (scene.mesh.bounds().unwrap(), lights());
    let (moved, seen) = setup(&light, &scene.camera, &scene.mesh, 64);
    let view = LightView::fit(&scene.mesh, &light, 64).unwrap();
    let (rays, forward) = (scene.camera.rays(64, 48), seen.forward);
    let scale = unit_scale(rays.eye, bounds);
    let points = seen_points(&moved, &seen);
    let depth_of = |p: &DVec3| p.dot(forward) / scale;
    let (near, far) = points.iter().map(depth_of).fold((f64::MAX, 0.0f64), |(n, f), d| (n.min(d), f.max(d)));
    let told = [near + 0.4 * (far - near), near + 0.6 * (far - near)];
    let held = |slices: &[LightView], p: DVec3| {
        let on = |t: DVec3| t.truncate().min_element() > -1e-6 && t.truncate().max_element() < 64.0 + 1e-6;
        slices.iter().any(|slice| slice.project(rays.eye + p / scale).is_some_and(on))
    };
    let [mut inside, mut outside, mut left] = [0; 3];
    for (warp, splits) in
        [Warp::Box, Warp::Fitted, Warp::LightSpace].into_iter().flat_map(|warp| [(warp, 1), (warp, 3)])
    {
        let plan = SplitPlan { by: PartBy::SeenDepth, splits, warp, ..SplitPlan::default() };
        let depths = Some(told.map(|d| d as f32));
        let of = |overlap, depths| view.slices(&scene.camera, [64, 48], bounds, &plan, overlap, depths);
        let [all, only] = [0.0, LightView::OVERLAP].map(|overlap| of(overlap, depths));
        assert!(all.len() == splits as usize && only.len() == splits as usize);
        for p in &points {
            let within = (told[0]..=told[1]).contains(&depth_of(p));
            assert!(held(&all, *p) && (!within || held(&only, *p)), "{p} is on no map of {plan:?}");
            inside += usize::from(within);
            outside += usize::from(!within);
            left += usize::from(!within && !held(&only, *p));
        }
        // Without depths, and with all there are, they are slices of the box.
        let plain = SplitPlan { by: PartBy::Depth, ..plan };
        assert_eq!(of(0.0, None), view.slices(&scene.camera, [64, 48], bounds, &plain, 0.0, depths));
        assert_eq!(of(0.0, Some([1e-6, 1e6])), of(0.0, None));
    }
    assert!(inside > 100 && 8 * left > outside, "{inside} within the depths, {left} of {outside} others on no map");
}

/// Near the eye a warped map has more texels than an even one.
#[test]
fn what_is_near_gets_more_texels() {
    let scene = builtin("windmill");
    let [_, inside, ..] = cameras(&scene);
    let (view, seen) = setup(&lights()[1], &inside, &scene.mesh, 64);
    let across = |warp, splits| {
        let split = view.split(&seen, &SplitPlan { splits, warp, focus: 0.3, ..SplitPlan::default() }, 0.0, None)[0];
        let at = seen.forward * seen.near.max(0.05);
        let step = |d: DVec3| (place(&split, at + d.normalize() * 1e-3) - place(&split, at)).truncate();
        let up = seen.corners[0] - seen.corners[3];
        step(up).perp_dot(step(seen.forward)).abs().max(step(up).perp_dot(step(seen.forward.cross(up))).abs())
    };
    let (even, boxed) = (across(Warp::Whole, 1), across(Warp::Box, 1));
    assert!(boxed >= even, "{boxed} {even}");
    for warp in [Warp::Trapezoid, Warp::LightSpace, Warp::Perspective] {
        assert!(across(warp, 1) > 1.05 * boxed, "{warp:?} {} of {boxed}", across(warp, 1));
    }
    assert!(across(Warp::Box, 3) > 1.5 * boxed);
}

/// From outside, where no bound on warps is reached, that from the eye is the strongest.
#[test]
fn perspective_bends_more_than_light_space() {
    let scene = builtin("windmill");
    let camera = Camera { eye: [0.0, 4.0, 30.0], target: [0.0, 4.0, 0.0], ..scene.camera };
    let (view, seen) = setup(&lights()[0], &camera, &scene.mesh, 64);
    let farthest = |warp| {
        let split = view.split(&seen, &SplitPlan { warp, ..SplitPlan::default() }, 0.0, None)[0];
        seen_points(&view, &seen).iter().map(|&p| place(&split, p).z).fold(1.0, f64::max)
    };
    let [even, light_space, perspective] = [Warp::Box, Warp::LightSpace, Warp::Perspective].map(farthest);
    assert!((even - 1.0).abs() < 1e-6 && light_space > 1.1, "{even} {light_space}");
    assert!(perspective > 1.1 * light_space, "{perspective} {light_space}");
}

/// The fitted warp makes texels at most 5 % larger beside pixels than any other warp does, and often smaller.
#[test]
fn the_fitted_warp_is_the_best_of_all() {
    let scene = builtin("windmill");
    let mut gains = 0;
    for light in lights() {
        for camera in cameras(&scene) {
            let (view, seen) = setup(&light, &camera, &scene.mesh, 64);
            let whole = view.split(
                &seen,
                &SplitPlan { splits: 1, warp: Warp::Box, focus: 0.6, ..SplitPlan::default() },
                0.0,
                None,
            )[0];
            let farthest = seen.box_corners().map(|p| p.dot(seen.forward)).fold(0.0, f64::max);
            let part = seen.part(&view, seen.near, farthest.max(seen.near));
            let depths = || part.iter().map(|p| p.dot(seen.forward));
            let near = depths().fold(f64::INFINITY, f64::min).max(seen.near);
            let probes = seen.probes(&view, near, depths().fold(0.0, f64::max));
            if probes.is_empty() {
                continue;
            }
            let width = |warp| {
                let split =
                    view.split(&seen, &SplitPlan { splits: 1, warp, focus: 0.6, ..SplitPlan::default() }, 0.0, None)[0];
                coarseness(split.warp, &probes)
            };
            let [fitted, even] = [width(Warp::Fitted), coarseness(whole.warp, &probes)];
            for other in [width(Warp::Trapezoid), width(Warp::LightSpace), width(Warp::Perspective), even] {
                assert!(fitted < 1.05 * other, "{other} beside {fitted}");
                gains += i32::from(fitted < 0.99 * other);
            }
        }
    }
    assert!(gains > 5, "{gains}");
}

/// A light from the side sees the axis at its length, one at 45 degrees foreshortened: the distance on the map is that of the paper,
/// `(n + sqrt(n f)) / sin`, times the sine by which lengths along the axis are shorter there, over the sine once more.
#[test]
fn light_space_perspective_has_the_distance_of_the_paper() {
    let scene = builtin("windmill");
    let camera = Camera { eye: [0.0, 4.0, 30.0], target: [0.0, 4.0, 0.0], ..scene.camera };
    for degrees in [90.0f64, 45.0, 30.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let light = Light::Directional { direction: [0.0, sin as f32, cos as f32] };
        let (view, seen) = setup(&light, &camera, &scene.mesh, 64);
        let (n, f) = (0.2, 0.7);
        let at = |depth: f64| view.project(seen.forward * depth).unwrap().truncate();
        let along = Along::new(&[at(n), at(f), at(n) + DVec2::new(1.0, 1.0)], at(n), at(f)).unwrap();
        let texels_a_length = at(f).distance(at(n)) / (f - n);
        let want = (n + (n * f).sqrt()) / (sin * sin) * texels_a_length;
        let got = along.by_light_space(&view, seen.forward, [n, f], |n, f| n + (n * f).sqrt()).unwrap();
        assert!((got / want - 1.0).abs() < 1e-3, "{degrees} degrees: {got} for {want}");
    }
}

/// A flat ground: every ray that meets it says where on the map its pixel lies.
#[test]
fn a_ground_alone_is_fitted() {
    let ground = Mesh {
        positions: [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, z]| [x, 0.5, z]).to_vec(),
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    };
    let plane = builtin("plane");
    let camera = Camera { eye: [0.0, 1.2, 7.0], target: [0.0, 0.5, 0.0], near: 0.01, ..plane.camera };
    for light in [Light::Directional { direction: [0.9, 0.8, 0.1] }, Light::Point { position: [3.0, 6.0, 2.0] }] {
        let (view, seen) = setup(&light, &camera, &ground, 64);
        let farthest = seen.box_corners().map(|p| p.dot(seen.forward)).fold(0.0, f64::max);
        let probes = seen.probes(&view, seen.near, farthest);
        assert!(probes.len() > 50, "{} probes", probes.len());
        let width = |warp| {
            let split =
                view.split(&seen, &SplitPlan { splits: 1, warp, focus: 0.6, ..SplitPlan::default() }, 0.0, None)[0];
            coarseness(split.warp, &probes)
        };
        let (fitted, even) = (width(Warp::Fitted), width(Warp::Box));
        assert!(fitted < 0.9 * even, "{fitted} of {even}");
    }
}

/// As the camera moves by little, so does what the map shows of a place.
#[test]
fn the_fitted_warp_follows_the_camera() {
    let scene = builtin("plane");
    let bounds = scene.mesh.bounds().unwrap();
    let (middle, long) = ((bounds.0 + bounds.1) * 0.5, (bounds.1 - bounds.0).length());
    let fit = LightView::fit(&scene.mesh, &lights()[2], 512).unwrap();
    let at_step = |step: i32| {
        let turn = 0.3 + f64::from(step) * 0.002;
        let eye = middle + DVec3::new(turn.cos() * 0.3, 0.03, turn.sin() * 0.3) * long;
        let target = middle + DVec3::X * ((turn + 0.4).sin() * 0.06 * long);
        let camera = Camera { eye: eye.as_vec3().into(), target: target.as_vec3().into(), ..scene.camera };
        let rays = camera.rays(64, 48);
        let scale = unit_scale(rays.eye, bounds);
        let seen = SeenBox::new(&rays, [64, 48], f64::from(camera.near), bounds, scale);
        let plan = SplitPlan { splits: 1, warp: Warp::Fitted, focus: 0.3, ..SplitPlan::default() };
        let view = fit.relative_to(rays.eye, scale).split(&seen, &plan, 0.0, None)[0];
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| {
            let p = middle + DVec3::new(0.03 * k, 0.0, 0.045 * (k + 1.0)) * long;
            place(&view, (p - rays.eye) * scale).truncate()
        })
    };
    let steps: Vec<_> = (0..400).map(at_step).collect();
    let moved = |pair: &[[DVec2; 5]]| (0..5).map(|k| pair[0][k].distance(pair[1][k])).fold(0.0, f64::max);
    let mut moves: Vec<f64> = steps.windows(2).map(moved).collect();
    moves.sort_by(f64::total_cmp);
    let (median, most) = (moves[moves.len() / 2], moves[moves.len() - 1]);
    assert!(median > 0.1 && most < 3.0 * median, "{most} texels where {median} are usual");
}

/// Where single precision bounds texels a warp gets weaker, and is not given up: near the eye it still has more of them than an even map, and
/// a larger map never has much fewer.
#[test]
fn a_warp_is_weaker_where_texels_would_be_too_small() {
    let half = 2400.0;
    let positions =
        vec![[-half, 0.0, -half], [half, 0.0, -half], [half, 0.0, half], [-half, 0.0, half], [0.0, 30.0, 0.0]];
    let mesh = Mesh { positions, triangles: vec![[0, 2, 1], [0, 3, 2], [0, 1, 4]] };
    let camera = Camera { eye: [30.0, 34.0, 190.0], target: [-6.0, 0.0, 20.0], ..builtin("windmill").camera };
    let light = Light::Directional { direction: [0.15, 0.5, 1.0] };
    let bounds = mesh.bounds().unwrap();
    // Texels a metre on the ground before the eye, across and along the view, the fewer of them.
    let texels = |map: u32, warp: Warp| {
        let view = LightView::fit(&mesh, &light, map).unwrap();
        let plan = SplitPlan { splits: 1, warp, ..SplitPlan::default() };
        let slice = view.slices(&camera, [400, 300], bounds, &plan, 0.0, None)[0];
        let at = |x: f64, z: f64| slice.project(DVec3::new(x, 0.0, z)).unwrap().truncate();
        let step = |d: DVec2| (at(18.0 + d.x, 133.0 + d.y) - at(18.0, 133.0)).length();
        step(DVec2::X).min(step(DVec2::Y))
    };
    let mut bounded = 0;
    for warp in [Warp::Trapezoid, Warp::LightSpace, Warp::Perspective, Warp::Fitted] {
        let mut before = 0.0;
        for map in [256, 512, 724, 1024, 1448, 2048, 4096] {
            let (even, warped) = (texels(map, Warp::Box), texels(map, warp));
            assert!(warped > 1.05 * even, "{warp:?}, a map of {map}: {warped} texels a metre, {even} without a warp");
            assert!(
                warped > 0.7 * before,
                "{warp:?}, a map of {map}: {warped} texels a metre, {before} with a smaller map"
            );
            bounded += usize::from(warped < 1.3 * before);
            before = warped;
        }
    }
    assert!(bounded > 2, "single precision bounds nothing");
}

/// While a camera moves and turns, the places of points that stand change by whole texels, but for the few steps in which a slice gets another
/// size; over a box they change as they like.
#[test]
fn stable_slices_move_by_whole_texels() {
    let scene = builtin("windmill");
    let light = &lights()[1];
    let bounds = scene.mesh.bounds().unwrap();
    let view = LightView::fit(&scene.mesh, light, 512).unwrap();
    let points = [DVec3::new(0.3, 0.1, 0.4), DVec3::new(-0.7, 0.5, 0.1), DVec3::new(1.3, 0.0, -0.9)];
    let moves = |warp: Warp| {
        let (mut whole, mut steps, mut before) = (0, 0, None::<Vec<[DVec2; 3]>>);
        for k in 0..200 {
            let t = f64::from(k) * 0.01;
            let eye = [(3.0 * t.cos()) as f32, 1.5, (3.0 * t.sin()) as f32];
            let camera = Camera { eye, target: [0.1 * (2.0 * t).sin() as f32, 0.4, 0.0], ..scene.camera };
            let plan = SplitPlan { splits: 3, warp, ..SplitPlan::default() };
            let slices = view.slices(&camera, [64, 48], bounds, &plan, 0.0, None);
            let now: Vec<_> =
                slices.iter().map(|s| points.map(|p| s.project(p).map_or(DVec2::ZERO, DVec3::truncate))).collect();
            for (old, new) in before.iter().flatten().zip(&now) {
                let by = new[0] - old[0];
                let rigid = (0..3).all(|p| (new[p] - old[p] - by).length() < 1e-5);
                steps += 1;
                whole += usize::from(rigid && (by - by.round()).length() < 1e-5);
            }
            before = Some(now);
        }
        (whole, steps)
    };
    let ((stable, all), (boxed, _)) = (moves(Warp::Stable), moves(Warp::Box));
    assert!(
        all == 597 && stable > all * 9 / 10 && boxed < all / 10,
        "{stable} and {boxed} of {all} steps are of whole texels"
    );
}
