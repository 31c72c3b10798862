//! Triangle-texel pairs: no exact pair is missing, none is farther than twice the margin.

use crate::support::shadow::{
    World, camera, deepest_of, folding_gpu, random_light, random_scene, samples, unit, vector,
};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::front_layer::Margin;
use oracle::reference::triangle_setup::Reach;
use oracle::reference::triangle_texel_pairs::{TilePair, pairs, tile_pairs};
use oracle::reference::view::MapEnds;
use std::sync::OnceLock;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::pixel_texel_pairs::PairTiles;
use subpixel_shadows::stages::triangle_texel_pairs::TriangleTexelPairs;
use test_support::gpu_test;

/// One for each kind of places.
fn stages() -> &'static [TriangleTexelPairs; 2] {
    static STAGES: OnceLock<[TriangleTexelPairs; 2]> = OnceLock::new();
    STAGES.get_or_init(|| {
        [PairTiles::Texels, PairTiles::Tiles].map(|places| TriangleTexelPairs::new(&gpu().device, places))
    })
}

/// As `check`, with pairs that meet by texel and by tile.
#[track_caller]
fn check_both(world: &World, deepest: &[Option<f32>]) -> usize {
    stages().iter().map(|stage| check(world, stage, deepest)).sum()
}

const MAPS: [u32; 4] = [1, 2, 33, 64];

fn of_mesh(gpu: &'static Gpu, mesh: &Mesh, light: Light, map: u32, random: &mut Random) -> World {
    let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
    World::new(gpu, mesh, camera(eye, vector(random) * 0.3, 50.0), light, [8, 8], map, samples(8))
}

fn world(gpu: &'static Gpu, kind: u32, random: &mut Random) -> World {
    let mesh = random_scene(kind, random);
    let light = random_light(random.below(2) == 0, random);
    let map = MAPS[random.below(4) as usize];
    of_mesh(gpu, &mesh, light, map, random)
}

/// Texels with facets at some depth, and texels without.
fn any_depths(world: &World, random: &mut Random) -> Vec<Option<f32>> {
    let texels = world.view.map.map_size.pow(2);
    (0..texels).map(|_| (random.below(4) > 0).then(|| unit(random) as f32 * 1.2)).collect()
}

/// Pairs missing of the exact ones, and pairs that are not among those of twice the margin.
fn faults(least: &[Vec<u32>], got: &[Vec<u32>], most: &[Vec<u32>]) -> (usize, usize) {
    let without = |a: &[Vec<u32>], b: &[Vec<u32>]| {
        a.iter().zip(b).map(|(a, b)| a.iter().filter(|&x| b.binary_search(x).is_err()).count()).sum()
    };
    (without(least, got), without(got, most))
}

#[track_caller]
fn check(world: &World, stage: &TriangleTexelPairs, deepest: &[Option<f32>]) -> usize {
    match stage.places() {
        PairTiles::Texels => check_texels(world, stage, deepest),
        PairTiles::Tiles => check_tiles(world, stage, deepest),
    }
}

/// Whether single precision may not know the triangle's orientation, so that it lists what its edges' lines touch in its box; or
/// the triangle is cut off at the light, where it is known less well.
fn thin(world: &World, t: u32) -> bool {
    world.triangles[t as usize].flat().is_none_or(|f| {
        let [a, b, c] = f.corners.map(DVec3::truncate);
        let (ab, ac) = (b - a, c - a);
        let size = (ab.x.abs() + ab.y.abs()).max(ac.x.abs() + ac.y.abs());
        ab.perp_dot(ac).abs() <= 1e-5 * (f.bounds().1.length() + f.bounds().0.length() + size) * size
    })
}

