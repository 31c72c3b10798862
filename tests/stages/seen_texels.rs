//! Which texels the pixels ask for, against footprints in `f64`: what lies well within reach of one is marked, what lies well
//! without is not.

use crate::support::shadow::{
    World, above, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples, sheet, uniform,
};
use crate::support::spsm::{footprint, pixels, take_list, with_blocks};
use crate::support::{Random, gpu, run, sizes_around};
use oracle::reference::seen_texels::asked;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::seen_texels::{SeenTexels, TexelMarks};
use subpixel_shadows::stages::spsm_map::{SpsmMap, SpsmTexels};
use subpixel_shadows::stages::spsm_query::{Class, SpsmPixels, SpsmQuery, SpsmQueryOptions};
use test_support::gpu_test;

const REACH: u32 = 3;

/// Marks before and after the uncertain pixels were known, and what came of the pixels.
struct Ran {
    first: Vec<u32>,
    then: Vec<u32>,
    classes: Vec<u32>,
    lit: Vec<u32>,
    visibility: Vec<f32>,
    missed: bool,
    seen: Vec<Option<u32>>,
}

/// A frame in which only the texels are made that are asked for; `spoil` has the marks before the map is made.
fn ask_spoilt(world: &World, spoil: &dyn Fn(&mut Vec<u32>)) -> Ran {
    let gpu = world.gpu;
    let count = pixels(world);
    let size = world.view.map.map_size as usize;
    let many = world.samples.count() > 1;
    let options =
        SpsmQueryOptions { words: world.words() as u32, many, stretch: REACH - 1, ..SpsmQueryOptions::default() };
    let texels = SpsmTexels::new(&gpu.device, &gpu.queue, size, count, 5).expect("memory");
    let out = SpsmPixels::new(&gpu.device, &gpu.queue, count, world.words()).expect("memory");
    let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
    let id_keys = Buffer::from_slice(&gpu.device, &gpu.queue, "test.ids", &keys).expect("memory");
    let (points, frame, offsets) = (world.points(), uniform(gpu, &world.frame), world.sample_offsets());
    let from =
        PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
    let stage = SeenTexels::new(&gpu.device, options, &texels);
    let map = SpsmMap::new(&gpu.device, 1, &texels);
    let query = SpsmQuery::new(&gpu.device, &PrefixScan::new(&gpu.device), options, &texels);
    let read = || texels.marks.words.read(gpu).expect("readback");
    run(gpu, |s| stage.record(s, &frame, from, &texels));
    let mut first = read();
    spoil(&mut first);
    texels.marks.words.write(&gpu.queue, &first);
    with_blocks(world, |blocks| {
        run(gpu, |s| {
            map.record(s, &frame, blocks, &texels)?;
            query.record_classify(s, &frame, from, &texels, &out)?;
            stage.record_around(s, &frame, from, &texels, &out);
            map.record_last(s, &frame, blocks, &texels)?;
            query.record_settle(s, &frame, from, &texels, &out)
        });
    });
    take_list(gpu, &texels.marks, &out);
    run(gpu, |s| query.record_recover(s, &frame, from, &texels, &out));
    Ran {
        first,
        then: read(),
        classes: out.classes(gpu).expect("readback"),
        lit: out.lit.read(gpu).expect("readback"),
        visibility: out.visibility.read(gpu).expect("readback"),
        missed: texels.marks.missed(gpu).expect("readback"),
        seen,
    }
}

fn ask(world: &World) -> Ran {
    ask_spoilt(world, &|_| ())
}

/// Where the stage departs from its definition.
fn fault(world: &World, ran: &Ran) -> Option<String> {
    let size = world.view.map.map_size;
    let many = world.samples.count() > 1;
    let marked = |words: &[u32]| -> Vec<bool> {
        let at = |k: u32| [(k % size) as usize, (k / size) as usize];
        (0..size * size).map(|k| TexelMarks::is_marked(words, size as usize, at(k))).collect()
    };
    // What of a pixel is certain: it faces the light, and its footprint is known and small.
    let certain = |pixel: usize, t: u32, [low, high]: [DVec2; 2]| {
        let [a, b, c] = world.triangles[t as usize].corners.expect("it is seen");
        let normal = (b - a).cross(c - a);
        let edge = 1e-3 * (b - a).length() * (c - a).length();
        let open = world.view.side([a, b, c]) * -normal.dot(a) > 0.0 && world.view.side([a, b, c]).abs() > edge;
        let extent = high.floor() - low.floor() + 2.0;
        let small = extent.x * extent.y <= 25.0;
        (open && small && ran.classes[pixel] != Class::Dark as u32).then_some(())
    };
    let boxes = |grow: f64, sure: bool, wanted: &dyn Fn(u32) -> bool| -> Vec<[DVec2; 2]> {
        let of = |(pixel, t): (usize, &Option<u32>)| {
            let t = (*t)?;
            let [low, high] = footprint(world, pixel as u32, t, many)?;
            if sure {
                certain(pixel, t, [low, high])?;
            }
            let (low, high) = (low - grow, high + grow);
            // A footprint smaller than what it shrinks by is left at its middle.
            let middle = 0.5 * (low + high);
            wanted(ran.classes[pixel]).then_some([low.min(middle), high.max(middle)])
        };
        ran.seen.iter().enumerate().filter_map(of).collect()
    };
    let any = |_: u32| true;
    let uncertain = |class: u32| class == Class::Uncertain as u32;
    let places = [
        ("at first", &ran.first, asked(boxes(-1e-3, true, &any), 0, size), 0),
        ("then", &ran.then, asked(boxes(-1e-3, true, &uncertain), REACH, size), REACH),
    ];
    for (when, words, inner, reach) in places {
        let outer = asked(boxes(0.1, false, &any), reach, size);
        for (k, is) in marked(words).into_iter().enumerate() {
            let at = format!("{when}: texel {} {}", k as u32 % size, k as u32 / size);
            if inner[k] && !is {
                return Some(format!("{at} is asked for, and is not marked"));
            }
            // Footprints without end ask for what nobody bounds here.
            if is
                && !outer[k]
                && ran
                    .seen
                    .iter()
                    .enumerate()
                    .all(|(p, t)| t.is_none_or(|t| footprint(world, p as u32, t, many).is_some()))
            {
                return Some(format!("{at} is marked, and nobody asks for it"));
            }
        }
    }
    let bits = 2 * (size as usize).div_ceil(8).pow(2);
    let at = TexelMarks::HEADER;
    for k in 0..bits {
        let (before, last, after) = (ran.first[at + k], ran.then[at + bits + k], ran.then[at + k]);
        if before & last != 0 || before | last != after {
            return Some(format!("word {k}: {before:x} and {last:x} make {after:x}"));
        }
    }
    ran.missed.then(|| "a texel is missed".to_owned())
}

