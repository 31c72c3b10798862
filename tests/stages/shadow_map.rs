//! Depth comparison, pixel by pixel against `f64` on the same map. What rounding may turn over (a place at a texel's border, a
//! depth at the receiver's) makes an interval of visibility, in which the kernel's has to lie.

use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::spsm::{noise, receiver};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::shadow_map::{DepthLookup, turn_of};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::shadow_map::{ShadowMap, ShadowMapOptions};
use subpixel_shadows::tap_disc::{disc_words, taps};
use test_support::gpu_test;

const PLAIN: ShadowMapOptions =
    ShadowMapOptions { kernel: 1, constant: 5e-5, slope: 1.05, receiver_plane: false, taps: 0, turned: false };

fn filtered(kernel: u32) -> ShadowMapOptions {
    ShadowMapOptions { kernel, slope: 0.0, receiver_plane: true, ..PLAIN }
}

fn disc(taps: u32, turned: bool) -> ShadowMapOptions {
    ShadowMapOptions { slope: 0.0, receiver_plane: true, taps, turned, ..PLAIN }
}

/// Texels.
const RADIUS: f32 = 2.5;

struct Ran {
    options: ShadowMapOptions,
    on: OnMap,
}

fn ask(world: &World, options: ShadowMapOptions) -> Ran {
    let stage = ShadowMap::new(&world.gpu.device, options);
    let disc = Buffer::<[f32; 4]>::uniform(&world.gpu.device, "test.disc", 32).expect("memory");
    disc.write(&world.gpu.queue, &disc_words(options.taps, RADIUS));
    let on = OnMap::of(world, |s, frame, seen, depths, visibility| {
        stage.record(s, frame, seen, (depths, &disc), visibility);
    });
    Ran { options, on }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    if ran.options.taps > 0 {
        return disc_fault(world, ran);
    }
    let lookup = |doubt: f64| DepthLookup {
        depths: &ran.on.depths,
        size: world.view.map.map_size,
        kernel: ran.options.kernel,
        constant: f64::from(ran.options.constant) + doubt,
        slope: f64::from(ran.options.slope),
        receiver_plane: ran.options.receiver_plane,
        taps: &[],
        curved: world.view.map.paraboloid.map(|_| world.view.map),
    };
    ran.on.fault(world, |p, _, slope, place, doubt| {
        let (brighter, darker) = (lookup(doubt), lookup(-doubt));
        let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
        let moved = around.map(|[x, y]| p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))));
        [
            moved.iter().map(|m| darker.share(*m, slope)).fold(1.0, f64::min),
            moved.iter().map(|m| brighter.share(*m, slope)).fold(0.0, f64::max),
        ]
    })
}

/// The same with a disc, of which each tap may fall to one side or the other by itself.
fn disc_fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let [place, depth] = noise(world);
    let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]].map(DVec2::from);
    let disc: Vec<DVec2> = taps(ran.options.taps).into_iter().map(|tap| tap * f64::from(RADIUS)).collect();
    ran.on.fault_of_pixels(world, |pixel, t| {
        let (places, slope, _) = receiver(world, pixel, t)?;
        let doubt = depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * place * 2.0;
        let [width, first] = [world.frame.image_size[0], world.frame.first_row];
        let turn = match ran.options.turned {
            true => turn_of([pixel % width, first + pixel / width]),
            false => DVec2::X,
        };
        let (mut share, mut seen) = ([0.0, 0.0], 0.0);
        for (p, tap) in places.iter().flatten().flat_map(|p| disc.iter().map(move |tap| (p, turn.rotate(*tap)))) {
            // The one is darker, the other brighter.
            let told = [-doubt, doubt].map(|doubt| {
                around.map(|by| {
                    let lookup = DepthLookup {
                        depths: &ran.on.depths,
                        size: world.view.map.map_size,
                        kernel: 1,
                        constant: f64::from(ran.options.constant) + doubt,
                        slope: 0.0,
                        receiver_plane: true,
                        taps: &[tap],
                        curved: world.view.map.paraboloid.map(|_| world.view.map),
                    };
                    lookup.share(*p + by.extend(slope.dot(by)), slope)
                })
            });
            share[0] += told[0].into_iter().fold(1.0, f64::min);
            share[1] += told[1].into_iter().fold(0.0, f64::max);
            seen += 1.0;
        }
        (seen > 0.0).then(|| [share[0] / seen - 1e-5, share[1] / seen + 1e-5])
    })
}

