//! Facets for every surface, against `f64`: each sample of each pixel in exactly one facet, that of the triangle it sees,
//! wherever no edge is within 1/256 pixel and no two depths are too near to tell; none missed where one surely covers.

use crate::support::geometry::{Case, MESHES, add, ball, fan, light, mesh};
use crate::support::surfaces::{Found, find, find_merged, find_within, is_span, pattern, square};
use crate::support::{Random, gpu, sizes_around, small_gpu};
use lab::scene::builtin;
use oracle::reference::camera_visibility::DepthMargin;
use oracle::reference::sample_surfaces::{Sample, merged, see, surfaces};
use oracle::truth::{AMBIGUITY, SceneTruth, Tracer, join_mask};
use subpixel_shadows::glam::{DQuat, DVec2, DVec3};
use subpixel_shadows::gpu::{Gpu, Profile};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::Mesh;
use test_support::gpu_test;

/// Triangles that a dispatch takes of a pixel on a driver of the CPU.
const TURNS: u32 = 512;
const DOUBT: DepthMargin = DepthMargin { edge: AMBIGUITY, depth: 1e-5 };

fn wanted(case: &Case, samples: &Samples) -> Vec<Sample> {
    wanted_by(case, samples, DOUBT)
}

fn wanted_by(case: &Case, samples: &Samples, doubt: DepthMargin) -> Vec<Sample> {
    let wanted = case.wanted();
    let offsets: Vec<DVec2> = samples.offsets().iter().map(|o| DVec2::new(o[0].into(), o[1].into())).collect();
    see(&wanted.view, &wanted.triangles, &offsets, doubt)
}

/// Where the stage departs from its definition, else how many samples are left open.
fn compare(found: &Found, wanted: &[Sample], samples: &Samples) -> Result<usize, String> {
    let count = samples.count();
    if found.surfaces.len() * count as usize != wanted.len() {
        return Err("another number of samples".to_owned());
    }
    let (mut open, mut facet) = (0, 0);
    for (pixel, wanted) in wanted.chunks(count as usize).enumerate() {
        let got = found.samples(pixel, count)?;
        if surfaces(&got) != found.surfaces[pixel] {
            return Err(format!("facets of pixel {pixel} in another order: {:?}", found.surfaces[pixel]));
        }
        for (_, mask) in &found.surfaces[pixel] {
            let first = samples.offsets()[mask.trailing_zeros() as usize].map(|o| o - 0.5);
            if found.origins.get(facet) != Some(&first) {
                return Err(format!("facet {facet} is not at its first sample"));
            }
            if !found.spans.get(facet).is_some_and(|span| is_span(*span, samples, *mask)) {
                return Err(format!("facet {facet} of {mask:x} has another box: {:x?}", found.spans.get(facet)));
            }
            facet += 1;
        }
        if got[0] != (found.id_keys[pixel] != 0).then_some(!found.id_keys[pixel]) {
            return Err(format!("pixel {pixel}: the triangle at the centre is not that of sample 0"));
        }
        for (k, (got, want)) in got.iter().zip(wanted).enumerate() {
            let at = format!("pixel {} {} sample {k}", pixel as u32 % found.image[0], pixel as u32 / found.image[0]);
            if want.covered && got.is_none() {
                return Err(format!("{at}: a hole; {want:?}"));
            }
            open += usize::from(want.open);
            if !want.open && *got != want.triangle {
                return Err(format!("{at}: {got:?}, {want:?}"));
            }
        }
    }
    Ok(open)
}

/// Fails on any difference, or if more than `share` of the samples are open.
#[track_caller]
fn check(gpu: &Gpu, case: &Case, count: u32, share: f64) -> Found {
    let samples = pattern(count);
    let found = find(gpu, case, &samples);
    let wanted = wanted(case, &samples);
    match compare(&found, &wanted, &samples) {
        Ok(open) => assert!(open as f64 <= 64.0 + share * wanted.len() as f64, "{open} of {} are open", wanted.len()),
        Err(text) => panic!("image {:?}: {text}", case.image),
    }
    found
}

