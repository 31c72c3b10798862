//! Mean and variance of squares of texels, cell by cell against `f64` over the texels themselves.

use crate::support::shadow::folding_gpu;
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::map_moments::moments;
use oracle::reference::moment_shadows::{Measure, Wave};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::map_moments::{MapLevels, MapMoments, MomentMeasures};
use test_support::gpu_test;

const FAR: f32 = 2.25;

struct Ran {
    size: u32,
    measures: MomentMeasures,
    keys: Vec<u32>,
    moments: Vec<[f32; 2]>,
}

/// The moments of the depths of `keys`, of a map of `size` texels a side.
fn reduce(gpu: &Gpu, size: u32, keys: Vec<u32>) -> Ran {
    reduce_of(gpu, size, keys, MomentMeasures::Depths)
}

fn reduce_of(gpu: &Gpu, size: u32, keys: Vec<u32>, measures: MomentMeasures) -> Ran {
    let frame = Buffer::uniform(&gpu.device, "test.frame", 1).expect("memory");
    frame.write(&gpu.queue, &[Frame { map_size: size, ..Frame::default() }]);
    let levels = Buffer::uniform(&gpu.device, "test.levels", 1).expect("memory");
    levels.write(&gpu.queue, &[MapLevels::new(size, f64::from(FAR))]);
    let texels = Buffer::from_slice(&gpu.device, &gpu.queue, "test.keys", &keys).expect("memory");
    let stage = MapMoments::new(&gpu.device, measures);
    let made = stage.memory(&gpu.device, size).expect("memory");
    made.write(&gpu.queue, &vec![[f32::from_bits(POISON); 2]; made.len()]);
    crate::support::run(gpu, |s| stage.record(s, &frame, &levels, &texels, &made, size));
    Ran { size, measures, keys, moments: made.read(gpu).expect("readback") }
}

/// Where the stage departs from its definition.
fn fault(ran: &Ran) -> Option<String> {
    let Ran { size, measures, keys, moments: made } = ran;
    let mut got = made.iter();
    let depth = |&key: &u32| f64::from(if key == 0 { FAR } else { f32::from_bits(!key) });
    if let MomentMeasures::Waves(terms) = *measures {
        return fault_of_waves(ran, terms);
    }
    let exponents = match *measures {
        MomentMeasures::Depths | MomentMeasures::Four => vec![(0.0, None)],
        MomentMeasures::Rising(c) => vec![(c, None)],
        MomentMeasures::Both(c) => vec![(c, None), (-c, None)],
        MomentMeasures::Layers(count) => (0..count).map(|k| (0.0, Some([k, count]))).collect(),
        MomentMeasures::Waves(_) => Vec::new(),
    };
    let four = *measures == MomentMeasures::Four;
    let mut high = made[if four { MapLevels::moments_of(*size) } else { 0 }..].iter();
    for (exponent, layer) in exponents {
        let exponent = f64::from(exponent);
        let measure = Measure { far: f64::from(FAR), exponent, layer, wave: None };
        let values: Vec<f64> = keys.iter().map(|key| measure.of(depth(key))).collect();
        // Of the exponentials a driver may be wrong in the last places of e to the forty-second.
        let share = if exponent == 0.0 { 1e-5 } else { 3e-4 };
        for level in 1..=MapLevels::count_of(*size) {
            for (cell, [mean, variance, third, fourth]) in moments(&values, *size, level).into_iter().enumerate() {
                let Some(&[m, v]) = got.next() else { return Some("too few cells".to_owned()) };
                let mean_off = if exponent == 0.0 { 2e-6 } else { share * mean.abs() };
                // Rounding gives values that are all alike a variance.
                let noise = if exponent == 0.0 { 1e-9 } else { (1e-5 * mean).powi(2) };
                let right = (f64::from(m) - mean).abs() <= mean_off
                    && (f64::from(v) - variance).abs() <= noise + 2.0 * share * variance;
                if !right {
                    let of = format!("exponent {exponent}, level {level}, cell {cell}");
                    return Some(format!("{of}: {m} {v}, {mean} {variance} expected"));
                }
                if !four {
                    continue;
                }
                let Some([t, f]) = high.next().map(|m| m.map(f64::from)) else {
                    return Some("too few high".to_owned());
                };
                let scale = variance.sqrt();
                if (t - third).abs() > 1e-5 * scale.powi(3) + 1e-12 || (f - fourth).abs() > 1e-5 * fourth + 1e-14 {
                    return Some(format!("level {level}, cell {cell}: {t} {f}, {third} {fourth} expected"));
                }
            }
        }
    }
    let more = if four { high.next() } else { got.next() };
    more.map(|_| "too many cells".to_owned())
}

