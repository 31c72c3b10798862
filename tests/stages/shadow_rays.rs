//! Shadow rays against facet truth: no sample may differ outside the ambiguity band. Facets are classified with nothing
//! settled, and every ray walks the whole tree.

use crate::support::masks::{List, Masks, Tally, boxes, judge};
use crate::support::shadow::{
    World, camera, folding_gpu, random_light, random_scene, samples, sheet, soup, uniform, unit, vector,
};
use crate::support::{Random, gpu, run, sizes_around};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock};
use subpixel_shadows::caster_tree::CasterTree;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::{Gpu, recorder};
use subpixel_shadows::reference::front_layer::Split;
use subpixel_shadows::reference::shadow_rays;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::facet_classify::State;
use subpixel_shadows::stages::shadow_rays::{Rays, Scene, ShadowRays, TreeBuffers};
use subpixel_shadows::truth::{FacetInput, FacetTruth, Tracer, full_mask, join_mask, split_mask};

fn stage(gpu: &'static Gpu, words: usize) -> &'static ShadowRays {
    static MADE: OnceLock<Mutex<HashMap<(u32, usize), &'static ShadowRays>>> = OnceLock::new();
    let key = (gpu.device.limits().max_compute_workgroups_per_dimension, words);
    let mut made = MADE.get_or_init(Mutex::default).lock().expect("no test panicked while making a pipeline");
    let make = || Box::leak(Box::new(ShadowRays::new(&gpu.device, &PrefixScan::new(&gpu.device), words as u32)));
    made.entry(key).or_insert_with(|| make())
}

/// Follows every sample of every listed facet; there is room for so many doubts. Returns masks, and how many facets were
/// traced, doubts met, and walks that ended early.
fn trace(world: &World, listed: &List, doubts: usize) -> (Masks, [u32; 3]) {
    let (gpu, words) = (world.gpu, world.words());
    let texels = (world.view.map.map_size as usize).pow(2);
    let facets = world.classify(listed, &vec![true; texels], &vec![Split::Marked; texels]);
    let tree = CasterTree::new(&world.prepared.mesh).expect("a tree");
    let buffers = TreeBuffers::new(&gpu.device, &gpu.queue, &tree).expect("memory");
    let eye = Vec3::from(world.camera.eye).as_dvec3();
    buffers.place.write(&gpu.queue, &[tree.place(eye, f64::from(world.frame.eye[3]))]);
    let mut frame = world.frame;
    frame.flags |= 2;
    frame.facets_total = listed.len() as u32;
    let (frame, offsets) = (uniform(gpu, &frame), world.sample_offsets());
    let count = world.samples.count();
    let rays = Rays::with_doubts(&gpu.device, &gpu.queue, listed.len(), count, doubts).expect("memory");
    let scene = Scene {
        samples: offsets.raw(),
        tree: &buffers,
        triangles: world.casters.triangles.raw(),
        positions: world.casters.positions.raw(),
    };
    let stage = stage(gpu, words);
    run(gpu, |s| stage.record_list(s, &facets, &rays));
    let listed_count = u64::from(rays.read(gpu).expect("readback")[0]);
    // The kernels fold for a device of usual limits; this one may have smaller ones.
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let groups = |per: u64| recorder::fold_within(listed_count.div_ceil(per), most);
    rays.args.write(&gpu.queue, &[groups(64 / u64::from(count.min(32))), groups(64)].concat());
    run(gpu, |s| stage.record_trace(s, frame.raw(), scene, &facets, &rays));
    run(gpu, |s| stage.record_cut(s, frame.raw(), scene, &facets, &rays));
    run(gpu, |s| stage.record_refine(s, frame.raw(), scene, &facets, &rays));
    let list = facets.list.read(gpu).expect("readback");
    let masks = facets.masks.read(gpu).expect("readback");
    let mask = |f: usize, part: usize| {
        let mut all = [0; 4];
        all[..words].copy_from_slice(&masks[(3 * f + part) * words..(3 * f + part + 1) * words]);
        join_mask(all)
    };
    let full = full_mask(count);
    let one = |f: usize| (list[f].state, [0, 1, 2].map(|part| mask(f, part) & full));
    ((0..list.len()).map(one).collect(), rays.read(gpu).expect("readback"))
}

fn compare(world: &World, listed: &List) -> Tally {
    let (got, [traced, _, early]) = trace(world, listed, 4096);
    assert_eq!(early, 0, "walks that ended early");
    Tally { evaluations: traced as usize, ..judge(world, listed, &got, true) }
}

fn world(mesh: &Mesh, camera: Camera, light: Light, size: [u32; 2], samples: Samples) -> World {
    let mut world = World::new(gpu(), mesh, camera, light, size, 1, samples);
    world.frame.flags |= 8;
    world
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn empty() {
    let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
    let look = || camera(DVec3::new(0.0, 1.0, 2.0), DVec3::ZERO, 50.0);
    let nothing = world(&Mesh::default(), look(), light, [8, 8], samples(32));
    assert_eq!(trace(&nothing, &vec![(3, None)], 8).1[0], 0);
    // Facets whose only neighbour is coplanar: followed, nothing occluded, nothing invalid.
    let world = world(&sheet(1, 1.0, |_, _| 0.0, |p| p), look(), light, [8, 8], samples(32));
    let (masks, [traced, ..]) = trace(&world, &world.seen(), 8);
    assert!(traced > 0 && masks.iter().all(|m| m.1[1] == 0 && m.1[2] == 0));
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn one() {
    let mut random = Random::new(61);
    let mut total = Tally::default();
    for round in 0..20 {
        let mut mesh = sheet(1, 1.0, |_, _| 0.0, |p| p);
        let extra = soup(1, 0.7, &mut random);
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(extra.positions);
        mesh.triangles.push([base, base + 1, base + 2]);
        let eye = DVec3::new(unit(&mut random), 1.5, 2.0);
        let light = random_light(round % 2 == 0, &mut random);
        let world = world(&mesh, camera(eye, DVec3::ZERO, 50.0), light, [16, 12], samples(8));
        total.add(compare(&world, &world.seen()));
    }
    total.assert_right("one caster");
    assert!(total.occluded > 50, "{total:?}");
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn every_size_around_workgroup() {
    let mut random = Random::new(62);
    let mesh = soup(9, 1.5, &mut random);
    let light = random_light(true, &mut random);
    let look = camera(DVec3::new(0.5, 1.5, 2.0), DVec3::ZERO, 50.0);
    for count in [1, 32, 128] {
        let world = world(&mesh, look, light, [24, 18], samples(count));
        let any = world.anything(193, &mut random);
        for size in sizes_around(64) {
            compare(&world, &any[..size].to_vec()).assert_right("a size around the workgroup");
        }
    }
}

/// Eyes, lights, facets and casters anywhere, also behind each other: every number of samples and every pattern; then
/// closed, open, interpenetrating and doubled scenes.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn random_seeded() {
    let mut random = Random::new(63);
    let mut total = Tally::default();
    for count in Samples::COUNTS {
        for (round, pattern) in [Pattern::Grid, Pattern::Rotated, Pattern::LowDiscrepancy].into_iter().enumerate() {
            let mesh = soup(40, [0.3, 1.0][round % 2], &mut random);
            let (eye, target) = (vector(&mut random), vector(&mut random));
            let light = match round {
                0 => Light::Directional { direction: vector(&mut random).as_vec3().into() },
                1 => random_light(false, &mut random),
                _ => Light::Point { position: (vector(&mut random) * 1.2).as_vec3().into() },
            };
            let samples = Samples::new(pattern, count).expect("a pattern");
            let world = world(&mesh, camera(eye, target, 70.0), light, [24, 18], samples);
            let listed = [world.anything(700, &mut random), world.seen()].concat();
            total.add(compare(&world, &listed));
        }
    }
    for kind in 0..8 {
        let mesh = random_scene(kind, &mut random);
        let eye = vector(&mut random).normalize() * 2.5;
        let light = random_light(random.below(2) == 0, &mut random);
        let world = world(&mesh, camera(eye, DVec3::ZERO, 50.0), light, [24, 18], samples(32));
        total.add(compare(&world, &world.seen()));
    }
    println!("{total:?}");
    total.assert_right("anywhere");
    assert!(total.occluded > 10_000, "{total:?}");
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn degenerate() {
    let mut random = Random::new(65);
    let eye = DVec3::new(0.3, 2.0, 3.0);
    let view = |mesh: &Mesh, light: Light| world(mesh, camera(eye, DVec3::ZERO, 60.0), light, [32, 24], samples(32));
    // Light grazing the floor, down to parallel to it; along an axis.
    for elevation in [1e-1f32, 1e-3, 1e-5, 1e-7, 0.0] {
        let world = view(&boxes(), Light::Directional { direction: [1.0, elevation, 0.3] });
        compare(&world, &world.seen()).assert_right(&format!("light {elevation} over the floor"));
    }
    let world = view(&boxes(), Light::Directional { direction: [0.0, 1.0, 0.0] });
    compare(&world, &world.seen()).assert_right("light along an axis");
    // Light in a caster's plane, beside it by one ulp, in a vertex of it.
    for y in [0.75f32, 0.75f32.next_up(), 0.75f32.next_down()] {
        for position in [[3.0, y, 0.1], [0.5, y, 0.5], [0.5, y, 2.0]] {
            let world = view(&boxes(), Light::Point { position });
            compare(&world, &world.seen()).assert_right(&format!("light at {position:?}"));
        }
    }
    // Slivers of aspect 1e3 to 1e7, and triangles of no area at all.
    for power in [3, 5, 7] {
        let mut mesh = sheet(1, 2.0, |_, _| -0.5, |p| p);
        let slivers = soup(60, 1.5, &mut random);
        let base = mesh.positions.len() as u32;
        for t in 0..60 {
            let corner = |k: usize| Vec3::from(slivers.positions[3 * t + k]);
            let (a, b) = (corner(0), corner(1));
            let c = a + (b - a) * 0.6 + (corner(2) - a) * 10f32.powi(-power);
            let c = if t % 10 == 0 { a } else { c };
            mesh.positions.extend([a, b, c].map(<[f32; 3]>::from));
            mesh.triangles.push([base + 3 * t as u32, base + 3 * t as u32 + 1, base + 3 * t as u32 + 2]);
        }
        let world = view(&mesh, random_light(power % 2 == 0, &mut random));
        compare(&world, &world.seen()).assert_right(&format!("slivers of aspect 1e{power}"));
    }
    // Everything twice; everything far from the origin.
    let mut mesh = boxes();
    mesh.triangles.extend(mesh.triangles.clone());
    let light = Light::Directional { direction: [0.4, 1.0, 0.3] };
    let world = view(&mesh, light);
    compare(&world, &world.seen()).assert_right("doubled");
    let far = DVec3::new(1e3, -2e3, 5e2);
    let mut mesh = boxes();
    mesh.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + far.as_vec3()).into());
    let world = self::world(&mesh, camera(eye + far, far, 60.0), light, [32, 24], samples(32));
    compare(&world, &world.seen()).assert_right("far away");
}

/// Doubts that find no room are decided all the same: by following their samples again.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn overflow_by_one() {
    let light = Light::Directional { direction: [0.4, 1.0, 0.3] };
    let look = camera(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO, 60.0);
    for count in [8, 128] {
        let world = world(&boxes(), look, light, [48, 36], samples(count));
        let listed = world.seen();
        let (want, [_, doubts, _]) = trace(&world, &listed, 4096);
        assert!(doubts > 1, "{doubts} doubts");
        for room in [doubts as usize + 1, doubts as usize, doubts as usize - 1, 0] {
            assert!(trace(&world, &listed, room).0 == want, "{count} samples, room for {room} of {doubts} doubts");
        }
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn two_d_dispatch() {
    let mut random = Random::new(67);
    let mesh = soup(20, 1.0, &mut random);
    let light = random_light(true, &mut random);
    let look = camera(DVec3::new(0.5, 1.5, 2.0), DVec3::ZERO, 50.0);
    // Seven groups of two facets each, where one dimension holds three.
    let mut folded = World::new(folding_gpu(), &mesh, look, light, [24, 18], 1, samples(32));
    folded.frame.flags |= 8;
    let listed = folded.anything(14, &mut random);
    let tally = compare(&folded, &listed);
    tally.assert_right("folded");
    assert!(tally.evaluations > 6, "{tally:?}");
    let flat = world(&mesh, look, light, [24, 18], samples(32));
    assert!(trace(&folded, &listed, 64).0 == trace(&flat, &listed, 64).0, "the fold changes the result");
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn detects_corruption() {
    let light = Light::Directional { direction: [0.4, 1.0, 0.3] };
    let world = world(&boxes(), camera(DVec3::new(0.3, 2.0, 3.0), DVec3::ZERO, 60.0), light, [24, 18], samples(32));
    let listed = world.seen();
    let (got, _) = trace(&world, &listed, 4096);
    judge(&world, &listed, &got, true).assert_right("untouched");
    assert!(trace(&world, &listed, 4096).0 == got, "another result in a second run");
    let undecided = |m: &&(u32, [u128; 3])| m.0 == State::Undecided as u32;
    let shadow = got.iter().filter(undecided).position(|m| m.1[1] == u128::from(u32::MAX));
    assert!(shadow.is_some(), "a facet all in shadow");
    let at = |full: bool| {
        let mask = if full { u128::from(u32::MAX) } else { 0 };
        (0..got.len()).find(|&f| got[f].0 == State::Undecided as u32 && got[f].1[1] == mask).expect("a facet")
    };
    for (f, part) in [(at(true), 1), (at(false), 1), (at(false), 2)] {
        let mut off = got.clone();
        off[f].1[part] ^= 1 << 7;
        let tally = judge(&world, &listed, &off, true);
        assert_eq!(tally.wrong_occluded + tally.wrong_valid, 1, "facet {f}, mask {part}: {tally:?}");
    }
    // The definition finds the same shadows; without the boxes it finds none.
    let [w, h] = world.view.image;
    let occluded = |mesh: &Mesh| -> u32 {
        let tracer = Tracer::new(mesh).expect("a tracer");
        let truth = FacetTruth::new(&tracer, &world.camera, &world.light, &world.samples, w, h).expect("a truth");
        let coverage = split_mask(full_mask(32));
        let facet = |&(pixel, triangle): &(u32, Option<u32>)| Some(FacetInput { pixel, triangle: triangle?, coverage });
        let inputs: Vec<_> =
            listed.iter().filter_map(facet).filter(|f| (f.triangle as usize) < mesh.triangles.len()).collect();
        shadow_rays::masks(&truth, &inputs).expect("masks").iter().map(|r| r.occluded[0].count_ones()).sum()
    };
    let ours: u32 = got.iter().filter(undecided).map(|m| m.1[1].count_ones()).sum();
    assert!(ours > 100 && occluded(&world.prepared.mesh) >= ours, "{ours}");
}