/// Every sample that the tracer says sees something, away from edges, lies in the facet of what it sees.
#[track_caller]
fn check_truth(case: &Case, found: &Found, count: u32) {
    let samples = pattern(count);
    let tracer = Tracer::new(case.prepared.mesh()).expect("a tracer");
    let [w, h] = case.image;
    let truth = SceneTruth::new(&tracer, &case.camera, &case.light, &samples, w, h).expect("a truth");
    let wanted = wanted(case, &samples);
    for (pixel, wanted) in wanted.chunks(count as usize).enumerate() {
        let sure = wanted.iter().enumerate().filter(|(_, w)| !w.open).fold(0u128, |m, (k, _)| m | 1 << k);
        let seen = truth.surfaces(pixel as u32);
        let mut want: Vec<_> = seen.into_iter().map(|(t, mask)| (t, join_mask(mask) & sure)).collect();
        let mut got: Vec<_> = found.surfaces[pixel].iter().map(|&(t, mask)| (t, mask & sure)).collect();
        for list in [&mut want, &mut got] {
            list.retain(|s| s.1 != 0);
            list.sort_unstable();
        }
        assert_eq!(got, want, "pixel {pixel}");
    }
}

#[gpu_test]
fn empty() {
    let found = check(gpu(), &Case::new(&Mesh::default(), light(0), [5, 3], 1), 32, 0.0);
    assert_eq!(found.needed, [0; 3]);
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for (image, count) in [([1, 1], 1), ([3, 1], 8), ([33, 17], 128)] {
        let mut case = Case::new(&mesh, light(0), image, 1);
        case.camera.target = [0.3, 0.0, 0.3];
        let found = check(gpu(), &case, count, 0.02);
        assert!(found.surfaces.iter().all(|s| s.len() <= 1) && found.needed[2] > 0);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for (size, count) in [(1, 32), (2, 64), (3, 128), (4, 16), (5, 32), (7, 8), (8, 32), (9, 64), (17, 1)] {
        let case = Case::new(&mesh("closed balls", size), light(0), [size as u32, 2 * size as u32 + 1], 8);
        check(gpu(), &case, count, 0.05);
    }
    // Lists around a batch of 32 triangles.
    for n in sizes_around(32) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [9, 7], 8), 32, 0.3);
    }
}

#[gpu_test]
fn random_seeded() {
    for name in MESHES {
        for seed in 0..2 {
            // Coplanar and doubled triangles are open wherever they are seen.
            let share = if ["doubled", "slivers"].contains(&name) { 1.0 } else { 0.06 };
            let case = Case::new(&mesh(name, seed), light(seed), [61, 45], 8);
            let found = check(gpu(), &case, 32, share);
            check_truth(&case, &found, 32);
        }
    }
}

/// Closed fans seen from above, their hub and their spokes through samples: of ten million samples inside none is missed, and
/// none lies in two facets.
#[gpu_test]
fn no_sample_of_a_closed_fan_is_missed() {
    let grid = Samples::new(subpixel_shadows::samples::Pattern::Grid, 16).expect("a grid");
    let mut looked = 0u64;
    for (n, side) in [(4u32, 400u32), (7, 401), (64, 512), (255, 401), (1024, 512)] {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n);
        mesh.positions.iter_mut().for_each(|p| p[1] = 0.0);
        mesh.positions[0] = [0.0; 3];
        let mut case = Case::new(&mesh, light(0), [side, side], 8);
        (case.camera.eye, case.camera.target, case.camera.up) = ([0.0, 2.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0]);
        case.camera.vertical_fov_degrees = 40.0;
        let found = find(gpu(), &case, &grid);
        let view = case.view();
        let inner = 0.99 * mesh.positions[1..].iter().map(|p| p[0].hypot(p[2])).fold(f32::MAX, f32::min);
        let inner = f64::from(inner) * (std::f64::consts::PI / f64::from(n)).cos();
        for pixel in 0..found.surfaces.len() {
            let seen = found.samples(pixel, 16).expect("each sample in one facet");
            for (k, o) in grid.offsets().iter().enumerate() {
                let (x, y) = (pixel as u32 % side, pixel as u32 / side);
                let ray = view.rays.direction(f64::from(x) + f64::from(o[0]), f64::from(y) + f64::from(o[1]));
                let p = view.eye - ray * (view.eye.y / ray.y);
                let inside = p.x.hypot(p.z) < inner;
                looked += u64::from(inside);
                assert!(!inside || seen[k].is_some(), "fan of {n}: hole at {x} {y} sample {k}");
            }
        }
    }
    assert!(looked > 10_000_000, "{looked} samples");
}

