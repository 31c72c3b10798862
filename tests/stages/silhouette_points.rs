//! Points of silhouette edges in the cells between texels, against `f64` on the same edges: each point is one of an edge that may be seen there,
//! and no nearer edge surely is.

use crate::support::geometry::{Case, MESHES, add, fan, light, mesh, run_all, unpack, work};
use crate::support::shadow::uniform;
use crate::support::{Random, gpu, poisoned, read_padded, run, sizes_around, small_gpu, upload};
use oracle::reference::silhouette_points::{hides_from, middle, point_in};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Gpu, kernels};
use subpixel_shadows::scene::Mesh;
use subpixel_shadows::stages::silhouette_points::{EdgeBlocks, SilhouetteCells, SilhouettePoints};
use test_support::gpu_test;

struct Ran {
    map: u32,
    depth_margin: f64,
    /// Of each silhouette edge its ends, and first and last cell.
    edges: Vec<([DVec3; 2], [[u32; 2]; 2])>,
    depths: Vec<Option<f64>>,
    edge_keys: Vec<u32>,
    point_keys: Vec<u32>,
}

fn points(gpu: &Gpu, case: &Case) -> Ran {
    let ran = run_all(gpu, case);
    let size = case.map as usize;
    let frame = uniform(gpu, &ran.frame);
    let (offsets, args) = work(gpu, &ran.edge_items, kernels::silhouette_points::WORKGROUP);
    let (edges, map_points) = (upload(gpu, &case.prepared.edges), upload(gpu, &ran.map_points));
    let (rects, nearest) = (upload(gpu, &ran.edge_rects), upload(gpu, &ran.nearest_keys));
    let count = (size + 1) * (size + 1);
    let cells = SilhouetteCells { edge_keys: poisoned(gpu, count), point_keys: poisoned(gpu, count) };
    cells.edge_keys.write(&gpu.queue, &vec![0; count]);
    let stage = SilhouettePoints::new(&gpu.device);
    let blocks =
        EdgeBlocks { edges: &edges, points: &map_points, rects: &rects, offsets: &offsets, args: (args.raw(), 0) };
    for _ in 0..2 {
        cells.point_keys.write(&gpu.queue, &vec![0; count]);
        run(gpu, |s| stage.record(s, &frame, blocks, &nearest, &cells));
    }
    let words = |buffer| {
        let mut words = read_padded(gpu, buffer);
        let rest = words.split_off(count);
        assert!(rest.iter().all(|&word| word == crate::support::POISON), "written past the end");
        words
    };
    let end = |v: u32| {
        DVec3::new(0.0, 0.0, 0.0) + DVec3::from_array(std::array::from_fn(|k| f64::from(ran.map_points[v as usize][k])))
    };
    let listed = case.prepared.edges.iter().zip(&ran.edge_rects).zip(&ran.edge_items).filter(|(_, items)| **items > 0);
    let edges = listed
        .map(|((edge, &rect), _)| {
            let [x0, y0, x1, y1] = unpack(rect).expect("a rectangle");
            ([end(edge.v0), end(edge.v1)], [[x0, y0], [x1 + 1, y1 + 1]])
        })
        .collect();
    Ran {
        map: case.map,
        depth_margin: f64::from(ran.frame.depth_margin),
        edges,
        depths: ran.nearest_keys.iter().map(|&key| (key != 0).then(|| f64::from(f32::from_bits(!key)))).collect(),
        edge_keys: words(&cells.edge_keys),
        point_keys: words(&cells.point_keys),
    }
}

