//! Facets and their states against their definition, and settled ones against rays.

mod settled;

use crate::support::masks::mask_of;
use crate::support::shadow::{World, camera, folding_gpu, random_light, random_scene, samples, soup, unit, vector};
use crate::support::{Random, assert_same, gpu, poisoned, run, sizes_around, upload};
use oracle::reference::facet_classify::{self as reference, FacetState, MapAround, classify, pixel_ray};
use oracle::reference::front_layer::{Margin, Split};
use oracle::reference::view::block_count;
use oracle::truth::Tracer;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::facet_classify::{Facet, FacetClassify, Facets, Undecided};
use test_support::gpu_test;

const STATES: [FacetState; 5] =
    [FacetState::Empty, FacetState::Dark, FacetState::Lit, FacetState::Shadowed, FacetState::Undecided];

/// What the GPU made of a list.
struct Got {
    facets: Vec<Facet>,
    undecided: Vec<Undecided>,
    masks: Vec<u32>,
    items: Vec<u32>,
}

fn read(gpu: &Gpu, facets: &Facets) -> Got {
    Got {
        facets: facets.list.read(gpu).expect("readback"),
        masks: facets.masks.read(gpu).expect("readback"),
        undecided: facets.undecided.read(gpu).expect("readback"),
        items: facets.items.read_first(gpu, facets.list.len()).expect("readback"),
    }
}

fn rect(packed: [u32; 2]) -> [u32; 4] {
    [packed[0] & 0xffff, packed[0] >> 16, packed[1] & 0xffff, packed[1] >> 16]
}

fn within(inner: Option<[u32; 4]>, outer: Option<[u32; 4]>) -> bool {
    match (inner, outer) {
        (None, _) => true,
        (Some(i), Some(o)) => i[0] >= o[0] && i[1] >= o[1] && i[2] <= o[2] && i[3] <= o[3],
        _ => false,
    }
}

/// What is wrong with each facet, and how many were open to rounding.
fn faults(world: &World, listed: &[(u32, Option<u32>)], marked: &[bool], splits: &[Split], got: &Got) -> Vec<String> {
    let (casters, samples) = (world.frame.triangle_count, world.samples.offsets());
    let around = MapAround { triangles: &world.triangles, marked, splits, samples, casters };
    let m = world.margin();
    let by = |times: f64| classify(&world.view, &around, listed, m.times(times), world.frame.flags & 8 == 0);
    let (exact, wide) = (by(0.0), by(2.0));
    let same = by(1.0);
    let words = world.words();
    let mut out = Vec::new();
    let mut open = 0;
    for (k, (facet, more)) in got.facets.iter().zip(&got.undecided).enumerate() {
        let mut fault = |what: String| out.push(format!("facet {k} of {:?}: {what}", listed[k]));
        let wanted = [&exact[k], &same[k], &wide[k]];
        let Some(&state) = STATES.get(facet.state as usize) else {
            fault(format!("state {}", facet.state));
            continue;
        };
        let undecided = state == FacetState::Undecided;
        let items = if undecided { block_count(Some(rect(more.rect))) } else { 0 };
        if got.items[k] != items {
            fault(format!("{} items, {items} expected", got.items[k]));
        }
        let mask = |part: usize| mask_of(&got.masks, words, k, part);
        if mask(1) != 0 || mask(2) != 0 {
            fault("occluded and invalid are not cleared".into());
        }
        let dark = same[k].state == FacetState::Dark;
        if !same[k].open_side && dark != (state == FacetState::Dark) {
            fault(format!("{state:?}, expected {:?}", same[k].state));
            continue;
        }
        if same[k].open {
            open += 1;
            continue;
        }
        if !wanted.iter().any(|w| w.state == state) {
            fault(format!("{state:?}, expected {:?}", wanted.map(|w| w.state)));
            continue;
        }
        if undecided {
            if (more.pixel, more.triangle, more.origin) != (facet.pixel, facet.triangle, facet.origin) {
                fault(format!("pixel {}, triangle {}, origin {:?}", more.pixel, more.triangle, more.origin));
            }
            if !within(exact[k].rect, Some(rect(more.rect))) || !within(Some(rect(more.rect)), wide[k].rect) {
                fault(format!("rect {:?}, {:?} to {:?} expected", rect(more.rect), exact[k].rect, wide[k].rect));
            }
            let (n, p) = (same[k].plane.truncate().normalize(), more.plane.map(f64::from));
            let told = DVec3::new(p[0], p[1], p[2]);
            // Along what is seen of it and across: by each component's own rounding, and that of the comparison.
            let shares = DVec3::from([0, 8, 16].map(|k| f64::from(more.tilts >> k & 255) / 255.0));
            let tilts = f64::from(more.tilt.abs()) * shares / told.length();
            let off = (n - told.normalize()).abs();
            if off.cmpgt(2f64.powi(-24) * (tilts + 2.0 * (tilts.length() + 1.0) * n.abs() + 1e-3)).any() {
                fault(format!("plane is off by {off}, told {tilts}"));
            }
            misplaced(world, &exact[k], more).into_iter().for_each(&mut fault);
        }
        if matches!(state, FacetState::Undecided | FacetState::Lit)
            && (mask(0) ^ same[k].coverage) & !same[k].open_coverage != 0
        {
            fault(format!("coverage {:x}, {:x} expected", mask(0), same[k].coverage));
        }
    }
    // Where the light grazes everything, all but the side may be open.
    let grazing = world.samples.count() == 16;
    if open * 20 > listed.len() + 40 && !grazing {
        out.push(format!("{open} of {} facets are open to rounding", listed.len()));
    }
    out
}