/// Samples exactly on edges and vertices: closed fans and squares have no holes and no sample twice, however they are cut.
#[gpu_test]
fn degenerate() {
    let grid = Samples::new(subpixel_shadows::samples::Pattern::Grid, 16).expect("a grid");
    let mut looked = 0;
    let mut meshes: Vec<(Mesh, f64)> = [1, 2, 7, 16, 31, 64].map(|n| (square(n), 0.999)).into();
    for n in [4u32, 5, 16, 64, 255, 1024] {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n);
        // The hub is seen exactly at samples: it is the origin, and the camera looks at it.
        mesh.positions.iter_mut().for_each(|p| p[1] = 0.0);
        mesh.positions[0] = [0.0; 3];
        meshes.push((mesh, 0.7 * (std::f64::consts::PI / f64::from(n)).cos()));
    }
    for (mesh, inner) in &meshes {
        for (eye, up) in [
            ([0.0, 2.5, 0.0], [0.0, 0.0, -1.0]),
            ([0.7, 0.4, 1.3], [0.0, 1.0, 0.0]),
            ([0.0, 2.0, 0.3], [0.0, 0.0, -1.0]),
        ] {
            for image in [[33, 33], [32, 32]] {
                let mut case = Case::new(mesh, light(0), image, 8);
                (case.camera.eye, case.camera.target, case.camera.up) = (eye, [0.0; 3], up);
                (case.camera.near, case.camera.vertical_fov_degrees) = (1e-3, 45.0);
                let found = find(gpu(), &case, &grid);
                let view = case.view();
                for pixel in 0..found.surfaces.len() {
                    let seen = found.samples(pixel, 16).expect("each sample in one facet");
                    for (k, o) in grid.offsets().iter().enumerate() {
                        let (x, y) = (pixel as u32 % image[0], pixel as u32 / image[0]);
                        let ray = view.rays.direction(f64::from(x) + f64::from(o[0]), f64::from(y) + f64::from(o[1]));
                        let p = view.eye - ray * (view.eye.y / ray.y);
                        let inside = ray.y < 0.0 && p.x.abs() < *inner && p.z.abs() < *inner;
                        looked += usize::from(inside);
                        assert!(!inside || seen[k].is_some(), "hole at {x} {y} sample {k}, eye {eye:?}");
                    }
                }
            }
        }
    }
    assert!(looked > 300_000, "{looked} samples");
    // Through the near plane, behind the camera, huge; a vertex that is no number; far away, below a pixel.
    for seed in 0..3 {
        let mut case = Case::new(&mesh("huge", seed), light(0), [61, 45], 8);
        check(gpu(), &case, 32, 0.1);
        (case.camera.eye, case.camera.target) = ([0.2, 0.6, 0.3], [0.6, 0.1, -1.0]);
        for near in [1e-1, 1e-3] {
            (case.camera.near, case.camera.far) = (near, 1e9);
            check(gpu(), &case, 32, 0.1);
        }
    }
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [49, 37], 8);
    let mut positions = case.prepared.mesh().positions.clone();
    positions[11][2] = f32::NAN;
    case.positions = Some(positions);
    check(gpu(), &case, 32, 0.06);
    let mut dense = Mesh::default();
    ball(&mut dense, DVec3::ZERO, 1.0, 90, 60);
    let mut case = Case::new(&dense, light(0), [9, 9], 8);
    case.camera.vertical_fov_degrees = 90.0;
    let found = check(gpu(), &case, 32, 1.0);
    assert!(found.longest > 1000, "{}", found.longest);
}

