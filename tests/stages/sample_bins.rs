//! Samples sorted into texels, and every caster against them, held against facet truth: no sample may differ outside the
//! ambiguity band, whatever the size of the map. Facets are classified with nothing settled.

use crate::support::masks::{
    self, Case, List, Masks, PATTERNS, Tally, anywhere, assert_defined, boxes_case, classify, judge,
    on_axis_and_far_away, one_caster, scene_case, soup_case, undecided_with,
};
use crate::support::shadow::{Pipelines, World, add_triangle, camera, folding_gpu, random_light, samples, sheet};
use crate::support::{Random, gpu, run, sizes_around};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::sample_bins;
use oracle::reference::view::MapEnds;
use std::collections::HashMap;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Gpu, recorder};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::facet_classify::FacetState;
use subpixel_shadows::stages::sample_bins::{BinInputs, Bins, SampleBins};
use test_support::gpu_test;

fn stage(gpu: &Gpu, words: usize) -> &'static SampleBins {
    static MADE: Pipelines<SampleBins> = Pipelines::new();
    MADE.get(gpu, words, || SampleBins::new(&gpu.device, &PrefixScan::new(&gpu.device), words as u32))
}

/// What a run left.
struct Ran {
    masks: Masks,
    /// Texel and facet of each sample, band by band.
    binned: Vec<(u32, u32)>,
    doubts: u32,
}

/// Every caster against every sample of every listed facet, in bands of at most so many facets.
fn test(world: &World, listed: &List, band: usize) -> Ran {
    let gpu = world.gpu;
    let size = world.view.map.map_size as usize;
    let facets = classify(world, listed);
    let count = world.samples.count();
    let mut frame = world.frame;
    frame.facets_total = listed.len() as u32;
    let bins = Bins::with_band(&gpu.device, &gpu.queue, size, listed.len(), count, band).expect("memory");
    bins.prepare(&gpu.queue, &frame);
    let (offsets, _, total) = world.items(&world.facts.light_items.read(gpu).expect("readback"));
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let args = Buffer::indirect(&gpu.device, "test.args", 6).expect("memory");
    let groups = |per: u64| recorder::fold_within(u64::from(total).div_ceil(per), most);
    args.write(&gpu.queue, &[groups(8), groups(1)].concat());
    let blocks = Blocks {
        triangles: &world.casters.triangles,
        points: &world.map_points,
        rects: &world.facts.light_rects,
        facing: &world.facts.facing,
        offsets: &offsets,
        args: (args.raw(), 0),
    };
    let patterns = world.sample_offsets();
    let scene = BinInputs { samples: &patterns, blocks, positions: &world.casters.positions, facets: &facets };
    let stage = stage(gpu, world.words());
    let (mut binned, mut doubts) = (Vec::new(), 0);
    run(gpu, |s| stage.record_list(s, &facets, &bins));
    let undecided = bins.listed.read(gpu).expect("readback");
    for band in 0..bins.frames.len() {
        bins.texel_ends.write(&gpu.queue, &vec![0; bins.texel_ends.len()]);
        run(gpu, |s| stage.record_bin(s, 0, band, scene, &bins));
        let starts = bins.texel_offsets.read(gpu).expect("readback");
        bins.texel_ends.write(&gpu.queue, &starts[..size * size]);
        run(gpu, |s| stage.record_bin(s, 1, band, scene, &bins));
        let places = bins.list.read(gpu).expect("readback");
        let first = band * bins.facets;
        for texel in 0..size * size {
            let within = &places[starts[texel] as usize..starts[texel + 1] as usize];
            binned.extend(
                within.iter().map(|p| (texel as u32, undecided[first + ((p[3] & 0x3f_ffff) / count) as usize])),
            );
        }
        run(gpu, |s| stage.record_occlude(s, band, scene, &bins));
        doubts += bins.texel_ends.read(gpu).expect("readback")[size * size];
        run(gpu, |s| stage.record_refine(s, band, scene, &bins));
    }
    let mut masks = masks::read(world, &facets);
    // Invalid masks are not the stage's.
    masks.iter_mut().for_each(|m| m.1[2] = 0);
    Ran { masks, binned, doubts }
}