#[track_caller]
fn check_texels(world: &World, stage: &TriangleTexelPairs, deepest: &[Option<f32>]) -> usize {
    let exact: Vec<Option<f64>> = deepest.iter().map(|d| d.map(f64::from)).collect();
    let by = |margin: Margin| pairs(&world.triangles, &exact, MapEnds::of(&world.view.map), margin);
    let (least, mut most) = (by(Margin::default()), by(world.margin().times(2.0)));
    let needed: usize = world.triangle_pairs(stage, deepest, 0).counts.iter().map(|&c| c as usize).sum();
    let got = world.triangle_pairs(stage, deepest, needed).sets();
    assert!(got.iter().all(|s| s.windows(2).all(|w| w[0] < w[1])), "a pair is listed twice");
    for (most, got) in most.iter_mut().zip(&got) {
        most.extend(got.iter().copied().filter(|&t| thin(world, t)));
        most.sort_unstable();
    }
    assert_eq!(faults(&least, &got, &most), (0, 0), "missing, too far");
    got.iter().map(Vec::len).sum()
}

#[track_caller]
fn check_tiles(world: &World, stage: &TriangleTexelPairs, deepest: &[Option<f32>]) -> usize {
    let size = world.view.map.map_size;
    let exact: Vec<Option<f64>> = deepest.iter().map(|d| d.map(f64::from)).collect();
    let exact = deepest_of(PairTiles::Tiles, size as usize, &exact);
    let by = |margin: Margin| tile_pairs(&world.triangles, &exact, MapEnds::of(&world.view.map), margin);
    let (least, most) = (by(Margin::default()), by(world.margin().times(2.0)));
    let needed: usize = world.triangle_pairs(stage, deepest, 0).counts.iter().map(|&c| c as usize).sum();
    let listed = world.triangle_pairs(stage, deepest, needed);
    let mut got = vec![Vec::new(); exact.len()];
    for (&(t, tile), &word) in listed.list.iter().zip(&listed.parts).filter(|(p, _)| p.0 != POISON) {
        let nearest = f64::from(f32::from_bits(word >> 16 << 16));
        got[tile as usize].push(TilePair { triangle: t, cells: word & 0xffff, nearest });
    }
    got.iter_mut().for_each(|set| set.sort_unstable_by_key(|p| p.triangle));
    let twice = |set: &Vec<TilePair>| set.windows(2).any(|w| w[0].triangle == w[1].triangle);
    assert!(!got.iter().any(twice), "a pair is listed twice");
    assert_eq!(tile_faults(&least, &got, &most, |t| thin(world, t)), [0; 3], "missing, too far, depths");
    got.iter().map(Vec::len).sum()
}