/// What is wrong with the places and depths that evaluation is told of a facet.
fn misplaced(world: &World, exact: &reference::FacetAtPixel, told: &Undecided) -> Vec<String> {
    let mut out = Vec::new();
    let m = world.margin();
    let (plane, at) = (exact.plane, DVec3::from(told.at.map(f64::from)));
    let ray = pixel_ray(&world.view, told.pixel, DVec2::from(told.origin.map(f64::from)));
    let n = plane.truncate();
    // Half a unit of the last place of what it is found from, in each component.
    let off = (n.dot(at) - plane.w).abs() / n.length();
    let slant = at.length() * n.length() / n.dot(at).abs();
    if off > 1e-6 * at.length().max(1e-3) || at.cross(ray).length() > 1e-6 * slant * at.length() * ray.length() {
        out.push(format!("at {at} is {off} off its plane, on {ray}"));
    }
    let reach = 4.0 * at.dot(world.view.rays.forward);
    if f64::from(told.limit) < reach * (1.0 - 1e-4) {
        out.push(format!("the plane is followed to {}, not to {reach}", told.limit));
    }
    let outline = &exact.outline;
    if !outline.in_front || outline.open {
        return out;
    }
    let corner = |low: bool| outline.corners.iter().copied().reduce(|a, b| if low { a.min(b) } else { a.max(b) });
    let (Some(least), Some(most)) = (corner(true), corner(false)) else { return out };
    let [low, high] = [told.box_low, told.box_high].map(|p| DVec2::from(p.map(f64::from)));
    let wide = DVec2::splat(4.0 * m.texels + 1e-3 + 1e-5 * (most - least).max_element());
    if !(low.cmple(least).all()
        && high.cmpge(most).all()
        && low.cmpge(least - wide).all()
        && high.cmple(most + wide).all())
    {
        out.push(format!("box {low} to {high}, {least} to {most} expected"));
    }
    let farthest = f64::from(told.farthest);
    // Of what casts nothing the margin is added already, for how far it reaches beyond the casters.
    let beyond = told.triangle >= world.frame.triangle_count;
    let over = m.depth * if beyond { 8.0 } else { 1.0 };
    // Casters lie up to depth 1: how much farther away a facet is does not matter.
    let (told_of, expected) = (farthest.min(1.0), outline.farthest.min(1.0));
    if told_of < expected - m.depth || told_of > expected + over {
        out.push(format!("farthest {farthest}, {} expected", outline.farthest));
    }
    // What the slopes say of the corners.
    let [per_x, per_y, at_zero, noise] = told.slope.map(f64::from);
    let depth = |p: &DVec2| per_x * p.x + per_y * p.y + at_zero;
    let deepest = outline.corners.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
    if (deepest - outline.farthest).abs() > noise + m.depth {
        out.push(format!("by its slopes {deepest} away, {} expected, {noise} allowed", outline.farthest));
    }
    out
}

