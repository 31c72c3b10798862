//! Visibility weighted over the samples of a pixel and of those around it.

use crate::support::pixels::{any, uploaded};
use crate::support::shadow::{folding_gpu, uniform};
use crate::support::{POISON, Random, gpu, run, sizes_around, upload};
use oracle::reference::pixel_filter::visibility;
use oracle::reference::resolve::{FacetBits, pixel, seen};
use oracle::truth::{join_mask, split_mask};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::pixel_filter::PixelFilter;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::stages::pixel_filter::{FilterMasks, FilterMemory};
use test_support::gpu_test;

const FILTERS: [PixelFilter; 3] = [PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::Mitchell];
/// Visibility before the stage runs.
const BEFORE: f32 = -7.0;

fn samples(count: u32) -> Samples {
    Samples::new(Pattern::LowDiscrepancy, count).expect("samples")
}

/// Visibility and seen words of an image `size` pixels wide and high, from the GPU.
fn filtered(
    gpu: &Gpu,
    filter: PixelFilter,
    count: u32,
    size: [u32; 2],
    pixels: &[Vec<FacetBits>],
) -> (Vec<f32>, Vec<u128>) {
    let (samples, words) = (samples(count), count.div_ceil(32) as usize);
    let facets = uploaded(gpu, count, pixels);
    let frame = uniform(gpu, &Frame { image_size: size, sample_count: count, ..Frame::default() });
    let lit: Vec<u32> = pixels.iter().flat_map(|p| split_mask(pixel(p).1)[..words].to_vec()).collect();
    let lit = upload(gpu, &lit);
    let shares = Buffer::<f32>::storage(&gpu.device, "test.visibility", pixels.len()).expect("memory");
    shares.write(&gpu.queue, &vec![BEFORE; pixels.len()]);
    let memory = FilterMemory::new(&gpu.device, &gpu.queue, filter, &samples, pixels.len()).expect("memory");
    memory.seen.write(&gpu.queue, &vec![POISON; pixels.len() * words]);
    let stage = FilterMasks::new(&gpu.device, words as u32, filter);
    run(gpu, |s| stage.record(s, &frame, &facets, &lit, &shares, &memory));
    let seen = memory.seen.read(gpu).expect("readback");
    let seen = seen.chunks(words).map(|part| {
        let mut all = [0; 4];
        all[..words].copy_from_slice(part);
        join_mask(all)
    });
    (shares.read(gpu).expect("readback"), seen.collect())
}

fn wanted(filter: PixelFilter, count: u32, size: [u32; 2], pixels: &[Vec<FacetBits>]) -> (Vec<f64>, Vec<u128>) {
    let lit: Vec<u128> = pixels.iter().map(|p| pixel(p).1).collect();
    let seen: Vec<u128> = pixels.iter().map(|p| seen(p)).collect();
    (visibility(filter, &samples(count), size, &lit, &seen), seen)
}

/// How many pixels are farther from the definition than rounding takes them.
fn wrong(got: &[f32], want: &[f64]) -> usize {
    assert_eq!(got.len(), want.len());
    got.iter().zip(want).filter(|(g, w)| (f64::from(**g) - **w).abs() > 2e-5 || !g.is_finite()).count()
}

#[track_caller]
fn check(gpu: &Gpu, count: u32, size: [u32; 2], pixels: &[Vec<FacetBits>]) {
    for filter in FILTERS {
        let (got, want) = (filtered(gpu, filter, count, size, pixels), wanted(filter, count, size, pixels));
        assert_eq!(got.1, want.1, "{filter:?}, {count} samples: seen");
        assert_eq!(wrong(&got.0, &want.0), 0, "{filter:?}, {count} samples");
    }
}

#[gpu_test]
fn empty() {
    check(gpu(), 32, [3, 1], &[vec![], vec![], vec![]]);
    check(gpu(), 128, [1, 1], &[vec![]]);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(71);
    for count in Samples::COUNTS {
        check(gpu(), count, [1, 1], &any(1, count, 2, &mut random));
        check(gpu(), count, [1, 5], &any(5, count, 2, &mut random));
        check(gpu(), count, [5, 1], &any(5, count, 2, &mut random));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(72);
    for size in sizes_around(64) {
        check(gpu(), 8, [size as u32, 1], &any(size, 8, 2, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(73);
    for count in Samples::COUNTS {
        check(gpu(), count, [37, 23], &any(37 * 23, count, 3, &mut random));
    }
}

/// Nothing seen, nothing lit, all lit; one sample that is seen amid nothing.
#[gpu_test]
fn degenerate() {
    use oracle::reference::facet_classify::FacetState::{Dark, Lit, Undecided};
    let all = u128::MAX >> 96;
    let facet = |state, coverage, occluded| vec![FacetBits { state, coverage, occluded, invalid: 0 }];
    for (pixel, share) in [(facet(Dark, all, 0), 0.0), (facet(Lit, all, 0), 1.0), (Vec::new(), 1.0)] {
        let pixels = vec![pixel; 49];
        for filter in FILTERS {
            assert_eq!(filtered(gpu(), filter, 32, [7, 7], &pixels).0, [share; 49], "{filter:?}");
        }
    }
    for sample in 0..32 {
        let mut pixels = vec![Vec::new(); 49];
        pixels[24] = facet(Lit, 1 << sample, 0);
        check(gpu(), 32, [7, 7], &pixels);
        pixels[25] = facet(Undecided, all, all >> 3);
        check(gpu(), 32, [7, 7], &pixels);
    }
}

/// There is no list to overflow: what lies behind the last pixel stays as it was.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(74);
    for size in [3, 63, 64, 65] {
        let pixels = any(size, 32, 1, &mut random);
        let got = filtered(gpu(), PixelFilter::Tent, 32, [size as u32 - 1, 1], &pixels).0;
        assert!(got[..size - 1].iter().all(|v| (0.0..=1.0).contains(v)), "{got:?}");
        assert_eq!(got[size - 1], BEFORE);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(75);
    check(folding_gpu(), 32, [47, 11], &any(47 * 11, 32, 2, &mut random));
}

/// A sample more or less is noticed, and so are a filter and an image of another width.
#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(76);
    let (size, mut pixels) = ([20, 10], any(200, 64, 2, &mut random));
    let got = filtered(gpu(), PixelFilter::Gaussian, 64, size, &pixels).0;
    let far = |filter, size, pixels: &[Vec<FacetBits>]| wrong(&got, &wanted(filter, 64, size, pixels).0);
    assert_eq!(far(PixelFilter::Gaussian, size, &pixels), 0);
    assert!(far(PixelFilter::Tent, size, &pixels) > 100);
    assert!(far(PixelFilter::Gaussian, [10, 20], &pixels) > 100);
    use oracle::reference::facet_classify::FacetState::Undecided;
    pixels[105] = vec![FacetBits { state: Undecided, coverage: u128::MAX >> 64, occluded: 0, invalid: 0 }];
    let got = filtered(gpu(), PixelFilter::Gaussian, 64, size, &pixels).0;
    pixels[105][0].occluded = 1;
    assert!((1..=9).contains(&wrong(&got, &wanted(PixelFilter::Gaussian, 64, size, &pixels).0)));
}