/// Pairs and cells that are missing, pairs and cells that are too far, and depths that are too far or too near, of a list of
/// tiles between two others. What is `thin` may have more.
fn tile_faults(
    least: &[Vec<TilePair>],
    got: &[Vec<TilePair>],
    most: &[Vec<TilePair>],
    thin: impl Fn(u32) -> bool,
) -> [u32; 3] {
    let of = |set: &[TilePair], t: u32| set.iter().find(|p| p.triangle == t).copied();
    let mut faults = [0; 3];
    for ((least, got), most) in least.iter().zip(got).zip(most) {
        for a in least {
            match of(got, a.triangle) {
                Some(b) => {
                    faults[0] += (a.cells & !b.cells).count_ones();
                    faults[2] += u32::from(b.nearest > a.nearest.max(0.0));
                }
                None => faults[0] += 1,
            }
        }
        for b in got.iter().filter(|b| !thin(b.triangle)) {
            match of(most, b.triangle) {
                Some(a) => {
                    faults[1] += (b.cells & !a.cells).count_ones();
                    // Rounded down to eight bits, of which the first is not written.
                    faults[2] += u32::from(b.nearest < a.nearest.max(0.0) * (1.0 - 1.0 / 128.0) - 1e-6);
                }
                // A tile of which its margin alone is touched may be listed with no cell.
                None => faults[1] += u32::from(b.cells != 0),
            }
        }
    }
    faults
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(31);
    let world = world(gpu(), 0, &mut random);
    let texels = (world.view.map.map_size as usize).pow(2);
    assert_eq!(check_both(&world, &vec![None; texels]), 0, "no facet, no pair");
    let none = of_mesh(gpu(), &Mesh::default(), Light::Directional { direction: [0.0, 1.0, 0.1] }, 8, &mut random);
    assert_eq!(check_both(&none, &[Some(1.0); 64]), 0);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(32);
    let mut found = 0;
    for map in MAPS {
        let mut mesh = crate::support::shadow::soup(1, 0.6, &mut random);
        // A triangle with nothing behind it is not looked at.
        let below = mesh.positions.iter().map(|p| [p[0], p[1] - 2.0, p[2]]).collect::<Vec<_>>();
        mesh.positions.extend(below);
        mesh.triangles.push([3, 4, 5]);
        let light = random_light(map % 2 == 0, &mut random);
        let world = of_mesh(gpu(), &mesh, light, map, &mut random);
        found += check_both(&world, &vec![Some(3.0); (map * map) as usize]);
    }
    assert!(found > 0);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(33);
    // One block a triangle: as many work items as triangles.
    for size in sizes_around(64) {
        let mesh = crate::support::shadow::soup(size, 0.1, &mut random);
        let light = random_light(size % 2 == 0, &mut random);
        let world = of_mesh(gpu(), &mesh, light, 8, &mut random);
        check_both(&world, &[Some(3.0); 64]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(34);
    let mut found = 0;
    for kind in 0..60 {
        let world = world(gpu(), kind, &mut random);
        found += check_both(&world, &any_depths(&world, &mut random));
    }
    assert!(found > 10_000, "{found} pairs");
}

/// Triangles of no area, slivers, triangles far outside the map, sub-texel ones, and ones that reach behind the light.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(35);
    for round in 0..12 {
        let mut mesh = crate::support::shadow::soup(60, 0.6, &mut random);
        for t in 0..60 {
            let [a, b] = [mesh.positions[3 * t], mesh.positions[3 * t + 1]];
            let thin = |by: f32| std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + by * (k as f32 - 1.0));
            match t % 6 {
                0 => mesh.positions[3 * t + 2] = thin(0.0),
                1 => mesh.positions[3 * t + 2] = thin(1e-5),
                2 => mesh.positions[3 * t + 2] = a,
                3 => mesh.positions[3 * t + 2] = thin(1e-3),
                _ => {}
            }
        }
        mesh.triangles.push([5, 5, 7]);
        let light = if round % 2 == 0 {
            // Among the triangles: many reach behind it.
            Light::Point { position: (vector(&mut random) * 0.5).as_vec3().into() }
        } else {
            Light::Directional { direction: (vector(&mut random)).as_vec3().into() }
        };
        let world = of_mesh(gpu(), &mesh, light, MAPS[random.below(4) as usize], &mut random);
        check_both(&world, &any_depths(&world, &mut random));
    }
}

/// Of triangles that reach behind the light only what the lines of their edges hold is listed, which is not all of the map.
#[gpu_test]
fn behind_the_light_lines_tell() {
    let mut random = Random::new(39);
    let map = 64;
    let [mut listed, mut held, mut all] = [0; 3];
    for _ in 0..6 {
        let mesh = crate::support::shadow::soup(40, 1.5, &mut random);
        let light = Light::Point { position: (vector(&mut random) * 0.3).as_vec3().into() };
        let world = of_mesh(gpu(), &mesh, light, map, &mut random);
        let deepest = vec![Some(3.0); (map * map) as usize];
        let exact = vec![Some(3.0); (map * map) as usize];
        let is_cut = |t: &u32| matches!(world.triangles[*t as usize].map, Reach::Cut(_));
        let count = |sets: &[Vec<u32>]| sets.iter().map(|s| s.iter().filter(|t| is_cut(t)).count()).sum::<usize>();
        let stage = &stages()[0];
        let needed = check(&world, stage, &deepest);
        listed += count(&world.triangle_pairs(stage, &deepest, needed).sets());
        held += count(&pairs(&world.triangles, &exact, MapEnds::of(&world.view.map), world.margin().times(2.0)));
        all += (0..world.triangles.len() as u32).filter(is_cut).count() * exact.len();
    }
    println!("{listed} pairs listed, {held} held by lines, {all} texels");
    assert!(all > 100_000 && held < all / 2, "{held} of {all} pairs are held by lines");
    assert!(listed >= held / 2 && listed < held + held / 7, "{listed} pairs listed where lines hold {held}");
}