/// Of waves every set holds two means.
fn fault_of_waves(ran: &Ran, terms: u32) -> Option<String> {
    let Ran { size, keys, moments: made, .. } = ran;
    let depth = |&key: &u32| f64::from(if key == 0 { FAR } else { f32::from_bits(!key) });
    let mut got = made.iter();
    for term in 0..terms {
        let [sines, cosines] = [Wave::Sine(term), Wave::Cosine(term)].map(|wave| {
            let measure = Measure { far: f64::from(FAR), exponent: 0.0, layer: None, wave: Some(wave) };
            keys.iter().map(|key| measure.of(depth(key))).collect::<Vec<f64>>()
        });
        for level in 1..=MapLevels::count_of(*size) {
            let cells = moments(&sines, *size, level).into_iter().zip(moments(&cosines, *size, level));
            for (cell, (sine, cosine)) in cells.enumerate() {
                let Some(&[s, c]) = got.next() else { return Some("too few cells".to_owned()) };
                if (f64::from(s) - sine[0]).abs() > 2e-5 || (f64::from(c) - cosine[0]).abs() > 2e-5 {
                    return Some(format!(
                        "term {term}, level {level}, cell {cell}: {s} {c}, {} {}",
                        sine[0], cosine[0]
                    ));
                }
            }
        }
    }
    got.next().map(|_| "too many cells".to_owned())
}

#[track_caller]
fn check(size: u32, keys: Vec<u32>) -> Ran {
    let ran = reduce(gpu(), size, keys);
    if let Some(text) = fault(&ran) {
        panic!("a map of {size}: {text}");
    }
    ran
}

/// Depths that change from texel to texel, a fifth of them missing.
fn keys(size: u32, random: &mut Random) -> Vec<u32> {
    let key = |_| if random.below(5) == 0 { 0 } else { !(random.below(1 << 20) as f32 / (1 << 20) as f32).to_bits() };
    (0..size * size).map(key).collect()
}

#[gpu_test]
fn empty() {
    let ran = check(20, vec![0; 400]);
    assert!(ran.moments.iter().all(|m| *m == [FAR, 0.0]));
}

#[gpu_test]
fn one() {
    // A map of one texel has no level above it.
    assert!(check(1, vec![!0.5f32.to_bits()]).moments.is_empty());
    assert_eq!(check(2, [0.0f32, 0.5, 0.5, 1.0].map(|d| !d.to_bits()).to_vec()).moments, [[0.5, 0.125]]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(1);
    for size in sizes_around(32).into_iter().chain(sizes_around(16)) {
        check(size as u32, keys(size as u32, &mut random));
    }
}

/// Sizes that take two and three dispatches.
#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(2);
    for size in [100, 257, 511, 1023, 1025, 1100] {
        check(size, keys(size, &mut random));
    }
}