/// Marks and splits of no particular meaning.
fn any_map(world: &World, marks: u32, random: &mut Random) -> (Vec<bool>, Vec<Split>) {
    let texels = (world.view.map.map_size as usize).pow(2);
    let marked: Vec<bool> = (0..texels).map(|_| random.below(100) < marks).collect();
    let split = |&m: &bool| match random.below(5) {
        _ if m => Split::Marked,
        0 => Split::Uncovered,
        1 => Split::At(f64::INFINITY),
        _ => Split::At(unit(random)),
    };
    let splits = marked.iter().map(split).collect();
    (marked, splits)
}

#[track_caller]
fn check(world: &World, listed: &[(u32, Option<u32>)], marks: u32, random: &mut Random) {
    let (marked, splits) = any_map(world, marks, random);
    let facets = world.classify(listed, &marked, &splits);
    let found = faults(world, listed, &marked, &splits, &read(world.gpu, &facets));
    assert!(found.is_empty(), "{} of {}: {}", found.len(), listed.len(), found[..found.len().min(5)].join("\n"));
}

fn world(gpu: &'static Gpu, kind: u32, random: &mut Random) -> World {
    let mesh = random_scene(kind, random);
    let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
    let light = random_light(random.below(2) == 0, random);
    let count = [32, 8, 128][random.below(3) as usize];
    World::new(gpu, &mesh, camera(eye, vector(random) * 0.3, 50.0), light, [24, 18], 40, samples(count))
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(1);
    let world = world(gpu(), 0, &mut random);
    check(&world, &[], 10, &mut random);
    check(&world, &[(0, None), (7, None), (8, None)], 10, &mut random);
}

