//! Facing, rectangles and work items of triangles, against `f64`. Facing equals wherever the exact side exceeds the
//! kernel's doubt; rectangles hold the exact ones and exceed them by at most a cell; items are the blocks exactly.

use crate::support::geometry::{
    Case, MESHES, Place, Ran, add, ball, fan, light, mesh, run_all, set_up_in_turn, unpack, with_what_turns_away,
};
use crate::support::{Random, difference, gpu, sizes_around, small_gpu};
use oracle::reference::requested_blocks::requested_part;
use oracle::reference::triangle_setup::{Reach, side_doubt};
use oracle::reference::view::block_count;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::geometry::SetupOf;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::triangle_setup::{BACK, DROPPED, FRONT, UNSURE};
use test_support::gpu_test;

/// Coordinates above which slack grows beyond a cell.
const FAR_OUT: f64 = 3e5;

fn fault(case: &Case, ran: &Ran) -> Option<String> {
    let wanted = case.wanted();
    let n = wanted.triangles.len();
    if [ran.facing.len(), ran.camera_rects.len(), ran.light_rects.len()] != [n; 3] {
        return Some("another number of triangles".to_owned());
    }
    for (items, rects) in [(&ran.camera_items, &ran.camera_rects), (&ran.light_items, &ran.light_rects)] {
        let blocks: Vec<u32> = rects.iter().map(|&r| block_count(unpack(r))).collect();
        if let Some(text) = difference(items, &blocks) {
            return Some(format!("items: {text}"));
        }
    }
    let margin = f64::from(ran.frame.map_margin);
    for (t, triangle) in wanted.triangles.iter().enumerate() {
        let (facing, in_camera, in_light) = (ran.facing[t], unpack(ran.camera_rects[t]), unpack(ran.light_rects[t]));
        let Some(corners) = triangle.corners else {
            if facing != DROPPED || in_camera.is_some() || in_light.is_some() {
                return Some(format!("triangle {t} is none, and not dropped"));
            }
            continue;
        };
        let doubt = side_doubt(&wanted.view, corners);
        let right = match facing {
            FRONT => triangle.side > 0.0,
            BACK => triangle.side < 0.0,
            UNSURE => triangle.side.abs() <= 1.01 * doubt,
            _ => false,
        };
        if !right {
            return Some(format!("triangle {t} has facing {facing}, its side is {}, doubt {doubt}", triangle.side));
        }
        let extent = triangle.image.map_or(0.0, |(lo, hi)| lo.abs().max(hi.abs()).max_element());
        if let Some(text) = misfit(in_camera, triangle.pixels(case.image), extent) {
            return Some(format!("pixels of triangle {t}: {text}"));
        }
        // The kernel culls by its own decision, which may be unsure.
        if case.cull_back && case.prepared.bodies[t] && (facing == BACK) != (triangle.side < 0.0) {
            continue;
        }
        let extent = match triangle.map {
            Reach::Flat(flat) => flat.bounds().0.abs().max(flat.bounds().1.abs()).max_element(),
            _ => 0.0,
        };
        // What reaches behind the light is taken for everywhere unless it lies well beyond one side.
        let extent = if matches!(triangle.map, Reach::Flat(_)) { extent } else { f64::INFINITY };
        let exact = triangle.texels(case.map, 0.0);
        let grown = triangle.texels(case.map, 2.0 * margin);
        let holds = |a: [u32; 4], b: [u32; 4]| a[0] <= b[0] && a[1] <= b[1] && a[2] >= b[2] && a[3] >= b[3];
        let fits = match (exact, in_light, grown) {
            (Some(exact), Some(got), Some(grown)) => holds(got, exact) && (holds(grown, got) || extent > FAR_OUT),
            (None, Some(got), Some(grown)) => holds(grown, got) || extent > FAR_OUT,
            (Some(_), None, _) => false,
            (None, Some(_), None) => extent > FAR_OUT,
            (None, None, _) => true,
            (Some(_), Some(_), None) => false,
        };
        if !fits {
            return Some(format!("texels of triangle {t}: {in_light:?}, {exact:?} to {grown:?} expected"));
        }
    }
    None
}