#[track_caller]
fn check(world: &World, options: ShadowMapOptions) -> Ran {
    let ran = ask(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => {
            // Of a disc every tap by itself may be in doubt.
            let least = compared / if options.taps > 0 { 8 } else { 2 };
            assert!(close + 5 >= least, "{close} of {compared} pixels compared closely");
        }
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
    // A floor under a roof, one sample: a plain map knows two answers, a filtered one more.
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 1);
    let plain = check(&world, PLAIN);
    assert!(plain.on.visibility.contains(&0.0) && plain.on.visibility.iter().all(|v| *v == 0.0 || *v == 1.0));
    let mut last = 0;
    for kernel in [2, 3, 5, 7] {
        let ran = check(&world, filtered(kernel));
        let between = ran.on.visibility.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
        assert!(between > last, "kernel {kernel}: {between} pixels between, {last} with a smaller one");
        last = between;
    }
    let mut last = 0;
    for (taps, turned) in [(2, false), (16, false), (64, true)] {
        let ran = check(&world, disc(taps, turned));
        let mut shares: Vec<u32> = ran.on.visibility.iter().map(|v| v.to_bits()).collect();
        shares.sort_unstable();
        shares.dedup();
        assert!(shares.len() > last, "{taps} taps: {} shares, {last} with fewer", shares.len());
        last = shares.len();
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), filtered(3));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        let all = [PLAIN, filtered(2), filtered(3), filtered(7), disc(9, false), disc(25, true), disc(64, true)];
        for (k, options) in all.into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let samples = [1, 32, 8, 128, 32, 8, 1][k];
            check(&world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2 % 2], samples), options);
        }
    }
}

/// At the default bias a bare plane does not shadow itself up to 89 degrees, filtered or not; without a bias it does.
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
        for options in [PLAIN, filtered(2), filtered(3), filtered(5), filtered(7), disc(9, false), disc(16, true)] {
            assert_eq!(dark(options), 0, "{options:?}, {degrees} degrees: pixels of acne");
        }
        unbiased += dark(ShadowMapOptions { constant: 0.0, slope: 0.0, ..PLAIN });
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
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), filtered(3));
    assert!(of(folding_gpu()).on.visibility == of(gpu()).on.visibility, "the fold changes the result");
}

/// A map on a paraboloid, from outside and from within, each of its two views, plain and filtered; what a map on a plane holds is wrong there.
#[gpu_test]
fn paraboloids() {
    let mut random = Random::new(83);
    let from = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    let within = Light::Point { position: [0.1, 0.9, 0.2] };
    for (kind, light, k) in [(0, within, 0), (1, within, 1), (1, within, 0), (2, random_light(false, &mut random), 0)] {
        let mesh = random_scene(kind, &mut random);
        let world = World::in_paraboloid(gpu(), &mesh, (from, light), [48, 36], 128, samples(8), k);
        check(&world, PLAIN);
        // The definition knows the receiver's slope at the pixel's middle, where one sample lies.
        let one = World::in_paraboloid(gpu(), &mesh, (from, light), [48, 36], 128, samples(1), k);
        for options in [PLAIN, filtered(3), disc(16, true)] {
            // Of one sample on steep planes most taps are in doubt.
            let [compared, close] = fault(&one, &ask(&one, options)).expect("it is right");
            assert!(close * 8 + 5 >= compared, "{options:?}: {close} of {compared} pixels compared closely");
        }
        let mut other = ask(&world, PLAIN);
        other.on.visibility = ask(&self::world(gpu(), &mesh, light, [48, 36], 128, 8), PLAIN).on.visibility;
        assert!(k == 1 || fault(&world, &other).is_err(), "a map on a plane answers the same");
    }
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
        (0..ran.on.visibility.len())
            .position(|p| ran.on.seen[p].is_some() && ran.on.visibility[p] == v)
            .expect("a pixel")
    };
    let (lit, dark) = (of(1.0), of(0.0));
    assert!(spoilt(&|r| r.on.visibility[lit] = 0.5));
    assert!(spoilt(&|r| r.on.visibility[dark] = 0.5));
    assert!(spoilt(&|r| r.on.depths.fill(None)));
    assert!(spoilt(&|r| r.options.kernel = 7));
    let turned = |to: fn(&mut Ran)| {
        let mut off = check(&world, disc(9, true));
        to(&mut off);
        fault(&world, &off).is_err()
    };
    assert!(turned(|r| r.options.turned = false) && turned(|r| r.options.taps = 4));
    assert!(turned(|r| r.on.depths.fill(None)));
    // The angle is that of the pixel.
    let [one, other] = [disc(9, true), disc(9, false)].map(|options| ask(&world, options).on.visibility);
    assert!(one != other, "no angle changes anything");
}
