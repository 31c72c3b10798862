//! Shadows by the maps of slices, pixel by pixel against `f64` on the same maps. What rounding may turn over (a place at a texel's
//! border, a depth at the receiver's, a pixel at the end of a slice, the number of squares along a footprint) makes an interval of
//! visibility, in which the kernel's has to lie.

use crate::support::shadow::{
    Pipelines, World, above, camera, folding_gpu, looked_down_on, random_light, random_scene, samples, sheet, uniform,
};
use crate::support::splits::{OnSplits, WARPS, in_split, on_plane, plan, rounding};
use crate::support::spsm::{faces_away, noise, receiver};
use crate::support::{POISON, Random, gpu, run, sizes_around};
use gpu_test::gpu_test;
use subpixel_shadows::glam::{DMat2, DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, kernels};
use subpixel_shadows::light_view::Warp;
use subpixel_shadows::reference::split_shadows::{Map, MomentQuery, Receiver};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::map_moments::MapMoments;
use subpixel_shadows::stages::split_shadows::{OfMaps, SplitQuery, SplitShadows};

const DEPTHS: SplitQuery = SplitQuery::Depths { constant: 5e-5, slope: 1.05 };
const MOMENTS: SplitQuery = SplitQuery::Moments { constant: 5e-5, bleeding: 0.0, grazing: 0.0 };
const REDUCED: SplitQuery = SplitQuery::Moments { constant: 5e-5, bleeding: 0.3, grazing: 0.4 };

struct Ran {
    ask: SplitQuery,
    on: OnSplits,
    seen: Vec<Option<u32>>,
    visibility: Vec<f32>,
}

fn ask(world: &World, ask: SplitQuery, splits: u32, warp: Warp) -> Ran {
    static REDUCE: Pipelines<MapMoments> = Pipelines::new();
    let gpu = world.gpu;
    let on = OnSplits::of(world, &plan(splits, warp));
    let (size, views) = (world.view.map.map_size, on.views.len());
    let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
    let id_keys = Buffer::from_slice(&gpu.device, &gpu.queue, "test.ids", &keys).expect("memory");
    let visibility = Buffer::<f32>::storage(&gpu.device, "test.visibility", seen.len()).expect("memory");
    visibility.write(&gpu.queue, &vec![f32::from_bits(POISON); seen.len()]);
    let moments = MapMoments::memory(&gpu.device, views, size).expect("memory");
    let (frame, offsets, points) = (uniform(gpu, &world.frame), world.sample_offsets(), world.points());
    let triangles = &world.casters.triangles;
    let reduce = REDUCE.get(gpu, 0, || MapMoments::new(&gpu.device));
    let stage = SplitShadows::new(&gpu.device, ask);
    run(gpu, |s| {
        reduce.record(s, &frame, &on.splits, &on.maps.keys, &moments, views, size);
        let from = PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles, points: &points };
        let maps = OfMaps { splits: &on.splits, keys: &on.maps.keys, moments: &moments };
        stage.record(s, &frame, from, maps, &visibility);
    });
    let visibility = visibility.read(gpu).expect("readback");
    Ran { ask, on, seen, visibility }
}

/// Around a place, in texels.
fn around(at: DVec2, by: f64) -> [DVec2; 5] {
    [[0.0, 0.0], [-by, -by], [by, -by], [-by, by], [by, by]].map(|o| at + DVec2::from(o))
}

/// The least and the greatest of what is found.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([1.0, 0.0], |[lo, hi]: [f64; 2], v| [lo.min(v), hi.max(v)])
}

/// A point of a pixel's receiver in the map of a slice, and what rounding leaves open there: texels and depth.
fn placed(world: &World, ran: &Ran, slice: usize, p: DVec3, slope: DVec2) -> Option<(Receiver, [f64; 2])> {
    let split = &ran.on.views[slice];
    let whole = world.view.on_map(p)?.truncate();
    let r = Receiver { at: in_split(split, p)?, ..Receiver::new(split, whole.truncate(), whole.z, slope) };
    let [texels, depth] = noise(world);
    let texels = texels + rounding(world, split) / 8.0;
    let doubt = depth + 2e-6 + (r.slope.x.abs() + r.slope.y.abs()) * texels * 2.0;
    Some((r, [texels, doubt]))
}

