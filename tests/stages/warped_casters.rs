//! Texels of a warped map against the nearest caster in `f64` at their centres: where no edge passes a centre within rounding, depths agree.

use crate::support::axes::Warped;
use crate::support::pages::ten_a_row;
use crate::support::shadow::{
    World, above, add_triangle, camera, looked_down_on as world, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::noise;
use crate::support::{Random, gpu, sizes_around};
use oracle::reference::page_casters::PageTexel;
use oracle::reference::warped_casters::{centres, texels};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::axis_density::DensityRule::{self, Logarithmic, Requested};
use test_support::gpu_test;

fn wanted(world: &World, ran: &Warped) -> Vec<PageTexel> {
    let [columns, rows] = [0, 1].map(|axis| centres(&ran.borders_of(axis)));
    texels(&world.view, &world.triangles, [&columns, &rows], 2.0 * noise(world)[0])
}

/// Where the stage departs from its definition; how many texels were compared, and how many of them are covered.
fn fault(world: &World, ran: &Warped) -> Result<[usize; 2], String> {
    let [place, depth] = noise(world);
    let (mut compared, mut covered) = (0, 0);
    for (texel, (found, wanted)) in ran.depths().into_iter().zip(wanted(world, ran)).enumerate() {
        if wanted.open {
            continue;
        }
        compared += 1;
        covered += usize::from(wanted.nearest.is_some());
        let doubt = 2e-6 + 2.0 * depth + wanted.slope * place * 4.0;
        let near = match (found, wanted.nearest) {
            (Some(a), Some(b)) => (a - b.max(0.0)).abs() <= doubt,
            (a, b) => a == b,
        };
        if !near {
            return Err(format!("texel {texel}: {found:?}, {wanted:?} expected within {doubt}"));
        }
    }
    Ok([compared, covered])
}

#[track_caller]
fn check(world: &World, rule: DensityRule, stretch: u32) -> Warped {
    let ran = Warped::new(world, rule, stretch);
    match fault(world, &ran) {
        Ok([compared, _]) => {
            assert!(compared * 100 >= ran.keys.len() * 5, "{compared} of {} texels compared", ran.keys.len());
        }
        Err(text) => panic!("{:?}, {rule:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 64, 8), Requested, 64);
    assert!(ran.keys.iter().all(|&key| key == 0));
}

#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    for rule in [Requested, Logarithmic] {
        let world = world(gpu(), &mesh, above(), [96, 72], 64, 1);
        let ran = check(&world, rule, 64);
        assert!(fault(&world, &ran).expect("it is right")[1] > 1024);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for triangles in sizes_around(64) {
        let mesh = crate::support::meshes::soup(triangles, 0.4, &mut Random::new(triangles as u64));
        check(&world(gpu(), &mesh, above(), [20, 15], 70, 1), Requested, 64);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, stretch) in [2, 16, 64, 256].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let world = world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], 8);
            check(&world, [Requested, Logarithmic][(k + kind as usize) % 2], stretch);
        }
    }
}

/// Casters that reach behind the light, a sheet that the light almost misses, and one triangle over all texels.
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
        for rule in [Requested, Logarithmic] {
            check(&World::new(gpu(), &mesh, camera, light, [60, 45], 100, samples(8)), rule, 64);
        }
    }
}

/// More triangles than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = crate::support::meshes::soup(65_537, 0.02, &mut Random::new(51));
    let world = world(gpu(), &mesh, above(), [20, 15], 32, 1);
    let ran = Warped::new(&world, Requested, 64);
    assert!(fault(&world, &ran).expect("it is right")[0] > 0);
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 100, 8), Requested, 64);
    assert!(of(ten_a_row()).keys == of(gpu()).keys, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 100, 8);
    let ran = check(&world, Requested, 64);
    let sure: Vec<usize> = {
        let wanted = wanted(&world, &ran);
        (0..wanted.len()).filter(|&k| !wanted[k].open).collect()
    };
    let full = *sure.iter().find(|&&k| ran.keys[k] != 0).expect("a covered texel");
    let spoilt = |spoil: &dyn Fn(&mut Warped)| {
        let mut off = Warped::new(&world, Requested, 64);
        assert!(off.keys == ran.keys, "another result in a second run");
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    assert!(spoilt(&|r| r.keys[full] = 0));
    assert!(spoilt(&|r| r.keys[full] ^= 1 << 16));
    assert!(spoilt(&|r| r.keys.rotate_right(1)));
    assert!(spoilt(&|r| r.keys.rotate_right(100)));
    assert!(spoilt(&|r| r.borders[..101].copy_from_slice(&ran.borders[101..])));
    if let Some(&bare) = sure.iter().find(|&&k| ran.keys[k] == 0) {
        assert!(spoilt(&|r| r.keys[bare] = !0.5f32.to_bits()));
    }
}
