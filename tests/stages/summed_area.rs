//! The summed-area table against its definition.

use crate::support::{POISON, Random, assert_same, difference, gpu, run, sizes_around, small_gpu, upload};
use oracle::reference::summed_area::{pack, rect_sum, table, unpack};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::SummedArea;
use subpixel_shadows::stages::summed_area::{SummedAreaScratch, Texels};
use test_support::gpu_test;

/// The table on the GPU, with one word of poison behind it.
fn sat(gpu: &Gpu, stage: &SummedArea, texels: &[u32], len: usize, scratch: &SummedAreaScratch) -> Vec<u32> {
    let input = upload(gpu, texels);
    let sat = Buffer::banded(&gpu.device, "test.sat", len + 1).expect("memory for the table");
    sat.write(&gpu.queue, &vec![POISON; len + 1]);
    run(gpu, |s| stage.record(s, &input, &sat, scratch));
    let mut got = sat.read(gpu).expect("readback");
    assert_eq!(got.pop(), Some(POISON), "wrote past the table");
    got
}

struct Stages {
    words: SummedArea,
    bits: SummedArea,
}

fn stages(gpu: &Gpu) -> Stages {
    Stages { words: SummedArea::new(&gpu.device, Texels::Words), bits: SummedArea::new(&gpu.device, Texels::Bits) }
}

/// Both forms of a map, with strips of several lengths.
#[track_caller]
fn check(gpu: &Gpu, stages: &Stages, texels: &[u32], width: usize, height: usize, strips: &[usize]) {
    let marks: Vec<u32> = texels.iter().map(|&t| u32::from(t & 1 == 1)).collect();
    let mut packed = pack(&marks, width);
    for (word, last) in packed.iter_mut().zip((1..).map(|i| i % width.div_ceil(32).max(1) == 0)) {
        if last && !width.is_multiple_of(32) {
            *word |= u32::MAX << (width % 32); // padding must not count
        }
    }
    for &rows in strips {
        for (stage, input, map) in [(&stages.words, texels, texels), (&stages.bits, &packed, &marks)] {
            let scratch = stage.scratch_with_strips(&gpu.device, width, height, rows).expect("scratch");
            let got = sat(gpu, stage, input, width * height, &scratch);
            assert_same(&format!("table of {width}x{height}, strips of {rows}"), &got, &table(map, width));
        }
    }
}

#[gpu_test]
fn empty() {
    let stages = stages(gpu());
    for (width, height) in [(0, 0), (5, 0), (0, 5)] {
        check(gpu(), &stages, &[], width, height, &[4096, 1]);
    }
}

