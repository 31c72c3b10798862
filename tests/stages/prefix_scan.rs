//! The exclusive scan against its definition.

use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::prefix_scan::exclusive;
use subpixel_shadows::gpu::{Buffer, Gpu, kernels};
use subpixel_shadows::stages::{Count, PrefixScan};
use test_support::gpu_test;

const BLOCK: usize = kernels::prefix_scan::BLOCK as usize;

/// Scans on the GPU: the whole output buffer and the two words of the total.
fn scan(gpu: &Gpu, stage: &PrefixScan, values: &[u32], output: usize, count: Count, capacity: usize) -> Vec<u32> {
    let input = upload(gpu, values);
    let sums = Buffer::banded(&gpu.device, "test.output", output).expect("memory for the output");
    sums.write(&gpu.queue, &vec![POISON; output]);
    let total = poisoned(gpu, 5);
    let scratch = PrefixScan::scratch(&gpu.device, capacity).expect("scratch");
    run(gpu, |s| stage.record(s, &input, &sums, (&total, 2), &scratch, count));
    let mut got = sums.read(gpu).expect("readback");
    got.extend(total.read(gpu).expect("readback"));
    got
}

fn wanted(values: &[u32]) -> Vec<u32> {
    let scan = exclusive(values);
    [scan.sums, vec![POISON, POISON, scan.total, u32::from(scan.overflow), POISON]].concat()
}

#[track_caller]
fn check(gpu: &Gpu, stage: &PrefixScan, values: &[u32]) {
    let got = scan(gpu, stage, values, values.len(), Count::Exactly(values.len()), values.len());
    assert_same(&format!("scan of {}", values.len()), &got, &wanted(values));
}

#[gpu_test]
fn empty() {
    let stage = PrefixScan::new(&gpu().device);
    check(gpu(), &stage, &[]);
    let zero = upload(gpu(), &[0u32]);
    let got = scan(gpu(), &stage, &[7, 8, 9], 3, Count::At(&zero, 0), 3);
    assert_same("count of 0 in a buffer", &got, &wanted(&[0, 0, 0]));
}

