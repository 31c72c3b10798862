//! Pairs sorted by texel against their definition. The list is written as the appending kernels would.

use crate::support::{POISON, Random, assert_same, gpu, run, sizes_around, small_gpu, upload};
use oracle::reference::sorted_pairs::sort;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::sorted_pairs::Sorted;
use subpixel_shadows::stages::{PrefixScan, SortedPairs};
use test_support::gpu_test;

fn stage(gpu: &Gpu) -> SortedPairs {
    SortedPairs::new(&gpu.device, &PrefixScan::new(&gpu.device))
}

/// Counts of the texels, item and texel of each place, items alone of each place.
#[derive(Clone)]
struct Got {
    counts: Vec<u32>,
    pairs: Vec<[u32; 2]>,
    items: Vec<u32>,
}

/// Both kinds of list, of `pairs` with room for `room`, of which `said` are said to have been appended.
fn sorted(gpu: &Gpu, stage: &SortedPairs, pairs: &[(u32, u32)], texels: usize, room: usize, said: u32) -> Got {
    let (keys, values): (Vec<u32>, Vec<u32>) = pairs.iter().copied().take(room).unzip();
    let to_pairs = Buffer::from_slice(&gpu.device, &gpu.queue, "to", &vec![[POISON; 2]; room + 1]).expect("memory");
    let to_items = upload(gpu, &vec![POISON; room + 1]);
    let mut counts = Vec::new();
    for to in [Sorted::Pairs(&to_pairs), Sorted::Items(&to_items)] {
        let joined = matches!(to, Sorted::Pairs(_));
        let scratch = SortedPairs::scratch(&gpu.device, room, joined).expect("scratch");
        scratch.appended.write(&gpu.queue, &[said, 0]);
        scratch.keys.write(&gpu.queue, &keys);
        scratch.values.write(&gpu.queue, &values);
        let of_texels = upload(gpu, &vec![0; texels]);
        run(gpu, |s| stage.record(s, &scratch, to, &of_texels));
        counts.push(of_texels.read(gpu).expect("readback"));
    }
    assert_eq!(counts[0], counts[1]);
    let (pairs, items) = (to_pairs.read(gpu).expect("readback"), to_items.read(gpu).expect("readback"));
    Got { counts: counts.swap_remove(0), pairs, items }
}

/// Why `got` is not what `pairs` make, if so.
fn fault(pairs: &[(u32, u32)], texels: usize, got: &Got) -> Option<String> {
    let (want, counts) = sort(pairs, texels);
    let items: Vec<u32> = want.iter().map(|pair| pair.1).collect();
    let joined: Vec<[u32; 2]> = want.iter().map(|&(texel, item)| [item, texel]).collect();
    let n = pairs.len();
    if got.counts != counts {
        return Some("counts".to_owned());
    }
    if got.items[..n] != items || got.pairs[..n] != joined {
        return Some("pairs".to_owned());
    }
    let rest = got.items[n..].iter().all(|&i| i == POISON) && got.pairs[n..].iter().all(|&p| p == [POISON; 2]);
    (!rest).then(|| "written beyond the pairs".to_owned())
}

#[track_caller]
fn check(gpu: &Gpu, stage: &SortedPairs, pairs: &[(u32, u32)], texels: usize) {
    for room in [pairs.len(), pairs.len() + 700] {
        let got = sorted(gpu, stage, pairs, texels, room, pairs.len() as u32);
        assert_eq!(fault(pairs, texels, &got), None, "{} pairs, {texels} texels, room {room}", pairs.len());
    }
}

fn any(count: usize, texels: u32, random: &mut Random) -> Vec<(u32, u32)> {
    (0..count as u32).map(|k| (random.below(texels), k.wrapping_mul(0x9e37_79b9))).collect()
}

#[gpu_test]
fn empty() {
    check(gpu(), &stage(gpu()), &[], 16);
}

