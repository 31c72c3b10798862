//! Boxes of clusters of triangles and edges whose vertices move, against their definition, bit by bit.

use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::cluster_bounds::boxes;
use std::sync::OnceLock;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::methods::prepared::padded;
use subpixel_shadows::scene::{Edge, Mesh, NO_TRIANGLE};
use subpixel_shadows::stages::ClusterBounds;
use subpixel_shadows::stages::cluster_bounds::{ClusterUses, cluster_uses};
use subpixel_shadows::stages::cluster_culling::{CLUSTER, ClusterBox};
use test_support::gpu_test;

fn stage() -> &'static ClusterBounds {
    static STAGE: OnceLock<ClusterBounds> = OnceLock::new();
    STAGE.get_or_init(|| ClusterBounds::new(&gpu().device))
}

fn position(random: &mut Random) -> [f32; 3] {
    [(); 3].map(|()| (random.below(1 << 20) as f32 - 5e5) / 1e3)
}

/// A mesh of triangles among so many vertices, mostly of near numbers, and edges of which some hold none.
fn mesh(random: &mut Random, vertices: u32, triangles: usize, edges: usize) -> (Mesh, Vec<Edge>) {
    let positions = (0..vertices).map(|_| position(random)).collect();
    let near = |random: &mut Random, at: u32| match random.below(20) {
        0 => random.below(vertices),
        _ => (at + random.below(8)).min(vertices - 1),
    };
    let of = |k: usize, of: usize| (u64::from(vertices) * k as u64 / of.max(1) as u64) as u32;
    let corners = |random: &mut Random, k: usize| [(); 3].map(|()| near(random, of(k, triangles)));
    let triangles = (0..triangles).map(|k| corners(random, k)).collect();
    let edge = |random: &mut Random, k: usize| {
        let v0 = near(random, of(k, edges));
        let v1 = if random.below(9) == 0 { v0 } else { near(random, v0) };
        Edge { v0, v1, t0: 0, t1: NO_TRIANGLE }
    };
    let edges = (0..edges).map(|k| edge(random, k)).collect();
    (Mesh { positions, triangles }, edges)
}

/// Boxes that the stage writes, as words.
fn made(gpu: &Gpu, stage: &ClusterBounds, (mesh, edges): &(Mesh, Vec<Edge>)) -> Vec<u32> {
    let positions = upload(gpu, &padded(&mesh.positions));
    let uses = cluster_uses(mesh, edges);
    let clusters = mesh.triangles.len().div_ceil(CLUSTER) + edges.len().div_ceil(CLUSTER);
    let mut of = ClusterUses::new(&gpu.device, &gpu.queue, &uses, mesh.positions.len()).expect("memory");
    of.vertex_boxes = poisoned(gpu, of.vertex_boxes.len());
    let boxes: Buffer<ClusterBox> = poisoned(gpu, clusters);
    run(gpu, |s| stage.record(s, &positions, &of, &boxes));
    let boxes = boxes.read(gpu).expect("readback");
    boxes.iter().flat_map(|of| [of.low, of.high].concat()).map(f32::to_bits).collect()
}

/// Boxes as they are defined; a cluster that uses no vertex has a box that holds nothing.
fn wanted((mesh, edges): &(Mesh, Vec<Edge>)) -> Vec<u32> {
    let triangles: Vec<Vec<u32>> = mesh.triangles.iter().map(|t| t.to_vec()).collect();
    let ends = |e: &Edge| if e.v0 == e.v1 { Vec::new() } else { vec![e.v0, e.v1] };
    let edges: Vec<Vec<u32>> = edges.iter().map(ends).collect();
    let all = [boxes(&mesh.positions, &triangles), boxes(&mesh.positions, &edges)].concat();
    let words = |found: &Option<[[f32; 3]; 2]>| match *found {
        Some([[a, b, c], [d, e, f]]) => [a, b, c, 0.0, d, e, f, 0.0],
        None => [3e38, 3e38, 3e38, 3e38, -3e38, -3e38, -3e38, -3e38],
    };
    all.iter().flat_map(words).map(f32::to_bits).collect()
}

