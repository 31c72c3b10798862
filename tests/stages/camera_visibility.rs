//! The nearest triangle at each pixel centre, against `f64`: equal at every pixel that is not within a thousandth of a
//! pixel of an edge or has two depths too near to tell; and no pixel that a surface covers goes without a triangle.

use crate::support::geometry::{Case, MESHES, Ran, add, ball, fan, light, mesh, run_all};
use crate::support::meshes::oblique;
use crate::support::{gpu, sizes_around, small_gpu};
use oracle::reference::camera_visibility::{DepthMargin, nearest};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::Mesh;
use test_support::gpu_test;

const DOUBT: DepthMargin = DepthMargin { edge: 1e-3, depth: 1e-5 };

/// Where the stage departs from its definition, else how many pixels are left open.
fn compare(case: &Case, ran: &Ran) -> Result<usize, String> {
    let wanted = case.wanted();
    let seen = nearest(&wanted.view, &wanted.triangles, DOUBT);
    if seen.len() != ran.id_keys.len() || seen.len() != ran.seen_keys.len() {
        return Err("another number of pixels".to_owned());
    }
    let mut open = 0;
    for (pixel, want) in seen.iter().enumerate() {
        let key = ran.id_keys[pixel];
        let got = (key != 0).then_some(!key);
        let depth = f64::from(f32::from_bits(!ran.seen_keys[pixel][1]));
        let at = format!("pixel {} {}", pixel as u32 % case.image[0], pixel as u32 / case.image[0]);
        if (key == 0) != (ran.seen_keys[pixel][1] == 0) {
            return Err(format!("{at}: depth without a triangle, or a triangle without depth"));
        }
        if want.covered && got.is_none() {
            return Err(format!("{at}: a hole; {want:?}"));
        }
        if want.open {
            open += 1;
            continue;
        }
        if got != want.triangle {
            return Err(format!("{at}: {got:?} at depth {depth}, {want:?}"));
        }
        // Of a sliver it is a bound.
        let near = (depth / want.depth - 1.0).abs() <= 2e-3;
        if got.is_some() && !near {
            return Err(format!("{at}: depth {depth}, {want:?}"));
        }
    }
    Ok(open)
}

/// Fails on any difference, or if more than `share` of the pixels are open.
#[track_caller]
fn check(gpu: &Gpu, case: &Case, share: f64) -> Ran {
    let ran = run_all(gpu, case);
    match compare(case, &ran) {
        Ok(open) => assert!(open as f64 <= 4.0 + share * ran.id_keys.len() as f64, "{open} pixels are open"),
        Err(text) => panic!("image {:?}: {text}", case.image),
    }
    ran
}

/// Every pixel inside the outline, by a generous distance, has a triangle.
#[track_caller]
fn assert_no_holes(case: &Case, ran: &Ran, inside: impl Fn(DVec3) -> bool) {
    let view = case.view();
    let mut covered = 0;
    for (pixel, &key) in ran.id_keys.iter().enumerate() {
        let (x, y) = (pixel as u32 % case.image[0], pixel as u32 / case.image[0]);
        let ray = view.rays.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
        // Both shapes lie in the plane y = 0.
        let t = -view.eye.y / ray.y;
        if t > 0.0 && inside(view.eye + ray * t) {
            covered += 1;
            assert!(key != 0, "hole at {x} {y}");
        }
    }
    assert!(covered > 1000, "the test looks at {covered} pixels");
}

