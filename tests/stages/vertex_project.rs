//! Vertices in the frame and in the light view, against `f64`: points are the correctly rounded difference times a power
//! of two, map points lie within the frame's margins.

use crate::support::geometry::{Case, MESHES, Place, Ran, add, ball, light, mesh, run_all};
use crate::support::{Random, difference, gpu, sizes_around, small_gpu};
use subpixel_shadows::glam::{DVec3, DVec4, Vec4};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::{Light, Mesh};
use test_support::gpu_test;

/// Where the stage departs from its definition.
fn fault(case: &Case, ran: &Ran) -> Option<String> {
    let wanted = case.wanted();
    if ran.points.len() != wanted.vertices.len() || ran.map_points.len() != wanted.vertices.len() {
        return Some("another number of vertices".to_owned());
    }
    let points: Vec<_> =
        wanted.vertices.iter().map(|v| v.point.map_or([0.0; 4], |p| p.as_vec3().extend(1.0).into())).collect();
    if let Some(text) = difference(&ran.points, &points) {
        return Some(text);
    }
    let f = &ran.frame;
    for (v, vertex) in wanted.vertices.iter().enumerate() {
        let got = Vec4::from(ran.map_points[v]).as_dvec4();
        let Some(map) = vertex.map else {
            let (map, Some(p)) = (&wanted.view.map, vertex.point.filter(|_| wanted.view.map.perspective)) else {
                if got != DVec4::ZERO {
                    return Some(format!("vertex {v} at {got}, none expected"));
                }
                continue;
            };
            // Seen from so far away it is no number.
            let lamp = map.lamp.map_or(0.0, |lamp| lamp.abs().max_element());
            if got == DVec4::ZERO && [map.u, map.v, map.z].iter().any(|row| row.abs().max_element() * lamp > 1e37) {
                continue;
            }
            // The near plane itself may go either way.
            let p = p.extend(1.0);
            let short = map.w.dot(p) - map.near;
            let raw = DVec4::new(map.u.dot(p), map.v.dot(p), map.z.dot(p), short.min(0.0));
            let rows = [map.u, map.v, map.z, map.w].map(|row| 1e-6 * (row.abs().dot(p.abs()) + map.near));
            let off = (got - raw).abs();
            if (0..4).any(|k| off[k] > rows[k]) && short.abs() > 1e-3 * map.near {
                return Some(format!("vertex {v} at {got}, {raw} expected before the division"));
            }
            continue;
        };
        if got == DVec4::ZERO && map.w > 1e30 {
            continue;
        }
        let off = (got - map).abs();
        let row = wanted.view.map.w.abs();
        let reach = 1e-6 * map.truncate().truncate().abs().max_element();
        let texels = f64::from(f.map_margin) + reach;
        let depth = f64::from(f.depth_margin) * (1.0 + map.z.abs());
        if !(off.x <= texels
            && off.y <= texels
            && off.z <= depth
            && off.w <= 1e-6 * (map.w + row.x + row.y + row.z + row.w))
        {
            return Some(format!("vertex {v} at {got}, {map} expected, margins {texels} {depth}"));
        }
    }
    None
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Ran {
    let ran = run_all(gpu, case);
    assert_eq!(fault(case, &ran), None);
    ran
}

fn cloud(count: usize, at: DVec3, size: f64) -> Mesh {
    let mut r = Place(Random::new(count as u64));
    let mut mesh = Mesh::default();
    let points: Vec<DVec3> = (0..count).map(|_| at + r.point() * size).collect();
    // Every vertex must be used, or it is dropped from the canonical mesh.
    let triangles: Vec<[u32; 3]> =
        (0..count as u32).map(|v| [v, (v + 1) % count as u32, (v + 2) % count as u32]).collect();
    add(&mut mesh, &points, &triangles);
    mesh
}

#[gpu_test]
fn empty() {
    for k in 0..3 {
        check(gpu(), &Case::new(&Mesh::default(), light(k), [1, 1], 1));
    }
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ONE], &[[0, 0, 0]]);
    for k in 0..3 {
        assert_eq!(check(gpu(), &Case::new(&mesh, light(k), [3, 1], 1)).points.len(), 1);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for count in sizes_around(64) {
        check(gpu(), &Case::new(&cloud(count, DVec3::ZERO, 1.0), light(count as u64), [2, 2], 3));
    }
}