/// Checks the marks, and that the pixels are what they are where all texels are made.
#[track_caller]
fn check(world: &World) -> Ran {
    let ran = ask(world);
    if let Some(text) = fault(world, &ran) {
        panic!("{:?}, {} samples: {text}", world.light, world.samples.count());
    }
    let whole = ask_spoilt(world, &|words| {
        let bits = 2 * (world.view.map.map_size as usize).div_ceil(8).pow(2);
        words[TexelMarks::HEADER..TexelMarks::HEADER + bits].fill(u32::MAX);
    });
    assert!(!whole.missed, "a texel is missed where all are made");
    assert!(ran.classes == whole.classes && ran.lit == whole.lit, "other texels, another picture");
    assert!(ran.visibility == whole.visibility, "other texels, another picture");
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 9, 8));
    assert!(ran.then.iter().all(|&w| w == 0), "an empty scene asks for nothing");
}

#[gpu_test]
fn one() {
    let mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    let ran = check(&world(gpu(), &mesh, above(), [1, 1], 63, 1));
    assert_eq!(ran.first[TexelMarks::HEADER..].iter().map(|w| w.count_ones()).sum::<u32>(), 1, "one pixel, one texel");
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 1));
    }
    for map in sizes_around(8) {
        check(&world(gpu(), &mesh, above(), [40, 30], map as u32, 1));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, count) in [1, 8, 32, 1].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            check(&world(gpu(), &mesh, light, [40, 30], [64, 250][k / 2], count));
        }
    }
}

/// A plane seen almost from its edge, whose footprints have no end, and one that the light almost misses.
#[gpu_test]
fn degenerate() {
    let mesh = sheet(3, 30.0, |_, _| 0.0, |p| p);
    for height in [1e-3, 0.2] {
        let camera = camera(DVec3::new(0.0, height, 40.0), DVec3::ZERO, 40.0);
        for light in [above(), Light::Directional { direction: [1.0, 0.01, 0.0] }] {
            for count in [1, 8] {
                check(&World::new(gpu(), &mesh, camera, light, [40, 30], 100, samples(count)));
            }
        }
    }
    let mesh = sheet(3, 1.0, |_, _| 0.0, |p| DVec3::new(p.x, p.z, 0.1));
    check(&world(gpu(), &mesh, Light::Directional { direction: [0.0, 1.0, 0.0] }, [20, 15], 40, 8));
}

/// The stage has no list but that of the pixels: more of them than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1));
    assert_eq!(ran.classes.len(), 65_537);
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 100, 1));
    let (a, b) = (of(folding_gpu()), of(gpu()));
    let bits = TexelMarks::HEADER..a.first.len();
    assert!(a.first[bits.clone()] == b.first[bits], "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 200, 1);
    let ran = check(&world);
    let at = TexelMarks::HEADER;
    let full = (at..ran.first.len()).find(|&k| ran.first[k] != 0).expect("a marked texel");
    // A mark that is not made is told by who reads the texel.
    let bit = ran.first[full] & ran.first[full].wrapping_neg();
    let off = ask_spoilt(&world, &|words| words[full] &= !bit);
    assert!(off.missed, "a texel that is not made is read, and nobody says so");
    assert!(fault(&world, &off).is_some());
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world);
        assert_eq!(fault(&world, &off), None);
        spoil(&mut off);
        fault(&world, &off).is_some()
    };
    assert!(spoilt(&|r| r.first[full] &= !bit));
    assert!(spoilt(&|r| r.then[full] &= !bit));
    assert!(spoilt(&|r| r.missed = true));
    // What the uncertain pixels ask for, as if it had not been.
    assert!(spoilt(&|r| {
        let bits = 2 * 25 * 25;
        r.then[at + bits..at + 2 * bits].fill(0);
        r.then[at..at + bits].copy_from_slice(&r.first[at..at + bits]);
    }));
    let bits = 2 * 25 * 25;
    let bare = (at..at + bits).find(|&k| ran.then[k] == 0).expect("a word without marks");
    assert!(spoilt(&|r| {
        r.first[bare] = 1;
        r.then[bare] = 1;
    }));
}
