//! Visibility as a texture, texel by texel.

use crate::support::shadow::{folding_gpu, uniform};
use crate::support::{Random, difference, gpu, read_texture, run, sizes_around, texture, upload};
use oracle::reference::visibility_texture::{Lengths, byte, half, is_complete, mean, texels};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::visibility_texture::{
    LastPicture, Lists, MeanVisibility, PackedVisibility, Packing, PointShare, VisibilityTexture,
};
use subpixel_shadows::status::{Need, Status, StatusBand, StatusHead};
use subpixel_shadows::wgpu;
use test_support::gpu_test;

/// What a texture holds before the stage runs, as bits.
const BEFORE: u32 = 0x40e0_0000;

/// Bits of the texels of a texture of `size`, row by row, after the stage ran on an image of `image` pixels.
fn ask(gpu: &Gpu, image: [u32; 2], size: [u32; 2], values: &[f32]) -> Vec<u32> {
    let frame = uniform(gpu, &Frame { image_size: image, ..Frame::default() });
    let before = vec![BEFORE; (size[0] * size[1]) as usize];
    let target = texture(gpu, size, wgpu::TextureFormat::R32Float, Some(&before));
    let visibility = upload(gpu, values);
    let stage = VisibilityTexture::new(&gpu.device);
    let view = target.create_view(&Default::default());
    run(gpu, |s| stage.record(s, &frame, &visibility, &view));
    read_texture(gpu, &target)
}

fn wanted(image: [u32; 2], size: [u32; 2], values: &[f32]) -> Vec<u32> {
    let mut out = vec![BEFORE; (size[0] * size[1]) as usize];
    for ([x, y], v) in texels(values, image[0] as usize) {
        if x < size[0] as usize && y < size[1] as usize {
            out[y * size[0] as usize + x] = v.to_bits();
        }
    }
    out
}

fn values(image: [u32; 2], random: &mut Random) -> Vec<f32> {
    (0..image[0] * image[1]).map(|_| random.below(33) as f32 / 32.0).collect()
}

#[track_caller]
fn check(gpu: &Gpu, image: [u32; 2], size: [u32; 2], values: &[f32]) -> Vec<u32> {
    let got = ask(gpu, image, size, values);
    assert_eq!(difference(&got, &wanted(image, size, values)), None);
    got
}

/// An image of no pixels writes nothing.
#[gpu_test]
fn empty() {
    assert!(check(gpu(), [0, 0], [3, 2], &[]).iter().all(|&t| t == BEFORE));
}