#[gpu_test]
fn random_seeded() {
    for (k, name) in MESHES.iter().enumerate() {
        for seed in 0..3 {
            check(gpu(), &Case::new(&mesh(name, seed), light(seed + k as u64), [8, 6], 33));
        }
    }
    // Far from the origin, large and small.
    for (k, (at, size)) in
        [(1e3, 1.0), (1e5, 1.0), (1e6, 10.0), (0.0, 1e-6), (0.0, 1e9), (-4096.0, 0.125)].into_iter().enumerate()
    {
        let lit = if k % 2 == 0 {
            light(0)
        } else {
            Light::Point { position: [at as f32 + 3.0 * size as f32, at as f32 + 4.0 * size as f32, at as f32] }
        };
        check(gpu(), &Case::new(&cloud(200, DVec3::splat(at), size), lit, [8, 6], 512));
    }
}

#[gpu_test]
fn degenerate() {
    // No number, or none that can be scaled: dropped, and its neighbours are not.
    let mut case = Case::new(&cloud(70, DVec3::ZERO, 1.0), light(1), [8, 6], 33);
    let mut positions = case.prepared.mesh().positions.clone();
    for (v, bad) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -f32::NAN].into_iter().enumerate() {
        positions[7 * v][v % 3] = bad;
    }
    positions[40] = [f32::MAX, f32::MIN, f32::MAX];
    positions[41] = [-0.0, 1e-42, 0.0];
    case.positions = Some(positions);
    let ran = check(gpu(), &case);
    assert!([0, 7, 14, 21].iter().all(|&v| ran.points[v] == [0.0; 4]), "not dropped");
    assert!(ran.points[41][3] == 1.0 && ran.points[1][3] == 1.0);
    // Behind the camera and behind the light.
    let mut mesh = Mesh::default();
    ball(&mut mesh, DVec3::ZERO, 1.0, 9, 7);
    add(
        &mut mesh,
        &[DVec3::new(0.0, -1.0, -90.0), DVec3::new(90.0, -1.0, 90.0), DVec3::new(-90.0, -1.0, 90.0)],
        &[[0, 1, 2]],
    );
    let lit = Light::Point { position: [0.3, 0.5, 0.9] };
    let mut case = Case::new(&mesh, lit, [8, 6], 33);
    (case.camera.eye, case.camera.target) = ([0.2, 0.1, 0.0], [0.0, 0.3, -5.0]);
    let ran = check(gpu(), &case);
    assert!(ran.map_points.iter().any(|p| p[3] <= 0.0), "one lies behind the light");
}

/// The stage has no list: nothing is written past the last vertex (see `run_all`), and a frame that counts fewer
/// vertices than there are leaves the others alone.
#[gpu_test]
fn overflow_by_one() {
    for count in [63, 64, 65, 127, 128, 129] {
        check(gpu(), &Case::new(&cloud(count, DVec3::ZERO, 1.0), light(0), [2, 2], 3));
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(20, 1 << 20);
    for count in [64 * 20, 64 * 20 + 1, 64 * 27 + 5] {
        let case = Case::new(&cloud(count, DVec3::ZERO, 1.0), light(1), [2, 2], 3);
        let ran = check(&small, &case);
        assert!(ran.words() == run_all(gpu(), &case).words(), "the fold changes the result");
    }
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&cloud(70, DVec3::ZERO, 1.0), light(1), [2, 2], 33);
    let ran = check(gpu(), &case);
    assert!(ran.words() == run_all(gpu(), &case).words(), "another result in a second run");
    let mut off = ran.clone();
    off.points[50][1] = off.points[50][1].next_up();
    assert!(fault(&case, &off).is_some());
    let mut off = ran.clone();
    off.map_points[50][0] += 2.5 * off.frame.map_margin;
    assert!(fault(&case, &off).is_some());
    let mut off = ran.clone();
    off.points.pop();
    assert!(fault(&case, &off).is_some());
}
