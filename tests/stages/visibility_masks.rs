//! Occlusion and validity masks against the facet truth: no sample may differ outside the ambiguity band.
//!
//! Facets are classified with nothing settled, and every facet is evaluated against every other triangle of the mesh, so
//! nothing depends on lists.

mod arithmetic;
mod other_ways;

use crate::support::masks::{
    self, Case, List, Masks, PATTERNS, Tally, anywhere, boxes_case, classify, judge, light_anywhere, list_triangle,
    one_caster, scene_case, soup_case, undecided_with, undecided_world,
};
use crate::support::shadow::{
    Pipelines, World, add_triangle, camera, folding_gpu, indirect, samples, sheet, uniform, unit,
};
use crate::support::{Random, difference, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify as reference;
use oracle::reference::front_layer::Split;
use oracle::reference::visibility_masks::two_step;
use oracle::truth::AMBIGUITY;
use subpixel_shadows::entry_point;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::{DVec3, DVec4};
use subpixel_shadows::gpu::bindings::{Read, Uniform, Write};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups};
use subpixel_shadows::mask_table::{MaskVariant, mask_table};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::facet_classify::FacetState;
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, TALLY_WORDS};
use subpixel_shadows::stages::visibility_masks::{EvaluationInputs, VisibilityMasks};
use test_support::gpu_test;

fn stage(gpu: &Gpu, samples: u32) -> &'static VisibilityMasks {
    static MADE: Pipelines<VisibilityMasks> = Pipelines::new();
    MADE.get(gpu, samples as usize, || VisibilityMasks::new(&gpu.device, samples, [0, 0]))
}

/// Evaluates every facet against every other triangle on the GPU.
fn evaluate(world: &World, listed: &List, validity: bool) -> (Masks, usize) {
    let (masks, [evaluations, _]) = evaluate_by(stage(world.gpu, world.samples.count()), world, listed, validity);
    (masks, evaluations)
}

/// The masks, how many pairs were evaluated, and how many of them again with 46 bits.
fn evaluate_by(stage: &VisibilityMasks, world: &World, listed: &List, validity: bool) -> (Masks, [usize; 2]) {
    evaluate_with(stage, &upload(world.gpu, &[0u32]), world, listed, validity)
}

/// The same with a lookup table, where the stage is made for one.
fn evaluate_with(
    stage: &VisibilityMasks,
    table: &Buffer<u32>,
    world: &World,
    listed: &List,
    validity: bool,
) -> (Masks, [usize; 2]) {
    let gpu = world.gpu;
    let facets = classify(world, listed);
    let list = facets.list.read(gpu).expect("readback");
    let undecided = |f: &usize| list[*f].state == FacetState::Undecided as u32;
    let triangles = world.prepared.mesh().triangles.len() as u32;
    let pairs: Vec<[u32; 2]> = (0..list.len())
        .filter(undecided)
        .flat_map(|f| (0..triangles).filter(move |&t| t != list_triangle(listed, f)).map(move |t| [f as u32, t]))
        .collect();
    let lists = PairLists::new(&gpu.device, 1, PairTiles::default(), 1, 1, pairs.len(), validity).expect("memory");
    let mut content = vec![0; TALLY_WORDS];
    content[1] = pairs.len() as u32;
    content.extend(pairs.iter().flatten());
    lists.candidates.write(&gpu.queue, &content);
    let mut frame = world.frame;
    frame.flags |= if validity { Frame::VALIDITY } else { 0 };
    frame.facets_total = listed.len() as u32;
    frame.candidate_capacity = pairs.len() as u32;
    let (frame, offsets) = (uniform(gpu, &frame), world.sample_offsets());
    let casters = EvaluationInputs {
        samples: &offsets,
        table,
        triangles: &world.casters.triangles,
        positions: &world.casters.positions,
    };
    let mut doubts = 0;
    if !pairs.is_empty() {
        let args = indirect(gpu, pairs.len() as u32);
        run(gpu, |s| stage.record_evaluate(s, &frame, casters, &facets, &lists, (args.raw(), 0)));
        doubts = lists.candidates.read_first(gpu, 4).expect("readback")[2];
        assert!(doubts <= pairs.len() as u32);
        let args = indirect(gpu, doubts);
        run(gpu, |s| stage.record_refine(s, &frame, casters, &facets, &lists, (args.raw(), 0)));
    }
    (masks::read(world, &facets), [pairs.len(), doubts as usize])
}

fn compare(world: &World, listed: &List, validity: bool) -> Tally {
    let (got, evaluations) = evaluate(world, listed, validity);
    Tally { evaluations, ..judge(world, listed, &got, validity) }
}

fn world((mesh, camera, light): Case, size: [u32; 2], samples: Samples) -> World {
    undecided_world(gpu(), &mesh, camera, light, size, samples)
}

