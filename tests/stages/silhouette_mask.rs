//! Silhouette edges and the texels they touch, against `f64`: the edges are a superset of the exact ones, by no more than
//! the doubt of facing; the marks hold the exact ones and lie within those at twice the margin.

use crate::support::geometry::{Case, MESHES, Ran, add, fan, light, mesh, run_all, unpack};
use crate::support::{Random, difference, gpu, sizes_around, small_gpu};
use oracle::reference::front_layer::Margin;
use oracle::reference::requested_blocks::requested_part;
use oracle::reference::silhouette_mask::{Sides, marks, silhouettes};
use oracle::reference::view::block_count;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::Mesh;
use test_support::gpu_test;

fn sides(case: &Case) -> Vec<Sides> {
    case.prepared.edges.iter().map(|e| [e.v0, e.v1, e.t0, e.t1]).collect()
}

/// Where the stage departs from its definition; `bounded`: whether its excess is looked at too.
fn fault(case: &Case, ran: &Ran, bounded: bool) -> Option<String> {
    let wanted = case.wanted();
    let edges = sides(case);
    let (fewest, most) = (
        silhouettes(&wanted.view, &edges, &wanted.triangles, 0.0),
        silhouettes(&wanted.view, &edges, &wanted.triangles, 2.0),
    );
    if ran.edge_items.len() != edges.len() || ran.edge_rects.len() != edges.len() {
        return Some("another number of edges".to_owned());
    }
    let blocks: Vec<u32> = ran.edge_rects.iter().map(|&r| block_count(unpack(r))).collect();
    if let Some(text) = difference(&ran.edge_items, &blocks) {
        return Some(format!("items: {text}"));
    }
    let count = |list: &[bool]| list.iter().filter(|s| **s).count() as u32;
    if ran.silhouettes < count(&fewest) || ran.silhouettes > count(&most) {
        return Some(format!("{} silhouettes, {} to {} expected", ran.silhouettes, count(&fewest), count(&most)));
    }
    let limit = f64::from(case.map);
    for (k, &[v0, v1, ..]) in edges.iter().enumerate() {
        if ran.edge_items[k] != 0 && !most[k] {
            return Some(format!("edge {k} is no silhouette"));
        }
        let (Some(a), Some(b)) = (wanted.vertices[v0 as usize].map, wanted.vertices[v1 as usize].map) else { continue };
        let (lo, hi) = (a.min(b), a.max(b));
        let in_map = lo.x < limit && lo.y < limit && hi.x > 0.0 && hi.y > 0.0;
        if fewest[k] && in_map && ran.edge_items[k] == 0 {
            return Some(format!("edge {k} is a silhouette, and not found"));
        }
    }
    let layers = wanted.layers(0.0, 0.0);
    let least = marks(&edges, &fewest, &wanted.vertices, &layers, case.map, Margin::default());
    let double = marks(&edges, &most, &wanted.vertices, &layers, case.map, ran.margin().times(2.0));
    for texel in 0..layers.len() {
        let at = format!("texel {} {}", texel as u32 % case.map, texel as u32 / case.map);
        if ran.marks[0][texel] {
            // The layers are not certain there, and the texel is marked whatever the edges do.
            if !ran.marks[1][texel] {
                return Some(format!("{at}: a mark is gone"));
            }
            continue;
        }
        if least[texel] && !ran.marks[1][texel] {
            return Some(format!("{at}: a silhouette is not marked"));
        }
        if bounded && ran.marks[1][texel] && !double[texel] {
            return Some(format!("{at}: marked, and no silhouette is near"));
        }
    }
    None
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case, bounded: bool) -> Ran {
    let ran = run_all(gpu, case);
    if let Some(text) = fault(case, &ran, bounded) {
        panic!("{:?}, map {}: {text}", case.light, case.map);
    }
    ran
}

#[gpu_test]
fn empty() {
    assert_eq!(check(gpu(), &Case::new(&Mesh::default(), light(0), [1, 1], 8), true).silhouettes, 0);
}

#[gpu_test]
fn one() {
    // One triangle: three edges, all silhouettes.
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for (k, map) in [1, 2, 3, 8, 64].into_iter().enumerate() {
        assert_eq!(check(gpu(), &Case::new(&mesh, light(k as u64), [1, 1], map), true).silhouettes, 3);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in [sizes_around(8), vec![63, 64, 65]].concat() {
        check(gpu(), &Case::new(&mesh("closed balls", size as u64), light(size as u64), [1, 1], size as u32), true);
    }
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [1, 1], 40), true);
    }
}

#[gpu_test]
fn random_seeded() {
    for (k, name) in MESHES.iter().enumerate() {
        for (seed, map) in [1, 3, 8, 33, 150].into_iter().enumerate() {
            let mut case = Case::new(&mesh(name, seed as u64), light((seed + k) as u64), [1, 1], map);
            case.cull_back = seed % 2 == 1;
            // Large coordinates carry a margin of their own.
            check(gpu(), &case, *name != "huge");
        }
    }
    check(gpu(), &Case::new(&mesh("closed balls", 7), light(2), [1, 1], 512), true);
}

