//! The depth that a texel is compared by, texel by texel against `f64`.

use crate::support::shadow::folding_gpu;
use crate::support::{POISON, Random, gpu, poisoned, read_padded, sizes_around, upload};
use oracle::reference::compared_depths::{Compared, compared};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::compared_depths::{ComparedDepths, DepthRule};
use subpixel_shadows::stages::light_layers::Layers;
use test_support::gpu_test;

const RULES: [DepthRule; 4] = [DepthRule::Midpoint, DepthRule::Second, DepthRule::Dual(0.02), DepthRule::Dual(1.0)];

struct Ran {
    rule: DepthRule,
    /// Keys of the two nearest depths of each texel.
    given: Vec<[u32; 2]>,
    made: Vec<u32>,
}

fn settle(gpu: &Gpu, size: u32, rule: DepthRule, given: Vec<[u32; 2]>) -> Ran {
    let frame = Buffer::uniform(&gpu.device, "test.frame", 1).expect("memory");
    frame.write(&gpu.queue, &[Frame { map_size: size, ..Frame::default() }]);
    let keys = |k: usize| given.iter().map(|keys| keys[k]).collect::<Vec<u32>>();
    let layers = Layers {
        nearest_keys: poisoned(gpu, given.len()),
        second_keys: upload(gpu, &keys(1)),
        mask: upload(gpu, &[0]),
        splits: upload(gpu, &[0.0]),
    };
    layers.nearest_keys.write(&gpu.queue, &keys(0));
    let stage = ComparedDepths::new(&gpu.device, rule);
    crate::support::run(gpu, |s| stage.record(s, &frame, &layers, size));
    let mut made = read_padded(gpu, &layers.nearest_keys);
    assert!(made[given.len()..].iter().all(|&word| word == POISON), "written past the end");
    made.truncate(given.len());
    Ran { rule, given, made }
}

fn depth_of(key: u32) -> Option<f64> {
    (key != 0).then(|| f64::from(f32::from_bits(!key)))
}

/// Where the stage departs from its definition.
fn fault(ran: &Ran) -> Option<String> {
    let rule = match ran.rule {
        DepthRule::Midpoint => Compared::Midpoint,
        DepthRule::Second => Compared::Second,
        DepthRule::Dual(farthest) => Compared::Dual(f64::from(farthest)),
    };
    for (texel, (&[nearest, second], &key)) in ran.given.iter().zip(&ran.made).enumerate() {
        let want = compared(rule, depth_of(nearest), depth_of(second));
        let agree = match (depth_of(key), want) {
            (None, None) => true,
            (Some(got), Some(want)) => (got - want).abs() <= 1.2e-7 * want.abs() + 1e-38,
            _ => false,
        };
        if !agree {
            return Some(format!("texel {texel}: {:?}, {want:?} expected by {:?}", depth_of(key), ran.rule));
        }
    }
    (ran.given.len() != ran.made.len()).then(|| "another number of texels".to_owned())
}

#[track_caller]
fn check(gpu: &Gpu, size: u32, given: &[[u32; 2]]) {
    for rule in RULES {
        if let Some(text) = fault(&settle(gpu, size, rule, given.to_vec())) {
            panic!("a map of {size}: {text}");
        }
    }
}

fn key(depth: f32) -> u32 {
    !depth.to_bits()
}

/// Depths of a map: a fifth of the texels without any, a third of the others with one.
fn keys(size: u32, random: &mut Random) -> Vec<[u32; 2]> {
    let mut depth = || random.below(1 << 20) as f32 / (1 << 20) as f32;
    let mut texel = |k: u32| {
        let (a, b) = (depth(), depth());
        match k.wrapping_mul(0x9e37_79b9) >> 24 {
            0..50 => [0, 0],
            50..120 => [key(a), 0],
            _ => [key(a.min(b)), key(a.max(b))],
        }
    };
    (0..size * size).map(&mut texel).collect()
}

#[gpu_test]
fn empty() {
    check(gpu(), 20, &[[0; 2]; 400]);
    assert!(settle(gpu(), 20, DepthRule::Dual(0.5), vec![[0; 2]; 400]).made.iter().all(|&key| key == 0));
}

#[gpu_test]
fn one() {
    let of = |rule, keys| settle(gpu(), 1, rule, vec![keys]).made[0];
    let both = [key(0.25), key(0.75)];
    assert_eq!(of(DepthRule::Midpoint, both), key(0.5));
    assert_eq!(of(DepthRule::Second, both), key(0.75));
    assert_eq!(of(DepthRule::Dual(0.125), both), key(0.375));
    assert_eq!(of(DepthRule::Dual(0.5), both), key(0.5));
    let alone = [key(0.25), 0];
    assert_eq!([of(DepthRule::Midpoint, alone), of(DepthRule::Second, alone)], [0; 2]);
    assert_eq!(of(DepthRule::Dual(0.125), alone), key(0.375));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(1);
    for size in sizes_around(8).into_iter().chain(sizes_around(16)) {
        check(gpu(), size as u32, &keys(size as u32, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(2);
    for size in [33, 100, 257] {
        check(gpu(), size, &keys(size, &mut random));
    }
}

/// Depths at both ends of what a map may hold, next to each other, and the same twice.
#[gpu_test]
fn degenerate() {
    let next = f32::from_bits(1.0f32.to_bits() + 1);
    let ends = [0.0, f32::MIN_POSITIVE, 1e-6, 1.0, next, 1e30];
    let pairs = ends.iter().enumerate().flat_map(|(k, &a)| ends[k..].iter().map(move |&b| [key(a), key(b)]));
    let mut given: Vec<[u32; 2]> = pairs.collect();
    given.resize(25, [0; 2]);
    check(gpu(), 5, &given);
}

#[gpu_test]
fn beyond_one_dimension() {
    let mut random = Random::new(4);
    check(&crate::support::small_gpu(100, 1 << 26), 200, &keys(200, &mut random));
}

#[gpu_test]
fn two_d_dispatch() {
    let given = keys(24, &mut Random::new(5));
    let of = |gpu| settle(gpu, 24, DepthRule::Midpoint, given.clone()).made;
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let given = keys(45, &mut Random::new(6));
    for rule in RULES {
        let of = || settle(gpu(), 45, rule, given.clone());
        assert!(fault(&of()).is_none() && of().made == of().made, "{rule:?}");
        let with_both = given.iter().position(|keys| keys[1] != 0).expect("a texel of two depths");
        let spoilt = |spoil: &dyn Fn(&mut Ran)| {
            let mut off = of();
            spoil(&mut off);
            fault(&off).is_some()
        };
        assert!(spoilt(&|r| r.made[with_both] ^= 8), "{rule:?}");
        assert!(spoilt(&|r| r.made[with_both] = 0));
        assert!(spoilt(&|r| r.made.truncate(7)));
        let other = RULES.into_iter().find(|other| *other != rule).expect("another rule");
        assert!(spoilt(&|r| r.rule = other), "{rule:?} passes for {other:?}");
    }
}