/// The list of one facet a pixel.
#[gpu_test]
fn one() {
    for (words, count) in [(1, 32), (1, 8), (2, 64), (4, 128)] {
        let stage = FacetClassify::new(&gpu().device, words);
        for [w, h] in [[1, 1], [3, 5], [16, 12]] {
            let pixels = w * h;
            let mut world = world(gpu(), 0, &mut Random::new(2));
            (world.frame.image_size, world.frame.sample_count) = ([w as u32, h as u32], count);
            let keys = Random::new(3).list(pixels, 1000);
            let facets = Facets::new(&gpu().device, pixels, pixels, words as usize).expect("memory");
            let pixel_facets = poisoned(gpu(), pixels + 1);
            let facets = Facets { pixel_facets, ..facets };
            let frame = crate::support::shadow::uniform(gpu(), &world.frame);
            let id_keys = upload(gpu(), &keys);
            run(gpu(), |s| stage.record_one(s, &frame, &id_keys, &facets));
            let list = facets.list.read(gpu()).expect("readback");
            let made: Vec<_> = list.iter().map(|f| (f.pixel, f.triangle)).collect();
            let wanted: Vec<_> = keys.iter().enumerate().map(|(k, key)| (k as u32, !key)).collect();
            assert_same("facets", &made, &wanted);
            let firsts: Vec<u32> = (0..=pixels as u32).collect();
            assert_same("pixel_facets", &facets.pixel_facets.read(gpu()).expect("readback"), &firsts);
            let masks = facets.masks.read(gpu()).expect("readback");
            let full = |w: u32| crate::support::shadow::full_word(count, w);
            for coverage in masks.chunks(3 * words as usize) {
                assert_same("coverage", &coverage[..words as usize], &(0..words).map(full).collect::<Vec<_>>());
            }
        }
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(4);
    let world = world(gpu(), 1, &mut random);
    let seen = world.seen();
    for size in sizes_around(64) {
        check(&world, &seen[..size], 5, &mut random);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(5);
    for round in 0..48 {
        let world = world(gpu(), round, &mut random);
        check(&world, &world.seen(), [0, 1, 10, 100][random.below(4) as usize], &mut random);
    }
}

/// Triangles behind those of the casters, in maps of all kinds: settled by every texel of their rectangles, or by lying nearer
/// to the light than any caster.
#[gpu_test]
fn what_only_receives() {
    let mut random = Random::new(1);
    let mut states = [0; 5];
    for round in 0..24 {
        let mut world = world(gpu(), round, &mut random);
        let all = world.frame.triangle_count;
        world.frame.triangle_count = if round % 3 == 0 { 0 } else { random.below(all) };
        if round % 4 == 3 {
            // As if the casters lay farther from the light.
            world.view.map.clear = world.view.map.near * 4.0 * unit(&mut random);
            world.frame.eye_low[3] = world.view.map.clear as f32;
        }
        let listed = if round % 2 == 0 { world.seen() } else { world.anything(400, &mut random) };
        check(&world, &listed, [0, 1, 10][random.below(3) as usize], &mut random);
        let texels = (world.view.map.map_size as usize).pow(2);
        // One sheet, or none, over all of the map.
        for split in [Split::At(0.0), Split::At(0.4), Split::At(2.0), Split::Uncovered] {
            let (marked, splits) = (vec![false; texels], vec![split; texels]);
            let got = read(gpu(), &world.classify(&listed, &marked, &splits));
            let found = faults(&world, &listed, &marked, &splits, &got);
            assert!(found.is_empty(), "{}: {}", found.len(), found[..found.len().min(5)].join("\n"));
            got.facets.iter().for_each(|f| states[f.state as usize] += 1);
        }
    }
    assert!(states.iter().skip(1).all(|&n| n > 500), "{states:?}");
}

/// Light along a facet, behind the eye, in a triangle's plane; slivers; a floor up to the horizon.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(6);
    let floor = crate::support::shadow::sheet(1, 50.0, |_, _| 0.0, |p| p);
    let eye = subpixel_shadows::glam::DVec3::new(0.0, 0.3, 4.0);
    for elevation in [1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 0.0, -1e-3] {
        let light = Light::Directional { direction: [1.0, elevation, 0.2] };
        let world = World::new(gpu(), &floor, camera(eye, eye * 0.1, 60.0), light, [24, 18], 40, samples(16));
        check(&world, &world.seen(), 10, &mut random);
    }
    let slivers = {
        let mut mesh = soup(40, 0.8, &mut random);
        for t in 0..40 {
            let (a, b) = (mesh.positions[3 * t], mesh.positions[3 * t + 1]);
            mesh.positions[3 * t + 2] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + 1e-5 * k as f32);
        }
        mesh
    };
    let light = Light::Point { position: slivers.positions[7] };
    let world = World::new(gpu(), &slivers, camera(eye * 0.5, eye * 0.0, 60.0), light, [24, 18], 40, samples(32));
    check(&world, &world.seen(), 10, &mut random);
}

