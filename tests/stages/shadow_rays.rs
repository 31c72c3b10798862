//! Shadow rays against facet truth: no sample may differ outside the ambiguity band. Facets are classified with nothing
//! settled, and every ray walks the whole tree.

use crate::support::masks::{
    self, Case, List, Masks, PATTERNS, Tally, anywhere, assert_defined, boxes_case, classify, judge, light_anywhere,
    on_axis_and_far_away, one_caster, scene_case, soup_case, undecided_with, undecided_world,
};
use crate::support::shadow::{Pipelines, World, camera, folding_gpu, samples, sheet, uniform};
use crate::support::{Random, gpu, run, sizes_around};
use oracle::reference::shadow_rays;
use subpixel_shadows::caster_tree::CasterTree;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::{Gpu, recorder};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::shadow_rays::{RayInputs, RayLists, RayStep, ShadowRays, TreeBuffers};
use test_support::gpu_test;

fn stage(gpu: &Gpu, words: usize) -> &'static ShadowRays {
    static MADE: Pipelines<ShadowRays> = Pipelines::new();
    MADE.get(gpu, words, || ShadowRays::new(&gpu.device, &PrefixScan::new(&gpu.device), words as u32))
}

/// Follows every sample of every listed facet; there is room for so many doubts. Returns masks, and how many facets were
/// traced, doubts met, and walks that ended early.
fn trace(world: &World, listed: &List, doubts: usize) -> (Masks, [u32; 3]) {
    let gpu = world.gpu;
    let facets = classify(world, listed);
    let tree = CasterTree::new(world.prepared.mesh()).expect("a tree");
    let buffers = TreeBuffers::new(&gpu.device, &gpu.queue, &tree.nodes, &tree.triangles).expect("memory");
    let eye = Vec3::from(world.camera.eye).as_dvec3();
    buffers.place.write(&gpu.queue, &[tree.place(eye, f64::from(world.frame.eye[3]))]);
    let mut frame = world.frame;
    frame.flags |= Frame::VALIDITY;
    frame.facets_total = listed.len() as u32;
    let (frame, offsets) = (uniform(gpu, &frame), world.sample_offsets());
    let count = world.samples.count();
    let rays = RayLists::with_doubts(&gpu.device, &gpu.queue, listed.len(), count, doubts).expect("memory");
    let scene = RayInputs {
        samples: &offsets,
        tree: &buffers,
        triangles: &world.casters.triangles,
        positions: &world.casters.positions,
    };
    let stage = stage(gpu, world.words());
    run(gpu, |s| stage.record_list(s, &facets, &rays));
    let listed_count = u64::from(rays.read(gpu).expect("readback")[0]);
    // The kernels fold for a device of usual limits; this one may have smaller ones.
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let groups = |per: u64| recorder::fold_within(listed_count.div_ceil(per), most);
    rays.args.write(&gpu.queue, &[groups(64 / u64::from(count.min(32))), groups(64)].concat());
    for step in [RayStep::Trace, RayStep::Cut, RayStep::Refine] {
        run(gpu, |s| stage.record(s, step, &frame, scene, &facets, &rays));
    }
    (masks::read(world, &facets), rays.read(gpu).expect("readback"))
}

fn compare(world: &World, listed: &List) -> Tally {
    let (got, [traced, _, early]) = trace(world, listed, 4096);
    assert_eq!(early, 0, "walks that ended early");
    Tally { evaluations: traced as usize, ..judge(world, listed, &got, true) }
}

fn world((mesh, camera, light): Case, size: [u32; 2], samples: Samples) -> World {
    undecided_world(gpu(), &mesh, camera, light, size, samples)
}