#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(36);
    let world = world(gpu(), 1, &mut random);
    let deepest = vec![Some(2.0); (world.view.map.map_size as usize).pow(2)];
    for stage in stages() {
        let counts = world.triangle_pairs(stage, &deepest, 0).counts;
        let needed = counts.iter().sum::<u32>() as usize;
        assert!(needed > 10);
        for capacity in [needed - 1, needed, needed + 1] {
            let listed = world.triangle_pairs_in(stage, &deepest, capacity, needed + 9);
            assert_eq!(listed.counts, counts, "the need does not depend on the capacity");
            let (inside, beyond) = listed.list.split_at(capacity.min(needed));
            assert!(inside.iter().all(|p| p.0 != POISON), "capacity {capacity}: a pair is not written");
            assert!(beyond.iter().all(|p| p.0 == POISON), "capacity {capacity}: written past the end");
            let mut parts = listed.parts[inside.len()..].iter();
            assert!(stage.places() == PairTiles::Texels || parts.all(|&p| p == POISON), "capacity {capacity}: a word");
        }
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(37);
    let small =
        [PairTiles::Texels, PairTiles::Tiles].map(|places| TriangleTexelPairs::new(&folding_gpu().device, places));
    let mesh = crate::support::shadow::soup(150, 0.1, &mut random);
    let light = random_light(true, &mut random);
    let world = of_mesh(folding_gpu(), &mesh, light, 33, &mut random);
    for stage in &small {
        let found = check(&world, stage, &any_depths(&world, &mut random));
        assert!(found > 150, "{:?}: {found} pairs", stage.places());
    }
}

#[gpu_test]
fn detects_corruption() {
    let (least, most) = (vec![vec![1, 4]], vec![vec![0, 1, 4]]);
    assert_eq!(faults(&least, &[vec![1, 4]], &most), (0, 0));
    assert_eq!(faults(&least, &[vec![4]], &most), (1, 0), "a missing pair is seen");
    assert_eq!(faults(&least, &[vec![1, 4, 7]], &most), (0, 1), "a spare one too");
    let pair = TilePair { triangle: 4, cells: 0x0330, nearest: 0.5 };
    let by = |pairs: &[TilePair]| tile_faults(&[vec![pair]], &[pairs.to_vec()], &[vec![pair]], |_| false);
    assert_eq!(by(&[pair]), [0; 3]);
    assert_eq!(by(&[]), [1, 0, 0], "a missing pair is seen");
    assert_eq!(by(&[TilePair { cells: 0x0130, ..pair }]), [1, 0, 0], "a missing cell");
    assert_eq!(by(&[TilePair { cells: 0x8330, ..pair }]), [0, 1, 0], "a spare cell");
    assert_eq!(by(&[pair, TilePair { triangle: 5, ..pair }]), [0, 1, 0], "a spare pair");
    assert_eq!(by(&[TilePair { nearest: 0.51, ..pair }]), [0, 0, 1], "a depth that is too far");
    assert_eq!(by(&[TilePair { nearest: 0.49, ..pair }]), [0, 0, 1], "and one that is too near");
    let mut random = Random::new(38);
    let world = world(gpu(), 1, &mut random);
    let depths = vec![Some(2.0); (world.view.map.map_size as usize).pow(2)];
    let exact: Vec<_> = depths.iter().map(|d| d.map(f64::from)).collect();
    let by = |texels| pairs(&world.triangles, &exact, MapEnds::of(&world.view.map), Margin { texels, depth: 0.0 });
    assert!(faults(&by(1.0), &by(0.0), &by(1.0)).0 > 0, "a margin makes pairs");
}
