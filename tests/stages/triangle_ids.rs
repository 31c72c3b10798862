//! Triangle numbers out of a texture.

use crate::support::shadow::{folding_gpu, uniform};
use crate::support::{
    POISON, Random, difference, gpu, padded, poisoned, read_padded, run, sizes_around, texture, upload,
};
use oracle::reference::triangle_ids::triangles;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::triangle_ids::{FAULT_UNKNOWN, TriangleIds, TriangleIdsParams};
use subpixel_shadows::wgpu;
use test_support::gpu_test;

/// A picture of triangle numbers.
#[derive(Clone)]
struct Case {
    size: [u32; 2],
    texels: Vec<u32>,
    numbers: Vec<u32>,
    counted: TriangleIdsParams,
}

impl Case {
    /// `count` triangles in any order; one texel in `unknown` names none, if that is not 0.
    fn new(size: [u32; 2], count: u32, first: u32, unknown: u32, random: &mut Random) -> Self {
        let none = first.wrapping_sub(1);
        let texels = (0..size[0] * size[1])
            .map(|_| match random.below(4) {
                0 => none,
                1 if unknown != 0 && random.below(unknown) == 0 => first + count + random.below(9),
                _ if count == 0 => none,
                _ => first + random.below(count),
            })
            .collect();
        let mut numbers: Vec<u32> = (0..count).collect();
        (1..count).rev().for_each(|i| numbers.swap(i as usize, random.below(i + 1) as usize));
        Self { size, texels, numbers, counted: TriangleIdsParams { first, none } }
    }

    /// Keys, padding included, and the count of unknown texels.
    fn ask(&self, gpu: &Gpu) -> Vec<u32> {
        self.ask_of(gpu, Frame { image_size: self.size, ..Frame::default() })
    }

    /// Those of a strip of rows.
    fn ask_of(&self, gpu: &Gpu, strip: Frame) -> Vec<u32> {
        let pixels = (strip.image_size[0] * strip.image_size[1]) as usize;
        let frame = uniform(gpu, &Frame { triangle_count: self.numbers.len() as u32, ..strip });
        let ids = texture(gpu, self.size, wgpu::TextureFormat::R32Uint, Some(&self.texels));
        let numbers = upload(gpu, &self.numbers);
        let keys = poisoned(gpu, pixels);
        let faults = poisoned(gpu, 4);
        faults.write(&gpu.queue, &[POISON, POISON, 0]);
        let stage = TriangleIds::new(&gpu.device);
        let view = ids.create_view(&Default::default());
        run(gpu, |s| stage.record(s, &frame, &view, self.counted, &numbers, &keys, &faults));
        let mut out = read_padded(gpu, &keys);
        out.extend(faults.read(gpu).expect("readback"));
        out
    }

    fn wanted(&self) -> Vec<u32> {
        let (seen, unknown) = triangles(&self.texels, self.counted.first, self.counted.none, &self.numbers);
        let mut out: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
        out.resize(padded(out.len()), POISON);
        let mut faults = [POISON; 4];
        faults[FAULT_UNKNOWN as usize] = unknown;
        out.extend(faults);
        out
    }
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Vec<u32> {
    let got = case.ask(gpu);
    assert_eq!(difference(&got, &case.wanted()), None);
    got
}

#[gpu_test]
fn empty() {
    let got = check(gpu(), &Case::new([5, 3], 0, 0, 0, &mut Random::new(1)));
    assert!(got[..15].iter().all(|&key| key == 0));
}

#[gpu_test]
fn one() {
    for first in [0, 1, 77] {
        check(gpu(), &Case::new([1, 1], 1, first, 0, &mut Random::new(u64::from(first))));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for pixels in sizes_around(64) {
        check(gpu(), &Case::new([pixels as u32, 1], 40, 1, 0, &mut Random::new(pixels as u64)));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(11);
    for size in [[64, 48], [61, 47], [3, 900], [1000, 2]] {
        for first in [0, 1, 1 << 30] {
            check(gpu(), &Case::new(size, 5000, first, 3, &mut random));
        }
    }
}

/// Texels that name no triangle are counted, at either end of the numbers.
#[gpu_test]
fn degenerate() {
    let case = Case {
        size: [4, 2],
        texels: vec![0, 9, 10, 12, 13, u32::MAX, 11, 0x8000_0000],
        numbers: vec![2, 0, 1],
        counted: TriangleIdsParams { first: 10, none: 9 },
    };
    let got = check(gpu(), &case);
    assert_eq!(got[8 + FAULT_UNKNOWN as usize], 4);
    let wraps = Case { counted: TriangleIdsParams { first: u32::MAX - 1, none: 0 }, ..case };
    check(gpu(), &wraps);
}

/// The stage has no list: nothing is written past the last pixel.
#[gpu_test]
fn overflow_by_one() {
    for pixels in [63, 65, 127, 129] {
        check(gpu(), &Case::new([pixels, 1], 3, 0, 2, &mut Random::new(31)));
    }
}

/// A strip of rows has the keys of its rows, and counts the faults of those that are its own.
#[gpu_test]
fn a_strip_is_its_rows() {
    let case = Case::new([16, 30], 50, 7, 3, &mut Random::new(61));
    let rows_of = |first: usize, count: usize| Case {
        size: [16, count as u32],
        texels: case.texels[16 * first..16 * (first + count)].to_vec(),
        ..case.clone()
    };
    for (first, rows, above, below) in [(0, 12, 0, 0), (9, 12, 3, 0), (18, 12, 0, 0), (5, 20, 4, 4)] {
        let strip = Frame {
            image_size: [16, rows as u32],
            first_row: first as u32,
            rows_above: above as u32,
            rows_below: below as u32,
            ..Frame::default()
        };
        let got = case.ask_of(gpu(), strip);
        let mut wanted = rows_of(first, rows).wanted();
        let faults = wanted.len() - 4 + FAULT_UNKNOWN as usize;
        let own = rows_of(first + above, rows - above - below).wanted();
        wanted[faults] = own[own.len() - 4 + FAULT_UNKNOWN as usize];
        assert_eq!(difference(&got, &wanted), None, "{rows} rows from {first}");
    }
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups in three rows.
    let case = Case::new([24, 24], 50, 0, 5, &mut Random::new(41));
    assert!(check(folding_gpu(), &case) == check(gpu(), &case), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new([20, 10], 50, 0, 5, &mut Random::new(51));
    let got = check(gpu(), &case);
    for at in [0, 77, 199, 200 + FAULT_UNKNOWN as usize] {
        let mut off = got.clone();
        off[at] ^= 1;
        assert!(difference(&off, &case.wanted()).is_some());
    }
    let mut other = case.clone();
    other.counted.first = 1;
    assert!(difference(&got, &other.wanted()).is_some());
}