#[gpu_test]
fn one() {
    for texel in [0, 1, 15] {
        check(gpu(), &stage(gpu()), &[(texel, 77)], 16);
    }
    check(gpu(), &stage(gpu()), &[(0, 77)], 1);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stage = stage(gpu());
    let mut random = Random::new(51);
    for size in sizes_around(64) {
        check(gpu(), &stage, &any(size, 30, &mut random), 36);
    }
}

#[gpu_test]
fn random_seeded() {
    let stage = stage(gpu());
    let mut random = Random::new(52);
    for side in [1u32, 2, 7, 33, 64, 256, 512] {
        let count = 1 + random.below(60_000) as usize;
        check(gpu(), &stage, &any(count, side * side, &mut random), (side * side) as usize);
    }
}

/// All pairs in one texel, in the first or the last; one in each; the same pair many times.
#[gpu_test]
fn degenerate() {
    let stage = stage(gpu());
    for texel in [0, 511 * 511, 512 * 512 - 1] {
        let pairs: Vec<(u32, u32)> = (0..200_000).map(|k| (texel, k)).collect();
        check(gpu(), &stage, &pairs, 512 * 512);
    }
    let falling: Vec<(u32, u32)> = (0..4096).map(|k| (4095 - k, k)).collect();
    check(gpu(), &stage, &falling, 4096);
    check(gpu(), &stage, &[(3, 3); 1000], 4);
}

/// More appended than there is room for: those that are there are sorted, and nothing is written beyond them.
#[gpu_test]
fn overflow_by_one() {
    let stage = stage(gpu());
    let pairs = any(1000, 50, &mut Random::new(53));
    for said in [1001, 2000, u32::MAX] {
        let got = sorted(gpu(), &stage, &pairs, 50, 1000, said);
        assert_eq!(fault(&pairs, 50, &got), None, "{said} appended");
    }
    let scratch = SortedPairs::scratch(&gpu().device, 10, true).expect("scratch");
    let (counts, short) = (upload(gpu(), &[0; 4]), upload(gpu(), &[0; 9]));
    let pairs = Buffer::from_slice(&gpu().device, &gpu().queue, "to", &[[0; 2]; 9]).expect("memory");
    let mut encoder = gpu().encoder();
    let mut recorder = subpixel_shadows::gpu::Recorder::new(&gpu().device, &mut encoder, None);
    let mut s = recorder.stage("test");
    assert!(stage.record(&mut s, &scratch, Sorted::Pairs(&pairs), &counts).is_err(), "9 places for 10 pairs");
    assert!(stage.record(&mut s, &scratch, Sorted::Items(&short), &counts).is_err(), "made for pairs");
}

#[gpu_test]
fn two_d_dispatch() {
    let gpu = small_gpu(3, 1 << 20);
    let stage = stage(&gpu);
    let mut random = Random::new(54);
    for size in [3 * 64, 3 * 64 + 1, 9 * 64] {
        let pairs = any(size, 20, &mut random);
        let got = sorted(&gpu, &stage, &pairs, 20, size, size as u32);
        assert_eq!(fault(&pairs, 20, &got), None, "{size} pairs");
    }
}

#[gpu_test]
fn detects_corruption() {
    let pairs = any(500, 20, &mut Random::new(55));
    let good = sorted(gpu(), &stage(gpu()), &pairs, 20, 500, 500);
    assert_eq!(fault(&pairs, 20, &good), None);
    let mut bad = good.clone();
    bad.counts[3] += 1;
    assert_eq!(fault(&pairs, 20, &bad).as_deref(), Some("counts"));
    let mut bad = good.clone();
    bad.items.swap(0, 1);
    assert_eq!(fault(&pairs, 20, &bad).as_deref(), Some("pairs"));
    let mut bad = good.clone();
    bad.pairs.swap(0, 1);
    assert_eq!(fault(&pairs, 20, &bad).as_deref(), Some("pairs"));
    let mut bad = good.clone();
    *bad.items.last_mut().expect("an item") = 1;
    assert!(fault(&pairs, 20, &bad).is_some_and(|f| f.contains("beyond")));
    assert_same("the list is not sorted by itself", &[pairs.is_sorted_by_key(|p| p.0)], &[false]);
}
