//! Between which depths pixels see triangles, against `f64`.

use crate::support::shadow::{World, above, folding_gpu, looked_down_on as world, random_scene, uniform};
use crate::support::{Random, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::seen_depths::{depth, range};
use subpixel_shadows::glam::DVec2;
use subpixel_shadows::scene::Mesh;
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::seen_depths::SeenDepths;
use subpixel_shadows::status::{Status, StatusBand};
use test_support::gpu_test;

/// The depths that the stage finds where pixels see these triangles, and whether it left all else of the counters alone.
fn gather(world: &World, seen: &[Option<u32>]) -> Option<[f32; 2]> {
    let gpu = world.gpu;
    let id_keys = upload(gpu, &seen.iter().map(|t| t.map_or(0, |t| !t)).collect::<Vec<_>>());
    let (frame, samples, points) = (uniform(gpu, &world.frame), world.sample_offsets(), world.points());
    let mut before = Status { bands: vec![StatusBand::default()], ..Status::default() };
    before.head.silhouette_edges = 7;
    before.head.facets_needed.items = 9;
    let status = upload(gpu, &before.to_words());
    let stage = SeenDepths::new(&gpu.device);
    let from =
        PrimaryHits { samples: &samples, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
    run(gpu, |s| stage.record(s, &frame, from, &status, seen.len() as u64));
    let mut after = Status::of(&status.read(gpu).expect("readback")[..Status::words(1)]);
    let found = after.depths();
    (after.head.nearest_key, after.head.farthest_depth) = (0, 0);
    assert_eq!(after, before, "other counters changed");
    found
}

fn seen(world: &World) -> Vec<Option<u32>> {
    world.seen().into_iter().map(|(_, t)| t).collect()
}

/// Where the result departs from the definition.
fn fault(world: &World, seen: &[Option<u32>], found: Option<[f32; 2]>) -> Option<String> {
    let forward = world.view.rays.forward;
    let at = |(pixel, t): (usize, &Option<u32>)| {
        let corners = world.triangles[(*t)? as usize].corners?;
        let ray = pixel_ray(&world.view, pixel as u32, DVec2::ZERO);
        let (depth, doubt) = depth(corners, ray / ray.dot(forward), forward)?;
        let scale = f64::from(world.frame.eye[3]);
        Some((depth / scale, doubt / scale))
    };
    match (found, range(seen.iter().enumerate().filter_map(at))) {
        (None, None) => None,
        (Some(found), Some(bounds)) => {
            let within = |k: usize| (bounds[k][0]..=bounds[k][1]).contains(&f64::from(found[k]));
            (!within(0) || !within(1)).then(|| format!("{found:?}, between {bounds:?} expected"))
        }
        (found, bounds) => Some(format!("{found:?}, {bounds:?} expected")),
    }
}

#[track_caller]
fn check(world: &World) -> Option<[f32; 2]> {
    let seen = seen(world);
    let found = gather(world, &seen);
    if let Some(text) = fault(world, &seen, found) {
        panic!("{text}");
    }
    found
}

#[gpu_test]
fn empty() {
    assert_eq!(check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 1)), None);
    let world = world(gpu(), &random_scene(1, &mut Random::new(5)), above(), [3, 2], 8, 1);
    assert_eq!(gather(&world, &[None; 6]), None);
}

#[gpu_test]
fn one() {
    let world = world(gpu(), &random_scene(1, &mut Random::new(5)), above(), [1, 1], 8, 1);
    let found = check(&world).expect("something is seen");
    assert_eq!(found[0], found[1]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 8, 1));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..8 {
        let mesh = random_scene(kind, &mut random);
        let found = check(&world(gpu(), &mesh, above(), [60, 45], 8, 1)).expect("something is seen");
        assert!(found[0] < found[1], "{found:?}");
    }
}

/// A triangle that is seen edge-on, and numbers of no triangle.
#[gpu_test]
fn degenerate() {
    let mut mesh = random_scene(1, &mut Random::new(51));
    let first = mesh.positions.len() as u32;
    let eye = [0.8f32, 2.2, 4.0];
    let towards = |t: f32| eye.map(|c| c * (1.0 - t));
    mesh.positions.extend([eye, towards(0.5), towards(0.9)]);
    mesh.triangles.push([first, first + 1, first + 2]);
    let world = world(gpu(), &mesh, above(), [16, 12], 8, 1);
    let count = world.triangles.len() as u32;
    let mut ids = seen(&world);
    let plain = gather(&world, &ids);
    assert!(plain.is_some());
    // Receivers behind the casters, and beyond.
    ids[3] = Some(count);
    ids[5] = Some(count + 77);
    let others: Vec<Option<u32>> = ids.iter().map(|t| t.filter(|t| *t < count)).collect();
    assert_eq!(gather(&world, &ids), gather(&world, &others));
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(61));
    check(&world(gpu(), &mesh, above(), [257, 256], 8, 1));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(71));
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 8, 1));
    assert_eq!(of(folding_gpu()), of(gpu()));
}

#[gpu_test]
fn detects_corruption() {
    let world = world(gpu(), &random_scene(1, &mut Random::new(81)), above(), [48, 36], 8, 1);
    let seen = seen(&world);
    let found = check(&world);
    assert_eq!(found, gather(&world, &seen), "another result in a second run");
    let [near, far] = found.expect("something is seen");
    for off in [None, Some([far, near]), Some([1.01 * near, far]), Some([near, 0.99 * far]), Some([0.99 * near, far])] {
        assert!(fault(&world, &seen, off).is_some(), "{off:?} passes for {found:?}");
    }
}
