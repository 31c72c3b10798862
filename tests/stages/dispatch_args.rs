//! Indirect arguments against their definition, and by running what they say.

use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::dispatch_args::{MAX_GROUPS, fold};
use subpixel_shadows::entry_point;
use subpixel_shadows::gpu::bindings::{Read, Write};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, Recorder, Source};
use subpixel_shadows::stages::DispatchArgs;
use subpixel_shadows::stages::dispatch_args::ArgsRequest;
use test_support::gpu_test;

/// Adds one to the word of every item that an invocation stands for.
const TOUCH: &str = concat!(
    include_str!("../../kernels/shared/frame/dispatch.wgsl"),
    "@group(0) @binding(0) var<storage, read> counts: array<u32>;
        @group(0) @binding(1) var<storage, read_write> touched: array<atomic<u32>>;
        @compute @workgroup_size(64)
        fn touch(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) local: u32) {
            let id = flat_invocation(group, groups, 64u, local);
            if id < counts[0] { atomicAdd(&touched[id], 1u); }
        }"
);

entry_point! { "touch", "touch", [64, 1, 1], Source(&[TOUCH]), () => Touch, TouchProgram {
    0 counts: Read<'a, u32>,
    1 touched: Write<'a, u32>,
} }

/// The arguments of each `(count, per_group, limit, skip)`, made on the GPU; then one word of poison.
fn folded(gpu: &Gpu, cases: &[[u32; 4]]) -> Vec<u32> {
    let stage = DispatchArgs::new(&gpu.device);
    let requests: Vec<ArgsRequest> = (0u32..)
        .zip(cases)
        .map(|(i, &[_, per_group, limit, skip])| ArgsRequest {
            count_word: i,
            per_group,
            limit,
            args_word: i * 3,
            skip,
            ..ArgsRequest::default()
        })
        .collect();
    let requests = DispatchArgs::requests(&gpu.device, &gpu.queue, &requests).expect("requests");
    let counts = upload(gpu, &cases.iter().map(|case| case[0]).collect::<Vec<_>>());
    let args = poisoned(gpu, cases.len() * 3 + 1);
    run(gpu, |s| stage.record(s, &counts, &requests, &args));
    args.read(gpu).expect("readback")
}

fn wanted(cases: &[[u32; 4]]) -> Vec<u32> {
    let mut want: Vec<u32> =
        cases.iter().flat_map(|&[count, per_group, limit, skip]| fold(count, per_group, limit, skip)).collect();
    want.push(POISON);
    want
}

#[track_caller]
fn check(gpu: &Gpu, cases: &[[u32; 4]]) {
    assert_same(&format!("{} requests", cases.len()), &folded(gpu, cases), &wanted(cases));
}

/// Touches `items` items, by arguments made on the GPU or by the host's own fold, and counts how often each was.
#[track_caller]
fn touches_each_once(gpu: &Gpu, program: &TouchProgram, items: usize, indirect: bool) {
    let stage = DispatchArgs::new(&gpu.device);
    let request = ArgsRequest::new(0, 64, items, 0).expect("a request");
    let requests = DispatchArgs::requests(&gpu.device, &gpu.queue, &[request]).expect("requests");
    let args = Buffer::<u32>::indirect(&gpu.device, "test.args", 3).expect("arguments");
    let counts = upload(gpu, &[items as u32]);
    let touched = upload(gpu, &vec![0u32; items + 1]);
    let bindings = Touch { counts: counts.as_read(), touched: touched.as_write() };
    run(gpu, |s| {
        stage.record(s, &counts, &requests, &args)?;
        let groups = if indirect { Groups::Indirect(args.raw(), 0) } else { Groups::Items(items as u64) };
        s.run(program, bindings, groups);
        Ok(())
    });
    let mut want = vec![1; items];
    want.push(0);
    assert_same(&format!("{items} items, indirect {indirect}"), &touched.read(gpu).expect("readback"), &want);
}

#[gpu_test]
fn empty() {
    check(gpu(), &[]);
    check(gpu(), &[[0, 64, 100, 0], [5, 64, 0, 0], [5, 0, 5, 0], [5, 64, 5, 5]]);
    touches_each_once(gpu(), &TouchProgram::new(&gpu().device, ()), 0, true);
}