#[gpu_test]
fn one() {
    let stage = PrefixScan::new(&gpu().device);
    check(gpu(), &stage, &[u32::MAX]);
    check(gpu(), &stage, &[3]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stage = PrefixScan::new(&gpu().device);
    let values = Random::new(1).list(3 * BLOCK + 1, 1000);
    for size in [sizes_around(BLOCK), sizes_around(64), sizes_around(16)].concat() {
        check(gpu(), &stage, &values[..size]);
    }
}

#[gpu_test]
fn random_seeded() {
    let stage = PrefixScan::new(&gpu().device);
    let mut random = Random::new(2);
    for round in 0..60 {
        let len = random.below(70_000) as usize;
        let end = [2, 256, 1 << 20, u32::MAX][round % 4];
        let values = random.list(len, end);
        check(gpu(), &stage, &values);
    }
    for len in [1 << 18, (1 << 20) + 5, 1 << 24] {
        let values = random.list(len, 200);
        check(gpu(), &stage, &values);
        check(gpu(), &stage, &values);
    }
}

#[gpu_test]
fn degenerate() {
    let stage = PrefixScan::new(&gpu().device);
    for fill in [0, 1, u32::MAX] {
        check(gpu(), &stage, &vec![fill; 5 * BLOCK + 17]);
    }
    // A count in a buffer: beyond it the input reads as 0, up to the capacity; beyond that nothing is written.
    let values = Random::new(3).list(3 * BLOCK, 1 << 20);
    for (count, capacity) in [(0, 2), (1, 5), (BLOCK, 2 * BLOCK), (100, 2 * BLOCK + 3), (5, 6), (9999, 3 * BLOCK)] {
        let counts = upload(gpu(), &[7, count as u32]);
        let got = scan(gpu(), &stage, &values, 3 * BLOCK, Count::At(&counts, 1), capacity);
        let mut live = values[..capacity].to_vec();
        live[count.min(capacity)..].fill(0);
        let mut want = wanted(&live);
        want.splice(capacity..capacity, vec![POISON; 3 * BLOCK - capacity]);
        assert_same(&format!("count {count} of {capacity}"), &got, &want);
        // Where nobody reads what lies beyond the count, only the rest of its block is written.
        let only = scan(gpu(), &stage, &values, 3 * BLOCK, Count::Only(&counts, 1), capacity);
        let end = count.min(capacity).next_multiple_of(BLOCK).min(capacity);
        want[end..3 * BLOCK].fill(POISON);
        assert_same(&format!("count {count} of {capacity} alone"), &only, &want);
    }
    let counts = upload(gpu(), &[u32::MAX]);
    let got = scan(gpu(), &stage, &values, values.len(), Count::At(&counts, 0), values.len());
    assert_same("count above the capacity", &got, &wanted(&values));
}

#[gpu_test]
fn overflow_by_one() {
    let stage = PrefixScan::new(&gpu().device);
    // The sum reaches, or passes by one, u32::MAX: inside a thread, a workgroup, across blocks, at the very end.
    for at in [1, 3, 63, 64, 1000, BLOCK - 1, BLOCK, 2 * BLOCK + 5, 3 * BLOCK] {
        for last in [0, 1, 2, u32::MAX] {
            let mut values = vec![0; 3 * BLOCK + 1];
            values[0] = u32::MAX - 1;
            values[at] = last;
            check(gpu(), &stage, &values);
        }
    }
    // In one lane of a vector alone, by two values of it, in a block that is full and in one that is not.
    for lane in 0..4 {
        for length in [2 * BLOCK, BLOCK + 40] {
            for (a, b) in [(0, 4), (8, 32), (BLOCK, BLOCK + 36)] {
                let mut values = vec![0; length];
                (values[a + lane], values[b + lane]) = (1 << 31, 1 << 31);
                check(gpu(), &stage, &values);
            }
        }
    }
    // 2^33: the low word alone would be 0.
    check(gpu(), &stage, &[1 << 31; 4]);
    check(gpu(), &stage, &vec![1 << 20; 2 * BLOCK]);
    // Capacity one short is refused, and so is one buffer as input and output.
    let device = &gpu().device;
    let (values, out, total) = (poisoned(gpu(), 10), poisoned(gpu(), 10), poisoned(gpu(), 2));
    let scratch = PrefixScan::scratch(device, 9).expect("scratch");
    let mut encoder = gpu().encoder();
    let mut recorder = subpixel_shadows::gpu::Recorder::new(device, &mut encoder, None);
    let mut s = recorder.stage("test");
    assert!(stage.record(&mut s, &values, &out, (&total, 0), &scratch, Count::Exactly(10)).is_err());
    assert!(stage.record(&mut s, &values, &values, (&total, 0), &scratch, Count::Exactly(9)).is_err());
    assert!(stage.record(&mut s, &values, &out, (&total, 1), &scratch, Count::Exactly(9)).is_err());
    assert!(stage.record(&mut s, &values, &out, (&total, 0), &scratch, Count::Exactly(9)).is_ok());
    assert!(PrefixScan::scratch(device, PrefixScan::MAX_VALUES + 1).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    // Three workgroups a dimension, and segments of 4 blocks: every fold and every segment border at small sizes.
    let gpu = small_gpu(3, 4 * 4 * BLOCK as u64);
    let stage = PrefixScan::new(&gpu.device);
    let values = Random::new(4).words(9 * BLOCK + 1);
    for size in [2 * BLOCK, 3 * BLOCK, 4 * BLOCK, 4 * BLOCK + 1, 8 * BLOCK - 1, 8 * BLOCK, 9 * BLOCK + 1] {
        check(&gpu, &stage, &values[..size]);
        check(&gpu, &stage, &values[..size].iter().map(|v| v >> 16).collect::<Vec<_>>());
        let counts = upload(&gpu, &[size as u32 - 7]);
        let got = scan(&gpu, &stage, &values[..size], size, Count::At(&counts, 0), size);
        let mut live = values[..size].to_vec();
        live[size - 7..].fill(0);
        assert_same(&format!("count {} of {size}", size - 7), &got, &wanted(&live));
    }
}

/// Above one binding of the adapter (2^25 values where it holds 128 MiB).
#[gpu_test]
fn above_the_binding_limit() {
    let stage = PrefixScan::new(&gpu().device);
    let values: Vec<u32> = (0..1u32 << 26).map(|i| (i ^ i >> 7) & 63).collect();
    check(gpu(), &stage, &values);
}

#[gpu_test]
fn detects_corruption() {
    let stage = PrefixScan::new(&gpu().device);
    let values = Random::new(5).list(BLOCK + 77, 9);
    let mut got = scan(gpu(), &stage, &values, values.len(), Count::Exactly(values.len()), values.len());
    let want = wanted(&values);
    assert_eq!(difference(&got, &want), None);
    got[BLOCK + 3] ^= 1;
    assert!(difference(&got, &want).is_some_and(|d| d.starts_with("1 of ")));
    got.truncate(want.len() - 1);
    assert!(difference(&got, &want).is_some(), "a short result is not the result");
}