/// Facets nearer to a lamp than its view's nearest distance touch the texels that they may be in, not all of the map.
#[gpu_test]
fn next_to_the_light() {
    let mut random = Random::new(31);
    let (mut near, mut small) = (0, 0);
    for round in 0..24 {
        let mesh = soup(600, 0.05, &mut random);
        let light = Light::Point { position: (vector(&mut random) * 0.3).as_vec3().into() };
        // Of an eye far away rounding is large next to the lamp.
        let eye = vector(&mut random).normalize() * 60.0;
        let map = [130, 512, 1024][round % 3];
        let world = World::new(gpu(), &mesh, camera(eye, eye * 0.01, 2.0), light, [96, 72], map, samples(16));
        let listed = world.seen();
        check(&world, &listed, 100, &mut random);
        let marked = vec![true; (map as usize).pow(2)];
        let around = MapAround {
            triangles: &world.triangles,
            marked: &marked,
            splits: &[],
            samples: world.samples.offsets(),
            casters: world.frame.triangle_count,
        };
        for facet in reference::classify(&world.view, &around, &listed, world.margin(), false) {
            let Some([x0, y0, x1, y1]) = facet.rect.filter(|_| !facet.open && !facet.outline.in_front) else {
                continue;
            };
            near += 1;
            small += usize::from((x1 - x0 + 1) * (y1 - y0 + 1) < map * map / 16);
        }
    }
    assert!(near > 40 && small > 20, "{small} of {near} facets next to the light are small");
}

/// Small triangles far away, so nearly in a plane with the light, or with the eye, that the side is lost in the rounding of
/// single precision, but not in the vertices as given: dark and seen as `f64` says.
#[gpu_test]
fn sides_are_exact() {
    let mut random = Random::new(12);
    let (mut within, mut dark, mut total) = (0, 0, 0);
    for round in 0..24 {
        let light = vector(&mut random).normalize() * 6.0;
        let eye = vector(&mut random).normalize() * 4.0;
        let (eye, light) = (eye.as_vec3().as_dvec3(), light.as_vec3().as_dvec3());
        let mut mesh = soup(300, 1.0, &mut random);
        let size = 10f64.powi(-(round % 4) - 1);
        for t in 0..300 {
            let p = |k: usize| subpixel_shadows::glam::DVec3::from(mesh.positions[k].map(f64::from));
            let to = if round % 8 < 6 { light } else { eye };
            let (a, across) = (p(3 * t), vector(&mut random));
            let along = (to - a).normalize();
            mesh.positions[3 * t + 1] = (a + across * size).as_vec3().into();
            mesh.positions[3 * t + 2] = (a + (along + across * unit(&mut random)) * size).as_vec3().into();
        }
        let point = round % 2 == 0;
        let light = light.as_vec3().into();
        let light = if point { Light::Point { position: light } } else { Light::Directional { direction: light } };
        let world = World::new(gpu(), &mesh, camera(eye, eye * 0.0, 60.0), light, [24, 18], 40, samples(32));
        let listed: Vec<_> = (0..300u32).map(|t| (random.below(24 * 18), Some(t))).collect();
        let (marked, splits) = any_map(&world, 10, &mut random);
        let got = read(gpu(), &world.classify(&listed, &marked, &splits));
        let around = MapAround {
            triangles: &world.triangles,
            marked: &marked,
            splits: &splits,
            samples: &[[0.5, 0.5]],
            casters: u32::MAX,
        };
        let wanted = classify(&world.view, &around, &listed, world.margin(), true);
        for (k, facet) in wanted.iter().enumerate() {
            let Some([a, b, c]) = world.triangles[k].corners else { continue };
            if facet.open_side {
                continue;
            }
            let is_dark = facet.state == FacetState::Dark;
            assert_eq!(is_dark, got.facets[k].state == FacetState::Dark as u32, "round {round}, facet {k}");
            // What the roundings of three points make of the side.
            let to_light = world.view.light.truncate() - a * world.view.light.w;
            let reach = a.length() * ((b - a).length() + (c - a).length()) * to_light.length() / f64::from(1 << 24);
            within += usize::from(world.triangles[k].side.abs() < reach);
            dark += usize::from(is_dark);
            total += 1;
        }
    }
    assert!(within > 1000 && dark > 1000 && total - dark > 1000, "{within} within rounding, {dark} dark of {total}");
}

