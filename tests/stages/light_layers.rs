//! The two nearest casters at each texel centre, against `f64`: every texel whose centre is within the guard of an edge is
//! marked; at all others both depths agree.

use crate::support::depth_map::OnMap;
use crate::support::geometry::{
    Case, MESHES, Ran, Wanted, add, fan, holes, light, mesh, run_all, with_what_turns_away,
};
use crate::support::shadow::{World, add_triangle, camera, random_light, random_scene, samples, vector};
use crate::support::{Random, gpu, sizes_around, small_gpu};
use oracle::reference::light_layers::{Layer, depth_in_front, shares_at};
use oracle::reference::triangle_setup::Reach;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::scene::{Light, Mesh};
use test_support::gpu_test;

/// The constant of the kernel.
const CENTRE_GUARD: f64 = 1.0 / 512.0;

/// Where the stage departs from its definition.
fn fault(case: &Case, ran: &Ran) -> Option<String> {
    let wanted = case.wanted();
    let marks = &ran.marks[0];
    // Casters next to a point light are placed less well than the guard; front_layer's margin, not the guard, is for them.
    let well_placed = ran.margin().texels - 1.0 / 64.0 < 0.5 * CENTRE_GUARD;
    let guard = CENTRE_GUARD;
    // Rounding of a vertex or an edge function eats into the guard, but never reaches the centre.
    let [inner, outer] = [0.25, 1.75].map(|share| wanted.layers(guard * share, 0.0));
    if marks.len() != inner.len() || ran.nearest_keys.len() != inner.len() || ran.second_keys.len() != inner.len() {
        return Some("another number of texels".to_owned());
    }
    for (texel, want) in inner.iter().enumerate() {
        if outer[texel].thin {
            continue;
        }
        let at = format!("texel {} {}", texel as u32 % case.map, texel as u32 / case.map);
        if want.open && well_placed && !marks[texel] && !near_tie(&wanted, ran, want) {
            return Some(format!("{at}: open, and not marked; {want:?}"));
        }
        if marks[texel] {
            if well_placed && !outer[texel].open {
                return Some(format!("{at}: marked without a reason; {want:?}"));
            }
            continue;
        }
        for (what, key, depth) in
            [("nearest", ran.nearest_keys[texel], want.nearest), ("second", ran.second_keys[texel], want.second)]
        {
            let got = (key != 0).then(|| f64::from(f32::from_bits(!key)));
            let agree = match (got, depth) {
                (None, None) => true,
                (Some(got), Some((depth, t))) => (got - depth.max(0.0)).abs() <= tolerance(&wanted, ran, t),
                _ => false,
            };
            let excused = what == "second" && near_tie(&wanted, ran, want);
            if !agree && !excused {
                return Some(format!("{at}: {what} {got:?}, {depth:?} expected, {want:?}"));
            }
        }
    }
    None
}

/// How far rounding may move the depth of triangle `t` at a texel centre.
fn tolerance(wanted: &Wanted, ran: &Ran, t: u32) -> f64 {
    let (triangle, texels) = (&wanted.triangles[t as usize], f64::from(ran.frame.map_margin));
    let slope = triangle.flat().and_then(|f| f.slope).map_or(0.0, |s| s.x.abs() + s.y.abs());
    let cut = triangle.cut().map_or(0.0, |cut| cut.depth_doubt(texels));
    f64::from(ran.frame.depth_margin) + slope * texels + cut
}