/// More triangles cover samples of a pixel than a round takes: what the first rounds found is kept.
#[gpu_test]
fn several_rounds() {
    // None covers the pixel, which would hide those behind.
    let mut mesh = Mesh::default();
    let mut random = Random::new(5);
    let mut number = || f64::from(random.below(1 << 20)) / f64::from(1 << 20);
    for _ in 0..4 * TURNS + 100 {
        let (depth, turn) = (1.0 + number(), std::f64::consts::TAU * number());
        let corner = |k: u32| {
            let (y, x) = (turn + std::f64::consts::TAU * f64::from(k) / 3.0).sin_cos();
            DVec3::new(x * depth, y * depth, -depth)
        };
        add(&mut mesh, &[0, 1, 2].map(corner), &[[0, 1, 2]]);
    }
    let mut case = Case::new(&mesh, light(0), [1, 1], 8);
    (case.camera.eye, case.camera.target, case.camera.up) = ([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]);
    case.camera.vertical_fov_degrees = 100.0;
    let found = check(gpu(), &case, 128, 1.0);
    assert!(found.covered.len() > 4 * TURNS as usize, "{}", found.covered.len());
    let room = found.needed.map(|n| n + 8);
    let within = |most| Profile::Software.within(|| find_within(gpu(), &case, &pattern(128), room, most));
    assert!(within(1).surfaces != found.surfaces, "one round is enough");
    assert!(within(found.longest + TURNS) == found, "a round too many changes something");
    assert!(Profile::Gpu.within(|| find(gpu(), &case, &pattern(128))) == found, "another profile");
}

/// Sheets that single precision does not tell apart, two to more than a round holds: each sample sees the nearest.
#[gpu_test]
fn crowds() {
    // No edge is in sight.
    let strict = DepthMargin { edge: 1e-10, depth: 1e-11 };
    let (x, y) = (DVec3::new(0.8, 0.23, -0.31), DVec3::new(0.17, 0.41, 0.83));
    let up = y.cross(x).normalize();
    for (sheets, image, count) in [(2, [33, 25], 32), (3, [33, 25], 32), (9, [17, 13], 128), (600, [5, 4], 64)] {
        let mut mesh = Mesh::default();
        for k in 0..sheets {
            let turn = DQuat::from_axis_angle(up, 0.7 * f64::from(k));
            let corners = [(-3.0, -2.0), (3.0, -2.0), (0.0, 4.0)];
            let corners = corners.map(|(u, v)| turn * (x * u + y * v) + DVec3::new(0.3, 0.7, -0.2));
            add(&mut mesh, &corners, &[[0, 1, 2]]);
        }
        let mut case = Case::new(&mesh, light(0), image, 8);
        (case.camera.eye, case.camera.target) = ((up * 4.0 + x).as_vec3().into(), [0.3, 0.7, -0.2]);
        case.camera.vertical_fov_degrees = 15.0;
        let samples = pattern(count);
        let wanted = wanted_by(&case, &samples, strict);
        let found = find(gpu(), &case, &samples);
        let open = compare(&found, &wanted, &samples).unwrap_or_else(|text| panic!("{sheets} sheets: {text}"));
        assert!(open * 10 < wanted.len(), "{sheets} sheets: {open} of {} are open", wanted.len());
        let seen = |samples: &[Sample]| samples.iter().filter(|s| !s.open && s.triangle.is_some()).count();
        assert!(seen(&wanted) * 2 > wanted.len(), "{sheets} sheets: nothing to see");
        assert!(found.longest >= sheets, "{sheets} sheets: {} in a pixel", found.longest);
        let mut corrupted = wanted.clone();
        let other = corrupted.iter_mut().find(|s| !s.open && s.triangle.is_some()).expect("one is seen");
        other.triangle = other.triangle.map(|t| t ^ 1);
        assert!(compare(&found, &corrupted, &samples).is_err(), "{sheets} sheets: another triangle passes");
        assert!(find(gpu(), &case, &samples) == found, "{sheets} sheets: another result in a second run");
    }
}