#[gpu_test]
fn one() {
    let stages = stages(gpu());
    for texel in [0, 1, u32::MAX] {
        check(gpu(), &stages, &[texel], 1, 1, &[4096, 1]);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stages = stages(gpu());
    let texels = Random::new(11).words(260 * 12);
    for width in [sizes_around(64), sizes_around(4), vec![31, 32, 33, 255, 256, 257]].concat() {
        check(gpu(), &stages, &texels[..width * 12], width, 12, &[4096, 4]);
    }
    for height in sizes_around(64) {
        check(gpu(), &stages, &texels[..9 * height], 9, height, &[4096, 64, 16]);
    }
}

#[gpu_test]
fn random_seeded() {
    let stages = stages(gpu());
    let mut random = Random::new(12);
    for _ in 0..20 {
        let (width, height) = (1 + random.below(300) as usize, 1 + random.below(300) as usize);
        check(gpu(), &stages, &random.words(width * height), width, height, &[4096, 32]);
    }
    let texels = random.words(512 * 512);
    check(gpu(), &stages, &texels, 512, 512, &[4096, 4096, 32]);
}

#[gpu_test]
fn degenerate() {
    let stages = stages(gpu());
    // One row, one column (longer than a strip), all clear, all set, and counts whose sums wrap.
    let texels = Random::new(13).words(16384);
    check(gpu(), &stages, &texels, 16384, 1, &[4096]);
    check(gpu(), &stages, &texels, 1, 16384, &[4096, 128]);
    check(gpu(), &stages, &texels[..3 * 4097], 3, 4097, &[4096]);
    for fill in [0, 1, u32::MAX] {
        check(gpu(), &stages, &vec![fill; 130 * 70], 130, 70, &[4096, 16]);
    }
}

/// 8192², all four corners of E24: 2^26 ones do not fit f32, and the table does not fit one 128 MiB binding.
#[gpu_test]
fn largest_map() {
    let side = 8192;
    let stage = SummedArea::new(&gpu().device, Texels::Bits);
    let mut words = Random::new(14).words(side * side / 32);
    words[..side].fill(u32::MAX);
    let scratch = stage.scratch(&gpu().device, side, side).expect("scratch");
    let got = sat(gpu(), &stage, &words, side * side, &scratch);
    assert_same("table of 8192x8192", &got, &table(&unpack(&words, side), side));
    words.fill(u32::MAX);
    let got = sat(gpu(), &stage, &words, side * side, &scratch);
    assert_eq!(got.last(), Some(&(1 << 26)));
    let wrong = got.iter().enumerate().find(|(i, s)| **s as usize != (i % side + 1) * (i / side + 1));
    assert_eq!(wrong, None);
}

#[gpu_test]
fn overflow_by_one() {
    let stage = SummedArea::new(&gpu().device, Texels::Words);
    let device = &gpu().device;
    let most = SummedArea::MAX_SIDE;
    assert!(stage.scratch(device, most, 1).is_ok());
    assert!(stage.scratch(device, most + 1, 1).is_err());
    assert!(stage.scratch(device, 1, most + 1).is_err());
    assert!(stage.scratch_with_strips(device, 9, 9, 3).is_err());
    let scratch = stage.scratch(device, 10, 10).expect("scratch");
    let (exact, short) = (upload(gpu(), &[0u32; 100]), upload(gpu(), &[0u32; 99]));
    let table = upload(gpu(), &[0u32; 100]);
    let mut encoder = gpu().encoder();
    let mut recorder = subpixel_shadows::gpu::Recorder::new(device, &mut encoder, None);
    let mut s = recorder.stage("test");
    assert!(stage.record(&mut s, &short, &table, &scratch).is_err());
    assert!(stage.record(&mut s, &table, &short, &scratch).is_err());
    assert!(SummedArea::new(device, Texels::Bits).record(&mut s, &exact, &table, &scratch).is_err());
    assert!(stage.record(&mut s, &exact, &table, &scratch).is_ok());
}

#[gpu_test]
fn two_d_dispatch() {
    // Four workgroups a dimension, and bands of 64, 128 or 192 rows.
    let gpu = small_gpu(4, 32 * 1024);
    let stages = stages(&gpu);
    for (width, height) in [(100, 200), (100, 192), (64, 128), (41, 500), (33, 449), (127, 129)] {
        let texels = Random::new(15).words(width * height);
        check(&gpu, &stages, &texels, width, height, &[4096, 64, 8]);
    }
    assert!(stages.bits.scratch(&gpu.device, 200, 200).is_err(), "64 rows of 200 do not fit 32 KiB");
}

/// `rect_sum` of the kernel and of the reference, over random rectangles, also empty ones and ones beyond the map.
#[gpu_test]
fn rectangle_sums() {
    let stage = SummedArea::new(&gpu().device, Texels::Words);
    let mut random = Random::new(16);
    let (width, height) = (61, 47);
    let table = table(&random.words(width * height), width);
    let rects: Vec<[u32; 4]> = (0..5000)
        .map(|i| {
            let high = if i % 10 == 0 { u32::MAX } else { 63 };
            [random.below(63), random.below(49), random.below(high), random.below(high)]
        })
        .collect();
    let (sat, list, sums) = (upload(gpu(), &table), upload(gpu(), &rects), upload(gpu(), &vec![POISON; rects.len()]));
    run(gpu(), |s| stage.record_queries(s, &sat, [width, height], &list, &sums));
    let want: Vec<u32> = rects.iter().map(|r| rect_sum(&table, width, r.map(|v| v as usize))).collect();
    assert_same("sums of rectangles", &sums.read(gpu()).expect("readback"), &want);
    assert!(want.contains(&0) && want.iter().any(|&s| s != 0));
}

#[gpu_test]
fn detects_corruption() {
    let stage = SummedArea::new(&gpu().device, Texels::Bits);
    let words = Random::new(17).words(8 * 40);
    let scratch = stage.scratch(&gpu().device, 256, 40).expect("scratch");
    let want = table(&unpack(&words, 256), 256);
    let mut got = sat(gpu(), &stage, &words, want.len(), &scratch);
    assert_eq!(difference(&got, &want), None);
    got[40 * 256 - 1] += 1;
    assert!(difference(&got, &want).is_some());
    let mut flipped = words;
    flipped[0] ^= 1;
    let got = sat(gpu(), &stage, &flipped, want.len(), &scratch);
    assert_eq!(got.iter().zip(&want).filter(|(g, w)| g == w).count(), 0, "texel (0, 0) counts everywhere");
}