/// Whether the two nearest are too near each other for their order to be known. An exact tie that rounding parts is none
/// to the kernel: the split then lies between two depths that are one, and front_layer marks the texel.
fn near_tie(wanted: &Wanted, ran: &Ran, layer: &Layer) -> bool {
    let (Some((a, s)), Some((b, t))) = (layer.nearest, layer.second) else { return false };
    b - a <= tolerance(wanted, ran, s) + tolerance(wanted, ran, t)
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Ran {
    let ran = run_all(gpu, case);
    if let Some(text) = fault(case, &ran) {
        panic!("{:?}, map {}: {text}", case.light, case.map);
    }
    ran
}

#[gpu_test]
fn empty() {
    for map in [1, 8, 33] {
        let ran = check(gpu(), &Case::new(&Mesh::default(), light(0), [1, 1], map));
        assert!(ran.nearest_keys.iter().all(|&k| k == 0) && !ran.marks[0].contains(&true));
    }
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for (k, map) in [1, 2, 3, 8, 64].into_iter().enumerate() {
        check(gpu(), &Case::new(&mesh, light(k as u64), [1, 1], map));
    }
}

/// Alpha-tested triangles are in no layer, and mark nothing.
#[gpu_test]
fn what_has_holes_is_no_layer() {
    let mut others = 0;
    for (k, name) in MESHES.iter().enumerate() {
        let whole = Case::new(&mesh(name, 4), light(k as u64), [1, 1], 64);
        let tested = whole.clone().with_holes();
        let ran = check(gpu(), &tested);
        others += usize::from(fault(&whole, &ran).is_some());
    }
    assert!(others > MESHES.len() / 2, "a case that takes them for whole is noticed: {others}");
}

/// Without marks the depths hold of alpha-tested triangles what is solid at the centres, also of such that reach behind the light.
#[gpu_test]
fn without_marks_there_are_holes() {
    let mut random = Random::new(31);
    let [mut compared, mut through, mut seconds] = [0; 3];
    for seed in 0..6 {
        let mut mesh = random_scene(seed, &mut random);
        for _ in 0..4 {
            let [a, b, c] = [vector(&mut random), vector(&mut random), vector(&mut random)];
            let up = DVec3::new(0.0, 9.0, 0.0);
            let corners = [a * 2.0 - up * 0.3, b * 2.0 + up * f64::from(seed % 2 + 1), c * 6.0 - up * 0.1];
            add_triangle(&mut mesh, corners.map(|p| p.as_vec3().into()));
        }
        let light = match seed % 2 {
            0 => Light::Point { position: [0.3, 4.0 + seed as f32, 0.2] },
            _ => Light::Directional { direction: [0.3, 1.0, -0.2] },
        };
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let prepared = Prepared::with_alpha(&mesh, &holes(&mesh)).expect("a sound mesh");
        let world = World::of(gpu(), prepared, (camera, light), [4, 3], 64, samples(1), None);
        let on = OnMap::of(&world, |_, _, _, _, _| {});
        let [first, second] = OnMap::two_depths(&world);
        assert!(first == on.depths, "seed {seed}: the second depth changes the nearest");
        let side = world.view.map.map_size as usize;
        for (texel, got) in on.depths.iter().enumerate() {
            let at = DVec2::new((texel % side) as f64 + 0.5, (texel / side) as f64 + 0.5);
            let (mut whole, mut open) = (f64::INFINITY, false);
            let mut depths = Vec::new();
            for triangle in &world.triangles {
                let Some(corners) = triangle.corners else { continue };
                let Some((depth, inside)) = depth_in_front(&world.view, corners, at) else { continue };
                open |= inside.abs() < 0.05;
                if inside <= 0.0 {
                    continue;
                }
                whole = whole.min(depth);
                let solid = |x: f64, y: f64| {
                    let shares = shares_at(&world.view, corners, at + DVec2::new(x, y));
                    triangle.tested.is_none_or(|place| world.prepared.alpha().is_solid(place, shares))
                };
                let here = solid(0.0, 0.0);
                open |=
                    [(-0.05, 0.0), (0.05, 0.0), (0.0, -0.05), (0.0, 0.05)].iter().any(|&(x, y)| solid(x, y) != here);
                if here {
                    depths.push(depth);
                }
            }
            if open {
                continue;
            }
            depths.sort_by(f64::total_cmp);
            let [nearest, next] = [0, 1].map(|k| depths.get(k).copied().unwrap_or(f64::INFINITY));
            compared += 1;
            through += u32::from(nearest > whole);
            let off = |got: Option<f64>, want: f64| match got {
                None if want == f64::INFINITY => 0.0,
                Some(got) => (got - want.max(0.0)).abs(),
                None => f64::INFINITY,
            };
            let text = format!("seed {seed}, texel {at}: {got:?}, {nearest} expected, {whole} without holes");
            assert!(off(*got, nearest) < 2e-3, "{text}");
            // Two in one place are one.
            if next - nearest > 2e-3 {
                assert!(off(second[texel], next) < 2e-3, "{text}; second {:?}, {next} expected", second[texel]);
                seconds += u32::from(next < f64::INFINITY);
            }
        }
    }
    assert!(compared > 5000 && through > 500, "{compared} texels compared, {through} through holes");
    assert!(seconds > 1000, "{seconds} second depths compared");
}

/// Where the triangles that texels keep are not those of the nearest depths, by their own depths at the centres.
fn triangle_fault(world: &World, depths: &[Option<f64>], kept: &[Option<u32>]) -> Option<String> {
    let side = world.view.map.map_size as usize;
    (0..depths.len()).find_map(|texel| {
        let at = DVec2::new((texel % side) as f64 + 0.5, (texel / side) as f64 + 0.5);
        let depth = |t: u32| {
            let (depth, inside) = depth_in_front(&world.view, world.triangles[t as usize].corners?, at)?;
            (inside > -0.01).then_some(depth.max(0.0))
        };
        let agree = match (depths[texel], kept[texel]) {
            (None, None) => true,
            (Some(nearest), Some(t)) => depth(t).is_some_and(|depth| (depth - nearest).abs() < 2e-3),
            _ => false,
        };
        (!agree).then(|| format!("texel {at}: triangle {:?} for depth {:?}", kept[texel], depths[texel]))
    })
}

/// In two runs the triangle of the nearest depth is kept, the lowest where several are there.
#[gpu_test]
fn triangles_of_the_nearest_depths() {
    let mut random = Random::new(37);
    for seed in 0..8 {
        let mesh = random_scene(seed, &mut random);
        let light = random_light(seed % 2 == 0, &mut random);
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let prepared = match seed < 4 {
            true => Prepared::with_alpha(&mesh, &holes(&mesh)),
            false => Prepared::new(&mesh),
        };
        let world = World::of(gpu(), prepared.expect("a sound mesh"), (camera, light), [4, 3], 64, samples(1), None);
        let nearest = OnMap::of(&world, |_, _, _, _, _| {}).depths;
        let (on, kept) = OnMap::of_triangles(&world, |_, _, _, _, _| {});
        assert!(on.depths == nearest, "seed {seed}: triangles change the nearest");
        assert_eq!(triangle_fault(&world, &on.depths, &kept), None, "seed {seed}");
        assert!(kept == OnMap::of_triangles(&world, |_, _, _, _, _| {}).1, "seed {seed}: others in another run");
        let covered = kept.iter().position(Option::is_some).expect("a caster");
        let mut spoilt = kept.clone();
        spoilt[covered] = None;
        assert!(triangle_fault(&world, &on.depths, &spoilt).is_some());
        let count = world.triangles.len() as u32;
        let others: Vec<_> = kept.iter().map(|t| t.map(|t| (t + count / 2) % count)).collect();
        assert!(triangle_fault(&world, &on.depths, &others).is_some());
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in [sizes_around(8), sizes_around(64)[7..10].to_vec()].concat() {
        check(gpu(), &Case::new(&mesh("closed balls", size as u64), light(size as u64), [1, 1], size as u32));
    }
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [1, 1], 40));
    }
}