/// Where what merging makes departs from what it should make of what the samples see, else how many facets are of several
/// triangles.
fn compare_merged(case: &Case, alone: &Found, found: &Found, samples: &Samples) -> Result<usize, String> {
    let view = case.view();
    let mesh = case.prepared.mesh();
    let depth = |t: u32| {
        let depths = mesh.corners(t as usize).map(|p| (p - view.eye).dot(view.rays.forward));
        depths.into_iter().fold(0.0, f64::max) * view.scale
    };
    let (mut facet, mut several) = (0, 0);
    for pixel in 0..alone.surfaces.len() {
        let seen = alone.samples(pixel, samples.count())?;
        let wanted = merged(&seen, &case.prepared.surfaces);
        if found.surfaces[pixel] != wanted {
            return Err(format!("pixel {pixel}: {:?}, {wanted:?}", found.surfaces[pixel]));
        }
        for (t, mask) in wanted {
            let own = seen.iter().enumerate().filter(|(_, s)| **s == Some(t)).fold(0u128, |m, (k, _)| m | 1 << k);
            let at = samples.offsets()[own.trailing_zeros() as usize].map(|o| o - 0.5);
            if found.origins[facet] != at {
                return Err(format!("facet {facet} at {:?}, {at:?}", found.origins[facet]));
            }
            if !is_span(found.spans[facet], samples, mask) {
                return Err(format!("facet {facet} of {mask:x} has another box: {:x?}", found.spans[facet]));
            }
            if found.reach[facet].is_some() != (own != mask) {
                return Err(format!("facet {facet}: {:?}", found.reach[facet]));
            }
            if let Some(reach) = found.reach[facet] {
                several += 1;
                let far = seen.iter().flatten().map(|&t| depth(t)).fold(0.0, f64::max);
                let near = (f64::from(reach) - far).abs() <= 1e-5 * far;
                if !near {
                    return Err(format!("facet {facet} reaches {reach}, {far}"));
                }
            }
            facet += 1;
        }
    }
    Ok(several)
}

/// Neighbouring triangles of one plane make one facet.
#[gpu_test]
fn one_plane_is_one_facet() {
    let boxes = ["cage", "windmill"].map(|name| builtin(name).expect("a scene"));
    let mut cases: Vec<Case> = [1, 7, 31].map(|n| Case::new(&square(n), light(0), [33, 29], 8)).into();
    cases.extend(boxes.iter().map(|scene| {
        let mut case = Case::new(&scene.mesh, light(0), [45, 37], 8);
        (case.camera, case.image) = (scene.camera, [25, 19]);
        case
    }));
    for (n, case) in cases.iter().enumerate() {
        let samples = pattern([8, 128, 32, 32, 64][n]);
        let alone = find(gpu(), case, &samples);
        let room = alone.needed.map(|n| n + 8);
        let most = alone.longest;
        let found = find_merged(gpu(), case, &samples, room, most);
        let several = compare_merged(case, &alone, &found, &samples).unwrap_or_else(|text| panic!("case {n}: {text}"));
        assert!(several > 8, "case {n}: {several} facets of several triangles");
        assert!(found.needed[2] < alone.needed[2] && found.id_keys == alone.id_keys, "case {n}");
        assert!(n > 2 || found.surfaces.iter().all(|s| s.len() <= 1), "one square, one facet");
    }
    // The comparison sees what is not merged, another triangle, another reach.
    let samples = pattern(32);
    let alone = find(gpu(), &cases[3], &samples);
    let found = find_merged(gpu(), &cases[3], &samples, alone.needed, alone.longest);
    let facet = found.reach.iter().position(Option::is_some).expect("a facet of several triangles");
    let broken = |change: &dyn Fn(&mut Found)| {
        let mut found = found.clone();
        change(&mut found);
        compare_merged(&cases[3], &alone, &found, &samples).is_err()
    };
    assert!(!broken(&|_| {}));
    assert!(broken(&|f| *f = alone.clone()), "nothing is merged");
    assert!(broken(&|f| f.reach[facet] = None), "not marked");
    assert!(broken(&|f| f.reach[facet] = f.reach[facet].map(|r| 0.999 * r)), "a shorter reach");
    assert!(broken(&|f| f.origins[facet][0] += 0.25), "another origin");
    assert!(broken(&|f| f.spans[facet] = alone.spans[0]), "another box");
}