#[gpu_test]
fn degenerate() {
    // Boundary, non-manifold and inconsistent edges are silhouettes whatever they face.
    for name in ["leaves", "non-manifold", "flipped", "t-junctions"] {
        let case = Case::new(&mesh(name, 3), light(0), [1, 1], 64);
        let ran = check(gpu(), &case, true);
        let always = case.prepared.edges.iter().filter(|e| e.t1 == u32::MAX).count();
        assert!(always > 0 && ran.silhouettes as usize >= always, "{name}");
    }
    // A vertex that is no number drops its triangles: their edges are silhouettes.
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [1, 1], 64);
    let before = check(gpu(), &case, true).silhouettes;
    let mut positions = case.prepared.mesh().positions.clone();
    positions[11][2] = f32::NAN;
    case.positions = Some(positions);
    assert!(check(gpu(), &case, true).silhouettes > before);
    // Elements that hold no edge count as none and mark nothing, wherever they lie.
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [1, 1], 64);
    let whole = check(gpu(), &case, true);
    let with_one: Vec<usize> = (0..whole.edge_items.len()).filter(|&k| whole.edge_items[k] != 0).step_by(3).collect();
    with_one.iter().for_each(|&k| case.prepared.edges[k].v1 = case.prepared.edges[k].v0);
    let ran = check(gpu(), &case, true);
    assert!(with_one.len() > 5 && with_one.iter().all(|&k| ran.edge_items[k] == 0), "{}", with_one.len());
    assert_eq!(ran.silhouettes as usize + with_one.len(), whole.silhouettes as usize);
    // Edges of length 0 in the light view, along the light.
    let mut mesh = Mesh::default();
    add(
        &mut mesh,
        &[DVec3::ZERO, DVec3::Y, DVec3::new(0.5, 0.3, 0.1), DVec3::new(-0.5, 0.3, 0.2)],
        &[[0, 1, 2], [1, 0, 3]],
    );
    for map in [3, 33] {
        let lit = subpixel_shadows::scene::Light::Directional { direction: [0.0, 1.0, 0.0] };
        check(gpu(), &Case::new(&mesh, lit, [1, 1], map), true);
    }
}

/// The stage has no list: nothing is written past the last edge (see `run_all`); edges are one more, or one less, than
/// a workgroup.
#[gpu_test]
fn overflow_by_one() {
    for n in [31, 32, 33, 63, 64, 65] {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n);
        let case = Case::new(&mesh, light(0), [1, 1], 33);
        assert_eq!(case.prepared.edges.len() as u32, 2 * n);
        check(gpu(), &case, true);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(40, 1 << 20);
    let mut dense = Mesh::default();
    crate::support::geometry::ball(&mut dense, DVec3::ZERO, 1.0, 40, 30);
    let case = Case::new(&dense, light(0), [1, 1], 150);
    let ran = check(&small, &case, true);
    assert!(case.prepared.edges.len() > 40 * 64, "more than one row of workgroups");
    assert!(ran.words() == run_all(gpu(), &case).words(), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [1, 1], 64);
    let ran = check(gpu(), &case, true);
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&case, &off, true).is_some()
    };
    let found = ran.edge_items.iter().position(|&n| n != 0).expect("a silhouette");
    let none = ran.edge_items.iter().position(|&n| n == 0).expect("an edge that is none");
    assert!(spoilt(&|r| (r.edge_items[found], r.edge_rects[found]) = (0, [u32::MAX, 0])));
    assert!(spoilt(&|r| (r.edge_items[none], r.edge_rects[none]) = (1, [0, 0])));
    assert!(spoilt(&|r| r.silhouettes = 0));
    let clear = |r: &mut Ran| r.marks[1] = r.marks[0].clone();
    assert!(spoilt(&clear));
    assert!(spoilt(&|r| r.marks[1].fill(true)));
}

/// Of requested blocks the marks are those of the whole map, and edges have no other blocks.
#[gpu_test]
fn what_is_requested() {
    let mut told = 0;
    for (seed, name) in (0..).zip(MESHES) {
        let map = 300;
        let whole = Case::new(&mesh(name, seed), light(seed), [1, 1], map);
        let mut random = Random::new(seed);
        let blocks: Vec<bool> = (0..map.div_ceil(8).pow(2)).map(|_| random.below(3) == 0).collect();
        let case = Case { requested: Some(blocks.clone()), ..whole.clone() };
        let (all, part) = (run_all(gpu(), &whole), run_all(gpu(), &case));
        assert_eq!(all.silhouettes, part.silhouettes, "{name}: silhouettes are counted wherever they are");
        let asked =
            |texel: usize| blocks[texel / map as usize / 8 * map.div_ceil(8) as usize + texel % map as usize / 8];
        for k in 0..3 {
            let marks =
                |ran: &Ran| -> Vec<bool> { ran.marks[k].iter().enumerate().map(|(t, m)| *m && asked(t)).collect() };
            assert_eq!(difference(&marks(&all), &marks(&part)), None, "{name}: marks after stage {k}");
        }
        for (k, (&of_all, &of_part)) in all.edge_rects.iter().zip(&part.edge_rects).enumerate() {
            let wanted = unpack(of_all).and_then(|rect| requested_part(rect, &blocks, map));
            assert_eq!(unpack(of_part), wanted, "{name}, edge {k}");
        }
        told += u32::from(part.edge_items.iter().sum::<u32>() < all.edge_items.iter().sum::<u32>());
        // The splits, too.
        let splits = |ran: &Ran| -> Vec<u32> {
            ran.splits.iter().enumerate().map(|(t, s)| if asked(t) { s.to_bits() } else { 0 }).collect()
        };
        assert_eq!(difference(&splits(&all), &splits(&part)), None, "{name}: splits");
        told += u32::from(all.marks != part.marks);
    }
    assert!(told > 8, "a comparison of all texels, or of all blocks, tells them apart {told} times");
}
