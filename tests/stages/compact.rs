//! Stream compaction against its definition.

use crate::support::{
    POISON, Random, assert_same, difference, gpu, padded, poisoned, read_padded, run, sizes_around, small_gpu, upload,
};
use oracle::reference::compact;
use oracle::reference::summed_area::pack;
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::compact::Flags;
use subpixel_shadows::stages::{Compact, Count, PrefixScan};
use test_support::gpu_test;

fn stage(gpu: &Gpu) -> Compact {
    Compact::new(&gpu.device, &PrefixScan::new(&gpu.device))
}

/// One case: the items, how many of them count, and how many of those kept there is room for.
struct Case<'a> {
    flags: &'a [u32],
    values: Option<&'a [u32]>,
    count: Option<usize>,
    room: usize,
    packed: bool,
}

/// The kept list (all of its buffer, padding included) and the total on the GPU.
fn kept(gpu: &Gpu, stage: &Compact, case: &Case) -> Vec<u32> {
    let words = if case.packed { pack(case.flags, case.flags.len()) } else { case.flags.to_vec() };
    let (flags, values) = (upload(gpu, &words), case.values.map(|v| upload(gpu, v)));
    let (kept, total) = (poisoned(gpu, case.room), poisoned(gpu, 3));
    let counts = upload(gpu, &[case.count.unwrap_or(0) as u32]);
    let count = case.count.map_or(Count::Exactly(case.flags.len()), |_| Count::At(&counts, 0));
    let flags = if case.packed { Flags::Bits(&flags) } else { Flags::Words(&flags) };
    let scratch = Compact::scratch(&gpu.device, case.flags.len()).expect("scratch");
    run(gpu, |s| stage.record(s, flags, values.as_ref(), &kept, (&total, 1), &scratch, count));
    let mut got = read_padded(gpu, &kept);
    got.extend(total.read(gpu).expect("readback"));
    got
}

/// What `kept` must give.
fn wanted(case: &Case) -> Vec<u32> {
    let flags = &case.flags[..case.count.unwrap_or(usize::MAX).min(case.flags.len())];
    let mut want = case.values.map_or_else(|| compact::indices(flags), |values| compact::compact(values, flags));
    let needed = want.len() as u32;
    want.truncate(case.room);
    want.resize(padded(case.room), POISON);
    want.extend([POISON, needed, 0]);
    want
}

/// Both forms of flags, values and indices.
#[track_caller]
fn check(gpu: &Gpu, stage: &Compact, flags: &[u32], values: &[u32], count: Option<usize>, room: usize) {
    for (values, packed) in [(None, false), (Some(values), true), (Some(values), false), (None, true)] {
        let case = Case { flags, values, count, room, packed };
        let what = format!("{} flags, packed {packed}, count {count:?}, room {room}", flags.len());
        assert_same(&what, &kept(gpu, stage, &case), &wanted(&case));
    }
}

#[gpu_test]
fn empty() {
    check(gpu(), &stage(gpu()), &[], &[], None, 3);
    check(gpu(), &stage(gpu()), &[1; 40], &[5; 40], Some(0), 3);
}

#[gpu_test]
fn one() {
    let stage = stage(gpu());
    for flag in [0, 1, u32::MAX] {
        check(gpu(), &stage, &[flag], &[7], None, 1);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stage = stage(gpu());
    let mut random = Random::new(21);
    let (flags, values) = (random.list(3 * 2048 + 1, 2), random.words(3 * 2048 + 1));
    for size in [sizes_around(32), sizes_around(64), sizes_around(2048)].concat() {
        check(gpu(), &stage, &flags[..size], &values[..size], None, size);
    }
}

#[gpu_test]
fn random_seeded() {
    let stage = stage(gpu());
    let mut random = Random::new(22);
    for share in [2, 3, 50, 1000] {
        let len = random.below(60_000) as usize;
        let flags: Vec<u32> = random.list(len, share).iter().map(|&v| if v == 1 { v << 31 } else { 0 }).collect();
        let values = random.words(len);
        check(gpu(), &stage, &flags, &values, None, len);
        check(gpu(), &stage, &flags, &values, Some(random.below(len as u32) as usize), len);
    }
    let (flags, values) = (random.list((1 << 20) + 3, 2), random.words((1 << 20) + 3));
    for _ in 0..2 {
        check(gpu(), &stage, &flags, &values, None, 1 << 20);
    }
}

#[gpu_test]
fn degenerate() {
    let stage = stage(gpu());
    let values = Random::new(23).words(5000);
    for fill in [0, 1, u32::MAX] {
        check(gpu(), &stage, &[fill; 5000], &values, None, 5000);
        for count in [1, 31, 32, 33, 4999, 5000, 1 << 31, u32::MAX as usize] {
            check(gpu(), &stage, &[fill; 5000], &values, Some(count), 5000);
        }
    }
}

#[gpu_test]
fn overflow_by_one() {
    let stage = stage(gpu());
    let mut random = Random::new(24);
    let (flags, values) = (random.list(3000, 2), random.words(3000));
    let needed = compact::indices(&flags).len();
    for room in [0, 1, needed - 1, needed, needed + 1] {
        check(gpu(), &stage, &flags, &values, None, room);
    }
    let (list, total) = (poisoned(gpu(), 9), poisoned(gpu(), 2));
    let scratch = Compact::scratch(&gpu().device, 10).expect("scratch");
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(&gpu().device, &mut encoder, None);
    let mut s = recorder.stage("test");
    let mut short = |count| stage.record(&mut s, Flags::Words(&list), None, &total, (&total, 0), &scratch, count);
    assert!(short(Count::Exactly(10)).is_err());
    assert!(short(Count::Exactly(11)).is_err());
    assert!(short(Count::At(&list, 9)).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    let gpu = small_gpu(3, 1 << 20);
    let mut random = Random::new(25);
    for len in [3 * 2048, 3 * 2048 + 1, 9 * 2048 - 31] {
        let (flags, values) = (random.list(len, 2), random.words(len));
        check(&gpu, &stage(&gpu), &flags, &values, None, len);
    }
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(26);
    let (flags, values) = (random.list(500, 2), random.words(500));
    let case = Case { flags: &flags, values: Some(&values), count: None, room: 500, packed: false };
    let (mut got, want) = (kept(gpu(), &stage(gpu()), &case), wanted(&case));
    assert_eq!(difference(&got, &want), None);
    got.swap(0, 1);
    assert!(difference(&got, &want).is_some(), "order counts");
}
