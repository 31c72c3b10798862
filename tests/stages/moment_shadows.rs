//! Shadows by the moments of a map, pixel by pixel against `f64` on the same map. What rounding may turn over (a place at a texel's border, a
//! depth at the receiver's, the number of squares along a footprint) makes an interval of visibility, in which the kernel's has to lie.

use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, camera, folding_gpu, looked_down_on, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::{noise, on_plane, receiver};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::moment_shadows::{Measure, MomentBound, MomentQuery, Moments, Receiver, Wave};
use subpixel_shadows::glam::{DMat2, DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Gpu, kernels};
use subpixel_shadows::light_view::{LightView, SplitPlan, Warp};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::map_moments::{MapLevels, MapMoments, MomentMeasures};
use subpixel_shadows::stages::moment_shadows::{MapWithMoments, MomentShadows, MomentShadowsOptions};
use test_support::gpu_test;

const PLAIN: MomentShadowsOptions =
    MomentShadowsOptions { constant: 5e-5, bleeding: 0.0, grazing: 0.0, measures: MomentMeasures::Depths };
const REDUCED: MomentShadowsOptions = MomentShadowsOptions { bleeding: 0.3, grazing: 0.4, ..PLAIN };
/// Exponentials: the steepest, the usual and a flat one, with and without light taken off.
const EXPONENTIALS: [MomentShadowsOptions; 4] = [
    MomentShadowsOptions { measures: MomentMeasures::Rising(40.0), ..PLAIN },
    MomentShadowsOptions { measures: MomentMeasures::Both(MomentMeasures::STEEPEST), ..PLAIN },
    MomentShadowsOptions { measures: MomentMeasures::Both(7.5), ..REDUCED },
    MomentShadowsOptions { measures: MomentMeasures::Rising(1.0), ..REDUCED },
];
const FOUR: MomentShadowsOptions = MomentShadowsOptions { measures: MomentMeasures::Four, ..PLAIN };
const LAYERED: MomentShadowsOptions = MomentShadowsOptions { measures: MomentMeasures::Layers(4), ..PLAIN };
const WAVES: MomentShadowsOptions = MomentShadowsOptions { measures: MomentMeasures::Waves(16), ..PLAIN };
const WARPS: [Warp; 7] =
    [Warp::Whole, Warp::Box, Warp::Stable, Warp::Trapezoid, Warp::LightSpace, Warp::Perspective, Warp::Fitted];

struct Ran {
    options: MomentShadowsOptions,
    far: f32,
    on: OnMap,
}

fn ask(world: &World, options: MomentShadowsOptions) -> Ran {
    let gpu = world.gpu;
    let size = world.view.map.map_size;
    let bounds = world.prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
    let scaled = |p: DVec3| (p - world.view.eye) * world.view.scale;
    let (map, directional) = (&world.view.map, world.light.is_directional());
    // Of a slice the divisor, 1 in world units, is that of the scaled ones.
    let unit = if map.perspective && directional { world.view.scale } else { 1.0 };
    let map = LightView { z: map.z / unit, ..*map };
    let far = MapLevels::farthest(&map, directional, (scaled(bounds.0), scaled(bounds.1))) as f32;
    let levels = Buffer::uniform(&gpu.device, "test.levels", 1).expect("memory");
    levels.write(&gpu.queue, &[MapLevels::new(size, f64::from(far))]);
    let reduce = MapMoments::new(&gpu.device, options.measures);
    let moments = reduce.memory(&gpu.device, size).expect("memory");
    let stage = MomentShadows::new(&gpu.device, options);
    let on = OnMap::of(world, |s, frame, seen, nearest_keys, visibility| {
        reduce.record(s, frame, &levels, nearest_keys, &moments, size);
        let map = MapWithMoments { levels: &levels, nearest_keys, moments: &moments };
        stage.record(s, frame, seen, map, visibility);
    });
    Ran { options, far, on }
}