/// Where the bins depart from their definition: a sample that is surely in a texel must be in its bin, and no other may.
fn fault_in_bins(world: &World, listed: &List, ran: &Ran) -> Option<String> {
    let size = world.view.map.map_size;
    let mut found: HashMap<(u32, u32), i64> = HashMap::new();
    ran.binned.iter().for_each(|&(texel, facet)| *found.entry((facet, texel)).or_default() += 1);
    for (f, &(pixel, triangle)) in listed.iter().enumerate() {
        let (state, [coverage, ..]) = ran.masks[f];
        let corners = triangle.and_then(|t| world.triangles[t as usize].corners);
        let (mut sure, mut possible) = (HashMap::new(), HashMap::new());
        if let Some([a, b, c]) = corners.filter(|_| state == FacetState::Undecided as u32) {
            let normal = (b - a).cross(c - a);
            let covered = world.samples.offsets().iter().enumerate().filter(|(k, _)| coverage >> k & 1 == 1);
            for (_, o) in covered {
                let ray = pixel_ray(&world.view, pixel, DVec2::new(f64::from(o[0]), f64::from(o[1])) - 0.5);
                let depth = normal.dot(a) / normal.dot(ray);
                let Some(at) = world.view.on_map(ray * depth).filter(|_| depth > 0.0) else { continue };
                let doubt = 2.0 * f64::from(world.frame.map_margin) + 1e-5 * at.truncate().length();
                let around = [[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
                let places = around.map(|d| DVec2::new(at.x, at.y) + DVec2::from(d) * doubt);
                let texels = sample_bins::texels(&places, MapEnds::of(&world.view.map));
                if let Some(t) = texels[0].filter(|_| texels.iter().all(|t| *t == texels[0])) {
                    *sure.entry(t).or_insert(0) += 1;
                }
                let mut any: Vec<u32> = texels.into_iter().flatten().collect();
                any.sort_unstable();
                any.dedup();
                any.into_iter().for_each(|t| *possible.entry(t).or_insert(0) += 1);
            }
        }
        for texel in 0..size * size {
            let count = found.get(&(f as u32, texel)).copied().unwrap_or(0);
            let least: i64 = sure.get(&texel).copied().unwrap_or(0);
            let most: i64 = possible.get(&texel).copied().unwrap_or(0);
            if !(least..=most).contains(&count) {
                return Some(format!("facet {f}, texel {texel}: {count} samples, {least} to {most} expected"));
            }
        }
    }
    None
}

fn compare(world: &World, listed: &List) -> Tally {
    let ran = test(world, listed, usize::MAX);
    assert_eq!(fault_in_bins(world, listed, &ran), None);
    Tally { evaluations: ran.binned.len(), ..judge(world, listed, &ran.masks, false) }
}

fn world((mesh, camera, light): Case, size: [u32; 2], map: u32, samples: Samples) -> World {
    World::new(gpu(), &mesh, camera, light, size, map, samples)
}

#[gpu_test]
fn empty() {
    let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
    let look = camera(DVec3::new(0.0, 1.0, 2.0), DVec3::ZERO, 50.0);
    let nothing = world((Mesh::default(), look, light), [8, 8], 4, samples(32));
    assert!(test(&nothing, &vec![(3, None)], 8).binned.is_empty());
    let world = world((sheet(1, 1.0, |_, _| 0.0, |p| p), look, light), [8, 8], 4, samples(32));
    let ran = test(&world, &world.seen(), 8);
    assert!(!ran.binned.is_empty() && ran.masks.iter().all(|m| m.1[1] == 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(61);
    let mut total = Tally::default();
    for round in 0..20 {
        let world = world(one_caster(round, &mut random), [16, 12], [1, 7, 32][round % 3], samples(8));
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
        let world = world(case.clone(), [24, 18], 12, samples(count));
        let any = world.anything(193, &mut random);
        for size in sizes_around(64) {
            compare(&world, &any[..size].to_vec()).assert_right("a size around the workgroup");
        }
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(63);
    let mut total = Tally::default();
    for count in Samples::COUNTS {
        for (round, pattern) in PATTERNS.into_iter().enumerate() {
            let (mesh, look) = anywhere(round, &mut random);
            let light = random_light(round != 1, &mut random);
            let samples = Samples::new(pattern, count).expect("a pattern");
            let world = world((mesh, look, light), [48, 36], [3, 24, 90][round], samples);
            // What is seen: the light's map holds no caster that reaches none of it.
            total.add(compare(&world, &world.seen()));
        }
    }
    for kind in 0..8 {
        let world = world(scene_case(kind, &mut random), [24, 18], 40, samples(32));
        total.add(compare(&world, &world.seen()));
    }
    println!("{total:?}");
    total.assert_right("anywhere");
    assert!(total.occluded > 10_000, "{total:?}");
}

#[gpu_test]
fn degenerate() {
    let cases = masks::degenerate(&[1e-1, 1e-3, 1e-5, 1e-7, 0.0], &[], &[3, 5, 7]);
    for (what, case) in cases.into_iter().chain(on_axis_and_far_away()) {
        let world = world(case, [32, 24], 24, samples(32));
        compare(&world, &world.seen()).assert_right(&what);
    }
}

/// No light falls through the edges that casters share: all samples under a roof of many triangles are occluded, those too whose rays meet
/// its edges and vertices, which single precision leaves open.
#[gpu_test]
fn shared_edges_let_nothing_through() {
    let mut open = 0;
    for direction in [[0.0, 1.0, 0.0], [1e-7, 1.0, -3e-8], [0.1, 1.0, 0.05]] {
        let mut mesh = sheet(8, 1.0, |_, _| 0.5, |p| p);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([[-0.5, 0.0, -0.5], [-0.5, 0.0, 0.5], [0.5, 0.0, 0.5], [0.5, 0.0, -0.5]]);
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
        // Straight down from below the roof: columns and rows of samples lie under its edges.
        let down = camera(DVec3::new(0.0, 0.3, 0.0), DVec3::ZERO, 60.0);
        let look = Camera { up: [0.0, 0.0, -1.0], ..down };
        let world = world((mesh, look, Light::Directional { direction }), [33, 33], 7, samples(32));
        let ran = test(&world, &world.seen(), usize::MAX);
        open += ran.doubts;
        let undecided = ran.masks.iter().filter(|m| m.0 == FacetState::Undecided as u32);
        assert!(undecided.clone().count() > 1000, "{direction:?}");
        for (f, (_, [coverage, occluded, _])) in undecided.enumerate() {
            assert_eq!(occluded, coverage, "{direction:?}: facet {f}");
        }
    }
    assert!(open > 100, "{open} samples are in doubt");
}

/// Bands that end inside the list, down to one facet each; with room for less than the doubts that come up.
#[gpu_test]
fn overflow_by_one() {
    for count in [1, 32, 128] {
        let world = world(boxes_case(), [48, 36], 24, samples(count));
        let listed: List = world.seen().into_iter().filter(|f| f.1.is_some()).take(65).collect();
        let whole = test(&world, &listed, 65);
        for band in [64, 33, 8, 1] {
            let ran = test(&world, &listed, band);
            assert!(ran.masks == whole.masks, "{count} samples, bands of {band}");
            let sorted = |ran: &Ran| {
                let mut all = ran.binned.clone();
                all.sort_unstable();
                all
            };
            assert!(sorted(&ran) == sorted(&whole), "{count} samples, bands of {band}: other bins");
        }
    }
    // One texel for all samples, many more than one invocation looks at.
    let crowded = world(boxes_case(), [48, 36], 1, samples(64));
    compare(&crowded, &crowded.seen()).assert_right("one texel");
    // Many walls edge-on to the light and one behind the other: all of them in doubt for the samples along their line.
    let mut mesh = sheet(1, 1.0, |_, _| 0.0, |p| p);
    for k in 0..400u32 {
        let y = 0.5 + 0.001 * k as f32;
        add_triangle(&mut mesh, [[0.0, y, -1.0], [0.0, y, 1.0], [1.0, y, 0.0]]);
    }
    let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
    let look = camera(DVec3::new(0.0, 0.3, 0.0), DVec3::new(0.0, 0.0, 0.01), 60.0);
    let world = world((mesh, look, light), [9, 9], 3, samples(1));
    let listed = world.seen();
    let ran = test(&world, &listed, usize::MAX);
    let room = (listed.len() as u32).div_ceil(4);
    assert!(ran.doubts > room, "{} doubts, room for {room}", ran.doubts);
    let mut tally = judge(&world, &listed, &ran.masks, false);
    tally.add(compare(&world, &listed));
    tally.assert_right("doubts without room");
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(67);
    let (mesh, look, light) = soup_case(20, 1.0, &mut random);
    let folded = World::new(folding_gpu(), &mesh, look, light, [24, 18], 12, samples(32));
    let listed = folded.anything(14, &mut random);
    let (.., blocks) = folded.items(&folded.facts.light_items.read(folded.gpu).expect("readback"));
    assert!((25..=72).contains(&blocks), "{blocks} blocks, eight a group, for 4 to 9 groups");
    let tally = compare(&folded, &listed);
    tally.assert_right("folded");
    let flat = world((mesh, look, light), [24, 18], 12, samples(32));
    assert!(test(&folded, &listed, 14).masks == test(&flat, &listed, 14).masks, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let map = 24;
    let world = world(boxes_case(), [24, 18], map, samples(32));
    let listed = world.seen();
    let ran = test(&world, &listed, usize::MAX);
    judge(&world, &listed, &ran.masks, false).assert_right("untouched");
    assert_eq!(fault_in_bins(&world, &listed, &ran), None);
    // A sample fewer, one twice, one in a bin far off.
    for spoil in 0..3 {
        // A sample at the border of two texels may be in either.
        let noticed = |at: usize| {
            let mut binned = ran.binned.clone();
            match spoil {
                0 => drop(binned.remove(at)),
                1 => binned.push(binned[at]),
                _ => binned[at].0 = (binned[at].0 + map * map / 2) % (map * map),
            }
            let off = Ran { binned, masks: ran.masks.clone(), doubts: ran.doubts };
            fault_in_bins(&world, &listed, &off).is_some()
        };
        let count = (0..20).map(|k| 77 + 31 * k).filter(|&at| noticed(at)).count();
        assert!(count > 5, "bins spoilt in way {spoil}: {count} of 20 noticed");
    }
    assert!(test(&world, &listed, usize::MAX).masks == ran.masks, "another result in a second run");
    let got = &ran.masks;
    for f in [u128::from(u32::MAX), 0].map(|occluded| undecided_with(got, occluded)) {
        let mut off = got.clone();
        off[f].1[1] ^= 1 << 7;
        let tally = judge(&world, &listed, &off, false);
        assert_eq!(tally.wrong_occluded, 1, "facet {f}: {tally:?}");
    }
    // The definition finds the same shadows.
    assert_defined(&world, &listed, got, sample_bins::masks);
    // Places on and beside the map.
    let places = [[0.0, 0.0], [-0.5, 3.2], [-1.5, 3.2], [23.9, 24.5], [25.5, 1.0], [7.5, 11.5]].map(DVec2::from);
    let texels = |ends| sample_bins::texels(&places, MapEnds { size: map, ends });
    let whole = [Some(0), Some(3 * map), None, Some(map * map - 1), None, Some(11 * map + 7)];
    assert_eq!(texels([false; 4]), whole);
    let at_end = [Some(0), Some(3 * map), Some(3 * map), Some(map * map - 1), None, Some(11 * map + 7)];
    assert_eq!(texels([true, false, true, true]), at_end);
    // Nearly every sample of a facet that faces the light is in a bin: few lie beside the map.
    let undecided = got.iter().filter(|m| m.0 == FacetState::Undecided as u32).count();
    assert!(ran.binned.len() > 24 * undecided, "{} samples of {undecided} facets", ran.binned.len());
}
