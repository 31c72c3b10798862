//! Grouping by key against its definition. Groups are compared as sets.

use crate::support::{
    POISON, Random, assert_same, gpu, padded, poisoned, read_padded, run, sizes_around, small_gpu, upload,
};
use oracle::reference::texel_group::{Grouped, canonical, group};
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::texel_group::Grouping;
use subpixel_shadows::stages::{Count, PrefixScan, TexelGroup};
use test_support::gpu_test;

fn stage(gpu: &Gpu) -> TexelGroup {
    TexelGroup::new(&gpu.device, &PrefixScan::new(&gpu.device))
}

/// Offsets, the whole buffer of grouped values (padding included), and the total, on the GPU.
struct Got {
    offsets: Vec<u32>,
    grouped: Vec<u32>,
    total: Vec<u32>,
}

fn grouped(
    gpu: &Gpu,
    stage: &TexelGroup,
    keys: &[u32],
    values: Option<&[u32]>,
    (groups, room, count): (usize, usize, Option<usize>),
) -> Got {
    let (input, values) = (upload(gpu, keys), values.map(|v| upload(gpu, v)));
    let (offsets, out, total) = (poisoned(gpu, groups + 2), poisoned(gpu, room), poisoned(gpu, 4));
    let counts = upload(gpu, &[count.unwrap_or(0) as u32]);
    let count = count.map_or(Count::Exactly(keys.len()), |_| Count::At(&counts, 0));
    let scratch = TexelGroup::scratch(&gpu.device, keys.len(), groups).expect("scratch");
    let to = Grouping { offsets: &offsets, grouped: &out, total: (&total, 1) };
    // Twice with the same scratch: counters must be cleared.
    run(gpu, |s| stage.record(s, &input, values.as_ref(), to, &scratch, count));
    run(gpu, |s| stage.record(s, &input, values.as_ref(), to, &scratch, count));
    let read = |buffer: &subpixel_shadows::gpu::Buffer<u32>| buffer.read(gpu).expect("readback");
    Got { offsets: read(&offsets), grouped: read_padded(gpu, &out), total: read(&total) }
}

/// Compares with the definition where there is ample room.
#[track_caller]
fn check(gpu: &Gpu, stage: &TexelGroup, keys: &[u32], groups: usize, count: Option<usize>) {
    let live = &keys[..count.unwrap_or(usize::MAX).min(keys.len())];
    let indices: Vec<u32> = (0..keys.len() as u32).collect();
    let values: Vec<u32> = indices.iter().map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
    for given in [Some(&values[..]), None] {
        let what = format!("{} keys below {groups}, count {count:?}, values {}", keys.len(), given.is_some());
        let want = group(live, given.unwrap_or(&indices), groups);
        let needed = want.grouped.len();
        let mut got = grouped(gpu, stage, keys, given, (groups, keys.len() + 1, count));
        assert_eq!(got.offsets.pop(), Some(POISON), "{what}: wrote past the offsets");
        assert_same(&what, &got.total, &[POISON, needed as u32, 0, POISON]);
        assert_same(&what, &got.offsets, &want.offsets);
        assert_same(&what, &got.grouped[needed..], &vec![POISON; padded(keys.len() + 1) - needed]);
        let got = canonical(&got.offsets, &got.grouped[..needed]).expect("offsets that rise");
        assert_same(&what, &got.grouped, &want.grouped);
    }
}

#[gpu_test]
fn empty() {
    let stage = stage(gpu());
    check(gpu(), &stage, &[], 5, None);
    check(gpu(), &stage, &[], 0, None);
    check(gpu(), &stage, &[0, 1, 2], 0, None);
    check(gpu(), &stage, &[0, 1, 2], 3, Some(0));
}