/// Exponentials of the depths, one and both, as steep as may be, and four moments.
#[gpu_test]
fn other_measures() {
    let mut random = Random::new(7);
    for measures in [
        MomentMeasures::Rising(40.0),
        MomentMeasures::Rising(1.0),
        MomentMeasures::Both(10.0),
        MomentMeasures::Both(MomentMeasures::STEEPEST),
        MomentMeasures::Four,
        MomentMeasures::Layers(2),
        MomentMeasures::Layers(7),
        MomentMeasures::Waves(1),
        MomentMeasures::Waves(16),
    ] {
        for size in [1, 2, 45, 64, 257] {
            let ran = reduce_of(gpu(), size, keys(size, &mut random), measures);
            if let Some(text) = fault(&ran) {
                panic!("{measures:?}, a map of {size}: {text}");
            }
            assert_eq!(
                ran.moments.len(),
                reduce_of(gpu(), size, vec![0; (size * size) as usize], measures).moments.len()
            );
        }
    }
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut ran = reduce_of(gpu(), 45, keys(45, &mut Random::new(8)), MomentMeasures::Both(10.0));
        spoil(&mut ran);
        fault(&ran).is_some()
    };
    assert!(!spoilt(&|_| {}));
    assert!(spoilt(&|r| r.measures = MomentMeasures::Both(10.1)));
    assert!(spoilt(&|r| r.measures = MomentMeasures::Rising(10.0)));
    let layers = |spoil: &dyn Fn(&mut Ran)| {
        let mut ran = reduce_of(gpu(), 45, keys(45, &mut Random::new(8)), MomentMeasures::Layers(4));
        spoil(&mut ran);
        fault(&ran).is_some()
    };
    assert!(!layers(&|_| {}) && layers(&|r| r.measures = MomentMeasures::Layers(3)));
    let waves = |spoil: &dyn Fn(&mut Ran)| {
        let mut ran = reduce_of(gpu(), 45, keys(45, &mut Random::new(8)), MomentMeasures::Waves(4));
        spoil(&mut ran);
        fault(&ran).is_some()
    };
    assert!(!waves(&|_| {}) && waves(&|r| r.measures = MomentMeasures::Waves(3)));
    let second = MapLevels::moments_of(45);
    assert!(waves(&|r| r.moments[second + 3][0] += 1e-3) && waves(&|r| r.moments[3 * second + 3][1] -= 1e-3));
    assert!(layers(&|r| r.moments[2 * second + 3][0] += 1e-2));
    assert!(spoilt(&|r| r.moments[second + 3][0] *= 1.002) && spoilt(&|r| r.moments[second + 3][1] *= 1.01));
    let four = |spoil: &dyn Fn(&mut Ran)| {
        let mut ran = reduce_of(gpu(), 45, keys(45, &mut Random::new(9)), MomentMeasures::Four);
        spoil(&mut ran);
        fault(&ran).is_some()
    };
    assert!(!four(&|_| {}) && four(&|r| r.moments[3][1] *= 1.01));
    assert!(four(&|r| r.moments[second + 9][0] += 1e-3) && four(&|r| r.moments[second + 9][1] *= 1.001));
}

/// Depths that differ by little, far from 0, where two moments would cancel.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(3);
    let near = |_| !(0.9f32 + random.below(256) as f32 * 2f32.powi(-22)).to_bits();
    let ran = check(64, (0..64 * 64).map(near).collect());
    let last = ran.moments.last().expect("a cell")[1];
    let spread = (256.0 * 2f32.powi(-22)).powi(2) / 12.0;
    assert!((last / spread - 1.0).abs() < 0.1, "variance {last} of {spread}");
    check(33, vec![!1.0f32.to_bits(); 33 * 33]);
}

/// More than 65,535 workgroups could hold in one dimension of single invocations; the stage has no list.
#[gpu_test]
fn beyond_one_dimension() {
    let ran = check(500, keys(500, &mut Random::new(4)));
    assert!(ran.moments.iter().flatten().all(|v| v.to_bits() != POISON) && ran.moments.len() > 65_535);
}

#[gpu_test]
fn two_d_dispatch() {
    let keys = keys(60, &mut Random::new(5));
    let of = |gpu| reduce(gpu, 60, keys.clone()).moments;
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let made = keys(45, &mut Random::new(6));
    let of = || reduce(gpu(), 45, made.clone());
    let ran = check(45, made.clone());
    assert!(ran.moments == of().moments, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = of();
        spoil(&mut off);
        fault(&off).is_some()
    };
    let last = ran.moments.len() - 1;
    assert!(spoilt(&|r| r.moments[last][0] += 1e-4));
    assert!(spoilt(&|r| r.moments[7][1] *= 1.001));
    assert!(spoilt(&|r| r.moments.swap(3, 4)));
    assert!(spoilt(&|r| r.moments.truncate(last)));
    assert!(spoilt(&|r| r.keys[9] = !r.keys[9]));
}