#[gpu_test]
fn empty() {
    let ran = check(gpu(), &Case::new(&Mesh::default(), light(0), [5, 3], 1), 0.0);
    assert!(ran.id_keys.iter().all(|&k| k == 0));
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for image in [[1, 1], [3, 1], [65, 33]] {
        let mut case = Case::new(&mesh, light(0), image, 1);
        case.camera.target = [0.3, 0.0, 0.3];
        let ran = check(gpu(), &case, 0.01);
        assert_eq!(ran.id_keys[(image[0] * (image[1] / 2) + image[0] / 2) as usize], !0, "in the middle");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    // Sizes of the image around a block, and of the work around a workgroup.
    for size in [sizes_around(8), vec![1]].concat() {
        check(
            gpu(),
            &Case::new(&mesh("closed balls", size as u64), light(0), [size as u32, 2 * size as u32 + 1], 8),
            0.02,
        );
    }
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [40, 31], 8), 0.2);
    }
}

#[gpu_test]
fn random_seeded() {
    for name in MESHES {
        for seed in 0..3 {
            // Coplanar and doubled triangles are open wherever they are seen.
            let share = if ["doubled", "slivers"].contains(&name) { 1.0 } else { 0.03 };
            check(gpu(), &Case::new(&mesh(name, seed), light(seed), [203, 151], 8), share);
        }
    }
    for n in [4, 5, 16, 64, 255, 1024] {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n);
        mesh.positions.iter_mut().for_each(|p| p[1] = 0.0);
        let case = Case::new(&mesh, light(0), [331, 203], 8);
        let ran = run_all(gpu(), &case);
        let inner = 0.99 * (std::f64::consts::PI / f64::from(n)).cos();
        assert_no_holes(&case, &ran, |p| p.length() < inner);
    }
}

#[gpu_test]
fn degenerate() {
    // A tessellated square whose lines run exactly through rows and columns of pixel centres, seen from above.
    for (n, image) in [(7u32, [63u32, 63u32]), (31, [65, 65]), (16, [129, 127]), (100, [401, 401])] {
        let mut mesh = Mesh::default();
        let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
        let points: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| DVec3::new(at(i), 0.0, at(j)))).collect();
        let quad = |i: u32, j: u32| {
            [
                [i + j * (n + 1), i + 1 + (j + 1) * (n + 1), i + 1 + j * (n + 1)],
                [i + j * (n + 1), i + (j + 1) * (n + 1), i + 1 + (j + 1) * (n + 1)],
            ]
        };
        let faces: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect();
        add(&mut mesh, &points, &faces);
        for (eye, up) in [
            ([0.0, 2.5, 0.0], [0.0, 0.0, -1.0]),
            ([0.0, 2.0, 0.3], [0.0, 0.0, -1.0]),
            ([0.7, 0.4, 1.3], [0.0, 1.0, 0.0]),
            ([0.0, 0.02, 1.5], [0.0, 1.0, 0.0]),
        ] {
            let mut case = Case::new(&mesh, light(0), image, 8);
            (case.camera.eye, case.camera.target, case.camera.up) = (eye, [0.0; 3], up);
            (case.camera.near, case.camera.vertical_fov_degrees) = (1e-3, 50.0);
            let ran = run_all(gpu(), &case);
            let view = case.view();
            for (pixel, &key) in ran.id_keys.iter().enumerate() {
                let ray = view
                    .rays
                    .direction(f64::from(pixel as u32 % image[0]) + 0.5, f64::from(pixel as u32 / image[0]) + 0.5);
                let t = -view.eye.y / ray.y;
                let p = view.eye + ray * t;
                let inside = t > 1e-2 && p.x.abs() < 0.999 && p.z.abs() < 0.999;
                assert!(!inside || key != 0, "n {n}, eye {eye:?}: hole at pixel {pixel}");
            }
        }
    }
    // Through the near plane, behind the camera, huge; and a vertex that is no number.
    for seed in 0..4 {
        let mut case = Case::new(&mesh("huge", seed), light(0), [151, 103], 8);
        check(gpu(), &case, 0.05);
        (case.camera.eye, case.camera.target) = ([0.2, 0.6, 0.3], [0.6, 0.1, -1.0]);
        for near in [1e-1, 1e-3] {
            (case.camera.near, case.camera.far) = (near, 1e9);
            check(gpu(), &case, 0.05);
        }
        let mut ground = mesh("contact", seed);
        let below = ground.ground_below().expect("a ground");
        ground.add_ground(&below);
        let mut case = Case::new(&ground, light(0), [151, 103], 8);
        (case.camera.eye, case.camera.target) = ([1.0, -0.3, 1.0], [0.0, -0.4, 0.0]);
        case.camera.near = 1e-3;
        check(gpu(), &case, 0.25);
    }
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [99, 77], 8);
    let mut positions = case.prepared.mesh().positions.clone();
    positions[11][2] = f32::NAN;
    case.positions = Some(positions);
    check(gpu(), &case, 0.02);
}