#[gpu_test]
fn random_seeded() {
    for (k, name) in MESHES.iter().enumerate() {
        for (seed, map) in [1, 3, 8, 33, 150].into_iter().enumerate() {
            let mut case = Case::new(&mesh(name, seed as u64), light((seed + k) as u64), [1, 1], map);
            case.cull_back = seed % 2 == 1;
            check(gpu(), &case);
        }
    }
    check(gpu(), &Case::new(&mesh("closed balls", 7), light(2), [1, 1], 512));
}

#[gpu_test]
fn degenerate() {
    // Two sheets in one place: both keys are the same wherever they cover a centre, and front_layer marks the texel.
    let doubled = Case::new(&mesh("doubled", 0), light(0), [1, 1], 64);
    let ran = check(gpu(), &doubled);
    assert!((0..64 * 64).all(|t| ran.marks[0][t] || ran.nearest_keys[t] == ran.second_keys[t]), "a tie is lost");
    assert!((0..64 * 64).all(|t| ran.nearest_keys[t] == 0 || ran.marks[2][t]), "a tie is not marked");
    // A vertex that is no number.
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [1, 1], 64);
    let mut positions = case.prepared.mesh().positions.clone();
    positions[11][2] = f32::NAN;
    case.positions = Some(positions);
    check(gpu(), &case);
    // A triangle that reaches behind the light is a layer where it surely covers a texel's centre.
    let mut mesh = self::mesh("closed balls", 2);
    add(
        &mut mesh,
        &[DVec3::new(0.25, -3.0, -0.5), DVec3::new(0.25, 8.0, -0.5), DVec3::new(0.25, 2.0, 40.0)],
        &[[0, 1, 2]],
    );
    let edge_on = Case::new(&mesh, Light::Point { position: [0.25, 1.5, 0.125] }, [1, 1], 64);
    assert!(edge_on.wanted().triangles.iter().any(|t| matches!(t.map, Reach::Cut(_))));
    check(gpu(), &edge_on);
    let mut random = Random::new(41);
    let mut held = 0;
    for _ in 0..12 {
        let mut mesh = self::mesh("closed balls", 2);
        let [a, b, c] = [vector(&mut random), vector(&mut random), vector(&mut random)];
        let up = DVec3::new(0.0, 9.0, 0.0);
        add(&mut mesh, &[a * 2.0 - up * 0.3, b * 2.0 + up, c * 6.0 - up * 0.1], &[[0, 1, 2]]);
        let case = Case::new(&mesh, Light::Point { position: [0.3, 4.0, 0.2] }, [1, 1], 64);
        let (wanted, ran) = (case.wanted(), check(gpu(), &case));
        let cut = |t: u32| wanted.triangles[t as usize].cut().is_some();
        let layers = wanted.layers(0.0, 0.0);
        let of_cut = |l: &&Layer| !l.thin && l.nearest.is_some_and(|(_, t)| cut(t));
        held += layers.iter().filter(of_cut).count();
        let Some(texel) = layers.iter().position(|l| of_cut(&l)) else { continue };
        let mut off = ran.clone();
        off.nearest_keys[texel] = 0;
        assert!(fault(&case, &off).is_some(), "a layer that is left out is noticed");
    }
    assert!(held > 500, "{held} texels held by what reaches behind the light");
}

