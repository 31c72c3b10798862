//! Texels of paraboloid views against the rays of their centres in `f64`: where no edge passes a centre within rounding, depths agree. So do those of
//! the stages that ask such a map, in their own tests.

use crate::support::depth_map::curved_keys;
use crate::support::pages::ten_a_row;
use crate::support::shadow::{World, add_triangle, camera, random_light, random_scene, samples, sheet};
use crate::support::{Random, gpu, sizes_around};
use oracle::reference::paraboloid_casters::{CurvedTexel, texels};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::{Light, Mesh};
use test_support::gpu_test;

const WITHIN: Light = Light::Point { position: [0.1, 0.6, 0.2] };
const ABOVE: Light = Light::Point { position: [0.4, 5.0, 0.3] };

fn world(gpu: &'static Gpu, mesh: &Mesh, light: Light, map: u32, k: usize) -> World {
    let camera = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    World::in_paraboloid(gpu, mesh, (camera, light), [16, 12], map, samples(1), k)
}

fn wanted(world: &World) -> Vec<CurvedTexel> {
    let corners: Vec<Option<[DVec3; 3]>> = world.triangles.iter().map(|t| t.corners).collect();
    texels(&world.view, &corners)
}

/// Where the stage departs from its definition; how many texels were compared, and how many of them covered.
fn fault(wanted: &[CurvedTexel], keys: &[u32]) -> Result<[usize; 2], String> {
    let (mut compared, mut covered) = (0, 0);
    for (texel, (&key, wanted)) in keys.iter().zip(wanted).enumerate().filter(|(_, (_, w))| !w.open) {
        let found = (key != 0).then(|| f64::from(f32::from_bits(!key)));
        compared += 1;
        covered += usize::from(found.is_some());
        // Along a plane that the ray grazes depth changes the more.
        let doubt = 2e-6 + 1e-5 / wanted.cosine.max(1e-6);
        let near = match (found, wanted.nearest) {
            (Some(a), Some(b)) => (a - b).abs() <= doubt,
            (a, b) => a == b,
        };
        if !near {
            return Err(format!("texel {texel}: {found:?}, {wanted:?} expected within {doubt}"));
        }
    }
    Ok([compared, covered])
}

#[track_caller]
fn check(world: &World) -> Vec<u32> {
    let keys = curved_keys(world);
    match fault(&wanted(world), &keys) {
        Ok([compared, _]) => assert!(compared * 10 >= keys.len() * 6, "{compared} of {} texels compared", keys.len()),
        Err(text) => panic!("{:?}: {text}", world.light),
    }
    keys
}

#[gpu_test]
fn empty() {
    let keys = check(&world(gpu(), &Mesh::default(), ABOVE, 64, 0));
    assert!(keys.iter().all(|&key| key == 0));
}

/// Large triangles, whose edges are bent most: a floor, and one that the ray against the axis meets.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    for k in 0..2 {
        let world = world(gpu(), &mesh, WITHIN, 100, k);
        let covered = check(&world).into_iter().filter(|&key| key != 0).count();
        assert!(covered > 1000, "view {k}: {covered}");
        assert!(wanted(&world).iter().filter(|t| t.nearest.is_some()).count() > 1000);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for triangles in sizes_around(64) {
        let mesh = crate::support::meshes::soup(triangles, 0.4, &mut Random::new(triangles as u64));
        check(&world(gpu(), &mesh, ABOVE, 70, 0));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(97);
    for kind in 0..4 {
        for k in 0..4 {
            let mesh = random_scene(kind, &mut random);
            let light = if k < 2 { random_light(false, &mut random) } else { WITHIN };
            check(&world(gpu(), &mesh, light, [64, 150][k % 2], k % 2));
        }
    }
}

/// A light next to a triangle, on its plane, at a corner of it, and triangles of no area.
#[gpu_test]
fn degenerate() {
    let mut mesh = sheet(3, 4.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-9.0, 0.5, -9.0], [9.0, 4.0, -9.0], [0.0, 0.5, 9.0]]);
    add_triangle(&mut mesh, [[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [1.0, 3.0, 0.0]]);
    for position in [[0.3, 0.001, 0.2], [2.0, 0.0, 9.0], [1.0, 1.0, 0.0], [0.0, 40.0, 0.0], [0.0, 2.0, 0.0]] {
        for k in 0..2 {
            let world = world(gpu(), &mesh, Light::Point { position }, 60, k);
            let keys = curved_keys(&world);
            fault(&wanted(&world), &keys).unwrap_or_else(|text| panic!("{position:?}, view {k}: {text}"));
        }
    }
}

/// More triangles than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = crate::support::meshes::soup(65_537, 0.02, &mut Random::new(51));
    let world = world(gpu(), &mesh, ABOVE, 32, 0);
    let [compared, covered] = fault(&wanted(&world), &curved_keys(&world)).expect("it is right");
    assert!(compared > 300 && covered > 300, "{compared} compared, {covered} covered");
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| check(&world(gpu, &mesh, WITHIN, 100, 1));
    assert!(of(ten_a_row()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, WITHIN, 100, 0);
    let (keys, wanted) = (check(&world), wanted(&world));
    assert!(keys == curved_keys(&world), "another result in a second run");
    let sure: Vec<usize> = (0..wanted.len()).filter(|&k| !wanted[k].open).collect();
    let full = *sure.iter().find(|&&k| keys[k] != 0).expect("a covered texel");
    let spoilt = |spoil: &dyn Fn(&mut Vec<u32>)| {
        let mut off = keys.clone();
        spoil(&mut off);
        fault(&wanted, &off).is_err()
    };
    assert!(spoilt(&|k| k[full] = 0));
    assert!(spoilt(&|k| k[full] ^= 1 << 16));
    assert!(spoilt(&|k| k.rotate_right(1)));
    assert!(spoilt(&|k| k.rotate_right(100)));
    if let Some(&bare) = sure.iter().find(|&&k| keys[k] == 0) {
        assert!(spoilt(&|k| k[bare] = !0.5f32.to_bits()));
    }
    // The rays of the other half.
    let other = self::world(gpu(), &mesh, WITHIN, 100, 1);
    assert!(fault(&self::wanted(&other), &keys).is_err());
}
