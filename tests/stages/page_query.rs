//! Depth comparison, pixel by pixel against `f64` on the same pages. What rounding may turn over (a place at a texel's border, a depth at the
//! receiver's) makes an interval of visibility, in which the kernel's has to lie.

use crate::support::depth_map::OnMap;
use crate::support::pages::{BIAS, Paged, ten_a_row};
use crate::support::shadow::{
    World, above, add_triangle, camera, looked_down_on as world, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::{noise, receiver};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::page_query::PageLookup;
use oracle::reference::page_requests::level;
use std::collections::BTreeMap;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::page_requests::PageRule;
use test_support::gpu_test;

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Paged) -> Result<[u64; 2], String> {
    let pages: BTreeMap<_, _> = ran.made().into_iter().map(|(page, number)| (page, ran.depths(number))).collect();
    let [place, depth] = noise(world);
    let on = OnMap { depths: Vec::new(), visibility: ran.visibility.clone(), seen: ran.seen.clone() };
    on.fault_of_pixels(world, |pixel, t| {
        let (places, slope, _) = receiver(world, pixel, t)?;
        let level = level(ran.levels[pixel as usize].saturating_sub(ran.counts[1]));
        let doubt = depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * place * 2.0;
        let lookup = |doubt: f64| PageLookup {
            pages: &pages,
            size: world.view.map.map_size,
            base: ran.tree.base,
            constant: f64::from(BIAS[0]) + doubt,
            slope: f64::from(BIAS[1]),
        };
        let (brighter, darker) = (lookup(doubt), lookup(-doubt));
        let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
        let (mut low, mut high, mut seen) = (0.0, 0.0, 0.0);
        for p in places.iter().flatten() {
            let moved = around.map(|[x, y]| *p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))));
            low += moved.iter().map(|m| darker.share(*m, slope, level)).fold(1.0, f64::min);
            high += moved.iter().map(|m| brighter.share(*m, slope, level)).fold(0.0, f64::max);
            seen += 1.0;
        }
        (seen > 0.0).then(|| [low / seen - 1e-5, high / seen + 1e-5])
    })
}

#[track_caller]
fn check(world: &World, budget: u32, finer: u32) -> Paged {
    let ran = Paged::new(world, budget, finer);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{:?}, budget {budget}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), 1, 0);
    assert!(ran.visibility.iter().all(|&v| v == 1.0));
}

#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    let ran = check(&world(gpu(), &mesh, above(), [48, 36], 64, 1), 64, 0);
    assert!(ran.visibility.contains(&0.0) && ran.visibility.iter().all(|v| *v == 0.0 || *v == 1.0));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), 9, 0);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, budget) in [1, 7, 60, 1000].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let world = world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], [1, 32, 8, 128][k]);
            check(&world, budget, k as u32 / 2);
            let fitted = Paged::by(PageRule::Fitted, &world, budget, k as u32 / 2);
            let compared = fault(&world, &fitted).unwrap_or_else(|text| panic!("by cells, budget {budget}: {text}"));
            assert!(compared[1] * 2 + 9 >= compared[0], "by cells: {compared:?}");
        }
    }
}

/// At the default bias a bare plane does not shadow itself up to 85 degrees on any level.
#[gpu_test]
fn degenerate() {
    for degrees in [0.0f64, 30.0, 60.0, 75.0, 85.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        for budget in [1, 16, 512] {
            let dark = Paged::new(&world, budget, 1).visibility.iter().filter(|v| **v < 1.0).count();
            assert_eq!(dark, 0, "{budget} pages, {degrees} degrees: pixels of acne");
        }
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), 16, 0);
    assert!(ran.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 24, 8), 16, 1);
    assert!(of(ten_a_row()).visibility == of(gpu()).visibility, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, 30, 1);
    let spoilt = |spoil: &dyn Fn(&mut Paged)| {
        let mut off = Paged::new(&world, 30, 1);
        assert!(off.visibility == ran.visibility, "another result in a second run");
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let of = |v: f32| {
        (0..ran.visibility.len()).position(|p| ran.seen[p].is_some() && ran.visibility[p] == v).expect("a pixel")
    };
    let (lit, dark) = (of(1.0), of(0.0));
    assert!(spoilt(&|r| r.visibility[lit] = 0.5));
    assert!(spoilt(&|r| r.visibility[dark] = 0.5));
    assert!(spoilt(&|r| r.keys.fill(0)));
    assert!(spoilt(&|r| r.keys.rotate_right(1024 * 3)));
    assert!(spoilt(&|r| r.levels.fill(0)));
}
