//! Lists of triangles out of G-buffers of several samples a pixel: layers of a texture, and a multisampled one.

use crate::support::multisampled::multisampled;
use crate::support::shadow::{folding_gpu, samples, uniform};
use crate::support::{POISON, Random, difference, gpu, padded, poisoned, read_padded, run, sizes_around, upload};
use oracle::reference::gbuffer_triangles::{TexelMeaning, nearest, pixels, shown};
use std::collections::BTreeMap;
use std::sync::Mutex;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu, Groups};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::gbuffer_triangles::{
    FAULT_UNKNOWN, GbufferTriangles, GbufferTrianglesParams, SampleGbuffer, Texture,
};
use subpixel_shadows::stages::pixel_coverage::{Covering, PairCoverage};
use subpixel_shadows::stages::pixel_triangles::PixelLists;
use subpixel_shadows::status_word;
use subpixel_shadows::wgpu;
use test_support::gpu_test;

/// A G-buffer.
#[derive(Clone)]
struct Case {
    size: [u32; 2],
    layers: Vec<Vec<u32>>,
    places: Vec<[f32; 2]>,
    numbers: Vec<u32>,
    first: u32,
    none: u32,
    /// Samples a pixel of the picture.
    ours: u32,
    /// Triangles that the lists can hold, if not as many as there are.
    room: Option<usize>,
}

impl Case {
    /// Pixels that show one to a few of `count` triangles, or nothing; one sample in `unknown` names none, if that is not 0.
    fn new(size: [u32; 2], samples: usize, ours: u32, count: u32, unknown: u32, random: &mut Random) -> Self {
        let (first, none) = (random.below(3) * 100, u32::MAX);
        let pixels = (size[0] * size[1]) as usize;
        let mut layers = vec![vec![none; pixels]; samples];
        for pixel in 0..pixels {
            let shown: Vec<u32> = (0..1 + random.below(5)).map(|_| random.below(count + 1)).collect();
            for layer in &mut layers {
                let t = shown[random.below(shown.len() as u32) as usize];
                layer[pixel] = if t == count { none } else { first + t };
                if unknown != 0 && random.below(unknown) == 0 {
                    layer[pixel] = first + count + random.below(9);
                }
            }
        }
        let place = |_| [random.below(256), random.below(256)].map(|v| v as f32 / 256.0);
        let places = (0..samples).map(place).collect();
        Self { size, layers, places, numbers: (0..count).rev().collect(), first, none, ours, room: None }
    }

    fn pixels(&self) -> usize {
        (self.size[0] * self.size[1]) as usize
    }

    fn texture(&self, gpu: &Gpu) -> wgpu::Texture {
        let [width, height] = self.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: self.layers.len() as u32 };
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("test.texture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: Some(height) };
        gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&self.layers.concat()), layout, size);
        texture
    }
}

/// All that was written, with padding: counts of what covers samples, flags, facets, single triangles, offsets, list; samples'
/// triangles; longest and unknown.
#[derive(Clone, Debug, PartialEq)]
struct Got {
    counts: Vec<u32>,
    flags: Vec<u32>,
    facets: Vec<u32>,
    singles: Vec<u32>,
    offsets: Vec<u32>,
    list: Vec<u32>,
    seen: Vec<u32>,
    longest: u32,
    unknown: u32,
}

fn complex_of(flags: &[u32]) -> Vec<u32> {
    (0..).zip(flags).filter(|(_, f)| **f != 0).map(|(p, _)| p).collect()
}

/// Whether the first triangle of a pixel covers its sample.
fn is_covered(slot: usize, k: usize) -> bool {
    (slot + k).is_multiple_of(3)
}