/// Two squares so near to each other that 46 bits alone tell which is nearer, the one to the left, the other to the right, over a floor.
fn crossing_sheets(half: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for (lean, half, y) in [(0.0, half, 0.0), (1e-7, half, 0.0), (0.0, 1.0, -1.0)] {
        let at = |x: f64, z: f64| DVec3::new(x, y + lean * x, z);
        let corners = [at(-half, -half), at(-half, half), at(half, half), at(half, -half)];
        add(&mut mesh, &corners, &[[0, 1, 2], [0, 2, 3]]);
    }
    mesh
}

/// Pixels that are open are settled to the nearest triangle by the list and, where that has not the room, through all blocks.
#[gpu_test]
fn overflow_by_one() {
    let image = [64, 48];
    let room = image[0] * image[1] / 4 + 64;
    let mut noted = Vec::new();
    for half in [0.05, 0.1, 0.2, 0.3, 0.4, 0.8] {
        let mut case = Case::new(&crossing_sheets(half), light(0), image, 8);
        (case.camera.eye, case.camera.target, case.camera.up) = ([0.0, 1.5, 0.0], [0.0; 3], [0.0, 0.0, -1.0]);
        (case.camera.near, case.camera.vertical_fov_degrees) = (1e-3, 50.0);
        let ran = run_all(gpu(), &case);
        let wanted = case.wanted();
        let seen = nearest(&wanted.view, &wanted.triangles, DepthMargin { edge: 1e-3, depth: 1e-10 });
        let (mut open, mut of_each) = (0, [0; 6]);
        for (pixel, want) in seen.iter().enumerate() {
            if want.open {
                open += 1;
                continue;
            }
            let got = (ran.id_keys[pixel] != 0).then_some(!ran.id_keys[pixel]);
            assert_eq!(got, want.triangle, "{half}: pixel {pixel}");
            of_each[got.map_or(0, |t| t as usize)] += 1;
        }
        assert!(open * 10 < seen.len(), "{half}: {open} pixels are open");
        assert!(of_each.iter().filter(|&&n| n > 0).count() >= 4, "{half}: {of_each:?}");
        noted.push(ran.noted);
    }
    assert!(noted[0] > 0 && noted[2] < room && noted.iter().any(|&n| n > 2 * room), "{noted:?}, {room}");
}

