//! Shadows by a deep shadow map, pixel by pixel against `f64` on the same functions. What rounding may turn over (a depth at a step) makes an
//! interval of visibility, in which the kernel's has to lie.

use crate::deep_map::decoded;
use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::deep_shadows::DeepLookup;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::deep_map::{DeepMap, DeepMapOptions};
use subpixel_shadows::stages::deep_shadows::DeepShadows;
use test_support::gpu_test;

const PLAIN: DeepMapOptions = DeepMapOptions { sub_texels: 4, nodes: 7, error: 1.0 / 16.0 };
const ALL: [DeepMapOptions; 4] = [
    PLAIN,
    DeepMapOptions { sub_texels: 2, nodes: 3, error: 0.2 },
    DeepMapOptions { sub_texels: 8, nodes: 15, error: 0.0 },
    DeepMapOptions { sub_texels: 8, nodes: 4, ..PLAIN },
];
const BIAS: [f32; 2] = [5e-5, 1.05];

struct Ran {
    options: DeepMapOptions,
    bias: [f32; 2],
    texels: Vec<Vec<(u32, f64)>>,
    on: OnMap,
}

fn ask_with(world: &World, options: DeepMapOptions, bias: [f32; 2]) -> Ran {
    let (device, size) = (&world.gpu.device, world.view.map.map_size);
    let (make, stage) = (DeepMap::new(device, options), DeepShadows::new(device, options, bias));
    let deep = make.memory(device, size).expect("memory");
    let worst = DeepMap::worst(device).expect("memory");
    let on = OnMap::of(world, |s, frame, seen, nearest_keys, visibility| {
        make.record(s, frame, nearest_keys, (&deep, &worst), size);
        stage.record(s, frame, seen, &deep, visibility);
    });
    Ran { options, bias, texels: decoded(&deep.read(world.gpu).expect("readback"), options.nodes), on }
}

fn ask(world: &World, options: DeepMapOptions) -> Ran {
    ask_with(world, options, BIAS)
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let lookup = DeepLookup {
        texels: &ran.texels,
        side: ran.options.side(world.view.map.map_size),
        sub: ran.options.sub_texels,
        constant: f64::from(ran.bias[0]),
        slope: f64::from(ran.bias[1]),
    };
    ran.on.fault(world, |p, _, slope, place, doubt| {
        let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
        let moved = around.map(|[x, y]| p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))));
        let shares = moved.map(|m| lookup.share(m, slope, doubt));
        let (low, high) = shares.iter().fold((1.0f64, 0.0f64), |(low, high), s| (low.min(s[0]), high.max(s[1])));
        [low, high]
    })
}

#[track_caller]
fn check(world: &World, options: DeepMapOptions) -> Ran {
    let ran = ask(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{options:?}, {:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), PLAIN);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0));
}

#[gpu_test]
fn one() {
    // A floor under a roof, one sample: what is between light and dark is told in ever more steps.
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    for options in ALL {
        let ran = check(&world(gpu(), &mesh, above(), [48, 36], 128, 1), options);
        let count = |wanted: &dyn Fn(f32) -> bool| ran.on.visibility.iter().filter(|v| wanted(**v)).count();
        let counts = [count(&|v| v == 0.0), count(&|v| v > 0.0 && v < 1.0), count(&|v| v == 1.0)];
        assert!(counts.iter().all(|n| *n > 12), "{options:?}: {counts:?}");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 42, 8), PLAIN);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, options) in ALL.into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            check(&world(gpu(), &mesh, light, [40, 30], [64, 151][k / 2 % 2], [1, 32, 8, 128][k]), options);
        }
    }
}

/// A bare plane does not shadow itself up to 88 degrees, however coarse the texels; without the slope of the bias it does.
#[gpu_test]
fn degenerate() {
    let mut unbiased = 0;
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        let dark = |options, bias| ask_with(&world, options, bias).on.visibility.iter().filter(|v| **v < 1.0).count();
        for options in ALL {
            assert_eq!(dark(options, BIAS), 0, "{options:?}, {degrees} degrees: pixels of acne");
        }
        unbiased += dark(PLAIN, [0.0; 2]);
    }
    assert!(unbiased > 0, "the bias is not needed");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), PLAIN);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), PLAIN);
    assert!(of(folding_gpu()).on.visibility == of(gpu()).on.visibility, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, PLAIN);
    assert!(ran.on.visibility == ask(&world, PLAIN).on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, PLAIN);
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let of = |v: f32| {
        let there = |p: &usize| ran.on.seen[*p].is_some() && ran.on.visibility[*p] == v;
        (0..ran.on.seen.len()).find(there).expect("a pixel")
    };
    let (lit, dark) = (of(1.0), of(0.0));
    assert!(spoilt(&|r| r.on.visibility[lit] = 0.9) && spoilt(&|r| r.on.visibility[dark] = 0.1));
    assert!(spoilt(&|r| r.texels.rotate_right(1)));
    assert!(spoilt(&|r| r.texels.iter_mut().for_each(Vec::clear)));
    assert!(spoilt(&|r| r.bias[0] = 0.3) && spoilt(&|r| r.bias[1] = 20.0));
    assert!(spoilt(&|r| r.texels.iter_mut().flatten().for_each(|node| node.1 = (node.1 + 16.0).min(128.0))));
}
