//! Borders drawn anew, pixel by pixel against `f64` on the same map. A sample whose answer hangs on what rounding may turn over may
//! be either.

use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::smsr::{SmsrLookup, SmsrMargin};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::smsr::{Smsr, SmsrOptions};
use test_support::gpu_test;

const MIDDLE: SmsrOptions = SmsrOptions { reach: 16, midpoints: true, constant: 5e-5, slope: 0.5 };
const CORNER: SmsrOptions = SmsrOptions { midpoints: false, ..MIDDLE };

struct Ran {
    options: SmsrOptions,
    on: OnMap,
}

fn ask(world: &World, options: SmsrOptions) -> Ran {
    let stage = Smsr::new(&world.gpu.device, options);
    let on = OnMap::of(world, |s, frame, seen, depths, visibility| stage.record(s, frame, seen, depths, visibility));
    Ran { options, on }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let lookup = SmsrLookup {
        depths: &ran.on.depths,
        size: world.view.map.map_size,
        reach: ran.options.reach,
        midpoints: ran.options.midpoints,
        constant: f64::from(ran.options.constant),
        slope: f64::from(ran.options.slope),
    };
    ran.on.fault(world, |p, first, slope, place, depth| {
        let lit = lookup.is_lit(p, first, slope, SmsrMargin { place, depth });
        lit.map_or([0.0, 1.0], |lit| [f64::from(u8::from(lit)); 2])
    })
}

#[track_caller]
fn check(world: &World, options: SmsrOptions) -> Ran {
    let ran = ask(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 4 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{options:?}, {:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), MIDDLE);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0));
}

/// A floor under a roof with slanting edges: lines by corners darken, lines by midpoints do both, and the farther a border is
/// followed the less is left of its steps.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -0.8], [0.1, 0.8, 1.0]]);
    let world = world(gpu(), &mesh, above(), [240, 180], 32, 1);
    let dark = |ran: &Ran| ran.on.visibility.iter().map(|&v| v == 0.0).collect::<Vec<_>>();
    let steps = dark(&check(&world, SmsrOptions { reach: 1, ..CORNER }));
    let corner = dark(&check(&world, CORNER));
    let middle = dark(&check(&world, MIDDLE));
    let more = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| **a && !**b).count();
    // With nothing followed all borders are open: the steps stay.
    let plain = dark(&check(&world, SmsrOptions { reach: 0, ..MIDDLE }));
    assert_eq!(more(&plain, &corner), 0, "corners grow the light");
    let grown = [more(&corner, &plain), more(&corner, &steps)];
    assert!(grown[0] > 20 && grown[1] > 0, "corners grow shadows by {grown:?} pixels");
    let [grown, shrunk] = [more(&middle, &plain), more(&plain, &middle)];
    assert!(grown > 5 && shrunk > 5 && grown < 4 * shrunk && shrunk < 4 * grown, "{grown} darker, {shrunk} brighter");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), MIDDLE);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        let short = SmsrOptions { reach: 3, ..MIDDLE };
        for (k, options) in [MIDDLE, CORNER, short, SmsrOptions { reach: 64, ..CORNER }].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind + k as u32).is_multiple_of(2), &mut random);
            check(&world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], [1, 32, 8, 128][k]), options);
        }
    }
}

/// Maps and images of one cell and of few.
#[gpu_test]
fn smallest() {
    let mut random = Random::new(47);
    for (k, (size, map)) in
        [([1, 1], 1), ([1, 1], 33), ([40, 30], 1), ([40, 30], 2), ([3, 1], 5)].into_iter().enumerate()
    {
        let mesh = random_scene(k as u32, &mut random);
        for (light, options) in [true, false].into_iter().flat_map(|l| [(l, MIDDLE), (l, CORNER)]) {
            check(&world(gpu(), &mesh, random_light(light, &mut random), size, map, 32), options);
        }
    }
}

/// At the default bias a bare plane has no borders up to 89 degrees; without a bias it has.
#[gpu_test]
fn degenerate() {
    let mut unbiased = 0;
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        let dark = |options| ask(&world, options).on.visibility.iter().filter(|v| **v < 1.0).count();
        for options in [MIDDLE, CORNER] {
            assert_eq!(dark(options), 0, "{options:?}, {degrees} degrees: pixels of acne");
        }
        unbiased += dark(SmsrOptions { constant: 0.0, slope: 0.0, ..MIDDLE });
    }
    assert!(unbiased > 0, "the bias is not needed");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), MIDDLE);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), MIDDLE);
    assert!(of(folding_gpu()).on.visibility == of(gpu()).on.visibility, "the fold changes the result");
}

/// A map on a paraboloid.
#[gpu_test]
fn paraboloids() {
    let from = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    let light = Light::Point { position: [0.1, 0.9, 0.2] };
    for (kind, k) in [(0, 0), (1, 1), (1, 0)] {
        let mesh = random_scene(kind, &mut Random::new(83));
        let world = World::in_paraboloid(gpu(), &mesh, (from, light), [48, 36], 128, samples(1), k);
        check(&world, MIDDLE);
        check(&world, CORNER);
    }
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, MIDDLE);
    assert!(ran.on.visibility == ask(&world, MIDDLE).on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, MIDDLE);
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
    assert!(spoilt(&|r| r.options.midpoints = false));
    assert!(spoilt(&|r| r.options.reach = 1));
    assert!(spoilt(&|r| r.options.slope = 8.0));
}
