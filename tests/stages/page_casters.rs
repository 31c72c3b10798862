//! Texels of pages against the nearest caster in `f64`: where no edge passes the centre within rounding, depths agree.

use crate::support::pages::{Paged, ten_a_row};
use crate::support::shadow::{
    World, above, add_triangle, camera, looked_down_on as world, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::noise;
use crate::support::{Random, gpu, sizes_around};
use oracle::reference::page_casters::texels;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::scene::{Light, Mesh};
use test_support::gpu_test;

/// Where the stage departs from its definition; how many texels were compared, and how many of them are covered.
fn fault(world: &World, ran: &Paged) -> Result<[usize; 2], String> {
    let [place, depth] = noise(world);
    let (mut compared, mut covered) = (0, 0);
    for ((level, page), number) in ran.made() {
        let scale = f64::from(level as i32 - ran.tree.base as i32).exp2();
        let wanted = texels(&world.view, &world.triangles, scale, page, 2.0 * place);
        let size = (f64::from(world.view.map.map_size) * scale).ceil() as u32;
        for (k, (found, wanted)) in (0..).zip(ran.depths(number).iter().zip(wanted)) {
            let at = [page[0] * 32 + k % 32, page[1] * 32 + k / 32];
            // Nobody asks for what lies beyond the map.
            if wanted.open || at.iter().any(|x| *x >= size) {
                continue;
            }
            compared += 1;
            covered += usize::from(wanted.nearest.is_some());
            let doubt = 2e-6 + 2.0 * depth + wanted.slope * place * 4.0;
            let near = match (*found, wanted.nearest) {
                (Some(a), Some(b)) => (a - b.max(0.0)).abs() <= doubt,
                (a, b) => a == b,
            };
            if !near {
                return Err(format!("level {level}, texel {at:?}: {found:?}, {wanted:?} expected within {doubt}"));
            }
        }
    }
    Ok([compared, covered])
}

#[track_caller]
fn check(world: &World, budget: u32, finer: u32) -> Paged {
    let ran = Paged::new(world, budget, finer);
    match fault(world, &ran) {
        Ok([compared, _]) => {
            let all = ran.made().len() * 1024;
            assert!(compared * 100 >= all * 5, "{compared} of {all} texels compared");
        }
        Err(text) => panic!("{:?}, budget {budget}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 64, 8), 4, 0);
    assert!(ran.keys.iter().all(|&key| key == 0));
}

#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    let world = world(gpu(), &mesh, above(), [96, 72], 64, 1);
    let ran = check(&world, 4096, 2);
    assert!(ran.made().keys().any(|(level, _)| *level > 1), "{:?}", ran.counts);
    assert!(fault(&world, &ran).expect("it is right")[1] > 1024);
}

#[gpu_test]
fn every_size_around_workgroup() {
    for triangles in sizes_around(64) {
        let mesh = crate::support::meshes::soup(triangles, 0.4, &mut Random::new(triangles as u64));
        check(&world(gpu(), &mesh, above(), [20, 15], 70, 1), 6, 0);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, budget) in [1, 9, 30, 1000].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            check(&world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], 8), budget, k as u32 / 2);
        }
    }
}

/// Casters that reach behind the light, a sheet that the light almost misses, and one triangle over all pages.
#[gpu_test]
fn degenerate() {
    let mut mesh = sheet(3, 4.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-9.0, 0.5, -9.0], [9.0, 4.0, -9.0], [0.0, 0.5, 9.0]]);
    let camera = camera(DVec3::new(0.0, 3.0, 6.0), DVec3::ZERO, 60.0);
    for light in [
        Light::Point { position: [0.3, 2.0, 0.2] },
        Light::Point { position: [3.0, 1.0, 0.2] },
        Light::Directional { direction: [1.0, 0.01, 0.0] },
        above(),
    ] {
        check(&World::new(gpu(), &mesh, camera, light, [60, 45], 100, samples(8)), 40, 1);
    }
}

/// More triangles than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = crate::support::meshes::soup(65_537, 0.02, &mut Random::new(51));
    let world = world(gpu(), &mesh, above(), [20, 15], 32, 1);
    let ran = Paged::new(&world, 1, 0);
    assert!(fault(&world, &ran).expect("it is right")[0] > 0);
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 24, 8), 16, 1);
    assert!(of(ten_a_row()).keys == of(gpu()).keys, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 100, 8);
    let ran = check(&world, 30, 2);
    let sure: Vec<usize> = {
        let mut sure = Vec::new();
        for ((level, page), number) in ran.made() {
            let scale = f64::from(level as i32 - ran.tree.base as i32).exp2();
            let size = (100.0 * scale).ceil() as usize;
            let wanted = texels(&world.view, &world.triangles, scale, page, 2.0 * noise(&world)[0]);
            let first = number as usize * 1024;
            let within = |k: usize| page[0] as usize * 32 + k % 32 < size && page[1] as usize * 32 + k / 32 < size;
            sure.extend((0..1024).filter(|&k| !wanted[k].open && within(k)).map(|k| first + k));
        }
        sure
    };
    let full = *sure.iter().find(|&&k| ran.keys[k] != 0).expect("a covered texel");
    let spoilt = |spoil: &dyn Fn(&mut Paged)| {
        let mut off = Paged::new(&world, 30, 2);
        assert!(off.keys == ran.keys, "another result in a second run");
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    assert!(spoilt(&|r| r.keys[full] = 0));
    assert!(spoilt(&|r| r.keys[full] ^= 1 << 16));
    assert!(spoilt(&|r| r.keys.rotate_right(1)));
    assert!(spoilt(&|r| r.keys.rotate_right(1024)));
    if let Some(&bare) = sure.iter().find(|&&k| ran.keys[k] == 0) {
        assert!(spoilt(&|r| r.keys[bare] = !0.5f32.to_bits()));
    }
}