#[gpu_test]
fn one() {
    assert_eq!(check(gpu(), [1, 1], [1, 1], &[0.25]), [0.25f32.to_bits()]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    for pixels in sizes_around(64) {
        let image = [pixels as u32, 1];
        check(gpu(), image, image, &values(image, &mut Random::new(pixels as u64)));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(11);
    for image in [[64, 48], [61, 47], [3, 900], [1000, 2]] {
        check(gpu(), image, image, &values(image, &mut random));
    }
}

/// Every finite value keeps its bits.
#[gpu_test]
fn degenerate() {
    let odd = [0.0, 1.0, 1.0f32.next_down(), f32::MIN_POSITIVE, f32::MAX, -1.0, 1.0 / 3.0, f32::EPSILON];
    check(gpu(), [4, 2], [4, 2], &odd);
}

/// A texture that is a row or a column short takes what it holds; one that is larger keeps the rest as it was.
#[gpu_test]
fn overflow_by_one() {
    let image = [9, 8];
    let values = values(image, &mut Random::new(31));
    for size in [[9, 7], [8, 8], [10, 9]] {
        check(gpu(), image, size, &values);
    }
}

/// The image lies in a part of the texture, the rest of which stays.
#[gpu_test]
fn an_image_lies_where_its_origin_is() {
    let (gpu, image, size, [x, y]) = (gpu(), [9, 8], [20, 11], [7usize, 3usize]);
    let values = values(image, &mut Random::new(37));
    let frame = Frame { image_size: image, target_origin: [x as u32, y as u32], ..Frame::default() };
    let target = texture(gpu, size, wgpu::TextureFormat::R32Float, Some(&[BEFORE; 220]));
    let view = target.create_view(&Default::default());
    let (frame, visibility) = (uniform(gpu, &frame), upload(gpu, &values));
    run(gpu, |s| VisibilityTexture::new(&gpu.device).record(s, &frame, &visibility, &view));
    let mut wanted = vec![BEFORE; 220];
    texels(&values, 9).into_iter().for_each(|([i, j], v)| wanted[(y + j) * 20 + x + i] = v.to_bits());
    assert_eq!(difference(&read_texture(gpu, &target), &wanted), None);
}

/// A strip of rows is written where it belongs, but for the rows of its neighbours.
#[gpu_test]
fn a_strip_writes_its_own_rows() {
    let (gpu, whole) = (gpu(), [9, 40]);
    let values = values(whole, &mut Random::new(61));
    for (first, rows, above, below) in [(0, 13, 0, 0), (5, 20, 3, 0), (11, 29, 0, 0), (7, 8, 4, 4), (7, 9, 4, 4)] {
        let (image_size, first_row) = ([9, rows], first as u32);
        let frame = Frame { image_size, first_row, rows_above: above, rows_below: below, ..Frame::default() };
        let frame = uniform(gpu, &frame);
        let target = texture(gpu, whole, wgpu::TextureFormat::R32Float, Some(&[BEFORE; 360]));
        let visibility = upload(gpu, &values[9 * first..9 * (first + rows as usize)]);
        let view = target.create_view(&Default::default());
        run(gpu, |s| VisibilityTexture::new(&gpu.device).record(s, &frame, &visibility, &view));
        let mut wanted = wanted(whole, whole, &values);
        let own = first + above as usize..first + (rows - below) as usize;
        (0..360).filter(|t| !own.contains(&(t / 9))).for_each(|t| wanted[t] = BEFORE);
        assert_eq!(difference(&read_texture(gpu, &target), &wanted), None, "{own:?}");
    }
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups in three rows.
    let image = [24, 24];
    let values = values(image, &mut Random::new(41));
    assert!(check(folding_gpu(), image, image, &values) == check(gpu(), image, image, &values));
}

#[gpu_test]
fn detects_corruption() {
    let image = [20, 10];
    let values = values(image, &mut Random::new(51));
    let got = check(gpu(), image, image, &values);
    for at in [0, 77, 199] {
        let mut off = got.clone();
        off[at] ^= 1;
        assert!(difference(&off, &wanted(image, image, &values)).is_some());
    }
    assert!(difference(&got, &wanted([10, 20], image, &values)).is_some());
}

const PACKINGS: [Packing; 5] =
    [Packing::R8Unorm, Packing::R16Float, Packing::R32Float, Packing::Rgba8Channel(0), Packing::Rgba8Channel(3)];

/// Bytes of rows that held `BEFORE` after the stage ran.
fn packed(gpu: &Gpu, image: [u32; 2], values: &[f32], packing: Packing) -> Vec<u8> {
    let words = packing.row_bytes(image[0]) as usize / 4 * image[1] as usize;
    let rows = upload(gpu, &vec![BEFORE; words]);
    let (frame, visibility) = (uniform(gpu, &Frame { image_size: image, ..Frame::default() }), upload(gpu, values));
    let stage = PackedVisibility::new(&gpu.device);
    run(gpu, |s| stage.record(s, &frame, image, &visibility, packing, &rows).expect("rows that suffice"));
    bytemuck::pod_collect_to_vec(&rows.read(gpu).expect("readback")[..words])
}

/// Where the bytes differ from the definition: those of texels, and of a channel the others, which stay.
fn packing_fault(got: &[u8], image: [u32; 2], values: &[f32], packing: Packing) -> Option<String> {
    let (row, each) = (packing.row_bytes(image[0]) as usize, packing.texel_bytes() as usize);
    let mut wanted: Vec<u8> = bytemuck::pod_collect_to_vec(&vec![BEFORE; got.len() / 4]);
    let mut known = vec![false; got.len()];
    for ([x, y], v) in texels(values, image[0] as usize) {
        let at = y * row + x * each;
        known[at..at + each].fill(true);
        match packing {
            Packing::R8Unorm => wanted[at] = byte(f64::from(v)),
            Packing::R16Float => wanted[at..at + 2].copy_from_slice(&half(f64::from(v)).to_le_bytes()),
            Packing::R32Float => wanted[at..at + 4].copy_from_slice(&v.to_le_bytes()),
            Packing::Rgba8Channel(channel) => wanted[at + channel as usize] = byte(f64::from(v)),
        }
    }
    let of = |bytes: &[u8]| bytes.iter().zip(&known).filter(|(_, k)| **k).map(|(b, _)| *b).collect::<Vec<u8>>();
    difference(&of(got), &of(&wanted))
}

#[gpu_test]
fn rows_are_packed_as_told() {
    let mut random = Random::new(91);
    for packing in PACKINGS {
        for image in [[0, 0], [1, 1], [3, 2], [64, 3], [65, 2], [255, 4], [60, 8]] {
            let mut values = values(image, &mut random);
            // Not only shares of samples.
            for v in values.iter_mut().step_by(3) {
                *v = [random.below(1 << 24) as f32 / (1 << 24) as f32, 1e-5, 6.1e-5, 1.0][random.below(4) as usize];
            }
            let got = packed(gpu(), image, &values, packing);
            assert_eq!(packing_fault(&got, image, &values, packing), None, "{packing:?} {image:?}");
            if image == [60, 8] {
                let corner = if let Packing::Rgba8Channel(channel) = packing { channel as usize } else { 0 };
                for at in [0, 256] {
                    let mut off = got.clone();
                    off[at + corner] ^= 1;
                    assert!(packing_fault(&off, image, &values, packing).is_some(), "{packing:?}: a corrupted byte");
                }
                let folded = packed(folding_gpu(), image, &values, packing);
                assert_eq!(packing_fault(&folded, image, &values, packing), None, "{packing:?}, folded");
            }
        }
        // 128 samples: each share is one of 16 bits.
        assert!((0..=128).all(|k| half(f64::from(k) / 128.0) as u32 == half_bits(k)), "{packing:?}");
    }
    let stage = PackedVisibility::new(&gpu().device);
    let (frame, visibility) = (uniform(gpu(), &Frame::default()), upload(gpu(), &[0.5f32; 8]));
    let short = upload(gpu(), &[0u32; 64]);
    run(gpu(), |s| assert!(stage.record(s, &frame, [8, 2], &visibility, Packing::R8Unorm, &short).is_err()));
}

/// The sums of the pixels from `offset` on, and the last picture, after all `points` were added.
fn added(gpu: &Gpu, image: [u32; 2], points: &[Vec<f32>], offset: u32) -> (Vec<f32>, Vec<f32>) {
    let (frame, pixels) = (uniform(gpu, &Frame { image_size: image, ..Frame::default() }), points[0].len());
    let sums = upload(gpu, &vec![f32::from_bits(BEFORE); offset as usize + pixels + 3]);
    let (stage, count) = (MeanVisibility::new(&gpu.device), points.len() as u32);
    let mut last = Vec::new();
    for (point, values) in (0..).zip(points) {
        let part = PointShare { offset, point, points: count, ..PointShare::default() };
        let visibility = upload(gpu, values);
        run(gpu, |s| stage.record(s, &frame, &visibility, pixels, &sums, part).expect("sums that suffice"));
        last = visibility.read(gpu).expect("readback")[..pixels].to_vec();
        assert!(point + 1 == count || last == *values, "the visibility of point {point} of {count} changes");
    }
    (sums.read(gpu).expect("readback")[..offset as usize + pixels + 3].to_vec(), last)
}

/// The mean over points is that of their sums; where all are lit it is 1, and beside the image nothing is written.
#[gpu_test]
fn points_of_a_light_are_averaged() {
    let mut random = Random::new(83);
    let close = |a: f32, b: f32| (a - b).abs() <= 1e-6;
    for (image, count, offset) in [([1, 1], 1, 0), ([9, 8], 3, 5), ([64, 3], 16, 64), ([65, 2], 7, 1), ([24, 24], 2, 0)]
    {
        let mut points: Vec<Vec<f32>> = (0..count).map(|_| values(image, &mut random)).collect();
        points.iter_mut().for_each(|point| point[0] = 1.0);
        let wanted = mean(&points);
        for gpu in [gpu(), folding_gpu()] {
            let (sums, got) = added(gpu, image, &points, offset);
            assert!(got.iter().zip(&wanted).all(|(a, b)| close(*a, *b)), "{image:?}, {count} points");
            assert_eq!(got[0], 1.0, "{image:?}, {count} points: all are lit");
            let (first, last) = (offset as usize, offset as usize + got.len());
            let stays = |v: &f32| v.to_bits() == BEFORE;
            assert!(sums[..first].iter().chain(&sums[last..]).all(stays), "{image:?}: beside the image");
            let whole = sums[first..last].iter().zip(&wanted).all(|(sum, mean)| close(sum / count as f32, *mean));
            assert!(whole, "{image:?}: the sums");
            let other = got.iter().zip(&wanted).position(|(a, b)| !close(*a + 1.0 / 32.0, *b));
            assert_eq!(other, Some(0), "a corrupted picture passes");
        }
    }
    let (frame, few) = (uniform(gpu(), &Frame::default()), upload(gpu(), &[0.5f32; 8]));
    let short = MeanVisibility::new(&gpu().device);
    let part = PointShare { offset: 1, points: 2, ..PointShare::default() };
    run(gpu(), |s| assert!(short.record(s, &frame, &few, 8, &few, part).is_err()));
}

/// The bits of `k` parts of 128, which need no rounding.
fn half_bits(k: u32) -> u32 {
    if k == 0 { 0 } else { ((k as f32 / 128.0).to_bits() >> 13) - (112 << 10) }
}

/// A frame's counters, each need at, below or beyond what its list holds: one alone decides, and so does a fault or another stamp.
#[gpu_test]
fn what_is_missing_is_found() {
    let gpu = gpu();
    let stage = LastPicture::new(&gpu.device);
    let mut random = Random::new(71);
    let mut found = [0, 0];
    for case in 0..400 {
        let bands = [1, 2, 63, 64, 65, 200][random.below(6) as usize];
        let band = [50, 60, 70, 80].map(|n| n + random.below(5));
        let camera = (case % 2 == 1).then(|| [90, 91, 92, 93].map(|n| n + random.below(5)));
        let frame = Frame {
            stamp: 1 + random.below(3),
            flags: if camera.is_some() { Frame::CLAMP } else { 0 },
            pixel_texel_capacity: band[0],
            triangle_texel_capacity: band[1],
            candidate_capacity: band[2],
            pixel_triangle_capacity: camera.map_or(0, |c| c[0]),
            complex_capacity: camera.map_or(0, |c| c[1]),
            facets_total: camera.map_or(7, |c| c[2]),
            ..Frame::default()
        };
        let lists = Lists { bands, most_at_place: band[3], most_at_pixel: camera.map_or(512, |c| c[3]), pad_0: 0 };
        // All lists full, then one thing wrong, or none.
        let [triangles, complex, facets, pixel] = camera.unwrap_or([7; 4]);
        let need = |items| Need { items, over: 0 };
        let head = StatusHead {
            finished: frame.stamp,
            longest_pixel: pixel,
            pixel_triangles: need(triangles),
            complex_pixels: need(complex),
            facets_needed: need(facets),
            ..StatusHead::default()
        };
        let full = |random: &mut Random| StatusBand {
            pixel_pairs: need(band[0]),
            triangle_pairs: need(band[1]),
            candidates: band[2],
            doubts: random.word(),
            longest: band[3],
            marked_texels: random.word(),
        };
        let mut status = Status { head, bands: (0..bands).map(|_| full(&mut random)).collect() };
        let mut faults = [0; 4];
        let one = random.below(bands) as usize;
        match random.below(4) {
            0 => {}
            1 => faults[random.below(4) as usize] = 1 + random.below(9),
            _ => {
                let (head, band) = (&mut status.head, &mut status.bands[one]);
                let words = [
                    &mut head.finished,
                    &mut head.longest_pixel,
                    &mut head.pixel_triangles.items,
                    &mut head.pixel_triangles.over,
                    &mut head.complex_pixels.items,
                    &mut head.complex_pixels.over,
                    &mut head.facets_needed.items,
                    &mut head.facets_needed.over,
                    &mut band.pixel_pairs.items,
                    &mut band.pixel_pairs.over,
                    &mut band.triangle_pairs.items,
                    &mut band.triangle_pairs.over,
                    &mut band.candidates,
                    &mut band.longest,
                ];
                let which = random.below(words.len() as u32) as usize;
                words.into_iter().nth(which).into_iter().for_each(|word| *word += 1);
            }
        }
        let lengths = Lengths { band, camera };
        let want = is_complete(&status, &faults, frame.stamp, lengths);
        found[usize::from(want)] += 1;
        let verdict = upload(gpu, &[0u32]);
        let (frame, status, faults) = (uniform(gpu, &frame), upload(gpu, &status.to_words()), upload(gpu, &faults));
        run(gpu, |s| stage.record_judge(s, &frame, &lists, &status, &faults, &verdict));
        assert_eq!(verdict.read(gpu).expect("readback"), [u32::from(!want)], "case {case}: {lengths:?}, {bands} bands");
    }
    assert!(found[0] > 100 && found[1] > 100, "{found:?}");
}

/// Words are copied if nothing is missing, all of them, and none else.
#[gpu_test]
fn what_is_complete_is_held() {
    for gpu in [gpu(), folding_gpu()] {
        let stage = LastPicture::new(&gpu.device);
        for size in [1, 63, 64, 65, 300, 570] {
            let mut random = Random::new(81 + size as u64);
            let latest: Vec<u32> = (0..size).map(|_| random.word()).collect();
            for missing in [0u32, 1] {
                let (verdict, from) = (upload(gpu, &[missing]), upload(gpu, &latest));
                let held = upload(gpu, &vec![BEFORE; size + 8]);
                run(gpu, |s| stage.record_hold(s, &verdict, &from, &held));
                let got = held.read(gpu).expect("readback");
                let want = if missing == 0 { latest.clone() } else { vec![BEFORE; size] };
                assert_eq!(difference(&got[..size], &want), None, "{size}, {missing}");
                // Bindings are multiples of 16 bytes.
                assert!(got[size.next_multiple_of(4)..].iter().all(|&w| w == BEFORE), "{size}: behind the last");
            }
        }
    }
}