/// How a rectangle fails to hold the exact one, or exceeds it by more than a cell.
fn misfit(got: Option<[u32; 4]>, exact: Option<[u32; 4]>, extent: f64) -> Option<String> {
    let text = || Some(format!("{got:?}, {exact:?} expected"));
    match (got, exact) {
        (None, Some(_)) => text(),
        (Some(g), Some(e)) => {
            let holds = g[0] <= e[0] && g[1] <= e[1] && g[2] >= e[2] && g[3] >= e[3];
            let near = (0..4).all(|k| g[k].abs_diff(e[k]) <= 1);
            if holds && (near || extent > FAR_OUT) { None } else { text() }
        }
        // Between two centres, or just outside: a cell's width or height at most.
        (Some(g), None) if g[2] - g[0] > 2 && g[3] - g[1] > 2 && extent <= FAR_OUT => text(),
        _ => None,
    }
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Ran {
    let ran = run_all(gpu, case);
    if let Some(text) = fault(case, &ran) {
        panic!("{:?}, map {}, image {:?}: {text}", case.light, case.map, case.image);
    }
    ran
}

#[gpu_test]
fn empty() {
    check(gpu(), &Case::new(&Mesh::default(), light(0), [1, 1], 1));
    // Triangles that are none.
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 0, 1], [2, 2, 2], [1, 0, 1]]);
    assert_eq!(check(gpu(), &Case::new(&mesh, light(0), [8, 8], 8)).facing, [DROPPED; 3]);
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 2, 1]]);
    for k in 0..6 {
        assert_eq!(check(gpu(), &Case::new(&mesh, light(k), [7, 5], 8)).facing, [FRONT]);
    }
    mesh.triangles[0].reverse();
    assert_eq!(check(gpu(), &Case::new(&mesh, light(0), [1, 1], 1)).facing, [BACK]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(count as u64), [17, 9], 33));
    }
}

#[gpu_test]
fn random_seeded() {
    for (k, name) in MESHES.iter().enumerate() {
        for (seed, map) in [1, 3, 8, 33, 512].into_iter().enumerate() {
            let mut case = Case::new(
                &mesh(name, seed as u64),
                light(seed as u64 + k as u64),
                [31 * (seed as u32) + 1, 17 * (seed as u32) + 1],
                map,
            );
            case.cull_back = seed % 2 == 1;
            check(gpu(), &case);
        }
    }
    check(gpu(), &Case::new(&mesh("closed balls", 9), light(1), [800, 600], 4096));
}

#[gpu_test]
fn degenerate() {
    // Edge-on, collinear, no area, far away, through the near planes, behind everything.
    let mut mesh = Mesh::default();
    let mut r = Place(Random::new(5));
    let (o, y) = (DVec3::ZERO, DVec3::Y);
    add(
        &mut mesh,
        &[o, y, DVec3::new(0.5, 0.5, 0.0), y * 0.5, y * 2.0, DVec3::new(1e-7, 1.0, 0.0)],
        &[[0, 1, 2], [0, 3, 1], [3, 1, 4], [0, 1, 5]],
    );
    for k in 0..20 {
        let size = 10f64.powi(k % 7);
        let (a, b) = (r.point() * size, r.point() * size);
        add(&mut mesh, &[r.point() * 0.5, a, b], &[[0, 1, 2]]);
        add(&mut mesh, &[r.point(), r.point() - DVec3::Z * size, r.point() + DVec3::Z * size], &[[0, 1, 2]]);
    }
    for (k, lit) in
        [Light::Directional { direction: [0.0, 1.0, 0.0] }, Light::Point { position: [0.4, 0.7, 0.2] }, light(1)]
            .into_iter()
            .enumerate()
    {
        let mut case = Case::new(&mesh, lit, [33, 65], 33);
        (case.camera.eye, case.camera.target) = ([0.3, 0.2, 0.1 * k as f32], [0.5, -0.4, -3.0]);
        for near in [1e-1, 1e-4] {
            (case.camera.near, case.camera.far) = (near, 1e9);
            let ran = check(gpu(), &case);
            assert!(k != 0 || ran.facing.contains(&UNSURE), "a triangle edge-on to the light is unsure");
        }
    }
    // A vertex that is no number takes its triangles with it.
    let mut case = Case::new(&mesh_of_ball(), light(0), [33, 33], 33);
    let mut positions = case.prepared.mesh().positions.clone();
    positions[4][1] = f32::NAN;
    case.positions = Some(positions);
    let ran = check(gpu(), &case);
    for (t, triangle) in case.prepared.mesh().triangles.iter().enumerate() {
        assert_eq!(triangle.contains(&4), ran.facing[t] == DROPPED);
    }
}

