//! The stable sort against its definition.

use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::radix_sort::sort;
use subpixel_shadows::gpu::{Gpu, Recorder, kernels};
use subpixel_shadows::stages::radix_sort::{Pairs, digits};
use subpixel_shadows::stages::{Count, PrefixScan, RadixSort};
use test_support::gpu_test;

const BLOCK: usize = kernels::radix_sort::BLOCK as usize;

fn stage(gpu: &Gpu) -> RadixSort {
    RadixSort::new(&gpu.device, &PrefixScan::new(&gpu.device))
}

/// Sorts on the GPU; values are indices, so that a pair that was torn apart shows. Keys, then values.
fn sorted(gpu: &Gpu, stage: &RadixSort, keys: &[u32], key_bits: u32, count: Option<usize>) -> Vec<u32> {
    let values: Vec<u32> = (0..keys.len() as u32).collect();
    let (input, indices) = (upload(gpu, keys), upload(gpu, &values));
    let (out, moved) = (poisoned(gpu, keys.len() + 1), poisoned(gpu, keys.len() + 1));
    let counts = upload(gpu, &[count.unwrap_or(0) as u32]);
    let scratch = RadixSort::scratch(&gpu.device, keys.len()).expect("scratch");
    let (pairs, to) = (Pairs { keys: &input, values: &indices }, Pairs { keys: &out, values: &moved });
    let count = count.map_or(Count::Exactly(keys.len()), |_| Count::At(&counts, 0));
    run(gpu, |s| stage.record(s, pairs, to, &scratch, key_bits, count));
    assert_same("the input", &input.read(gpu).expect("readback"), keys);
    [out.read(gpu).expect("readback"), moved.read(gpu).expect("readback")].concat()
}

fn wanted(keys: &[u32], key_bits: u32, count: Option<usize>) -> Vec<u32> {
    let count = count.unwrap_or(usize::MAX).min(keys.len());
    let values: Vec<u32> = (0..count as u32).collect();
    let (mut keys_out, mut values_out) = sort(&keys[..count], &values, key_bits);
    keys_out.resize(keys.len() + 1, POISON);
    values_out.resize(keys.len() + 1, POISON);
    [keys_out, values_out].concat()
}

#[track_caller]
fn check(gpu: &Gpu, stage: &RadixSort, keys: &[u32], key_bits: u32, count: Option<usize>) {
    let what = format!("{} keys of {key_bits} bits, count {count:?}", keys.len());
    assert_same(&what, &sorted(gpu, stage, keys, key_bits, count), &wanted(keys, key_bits, count));
}

#[test]
fn digits_cover_the_key_once() {
    for key_bits in 0..=32 {
        let digits: Vec<_> = digits(key_bits).collect();
        assert_eq!(digits.iter().map(|(_, bits)| bits).sum::<u32>(), key_bits);
        assert_eq!(digits.len() as u32, key_bits.div_ceil(kernels::radix_sort::DIGIT_BITS).max(1));
        let mut end = 0;
        for (first, bits) in digits {
            assert_eq!(first, end, "{key_bits} bits");
            assert!(bits <= kernels::radix_sort::DIGIT_BITS && first < 32);
            end = first + bits;
        }
    }
}

#[gpu_test]
fn empty() {
    check(gpu(), &stage(gpu()), &[], 32, None);
    check(gpu(), &stage(gpu()), &[3, 2, 1], 32, Some(0));
}

#[gpu_test]
fn one() {
    let stage = stage(gpu());
    for key_bits in [0, 1, 6, 7, 32] {
        check(gpu(), &stage, &[u32::MAX], key_bits, None);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stage = stage(gpu());
    let keys = Random::new(31).list(3 * BLOCK + 1, 1 << 9);
    for size in [sizes_around(BLOCK), sizes_around(64)].concat() {
        check(gpu(), &stage, &keys[..size], 9, None);
    }
}

#[gpu_test]
fn random_seeded() {
    let stage = stage(gpu());
    let mut random = Random::new(32);
    for key_bits in (0..=32).cycle().take(99) {
        let len = random.below(3 * BLOCK as u32) as usize;
        check(gpu(), &stage, &random.words(len), key_bits, None);
    }
    for (len, key_bits) in [(1 << 18, 18), (300_001, 26), (1 << 20, 18)] {
        let keys = random.words(len);
        check(gpu(), &stage, &keys, key_bits, None);
        check(gpu(), &stage, &keys, key_bits, Some(len - 12_345));
    }
}

#[gpu_test]
fn degenerate() {
    let stage = stage(gpu());
    let len = 2 * BLOCK + 99;
    let up: Vec<u32> = (0..len as u32).collect();
    let down: Vec<u32> = up.iter().rev().copied().collect();
    let last_first: Vec<u32> = up.iter().map(|&i| u32::from(i + 1 != len as u32)).collect();
    for keys in [&up, &down, &last_first, &vec![0; len], &vec![u32::MAX; len], &vec![0x2a; len]] {
        for key_bits in [1, 6, 14, 32] {
            check(gpu(), &stage, keys, key_bits, None);
        }
        for count in [1, BLOCK, len - 1, len, u32::MAX as usize] {
            check(gpu(), &stage, keys, 13, Some(count));
        }
    }
}

#[gpu_test]
fn overflow_by_one() {
    let stage = stage(gpu());
    let device = &gpu().device;
    let [a, b, c, d] = [10, 10, 10, 10].map(|len| poisoned(gpu(), len));
    let short = poisoned(gpu(), 9);
    let scratch = RadixSort::scratch(device, 10).expect("scratch");
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(device, &mut encoder, None);
    let mut s = recorder.stage("test");
    let mut sort = |pairs, to, bits, count| stage.record(&mut s, pairs, to, &scratch, bits, count).is_ok();
    let pairs = Pairs { keys: &a, values: &b };
    let to = Pairs { keys: &c, values: &d };
    let ten = Count::Exactly(10);
    assert!(sort(pairs, to, 32, ten));
    assert!(!sort(pairs, to, 33, ten));
    assert!(!sort(pairs, to, 32, Count::Exactly(11)), "more than the scratch is for");
    assert!(!sort(pairs, Pairs { keys: &c, values: &short }, 32, ten));
    assert!(!sort(Pairs { keys: &short, values: &b }, to, 32, ten));
    assert!(!sort(pairs, Pairs { keys: &a, values: &d }, 32, ten), "in place");
}

#[gpu_test]
fn two_d_dispatch() {
    let gpu = small_gpu(2, 1 << 20);
    let stage = stage(&gpu);
    for len in [2 * BLOCK, 2 * BLOCK + 1, 4 * BLOCK] {
        check(&gpu, &stage, &Random::new(33).words(len), 12, None);
    }
}

#[gpu_test]
fn detects_corruption() {
    let keys = Random::new(34).list(1000, 8);
    let (mut got, want) = (sorted(gpu(), &stage(gpu()), &keys, 3, None), wanted(&keys, 3, None));
    assert_eq!(difference(&got, &want), None);
    got.swap(1001, 1002);
    assert!(difference(&got, &want).is_some(), "equal keys must keep their order");
}