#[gpu_test]
fn one() {
    let stage = stage(gpu());
    for key in [0, 1, 2, 3, u32::MAX] {
        check(gpu(), &stage, &[key], 3, None);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let stage = stage(gpu());
    let keys = Random::new(41).list(4097, 40);
    for size in sizes_around(64) {
        check(gpu(), &stage, &keys[..size], 40, None);
        check(gpu(), &stage, &keys, size, None);
    }
    for groups in sizes_around(1024) {
        check(gpu(), &stage, &keys[..300], groups, None);
    }
}

#[gpu_test]
fn random_seeded() {
    let stage = stage(gpu());
    let mut random = Random::new(42);
    for _ in 0..12 {
        let (len, groups) = (1 + random.below(20_000) as usize, 1 + random.below(20_000));
        let keys = random.list(len, groups + groups / 4);
        check(gpu(), &stage, &keys, groups as usize, None);
        check(gpu(), &stage, &keys, groups as usize, Some(random.below(len as u32) as usize));
    }
    check(gpu(), &stage, &random.list(1 << 20, 1 << 18), 1 << 18, None);
}

#[gpu_test]
fn degenerate() {
    let stage = stage(gpu());
    // All in one group (the 65,535 loop steps of some software adapters must not matter), none in any.
    for key in [0, 7, 8, u32::MAX] {
        check(gpu(), &stage, &vec![key; 200_000], 8, None);
    }
    let keys = Random::new(43).list(999, 9);
    for count in [1, 998, 999, 1000, u32::MAX as usize] {
        check(gpu(), &stage, &keys, 9, Some(count));
    }
}

#[gpu_test]
fn overflow_by_one() {
    let stage = stage(gpu());
    let keys = Random::new(44).list(1000, 12);
    let want = group(&keys, &(0..1000).collect::<Vec<_>>(), 10);
    let needed = want.grouped.len();
    for room in [0, 1, 2, needed - 1, needed, needed + 1] {
        let got = grouped(gpu(), &stage, &keys, None, (10, room, None));
        assert_same("the total keeps counting", &got.total[1..3], &[needed as u32, 0]);
        assert_same("offsets", &got.offsets[..11], &want.offsets);
        // What is there is right: groups below the capacity whole, the last one a part of its set.
        let room = room.min(needed);
        for (k, set) in want.offsets.windows(2).map(|w| &want.grouped[w[0] as usize..w[1] as usize]).enumerate() {
            let (begin, end) = (want.offsets[k] as usize, want.offsets[k + 1] as usize);
            let mut found = got.grouped[begin.min(room)..end.min(room)].to_vec();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), end.min(room) - begin.min(room), "room {room}, group {k}: a value came twice");
            assert!(found.iter().all(|v| set.binary_search(v).is_ok()), "room {room}, group {k}: a foreign value");
        }
        assert!(got.grouped[room..].iter().all(|&v| v == POISON), "wrote past {needed} values");
    }
    let scratch = TexelGroup::scratch(&gpu().device, 10, 5).expect("scratch");
    let [list, short, total] = [10, 5, 2].map(|len| poisoned(gpu(), len));
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(&gpu().device, &mut encoder, None);
    let mut s = recorder.stage("test");
    let to = Grouping { offsets: &short, grouped: &list, total: (&total, 0) };
    assert!(stage.record(&mut s, &list, None, to, &scratch, Count::Exactly(10)).is_err(), "5 offsets for 5 groups");
    let to = Grouping { offsets: &list, grouped: &total, total: (&total, 0) };
    assert!(stage.record(&mut s, &list, None, to, &scratch, Count::Exactly(11)).is_err());
    assert!(stage.record(&mut s, &short, None, to, &scratch, Count::Exactly(10)).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    let gpu = small_gpu(3, 1 << 20);
    let stage = stage(&gpu);
    let keys = Random::new(45).list(9 * 64, 9 * 1024);
    for size in [3 * 64, 3 * 64 + 1, 9 * 64] {
        check(&gpu, &stage, &keys[..size], size * 16 - 1, None);
    }
}

#[gpu_test]
fn detects_corruption() {
    let keys = Random::new(46).list(500, 20);
    let want = group(&keys, &(0..500).collect::<Vec<_>>(), 20);
    let mut got = grouped(gpu(), &stage(gpu()), &keys, None, (20, 500, None));
    got.offsets.pop();
    assert_eq!(canonical(&got.offsets, &got.grouped), Some(want.clone()));
    // Swapping inside a group is no error; swapping across groups, or an offset that is off by one, is.
    let border = want.offsets[1] as usize;
    let mut inside = got.grouped.clone();
    inside.swap(0, 1);
    assert_eq!(canonical(&got.offsets, &inside), Some(want.clone()));
    got.grouped.swap(border - 1, border);
    assert_ne!(canonical(&got.offsets, &got.grouped), Some(want.clone()));
    got.grouped.swap(border - 1, border);
    got.offsets[1] += 1;
    assert_ne!(canonical(&got.offsets, &got.grouped), Some(want));
    assert_eq!(canonical(&[1, 2], &[5, 6]), None::<Grouped>);
}