/// What visibility a pixel may have; `None` where its receiver cannot be told.
fn wanted(world: &World, ran: &Ran, maps: &[Map], pixel: u32, t: u32) -> Option<[f64; 2]> {
    let (_, slope, _) = receiver(world, pixel, t)?;
    let forward = world.view.rays.forward;
    let point = |offset: DVec2| on_plane(world, pixel, t, offset);
    match ran.ask {
        SplitQuery::Depths { constant, slope: bias } => {
            let [constant, bias] = [constant, bias].map(f64::from);
            let (mut sum, mut seen) = ([0.0, 0.0], 0.0);
            for offset in world.samples.offsets() {
                let Some(p) = point(DVec2::from(offset.map(f64::from)) - 0.5) else { continue };
                if world.view.on_map(p).is_none() {
                    continue;
                }
                seen += 1.0;
                let of_slice = |k: usize| {
                    let map = &maps[k];
                    let Some((r, [texels, depth])) = placed(world, ran, k, p, slope) else { return vec![1.0] };
                    let lit = |at: DVec2, depth: f64| {
                        !map.holds(at) || map.is_lit(&Receiver { at, depth, ..r }, constant, bias)
                    };
                    let places = around(r.at, texels).into_iter();
                    places
                        .flat_map(|at| [-depth, depth].map(|d| f64::from(u8::from(lit(at, r.depth + d)))))
                        .collect::<Vec<_>>()
                };
                let [low, high] = range(ran.on.slices(p.dot(forward)).into_iter().flat_map(of_slice));
                sum = [sum[0] + low, sum[1] + high];
            }
            (seen > 0.0).then(|| sum.map(|s| s / seen))
        }
        SplitQuery::Moments { constant, bleeding, grazing } => {
            let [a, b, c] = world.triangles[t as usize].corners?;
            let normal = (b - a).cross(c - a).normalize();
            let to_light = world.view.light.truncate() - a * world.view.light.w;
            let sine = normal.dot(to_light.normalize()).abs();
            if (sine - f64::from(grazing)).abs() < 1e-4 {
                return None;
            }
            if sine < f64::from(grazing) {
                return Some([0.5; 2]);
            }
            let p = point(DVec2::ZERO)?;
            let asked = MomentQuery {
                constant: f64::from(constant),
                bleeding: f64::from(bleeding),
                most_probes: f64::from(kernels::split_shadows::MOST_PROBES),
            };
            let of_slice = |k: usize| {
                let map = &maps[k];
                let Some((r, [texels, depth])) = placed(world, ran, k, p, slope) else { return vec![1.0] };
                let step = |dx: f64, dy: f64| {
                    let at = |by: f64| point(DVec2::new(dx, dy) * by).and_then(|p| in_split(&ran.on.views[k], p));
                    Some((at(1e-4)? - at(-1e-4)?) / 2e-4)
                };
                let (Some(x), Some(y)) = (step(1.0, 0.0), step(0.0, 1.0)) else { return vec![0.0, 1.0] };
                let mut found = Vec::new();
                for at in around(r.at, texels) {
                    if !map.holds(at) {
                        found.push(1.0);
                        continue;
                    }
                    for (d, by) in [-depth, depth].into_iter().flat_map(|d| [0.999, 1.0, 1.001].map(|by| (d, by))) {
                        let r = Receiver { at, depth: r.depth + d, ..r };
                        found.push(map.filtered(&r, DMat2::from_cols(x, y) * by, &asked));
                    }
                }
                found
            };
            Some(range(ran.on.slices(p.dot(forward)).into_iter().flat_map(of_slice)))
        }
    }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[usize; 2], String> {
    let size = world.view.map.map_size;
    let map = |k: usize| Map::new(ran.on.depths(k), size, f64::from(ran.on.far as f32));
    let maps: Vec<Map> = (0..ran.on.views.len()).map(map).collect();
    let (mut compared, mut close) = (0, 0);
    for (pixel, &v) in ran.visibility.iter().enumerate() {
        let at = format!("pixel {pixel}, visibility {v}");
        let Some(t) = ran.seen[pixel] else {
            if v != 1.0 {
                return Err(format!("{at}: nothing is seen"));
            }
            continue;
        };
        let Some(dark) = faces_away(world, t) else { continue };
        if dark {
            if v != 0.0 {
                return Err(format!("{at}: it faces away from the light"));
            }
            continue;
        }
        let Some([low, high]) = wanted(world, ran, &maps, pixel as u32, t) else { continue };
        compared += 1;
        close += usize::from(high - low < 0.05);
        if !(low - 2e-3..=high + 2e-3).contains(&f64::from(v)) {
            return Err(format!("{at}: {low} to {high} expected"));
        }
    }
    Ok([compared, close])
}

#[track_caller]
fn check(world: &World, how: SplitQuery, splits: u32, warp: Warp) -> Ran {
    let ran = ask(world, how, splits, warp);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 3 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{how:?}, {warp:?} of {splits}, {:?}: {text}", world.light),
    }
    ran
}

fn world(mesh: &Mesh, light: Light, size: [u32; 2], map: u32, count: u32) -> World {
    looked_down_on(gpu(), mesh, light, size, map, count)
}

#[gpu_test]
fn empty() {
    for how in [DEPTHS, MOMENTS] {
        let ran = check(&world(&Mesh::default(), above(), [3, 2], 8, 8), how, 3, Warp::Trapezoid);
        assert!(ran.visibility.iter().all(|&v| v == 1.0));
    }
}

