//! The maps of slices, texel by texel against `f64` in the whole light view: each key lies between the depths that places near its
//! texel's centre have.

use crate::support::depth_map::OnMap;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on, random_light, random_scene, samples, soup,
};
use crate::support::splits::{OnSplits, WARPS, plan, rounding};
use crate::support::{Random, gpu, sizes_around};
use gpu_test::gpu_test;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::light_view::Warp;
use subpixel_shadows::reference::split_maps::depths;
use subpixel_shadows::reference::view::centre;
use subpixel_shadows::scene::{Light, Mesh};

/// Where the stage departs from its definition; how many texels were compared, and how many of them closely.
fn fault(world: &World, ran: &OnSplits) -> Result<[usize; 2], String> {
    let size = world.view.map.map_size;
    let (mut compared, mut close) = (0, 0);
    for (k, split) in ran.views.iter().enumerate() {
        let reach = 1.0 / 64.0 + rounding(world, split);
        let margin = f64::from(world.frame.depth_margin);
        let wanted = depths(&world.triangles, split, size, reach, margin);
        let back = split.warp.inverse();
        for (texel, (got, want)) in ran.depths(k).into_iter().zip(&wanted).enumerate() {
            let place = back * centre(texel as u32 % size, texel as u32 / size).extend(1.0);
            // Rows of the border may lie beyond the horizon; casters beside the whole view have no work there.
            let beyond = place.z <= 0.0;
            let place = place.truncate() / place.z;
            if beyond || place.min_element() < 1.0 || place.max_element() > f64::from(size) - 1.0 {
                continue;
            }
            let right = match got {
                None => want.greatest.is_none(),
                Some(d) => {
                    want.least.is_some_and(|least| least <= d.max(1e-9))
                        && want.greatest.is_none_or(|greatest| d <= greatest.max(0.0))
                }
            };
            if !right {
                let at = [texel as u32 % size, texel as u32 / size];
                return Err(format!("view {k}, texel {at:?} at {place}: {got:?}, {want:?} expected"));
            }
            compared += 1;
            let narrow = want.least.zip(want.greatest).is_some_and(|(a, b)| b - a < 0.02);
            close += usize::from(narrow || want.least.is_none());
        }
    }
    Ok([compared, close])
}

#[track_caller]
fn check(world: &World, splits: u32, warp: Warp) -> OnSplits {
    let ran = OnSplits::of(world, &plan(splits, warp));
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 20 >= compared, "{close} of {compared} texels compared closely"),
        Err(text) => panic!("{warp:?}, {splits} splits, {:?}: {text}", world.light),
    }
    ran
}

fn world(mesh: &Mesh, light: Light, map: u32) -> World {
    looked_down_on(gpu(), mesh, light, [64, 48], map, 1)
}

/// Among the casters of a scene, a little above what stands there.
fn among(mesh: &Mesh, light: Light, map: u32) -> World {
    let camera = camera(DVec3::new(0.2, 0.4, 0.9), DVec3::new(-0.5, -0.6, -1.0), 70.0);
    World::new(gpu(), mesh, camera, light, [64, 48], map, samples(1))
}

#[gpu_test]
fn empty() {
    for warp in WARPS {
        let ran = check(&world(&Mesh::default(), above(), 9), 3, warp);
        assert!(ran.keys.iter().all(|&k| k == 0) && ran.keys.len() == 3 * 81);
    }
}

#[gpu_test]
fn one() {
    let mesh = soup(1, 1.0, &mut Random::new(3));
    for (warp, map) in WARPS.into_iter().flat_map(|w| [1, 2, 8, 33].map(|m| (w, m))) {
        let ran = check(&world(&mesh, above(), map), 2, warp);
        assert!(map < 8 || ran.keys.iter().any(|&k| k != 0), "nothing in a map of {map}");
    }
}

/// One view that is not warped is the map of `light_layers`, but for texels at borders and roundings of depth.
#[gpu_test]
fn a_whole_view_is_the_map_of_light_layers() {
    let mut random = Random::new(37);
    for kind in 0..4 {
        let light = random_light(kind % 2 == 0, &mut random);
        let world = world(&random_scene(kind, &mut random), light, 100);
        let [ours, theirs] =
            [OnSplits::of(&world, &plan(1, Warp::Whole)).depths(0), OnMap::of(&world, |_, _, _, _, _| {}).depths];
        let alike = |a: &Option<f64>, b: &Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 1e-3,
            (a, b) => a.is_none() && b.is_none(),
        };
        let off = ours.iter().zip(&theirs).filter(|(a, b)| !alike(a, b)).count();
        assert!(off * 200 < ours.len() && theirs.iter().flatten().count() > 1000, "{off} of {} differ", ours.len());
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(5);
    for (k, map) in sizes_around(8).into_iter().chain([63, 64, 65]).enumerate() {
        check(&world(&random_scene(k as u32, &mut random), above(), map as u32), 3, WARPS[k % 5]);
    }
    for (k, count) in sizes_around(64).into_iter().enumerate() {
        check(&world(&soup(count, 0.4, &mut random), above(), 24), 1 + k as u32 % 4, WARPS[k % 5]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(7);
    for (kind, (k, warp)) in (0..4).flat_map(|kind| WARPS.into_iter().enumerate().map(move |w| (kind, w))) {
        let mesh = random_scene(kind, &mut random);
        let light = random_light((kind + k as u32).is_multiple_of(2), &mut random);
        let map = [40, 100][k % 2];
        check(&world(&mesh, light, map), 1 + k as u32 % 4, warp);
        check(&among(&mesh, light, map), 3, warp);
    }
}

/// A camera along the light, triangles that reach behind eye, light and the map's horizon, one of them with a vertex twice.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(11);
    let mut mesh = random_scene(1, &mut random);
    let wide = [[-60.0, -1.3, -50.0], [70.0, -1.3, -55.0], [3.0, -1.3, 80.0]];
    mesh.positions.extend(wide);
    let base = mesh.positions.len() as u32 - 3;
    mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 1], [base, base, base + 1]]);
    let lights =
        [above(), Light::Point { position: [0.1, 0.9, 0.2] }, Light::Directional { direction: [0.0, 0.02, 1.0] }];
    for (light, warp) in lights.into_iter().flat_map(|l| WARPS.map(|w| (l, w))) {
        check(&among(&mesh, light, 48), 3, warp);
    }
    let along = camera(DVec3::new(0.9, 3.0, 0.6), DVec3::ZERO, 50.0);
    for warp in WARPS {
        check(&World::new(gpu(), &mesh, along, above(), [64, 48], 48, samples(1)), 2, warp);
    }
}

