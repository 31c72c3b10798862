//! Depth comparison on the sides of a silhouette, pixel by pixel against `f64` on the same map and the same points, which here are any. What
//! rounding may turn over makes an interval of visibility, in which the kernel's has to lie.

use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::{POISON, Random, gpu, sizes_around, upload};
use oracle::reference::silhouette_map::SilhouetteLookup;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::silhouette_map::SilhouetteMap;
use subpixel_shadows::stages::silhouette_points::SilhouetteCells;
use test_support::gpu_test;

const BIAS: [f32; 2] = [5e-5, 1.05];

struct Ran {
    bias: [f32; 2],
    keys: Vec<u32>,
    on: OnMap,
}

/// Points all over their cells, of a fifth of these none.
fn any_points(world: &World, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    let cells = (world.view.map.map_size + 1).pow(2);
    (0..cells)
        .map(|_| if random.below(5) == 0 { 0 } else { (random.below(65535) + 1) | ((random.below(65535) + 1) << 16) })
        .collect()
}

fn ask(world: &World, bias: [f32; 2], keys: Vec<u32>) -> Ran {
    let stage = SilhouetteMap::new(&world.gpu.device, bias[0], bias[1]);
    let points = upload(world.gpu, &keys);
    let on = OnMap::of(world, |s, frame, seen, depths, visibility| {
        stage.record(s, frame, seen, depths, &points, visibility);
    });
    Ran { bias, keys, on }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let points: Vec<_> = ran.keys.iter().map(|&key| SilhouetteCells::place(key)).collect();
    let (depths, size) = (&ran.on.depths, world.view.map.map_size);
    let [constant, slope] = ran.bias.map(f64::from);
    let lookup = |doubt: f64| SilhouetteLookup { depths, size, points: &points, constant: constant + doubt, slope };
    ran.on.fault(world, |p, _, slope, place, doubt| {
        let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
        let moved = around.map(|[x, y]| p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))));
        let near = |m: &DVec3| (lookup(0.0).point_at(m.truncate()) - m.truncate()).length() < 4.0 * place;
        if moved.iter().any(near) {
            return [0.0, 1.0];
        }
        let told = [doubt, -doubt].map(|doubt| moved.map(|m| lookup(doubt).is_lit(m, slope)));
        let all = told.as_flattened();
        [f64::from(u8::from(all.iter().all(|lit| *lit))), f64::from(u8::from(all.iter().any(|lit| *lit)))]
    })
}

#[track_caller]
fn check(world: &World, seed: u64) -> Ran {
    let ran = ask(world, BIAS, any_points(world, seed));
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), 1);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0));
}

/// A floor under a roof: with points in the middles the shadow is that of texels half a texel on, with others it ends elsewhere.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -0.8], [0.1, 0.8, 1.0]]);
    let world = world(gpu(), &mesh, above(), [240, 180], 32, 1);
    let cells = 33 * 33;
    let of = |key: u32| {
        let ran = ask(&world, BIAS, vec![key; cells]);
        assert_eq!(fault(&world, &ran).err(), None);
        ran.on.visibility
    };
    let [none, middle, corner] = [0, 32768 | (32768 << 16), 1 | (1 << 16)].map(of);
    let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    assert!(apart(&none, &middle) <= 4, "{} pixels", apart(&none, &middle));
    assert!(apart(&none, &corner) > 100 && none.contains(&0.0));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), pixels as u64);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for k in 0..4 {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind + k).is_multiple_of(2), &mut random);
            let k = k as usize;
            check(&world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], [1, 32, 8, 128][k]), k as u64);
        }
    }
}

/// At the default bias a bare plane does not shadow itself up to 89 degrees; without a bias it does.
#[gpu_test]
fn degenerate() {
    let mut unbiased = 0;
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        let dark = |bias| {
            let keys = any_points(&world, 3);
            ask(&world, bias, keys).on.visibility.iter().filter(|v| **v < 1.0).count()
        };
        assert_eq!(dark(BIAS), 0, "{degrees} degrees: pixels of acne");
        unbiased += dark([0.0; 2]);
    }
    assert!(unbiased > 0, "the bias is not needed");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), 4);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| {
        let world = world(gpu, &mesh, above(), [24, 24], 24, 8);
        ask(&world, BIAS, any_points(&world, 5)).on.visibility
    };
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, 6);
    let again = || ask(&world, BIAS, ran.keys.clone());
    assert!(ran.on.visibility == again().on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = again();
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let of = |v: f32| {
        let here = |&p: &usize| ran.on.seen[p].is_some() && ran.on.visibility[p] == v;
        (0..ran.on.visibility.len()).find(here).expect("a pixel")
    };
    let (lit, dark) = (of(1.0), of(0.0));
    assert!(spoilt(&|r| r.on.visibility[lit] = 0.5));
    assert!(spoilt(&|r| r.on.visibility[dark] = 0.5));
    assert!(spoilt(&|r| r.on.depths.fill(None)));
    assert!(spoilt(&|r| r.keys.fill(0)));
    assert!(spoilt(&|r| r.keys.rotate_left(1)));
    assert!(spoilt(&|r| r.bias[0] = 0.1));
}
