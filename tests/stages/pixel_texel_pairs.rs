//! Pixel-texel pairs: no exact pair is missing, none is farther than twice the margin.

use crate::support::shadow::{
    World, camera, folding_gpu, place_of, random_light, random_scene, samples, sheet, unit, vector,
};
use crate::support::{POISON, Random, difference, gpu, sizes_around};
use oracle::reference::facet_classify::{FacetAtPixel, FacetState, MapAround, classify, outline};
use oracle::reference::front_layer::{Margin, Split};
use oracle::reference::pixel_texel_pairs::pairs;
use oracle::reference::view::MapEnds;
use std::sync::OnceLock;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::facet_classify::{self, Facets};
use subpixel_shadows::stages::pixel_texel_pairs::{PairTiles, PixelTexelPairs};
use test_support::gpu_test;

/// One for each kind of places.
fn stages() -> &'static [PixelTexelPairs; 2] {
    static STAGES: OnceLock<[PixelTexelPairs; 2]> = OnceLock::new();
    STAGES
        .get_or_init(|| [PairTiles::Texels, PairTiles::Tiles].map(|places| PixelTexelPairs::new(&gpu().device, places)))
}

/// As `check`, with pairs that meet by texel and by tile.
#[track_caller]
fn check_both(world: &World, listed: &[(u32, Option<u32>)], splits: &[Split]) -> usize {
    stages().iter().map(|stage| check(world, stage, listed, splits)).sum()
}

fn world(gpu: &'static Gpu, kind: u32, random: &mut Random) -> World {
    let mesh = random_scene(kind, random);
    let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
    let light = random_light(random.below(2) == 0, random);
    let map = [1, 2, 33, 64][random.below(4) as usize];
    let mut world = World::new(gpu, &mesh, camera(eye, vector(random) * 0.3, 50.0), light, [24, 18], map, samples(8));
    world.frame.flags |= [0, 2, 8][random.below(3) as usize];
    world
}

/// Facets as the GPU classified them with every texel marked, and by their definition with a margin.
fn facets(world: &World, listed: &[(u32, Option<u32>)], margin: Margin) -> (Facets, Vec<FacetAtPixel>) {
    let texels = (world.view.map.map_size as usize).pow(2);
    let (marked, splits) = (vec![true; texels], vec![Split::Marked; texels]);
    let around = MapAround {
        triangles: &world.triangles,
        marked: &marked,
        splits: &splits,
        samples: world.samples.offsets(),
        casters: world.frame.triangle_count,
    };
    (world.classify(listed, &marked, &splits), classify(&world.view, &around, listed, margin, true))
}

/// Splits at which skipping depends on no rounding: far before or behind every facet, or none.
fn any_splits(world: &World, random: &mut Random) -> Vec<Split> {
    let split = |_| match random.below(4) {
        0 => Split::Uncovered,
        1 => Split::At(f64::INFINITY),
        2 => Split::At(-1.5e30),
        _ => Split::Marked,
    };
    (0..world.view.map.map_size.pow(2)).map(split).collect()
}

/// Pairs missing of the exact ones, and pairs that are not among those of twice the margin.
fn faults(least: &[Vec<u32>], got: &[Vec<u32>], most: &[Vec<u32>]) -> (usize, usize) {
    let without = |a: &[Vec<u32>], b: &[Vec<u32>]| {
        a.iter().zip(b).map(|(a, b)| a.iter().filter(|&x| b.binary_search(x).is_err()).count()).sum()
    };
    (without(least, got), without(got, most))
}