#[gpu_test]
fn empty() {
    let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
    let mesh = sheet(1, 1.0, |_, _| 0.0, |p| p);
    let eye = DVec3::new(0.0, 1.0, 2.0);
    let world = world((mesh, camera(eye, DVec3::ZERO, 50.0), light), [8, 8], samples(32));
    let (masks, evaluations) = evaluate(&world, &vec![(3, None)], true);
    assert_eq!((evaluations, masks[0].1[1], masks[0].1[2]), (0, 0, 0));
    // Facets whose only neighbour is coplanar: evaluated, nothing occluded, nothing invalid.
    let (masks, _) = evaluate(&world, &world.seen(), true);
    assert!(masks.iter().all(|m| m.1[1] == 0 && m.1[2] == 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(61);
    let mut total = Tally::default();
    for round in 0..40 {
        let world = world(one_caster(round, &mut random), [16, 12], samples(8));
        total.add(compare(&world, &world.seen(), true));
    }
    total.assert_right("one caster");
    assert!(total.occluded > 100, "{total:?}");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(62);
    // One evaluation a facet: as many as facets.
    let world = world(soup_case(2, 1.5, &mut random), [24, 18], samples(32));
    let any = world.anything(193, &mut random);
    for size in sizes_around(64) {
        compare(&world, &any[..size].to_vec(), true).assert_right("a size around the workgroup");
    }
}

/// Eyes, lights, facets and casters anywhere, also behind each other: every number of samples and every pattern.
fn all_anywhere() -> Tally {
    let mut random = Random::new(63);
    let mut total = Tally::default();
    for count in Samples::COUNTS {
        for pattern in PATTERNS {
            for round in 0..4 {
                let (mesh, look) = anywhere(round, &mut random);
                let light = light_anywhere(round, &mut random);
                let samples = Samples::new(pattern, count).expect("a pattern");
                let world = world((mesh, look, light), [24, 18], samples);
                let listed = [world.anything(700, &mut random), world.seen()].concat();
                total.add(compare(&world, &listed, true));
            }
        }
    }
    println!("{total:?}");
    total
}

#[gpu_test]
fn random_seeded() {
    let total = all_anywhere();
    assert!(total.evaluations >= 1_000_000 && total.occluded > 10_000, "{total:?}");
    assert_eq!((total.wrong_occluded, total.leaks), (0, 0), "{total:?}");
}

#[gpu_test]
fn cuts_behind_the_eye_are_as_exact() {
    all_anywhere().assert_right("anywhere");
}

/// Closed, open, interpenetrating and doubled scenes.
#[gpu_test]
fn scenes() {
    let mut random = Random::new(64);
    let mut total = Tally::default();
    for kind in 0..16 {
        let world = world(scene_case(kind, &mut random), [24, 18], samples(32));
        let tally = compare(&world, &world.seen(), true);
        tally.assert_right(&format!("scene {kind}"));
        total.add(tally);
    }
    assert!(total.occluded > 10_000, "{total:?}");
}

#[gpu_test]
fn degenerate() {
    let elevations = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
    let heights = [0.75, 0.75f32.next_up(), 0.75f32.next_down(), 0.750_001];
    for (what, case) in masks::degenerate(&elevations, &heights, &[2, 3, 4, 5, 6, 7]) {
        let world = world(case, [32, 24], samples(32));
        compare(&world, &world.seen(), true).assert_right(&what);
    }
}

/// A caster in whose plane the light lies casts nothing, but where it rises through a facet it still cuts it.
#[gpu_test]
fn edge_on_casters_still_cut() {
    let (mesh, look, _) = boxes_case();
    let light = Light::Directional { direction: [1.0, 0.0, 0.3] };
    let world = world((mesh, look, light), [32, 24], samples(32));
    compare(&world, &world.seen(), true).assert_right("light along the floor");
}

/// A tilted floor of many triangles that would be coplanar but for the rounding of their vertices. By the model, samples
/// beyond the facet's own triangle lie on its plane, and a neighbour that rises over it by rounding alone shadows them;
/// the validity mask takes those samples out. With it no counted sample is occluded.
#[gpu_test]
fn tessellated_floors_do_not_shadow_themselves() {
    let turn = |offset: f64| {
        move |p: DVec3| {
            let p = DVec3::new(p.x * 0.83 - p.y * 0.557, p.x * 0.557 + p.y * 0.83, p.z);
            DVec3::new(p.x, p.y * 0.91 - p.z * 0.414, p.y * 0.414 + p.z * 0.91) + offset
        }
    };
    for offset in [0.0, 1e3] {
        let mesh = sheet(20, 1.0, |_, _| 0.0, turn(offset));
        let eye = turn(offset)(DVec3::new(0.3, 1.1, 1.0));
        let light = Light::Directional { direction: turn(0.0)(DVec3::new(0.8, 0.6, -0.3)).as_vec3().into() };
        let world = world((mesh, camera(eye, DVec3::splat(offset), 50.0), light), [24, 18], samples(32));
        let listed = world.seen();
        assert!(listed.iter().filter(|l| l.1.is_some()).count() > 200);
        let (got, _) = evaluate(&world, &listed, true);
        judge(&world, &listed, &got, true).assert_right(&format!("offset {offset}"));
        let undecided = got.iter().filter(|m| m.0 == FacetState::Undecided as u32);
        let acne: u32 = undecided.map(|(_, [cover, dark, lost])| (cover & dark & !lost).count_ones()).sum();
        println!("offset {offset}: {acne} samples of acne");
        assert!(acne == 0 || offset > 0.0, "offset {offset}: {acne} samples of acne");
    }
}

/// A wall that rises through the floor, its foot swept across a pixel's centre.
#[gpu_test]
fn cuts_through_the_pixel_centre() {
    let eye = DVec3::new(0.0, 2.0, 0.0);
    let look = Camera { up: [0.0, 0.0, -1.0], ..camera(eye, DVec3::ZERO, 60.0) };
    let rays = look.rays(9, 9);
    let ray = rays.direction(4.5, 4.5);
    let centre = eye - ray * (eye.y / ray.y);
    let pixel = rays.step_x.length() * 2.0;
    for step in -6..=6 {
        let at = centre.x + f64::from(step) * 1e-7 * pixel;
        let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
        let wall = [[at, -0.3, -1.0], [at, -0.3, 1.0], [at, 0.4, 0.1]];
        add_triangle(&mut mesh, wall.map(|p| p.map(|c| c as f32)));
        let light = Light::Directional { direction: [0.5, 1.0, 0.1] };
        let world = world((mesh, look, light), [9, 9], samples(32));
        let listed: List = world.seen();
        let (got, _) = evaluate(&world, &listed, true);
        judge(&world, &listed, &got, true).assert_right(&format!("step {step}"));
        for (k, (state, [coverage, _, invalid])) in got.iter().enumerate() {
            let kept = coverage & 1 == 1 && invalid & 1 == 0;
            assert!(*state != FacetState::Undecided as u32 || kept, "step {step}: pixel {k} loses its centre");
        }
    }
}

/// Samples exactly on the shadows of edges and of vertices that triangles of a closed fan share are occluded; of pairs whose lines
/// pass a sample so near, single precision decides none.
#[gpu_test]
fn closed_fans_do_not_leak() {
    let mut total = Tally::default();
    for (blades, size, samples) in [
        (4u32, [56, 42], samples(128)),
        (5, [56, 42], samples(128)),
        (16, [48, 36], samples(128)),
        (64, [40, 30], Samples::new(Pattern::Grid, 128).expect("a pattern")),
        (256, [24, 18], samples(128)),
        (1024, [12, 9], Samples::new(Pattern::Rotated, 128).expect("a pattern")),
    ] {
        for light in [[0.0f32, 1.0, 0.0, 0.0], [0.3, 1.0, -0.2, 0.0], [0.1, 3.0, 0.2, 1.0]] {
            let eye = DVec3::new(0.05, 2.9, 0.15);
            let look = Camera { up: [0.0, 0.0, -1.0], ..camera(eye, DVec3::new(0.05, 0.0, 0.15), 40.0) };
            let rays = look.rays(size[0], size[1]);
            let l = DVec4::from(light.map(f64::from));
            // The point of the fan's plane whose shadow is where a sample meets the floor.
            let above = |x: f64, y: f64| {
                let ray = rays.direction(x, y);
                let floor = eye - ray * (eye.y / ray.y);
                let to_light = l.truncate() - floor * l.w;
                floor + to_light * (0.5 / to_light.y)
            };
            let (w, h) = (f64::from(size[0]), f64::from(size[1]));
            let mut mesh = Mesh::default();
            mesh.positions.extend([[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 18.0]]);
            mesh.triangles.push([0, 1, 2]);
            mesh.positions.push(above((w * 0.5).floor() + 0.5, (h * 0.5).floor() + 0.5).as_vec3().into());
            for k in 0..blades {
                let angle = f64::from(k) / f64::from(blades) * std::f64::consts::TAU;
                let (x, y) = (w * (0.5 + 0.4 * angle.cos()), h * (0.5 + 0.4 * angle.sin()));
                mesh.positions.push(above(x.floor() + 0.5, y.floor() + 0.5).as_vec3().into());
            }
            mesh.triangles.extend((0..blades).map(|k| [3, 4 + k, 4 + (k + 1) % blades]));
            let light = match light {
                [x, y, z, 0.0] => Light::Directional { direction: [x, y, z] },
                [x, y, z, _] => Light::Point { position: [x, y, z] },
            };
            let world = world((mesh, look, light), size, samples.clone());
            // Floor facets whatever is in front of them.
            let pixels = size[0] * size[1];
            let floor = world.prepared.given.iter().position(|&t| t == 0).expect("the floor") as u32;
            let listed: List = (0..pixels).map(|p| (p, Some(floor))).collect();
            let (got, [evaluations, doubts]) = evaluate_by(stage(gpu(), 128), &world, &listed, false);
            let tally = Tally { evaluations, ..judge(&world, &listed, &got, false) };
            tally.assert_right(&format!("{blades} blades, {light:?}"));
            // Every blade at the hub, at least.
            assert!(doubts >= blades as usize, "{blades} blades, {light:?}: {doubts} pairs decided with 46 bits");
            assert!(tally.occluded * 5 > tally.samples, "{blades} blades, {light:?}: {tally:?}");
            total.add(tally);
        }
    }
    println!("{total:?}");
    assert!(total.occluded >= 1_000_000, "{total:?}");
}

/// The list of candidates ends at its capacity: what lies behind it is not evaluated.
#[gpu_test]
fn overflow_by_one() {
    let world = world(boxes_case(), [8, 8], samples(32));
    let listed = world.seen();
    let stage = stage(gpu(), 32);
    let reach = |capacity: u32, counted: u32| {
        let facets = classify(&world, &listed);
        let lists = PairLists::new(&gpu().device, 1, PairTiles::default(), 1, 1, 8, true).expect("memory");
        let mut content = vec![0; TALLY_WORDS];
        content[1] = counted;
        // A facet on a triangle in the same place eight times over: candidates 3 and later are some other facet's.
        let f = |k: u32| if k < 3 { 0 } else { 1 };
        content.extend((0..8).flat_map(|k| [f(k), 5]));
        lists.candidates.write(&gpu().queue, &content);
        let mut frame = world.frame;
        frame.flags |= Frame::VALIDITY;
        frame.candidate_capacity = capacity;
        let (frame, offsets) = (uniform(gpu(), &frame), world.sample_offsets());
        let casters = EvaluationInputs {
            samples: &offsets,
            table: &upload(gpu(), &[0u32]),
            triangles: &world.casters.triangles,
            positions: &world.casters.positions,
        };
        let args = indirect(gpu(), 8);
        let sentinel = vec![u32::MAX; 8];
        lists.doubts.write(&gpu().queue, &sentinel);
        lists.cuts.write(&gpu().queue, &sentinel);
        run(gpu(), |s| stage.record_evaluate(s, &frame, casters, &facets, &lists, (args.raw(), 0)));
        let tally = lists.candidates.read_first(gpu(), 4).expect("readback");
        assert_eq!(tally[1], counted, "the need stays");
        let listed = [&lists.doubts, &lists.cuts].map(|list| list.read(gpu()).expect("readback"));
        let listed = listed.concat().into_iter().filter(|&k| k != u32::MAX).collect::<Vec<_>>();
        assert!(listed.iter().all(|&k| k < capacity.min(counted)), "capacity {capacity}: {listed:?}");
        listed.len()
    };
    for capacity in [2, 3, 4] {
        assert!(reach(capacity, 8) <= capacity as usize);
        assert!(reach(8, capacity) <= capacity as usize);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(67);
    let (mesh, look, light) = soup_case(20, 1.0, &mut random);
    // At most 3 by 3 workgroups of 64 fit: 30 facets against 19 triangles.
    let world = undecided_world(folding_gpu(), &mesh, look, light, [24, 18], samples(32));
    let listed = world.anything(25, &mut random);
    let tally = compare(&world, &listed, true);
    tally.assert_right("folded");
    assert!(tally.evaluations > 3 * 64, "{tally:?}");
}

#[gpu_test]
fn detects_corruption() {
    let world = world(boxes_case(), [24, 18], samples(32));
    let listed = world.seen();
    let (mut got, _) = evaluate(&world, &listed, true);
    let right = judge(&world, &listed, &got, true);
    right.assert_right("untouched");
    let k = undecided_with(&got, u128::from(u32::MAX));
    got[k].1[1] ^= 1;
    let wrong = judge(&world, &listed, &got, true);
    assert_eq!((wrong.wrong_occluded, wrong.leaks), (1, 1), "a lit sample in a shadow is seen");
    let j = undecided_with(&got, 0);
    got[j].1[2] |= 1;
    assert_eq!(judge(&world, &listed, &got, true).wrong_valid, 1, "a lost sample is seen");
    assert!(difference(&[1], &[2]).is_some());
}