#[track_caller]
fn check(gpu: &Gpu, stage: &ClusterBounds, of: &(Mesh, Vec<Edge>)) -> usize {
    let (got, want) = (made(gpu, stage, of), wanted(of));
    assert_same("boxes", &got, &want);
    assert!(!got.contains(&POISON));
    want.len() / 8
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(1);
    assert_eq!(check(gpu(), stage(), &mesh(&mut random, 1, 0, 0)), 0);
    assert_eq!(check(gpu(), stage(), &mesh(&mut random, 200, 0, 70)), 2);
    assert_eq!(check(gpu(), stage(), &mesh(&mut random, 200, 70, 0)), 2);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(2);
    for _ in 0..20 {
        check(gpu(), stage(), &mesh(&mut random, 3, 1, 3));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(3);
    for size in sizes_around(64) {
        let vertices = random.below(400) + 1;
        check(gpu(), stage(), &mesh(&mut random, size.max(1) as u32, 3 * size, 5 * size));
        check(gpu(), stage(), &mesh(&mut random, vertices, 64 * size, size));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(4);
    for _ in 0..20 {
        let [vertices, triangles, edges] = [5000, 9000, 15_000].map(|most| random.below(most) + 1);
        check(gpu(), stage(), &mesh(&mut random, vertices, triangles as usize, edges as usize));
    }
}

#[gpu_test]
fn degenerate() {
    let mut random = Random::new(5);
    // Edges that hold none, all of a cluster; one vertex for all; places as far apart as numbers are.
    let (mut of, mut edges) = mesh(&mut random, 100, 64, 128);
    edges[..64].iter_mut().for_each(|e| e.v1 = e.v0);
    of.triangles.iter_mut().for_each(|t| *t = [7; 3]);
    of.positions[3] = [1e38, -1e38, 0.0];
    check(gpu(), stage(), &(of, edges));
    // Clusters that use all others.
    let (mut of, edges) = mesh(&mut random, 64 * 200, 640, 64);
    of.triangles
        .iter_mut()
        .enumerate()
        .for_each(|(k, t)| *t = [0, 1, 2].map(|c| (64 * (3 * k + c) % (64 * 200)) as u32));
    check(gpu(), stage(), &(of, edges));
}

#[gpu_test]
fn overflow_by_one() {
    // Lists have the length that they need; buffers that are too short are refused.
    let (of, edges) = mesh(&mut Random::new(6), 130, 64, 64);
    let positions = upload(gpu(), &padded(&of.positions));
    let uses = ClusterUses::new(&gpu().device, &gpu().queue, &cluster_uses(&of, &edges), 130).expect("memory");
    let short = ClusterUses::new(&gpu().device, &gpu().queue, &cluster_uses(&of, &edges), 128).expect("memory");
    let boxes = |len: usize| poisoned::<ClusterBox>(gpu(), len);
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(&gpu().device, &mut encoder, None);
    let s = &mut recorder.stage("test");
    assert!(stage().record(s, &positions, &uses, &boxes(2)).is_ok());
    assert!(stage().record(s, &positions, &short, &boxes(2)).is_err(), "three clusters of vertices");
    assert!(stage().record(s, &positions, &uses, &boxes(20)).is_err(), "no lists of so many");
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(10, 1 << 22);
    let stage = ClusterBounds::new(&small.device);
    let of = mesh(&mut Random::new(7), 64 * 60, 64 * 700, 100);
    assert!(check(&small, &stage, &of) > 64 * 10, "more workgroups than fit along a dimension");
}

#[gpu_test]
fn detects_corruption() {
    let mut of = mesh(&mut Random::new(8), 500, 900, 300);
    let want = wanted(&of);
    assert_eq!(difference(&made(gpu(), stage(), &of), &want), None);
    of.0.positions[200][1] = 1e6;
    assert!(difference(&made(gpu(), stage(), &of), &want).is_some());
}
