//! Counts of pixels, exactly.

use crate::support::pixels::STATES;
use crate::support::shadow::{folding_gpu, indirect, uniform};
use crate::support::{POISON, Random, assert_same, difference, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify::FacetState;
use oracle::reference::pixel_counts::{Counted, pixel_counts};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::candidate_pairs::tally::{TALLY_CANDIDATES, TALLY_PAIRS};
use subpixel_shadows::stages::facet_classify::{Facet, Facets, Undecided};
use subpixel_shadows::stages::pixel_counts::{CountedPairs, CountedPixels, PixelCounts};
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, TALLY_WORDS};
use test_support::gpu_test;

const PLACES: [PairTiles; 2] = [PairTiles::Texels, PairTiles::Tiles];

/// Facets of so many pixels, up to `most` each, in the order of pixels.
fn any(pixels: usize, most: u32, places: PairTiles, random: &mut Random) -> Vec<Counted> {
    let mut facets = Vec::new();
    for pixel in 0..pixels {
        for _ in 0..random.below(most + 1) {
            let state = STATES[random.below(5) as usize];
            let some = if state == FacetState::Undecided { 4 } else { 0 };
            let named = |random: &mut Random| if places == PairTiles::Texels { 1 } else { random.below(5) };
            let texels = (0..random.below(some + 1)).map(|_| named(random)).collect();
            facets.push(Counted { pixel, state, texels, candidates: random.below(2 * some + 1) });
        }
    }
    facets
}

/// Counts of all pixels from the GPU, and of one beyond them; lists that lack room for the last `cut` of their items.
fn counted(gpu: &Gpu, places: PairTiles, pixels: usize, facets: &[Counted], cut: usize) -> Vec<[u32; 4]> {
    let memory = Facets::new(&gpu.device, facets.len(), pixels, 1).expect("memory");
    let list: Vec<Facet> = facets.iter().map(|f| Facet { state: f.state as u32, ..Facet::default() }).collect();
    memory.list.write(&gpu.queue, &list);
    let of_pixel = |f: &Counted| Undecided { pixel: f.pixel as u32, ..Undecided::default() };
    memory.undecided.write(&gpu.queue, &facets.iter().map(of_pixel).collect::<Vec<_>>());
    let first = |pixel: usize| facets.partition_point(|f| f.pixel < pixel) as u32;
    memory.pixel_facets.write(&gpu.queue, &(0..=pixels).map(first).collect::<Vec<_>>());
    let (mut pairs, mut candidates) = (Vec::new(), Vec::new());
    for (f, facet) in (0..).zip(facets) {
        // Any texels of a tile, so many.
        let name = |texels: &u32| if places == PairTiles::Texels { 77 } else { 13 << 4 | ((1 << texels) - 1) };
        pairs.extend(facet.texels.iter().map(|texels| [f, name(texels)]));
        candidates.extend((0..facet.candidates).flat_map(|t| [f, t]));
    }
    let mut words = vec![0; TALLY_WORDS];
    (words[TALLY_PAIRS as usize], words[TALLY_CANDIDATES as usize]) = (pairs.len() as u32, candidates.len() as u32 / 2);
    let lists = PairLists::new(&gpu.device, 8, places, pairs.len(), 0, candidates.len().div_ceil(2).max(1), false)
        .expect("memory");
    let args = [indirect(gpu, words[TALLY_PAIRS as usize]), indirect(gpu, words[TALLY_CANDIDATES as usize])];
    let room = |items: usize| items.saturating_sub(cut) as u32;
    let frame = Frame {
        image_size: [pixels as u32, 1],
        pixel_texel_capacity: room(pairs.len()),
        candidate_capacity: room(candidates.len() / 2),
        ..Frame::default()
    };
    lists.pixel_pairs.write(&gpu.queue, &pairs);
    words.extend(candidates);
    lists.candidates.write(&gpu.queue, &words);
    let poison = PixelCounts { state: POISON, facets: POISON, texels: 0, pairs: 0 };
    let (frame, counts) = (uniform(gpu, &frame), upload(gpu, &vec![poison; pixels + 1]));
    let (of_pairs, of_pixels) = (CountedPairs::new(&gpu.device, places), CountedPixels::new(&gpu.device));
    run(gpu, |s| {
        let args = [(args[0].raw(), 0), (args[1].raw(), 0)];
        of_pairs.record(s, &frame, &memory, &lists, args, &counts);
        of_pixels.record_facets(s, &frame, &memory, &counts);
    });
    let counts = counts.read(gpu).expect("readback");
    counts.iter().map(|c| [c.state, c.facets, c.texels, c.pairs]).collect()
}