/// The stage has no list. At most 65,535 work items fit one dimension of a dispatch of single invocations; here are more.
#[gpu_test]
fn beyond_one_dimension() {
    let mut mesh = Mesh::default();
    crate::support::geometry::ball(&mut mesh, DVec3::ZERO, 1.0, 200, 120);
    let ran = check(gpu(), &Case::new(&mesh, light(0), [1, 1], 512));
    assert!(ran.light_items.iter().map(|&n| n as usize).sum::<usize>() > 65_535);
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(40, 1 << 20);
    let mut dense = Mesh::default();
    crate::support::geometry::ball(&mut dense, DVec3::ZERO, 1.0, 40, 30);
    let case = Case::new(&dense, light(0), [1, 1], 150);
    let ran = check(&small, &case);
    assert!(ran.light_items.iter().sum::<u32>() > 40 * 64, "more than one row of workgroups");
    assert!(ran.words() == run_all(gpu(), &case).words(), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [1, 1], 64);
    let ran = check(gpu(), &case);
    assert!(ran.words() == run_all(gpu(), &case).words(), "another result in a second run");
    let sure = (0..64 * 64).find(|&t| ran.nearest_keys[t] != 0 && !ran.marks[0][t]).expect("a certain texel");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&case, &off).is_some()
    };
    assert!(spoilt(&|r| r.nearest_keys[sure] ^= 1 << 15));
    assert!(spoilt(&|r| r.nearest_keys[sure] = 0));
    // Where the second is as near as the nearest, either may be it.
    let seconds: Vec<usize> = (0..64 * 64).filter(|&t| ran.second_keys[t] != 0 && !ran.marks[0][t]).collect();
    let few = seconds.iter().step_by(seconds.len() / 8);
    let [none, nearer] = few.fold([0, 0], |[none, nearer], &t| {
        [
            none + u32::from(spoilt(&|r| r.second_keys[t] = 0)),
            nearer + u32::from(spoilt(&|r| r.second_keys[t] = !0x3d00_0000)),
        ]
    });
    assert!(none >= 4 && nearer >= 4, "{none}, {nearer}");
    assert!(spoilt(&|r| r.marks[0][sure] = true));
    assert!(spoilt(&|r| r.nearest_keys.truncate(9)));
}

