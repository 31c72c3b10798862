//! Lights listed by tiles, exactly, but for samples that rounding puts on either side of the end of a light's reach.

use crate::support::pixels::{STATES, any};
use crate::support::shadow::{World, above, folding_gpu, looked_down_on as world, random_scene, uniform};
use crate::support::{POISON, Random, assert_same, difference, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::light_lists::{LightVolume, byte, words};
use oracle::reference::resolve::FacetBits;
use oracle::truth::split_mask;
use subpixel_shadows::frame::{Frame, sample_words};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::facet_classify::{Facet, Facets};
use subpixel_shadows::stages::light_lists::{LightListMemory, LightLists, LightPart, words_for};
use subpixel_shadows::wgpu;
use test_support::gpu_test;

/// The word of each tile's pixels, as the stage keeps them.
fn tiled([width, height]: [usize; 2], bytes: &[u8]) -> Vec<u32> {
    let [across, down] = [width, height].map(|side| side.div_ceil(8));
    let mut out = vec![0; 16 * across * down];
    for (k, byte) in bytes.iter().enumerate() {
        let (x, y) = (k % width, k / width);
        out[16 * (y / 8 * across + x / 8) + y % 8 * 2 + x % 8 / 4] |= u32::from(*byte) << (8 * (x % 4));
    }
    out
}

/// Lists of these lights, of which the visibility is known, from the GPU.
fn listed(gpu: &Gpu, size: [usize; 2], lights: &[(u32, &[u8])], capacity: usize) -> Vec<u32> {
    let image = size.map(|side| side as u32);
    let memory = LightListMemory::new(&gpu.device, image).expect("memory");
    let stage = LightLists::new(&gpu.device, 1);
    let room = words_for(image, capacity as u64) as usize;
    let lists = upload(gpu, &vec![POISON; room + 2]);
    let part = |light| LightPart::everywhere(light, image, capacity as u32);
    run(gpu, |s| stage.record_begin(s, part(0), lists.raw()).expect("recorded"));
    for (light, bytes) in lights {
        memory.shares.write(&gpu.queue, &tiled(size, bytes));
        run(gpu, |s| stage.record_append(s, part(*light), &memory, lists.raw()).expect("recorded"));
    }
    let mut got = lists.read(gpu).expect("readback");
    assert_eq!(got.split_off(room), [POISON; 2], "written beyond the room");
    if !lights.is_empty() {
        assert_eq!(memory.need.read(gpu).expect("readback")[0], got[0]);
    }
    // Entries that were not needed are not written.
    got.iter_mut().for_each(|word| *word = if *word == POISON { 0 } else { *word });
    got
}

/// Bytes of an image, dark in patches.
fn patches([width, height]: [usize; 2], random: &mut Random) -> Vec<u8> {
    let lit: Vec<bool> = (0..width.div_ceil(8) * height.div_ceil(8)).map(|_| random.below(3) == 0).collect();
    let one = |k: usize, random: &mut Random| {
        let tile = k / width / 8 * width.div_ceil(8) + k % width / 8;
        if lit[tile] { random.below(256) as u8 } else { 0 }
    };
    (0..width * height).map(|k| one(k, random)).collect()
}

#[track_caller]
fn check(gpu: &Gpu, size: [usize; 2], lights: usize, capacity: usize, random: &mut Random) {
    let bytes: Vec<Vec<u8>> = (0..lights).map(|_| patches(size, random)).collect();
    let lights: Vec<(u32, &[u8])> = (3..).zip(bytes.iter().map(Vec::as_slice)).collect();
    assert_same("lists", &listed(gpu, size, &lights, capacity), &words(size, &lights, capacity));
}

#[gpu_test]
fn empty() {
    let dark = [0; 12];
    assert_same("lists", &listed(gpu(), [4, 3], &[], 2), &words([4, 3], &[], 2));
    assert_same("lists", &listed(gpu(), [4, 3], &[(1, &dark), (2, &dark)], 2), &words([4, 3], &[], 2));
}

#[gpu_test]
fn one() {
    assert_same("lists", &listed(gpu(), [1, 1], &[(7, &[9])], 1), &words([1, 1], &[(7, &[9])], 1));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(31);
    for tiles in sizes_around(64) {
        check(gpu(), [8 * tiles, 8], 2, 2 * tiles, &mut random);
        check(gpu(), [8 * tiles - 7, 3], 2, 2 * tiles, &mut random);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(32);
    for size in [[83, 61], [64, 64], [7, 300], [300, 7]] {
        check(gpu(), size, 16, 2000, &mut random);
    }
    for (kind, count) in [(0, 1), (1, 8), (2, 32), (3, 64), (1, 128)] {
        for cone in [false, true] {
            let seen = Seen::new(gpu(), kind, count, cone, &mut random);
            assert_eq!(seen.faults(&seen.shares(gpu(), seen.part())), 0, "scene {kind}, {count} samples");
        }
    }
}

/// A light everywhere, a light nowhere, and pixels that see nothing.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(33);
    let seen = Seen::new(gpu(), 1, 32, true, &mut random);
    let far = seen.shares(gpu(), LightPart { range: 1e-30, ..seen.part() });
    assert!(far.iter().all(|byte| *byte == 0), "{far:?}");
    let everywhere = seen.shares(gpu(), LightPart { everywhere: 1, ..seen.part() });
    let wide = seen.shares(gpu(), LightPart { range: f32::MAX, cosine: -2.0, axis: [0.0; 3], ..seen.part() });
    let all: Vec<u8> =
        seen.facets.iter().map(|f| byte(&f.iter().map(|f| (f.1, u128::MAX)).collect::<Vec<_>>())).collect();
    assert_eq!(everywhere, all);
    // Planes that rays meet behind the eye are in no reach.
    assert!(wide.iter().zip(&all).all(|(wide, all)| wide <= all));
    let plain = Seen { facets: vec![Vec::new(); seen.facets.len()], ..seen };
    assert!(plain.shares(gpu(), plain.part()).iter().all(|byte| *byte == 0));
}

#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(34);
    let size = [83, 61];
    let bytes: Vec<Vec<u8>> = (0..5).map(|_| patches(size, &mut random)).collect();
    let lights: Vec<(u32, &[u8])> = (0..).zip(bytes.iter().map(Vec::as_slice)).collect();
    let needed = words(size, &lights, 0)[0] as usize;
    for capacity in [needed, needed - 1, needed / 2, 1, 0] {
        let got = listed(gpu(), size, &lights, capacity);
        assert_same("lists", &got, &words(size, &lights, capacity));
        assert_eq!(got[0] as usize, needed);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(35);
    check(folding_gpu(), [48, 47], 3, 80, &mut random);
    let seen = Seen::new(gpu(), 1, 32, true, &mut random);
    assert_eq!(seen.shares(folding_gpu(), seen.part()), seen.shares(gpu(), seen.part()));
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(36);
    let bytes = patches([83, 61], &mut random);
    let (got, want) = (listed(gpu(), [83, 61], &[(3, &bytes)], 99), words([83, 61], &[(3, &bytes)], 99));
    assert_eq!(difference(&got, &want), None);
    for at in [0, 3, 8, 9, got.len() - 1] {
        let mut wrong = got.clone();
        wrong[at] ^= 1;
        assert!(difference(&wrong, &want).is_some(), "{at}");
    }
    let seen = Seen::new(gpu(), 1, 32, true, &mut random);
    assert_eq!(seen.faults(&seen.shares(gpu(), seen.part())), 0);
    let part = seen.part();
    for other in [
        LightPart { range: part.range * 0.7, ..part },
        LightPart { cosine: part.cosine + 0.1, ..part },
        LightPart { axis: [part.axis[1], part.axis[2], part.axis[0]], ..part },
    ] {
        assert!(seen.faults(&seen.shares(gpu(), other)) > 10, "{other:?}");
    }
}

/// Facets in any state over the planes of a scene's triangles, and a light of some reach.
struct Seen {
    world: World,
    reach: LightVolume,
    /// Triangle and masks of the facets of each pixel.
    facets: Vec<Vec<(u32, FacetBits)>>,
}

impl Seen {
    fn new(gpu: &'static Gpu, kind: u32, count: u32, cone: bool, random: &mut Random) -> Self {
        let world = world(gpu, &random_scene(kind, random), above(), [37, 23], 8, count);
        let triangles = world.triangles.len() as u32;
        let seen = world.seen();
        let some = any(37 * 23, count, 3, random);
        let with = |(pixel, facets): (usize, Vec<FacetBits>), random: &mut Random| {
            let own = |k: usize, random: &mut Random| match seen[pixel].1 {
                Some(t) if k == 0 => t,
                _ => random.below(triangles),
            };
            facets.into_iter().enumerate().map(|(k, f)| (own(k, random), f)).collect()
        };
        let facets = some.into_iter().enumerate().map(|facets| with(facets, random)).collect();
        let axis = DVec3::new(0.2, -1.0, 0.1).normalize();
        let eye = DVec3::from(world.camera.eye.map(f64::from));
        // Given in single precision, as the light of a frame is.
        let scale = world.view.scale;
        let at = ((DVec3::new(0.3, 1.4, 0.2) - eye) * scale).as_vec3().as_dvec3();
        let (axis, cosine) = (axis.as_vec3().as_dvec3(), f64::from(0.8f32));
        let reach = LightVolume { at, range: f64::from(3.0f32) * scale, cone: cone.then_some((axis, cosine)) };
        Self { world, reach, facets }
    }

    fn part(&self) -> LightPart {
        let (axis, cosine) = self.reach.cone.unwrap_or((DVec3::ZERO, -2.0));
        LightPart {
            axis: axis.as_vec3().into(),
            cosine: cosine as f32,
            range: (self.reach.range / self.world.view.scale) as f32,
            everywhere: 0,
            ..LightPart::everywhere(0, [37, 23], 0)
        }
    }

    /// A byte a pixel, from the GPU.
    fn shares(&self, gpu: &Gpu, part: LightPart) -> Vec<u8> {
        let words = self.world.words();
        let count: usize = self.facets.iter().map(Vec::len).sum();
        let memory = Facets::new(&gpu.device, count, self.facets.len(), words).expect("memory");
        let state = |m: &FacetBits| STATES.iter().position(|s| *s == m.state).expect("a state") as u32;
        let all = || self.facets.iter().flatten();
        let list: Vec<Facet> =
            all().map(|(t, m)| Facet { triangle: *t, state: state(m), ..Facet::default() }).collect();
        memory.list.write(&gpu.queue, &list);
        let masks = |m: &FacetBits| [m.coverage, m.occluded, m.invalid].map(|m| split_mask(m)[..words].to_vec());
        memory.masks.write(&gpu.queue, &all().flat_map(|(_, m)| masks(m).concat()).collect::<Vec<_>>());
        let mut firsts = vec![0];
        self.facets.iter().for_each(|p| firsts.push(firsts.last().unwrap_or(&0) + p.len() as u32));
        memory.pixel_facets.write(&gpu.queue, &firsts);
        let light = self.reach.at.as_vec3().extend(1.0).into();
        let frame = uniform(gpu, &Frame { light, ..self.world.frame });
        let samples = Buffer::uniform(&gpu.device, "test.samples", 64).expect("memory");
        samples.write(&gpu.queue, &sample_words(&self.world.samples));
        let lists = LightListMemory::new(&gpu.device, [37, 23]).expect("memory");
        let casters = self.world.prepared.upload(&gpu.device, &gpu.queue).expect("memory");
        let stage = LightLists::new(&gpu.device, words as u32);
        run(gpu, |s| {
            stage.record_share(s, (&frame, &samples, [37, 23]), part, &casters, &memory, &lists).expect("recorded");
        });
        let tiles = lists.shares.read(gpu).expect("readback");
        let at = |k: usize| (k % 37, k / 37);
        let word = |(x, y): (usize, usize)| tiles[16 * (y / 8 * 5 + x / 8) + y % 8 * 2 + x % 8 / 4] >> (8 * (x % 4));
        (0..37 * 23).map(|k| word(at(k)) as u8).collect()
    }

    /// Pixels whose byte is none that the definition allows: samples near the end of the reach count or do not.
    fn faults(&self, got: &[u8]) -> usize {
        let view = &self.world.view;
        let doubt = 1e-4;
        let reached = |pixel: usize, t: u32, least: f64| {
            let Some(corners) = self.world.triangles[t as usize].corners else { return 0 };
            let mut mask = 0u128;
            for (k, o) in self.world.samples.offsets().iter().enumerate() {
                let ray = pixel_ray(view, pixel as u32, DVec2::new(f64::from(o[0]), f64::from(o[1])) - 0.5);
                mask |= u128::from(self.reach.along(corners, ray) >= least) << k;
            }
            mask
        };
        let wrong = |pixel: usize| {
            let ends = [doubt, -doubt].map(|least| {
                let facets: Vec<_> = self.facets[pixel].iter().map(|(t, f)| (*f, reached(pixel, *t, least))).collect();
                byte(&facets)
            });
            !(ends[0]..=ends[1]).contains(&got[pixel])
        };
        (0..got.len()).filter(|pixel| wrong(*pixel)).count()
    }
}

/// One surface a pixel: the byte is that of the visibility where the centre is within reach.
#[gpu_test]
fn centres_are_within_reach() {
    let mut random = Random::new(37);
    let seen = Seen::new(gpu(), 1, 1, true, &mut random);
    let (gpu, world) = (gpu(), &seen.world);
    let shares: Vec<f32> = (0..37 * 23).map(|_| random.below(33) as f32 / 32.0).collect();
    let ids: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let keys = upload(gpu, &ids.iter().map(|t| t.map_or(0, |t| !t)).collect::<Vec<_>>());
    let visibility = Buffer::from_slice(&gpu.device, &gpu.queue, "test.visibility", &shares).expect("memory");
    let lists = LightListMemory::new(&gpu.device, [37, 23]).expect("memory");
    let frame = uniform(gpu, &Frame { light: seen.reach.at.as_vec3().extend(1.0).into(), ..world.frame });
    let stage = LightLists::new(&gpu.device, 1);
    run(gpu, |s| {
        let casters = &world.casters;
        let of = (&keys, &visibility);
        stage.record_centres(s, (&frame, [37, 23]), seen.part(), casters, of, &lists).expect("recorded");
    });
    let tiles = lists.shares.read(gpu).expect("readback");
    let mut reached = [0; 2];
    for (pixel, t) in ids.iter().enumerate() {
        let (x, y) = (pixel % 37, pixel / 37);
        let got = (tiles[16 * (y / 8 * 5 + x / 8) + y % 8 * 2 + x % 8 / 4] >> (8 * (x % 4))) as u8;
        let within = t.map_or(-1.0, |t| {
            let corners = world.triangles[t as usize].corners.expect("it is seen");
            seen.reach.along(corners, pixel_ray(&world.view, pixel as u32, DVec2::ZERO))
        });
        let want = if within > 0.0 { (255.0 * shares[pixel]).round() as u8 } else { 0 };
        assert!(got == want || within.abs() < 1e-4, "pixel {pixel}: {got}, {want} expected");
        reached[usize::from(within > 0.0)] += 1;
    }
    assert!(reached.iter().all(|count| *count > 50), "{reached:?}");
}

/// Lists that are too short for what they are said to hold are refused.
#[gpu_test]
fn lists_without_their_room_are_refused() {
    let gpu = gpu();
    let stage = LightLists::new(&gpu.device, 1);
    let usage = wgpu::BufferUsages::STORAGE;
    let descriptor =
        wgpu::BufferDescriptor { label: None, size: 4 * words_for([9, 9], 3), usage, mapped_at_creation: false };
    let lists = gpu.device.create_buffer(&descriptor);
    for (capacity, fits) in [(3, true), (4, false)] {
        let part = LightPart::everywhere(0, [9, 9], capacity);
        run(gpu, |s| assert_eq!(stage.record_begin(s, part, &lists).is_ok(), fits));
    }
}