/// Least and greatest visibility that a pixel may have; `None` where its receiver cannot be told.
fn wanted(world: &World, ran: &Ran, moments: &[Moments], pixel: u32, t: u32) -> Option<[f64; 2]> {
    let (_, slope, _) = receiver(world, pixel, t)?;
    let MomentShadowsOptions { constant, bleeding, grazing, measures } = ran.options;
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
    let place = on_plane(world, pixel, t, DVec2::ZERO)?;
    let step = |dx: f64, dy: f64| {
        let at = |by: f64| on_plane(world, pixel, t, DVec2::new(dx, dy) * by).map(DVec3::truncate);
        Some((at(1e-4)? - at(-1e-4)?) / 2e-4)
    };
    let (Some(x), Some(y)) = (step(1.0, 0.0), step(0.0, 1.0)) else { return Some([0.0, 1.0]) };
    let asked = MomentQuery {
        constant: f64::from(constant),
        bleeding: f64::from(bleeding),
        most_probes: f64::from(kernels::moment_shadows::MOST_PROBES),
        by: match measures {
            MomentMeasures::Rising(_) => MomentBound::Mean,
            MomentMeasures::Layers(_) => MomentBound::Layers,
            MomentMeasures::Waves(_) => MomentBound::Waves(f64::from(MomentMeasures::RINGING)),
            MomentMeasures::Four => MomentBound::Four(f64::from(MomentMeasures::FLATTEST)),
            _ => MomentBound::Variance,
        },
    };
    let [texels, depth] = noise(world);
    let doubt = depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * texels * 2.0;
    let mut found = Vec::new();
    for off in [[0.0, 0.0], [-texels, -texels], [texels, -texels], [-texels, texels], [texels, texels]] {
        let at = place.truncate() + DVec2::from(off);
        if !moments[0].holds(at) {
            found.push(1.0);
            continue;
        }
        for (d, by) in [-doubt, doubt].into_iter().flat_map(|d| [0.999, 1.0, 1.001].map(|by| (d, by))) {
            let r = Receiver { at, depth: place.z + d, slope };
            found.push(Moments::filtered(moments, &r, DMat2::from_cols(x, y) * by, &asked));
        }
    }
    let (low, high) = found.into_iter().fold((1.0f64, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    Some([low - 2e-3, high + 2e-3])
}

/// The measures that moments are of.
fn measures(of: MomentMeasures, far: f64) -> Vec<Measure> {
    let depths = Measure { far, exponent: 0.0, layer: None, wave: None };
    let warped = |c: f32| Measure { exponent: f64::from(c), ..depths };
    match of {
        MomentMeasures::Depths | MomentMeasures::Four => vec![depths],
        MomentMeasures::Rising(c) => vec![warped(c)],
        MomentMeasures::Both(c) => vec![warped(c), warped(-c)],
        MomentMeasures::Layers(count) => (0..count).map(|k| Measure { layer: Some([k, count]), ..depths }).collect(),
        MomentMeasures::Waves(terms) => {
            let waves = (0..terms).flat_map(|k| [Wave::Sine(k), Wave::Cosine(k)]);
            waves.map(|wave| Measure { wave: Some(wave), ..depths }).collect()
        }
    }
}

/// Where the stage departs from its definition; how many pixels were compared and how many of them closely.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let measures = measures(ran.options.measures, f64::from(ran.far));
    let of = |measure| Moments::new(&ran.on.depths, world.view.map.map_size, measure);
    let moments: Vec<Moments> = measures.into_iter().map(of).collect();
    ran.on.fault_of_pixels(world, |pixel, t| wanted(world, ran, &moments, pixel, t))
}

#[track_caller]
fn check(world: &World, options: MomentShadowsOptions) -> Ran {
    let ran = ask(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 3 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{options:?}, {:?}: {text}", world.light),
    }
    ran
}

fn world(mesh: &Mesh, light: Light, size: [u32; 2], map: u32) -> World {
    looked_down_on(gpu(), mesh, light, size, map, 1)
}

/// The same in the view of a slice of `splits`, the last but one.
fn sliced(mesh: &Mesh, light: Light, size: [u32; 2], map: u32, (splits, warp): (u32, Warp)) -> World {
    let camera = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    let plan = SplitPlan { splits, warp, focus: SplitPlan::FOCUS, ..SplitPlan::default() };
    let slice = Some((plan, splits.saturating_sub(2) as usize));
    World::in_slice(gpu(), mesh, (camera, light), size, map, samples(1), slice)
}

#[gpu_test]
fn empty() {
    let ran = check(&world(&Mesh::default(), above(), [3, 2], 8), PLAIN);
    assert!(ran.on.visibility.iter().all(|&v| v == 1.0));
}

#[gpu_test]
fn one() {
    let mesh = random_scene(1, &mut Random::new(29));
    for warp in WARPS {
        let ran = check(&sliced(&mesh, above(), [96, 72], 128, (1, warp)), PLAIN);
        let count = |wanted: &dyn Fn(f32) -> bool| ran.on.visibility.iter().filter(|v| wanted(**v)).count();
        let counts = [count(&|v| v == 1.0), count(&|v| v < 0.1), count(&|v| v > 0.1 && v < 0.9)];
        assert!(counts[0] > 500 && counts[1] > 50 && counts[2] > 20, "{warp:?}: {counts:?}");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for (k, pixels) in sizes_around(64).into_iter().enumerate() {
        check(&sliced(&mesh, above(), [pixels as u32, 1], 40, (2, WARPS[k % 5])), PLAIN);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for (kind, (k, warp)) in (0..4).flat_map(|kind| WARPS.into_iter().enumerate().map(move |w| (kind, w))) {
        for (j, options) in [PLAIN, REDUCED].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light((kind as usize + k + j).is_multiple_of(2), &mut random);
            check(&world(&mesh, light, [40, 30], [64, 150][k % 2]), options);
            check(&sliced(&mesh, light, [40, 30], [64, 150][k % 2], (1 + k as u32 % 4, warp)), options);
        }
    }
}

/// Exponentials of depth in place of depths, and four moments, in all warps.
#[gpu_test]
fn other_measures() {
    let mut random = Random::new(53);
    let four = [FOUR, MomentShadowsOptions { measures: MomentMeasures::Four, ..REDUCED }];
    let layered = [LAYERED, MomentShadowsOptions { measures: MomentMeasures::Layers(7), ..REDUCED }];
    let waves = [WAVES, MomentShadowsOptions { measures: MomentMeasures::Waves(3), ..REDUCED }];
    for (k, options) in EXPONENTIALS.into_iter().chain(four).chain(layered).chain(waves).enumerate() {
        for (kind, warp) in [(1, WARPS[k % 5]), (2, WARPS[(k + 1) % 5]), (3, WARPS[0])] {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(kind % 2 == 0, &mut random);
            check(&world(&mesh, light, [40, 30], 64), options);
            check(&sliced(&mesh, light, [40, 30], 150, (1 + k as u32 % 3, warp)), options);
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
        for warp in WARPS {
            check(&sliced(&mesh, random_light(k % 2 == 0, &mut random), size, map, (3, warp)), PLAIN);
        }
    }
}

/// A bare plane does not shadow itself, however it is tilted and warped and however fine the map.
#[gpu_test]
fn degenerate() {
    let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
    let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
    let dark = |mesh: &Mesh, size, map, warp, options| {
        let plan = SplitPlan { splits: 1, warp, focus: SplitPlan::FOCUS, ..SplitPlan::default() };
        let world = World::in_slice(gpu(), mesh, (camera, light), size, map, samples(1), Some((plan, 0)));
        ask(&world, options).on.visibility.iter().filter(|v| **v < 0.95).count()
    };
    // Over a square that is mostly empty texels are wider than such a sheet.
    let around = || WARPS.into_iter().filter(|warp| *warp != Warp::Stable);
    for degrees in [0.0f64, 10.0, 45.0, 75.0, 85.0, 88.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        for (warp, map) in around().flat_map(|w| [64, 512].map(|m| (w, m))) {
            for options in [PLAIN, EXPONENTIALS[0], EXPONENTIALS[1], FOUR, LAYERED, WAVES] {
                let dark = dark(&mesh, [60, 45], map, warp, options);
                // The falling exponential bends over the large texels of a trapezoid's far side; on a slope of 88 degrees a texel's depths are far
                // apart, and four moments bound them closely.
                let most = match options.measures {
                    MomentMeasures::Both(_) if warp == Warp::Trapezoid => 12,
                    MomentMeasures::Four if degrees > 85.0 => 4,
                    // A series takes its step over a sixteenth of all depths, not at once: of a slope, a footprint's depths lie on it unevenly at
                    // its border.
                    MomentMeasures::Waves(_) if degrees > 0.0 => 24,
                    _ => 0,
                };
                assert!(
                    dark <= most,
                    "{options:?}, {warp:?}, {degrees} degrees, a map of {map}: {dark} pixels of acne"
                );
            }
        }
    }
    // The border of a tilted sheet over nothing, in texels of many pixels, is not dark either; what floats before itself is.
    let mesh = sheet(6, 1.5, |_, _| 0.0, |p: DVec3| DVec3::new(p.x, p.x, p.z) * 0.7);
    for warp in around() {
        assert_eq!(dark(&mesh, [300, 225], 64, warp, PLAIN), 0, "{warp:?}: dark pixels at a border");
    }
    let before_itself = MomentShadowsOptions { constant: -0.05, ..PLAIN };
    assert!(dark(&mesh, [60, 45], 64, Warp::Box, before_itself) > 100, "the bias is not used");
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = ask(&world(&mesh, above(), [65_537, 1], 16), PLAIN);
    assert!(ran.on.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu: &'static Gpu| ask(&looked_down_on(gpu, &mesh, above(), [24, 24], 8, 1), PLAIN).on.visibility;
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

/// A map on a paraboloid: the footprint is that of the bent place.
#[gpu_test]
fn paraboloids() {
    let from = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    let light = Light::Point { position: [0.1, 0.9, 0.2] };
    for (kind, k) in [(0, 0), (1, 1), (1, 0)] {
        let mesh = random_scene(kind, &mut Random::new(83));
        let world = World::in_paraboloid(gpu(), &mesh, (from, light), [48, 36], 128, samples(1), k);
        for measures in [MomentMeasures::Depths, MomentMeasures::Rising(20.0), MomentMeasures::Four] {
            check(&world, MomentShadowsOptions { measures, ..PLAIN });
        }
    }
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = sliced(&mesh, above(), [48, 36], 64, (1, Warp::Trapezoid));
    let ran = check(&world, PLAIN);
    assert!(ran.on.visibility == ask(&world, PLAIN).on.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, PLAIN);
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let of = |v: f32| {
        let there = |p: &usize| ran.on.seen[*p].is_some() && (ran.on.visibility[*p] - v).abs() < 1e-3;
        (0..ran.on.seen.len()).find(there).expect("a pixel")
    };
    let (lit, dark) = (of(1.0), of(0.0));
    assert!(spoilt(&|r| r.on.visibility[lit] = 0.5));
    assert!(spoilt(&|r| r.on.visibility[dark] = 0.5));
    assert!(spoilt(&|r| r.on.depths.fill(None)));
    assert!(spoilt(&|r| r.on.depths.rotate_right(3)));
    for other in [
        MomentShadowsOptions { constant: 0.02, ..PLAIN },
        MomentShadowsOptions { bleeding: 0.2, ..PLAIN },
        MomentShadowsOptions { grazing: 0.9, ..PLAIN },
        EXPONENTIALS[0],
    ] {
        assert!(fault(&world, &Ran { options: other, ..ask(&world, PLAIN) }).is_err(), "{other:?}");
    }
    let [mean, both, ..] = EXPONENTIALS;
    let flatter = MomentShadowsOptions { measures: MomentMeasures::Both(20.0), ..both };
    let fewer = MomentShadowsOptions { measures: MomentMeasures::Layers(3), ..LAYERED };
    let short = MomentShadowsOptions { measures: MomentMeasures::Waves(12), ..WAVES };
    for (one, other) in [(mean, both), (both, flatter), (FOUR, PLAIN), (LAYERED, fewer), (WAVES, short)] {
        check(&world, one);
        assert!(fault(&world, &Ran { options: other, ..ask(&world, one) }).is_err(), "{one:?} as {other:?}");
    }
}