/// By the definition; nothing beyond the last pixel.
fn wanted(pixels: usize, facets: &[Counted]) -> Vec<[u32; 4]> {
    let mut counts = pixel_counts(pixels, facets);
    counts.push([POISON, POISON, 0, 0]);
    counts
}

fn check(gpu: &Gpu, places: PairTiles, pixels: usize, facets: &[Counted]) {
    assert_same("counts", &counted(gpu, places, pixels, facets, 0), &wanted(pixels, facets));
}

#[gpu_test]
fn empty() {
    check(gpu(), PairTiles::Tiles, 3, &[]);
    check(gpu(), PairTiles::Texels, 1, &[]);
}

#[gpu_test]
fn one() {
    for state in STATES {
        let texels = if state == FacetState::Undecided { vec![3] } else { Vec::new() };
        let candidates = 2 * texels.len() as u32;
        check(gpu(), PairTiles::Tiles, 1, &[Counted { pixel: 0, state, texels, candidates }]);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(61);
    for size in sizes_around(64) {
        check(gpu(), PairTiles::Tiles, size, &any(size, 2, PairTiles::Tiles, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(62);
    for places in PLACES {
        check(gpu(), places, 3000, &any(3000, 3, places, &mut random));
        check(gpu(), places, 20, &any(20, 200, places, &mut random));
    }
}

/// Every facet of one pixel, parts of tiles without a texel and with all; classes that a method kept.
#[gpu_test]
fn degenerate() {
    let facet = |state, texels: &[u32]| Counted { pixel: 1, state, texels: texels.to_vec(), candidates: 900 };
    let facets: Vec<_> = STATES.iter().map(|state| facet(*state, &[0, 4, 0, 4, 4])).collect();
    check(gpu(), PairTiles::Tiles, 3, &facets);
    let poison = PixelCounts { state: POISON, facets: POISON, texels: 5, pairs: 6 };
    let (counts, classes) = (upload(gpu(), &[poison; 6]), upload(gpu(), &[9, 9, 9, 9, 9, 0, 1, 2, 3, 4]));
    let frame = uniform(gpu(), &Frame { image_size: [5, 1], ..Frame::default() });
    let stage = CountedPixels::new(&gpu().device);
    run(gpu(), |s| stage.record_classes(s, &frame, &classes, &counts));
    let got = counts.read(gpu()).expect("readback");
    let of_class = |state| PixelCounts { state, facets: u32::from(state > 0), ..poison };
    assert_eq!(got, [of_class(0), of_class(1), of_class(2), of_class(3), of_class(4), poison]);
}

/// Entries without room in the lists are not counted.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(63);
    for places in PLACES {
        let mut facets = any(200, 2, places, &mut random);
        facets.push(Counted { pixel: 199, state: FacetState::Undecided, texels: vec![1], candidates: 1 });
        let got = counted(gpu(), places, 200, &facets, 1);
        assert!(difference(&got, &wanted(200, &facets)).is_some());
        let last = facets.len() - 1;
        (facets[last].texels, facets[last].candidates) = (Vec::new(), 0);
        assert_same("counts", &got, &wanted(200, &facets));
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(64);
    let pixels = 64 * 8 + 5;
    check(folding_gpu(), PairTiles::Tiles, pixels, &any(pixels, 2, PairTiles::Tiles, &mut random));
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(65);
    let facets = any(100, 3, PairTiles::Tiles, &mut random);
    let (mut got, want) = (counted(gpu(), PairTiles::Tiles, 100, &facets, 0), wanted(100, &facets));
    assert_eq!(difference(&got, &want), None);
    got[50][2] += 1;
    assert!(difference(&got, &want).is_some_and(|d| d.starts_with("1 of ")));
}
