//! Owners of work items against their definition: the table itself, and what kernels find with it and without.

use crate::support::shadow::with_total;
use crate::support::{NO_TABLE, POISON, Random, assert_same, difference, gpu, run, sizes_around, small_gpu, upload};
use oracle::reference::cluster_culling::list as cluster_list;
use oracle::reference::work_owners::{owners as owners_of, table};
use std::sync::OnceLock;
use subpixel_shadows::entry_point;
use subpixel_shadows::gpu::bindings::{Read, Write};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, Recorder, Source};
use subpixel_shadows::stages::WorkOwners;
use subpixel_shadows::stages::cluster_culling::{CLUSTER, ClusterList, ClusterPart};
use subpixel_shadows::stages::work_owners::STRIDE;
use test_support::gpu_test;

/// Writes the owner of every item.
const FIND: &str = concat!(
    include_str!("../../kernels/shared/frame/dispatch.wgsl"),
    include_str!("../../kernels/shared/raster/work_items.wgsl"),
    "@group(0) @binding(0) var<storage, read> work_offsets: array<u32>;
        @group(0) @binding(1) var<storage, read_write> found: array<u32>;
        @group(0) @binding(2) var<storage, read> owners: array<u32>;
        @compute @workgroup_size(64)
        fn find(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) local: u32) {
            let item = flat_invocation(group, groups, 64u, local);
            if item < work_offsets[owners[0]] { found[item] = owner_in(slot_of(item, owners[0]), owners[0]); }
        }"
);

entry_point! { "find", "find", [64, 1, 1], Source(&[FIND]), () => Find, FindProgram {
    0 work_offsets: Read<'a, u32>,
    1 found: Write<'a, u32>,
    2 owners: Read<'a, u32>,
} }

fn stage() -> &'static WorkOwners {
    static STAGE: OnceLock<WorkOwners> = OnceLock::new();
    STAGE.get_or_init(|| WorkOwners::new(&gpu().device))
}

/// Words before the table, behind those of the owners.
const HEAD: usize = 5;

/// The scan of `counts`, with poisoned words for the head of the table and `room` for its places.
fn offsets(gpu: &Gpu, counts: &[u32], room: usize) -> Buffer<u32> {
    let mut words = with_total(counts);
    words.resize(counts.len() + HEAD + room, POISON);
    upload(gpu, &words)
}

/// The table that the stage makes in `offsets`.
fn made(gpu: &Gpu, stage: &WorkOwners, offsets: &Buffer<u32>, owners: usize) -> Vec<u32> {
    run(gpu, |s| stage.record(s, offsets, owners));
    let words = offsets.read(gpu).expect("readback");
    let table = &words[owners + HEAD..];
    let places = words[owners + HEAD - 1] as usize;
    assert_eq!(words[owners + 2..owners + HEAD - 1], [0; 2], "no list of clusters");
    assert!(table[places..].iter().all(|&w| w == POISON), "written beyond the table");
    table[..places].to_vec()
}

/// What kernels find for `items` items.
fn found(gpu: &Gpu, offsets: &Buffer<u32>, owners: usize, items: usize) -> Vec<u32> {
    let program = FindProgram::new(&gpu.device, ());
    let (found, owners) = (upload(gpu, &vec![POISON; items.max(1)]), upload(gpu, &[owners as u32]));
    let bindings = Find { work_offsets: offsets.as_read(), found: found.as_write(), owners: owners.as_read() };
    run(gpu, |s| s.run(&program, bindings, Groups::Items(items as u64)));
    let mut found = found.read(gpu).expect("readback");
    found.truncate(items);
    found
}

/// Compares the table, and the owners found with all of it, a part of it, and none.
#[track_caller]
fn check(gpu: &Gpu, stage: &WorkOwners, counts: &[u32]) -> usize {
    let want = owners_of(counts);
    let whole = table(counts, STRIDE as usize, usize::MAX).len();
    // Four rooms in a row: the buffer's padding, up to three words, is no room.
    for room in [whole + 5, whole, whole / 2 + 1, whole / 2 + 2, whole / 2 + 3, whole / 2] {
        let offsets = offsets(gpu, counts, room);
        let room = offsets.len() - counts.len() - HEAD;
        let what = format!("{} items, room for {room}", want.len());
        assert_same(&what, &made(gpu, stage, &offsets, counts.len()), &table(counts, STRIDE as usize, room));
        assert_same(&what, &found(gpu, &offsets, counts.len(), want.len()), &want);
    }
    // Where the stage did not run.
    let words = [with_total(counts), NO_TABLE.to_vec()].concat();
    assert_same("no table", &found(gpu, &upload(gpu, &words), counts.len(), want.len()), &want);
    want.len()
}

#[gpu_test]
fn empty() {
    assert_eq!(check(gpu(), stage(), &[]), 0);
    assert_eq!(check(gpu(), stage(), &[0; 100]), 0);
}

