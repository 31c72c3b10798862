//! Blocks of the light's map that facets ask for, against `f64`: those that the exact outlines touch, and none beyond what they touch at four times
//! the margin and a hundredth of their size more. Facets whose state or outline rounding may turn are left out of the lists.

use crate::support::shadow::{World, camera, folding_gpu, random_light, random_scene, samples, unit, vector};
use crate::support::{Random, gpu, sizes_around};
use oracle::reference::facet_classify::{FacetAtPixel, MapAround, classify};
use oracle::reference::front_layer::Margin;
use oracle::reference::requested_blocks::blocks_of;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;
use test_support::gpu_test;

const WAS_SETTLED: u32 = 16;
const WAS_HELD: u32 = 32;

type Listed = Vec<(u32, Option<u32>)>;

/// The facets as they are defined, none settled, with so many margins.
fn defined(world: &World, listed: &[(u32, Option<u32>)], times: f64) -> Vec<FacetAtPixel> {
    within(world, listed, world.margin().times(times))
}

fn within(world: &World, listed: &[(u32, Option<u32>)], margin: Margin) -> Vec<FacetAtPixel> {
    let marked = vec![true; (world.view.map.map_size as usize).pow(2)];
    let (casters, samples) = (world.frame.triangle_count, world.samples.offsets());
    let around = MapAround { triangles: &world.triangles, marked: &marked, splits: &[], samples, casters };
    classify(&world.view, &around, listed, margin, false)
}

/// Facets of which it is certain what they ask.
fn certain(world: &World, listed: Listed) -> Listed {
    let defined = defined(world, &listed, 1.0);
    // Next to the light a little more of the pixel reaches far.
    let near = |facet: &FacetAtPixel| facet.outline.blurred.iter().any(|(_, off)| *off > 1.0);
    listed.into_iter().zip(defined).filter(|(_, facet)| !facet.open && !near(facet)).map(|(part, _)| part).collect()
}

fn rects(facets: &[FacetAtPixel]) -> Vec<[u32; 4]> {
    facets.iter().filter_map(|facet| facet.rect).collect()
}

/// A rectangle with a hundredth of its size, and a texel, to every side.
fn grown([x0, y0, x1, y1]: [u32; 4], size: u32) -> [u32; 4] {
    let [x, y] = [x1 - x0, y1 - y0].map(|d| d / 100 + 1);
    [x0.saturating_sub(x), y0.saturating_sub(y), (x1 + x).min(size - 1), (y1 + y).min(size - 1)]
}

/// The first fault of the words that were written for these facets, and how many blocks are requested.
fn fault(world: &World, listed: &[(u32, Option<u32>)], words: &[u32]) -> (Option<String>, usize) {
    let size = world.view.map.map_size;
    let least = blocks_of(rects(&defined(world, listed, 0.0)), size);
    // A little more of the pixel than of which they are defined.
    let wide = world.margin().times(4.0);
    let wide = Margin { texels: wide.texels + 0.25, ..wide };
    let most = blocks_of(rects(&within(world, listed, wide)).into_iter().map(|rect| grown(rect, size)), size);
    let across = size.div_ceil(8) as usize;
    if words.len() != RequestedBlocks::words(size as usize) || words[0] != 1 {
        return (Some(format!("{} words, the first {}", words.len(), words[0])), 0);
    }
    let mut count = 0;
    for (k, word) in words[1..].iter().enumerate() {
        let (row, first) = (k / across.div_ceil(32), k % across.div_ceil(32) * 32);
        for bit in 0..32 {
            let (asked, x) = (word >> bit & 1 == 1, first + bit);
            let [must, may] = [&least, &most].map(|blocks| x < across && blocks[row * across + x]);
            if (must && !asked) || (asked && !may) {
                return (Some(format!("block {x}, {row}: {asked}, from {must} to {may} expected")), 0);
            }
            count += usize::from(asked);
        }
    }
    (None, count)
}

/// How many blocks are requested.
#[track_caller]
fn check(world: &World, listed: Listed) -> usize {
    let listed = certain(world, listed);
    let words = world.request(&listed, listed.len(), 0);
    let (fault, count) = fault(world, &listed, &words);
    assert_eq!(fault, None, "{} facets, a map of {}", listed.len(), world.view.map.map_size);
    count
}

