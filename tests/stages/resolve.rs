//! Visibility from masks, exactly.

use crate::support::pixels::{STATES, any, uploaded};
use crate::support::shadow::{folding_gpu, uniform};
use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, upload};
use oracle::reference::resolve::{FacetBits, pixel};
use oracle::truth::split_mask;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::facet_classify::Facets;
use subpixel_shadows::stages::resolve::Resolve;
use subpixel_shadows::status_word;
use test_support::gpu_test;

const STAMP: u32 = 0xdecade;
const COUNTS: [u32; 6] = [1, 8, 16, 32, 64, 128];

/// Visibility bits, lit words, and the counts by state, from the GPU.
fn resolve(gpu: &Gpu, stage: &Resolve, count: u32, pixels: &[Vec<FacetBits>]) -> Vec<u32> {
    let words = count.div_ceil(32) as usize;
    let memory = uploaded(gpu, count, pixels);
    let frame = Frame { image_size: [pixels.len() as u32, 1], sample_count: count, stamp: STAMP, ..Frame::default() };
    let frame = uniform(gpu, &frame);
    let visibility = Buffer::<f32>::storage(&gpu.device, "test.visibility", pixels.len()).expect("memory");
    visibility.write(&gpu.queue, &vec![f32::from_bits(POISON); pixels.len()]);
    let lit = poisoned(gpu, pixels.len() * words);
    let status = upload(gpu, &[7; 32]);
    run(gpu, |s| stage.record(s, &frame, &memory, &visibility, &lit, &status));
    let mut out: Vec<u32> = visibility.read(gpu).expect("readback").iter().map(|v| v.to_bits()).collect();
    out.extend(lit.read(gpu).expect("readback"));
    out.extend(status.read(gpu).expect("readback"));
    out
}

fn wanted(count: u32, pixels: &[Vec<FacetBits>]) -> Vec<u32> {
    let words = count.div_ceil(32) as usize;
    let all: Vec<_> = pixels.iter().map(|p| pixel(p)).collect();
    let mut out: Vec<u32> = all.iter().map(|p| p.0.to_bits()).collect();
    out.extend(all.iter().flat_map(|p| split_mask(p.1)[..words].to_vec()));
    let mut status = vec![7; 32];
    status[status_word!(finished)] = STAMP;
    for (k, state) in STATES.iter().enumerate() {
        status[status_word!(facets) + k] += pixels.iter().flatten().filter(|m| m.state == *state).count() as u32;
    }
    out.extend(status);
    out
}

#[track_caller]
fn check(gpu: &Gpu, count: u32, pixels: &[Vec<FacetBits>]) {
    let stage = Resolve::new(&gpu.device, count.div_ceil(32));
    let got = resolve(gpu, &stage, count, pixels);
    // Software and hardware alike round the quotient of small integers as IEEE does, or one step beside it (2.5 ulp).
    let want = wanted(count, pixels);
    let near = |(g, w): (u32, &u32)| if g.abs_diff(*w) <= 2 { *w } else { g };
    let shares: Vec<u32> = got[..pixels.len()].iter().copied().zip(&want).map(near).collect();
    assert_same("visibility", &shares, &want[..pixels.len()]);
    assert_same("lit and status", &got[pixels.len()..], &want[pixels.len()..]);
}

#[gpu_test]
fn empty() {
    check(gpu(), 32, &[vec![], vec![], vec![]]);
    check(gpu(), 128, &[vec![]]);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(51);
    for count in COUNTS {
        check(gpu(), count, &any(1, count, 1, &mut random));
        check(gpu(), count, &any(5, count, 1, &mut random));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(52);
    let stage = Resolve::new(&gpu().device, 1);
    for size in sizes_around(64) {
        let pixels = any(size, 16, 2, &mut random);
        let got = resolve(gpu(), &stage, 16, &pixels);
        assert_same("lit", &got[size..], &wanted(16, &pixels)[size..]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(53);
    for count in COUNTS {
        check(gpu(), count, &any(3000, count, 3, &mut random));
        check(gpu(), count, &any(20, count, 200, &mut random));
    }
}

/// All samples invalid, all occluded, none covered: a pixel that nothing counts in is lit.
#[gpu_test]
fn degenerate() {
    let all = u128::MAX >> 96;
    let mut pixels = Vec::new();
    for state in STATES {
        for (coverage, occluded, invalid) in [(all, 0, all), (all, all, 0), (0, 0, 0), (1, 0, 0), (all, all, all)] {
            pixels.push(vec![FacetBits { state, coverage, occluded, invalid }]);
        }
    }
    check(gpu(), 32, &pixels);
}

/// There is no list to overflow: what lies behind the last pixel stays as it was.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(54);
    for size in [3, 63, 64, 65] {
        let pixels = any(size, 32, 1, &mut random);
        let stage = Resolve::new(&gpu().device, 1);
        let memory = Facets::new(&gpu().device, 1, size, 1).expect("memory");
        memory.pixel_facets.write(&gpu().queue, &vec![0; size + 1]);
        let frame = uniform(gpu(), &Frame { image_size: [size as u32 - 1, 1], sample_count: 32, ..Frame::default() });
        let visibility = Buffer::<f32>::storage(&gpu().device, "test.visibility", size).expect("memory");
        visibility.write(&gpu().queue, &vec![0.25; size]);
        let (lit, status) = (poisoned(gpu(), size), upload(gpu(), &[0; 32]));
        run(gpu(), |s| stage.record(s, &frame, &memory, &visibility, &lit, &status));
        let shares = visibility.read(gpu()).expect("readback");
        assert!(shares[..size - 1].iter().all(|&v| v == 1.0) && shares[size - 1] == 0.25);
        assert_eq!(lit.read(gpu()).expect("readback")[size - 1], POISON);
        assert_eq!(pixels.len(), size);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(55);
    check(folding_gpu(), 32, &any(64 * 8 + 5, 32, 2, &mut random));
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(56);
    let pixels = any(100, 64, 2, &mut random);
    let stage = Resolve::new(&gpu().device, 2);
    let mut got = resolve(gpu(), &stage, 64, &pixels);
    let want = wanted(64, &pixels);
    assert_eq!(difference(&got[100..], &want[100..]), None);
    got[150] ^= 0x100;
    assert!(difference(&got[100..], &want[100..]).is_some_and(|d| d.starts_with("1 of ")));
}