#[gpu_test]
fn one() {
    for count in [1, 7, 8, 9, 500] {
        assert_eq!(check(gpu(), stage(), &[count]), count as usize);
        check(gpu(), stage(), &[0, 0, count, 0]);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in sizes_around(64) {
        check(gpu(), stage(), &vec![1; size]);
        check(gpu(), stage(), &vec![8; size]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(191);
    let mut items = 0;
    for round in 0..40 {
        let most = [1, 2, 3, 20, 300][round % 5];
        // Many owners of none in a row, as among facets.
        let count = |random: &mut Random| if random.below(4) > round as u32 % 4 { 0 } else { random.below(most + 1) };
        let len = random.below(2000) as usize;
        let counts: Vec<u32> = (0..len).map(|_| count(&mut random)).collect();
        items += check(gpu(), stage(), &counts);
    }
    assert!(items > 20_000, "{items}");
}

#[gpu_test]
fn degenerate() {
    // One owner of almost all, first, last or between; owners of none at both ends.
    let (many, ones) = (100_000, vec![1; 70]);
    check(gpu(), stage(), &[vec![many], ones.clone()].concat());
    check(gpu(), stage(), &[ones.clone(), vec![many]].concat());
    check(gpu(), stage(), &[vec![0; 3000], ones.clone(), vec![many], ones, vec![0; 3000]].concat());
}

/// Of owners some clusters of which are kept their slots are found, and from these their numbers, whatever lies beyond.
#[gpu_test]
fn owners_of_kept_clusters() {
    let mut random = Random::new(194);
    for round in 0..30 {
        let owners = 1 + random.below([60, 700, 5000][round % 3]) as usize;
        let kept: Vec<bool> = (0..owners.div_ceil(CLUSTER)).map(|_| random.below(3) == 0).collect();
        let part = [ClusterPart::Triangles, ClusterPart::Edges][round % 2];
        let elements = if round % 2 == 0 { [owners, 0, 0] } else { [0, owners, 0] };
        let kept_of = |of: usize| if part as usize == of { kept.as_slice() } else { &[] };
        let list = ClusterList::new(&gpu().device, &gpu().queue, elements).expect("memory");
        list.kept.write(&gpu().queue, &cluster_list([kept_of(0), kept_of(1), &[]], elements));
        let numbers: Vec<u32> = (0..owners as u32).filter(|&n| kept[n as usize / CLUSTER]).collect();
        let counts = random.list(numbers.len(), [2, 5, 40][round % 3]);
        let want: Vec<u32> = owners_of(&counts).iter().map(|&slot| numbers[slot as usize]).collect();
        let whole = table(&counts, STRIDE as usize, usize::MAX).len();
        for room in [whole + 3, whole, whole / 2, 0] {
            // Beyond the slots that are in use anything may stand.
            let scan = with_total(&counts);
            let mut words = vec![POISON; owners + HEAD + room + kept.len()];
            words[..counts.len()].copy_from_slice(&scan[..counts.len()]);
            words[owners..owners + 2].copy_from_slice(&scan[counts.len()..]);
            let offsets = upload(gpu(), &words);
            run(gpu(), |s| stage().record(s, &offsets, list.elements(part, owners)));
            assert_same("numbers", &found(gpu(), &offsets, owners, want.len()), &want);
        }
        assert!(round > 5 || want.is_empty() || difference(&want, &owners_of(&counts)).is_some());
    }
}

#[gpu_test]
fn overflow_by_one() {
    // Rooms around the length of the table are in `check`; no room at all, and a buffer that does not hold the scan.
    let counts = vec![3; 129];
    let offsets = upload(gpu(), &[with_total(&counts), vec![POISON; 3]].concat());
    assert!(made(gpu(), stage(), &offsets, 129).is_empty());
    assert_same("no room", &found(gpu(), &offsets, 129, 387), &owners_of(&counts));
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(&gpu().device, &mut encoder, None);
    assert!(stage().record(&mut recorder.stage("test"), &offsets, 129).is_ok());
    assert!(stage().record(&mut recorder.stage("test"), &offsets, 130).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(10, 1 << 22);
    let stage = WorkOwners::new(&small.device);
    let mut random = Random::new(192);
    let counts = random.list(2000, 7);
    assert!(check(&small, &stage, &counts) > 8 * 64 * 10, "more workgroups than fit along a dimension");
}

#[gpu_test]
fn detects_corruption() {
    let counts = Random::new(193).list(300, 5);
    let want = owners_of(&counts);
    let offsets = offsets(gpu(), &counts, 1000);
    let table = made(gpu(), stage(), &offsets, 300);
    assert_eq!(difference(&found(gpu(), &offsets, 300, want.len()), &want), None);
    // A place of the table that names another owner is seen in what is found.
    let mut words = offsets.read(gpu()).expect("readback");
    words[300 + HEAD + table.len() / 2] = 0;
    offsets.write(&gpu().queue, &words);
    assert!(difference(&found(gpu(), &offsets, 300, want.len()), &want).is_some());
}