#[gpu_test]
fn one() {
    let mesh = random_scene(1, &mut Random::new(29));
    for (how, warp) in [DEPTHS, MOMENTS].into_iter().flat_map(|h| WARPS.map(|w| (h, w))) {
        let ran = check(&world(&mesh, above(), [96, 72], 128, 8), how, 3, warp);
        let count = |wanted: &dyn Fn(f32) -> bool| ran.visibility.iter().filter(|v| wanted(**v)).count();
        assert!(
            count(&|v| v == 1.0) > 500 && count(&|v| v < 0.1) > 50 && count(&|v| v > 0.1 && v < 0.9) > 20,
            "{how:?}"
        );
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for (k, pixels) in sizes_around(64).into_iter().enumerate() {
        let how = [DEPTHS, MOMENTS][k % 2];
        check(&world(&mesh, above(), [pixels as u32, 1], 40, 8), how, 2, WARPS[k % 5]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for (kind, (k, warp)) in (0..4).flat_map(|kind| WARPS.into_iter().enumerate().map(move |w| (kind, w))) {
        for (j, how) in [DEPTHS, MOMENTS, REDUCED].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind as usize + k + j).is_multiple_of(2), &mut random);
            check(&world(&mesh, light, [40, 30], [64, 150][k % 2], [1, 32][j % 2]), how, 1 + k as u32 % 4, warp);
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
        for (how, warp) in [DEPTHS, MOMENTS].into_iter().flat_map(|h| WARPS.map(|w| (h, w))) {
            check(&world(&mesh, random_light(k % 2 == 0, &mut random), size, map, 8), how, 3, warp);
        }
    }
}

/// A bare plane does not shadow itself, however it is tilted and split and however fine the map; by depths without a bias it does.
#[gpu_test]
fn degenerate() {
    let unbiased = SplitQuery::Depths { constant: 0.0, slope: 0.0 };
    let mut spoilt = 0;
    for degrees in [0.0f64, 10.0, 45.0, 75.0, 85.0, 88.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let of = |how, map, warp| {
            let world = World::new(gpu(), &mesh, camera, light, [60, 45], map, samples(8));
            let ran = ask(&world, how, 3, warp);
            ran.visibility.iter().filter(|v| **v < 0.95).count()
        };
        for (warp, map) in WARPS.into_iter().flat_map(|w| [64, 512].map(|m| (w, m))) {
            for how in [DEPTHS, MOMENTS] {
                assert_eq!(of(how, map, warp), 0, "{how:?}, {warp:?}, {degrees} degrees, a map of {map}: acne");
            }
        }
        spoilt += of(unbiased, 64, Warp::Trapezoid);
    }
    assert!(spoilt > 0, "the bias is not needed");
    // The border of a tilted sheet over nothing, in texels of many pixels, is not dark either.
    let turn = |p: DVec3| DVec3::new(p.x, p.x, p.z) * 0.7;
    let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
    let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
    let world = World::new(gpu(), &sheet(6, 1.5, |_, _| 0.0, turn), camera, light, [300, 225], 64, samples(1));
    for warp in WARPS {
        let dark = ask(&world, MOMENTS, 2, warp).visibility.iter().filter(|v| **v < 0.95).count();
        assert_eq!(dark, 0, "{warp:?}: dark pixels at a border");
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    for how in [DEPTHS, MOMENTS] {
        let ran = ask(&world(&mesh, above(), [65_537, 1], 16, 1), how, 2, Warp::Box);
        assert!(ran.visibility.iter().all(|v| v.to_bits() != POISON));
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    for how in [DEPTHS, MOMENTS] {
        // The maps are made without a fold: so few triangles and texels.
        let of = |gpu| ask(&looked_down_on(gpu, &mesh, above(), [24, 24], 8, 8), how, 2, Warp::Fitted).visibility;
        assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
    }
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(&mesh, above(), [48, 36], 64, 32);
    for how in [DEPTHS, MOMENTS] {
        let of = || ask(&world, how, 3, Warp::Trapezoid);
        let ran = check(&world, how, 3, Warp::Trapezoid);
        assert!(ran.visibility == of().visibility, "another result in a second run");
        let spoilt = |spoil: &dyn Fn(&mut Ran)| {
            let mut off = of();
            spoil(&mut off);
            fault(&world, &off).is_err()
        };
        let of = |v: f32| (0..ran.seen.len()).find(|&p| ran.seen[p].is_some() && (ran.visibility[p] - v).abs() < 1e-3);
        let (lit, dark) = (of(1.0).expect("a lit pixel"), of(0.0).expect("a dark pixel"));
        assert!(spoilt(&|r| r.visibility[lit] = 0.5));
        assert!(spoilt(&|r| r.visibility[dark] = 0.5));
        assert!(spoilt(&|r| r.on.keys.fill(0)));
        assert!(spoilt(&|r| r.on.views.swap(0, 2)));
        assert!(spoilt(&|r| r.on.views.iter_mut().for_each(|v| v.rows[0] += v.rows[2] * 20.0)));
    }
    for other in [
        SplitQuery::Moments { constant: 0.02, bleeding: 0.0, grazing: 0.0 },
        SplitQuery::Moments { constant: 5e-5, bleeding: 0.2, grazing: 0.0 },
        SplitQuery::Moments { constant: 5e-5, bleeding: 0.0, grazing: 0.9 },
    ] {
        let ran = Ran { ask: other, ..ask(&world, MOMENTS, 3, Warp::Trapezoid) };
        assert!(fault(&world, &ran).is_err(), "{other:?}");
    }
}
