//! Polygons by their numbers, pixel by pixel against `f64` on the same map. A sample whose texel, or whose being on its triangle, hangs on what
//! rounding may turn over may be either.

use crate::support::depth_map::OnMap;
use crate::support::geometry::holes;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet,
};
use crate::support::spsm::{noise, receiver};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::kept_triangles::KeptLookup;
use oracle::reference::light_layers::depth_in_front;
use oracle::reference::polygon_ids::PolygonLookup;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::polygon_ids::{PolygonIds, PolygonMap};
use test_support::gpu_test;

struct Ran {
    lookups: u32,
    on: OnMap,
    kept: Vec<Option<u32>>,
    surfaces: Vec<u32>,
}

/// With the polygons of the mesh, or every triangle by itself.
fn ask_of(world: &World, lookups: u32, merged: bool) -> Ran {
    let device = &world.gpu.device;
    let stage = PolygonIds::new(device, lookups);
    let each = Buffer::from_slice(device, &world.gpu.queue, "test.each", &each(world)).expect("memory");
    let surfaces = world.casters.surfaces.as_ref().filter(|_| merged).unwrap_or(&each);
    let (on, kept) = OnMap::of_triangles(world, |s, frame, seen, triangle_keys, visibility| {
        stage.record(s, frame, seen, PolygonMap { triangle_keys, surfaces }, visibility);
    });
    let surfaces = if merged { world.prepared.surfaces.clone() } else { self::each(world) };
    Ran { lookups, on, kept, surfaces }
}

fn each(world: &World) -> Vec<u32> {
    (0..world.triangles.len() as u32).collect()
}

fn ask(world: &World, lookups: u32) -> Ran {
    ask_of(world, lookups, true)
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let map = KeptLookup {
        view: &world.view,
        triangles: &world.triangles,
        vertices: &world.prepared.mesh().triangles,
        alpha: world.prepared.alpha(),
        kept: &ran.kept,
        lookups: ran.lookups,
        bias: 0.0,
    };
    let lookup = PolygonLookup { map, surfaces: &ran.surfaces };
    let [place, _] = noise(world);
    ran.on.fault_of_pixels(world, |pixel, t| {
        let (places, _, _) = receiver(world, pixel, t)?;
        let corners = world.triangles[t as usize].corners?;
        // Samples that surely meet the triangle, and those that may: how many are lit at the least, at the most, and how many there are.
        let (mut sure, mut maybe) = ([0.0; 3], [0.0; 3]);
        for p in places.iter().flatten() {
            let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
            let told = around.map(|[x, y]| lookup.is_lit(p.truncate() + DVec2::new(x, y), t));
            let lit = [told.iter().all(|&lit| lit == Some(true)), told.iter().any(|&lit| lit != Some(false))];
            let inside = depth_in_front(&world.view, corners, p.truncate()).map_or(0.0, |(_, inside)| inside);
            let of = match inside {
                inside if inside > place => &mut sure,
                inside if inside < -place => continue,
                _ => &mut maybe,
            };
            let [least, most] = lit.map(|lit| f64::from(u8::from(lit)));
            *of = [of[0] + least, of[1] + most, of[2] + 1.0];
        }
        // A triangle that may meet it may be left out if it is lit, and for the most if it is dark.
        let low = sure[0] / (sure[2] + maybe[2] - maybe[0]);
        let high = (sure[1] + maybe[1]) / (sure[2] + maybe[1]);
        (sure[2] > 0.0).then_some([low - 1e-5, high + 1e-5])
    })
}

#[track_caller]
fn judged(world: &World, ran: Ran) -> Ran {
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{} look-ups, {:?}: {text}", ran.lookups, world.light),
    }
    ran
}

#[track_caller]
fn check(world: &World, lookups: u32) -> Ran {
    judged(world, ask(world, lookups))
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), 1);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0) && ran.kept.iter().all(Option::is_none));
}

/// A floor under a roof: the shadow of the roof, from which more look-ups take the rim.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-1.0, 0.8, -1.0], [1.0, 0.8, -0.8], [0.1, 0.8, 1.0]]);
    let fine = world(gpu(), &mesh, above(), [120, 90], 1024, 1);
    let coarse = world(gpu(), &mesh, above(), [120, 90], 64, 1);
    let dark = |ran: &Ran| ran.on.visibility.iter().map(|&v| v == 0.0).collect::<Vec<_>>();
    let right = dark(&check(&fine, 1));
    assert!(right.iter().filter(|dark| **dark).count() > 300);
    let other = |lookups| {
        let got = dark(&check(&coarse, lookups));
        let count = |both: [bool; 2]| got.iter().zip(&right).filter(|(got, want)| [**got, **want] == both).count();
        [count([true, false]), count([false, true])]
    };
    let [[more, fewer], [more_of_3, fewer_of_3], [_, fewer_of_7]] = [1, 3, 7].map(other);
    assert!(more + fewer < 60 && more_of_3 < 5, "{more} and {more_of_3} pixels too dark, {fewer} too bright");
    assert!(fewer < fewer_of_3 && fewer_of_3 < fewer_of_7, "{fewer}, {fewer_of_3}, {fewer_of_7} pixels too bright");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), 1);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, lookups) in [1, 3, 5, 7].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind + k as u32).is_multiple_of(2), &mut random);
            let world = world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], [1, 32, 8, 128][k]);
            judged(&world, ask_of(&world, lookups, k % 2 == 0));
        }
    }
}

/// Of triangles with holes what is solid at a centre is kept.
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
        let ran = check(&tested, 1);
        others += usize::from(ran.on.visibility != ask(&plain, 1).on.visibility);
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
            check(&world, 1);
        }
    }
}

/// Without a bias a plane of 72 triangles does not shadow itself up to 89 degrees, as one polygon, nor a dome of as many. What only its own
/// triangle knows does, where others lie in its texels.
#[gpu_test]
fn degenerate() {
    let mut alone = 0;
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turn = |p: DVec3| DVec3::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z);
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let dark = |mesh: &Mesh, map, lookups, merged| {
            let world = World::new(gpu(), mesh, camera, light, [60, 45], map, samples(8));
            let ran = judged(&world, ask_of(&world, lookups, merged));
            ran.on.visibility.iter().filter(|v| **v < 1.0).count()
        };
        let flat = sheet(6, 1.5, |_, _| 0.0, turn);
        if degrees == 0.0 {
            for lookups in [1, 3, 5, 7] {
                assert_eq!(dark(&flat, 4, lookups, true), 0, "{lookups} look-ups: pixels of acne on one polygon");
            }
            alone += dark(&flat, 4, 1, false);
        }
        // From the side a dome shadows itself.
        let domed = (degrees < 85.0).then(|| sheet(6, 1.5, |x, z| -0.02 * (x * x + z * z), turn));
        for mesh in [Some(&flat), domed.as_ref()].into_iter().flatten() {
            for lookups in [3, 5, 7] {
                let dark = dark(mesh, 128, lookups, false);
                assert_eq!(dark, 0, "{lookups} look-ups, {degrees} degrees: pixels of acne");
            }
        }
    }
    assert!(alone > 0, "polygons are of no use");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), 1);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), 1);
    assert!(of(folding_gpu()).on.visibility == of(gpu()).on.visibility, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, 1);
    assert!(ran.on.visibility == ask(&world, 1).on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, 1);
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
    assert!(spoilt(&|r| r.lookups = 7));
    assert!(spoilt(&|r| r.surfaces.fill(0)));
}