/// Where the stage departs from its definition.
fn fault(ran: &Ran) -> Option<String> {
    let side = ran.map + 1;
    if [ran.edge_keys.len(), ran.point_keys.len()] != [(side * side) as usize; 2] {
        return Some("another number of cells".to_owned());
    }
    // Of each cell the least depth that is surely seen, and whether its point is that of an edge.
    let mut least = vec![f64::INFINITY; ran.edge_keys.len()];
    let mut known = vec![false; ran.edge_keys.len()];
    for &(edge, [first, last]) in &ran.edges {
        let [a, b] = edge;
        let extent = a.abs().max(b.abs()).truncate().max_element();
        let off = 1e-3 + 4e-6 * extent;
        let length = (b - a).truncate().length();
        let depth_off = 1e-5 + (b.z - a.z).abs() * (4.0 * off / length).min(1.0);
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let (cell, index) = ([x, y], (y * side + x) as usize);
                let found = [0.5 - off, 0.5, 0.5 + off].map(|half| point_in(cell, edge, half));
                let limit = hides_from(cell, &ran.depths, ran.map) + ran.depth_margin;
                if let [Some(p), Some(q), Some(r)] = found
                    && p.z.max(q.z).max(r.z) + depth_off < limit
                {
                    least[index] = least[index].min(p.z.max(q.z).max(r.z) + depth_off);
                }
                let Some([across, down]) = SilhouetteCells::place(ran.point_keys[index]) else { continue };
                let at = middle(cell) + DVec2::new(across, down) - 0.5;
                let depth = f64::from(f32::from_bits(!ran.edge_keys[index]));
                known[index] |= found.into_iter().flatten().any(|p| {
                    let near = (p.truncate() - at).abs().max_element() < 4.0 * off;
                    near && (p.z.max(0.0) - depth).abs() < 2.0 * depth_off && p.z - depth_off < limit
                });
            }
        }
    }
    for (k, (&edge, &point)) in ran.edge_keys.iter().zip(&ran.point_keys).enumerate() {
        let at = format!("cell {} {}", k as u32 % side, k as u32 / side);
        if (edge == 0) != (point == 0) {
            return Some(format!("{at}: depth and point disagree"));
        }
        if edge == 0 && least[k] < f64::INFINITY {
            return Some(format!("{at}: an edge of depth {} is missed", least[k]));
        }
        let depth = f64::from(f32::from_bits(!edge));
        if edge != 0 && depth > least[k].max(0.0) + 1e-6 {
            return Some(format!("{at}: depth {depth}, one of {} is nearer", least[k]));
        }
        if edge != 0 && !known[k] {
            return Some(format!("{at}: {:?} is no point of an edge", SilhouetteCells::place(point)));
        }
    }
    None
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Ran {
    let ran = points(gpu, case);
    if let Some(text) = fault(&ran) {
        panic!("{:?}, map {}: {text}", case.light, case.map);
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(gpu(), &Case::new(&Mesh::default(), light(0), [1, 1], 8));
    assert!(ran.edges.is_empty() && ran.point_keys.iter().all(|&key| key == 0));
}

#[gpu_test]
fn one() {
    // One triangle: three edges, all silhouettes.
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for (k, map) in [1, 2, 3, 8, 64].into_iter().enumerate() {
        let ran = check(gpu(), &Case::new(&mesh, light(k as u64), [1, 1], map));
        assert!(ran.edges.len() == 3 && ran.point_keys.iter().any(|&key| key != 0), "map {map}");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in [sizes_around(8), sizes_around(64)[7..10].to_vec()].concat() {
        check(gpu(), &Case::new(&mesh("closed balls", size as u64), light(size as u64), [1, 1], size as u32));
    }
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [1, 1], 40));
    }
}

#[gpu_test]
fn random_seeded() {
    for (k, name) in MESHES.iter().enumerate() {
        for (seed, map) in [1, 3, 8, 33, 150].into_iter().enumerate() {
            check(gpu(), &Case::new(&mesh(name, seed as u64), light((seed + k) as u64), [1, 1], map));
        }
    }
}

/// Edges along rows and columns of cells, and seen end on.
#[gpu_test]
fn degenerate() {
    let mut grid = Mesh::default();
    for k in 0..6u32 {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x + f64::from(k), y, z);
        add(&mut grid, &[at(0.0, 0.0, 0.0), at(0.5, 0.0, 0.0), at(0.0, 0.5, 0.5)], &[[0, 1, 2]]);
        add(&mut grid, &[at(0.0, 1.0, 0.0), at(0.0, -1.0, 0.0), at(0.5, 0.0, 0.0)], &[[0, 1, 2]]);
    }
    let above = subpixel_shadows::scene::Light::Directional { direction: [0.0, 1.0, 0.0] };
    for map in [6, 12, 13, 64] {
        check(gpu(), &Case::new(&grid, above, [1, 1], map));
    }
}

#[gpu_test]
fn beyond_one_dimension() {
    check(&small_gpu(100, 1 << 26), &Case::new(&mesh("closed balls", 4), light(1), [1, 1], 200));
}

#[gpu_test]
fn two_d_dispatch() {
    let case = Case::new(&mesh("closed balls", 5), light(2), [1, 1], 100);
    let of = |gpu: &Gpu| points(gpu, &case).point_keys;
    assert!(of(&small_gpu(64, 1 << 26)) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 6), light(3), [1, 1], 64);
    let ran = check(gpu(), &case);
    assert!(points(gpu(), &case).point_keys == ran.point_keys, "another result in a second run");
    let mut random = Random::new(1);
    let with: Vec<usize> = (0..ran.point_keys.len()).filter(|&k| ran.point_keys[k] != 0).collect();
    let cell = with[random.below(with.len() as u32) as usize];
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = points(gpu(), &case);
        spoil(&mut off);
        fault(&off).is_some()
    };
    assert!(spoilt(&|r| r.point_keys[cell] ^= 0x4000_4000));
    assert!(spoilt(&|r| (r.edge_keys[cell], r.point_keys[cell]) = (0, 0)));
    assert!(spoilt(&|r| r.edge_keys[cell] = !2.0f32.to_bits()));
    assert!(spoilt(&|r| r.point_keys.rotate_left(1)));
    assert!(spoilt(&|r| r.edge_keys.truncate(9)));
}