/// Needs are counted in full, and nothing is written past the end (see `find_within`).
#[gpu_test]
fn overflow_by_one() {
    let case = Case::new(&mesh("closed balls", 3), light(0), [31, 23], 8);
    let samples = pattern(32);
    let all = find(gpu(), &case, &samples);
    for list in 0..3 {
        for room in [0, 1, all.needed[list] - 1, all.needed[list], all.needed[list] + 1] {
            let mut rooms = all.needed;
            rooms[list] = room;
            let found = find_within(gpu(), &case, &samples, rooms, 1);
            assert_eq!(found.needed[list], all.needed[list], "list {list}, room {room}");
            // A triangle that is not listed may be one that no sample sees.
            let same = found.surfaces == all.surfaces;
            assert!(same == (room >= all.needed[list]) || (same && list == 0), "list {list}, room {room}");
        }
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(24, 1 << 24);
    let mut dense = Mesh::default();
    ball(&mut dense, DVec3::ZERO, 1.0, 30, 20);
    let case = Case::new(&dense, light(0), [60, 40], 8);
    let found = check(&small, &case, 32, 0.15);
    assert!(found == find(gpu(), &case, &pattern(32)), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [49, 37], 8);
    let samples = pattern(32);
    let found = check(gpu(), &case, 32, 0.06);
    assert!(found == find(gpu(), &case, &samples), "another result in a second run");
    let wanted = wanted(&case, &samples);
    let several = found.surfaces.iter().position(|s| s.len() > 1).expect("a pixel of several surfaces");
    let broken = |change: &dyn Fn(&mut Found)| {
        let mut found = found.clone();
        change(&mut found);
        compare(&found, &wanted, &samples).is_err()
    };
    assert!(!broken(&|_| {}));
    assert!(broken(&|f| f.surfaces[several][0].1 |= f.surfaces[several][1].1), "a sample in two facets");
    assert!(broken(&|f| f.surfaces[several].swap(0, 1)), "the order");
    assert!(broken(&|f| f.surfaces[several].truncate(1)), "a facet is missing");
    assert!(broken(&|f| f.surfaces[several][0].0 += 1), "another triangle");
    assert!(broken(&|f| f.origins[0][0] += 0.25), "another origin");
    assert!(broken(&|f| f.spans[0][1] -= 20), "a narrower box");
    assert!(broken(&|f| f.id_keys[several] ^= 1), "another centre");
    assert!(broken(&|f| drop(f.surfaces.pop())), "a pixel is missing");
}

/// Backs of closed bodies are listed nowhere, and samples see what they see with them, but at silhouettes within rounding; from
/// inside a body, and of a mesh that is open, something is missing.
#[gpu_test]
fn hidden_backs_are_not_seen() {
    let scene = builtin("windmill").expect("a scene");
    let mut cases = vec![Case { camera: scene.camera, ..Case::new(&scene.mesh, light(0), [200, 150], 8) }];
    cases.extend((0..3).map(|seed| Case::new(&mesh("closed balls", seed), light(seed), [61, 45], 8)));
    for (n, case) in cases.iter().enumerate() {
        let samples = pattern([32, 128, 32, 8][n]);
        let with = find(gpu(), case, &samples);
        let hidden = Case { backs_hidden: true, ..case.clone() };
        let found = find(gpu(), &hidden, &samples);
        let wanted = wanted(case, &samples);
        let open = compare(&found, &wanted, &samples).unwrap_or_else(|text| panic!("case {n}: {text}"));
        assert!(open * 10 < wanted.len(), "case {n}: {open} of {} are open", wanted.len());
        assert!(
            found.needed[0] * 10 < with.needed[0] * 8,
            "case {n}: {} of {} listed",
            found.needed[0],
            with.needed[0]
        );
        let view = case.view();
        for &t in found.lists.iter().flatten().filter(|&&t| case.prepared.bodies[t as usize]) {
            let [a, b, c] = case.prepared.mesh().corners(t as usize).map(|p| p - view.eye);
            let facing = (b - a).cross(c - a).dot(-a);
            let (ab, ac, reach) = ((b - a).length(), (c - a).length(), a.length().max(b.length()).max(c.length()));
            let doubt = 4.0 * a.length() * (2e-6 * ab * ac + 6e-7 * reach * (ab + ac));
            assert!(facing > -doubt, "case {n}: triangle {t} faces away by {facing}");
        }
    }
    // From inside a ball all of it faces away.
    let mut case = cases.swap_remove(1);
    let inside = case.prepared.mesh().corners(0).iter().sum::<DVec3>() / 3.0;
    let normal = case.prepared.mesh().corners(0);
    let normal = (normal[1] - normal[0]).cross(normal[2] - normal[0]).normalize();
    case.camera.eye = (inside - 0.05 * normal).as_vec3().into();
    case.camera.target = inside.as_vec3().into();
    (case.camera.near, case.camera.up) = (1e-4, normal.any_orthonormal_vector().as_vec3().into());
    let samples = pattern(32);
    let wanted = wanted(&case, &samples);
    compare(&find(gpu(), &case, &samples), &wanted, &samples).expect("seen from inside");
    assert!(compare(&find(gpu(), &Case { backs_hidden: true, ..case }, &samples), &wanted, &samples).is_err());
}