/// There is no list to overflow here: the last facet of a buffer with nothing behind it.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(7);
    let world = world(gpu(), 1, &mut random);
    let (marked, splits) = any_map(&world, 10, &mut random);
    let seen = world.seen();
    for count in [63, 64, 65] {
        let mut longer = world.classify(&seen[..count + 1], &marked, &splits);
        let whole = read(gpu(), &longer);
        // The same list, told to be one shorter: its last facet stays as it was.
        longer = world.classify(&seen[..count], &marked, &splits);
        let part = read(gpu(), &longer);
        assert_same("facets", &words_of(&part, count), &words_of(&whole, count));
    }
}

fn words_of(got: &Got, count: usize) -> Vec<u32> {
    let of = |f: usize| {
        let (facet, more) = (&got.facets[f], &got.undecided[f]);
        let rect = if facet.state == FacetState::Undecided as u32 { more.rect } else { [0; 2] };
        [facet.state, rect[0], rect[1], facet.pixel, facet.triangle]
    };
    (0..count).flat_map(of).collect()
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(8);
    let small = folding_gpu();
    let front = world_on(small, &mut random);
    check(&front, &front.seen(), 10, &mut random);
}

fn world_on(gpu: &'static Gpu, random: &mut Random) -> World {
    let mesh = random_scene(1, random);
    let eye = subpixel_shadows::glam::DVec3::new(1.0, 1.2, 2.0);
    let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
    World::new(gpu, &mesh, camera(eye, eye * 0.0, 50.0), light, [24, 18], 40, samples(32))
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(9);
    let world = world_on(gpu(), &mut random);
    let (marked, splits) = any_map(&world, 10, &mut random);
    let seen = world.seen();
    let facets = world.classify(&seen, &marked, &splits);
    let mut got = read(gpu(), &facets);
    let check = |got: &Got| faults(&world, &seen, &marked, &splits, got).len();
    assert_eq!(check(&got), 0);
    let around = MapAround {
        triangles: &world.triangles,
        marked: &marked,
        splits: &splits,
        samples: world.samples.offsets(),
        casters: world.frame.triangle_count,
    };
    let wanted: Vec<reference::FacetAtPixel> = classify(&world.view, &around, &seen, Margin::default(), true);
    let k = wanted.iter().position(|f| f.state == FacetState::Undecided && !f.open).expect("an undecided facet");
    got.undecided[k].rect[1] -= 1;
    got.undecided[k].rect[0] += 2;
    assert!(check(&got) > 0, "a shrunken rectangle passes");
    got = read(gpu(), &facets);
    got.facets[k].state = FacetState::Lit as u32;
    assert!(check(&got) > 0, "a wrong state passes");
    got = read(gpu(), &facets);
    got.masks[3 * k] ^= 4;
    assert!(check(&got) > 0, "a wrong coverage passes");
    type Spoil = fn(&mut Undecided);
    let wrong: [(&str, Spoil); 8] = [
        ("a place off the plane", |u| u.at = u.at.map(|x| 1.01 * x)),
        ("a place off its ray", |u| u.at[0] += 0.01),
        ("a near limit", |u| u.limit *= 0.5),
        ("a box too small", |u| u.box_high[1] = 0.5 * (u.box_low[1] + u.box_high[1])),
        ("a box too wide", |u| u.box_low[0] -= 1.0),
        ("another depth", |u| u.farthest += 0.01),
        ("another slope", |u| u.slope[1] += 0.01),
        ("another pixel", |u| u.pixel += 1),
    ];
    for (what, spoil) in wrong {
        got = read(gpu(), &facets);
        spoil(&mut got.undecided[k]);
        assert!(check(&got) > 0, "{what} passes");
    }
}

/// The reference's rays are those of the truth.
#[gpu_test]
fn rays_are_the_cameras() {
    let world = world(gpu(), 0, &mut Random::new(11));
    let rays = world.camera.rays(24, 18);
    let (a, b) = (pixel_ray(&world.view, 25, DVec2::new(0.25, -0.5)), rays.direction(1.75, 1.0));
    assert!((a - b).length() < 1e-12, "{a} {b}");
    let _: Buffer<u32> = poisoned(gpu(), 1);
}
