//! The triangles that texels keep, pixel by pixel against `f64` on the same map. A sample whose answer hangs on what rounding may turn over
//! may be either.

use crate::support::depth_map::OnMap;
use crate::support::geometry::holes;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::spsm::{noise, receiver};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::kept_triangles::{KeptLookup, KeptMargin};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::kept_triangles::{KeptTriangles, KeptTrianglesOptions};
use test_support::gpu_test;

const USUAL: KeptTrianglesOptions = KeptTrianglesOptions { lookups: 5, bias: 1e-5, words: 1, alpha: false };

fn asking(lookups: u32) -> KeptTrianglesOptions {
    KeptTrianglesOptions { lookups, ..USUAL }
}

struct Ran {
    options: KeptTrianglesOptions,
    on: OnMap,
    kept: Vec<Option<u32>>,
}

fn ask(world: &World, options: KeptTrianglesOptions) -> Ran {
    let alpha = !world.prepared.alpha().is_empty();
    let options = KeptTrianglesOptions { words: world.words() as u32, alpha, ..options };
    let stage = KeptTriangles::new(&world.gpu.device, options);
    let (on, kept) =
        OnMap::of_triangles(world, |s, frame, seen, keys, visibility| stage.record(s, frame, seen, keys, visibility));
    Ran { options, on, kept }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let lookup = KeptLookup {
        view: &world.view,
        triangles: &world.triangles,
        vertices: &world.prepared.mesh().triangles,
        alpha: world.prepared.alpha(),
        kept: &ran.kept,
        lookups: ran.options.lookups,
        bias: f64::from(ran.options.bias),
    };
    let [place, depth] = noise(world);
    ran.on.fault_of_pixels(world, |pixel, t| {
        let (places, slope, _) = receiver(world, pixel, t)?;
        let doubt = KeptMargin { place, depth: depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * place * 2.0 };
        let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
        let (mut low, mut high, mut seen) = (0.0, 0.0, 0.0);
        for p in places.iter().flatten() {
            let told = around.map(|[x, y]| lookup.is_lit(*p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))), t, doubt));
            low += f64::from(u8::from(told.iter().all(|&lit| lit == Some(true))));
            high += f64::from(u8::from(told.iter().any(|&lit| lit != Some(false))));
            seen += 1.0;
        }
        (seen > 0.0).then(|| [low / seen - 1e-5, high / seen + 1e-5])
    })
}

#[track_caller]
fn check(world: &World, options: KeptTrianglesOptions) -> Ran {
    let ran = ask(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{options:?}, {:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), USUAL);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0) && ran.kept.iter().all(Option::is_none));
}

/// A floor under a roof: its shadow has sharp edges however coarse the map. With one look-up what lies in texels whose centres the roof
/// leaves is lit; the more look-ups, the less is missed.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -0.8], [0.1, 0.8, 1.0]]);
    let fine = world(gpu(), &mesh, above(), [240, 180], 512, 1);
    let coarse = world(gpu(), &mesh, above(), [240, 180], 24, 1);
    let dark = |ran: &Ran| ran.on.visibility.iter().map(|&v| v == 0.0).collect::<Vec<_>>();
    let right = dark(&check(&fine, asking(3)));
    let missed = |lookups| {
        let got = dark(&check(&coarse, asking(lookups)));
        let more = got.iter().zip(&right).filter(|(got, want)| **got && !**want).count();
        assert!(more < 5, "{more} pixels too dark");
        got.iter().zip(&right).filter(|(got, want)| !**got && **want).count()
    };
    let missed = [1, 3, 5, 7].map(missed);
    assert!(missed[0] > 50 && missed.is_sorted_by(|a, b| a >= b) && missed[1] < 5, "{missed:?} pixels too bright");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), USUAL);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, lookups) in [1, 3, 5, 7].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind + k as u32).is_multiple_of(2), &mut random);
            check(&world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], [1, 32, 8, 128][k]), asking(lookups));
        }
    }
}

/// Of triangles with holes what is solid at a sample shadows it, and what is solid at a centre is kept.
#[gpu_test]
fn through_holes() {
    let mut random = Random::new(47);
    let mut others = 0;
    for kind in 0..4 {
        let mesh = random_scene(kind, &mut random);
        let light = random_light(kind % 2 == 0, &mut random);
        let prepared = Prepared::with_alpha(&mesh, &holes(&mesh)).expect("a sound mesh");
        let plain = world(gpu(), &mesh, light, [40, 30], 64, 32);
        let camera = (plain.camera, plain.light);
        let tested = World::of(gpu(), prepared, camera, [40, 30], 64, samples(32), None);
        let ran = check(&tested, USUAL);
        others += usize::from(ran.on.visibility != ask(&plain, USUAL).on.visibility);
    }
    assert!(others > 2, "holes change {others} pictures");
}

/// In warped slices of what the camera sees, of the sun and of a lamp.
#[gpu_test]
fn in_slices() {
    let mut random = Random::new(53);
    for (k, warp) in [Warp::Box, Warp::Trapezoid, Warp::LightSpace, Warp::Fitted].into_iter().enumerate() {
        let mesh = random_scene(1 + k as u32 % 2, &mut random);
        let plain = world(gpu(), &mesh, random_light(k != 0, &mut random), [40, 30], 64, 8);
        let plan = SplitPlan { splits: 2, warp, ..SplitPlan::default() };
        let view = (plain.camera, plain.light);
        for slice in 0..2 {
            let world = World::in_slice(gpu(), &mesh, view, [40, 30], 64, samples(8), Some((plan, slice)));
            check(&world, USUAL);
        }
    }
}

/// At the default bias a bare plane does not shadow itself up to 89 degrees; pressed down by a bias a roof throws no shadow.
#[gpu_test]
fn degenerate() {
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        for lookups in [1, 3, 5, 7] {
            let dark = ask(&world, asking(lookups)).on.visibility.iter().filter(|v| **v < 1.0).count();
            assert_eq!(dark, 0, "{lookups} look-ups, {degrees} degrees: pixels of acne");
        }
    }
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -0.8], [0.1, 0.8, 1.0]]);
    let world = world(gpu(), &mesh, above(), [48, 36], 32, 8);
    let dark = |bias| {
        let ran = check(&world, KeptTrianglesOptions { bias, ..USUAL });
        ran.on.visibility.iter().filter(|v| **v < 1.0).count()
    };
    let dark = [1e3, 0.01].map(dark);
    assert!(dark[0] == 0 && dark[1] > 20, "{dark:?} pixels in shadow");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), USUAL);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), USUAL);
    assert!(of(folding_gpu()).on.visibility == of(gpu()).on.visibility, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, USUAL);
    assert!(ran.on.visibility == ask(&world, USUAL).on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, USUAL);
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
    assert!(spoilt(&|r| r.kept.fill(None)));
    assert!(spoilt(&|r| r.options.lookups = 1));
    assert!(spoilt(&|r| r.options.bias = 0.2));
}