fn world_on(gpu: &'static Gpu, map: u32, random: &mut Random) -> World {
    let mesh = random_scene(1, random);
    let eye = DVec3::new(1.0, 1.2, 2.0);
    let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
    World::new(gpu, &mesh, camera(eye, eye * 0.0, 50.0), light, [24, 18], map, samples(32))
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(1);
    let world = world_on(gpu(), 40, &mut random);
    assert_eq!(check(&world, Vec::new()), 0);
    assert_eq!(check(&world, vec![(0, None), (7, None)]), 0);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(2);
    for map in [1, 7, 8, 9, 255, 256, 257, 600] {
        let world = world_on(gpu(), map, &mut random);
        let asks = world.seen().into_iter().find(|&part| !rects(&defined(&world, &[part], 1.0)).is_empty());
        assert!(check(&world, vec![asks.expect("a facet that asks")]) > 0);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(4);
    let world = world_on(gpu(), 300, &mut random);
    let seen = world.seen();
    for size in sizes_around(64) {
        check(&world, seen[..size].to_vec());
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(5);
    let mut parts = 0;
    for round in 0..40 {
        let mesh = random_scene(round, &mut random);
        let eye = vector(&mut random).normalize() * (0.5 + 2.5 * unit(&mut random));
        let light = random_light(random.below(2) == 0, &mut random);
        let (count, map) = ([32, 8, 128][random.below(3) as usize], [40, 130, 512][random.below(3) as usize]);
        let camera = camera(eye, vector(&mut random) * 0.3, 50.0);
        let mut world = World::new(gpu(), &mesh, camera, light, [24, 18], map, samples(count));
        if round % 5 == 4 {
            // The last of them cast nothing.
            let all = world.frame.triangle_count;
            world.frame.triangle_count = random.below(all);
        }
        let listed = if round % 2 == 0 { world.seen() } else { world.anything(300, &mut random) };
        let asked = check(&world, listed);
        parts += usize::from(asked > 0 && asked < map.div_ceil(8).pow(2) as usize / 2);
    }
    assert!(parts > 10, "{parts} of 40 ask for a part of the map");
}

/// Of several views those after the first are not asked by what is settled or held already; and what faces away asks for nothing.
#[gpu_test]
fn what_asks_nothing() {
    let mut random = Random::new(6);
    let mut world = world_on(gpu(), 200, &mut random);
    let listed = certain(&world, world.seen());
    let first = world.request(&listed, listed.len(), WAS_SETTLED | WAS_HELD);
    assert_eq!(fault(&world, &listed, &first).0, None, "the first view");
    world.frame.flags |= Frame::FURTHER_VIEW;
    for (state, asks) in [(0, true), (WAS_SETTLED, false), (WAS_HELD, false)] {
        let words = world.request(&listed, listed.len(), state);
        assert_eq!(words[1..].iter().any(|w| *w != 0), asks, "state {state}");
    }
    world.frame.flags &= !Frame::FURTHER_VIEW;
    world.frame.light = world.frame.light.map(|c| -c);
    let words = world.request(&listed, listed.len(), 0);
    assert!(words[1..] != first[1..], "the light from the other side");
}

/// A facet that reaches behind the light asks for the whole map, of a large one by a word for all.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(3);
    for (map, whole) in [(64, 1), (2048, 0)] {
        let mut found = None;
        for round in 0..40 {
            let mesh = random_scene(round, &mut random);
            let eye = vector(&mut random).normalize() * 2.0;
            let position = (vector(&mut random) * 0.2).as_vec3().into();
            let light = Light::Spot { position, target: [0.3, 0.2, 5.0], angle_degrees: 60.0 };
            let world = World::new(gpu(), &mesh, camera(eye, eye * 0.1, 60.0), light, [24, 18], map, samples(16));
            let listed = world.anything(300, &mut random);
            let behind = |facet: &FacetAtPixel| !facet.open && !facet.outline.known && facet.rect.is_some();
            let at = defined(&world, &listed, 1.0).iter().position(behind);
            if let Some(k) = at {
                found = Some((world, listed[k]));
                break;
            }
        }
        let (world, part) = found.expect("a facet that reaches behind the light");
        let words = world.request(&[part], 1, 0);
        assert_eq!(words[0], whole, "a map of {map}");
        if whole == 1 {
            assert_eq!(fault(&world, &[part], &words).0, None);
            assert!(words[1..].iter().all(|w| *w == 0xff), "{words:x?}");
        }
    }
}

/// A facet behind the last asks for nothing, and no word behind the last is touched.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(7);
    let world = world_on(gpu(), 120, &mut random);
    let listed = certain(&world, world.seen());
    for count in [63, 64, 65] {
        let part = world.request(&listed, count, 0);
        assert_eq!(fault(&world, &listed[..count], &part).0, None);
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(8);
    let world = world_on(folding_gpu(), 120, &mut random);
    check(&world, world.seen());
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(9);
    let world = world_on(gpu(), 300, &mut random);
    let listed = certain(&world, world.seen());
    let words = world.request(&listed, listed.len(), 0);
    assert_eq!(fault(&world, &listed, &words).0, None);
    let k = 1 + words[1..].iter().position(|w| *w != 0).expect("a block");
    type Spoil = fn(u32) -> u32;
    let spoils: [(&str, Spoil); 3] =
        [("a block is missing", |w| w & (w - 1)), ("a block too many", |w| w ^ 1 << 31), ("all of them", |_| u32::MAX)];
    for (what, spoil) in spoils {
        let mut wrong = words.clone();
        wrong[k] = spoil(wrong[k]);
        assert!(fault(&world, &listed, &wrong).0.is_some(), "{what} passes");
    }
    let all = [vec![0], words[1..].to_vec()].concat();
    assert!(fault(&world, &listed, &all).0.is_some(), "everything passes");
}