#[gpu_test]
fn empty() {
    let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
    let look = camera(DVec3::new(0.0, 1.0, 2.0), DVec3::ZERO, 50.0);
    let nothing = world((Mesh::default(), look, light), [8, 8], samples(32));
    assert_eq!(trace(&nothing, &vec![(3, None)], 8).1[0], 0);
    // Facets whose only neighbour is coplanar: followed, nothing occluded, nothing invalid.
    let world = world((sheet(1, 1.0, |_, _| 0.0, |p| p), look, light), [8, 8], samples(32));
    let (masks, [traced, ..]) = trace(&world, &world.seen(), 8);
    assert!(traced > 0 && masks.iter().all(|m| m.1[1] == 0 && m.1[2] == 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(61);
    let mut total = Tally::default();
    for round in 0..20 {
        let world = world(one_caster(round, &mut random), [16, 12], samples(8));
        total.add(compare(&world, &world.seen()));
    }
    total.assert_right("one caster");
    assert!(total.occluded > 50, "{total:?}");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(62);
    let case = soup_case(9, 1.5, &mut random);
    for count in [1, 32, 128] {
        let world = world(case.clone(), [24, 18], samples(count));
        let any = world.anything(193, &mut random);
        for size in sizes_around(64) {
            compare(&world, &any[..size].to_vec()).assert_right("a size around the workgroup");
        }
    }
}

/// Eyes, lights, facets and casters anywhere, also behind each other: every number of samples and every pattern; then
/// closed, open, interpenetrating and doubled scenes.
#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(63);
    let mut total = Tally::default();
    for count in Samples::COUNTS {
        for (round, pattern) in PATTERNS.into_iter().enumerate() {
            let (mesh, look) = anywhere(round, &mut random);
            let light = light_anywhere(round, &mut random);
            let samples = Samples::new(pattern, count).expect("a pattern");
            let world = world((mesh, look, light), [24, 18], samples);
            let listed = [world.anything(700, &mut random), world.seen()].concat();
            total.add(compare(&world, &listed));
        }
    }
    for kind in 0..8 {
        let world = world(scene_case(kind, &mut random), [24, 18], samples(32));
        total.add(compare(&world, &world.seen()));
    }
    println!("{total:?}");
    total.assert_right("anywhere");
    assert!(total.occluded > 10_000, "{total:?}");
}

#[gpu_test]
fn degenerate() {
    let heights = [0.75, 0.75f32.next_up(), 0.75f32.next_down()];
    let cases = masks::degenerate(&[1e-1, 1e-3, 1e-5, 1e-7, 0.0], &heights, &[3, 5, 7]);
    for (what, case) in cases.into_iter().chain(on_axis_and_far_away()) {
        let world = world(case, [32, 24], samples(32));
        compare(&world, &world.seen()).assert_right(&what);
    }
}

/// Doubts that find no room are decided all the same: by following their samples again.
#[gpu_test]
fn overflow_by_one() {
    for count in [8, 128] {
        let world = world(boxes_case(), [48, 36], samples(count));
        let listed = world.seen();
        let (want, [_, doubts, _]) = trace(&world, &listed, 4096);
        assert!(doubts > 1, "{doubts} doubts");
        for room in [doubts as usize + 1, doubts as usize, doubts as usize - 1, 0] {
            assert!(trace(&world, &listed, room).0 == want, "{count} samples, room for {room} of {doubts} doubts");
        }
    }
}

/// Doubts lie in no padding, which the kernel counts as room and the host does not go through.
#[gpu_test]
fn padding_holds_no_doubts() {
    let gpu = gpu();
    for facets in 1..9 {
        for doubts in 0..5 {
            let rays = RayLists::with_doubts(&gpu.device, &gpu.queue, facets, 8, doubts).expect("memory");
            assert_eq!(rays.work.bytes(), 4 * rays.work.len() as u64, "{facets} facets, room for {doubts} doubts");
        }
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(67);
    let (mesh, look, light) = soup_case(20, 1.0, &mut random);
    // Fourteen groups of two facets each, where one dimension holds three.
    let folded = undecided_world(folding_gpu(), &mesh, look, light, [24, 18], samples(32));
    let listed = folded.anything(28, &mut random);
    let tally = compare(&folded, &listed);
    tally.assert_right("folded");
    assert!(tally.evaluations > 6, "{tally:?}");
    let flat = world((mesh, look, light), [24, 18], samples(32));
    assert!(trace(&folded, &listed, 64).0 == trace(&flat, &listed, 64).0, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let world = world(boxes_case(), [24, 18], samples(32));
    let listed = world.seen();
    let (got, _) = trace(&world, &listed, 4096);
    judge(&world, &listed, &got, true).assert_right("untouched");
    assert!(trace(&world, &listed, 4096).0 == got, "another result in a second run");
    let [dark, lit] = [u128::from(u32::MAX), 0].map(|occluded| undecided_with(&got, occluded));
    for (f, part) in [(dark, 1), (lit, 1), (lit, 2)] {
        let mut off = got.clone();
        off[f].1[part] ^= 1 << 7;
        let tally = judge(&world, &listed, &off, true);
        assert_eq!(tally.wrong_occluded + tally.wrong_valid, 1, "facet {f}, mask {part}: {tally:?}");
    }
    // The definition finds the same shadows.
    assert_defined(&world, &listed, &got, shadow_rays::masks);
}