/// A sheet whose depth is that of the near distance, to a few ulps, is seen where it lies beyond it, and elsewhere a wall behind it, or nothing.
#[gpu_test]
fn near_distance() {
    for (near, lean, wall) in [(1.0f32, 4e-7, true), (1.0, -4e-7, false), (0.25, 2e-7, true), (3.0, 8e-7, false)] {
        let mut mesh = Mesh::default();
        let of = |near: f64, x: f64, y: f64, lean: f64| DVec3::new(x, y, -near - lean * x / near);
        for (far, lean) in
            [(f64::from(near), lean), (2.0 * f64::from(near), 0.0)].into_iter().take(1 + usize::from(wall))
        {
            let corners =
                [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, y)| of(far, far * x, far * y, lean));
            add(&mut mesh, &corners, &[[0, 1, 2], [0, 2, 3]]);
        }
        let mut case = Case::new(&mesh, light(0), [61, 43], 8);
        (case.camera.eye, case.camera.target, case.camera.up) = ([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
        (case.camera.near, case.camera.far) = (near, 100.0);
        let ran = run_all(gpu(), &case);
        let wanted = case.wanted();
        let seen = nearest(&wanted.view, &wanted.triangles, DepthMargin { edge: 1e-3, depth: 1e-11 });
        let (mut open, mut of_each) = (0, [0; 5]);
        for (pixel, want) in seen.iter().enumerate() {
            let got = (ran.id_keys[pixel] != 0).then_some(!ran.id_keys[pixel]);
            if want.open {
                open += 1;
                continue;
            }
            assert_eq!(got, want.triangle, "near {near}, lean {lean}: pixel {pixel}");
            of_each[got.map_or(4, |t| t as usize)] += 1;
        }
        let surfaces = of_each.iter().filter(|&&n| n > 100).count();
        assert!(open * 4 < seen.len() && surfaces >= 3, "near {near}, lean {lean}: {open} open, {of_each:?}");
        assert!(ran.noted > 100, "{} pixels are in doubt", ran.noted);
    }
}

/// Surfaces before an oblique near plane are not seen, whether that cuts triangles or hides all in a part of the image.
#[gpu_test]
fn an_oblique_near_plane() {
    for (name, seed) in [("closed balls", 1), ("huge", 2), ("contact", 3)] {
        for (share, tilt) in [(1.0, [0.4, 0.3, -0.2]), (0.9, [-2.0, 0.5, 1.0]), (0.5, [0.0; 3])] {
            let mut case = Case::new(&mesh(name, seed), light(0), [101, 77], 8);
            case.camera.near_plane = oblique(&case.camera, share, tilt);
            let ran = check(gpu(), &case, 0.05);
            if share == 1.0 {
                case.camera.near_plane = None;
                assert!(compare(&case, &ran).is_err(), "{name}: the plane hides nothing");
            }
        }
    }
}

/// Nothing is written past the last pixel (see `run_all`), whatever the image's size.
#[gpu_test]
fn no_pixel_too_many() {
    for image in [[1, 1], [7, 1], [8, 8], [9, 7], [63, 65], [64, 64]] {
        let mut case = Case::new(&mesh("closed balls", 3), light(0), image, 8);
        // So near that the whole image is covered.
        case.camera.vertical_fov_degrees = 3.0;
        check(gpu(), &case, 0.05);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(24, 1 << 20);
    let mut dense = Mesh::default();
    ball(&mut dense, DVec3::ZERO, 1.0, 40, 30);
    let case = Case::new(&dense, light(0), [130, 70], 8);
    let ran = check(&small, &case, 0.02);
    assert!(ran.camera_items.iter().sum::<u32>() > 24 * 64, "more than one row of workgroups");
    assert!(ran.words() == run_all(gpu(), &case).words(), "the fold changes the result");
}

/// More work items than a dispatch has workgroups along one dimension.
#[gpu_test]
fn very_many_items() {
    let mut mesh = Mesh::default();
    ball(&mut mesh, DVec3::ZERO, 1.0, 300, 180);
    let ran = check(gpu(), &Case::new(&mesh, light(0), [640, 480], 8), 0.2);
    assert!(ran.camera_items.iter().map(|&n| n as usize).sum::<usize>() > 65_535);
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [99, 77], 8);
    let ran = check(gpu(), &case, 0.02);
    assert!(ran.words() == run_all(gpu(), &case).words(), "another result in a second run");
    let middle = ran.id_keys.iter().position(|&k| k != 0).expect("something is seen") + 2;
    for key in [0, ran.id_keys[middle].wrapping_add(1)] {
        let mut off = ran.clone();
        off.id_keys[middle] = key;
        assert!(compare(&case, &off).is_err());
    }
    let mut off = ran;
    off.id_keys.pop();
    assert!(compare(&case, &off).is_err());
}