fn stage(gpu: &'static Gpu) -> &'static GbufferTriangles {
    static MADE: Mutex<BTreeMap<bool, &'static GbufferTriangles>> = Mutex::new(BTreeMap::new());
    let key = std::ptr::eq(gpu, self::gpu());
    let make = || &*Box::leak(Box::new(GbufferTriangles::new(&gpu.device, &PrefixScan::new(&gpu.device))));
    MADE.lock().expect("no test panicked here").entry(key).or_insert_with(make)
}

fn ask(gpu: &'static Gpu, case: &Case, texture: Texture) -> Got {
    let (device, pixels, ours) = (&gpu.device, case.pixels(), samples(case.ours));
    let words = ours.words();
    let (wanted, _) = wanted_pixels(case);
    let needed: usize = wanted.iter().filter(|p| p.complex()).map(|p| p.triangles.len()).sum();
    let room = case.room.unwrap_or(needed);
    let lists = PixelLists::new(device, pixels, 1).expect("memory");
    let lists = PixelLists {
        counts: poisoned(gpu, pixels),
        offsets: poisoned(gpu, pixels + 2),
        list: poisoned(gpu, room),
        complex_flags: poisoned(gpu, pixels),
        facet_counts: poisoned(gpu, pixels),
        ..lists
    };
    let id_keys = poisoned(gpu, pixels);
    let status = upload(gpu, &[0u32; 32]);
    let faults = upload(gpu, &[5u32, 6, 0, 0]);
    let complex = complex_of(&wanted.iter().map(|p| u32::from(p.complex())).collect::<Vec<_>>());
    let (complex_pixels, total) = (upload(gpu, &complex), upload(gpu, &[complex.len() as u32, 0]));
    let frame = Frame {
        image_size: case.size,
        triangle_count: case.numbers.len() as u32,
        sample_count: case.ours,
        pixel_triangle_capacity: room as u32,
        complex_capacity: complex.len() as u32,
        ..Frame::default()
    };
    let (frame, numbers) = (uniform(gpu, &frame), upload(gpu, &case.numbers));
    let scratch = PrefixScan::scratch(device, pixels).expect("memory");
    let params = GbufferTrianglesParams::new(ours.offsets(), &case.places, case.first, case.none).expect("parameters");
    let given = SampleGbuffer { texture, params, numbers: &numbers };
    let stage = stage(gpu);
    run(gpu, |s| stage.record(s, &frame, &given, &lists, &id_keys, &scratch, &status, &faults));
    let left = lists.counts.read(gpu).expect("readback");
    assert!(complex.iter().all(|&p| left[p as usize] == 0), "counts left over");
    let offsets = lists.offsets.read(gpu).expect("readback");
    // The first triangle of each pixel covers some samples, where it has room.
    let wide = words as usize;
    let coverage = PairCoverage { list: poisoned(gpu, room), masks: poisoned(gpu, room * wide) };
    let (mut counts, mut list) = (vec![0u32; pixels], coverage.list.read(gpu).expect("readback"));
    let mut masks = coverage.masks.read(gpu).expect("readback");
    for (slot, &pixel) in complex.iter().enumerate() {
        let (pixel, at) = (pixel as usize, offsets[pixel as usize] as usize);
        if at < room {
            counts[pixel] = 1;
            list[at] = Covering { triangle: wanted[pixel].triangles[0], ..Covering::default() };
            masks[at * wide..(at + 1) * wide].fill(0);
            let covered = (0..case.ours as usize).filter(|&k| is_covered(slot, k));
            covered.for_each(|k| masks[at * wide + k / 32] |= 1 << (k % 32));
        }
    }
    lists.counts.write(&gpu.queue, &counts);
    coverage.list.write(&gpu.queue, &list);
    coverage.masks.write(&gpu.queue, &masks);
    run(gpu, |s| {
        let groups = Groups::Items(complex.len() as u64 + 2);
        stage.record_fill(s, &frame, &given, &lists, &complex_pixels, &total, &coverage, groups)
    });
    let counts = lists.counts.read(gpu).expect("readback");
    let (list, masks) = (coverage.list.read(gpu).expect("readback"), coverage.masks.read(gpu).expect("readback"));
    let mut seen = vec![u32::MAX; complex.len() * 32 * wide];
    for (slot, &pixel) in complex.iter().enumerate() {
        let first = offsets[pixel as usize] as usize;
        for n in first..first + counts[pixel as usize] as usize {
            for k in (0..32 * wide).filter(|k| masks[n * wide + k / 32] >> (k % 32) & 1 == 1) {
                let before = std::mem::replace(&mut seen[slot * 32 * wide + k], list[n].triangle);
                assert_eq!(before, u32::MAX, "sample {k} of slot {slot} is given twice");
            }
        }
    }
    let read = |b: &Buffer<u32>| read_padded(gpu, b);
    Got {
        counts,
        flags: read(&lists.complex_flags),
        facets: read(&lists.facet_counts),
        singles: read(&id_keys),
        offsets,
        list: read_padded(gpu, &lists.list),
        seen,
        longest: status.read(gpu).expect("readback")[status_word!(longest_pixel)],
        unknown: faults.read(gpu).expect("readback")[FAULT_UNKNOWN as usize],
    }
}

fn wanted_pixels(case: &Case) -> (Vec<oracle::reference::gbuffer_triangles::PixelSamples>, u32) {
    pixels(&case.layers, case.first, case.none, &case.numbers)
}

fn wanted(case: &Case) -> Got {
    let (pixels, unknown) = wanted_pixels(case);
    let pad = |mut words: Vec<u32>| {
        words.resize(padded(words.len()), POISON);
        words
    };
    let flags: Vec<u32> = pixels.iter().map(|p| u32::from(p.complex())).collect();
    let mut offsets = vec![0];
    for p in &pixels {
        offsets.push(offsets[offsets.len() - 1] + if p.complex() { p.triangles.len() as u32 } else { 0 });
    }
    offsets.push(0);
    let room = case.room.unwrap_or(offsets[pixels.len()] as usize);
    let pairs = pixels.iter().zip(0..).filter(|(p, _)| p.complex());
    let list: Vec<[u32; 2]> = pairs.flat_map(|(p, at)| p.triangles.iter().map(move |&t| [t, at])).take(room).collect();
    let (complex, ours) = (complex_of(&flags), samples(case.ours));
    let (words, near) = (ours.words() as usize, nearest(ours.offsets(), &case.places));
    let (mut counts, mut seen) = (vec![0; pixels.len()], vec![u32::MAX; complex.len() * 32 * words]);
    for (slot, &pixel) in complex.iter().enumerate() {
        let at = pixel as usize;
        let most = room.min(offsets[at + 1] as usize).saturating_sub(offsets[at] as usize);
        let mut listed: Vec<u32> = pixels[at].triangles.iter().copied().take(most.min(1)).collect();
        for k in 0..case.ours as usize {
            if !listed.is_empty() && is_covered(slot, k) {
                seen[slot * 32 * words + k] = listed[0];
                continue;
            }
            let id = case.layers[near[k]][at];
            let TexelMeaning::Triangle(t) = shown(id, case.first, case.none, &case.numbers) else { continue };
            if !listed.contains(&t) && listed.len() < most {
                listed.push(t);
            }
            if listed.contains(&t) {
                seen[slot * 32 * words + k] = t;
            }
        }
        counts[at] = listed.len() as u32;
    }
    let longest = pixels.iter().filter(|p| p.complex()).map(|p| p.triangles.len() as u32).max().unwrap_or(0);
    Got {
        facets: pad(pixels.iter().map(|p| u32::from(p.single)).collect()),
        singles: pad(pixels.iter().map(|p| if p.single { !p.triangles[0] } else { POISON }).collect()),
        seen,
        counts,
        flags: pad(flags),
        list: {
            let mut words: Vec<u32> = list.concat();
            words.resize(padded(words.len()), POISON);
            words
        },
        offsets,
        longest,
        unknown,
    }
}

#[track_caller]
fn check(gpu: &'static Gpu, case: &Case) -> Got {
    let texture = case.texture(gpu);
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let got = ask(gpu, case, Texture::Layers(&view));
    assert_same(&got, &wanted(case));
    got
}

#[track_caller]
fn assert_same(got: &Got, want: &Got) {
    for (what, got, want) in [
        ("counts", &got.counts, &want.counts),
        ("flags", &got.flags, &want.flags),
        ("facets", &got.facets, &want.facets),
        ("single triangles", &got.singles, &want.singles),
        ("offsets", &got.offsets, &want.offsets),
        ("list", &got.list, &want.list),
        ("samples", &got.seen, &want.seen),
        ("longest and unknown", &vec![got.longest, got.unknown], &vec![want.longest, want.unknown]),
    ] {
        assert_eq!(difference(got, want), None, "{what}");
    }
}

#[gpu_test]
fn empty() {
    let got = check(gpu(), &Case::new([5, 3], 4, 32, 0, 0, &mut Random::new(1)));
    assert!(got.counts[..15].iter().all(|&c| c == 0));
}

#[gpu_test]
fn one() {
    for samples in [1, 2, 4] {
        check(gpu(), &Case::new([1, 1], samples, 8, 1, 0, &mut Random::new(samples as u64)));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for pixels in sizes_around(64) {
        check(gpu(), &Case::new([pixels as u32, 1], 3, 16, 40, 0, &mut Random::new(pixels as u64)));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(2);
    for (samples, ours) in [(1, 32), (4, 32), (8, 128), (32, 64), (128, 1), (128, 128), (5, 16)] {
        for size in [[31, 23], [3, 100]] {
            check(gpu(), &Case::new(size, samples, ours, 300, 0, &mut random));
            check(gpu(), &Case::new(size, samples, ours, 300, 50, &mut random));
        }
    }
}

/// As many triangles in a pixel as samples; only unknown ones; samples at one place.
#[gpu_test]
fn degenerate() {
    let mut case = Case::new([9, 2], 128, 128, 200, 0, &mut Random::new(3));
    let first = case.first;
    case.layers.iter_mut().zip(0..).for_each(|(layer, s)| layer.fill(first + s));
    assert_eq!(check(gpu(), &case).longest, 128);
    case.layers.iter_mut().for_each(|layer| layer.fill(first + 200));
    assert_eq!(check(gpu(), &case).unknown, 128 * 18);
    let mut case = Case::new([9, 2], 6, 32, 3, 0, &mut Random::new(4));
    case.places.fill([0.5; 2]);
    check(gpu(), &case);
    for bad in [[1.0, 0.5], [-0.1, 0.5], [f32::NAN, 0.5], [0.5, f32::INFINITY]] {
        assert!(GbufferTrianglesParams::new(&[[0.5; 2]], &[[0.5; 2], bad], 0, 1).is_err(), "{bad:?}");
    }
    assert!(
        GbufferTrianglesParams::new(&[[0.5; 2]], &[], 0, 1).is_err()
            && GbufferTrianglesParams::new(&[[0.5; 2]], &[[0.5; 2]; 129], 0, 1).is_err()
    );
}

#[gpu_test]
fn overflow_by_one() {
    let mut case = Case::new([20, 13], 4, 32, 50, 0, &mut Random::new(5));
    let needed = wanted(&case).offsets[case.pixels()] as usize;
    for room in [needed - 1, needed / 2, 1] {
        case.room = Some(room);
        assert_eq!(check(gpu(), &case).offsets[case.pixels()] as usize, needed);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups of pixels in three rows, and as many of complex ones, of which there are six.
    let mut case = Case::new([24, 24], 4, 32, 50, 0, &mut Random::new(6));
    let complex = complex_of(&wanted(&case).flags[..576]);
    let first = case.layers[0].clone();
    for layer in &mut case.layers {
        (0..576).filter(|p| !complex[..6].contains(p)).for_each(|p| layer[p as usize] = first[p as usize]);
    }
    assert!(check(folding_gpu(), &case) == check(gpu(), &case), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new([20, 13], 4, 32, 50, 40, &mut Random::new(7));
    let got = check(gpu(), &case);
    let mut other = case.clone();
    other.layers[2].rotate_left(1);
    assert!(got != wanted(&other), "another layer passes");
    let mut other = case.clone();
    other.places.rotate_left(1);
    assert!(got.seen != wanted(&other).seen, "samples at other places pass");
    let mut off = got.clone();
    off.list[7] ^= 1;
    assert!(off != wanted(&case) && difference(&off.list, &wanted(&case).list).is_some());
}

/// A texture of four samples and two channels, written sample by sample as hardware would, gives what layers give.
#[gpu_test]
fn samples_of_a_texture() {
    for (format, count) in [(wgpu::TextureFormat::Rg16Uint, 100_000), (wgpu::TextureFormat::R16Uint, 300)] {
        let mut case = Case::new([37, 21], 4, 32, count, 60, &mut Random::new(8));
        if format == wgpu::TextureFormat::R16Uint {
            let old = std::mem::replace(&mut case.none, 0xffff);
            case.layers.iter_mut().flatten().filter(|id| **id == old).for_each(|id| *id = 0xffff);
        }
        let texels: Vec<[u32; 4]> = case.layers.iter().flatten().map(|id| [id & 0xffff, id >> 16, 0, 0]).collect();
        let view = multisampled(gpu(), case.size, format, &texels);
        assert_same(&ask(gpu(), &case, Texture::Samples(&view)), &wanted(&case));
        let mut other = case.clone();
        other.layers.rotate_left(1);
        assert!(ask(gpu(), &case, Texture::Samples(&view)) != wanted(&other), "samples in another order pass");
    }
}
