//! Lists of triangles by pixel, against `f64`: every triangle that a place in the pixel sees is listed, none that stays
//! away from the pixel; a pixel passes for single only if every place of it sees its one triangle.

use crate::support::geometry::{Case, MESHES, add, ball, light, mesh};
use crate::support::surfaces::{Found, find, find_within, pattern, square};
use crate::support::{gpu, small_gpu};
use oracle::reference::camera_visibility::DepthMargin;
use oracle::reference::pixel_triangles::{may_touch, pixels};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::Mesh;
use test_support::gpu_test;

/// The first block of 8 x 8 pixels whose key is not the least of theirs: 0 where one is not hidden.
fn wrong_block(found: &Found) -> Option<usize> {
    let [width, height] = found.image.map(|n| n as usize);
    let (pixels, blocks) = found.cover_keys.split_at(width * height);
    let across = width.div_ceil(8);
    (0..across * height.div_ceil(8)).find(|block| {
        let (x, y) = (block % across * 8, block / across * 8);
        let rows = (y..height.min(y + 8)).map(|row| &pixels[row * width..][x..width.min(x + 8)]);
        blocks[*block] != rows.flatten().copied().min().unwrap_or(0)
    })
}

/// Where the stage departs from its definition, else how many pixels are single.
fn compare(case: &Case, found: &Found) -> Result<usize, String> {
    let wanted = case.wanted();
    let places: Vec<DVec2> = (0..49).map(|k| DVec2::new(f64::from(k % 7) / 6.0, f64::from(k / 7) / 6.0)).collect();
    let must = pixels(&wanted.view, &wanted.triangles, &places, DepthMargin { edge: 1e-4, depth: 1e-5 });
    if must.len() != found.lists.len() {
        return Err("another number of pixels".to_owned());
    }
    if let Some(block) = wrong_block(found) {
        return Err(format!("block {block} is not hidden as its pixels are"));
    }
    let mut singles = 0;
    for (pixel, (must, listed)) in must.iter().zip(&found.lists).enumerate() {
        let (x, y) = (pixel as u32 % case.image[0], pixel as u32 / case.image[0]);
        if let Some(t) = must.seen.iter().find(|t| listed.binary_search(t).is_err()) {
            return Err(format!("pixel {x} {y} sees triangle {t}, which is not listed"));
        }
        if listed.windows(2).any(|w| w[0] == w[1]) {
            return Err(format!("pixel {x} {y} lists a triangle twice"));
        }
        if let Some(t) = listed
            .iter()
            .find(|&&t| wanted.triangles.get(t as usize).is_none_or(|triangle| !may_touch(triangle, x, y, 0.25)))
        {
            return Err(format!("pixel {x} {y} lists triangle {t}, which is elsewhere"));
        }
        let single = !listed.is_empty() && !found.complex[pixel];
        singles += usize::from(single);
        if single && (listed.len() != 1 || must.open || must.seen != *listed) {
            return Err(format!("pixel {x} {y} passes for single with {listed:?}, sees {:?}", must.seen));
        }
        if listed.is_empty() && found.complex[pixel] {
            return Err(format!("pixel {x} {y} is complex with no triangle"));
        }
    }
    Ok(singles)
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> (Found, usize) {
    let found = find(gpu, case, &pattern(8));
    match compare(case, &found) {
        Ok(singles) => (found, singles),
        Err(text) => panic!("image {:?}: {text}", case.image),
    }
}

#[gpu_test]
fn empty() {
    let (found, _) = check(gpu(), &Case::new(&Mesh::default(), light(0), [5, 3], 1));
    assert!(found.lists.iter().all(Vec::is_empty) && !found.complex.contains(&true));
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for image in [[1, 1], [3, 1], [65, 33]] {
        let mut case = Case::new(&mesh, light(0), image, 1);
        case.camera.target = [0.3, 0.0, 0.3];
        let (_, singles) = check(gpu(), &case);
        assert!(singles > 20 || image[0] < 65, "{singles} pixels are single");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in [1, 2, 3, 7, 8, 9, 15, 16, 17, 63, 64, 65] {
        check(gpu(), &Case::new(&mesh("closed balls", size), light(0), [size as u32, 2 * size as u32 + 1], 8));
    }
}

#[gpu_test]
fn random_seeded() {
    for name in MESHES {
        for seed in 0..2 {
            check(gpu(), &Case::new(&mesh(name, seed), light(seed), [83, 61], 8));
        }
    }
}

/// A flat square of two triangles: all pixels inside are single but those that a line crosses. And the near plane.
#[gpu_test]
fn degenerate() {
    let mut case = Case::new(&square(1), light(0), [64, 64], 8);
    (case.camera.eye, case.camera.target, case.camera.up) = ([0.0, 2.5, 0.0], [0.0; 3], [0.0, 0.0, -1.0]);
    case.camera.vertical_fov_degrees = 30.0;
    let (found, singles) = check(gpu(), &case);
    assert_eq!(found.lists.iter().filter(|l| l.is_empty()).count(), 0, "the square fills the view");
    assert!(singles >= 64 * 64 - 3 * 64, "{singles} pixels are single");
    for seed in 0..4 {
        let mut case = Case::new(&mesh("huge", seed), light(0), [61, 43], 8);
        check(gpu(), &case);
        (case.camera.eye, case.camera.target) = ([0.2, 0.6, 0.3], [0.6, 0.1, -1.0]);
        for near in [1e-1, 1e-3] {
            (case.camera.near, case.camera.far) = (near, 1e9);
            check(gpu(), &case);
        }
    }
}

/// The list keeps counting beyond its room, and what is written is right.
#[gpu_test]
fn overflow_by_one() {
    let case = Case::new(&mesh("leaves", 3), light(0), [31, 23], 8);
    let all = find(gpu(), &case, &pattern(8));
    for room in [0, 1, all.needed[0] - 1, all.needed[0]] {
        let found = find_within(gpu(), &case, &pattern(8), [room, all.needed[1], all.needed[2]], 1);
        assert_eq!(found.needed[0], all.needed[0]);
        assert_eq!(found.complex, all.complex);
        for (part, whole) in found.lists.iter().zip(&all.lists) {
            assert!(part.iter().all(|t| whole.binary_search(t).is_ok()) && part.len() <= whole.len());
        }
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(24, 1 << 24);
    let mut dense = Mesh::default();
    ball(&mut dense, DVec3::ZERO, 1.0, 40, 30);
    let case = Case::new(&dense, light(0), [130, 70], 8);
    let (found, _) = check(&small, &case);
    // Of the samples not all are looked at: they need more workgroups than this device can run.
    let all = find(gpu(), &case, &pattern(8));
    assert!(found.lists == all.lists && found.complex == all.complex, "the fold changes the result");
}

/// Blocks of a wall that covers the image are hidden, but for those on its diagonal: the ball behind is listed at none of their pixels.
#[gpu_test]
fn a_wall_hides_blocks() {
    let mut mesh = square(1);
    ball(&mut mesh, DVec3::new(0.0, -1.0, 0.0), 0.4, 20, 12);
    let mut case = Case::new(&mesh, light(0), [45, 37], 8);
    (case.camera.eye, case.camera.target, case.camera.up) = ([0.0, 1.0, 0.0], [0.0; 3], [0.0, 0.0, -1.0]);
    case.camera.vertical_fov_degrees = 50.0;
    let (found, _) = check(gpu(), &case);
    let hidden = |x: usize, y: usize| found.cover_keys[45 * 37 + y / 8 * 6 + x / 8] != 0;
    let count = (0..37).flat_map(|y| (0..45).map(move |x| (x, y))).filter(|&(x, y)| hidden(x, y));
    let lists = count.map(|(x, y)| found.lists[y * 45 + x].len()).collect::<Vec<_>>();
    assert!(lists.len() > 800 && lists.iter().all(|&n| n == 1), "{} pixels in hidden blocks", lists.len());
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("leaves", 5), light(0), [99, 77], 8);
    let (found, singles) = check(gpu(), &case);
    assert!(singles > 10, "{singles} pixels are single");
    let complex = found.complex.iter().position(|&c| c).expect("a complex pixel");
    let single =
        (0..found.lists.len()).find(|&p| found.lists[p].len() == 1 && !found.complex[p]).expect("a single one");
    let broken = |change: &dyn Fn(&mut Found)| {
        let mut found = found.clone();
        change(&mut found);
        compare(&case, &found).is_err()
    };
    assert!(!broken(&|_| {}));
    assert!(broken(&|f| f.lists[single].clear()), "a triangle is missing");
    assert!(broken(&|f| f.lists[single].push(u32::MAX)), "no such triangle");
    assert!(broken(&|f| f.lists[complex].extend_from_within(..1)), "a triangle twice");
    assert!(broken(&|f| f.complex[complex] = false), "a complex pixel passes for single");
    let block = found.image[0] as usize * found.image[1] as usize;
    assert!(broken(&|f| f.cover_keys[block] ^= 1), "another key of a block");
    assert!(broken(&|f| drop(f.lists.pop())), "a pixel is missing");
}
