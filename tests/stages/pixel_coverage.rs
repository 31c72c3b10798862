//! Samples that listed triangles cover, against `f64`: none that is surely outside, all that are surely inside, wherever no edge is
//! within 1/256 pixel; and bounds of the depth there.

use crate::support::geometry::{Case, MESHES, add, ball, fan, light, mesh};
use crate::support::meshes::oblique;
use crate::support::surfaces::{Found, find, find_with_stale, find_within, pattern};
use crate::support::{gpu, sizes_around, small_gpu};
use oracle::reference::camera_visibility::DepthMargin;
use oracle::reference::pixel_coverage::covered;
use oracle::truth::AMBIGUITY;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::Mesh;
use test_support::gpu_test;

const DOUBT: DepthMargin = DepthMargin { edge: AMBIGUITY, depth: 1e-5 };

/// Where the stage departs from its definition, else how many samples triangles surely cover.
fn compare(case: &Case, found: &Found, samples: &Samples) -> Result<usize, String> {
    let wanted = case.wanted();
    let offsets: Vec<DVec2> = samples.offsets().iter().map(|o| DVec2::new(o[0].into(), o[1].into())).collect();
    let (mut sure, mut listed) = (0, 0);
    for (pixel, list) in found.lists.iter().enumerate().filter(|&(p, _)| found.complex[p]) {
        let at = [pixel as u32 % found.image[0], pixel as u32 / found.image[0]];
        for &t in list {
            let want = covered(&wanted.view, &wanted.triangles[t as usize], case.prepared.alpha(), at, &offsets, DOUBT);
            let got = found.covered.get(&(pixel as u32, t));
            listed += usize::from(got.is_some());
            let mask = got.map_or(0, |(mask, _)| *mask);
            if want.sure & !mask != 0 || mask & !want.possible != 0 {
                return Err(format!("triangle {t} at {at:?}: {mask:x}, {want:x?}"));
            }
            sure += want.sure.count_ones() as usize;
            let Some((_, c)) = got else { continue };
            let samples = (0..128).filter(|k| want.sure >> k & 1 == 1);
            for (k, depth) in samples.zip(&want.depths) {
                let o = offsets[k] - 0.5;
                let slope = o.x * f64::from(c.slope_x) + o.y * f64::from(c.slope_y);
                let [low, high] = [c.low, c.high].map(|bound| f64::from(bound) + slope);
                if !(low..=high).contains(&depth.recip()) {
                    return Err(format!("triangle {t} at {at:?}, sample {k}: {}, {low} to {high}", depth.recip()));
                }
            }
        }
    }
    if listed != found.covered.len() {
        return Err(format!("{} triangles cover samples, {listed} of them are listed", found.covered.len()));
    }
    Ok(sure)
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case, count: u32) -> (Found, usize) {
    let samples = pattern(count);
    let found = find(gpu, case, &samples);
    let sure = compare(case, &found, &samples).unwrap_or_else(|text| panic!("image {:?}: {text}", case.image));
    (found, sure)
}

#[gpu_test]
fn empty() {
    let (found, sure) = check(gpu(), &Case::new(&Mesh::default(), light(0), [5, 3], 1), 32);
    assert!(found.covered.is_empty() && sure == 0);
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for count in [1, 8, 128] {
        let mut case = Case::new(&mesh, light(0), [33, 17], 1);
        case.camera.target = [0.3, 0.0, 0.3];
        let (found, sure) = check(gpu(), &case, count);
        assert!(sure > 0 && found.covered.keys().all(|&(_, t)| t == 0), "{sure} samples");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for n in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, n.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [5, 4], 8), 16);
    }
}

#[gpu_test]
fn random_seeded() {
    for name in MESHES {
        for (seed, count) in [(0, 32), (1, 128)] {
            let (_, sure) = check(gpu(), &Case::new(&mesh(name, seed), light(seed), [61, 45], 8), count);
            assert!(sure > 100, "{name}: {sure} samples");
        }
    }
}

/// Alpha-tested triangles cover the samples at which they are solid.
#[gpu_test]
fn holes_cover_nothing() {
    let whole = Case::new(&mesh("closed balls", 2), light(0), [61, 45], 8);
    let case = whole.clone().with_holes();
    let (found, sure) = check(gpu(), &case, 32);
    let (all, more) = check(gpu(), &whole, 32);
    assert!(sure > 1000 && sure < more, "{sure} of {more} samples");
    assert!(compare(&case, &all, &pattern(32)).is_err() && found.covered != all.covered, "holes do not matter");
}