/// Maps of one texel and of few.
#[gpu_test]
fn smallest() {
    for map in [1, 2, 3] {
        for (k, warp) in WARPS.into_iter().enumerate() {
            let mesh = random_scene(k as u32, &mut Random::new(13));
            check(&world(&mesh, above(), map), 4, warp);
        }
    }
}

/// More workgroups of blocks than one dimension of a dispatch holds; the stage has no list that could run over.
#[gpu_test]
fn beyond_one_dimension() {
    let mut mesh = Mesh::default();
    for k in 0..36 {
        let height = 0.01 * f64::from(k % 7) - 0.3;
        let corners = [[-3.0, height, -3.0], [3.0, height, -3.0], [0.0, height + 0.1, 6.0]];
        add_triangle(&mut mesh, corners.map(|c| c.map(|v| v as f32)));
    }
    let world = looked_down_on(gpu(), &mesh, above(), [64, 48], 2048, 1);
    let ran = OnSplits::of(&world, &plan(4, Warp::Whole));
    let blocks: u64 = ran.maps.items.read(gpu()).expect("readback").iter().map(|&n| u64::from(n)).sum();
    assert!(blocks > 65_535 * 64, "{blocks} blocks");
    // All views are one, and the blocks of the last lie in the second row of workgroups.
    let texels = ran.keys.len() / 4;
    assert!(ran.keys[..texels] == ran.keys[3 * texels..], "the last view differs from the first");
    assert!(ran.keys[..texels].iter().filter(|k| **k != 0).count() > texels / 3);
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(0, &mut Random::new(19));
    // Four workgroups of triangles in two rows. The folded blocks are those of overflow_by_one: the stage that makes their arguments
    // does not know of a device's smaller limits.
    let measured = |gpu| {
        let world = looked_down_on(gpu, &mesh, above(), [24, 24], 8, 1);
        OnSplits::measured(&world, &plan(4, Warp::Trapezoid)).rects.read(gpu).expect("readback")
    };
    let rects = measured(gpu());
    assert!(rects.len() > 3 * 64 && measured(folding_gpu()) == rects, "the fold changes the result");
}

/// Levels of the largest map, and sizes that no map has.
#[test]
fn levels_of_any_size() {
    use subpixel_shadows::stages::split_maps::SplitViews;
    let levels = |size| SplitViews::levels_of(size);
    assert_eq!([0, 1, 2, 3, 8192, u32::MAX].map(levels), [0, 0, 1, 2, 13, 32]);
    let largest = SplitViews::new(&[], 8192, 1.0);
    assert_eq!((largest.levels, SplitViews::new(&[], u32::MAX, 1.0).levels), (13, 13));
    assert_eq!(largest.level_stride as usize, SplitViews::moments_of(8192));
}

#[gpu_test]
fn detects_corruption() {
    let world = world(&random_scene(1, &mut Random::new(23)), above(), 64);
    let of = || OnSplits::of(&world, &plan(3, Warp::Trapezoid));
    let ran = check(&world, 3, Warp::Trapezoid);
    assert!(ran.keys == of().keys, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut OnSplits)| {
        let mut off = of();
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let held = |k: &u32| *k != 0;
    let middle = ran.keys.len() / 3 + ran.keys.len() / 6 + 32;
    let texel = (middle..).find(|&k| held(&ran.keys[k])).expect("a caster");
    assert!(spoilt(&|r| r.keys[texel] = 0));
    assert!(spoilt(&|r| r.keys[texel] = !(f32::from_bits(!r.keys[texel]) + 0.1).to_bits()));
    assert!(spoilt(&|r| r.keys.rotate_right(1)));
    assert!(spoilt(&|r| r.keys.rotate_right(64 * 64)));
    assert!(spoilt(&|r| r.views[1].warp *= subpixel_shadows::glam::DMat3::from_translation(DVec2::new(1.0, 0.0))));
}