#[gpu_test]
fn one() {
    check(gpu(), &[[1, 64, 100, 0], [1, 64, 100, 1]]);
    touches_each_once(gpu(), &TouchProgram::new(&gpu().device, ()), 1, true);
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in sizes_around(64) {
        let cases: Vec<_> = (0..size as u32).map(|i| [i, 64, 150, i % 70]).collect();
        check(gpu(), &cases);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(51);
    let mut word = || random.word() >> random.below(32);
    let cases: Vec<_> = (0..20_000).map(|_| [word(), word(), word(), word()]).collect();
    check(gpu(), &cases);
    check(gpu(), &cases);
}

#[gpu_test]
fn degenerate() {
    let edges = [0, 1, 2, 63, 64, 65, MAX_GROUPS - 1, MAX_GROUPS, MAX_GROUPS + 1, 1 << 31, u32::MAX - 1, u32::MAX];
    let mut cases = Vec::new();
    for count in edges {
        for per_group in edges {
            cases.extend(edges.map(|limit| [count, per_group, limit, limit / 2]));
            cases.extend(edges.map(|skip| [count, per_group, u32::MAX, skip]));
        }
    }
    check(gpu(), &cases);
}

#[gpu_test]
fn overflow_by_one() {
    // A count beyond the capacity runs the capacity.
    check(
        gpu(),
        &[[99, 10, 100, 0], [100, 10, 100, 0], [101, 10, 100, 0], [u32::MAX, 10, 100, 0], [u32::MAX, 1, u32::MAX, 0]],
    );
    assert!(ArgsRequest::new(0, 64, ArgsRequest::MAX_LIMIT, 0).is_ok());
    assert!(ArgsRequest::new(0, 64, ArgsRequest::MAX_LIMIT + 1, 0).is_err());
    assert!(ArgsRequest::new(0, 0, 5, 0).is_err());
    let device = &gpu().device;
    let stage = DispatchArgs::new(device);
    let request = ArgsRequest::new(4, 64, 10, 3).expect("a request");
    let requests = DispatchArgs::requests(device, &gpu().queue, &[request]).expect("requests");
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(device, &mut encoder, None);
    let mut s = recorder.stage("test");
    let mut fits =
        |counts, args| stage.record(&mut s, &poisoned(gpu(), counts), &requests, &poisoned(gpu(), args)).is_ok();
    assert!(fits(5, 6));
    assert!(!fits(4, 6));
    assert!(!fits(5, 5));
}

#[gpu_test]
fn two_d_dispatch() {
    let program = TouchProgram::new(&gpu().device, ());
    let max = MAX_GROUPS as usize;
    for groups in [max - 1, max, max + 1, max + 2, 1 << 17] {
        touches_each_once(gpu(), &program, groups * 64, true);
    }
    touches_each_once(gpu(), &program, max * 256 + 1, true);
    touches_each_once(gpu(), &program, (max + 1) * 64 - 1, false);
    let small = small_gpu(3, 1 << 20);
    let program = TouchProgram::new(&small.device, ());
    for items in [3 * 64, 3 * 64 + 1, 7 * 64, 9 * 64] {
        touches_each_once(&small, &program, items, false);
    }
}

#[gpu_test]
fn detects_corruption() {
    let cases = [[70_000, 1, 80_000, 0], [5, 64, 5, 0]];
    let (mut got, want) = (folded(gpu(), &cases), wanted(&cases));
    assert_eq!(difference(&got, &want), None);
    got.swap(0, 1);
    assert!(difference(&got, &want).is_some());
    // Arguments that were never written, or one row only, leave items untouched: the count of touches must tell.
    let program = TouchProgram::new(&gpu().device, ());
    let counts = upload(gpu(), &[200u32]);
    let touched = upload(gpu(), &[0u32; 200]);
    let bindings = Touch { counts: counts.as_read(), touched: touched.as_write() };
    run(gpu(), |s| s.run(&program, bindings, Groups::Workgroups(2)));
    assert!(difference(&touched.read(gpu()).expect("readback"), &[1; 200]).is_some());
}