fn mesh_of_ball() -> Mesh {
    let mut mesh = Mesh::default();
    ball(&mut mesh, DVec3::ZERO, 0.8, 9, 8);
    mesh
}

/// A caster that turns away and may cut a facet keeps its texels; one that cannot has none.
#[gpu_test]
fn what_turns_away() {
    let [with_all, culled, cutting] = with_what_turns_away(gpu(), 3);
    let texels = |ran: &Ran| ran.light_items.iter().filter(|&&items| items > 0).count();
    assert_eq!(cutting.light_rects, with_all.light_rects);
    assert!(texels(&culled) < texels(&with_all), "nothing turns away");
    for t in 0..culled.facing.len() {
        assert!(
            culled.light_rects[t] == with_all.light_rects[t] || culled.facing[t] == BACK && culled.light_items[t] == 0
        );
    }
}

/// A strip of rows has of each rectangle of pixels what lies in it.
#[gpu_test]
fn a_strip_of_rows() {
    for (seed, name) in (0..).zip(MESHES) {
        let case = Case::new(&mesh(name, seed), light(seed), [37, 41], 16);
        let (frame, whole) = (case.frame(), run_all(gpu(), &case));
        let (points, count) = (4 * whole.points.len(), whole.facing.len());
        let mut cut = 0;
        for [first, rows] in [[0, 7], [7, 20], [27, 14], [40, 1]] {
            let strip = Frame { image_size: [37, rows], first_row: first, ..frame };
            let got = &set_up_in_turn(gpu(), &case, &[(SetupOf::Both, strip)])[0][points..];
            for (t, &rect) in whole.camera_rects.iter().enumerate() {
                let wanted = unpack(rect).and_then(|[left, top, right, bottom]| {
                    let (top, bottom) = (top.max(first), bottom.min(first + rows - 1));
                    (top <= bottom).then(|| [left, top - first, right, bottom - first])
                });
                assert_eq!(unpack([got[2 * t], got[2 * t + 1]]), wanted, "{name}, triangle {t}, rows from {first}");
                assert_eq!(got[2 * count + t], block_count(wanted), "{name}, triangle {t}, rows from {first}");
                cut += u32::from(wanted.is_some() && wanted != unpack(rect));
            }
        }
        assert!(cut > 0, "{name}: no rectangle is cut");
    }
}

/// The part of a view that stands is left as it is, and the other view's part is that of a frame of its own.
#[gpu_test]
fn one_view_alone() {
    for (seed, name) in (0..).zip(MESHES) {
        let case = Case::new(&mesh(name, seed), light(seed), [33, 17], 40);
        let mut from_elsewhere = case.clone();
        from_elsewhere.camera.eye = case.camera.eye.map(|c| 1.5 * c + 0.25);
        let mut other_light = case.clone();
        other_light.light = light(seed + 1);
        let [here, there, lit] = [&case, &from_elsewhere, &other_light].map(Case::frame);
        let [of_here, of_there, of_lit] = [(&case, here), (&from_elsewhere, there), (&other_light, lit)]
            .map(|(c, f)| set_up_in_turn(gpu(), c, &[(SetupOf::Both, f)]));
        assert!(of_here[0] != of_there[0] && of_here[1] != of_lit[1], "{name}: nothing differs");
        let first = (SetupOf::Both, here);
        let camera_alone = set_up_in_turn(gpu(), &case, &[first, (SetupOf::Camera, there)]);
        assert!(camera_alone == [of_there[0].clone(), of_here[1].clone()], "{name}: the camera's part alone");
        let light_alone = set_up_in_turn(gpu(), &case, &[first, (SetupOf::Light, lit)]);
        assert!(light_alone == [of_here[0].clone(), of_lit[1].clone()], "{name}: the light's part alone");
    }
}