/// Through the near plane, behind the camera, huge.
#[gpu_test]
fn degenerate() {
    for seed in 0..3 {
        let mut case = Case::new(&mesh("huge", seed), light(0), [61, 45], 8);
        (case.camera.eye, case.camera.target) = ([0.2, 0.6, 0.3], [0.6, 0.1, -1.0]);
        for near in [1e-1, 1e-3] {
            (case.camera.near, case.camera.far) = (near, 1e9);
            check(gpu(), &case, 32);
        }
    }
}

/// Triangles before an oblique near plane cover nothing, whether that cuts triangles or hides all in a part of the image.
#[gpu_test]
fn an_oblique_near_plane() {
    for (name, seed) in [("closed balls", 2), ("huge", 1)] {
        for (share, tilt) in [(1.0, [0.4, 0.3, -0.2]), (0.9, [-2.0, 0.5, 1.0])] {
            let mut case = Case::new(&mesh(name, seed), light(0), [61, 45], 8);
            case.camera.near_plane = oblique(&case.camera, share, tilt);
            let (found, sure) = check(gpu(), &case, 32);
            assert!(sure > 100, "{name}, {share}: {sure} samples");
            case.camera.near_plane = None;
            assert!(compare(&case, &found, &pattern(32)).is_err(), "{name}, {share}: the plane hides nothing");
        }
    }
}

/// Nothing is written past the end (see `find_within`), and what has room is right.
#[gpu_test]
fn overflow_by_one() {
    let case = Case::new(&mesh("closed balls", 3), light(0), [31, 23], 8);
    let samples = pattern(32);
    let all = find(gpu(), &case, &samples);
    for room in [0, 1, all.needed[0] - 1, all.needed[0]] {
        let found = find_within(gpu(), &case, &samples, [room, all.needed[1], all.needed[2]], 1);
        assert!(found.covered.iter().all(|(at, (mask, _))| all.covered[at].0 == *mask), "room {room}");
        assert!(found.covered.len() <= room && (room < all.needed[0] || found.covered.len() == all.covered.len()));
    }
}

/// Pairs that an older frame left in the list, at places of other pixels, are passed over: nothing else changes.
#[gpu_test]
fn stale_pairs_cover_nothing() {
    let case = Case::new(&mesh("closed balls", 3), light(0), [31, 23], 8);
    let samples = pattern(32);
    let all = find(gpu(), &case, &samples);
    let stale: Vec<(u32, u32)> = all.covered.keys().copied().step_by(7).collect();
    assert!(stale.len() > 50, "{} pairs", stale.len());
    let found = find_with_stale(gpu(), &case, &samples, all.needed, &stale);
    let wanted = all.covered.iter().filter(|(at, _)| !stale.contains(at));
    assert!(found.covered.iter().map(|(at, c)| (at, c.0)).eq(wanted.map(|(at, c)| (at, c.0))), "another coverage");
    assert_eq!(found.covered.len() + stale.len(), all.covered.len());
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(24, 1 << 24);
    let mut dense = Mesh::default();
    ball(&mut dense, DVec3::ZERO, 1.0, 30, 20);
    let case = Case::new(&dense, light(0), [60, 40], 8);
    let (found, _) = check(&small, &case, 32);
    assert!(found.covered == find(gpu(), &case, &pattern(32)).covered, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [49, 37], 8);
    let samples = pattern(32);
    let (found, sure) = check(gpu(), &case, 32);
    assert!(sure > 1000, "{sure} samples");
    // One that covers several samples, far from any edge at one of them.
    let (&key, _) = found.covered.iter().max_by_key(|(_, (mask, _))| mask.count_ones()).expect("one that covers");
    let broken = |change: &dyn Fn(&mut Found)| {
        let mut found = found.clone();
        change(&mut found);
        compare(&case, &found, &samples).is_err()
    };
    assert!(!broken(&|_| {}));
    assert!(broken(&|f| f.covered.get_mut(&key).expect("it").0 = 0), "samples are missing");
    assert!(broken(&|f| f.covered.get_mut(&key).expect("it").0 |= 1 << 100), "a sample too many");
    assert!(broken(&|f| f.covered.retain(|at, _| *at != key)), "a triangle is missing");
    assert!(broken(&|f| f.covered.get_mut(&key).expect("it").1.high *= 0.99), "a lower upper bound");
    assert!(broken(&|f| f.covered.get_mut(&key).expect("it").1.low *= 1.01), "a higher lower bound");
    assert!(broken(&|f| f.covered.extend([((u32::MAX, 0), found.covered[&key])])), "one that is not listed");
}