/// Runs and compares; returns the pairs.
#[track_caller]
fn check(world: &World, stage: &PixelTexelPairs, listed: &[(u32, Option<u32>)], splits: &[Split]) -> usize {
    let size = world.view.map.map_size;
    let (on_gpu, exact) = facets(world, listed, Margin::default());
    let (_, wide) = facets(world, listed, world.margin().times(2.0));
    // Of what casts nothing, no texel is skipped.
    let skip = world.frame.flags & (2 | 8) == 0 && world.frame.triangle_count != 0;
    let states = on_gpu.list.read(world.gpu).expect("readback");
    let undecided = on_gpu.undecided.read(world.gpu).expect("readback");
    // Facets whose state is open to rounding, or differs by the margin, are not compared.
    let clear = |f: usize| {
        let undecided = states[f].state == facet_classify::FacetState::Undecided as u32;
        let same = |x: &FacetAtPixel| (x.state == FacetState::Undecided) == undecided;
        same(&exact[f]) && same(&wide[f]) && !exact[f].open
    };
    let map = MapEnds::of(&world.view.map);
    let mut least = pairs(&exact, splits, map, Margin::default(), skip);
    let mut most = pairs(&wide, splits, map, world.margin().times(2.0), skip);
    let total: usize = 1 << 21;
    let listed_pairs = world.pixel_pairs(stage, &on_gpu, splits, total);
    let mut got = listed_pairs.texel_sets(stage.places(), size as usize);
    for sets in [&mut least, &mut got, &mut most] {
        sets.iter_mut().for_each(|s| s.retain(|&f| clear(f as usize)));
    }
    assert!(got.iter().all(|s| s.windows(2).all(|w| w[0] < w[1])), "a pair is listed twice");
    assert_eq!(faults(&least, &got, &most), (0, 0), "missing, too far");
    // What later stages read of each place, and of each block of texels.
    let sets = listed_pairs.sets();
    for (place, set) in sets.iter().enumerate() {
        assert!(set.windows(2).all(|w| w[0] < w[1]), "place {place}: a facet is listed twice");
        let deepest = set.iter().map(|&f| undecided[f as usize].farthest.max(0.0).to_bits() + 1).max().unwrap_or(0);
        assert_eq!(listed_pairs.deepest[place], deepest, "place {place}");
    }
    let (size, across) = (size as usize, size.div_ceil(8) as usize);
    for texel in 0..size * size {
        let empty = sets[place_of(stage.places(), size, texel)].is_empty();
        let block = sets.len() + texel / size / 8 * across + texel % size / 8;
        assert!(empty || listed_pairs.deepest[block] != 0, "texel {texel}: its block has no pair");
    }
    got.iter().map(Vec::len).sum()
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(21);
    let world = world(gpu(), 0, &mut random);
    let splits = vec![Split::Marked; (world.view.map.map_size as usize).pow(2)];
    assert_eq!(check_both(&world, &[(3, None), (4, None)], &splits), 0);
    let splits = vec![Split::Uncovered; splits.len()];
    assert_eq!(check_both(&world, &world.seen(), &splits), 0, "where no caster is, there is no pair");
}