/// Of texels a triangle keeps the least rectangle of requested blocks, of a large one all, and of the camera's view everything.
#[gpu_test]
fn what_is_requested() {
    let (mut cut, mut gone, mut large) = (0, 0, 0);
    for (seed, name) in (0..).zip(MESHES) {
        for (map, share) in [(40, 2), (300, 3), (520, 10), (700, 40)] {
            let whole = Case::new(&mesh(name, seed), light(seed), [33, 17], map);
            let mut random = Random::new(u64::from(map) + seed);
            let blocks: Vec<bool> = (0..map.div_ceil(8).pow(2)).map(|_| random.below(share) == 0).collect();
            let case = Case { requested: Some(blocks.clone()), ..whole.clone() };
            let (all, part) = (run_all(gpu(), &whole), run_all(gpu(), &case));
            assert!(all.camera_rects == part.camera_rects && all.facing == part.facing, "{name}");
            for (t, (&of_all, &of_part)) in all.light_rects.iter().zip(&part.light_rects).enumerate() {
                let (of_all, of_part) = (unpack(of_all), unpack(of_part));
                let wanted = of_all.and_then(|rect| requested_part(rect, &blocks, map));
                let words = |r: [u32; 4]| (r[2] / 256 - r[0] / 256 + 1) * (r[3] / 8 - r[1] / 8 + 1);
                let whole = of_all.is_some_and(|r| words(r) > 64);
                assert_eq!(of_part, if whole { of_all } else { wanted }, "{name}, {map} texels, triangle {t}");
                assert_eq!(part.light_items[t], block_count(of_part), "{name}, {map} texels, triangle {t}");
                cut += u32::from(of_part.is_some() && of_part != of_all);
                gone += u32::from(of_part.is_none() && of_all.is_some());
                large += u32::from(whole);
            }
        }
    }
    assert!(cut > 300 && gone > 300 && large > 5, "{cut} cut, {gone} gone, {large} large");
}

/// The stage has no list: nothing is written past the last triangle (see `run_all`). An index past the last vertex
/// drops its triangle.
#[gpu_test]
fn overflow_by_one() {
    let case = Case::new(&mesh_of_ball(), light(0), [33, 33], 33);
    let mut cut = case.clone();
    let mut positions = cut.prepared.mesh().positions.clone();
    let gone = positions.len() as u32 - 1;
    positions.pop();
    cut.positions = Some(positions);
    // Edges keep their vertices: only the first two stages look at what is cut.
    cut.prepared.edges.retain(|e| e.v0 != gone && e.v1 != gone);
    let ran = check(gpu(), &cut);
    for (t, triangle) in case.prepared.mesh().triangles.iter().enumerate() {
        assert_eq!(triangle.contains(&gone), ran.facing[t] == DROPPED);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(20, 1 << 20);
    let mut mesh = Mesh::default();
    fan(&mut mesh, 64 * 27 + 5);
    let case = Case::new(&mesh, light(1), [9, 9], 33);
    assert!(check(&small, &case).words() == run_all(gpu(), &case).words(), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh_of_ball(), light(1), [64, 64], 64);
    let ran = check(gpu(), &case);
    assert!(ran.words() == run_all(gpu(), &case).words(), "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&case, &off).is_some()
    };
    let front = ran.facing.iter().position(|&f| f == FRONT).expect("one faces the light");
    assert!(spoilt(&|r| r.facing[front] = BACK));
    assert!(spoilt(&|r| r.facing[front] = UNSURE));
    assert!(spoilt(&|r| r.light_items[front] += 1));
    assert!(spoilt(&|r| r.camera_rects[9][1] -= 0x2_0002));
    assert!(spoilt(&|r| r.light_rects[9][0] += 0x2_0002));
    assert!(spoilt(&|r| r.facing.truncate(1)));
}