/// What turns away of a closed body may keep its texels, since it may cut a facet: it is no layer.
#[gpu_test]
fn what_only_cuts_is_left_out() {
    let mut others = 0;
    for seed in 0..6 {
        let [with_all, culled, cutting] = with_what_turns_away(gpu(), seed);
        assert_eq!(cutting.nearest_keys, culled.nearest_keys);
        assert_eq!(cutting.second_keys, culled.second_keys);
        assert_eq!(cutting.marks[0], culled.marks[0]);
        others += cutting.second_keys.iter().zip(&with_all.second_keys).filter(|(a, b)| a != b).count();
    }
    assert!(others > 0, "what turns away is seen nowhere");
}

/// Alone, the nearest depths hold of triangles that reach behind the light what lies in front of it.
#[gpu_test]
fn nearest_alone_holds_what_reaches_behind_the_light() {
    let mut random = Random::new(23);
    let [mut compared, mut cut] = [0; 2];
    for seed in 0..6 {
        let mut mesh = random_scene(seed, &mut random);
        for _ in 0..6 {
            // Through the height of the light, from far in front of it to far behind.
            let [a, b, c] = [vector(&mut random), vector(&mut random), vector(&mut random)];
            let up = DVec3::new(0.0, 9.0, 0.0);
            let corners = [a * 2.0 - up * 0.3, b * 2.0 + up * f64::from(seed % 2 + 1), c * 6.0 - up * 0.1];
            add_triangle(&mut mesh, corners.map(|p| p.as_vec3().into()));
        }
        let light = Light::Point { position: [0.3, 4.0 + seed as f32, 0.2] };
        let world = World::new(
            gpu(),
            &mesh,
            camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0),
            light,
            [4, 3],
            64,
            samples(1),
        );
        let on = OnMap::of(&world, |_, _, _, _, _| {});
        let side = world.view.map.map_size as usize;
        for (texel, got) in on.depths.iter().enumerate() {
            let at = DVec2::new((texel % side) as f64 + 0.5, (texel / side) as f64 + 0.5);
            let mut nearest = None::<(f64, bool)>;
            let mut open = false;
            for corners in world.triangles.iter().filter_map(|t| t.corners) {
                let Some((depth, inside)) = depth_in_front(&world.view, corners, at) else { continue };
                open |= inside.abs() < 0.05;
                let behind = corners.iter().any(|p| world.view.on_map(*p).is_none());
                if inside > 0.0 && nearest.is_none_or(|(other, _)| depth < other) {
                    nearest = Some((depth, behind));
                }
            }
            if open {
                continue;
            }
            compared += 1;
            let off = match (*got, nearest) {
                (None, None) => 0.0,
                (Some(got), Some((depth, behind))) => {
                    cut += u32::from(behind);
                    (got - depth.max(0.0)).abs()
                }
                _ => f64::INFINITY,
            };
            assert!(off < 2e-3, "seed {seed}, texel {at}: {got:?}, {nearest:?} expected");
        }
    }
    assert!(compared > 5000 && cut > 1000, "{compared} texels compared, {cut} of what reaches behind");
}