#[gpu_test]
fn one() {
    let mut random = Random::new(22);
    let mut found = 0;
    for kind in 0..4 {
        let world = world(gpu(), kind, &mut random);
        let splits = vec![Split::Marked; (world.view.map.map_size as usize).pow(2)];
        let seen = world.seen();
        let middle: Vec<_> = seen.into_iter().filter(|s| s.1.is_some()).skip(40).take(1).collect();
        found += check_both(&world, &middle, &splits);
    }
    assert!(found > 0);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(23);
    let world = world(gpu(), 1, &mut random);
    let splits = any_splits(&world, &mut random);
    for size in sizes_around(64) {
        check_both(&world, &world.seen()[..size], &splits);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(24);
    let mut found = 0;
    for kind in 0..40 {
        let world = world(gpu(), kind, &mut random);
        let splits = any_splits(&world, &mut random);
        let listed = if kind % 2 == 0 { world.seen() } else { world.anything(300, &mut random) };
        found += check_both(&world, &listed, &splits);
    }
    assert!(found > 5_000, "{found} pairs");
}

/// Facets of what casts nothing lie anywhere between two layers: no texel is skipped before its split.
#[gpu_test]
fn what_only_receives() {
    let mut random = Random::new(26);
    let mut found = 0;
    for kind in 0..16 {
        let mut world = world(gpu(), kind, &mut random);
        (world.frame.triangle_count, world.frame.flags) = (0, world.frame.flags & !(2 | 8));
        let splits = any_splits(&world, &mut random);
        found += check_both(&world, &world.seen(), &splits);
    }
    assert!(found > 2_000, "{found} pairs");
}

/// A floor seen at a grazing angle, up to the horizon, and a light that grazes it.
#[gpu_test]
fn degenerate() {
    let floor = sheet(3, 4.0, |_, _| 0.0, |p| p);
    for height in [1.0, 0.1, 1e-2, 1e-3] {
        for elevation in [1.0, 1e-1, 1e-2, 1e-3] {
            let eye = DVec3::new(0.3, height, 4.2);
            let light = Light::Directional { direction: [1.0, elevation, 0.3] };
            let world = World::new(
                gpu(),
                &floor,
                camera(eye, DVec3::new(0.0, 0.0, -2.0), 50.0),
                light,
                [24, 18],
                64,
                samples(8),
            );
            let splits = vec![Split::Marked; 64 * 64];
            check_both(&world, &world.seen(), &splits);
        }
    }
}

/// The list one short, exact, and one longer: the counts stay right and nothing is written past the capacity.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(26);
    let world = world(gpu(), 1, &mut random);
    let splits = vec![Split::Marked; (world.view.map.map_size as usize).pow(2)];
    let (facets, _) = facets(&world, &world.seen(), Margin::default());
    for stage in stages() {
        let whole = world.pixel_pairs(stage, &facets, &splits, 1 << 21);
        let needed: u32 = whole.counts.iter().sum();
        assert!(needed > 100);
        for capacity in [needed as usize - 1, needed as usize, needed as usize + 1] {
            let mut padded = world.pixel_pairs(stage, &facets, &splits, capacity);
            assert_eq!(padded.counts, whole.counts, "the need does not depend on the capacity");
            assert!(padded.list[..capacity.min(needed as usize)].iter().all(|p| p.0 != POISON), "capacity {capacity}");
            padded.list.drain(..needed.min(capacity as u32) as usize);
            assert!(padded.list.iter().all(|&p| p == (POISON, POISON)), "capacity {capacity}: written past the need");
        }
        // A list with room behind its capacity keeps what stands there.
        let half = needed as usize / 2;
        let listed = world.pixel_pairs_in(stage, &facets, &splits, half, needed as usize);
        assert!(listed[half..].iter().all(|&p| p == [POISON; 2]), "written past the capacity");
        assert!(listed[..half].iter().all(|&p| p != [POISON; 2]));
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(27);
    let small = [PairTiles::Texels, PairTiles::Tiles].map(|places| PixelTexelPairs::new(&folding_gpu().device, places));
    let mut found = 0;
    for kind in 0..4 {
        let world = world(folding_gpu(), kind, &mut random);
        let splits = vec![Split::Marked; (world.view.map.map_size as usize).pow(2)];
        let listed = &world.seen()[..100 + 50 * kind as usize];
        found += small.iter().map(|stage| check(&world, stage, listed, &splits)).sum::<usize>();
    }
    assert!(found > 0);
}

#[gpu_test]
fn detects_corruption() {
    let (least, most) = (vec![vec![1, 4]], vec![vec![0, 1, 4]]);
    assert_eq!(faults(&least, &[vec![1, 4]], &most), (0, 0));
    assert_eq!(faults(&least, &[vec![4]], &most), (1, 0), "a missing pair is seen");
    assert_eq!(faults(&least, &[vec![1, 4, 7]], &most), (0, 1), "a spare one too");
    assert!(difference(&[1, 2], &[1]).is_some());
    // The margin is what covers rounding: pairs are not the same without it.
    let mut random = Random::new(28);
    let mut changed = 0;
    for kind in 0..8 {
        let world = world(gpu(), kind, &mut random);
        let (_, facets) = facets(&world, &world.seen(), Margin { texels: 0.5, depth: 0.0 });
        let splits = vec![Split::Marked; (world.view.map.map_size as usize).pow(2)];
        let by = |texels| pairs(&facets, &splits, MapEnds::of(&world.view.map), Margin { texels, depth: 0.0 }, false);
        let (least, most) = (by(0.0), by(0.5));
        changed += faults(&most, &least, &most).0;
        let f = facets.iter().find(|f| f.state == FacetState::Undecided);
        let Some(f) = f else { continue };
        assert!(outline(&world.view, f.pixel, f.plane, 10.0).corners.len() >= 3);
    }
    assert!(changed > 0);
}
