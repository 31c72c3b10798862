//! Rounds of finer pages: which pixels go on and what pages they ask for, against their footprints in `f64`; exactly, which pages are made of these;
//! visibility on the same pages, pixel by pixel, as an interval that rounding may make of it; and how many pixels changed in each page.

use crate::support::pages::{BIAS, ten_a_row, thirds_wanted};
use crate::support::shadow::{
    World, above, add_triangle, camera, looked_down_on as world, random_light, random_scene, samples, sheet, uniform,
};
use crate::support::spsm::{faces_away, noise, receiver, with_blocks};
use crate::support::{POISON, Random, gpu, run, sizes_around};
use oracle::reference::page_query::PageLookup;
use oracle::reference::page_refinement::{chosen, class, counted, goes_on};
use oracle::reference::page_requests::{TreePage, level};
use oracle::reference::prefix_scan::exclusive;
use oracle::reference::summed_area::table;
use std::collections::{BTreeMap, BTreeSet};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Recorder};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::page_casters::{PageCasters, PageTexels};
use subpixel_shadows::stages::page_refinement::{PageChanges, PageRefinement, PageRefinementOptions};
use subpixel_shadows::stages::page_requests::{PageNodes, PageTree};
use test_support::gpu_test;

const CLASSES: usize = PageRefinement::CLASSES as usize;

/// State of pixels and pages between rounds.
#[derive(Clone, Debug, PartialEq)]
struct State {
    levels: Vec<u32>,
    changes: Vec<u32>,
    visibility: Vec<f32>,
    totals: [u32; 2],
}

/// A round: what it found, chose and left.
#[derive(Clone, Debug, PartialEq)]
struct Round {
    level: u32,
    before: State,
    asked_levels: Vec<u32>,
    requests: Vec<u32>,
    flags: Vec<u32>,
    masks: Vec<u32>,
    table: Vec<u32>,
    sat: Vec<u32>,
    keys: Vec<u32>,
    after: State,
}

/// All rounds over a world.
#[derive(Clone, Debug, PartialEq)]
struct Rounds {
    options: PageRefinementOptions,
    seen: Vec<Option<u32>>,
    rounds: Vec<Round>,
}

fn options(world: &World, budget: u32, finer: u32, changed: u32) -> PageRefinementOptions {
    let tree = PageTree::new(world.view.map.map_size);
    PageRefinementOptions { tree, budget, finer, changed, bias: BIAS }
}

impl Rounds {
    fn new(world: &World, options: PageRefinementOptions) -> Self {
        let gpu = world.gpu;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let (tree, budget) = (options.tree, options.budget);
        let stage = PageRefinement::new(device, options).expect("a budget");
        let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
        let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
        let id_keys = Buffer::from_slice(device, queue, "test.ids", &keys).expect("memory");
        let nodes = PageNodes::new(device, stage.numbers(), tree, seen.len()).expect("memory");
        for poisoned in [&nodes.levels, &nodes.flags, &nodes.masks, &nodes.sat, &nodes.table] {
            poisoned.write(queue, &vec![POISON; poisoned.len()]);
        }
        let found = PageChanges::new(device, tree).expect("memory");
        let texels = PageTexels::new(device, queue, world.triangles.len(), budget).expect("memory");
        let visibility = Buffer::<f32>::storage(device, "test.visibility", seen.len()).expect("memory");
        visibility.write(queue, &vec![f32::from_bits(POISON); seen.len()]);
        let casters = PageCasters::new(device, tree, budget, !world.prepared.alpha().is_empty());
        let (points, frame, offsets) = (world.points(), uniform(gpu, &world.frame), world.sample_offsets());
        let from =
            PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
        let read = |buffer: &Buffer<u32>| buffer.read(gpu).expect("readback");
        let state = || State {
            levels: read(&nodes.levels),
            changes: read(&found.changes),
            visibility: visibility.read(gpu).expect("readback"),
            totals: found.counts(gpu).expect("readback"),
        };
        let clear = |all: &[&Buffer<u32>], found: Option<&PageChanges>| {
            let mut encoder = gpu.encoder();
            let mut rec = Recorder::new(device, &mut encoder, None);
            all.iter().for_each(|buffer| rec.clear(buffer.raw()));
            if let Some(found) = found {
                found.clear(&mut rec);
            }
            gpu.submit_and_wait(encoder).expect("cleared");
        };
        found.changes.write(queue, &vec![POISON; found.changes.len()]);
        clear(&[], Some(&found));
        let rounds = stage.rounds().map(|level| {
            let before = state();
            clear(&[&nodes.requests, &texels.keys], None);
            run(gpu, |s| stage.record_choice(s, &frame, from, (&nodes, &found), level));
            let asked_levels = read(&nodes.levels);
            with_blocks(world, |blocks| run(gpu, |s| casters.record(s, &frame, blocks, &nodes, &texels)));
            let of = (&nodes, &texels, &found);
            run(gpu, |s| stage.record_compare(s, &frame, from, of, level, &visibility));
            Round {
                level,
                before,
                asked_levels,
                requests: read(&nodes.requests),
                flags: read(&nodes.flags),
                masks: read(&nodes.masks),
                table: read(&nodes.table),
                sat: read(&nodes.sat),
                keys: read(&texels.keys),
                after: state(),
            }
        });
        Self { options, rounds: rounds.collect(), seen }
    }
}

/// A pixel as far as rounding leaves it known.
struct Asker {
    /// The levels of the finest pages it may ask for, the coarsest first.
    finest: [u32; 2],
    /// Box of its samples.
    low: DVec2,
    high: DVec2,
}

/// `None`: it surely asks for nothing; one without a box may ask for anything.
fn asker(world: &World, options: &PageRefinementOptions, pixel: usize, t: Option<u32>) -> Option<Option<Asker>> {
    let t = t.filter(|&t| faces_away(world, t) != Some(true))?;
    let tree = [options.tree.base, options.tree.last];
    let known = || {
        let (thirds, [low, high]) = thirds_wanted(world, pixel as u32, t, options.finer, tree)?;
        faces_away(world, t)?;
        Some(Asker { finest: thirds.map(level), low, high })
    };
    Some(known())
}

/// Pages of a level that a box touches which is longer by `grow` texels on either side; none beside the map.
fn touched(world: &World, tree: PageTree, at: u32, [low, high]: [DVec2; 2], grow: f64) -> Vec<TreePage> {
    let size = f64::from(world.view.map.map_size);
    let scale = f64::from(at as i32 - tree.base as i32).exp2();
    let end = DVec2::splat((size * scale).ceil() - 1.0);
    let around = (grow - 0.5) / scale;
    if (high + around).cmplt(DVec2::ZERO).any() || (low - around).cmpge(DVec2::splat(size)).any() {
        return Vec::new();
    }
    let page = |p: DVec2| (p.clamp(DVec2::ZERO, end) / f64::from(PageTree::PAGE)).floor().as_uvec2();
    let (first, last) = (page(low * scale - grow), page(high * scale + grow));
    (first.y..=last.y).flat_map(|y| (first.x..=last.x).map(move |x| (at, [x, y]))).collect()
}

/// Where the choice of a round departs from its definition.
fn choice_fault(world: &World, rounds: &Rounds, round: &Round) -> Result<(), String> {
    let (options, tree, to) = (&rounds.options, rounds.options.tree, round.level);
    let first = to == *options.rounds().start();
    let changed = |pages: &[TreePage]| {
        pages.iter().map(|&(level, page)| round.before.changes[tree.node(level, page)]).max().unwrap_or(0)
    };
    let (mut must, mut may, mut any) = (BTreeMap::new(), BTreeMap::new(), 0);
    for (pixel, &found) in round.asked_levels.iter().enumerate() {
        let before = round.before.levels[pixel];
        let on = before.wrapping_add(1) == to && !first;
        let Some(asker) = asker(world, options, pixel, rounds.seen[pixel]).filter(|_| on) else {
            if found != if first { to } else { before } {
                return Err(format!("pixel {pixel} goes to level {found}"));
            }
            continue;
        };
        let Some(Asker { finest, low, high }) = asker else {
            any = u32::MAX;
            continue;
        };
        let most = [0.25, 1.0].map(|grow| changed(&touched(world, tree, to - 1, [low, high], grow)));
        let goes = [0, 1].map(|k| goes_on(to, finest[k], most[k], options.changed));
        if goes[0] && found != to || !goes[1] && found != before || ![before, to].contains(&found) {
            return Err(format!("pixel {pixel} is on level {found} of {to}, {goes:?}, {most:?} changed"));
        }
        if found != to {
            continue;
        }
        let raise = |asked: &mut BTreeMap<TreePage, u32>, most: u32, grow| {
            for page in touched(world, tree, to, [low, high], grow) {
                let of = asked.entry(page).or_insert(0);
                *of = (*of).max(class(most.max(options.changed)));
            }
        };
        raise(&mut must, most[0], 0.25);
        raise(&mut may, most[1], 1.0);
    }
    let all = |level: u32| (0..1 << level).flat_map(move |y| (0..1 << level).map(move |x| (level, [x, y])));
    let word = |(level, page): TreePage| round.requests[CLASSES + tree.node(level, page)];
    let asked: BTreeMap<TreePage, u32> = all(to).filter_map(|p| Some((p, word(p).checked_sub(1)?))).collect();
    for page in all(to) {
        let of = |pages: &BTreeMap<TreePage, u32>| pages.get(&page).map_or(0, |class| class + 1);
        if !(of(&must)..=of(&may).max(any)).contains(&word(page)) {
            return Err(format!("{page:?} has {}, {} to {} expected", word(page), of(&must), of(&may)));
        }
    }
    if round.requests[..CLASSES] != counted(&asked) || (0..to).any(|level| all(level).any(|p| word(p) != 0)) {
        return Err("the classes do not count the pages".to_owned());
    }
    let side = f64::from(world.view.map.map_size) * f64::from(to as i32 - tree.base as i32).exp2();
    let held = |(_, page): &TreePage| page.iter().all(|&x| f64::from(x * PageTree::PAGE) < side);
    let made: BTreeSet<TreePage> = if first { all(to).filter(held).collect() } else { chosen(&asked, options.budget) };
    let wanted = if first { made.len() } else { asked.len() };
    let totals = [round.before.totals[0] + made.len() as u32, round.before.totals[1] + wanted as u32];
    if round.after.totals != totals || made.len() > options.budget as usize {
        return Err(format!("{:?} pages, {totals:?} expected", round.after.totals));
    }
    let (mut flags, mut masks) = (vec![0; tree.nodes()], vec![0; tree.nodes()]);
    for (level, page) in (0..=tree.last).flat_map(all) {
        let within = level < to || made.contains(&(to, page.map(|x| x >> (level - to))));
        masks[tree.node(level, page)] = u32::from(within) << to;
        flags[tree.node(level, page)] = u32::from(within && level == to);
    }
    let counted = round.table[..tree.nodes()] == exclusive(&flags).sums && round.sat == table(&flags, tree.grid()[0]);
    let right = round.flags == flags && round.masks == masks && counted;
    if right { Ok(()) } else { Err("another choice of pages".to_owned()) }
}

/// Where the comparison of a round departs from its definition; how many pixels were compared, and how many of them closely.
fn compare_fault(world: &World, rounds: &Rounds, round: &Round) -> Result<[u64; 2], String> {
    let (options, tree, to) = (&rounds.options, rounds.options.tree, round.level);
    let first = to == *options.rounds().start();
    let size = world.view.map.map_size;
    let scale = f64::from(to as i32 - tree.base as i32).exp2();
    let texels = PageTree::PAGE.pow(2) as usize;
    let depth_of = |&key: &u32| (key != 0).then(|| f64::from(f32::from_bits(!key)));
    let all = (0..1 << to).flat_map(|y| (0..1 << to).map(move |x| (to, [x, y])));
    let pages: BTreeMap<TreePage, Vec<Option<f64>>> = all
        .filter(|&(level, page)| round.flags[tree.node(level, page)] == 1)
        .map(|(level, page)| ((level, page), round.table[tree.node(level, page)] as usize * texels))
        .map(|(page, begin)| (page, round.keys[begin..][..texels].iter().map(depth_of).collect()))
        .collect();
    let [place, depth] = noise(world);
    let around = [[0.0, 0.0], [place, place], [-place, place], [place, -place], [-place, -place]];
    let (mut least, mut most, mut anywhere) = (vec![0; tree.nodes()], vec![0; tree.nodes()], 0);
    let (mut compared, mut close) = (0, 0);
    let bits = |v: f32| v.to_bits();
    for (pixel, &t) in rounds.seen.iter().enumerate() {
        let (was, is) = (round.before.visibility[pixel], round.after.visibility[pixel]);
        let (asked, level) = (round.asked_levels[pixel], round.after.levels[pixel]);
        let kept = bits(was) == bits(is);
        if asked != to || level != to {
            let back = asked == to && !first && level + 1 == to;
            if !kept || !(level == asked || back) {
                return Err(format!("pixel {pixel} of level {asked} is at {level}, {was} became {is}"));
            }
            let sure = t.and_then(|t| receiver(world, pixel as u32, t));
            let made = |p: DVec3| {
                let texel = [p.x, p.y].map(|x| (x * scale).max(0.0) as u32 / PageTree::PAGE);
                let outside = p.x < 0.0 || p.y < 0.0 || p.x >= f64::from(size) || p.y >= f64::from(size);
                outside || pages.contains_key(&(to, texel))
            };
            let lacks = |places: &[Option<DVec3>]| {
                places.iter().flatten().any(|p| around.iter().any(|[x, y]| !made(*p + DVec3::new(*x, *y, 0.0))))
            };
            if back && sure.is_some_and(|(places, ..)| !lacks(&places)) {
                return Err(format!("pixel {pixel} goes back though all of its pages are made"));
            }
            continue;
        }
        let Some(t) = t else {
            if is != 1.0 {
                return Err(format!("pixel {pixel} sees nothing and has {is}"));
            }
            continue;
        };
        let dark = faces_away(world, t);
        if dark == Some(true) {
            if is != 0.0 {
                return Err(format!("pixel {pixel} is dark and has {is}"));
            }
            continue;
        }
        if let (Some(false), Some((places, slope, _))) = (dark, receiver(world, pixel as u32, t)) {
            let doubt = depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * place * 2.0;
            let lookup = |doubt: f64| PageLookup {
                pages: &pages,
                size,
                base: tree.base,
                constant: f64::from(BIAS[0]) + doubt,
                slope: f64::from(BIAS[1]),
            };
            let (brighter, darker) = (lookup(doubt), lookup(-doubt));
            let (mut low, mut high, mut seen) = (0.0, 0.0, 0.0);
            for p in places.iter().flatten() {
                let moved = around.map(|[x, y]| *p + DVec3::new(x, y, slope.dot(DVec2::new(x, y))));
                low += moved.iter().map(|m| darker.share(*m, slope, to)).fold(1.0, f64::min);
                high += moved.iter().map(|m| brighter.share(*m, slope, to)).fold(0.0, f64::max);
                seen += 1.0;
            }
            let (low, high) = (low / seen - 1e-5, high / seen + 1e-5);
            if seen > 0.0 && !(low..=high).contains(&f64::from(is)) {
                return Err(format!("pixel {pixel} has {is}, {low} to {high} expected"));
            }
            compared += 1;
            close += u64::from(high - low < 1e-3);
        }
        if kept && !first {
            continue;
        }
        let Some(asker) = asker(world, options, pixel, Some(t)) else { continue };
        let Some(Asker { finest, low, high }) = asker else {
            anywhere += 1;
            continue;
        };
        for (counts, grow, finest) in [(&mut least, 0.25, finest[0]), (&mut most, 1.0, finest[1])] {
            let counting = if finest > to { touched(world, tree, to, [low, high], grow) } else { Vec::new() };
            counting.into_iter().for_each(|(level, page)| counts[tree.node(level, page)] += 1);
        }
    }
    for (node, (&before, &after)) in round.before.changes.iter().zip(&round.after.changes).enumerate() {
        if !(before + least[node]..=before + most[node] + anywhere).contains(&after) {
            return Err(format!("node {node} counts {after}, {before} + {} to {}", least[node], most[node]));
        }
    }
    Ok([compared, close])
}

/// Where the rounds depart from their definition; how many pixels were compared, and how many of them closely.
fn fault(world: &World, rounds: &Rounds) -> Result<[u64; 2], String> {
    let mut sums = [0, 0];
    for (k, round) in rounds.rounds.iter().enumerate() {
        let before = k.checked_sub(1).map_or(&round.before, |k| &rounds.rounds[k].after);
        let same = before.levels == round.before.levels && before.changes == round.before.changes;
        let of = |text: String| format!("round of level {}: {text}", round.level);
        if !same || k == 0 && (round.before.changes.iter().any(|&n| n != 0) || round.before.totals != [0, 0]) {
            return Err(of("begins with what none has left".to_owned()));
        }
        choice_fault(world, rounds, round).map_err(of)?;
        let compared = compare_fault(world, rounds, round).map_err(of)?;
        (0..2).for_each(|k| sums[k] += compared[k]);
    }
    Ok(sums)
}

#[track_caller]
fn check(world: &World, options: PageRefinementOptions) -> Rounds {
    let ran = Rounds::new(world, options);
    match fault(world, &ran) {
        Ok([compared, close]) => assert!(close * 2 + 9 >= compared, "{close} of {compared} pixels compared closely"),
        Err(text) => panic!("{:?}, {options:?}: {text}", world.light),
    }
    ran
}

fn totals(ran: &Rounds) -> [u32; 2] {
    ran.rounds.last().expect("a round").after.totals
}

#[gpu_test]
fn empty() {
    let world = world(gpu(), &Mesh::default(), above(), [3, 2], 9, 8);
    let ran = check(&world, options(&world, 4, 0, 1));
    assert!(ran.rounds.iter().all(|round| round.after.visibility.iter().all(|&v| v == 1.0)));
    assert_eq!(totals(&ran), [1, 1], "the whole map, and nothing finer");
}

/// A triangle over a sheet is asked for as finely as pixels want it, the rest of the sheet not.
#[gpu_test]
fn one() {
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    add_triangle(&mut mesh, [[-0.3, 0.2, -0.3], [0.1, 0.2, -0.3], [-0.3, 0.2, 0.1]]);
    let world = world(gpu(), &mesh, above(), [200, 150], 32, 8);
    let all = totals(&check(&world, options(&world, 4096, 4, 1)));
    let some = totals(&check(&world, options(&world, 4, 4, 1)));
    assert!(all[0] == all[1] && all[0] > 8 && some[0] < all[0], "{all:?}, {some:?}");
    let bare = sheet(1, 2.0, |_, _| 0.0, |p| p);
    let nothing = self::world(gpu(), &bare, above(), [200, 150], 32, 8);
    let ran = check(&nothing, options(&nothing, 4096, 4, 1));
    assert!(totals(&ran)[0] < all[0], "nothing changes, so one level is tried: {:?}, {all:?}", totals(&ran));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        let world = world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8);
        check(&world, options(&world, 9, 1, 1));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    let (mut short, mut stopped) = (0, 0);
    for kind in 0..4 {
        for (k, budget) in [1, 7, 60, 1000].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let world = world(gpu(), &mesh, light, [60, 40], [64, 150][k / 2], [1, 32, 8, 128][k]);
            let ran = check(&world, options(&world, budget, k as u32, [1, 20][k % 2]));
            let [made, asked] = totals(&ran);
            short += usize::from(made < asked);
            let last = ran.rounds.last().expect("a round").level;
            stopped +=
                ran.rounds.iter().filter(|r| r.level == last && r.after.levels.iter().all(|l| *l < last)).count();
        }
    }
    assert!(short > 3 && stopped > 3, "{short} had too few pages, {stopped} stopped early");
}

/// A plane seen almost from its edge, whose footprints have no end, and one that the light almost misses.
#[gpu_test]
fn degenerate() {
    let mesh = sheet(3, 30.0, |_, _| 0.0, |p| p);
    for height in [1e-3, 0.2] {
        let camera = camera(DVec2::new(0.0, height).extend(40.0), Default::default(), 40.0);
        for light in [above(), Light::Directional { direction: [1.0, 0.01, 0.0] }] {
            let world = World::new(gpu(), &mesh, camera, light, [40, 30], 100, samples(8));
            check(&world, options(&world, 20, 0, 1));
        }
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let world = world(gpu(), &mesh, above(), [65_537, 1], 16, 1);
    let ran = Rounds::new(&world, options(&world, 64, 0, 1));
    let left = &ran.rounds.last().expect("a round").after;
    assert!(left.levels.iter().all(|l| *l != POISON) && left.visibility.iter().all(|v| v.to_bits() != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| {
        let world = world(gpu, &mesh, above(), [24, 24], 24, 8);
        check(&world, options(&world, 64, 1, 1))
    };
    assert!(of(ten_a_row()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [96, 72], 100, 8);
    let options = options(&world, 12, 2, 3);
    let ran = check(&world, options);
    assert!(Rounds::new(&world, options) == ran, "another result in a second run");
    let [made, asked] = totals(&ran);
    assert!(made < asked, "the budget is not felt: {made}, {asked}");
    let spoilt = |k: usize, spoil: &dyn Fn(&mut Round)| {
        let mut off = ran.clone();
        spoil(&mut off.rounds[k]);
        fault(&world, &off).is_err()
    };
    let second = &ran.rounds[1];
    let tree = ran.options.tree;
    let went = second.asked_levels.iter().position(|&l| l == second.level).expect("a pixel that goes on");
    let stayed = second.asked_levels.iter().position(|&l| l < second.level).expect("a pixel that stays");
    let node = (0..tree.nodes()).find(|&n| second.flags[n] == 1).expect("a page");
    let changed = (0..tree.nodes()).find(|&n| second.after.changes[n] > second.before.changes[n]).expect("changes");
    assert!(!spoilt(1, &|_| ()));
    assert!(spoilt(1, &|r| r.asked_levels[went] -= 1));
    assert!(spoilt(1, &|r| r.asked_levels[stayed] += 1));
    assert!(spoilt(1, &|r| r.requests[CLASSES + node] += 40));
    assert!(spoilt(1, &|r| r.requests[CLASSES + node] = 0));
    assert!(spoilt(1, &|r| r.requests[3] += 1));
    assert!(spoilt(1, &|r| r.flags[node] = 0));
    assert!(spoilt(1, &|r| r.masks[node] = 0));
    assert!(spoilt(1, &|r| r.table[node] += 1));
    assert!(spoilt(1, &|r| *r.sat.last_mut().expect("a table") += 1));
    assert!(spoilt(1, &|r| r.keys.rotate_right(1024)));
    assert!(spoilt(1, &|r| r.after.totals[0] += 1));
    assert!(spoilt(1, &|r| r.after.totals[1] += 1));
    let lit =
        (0..ran.seen.len()).find(|&p| second.after.levels[p] == second.level && second.after.visibility[p] == 1.0);
    assert!(spoilt(1, &|r| r.after.visibility[lit.expect("a lit pixel")] = 0.5));
    assert!(spoilt(0, &|r| r.before.totals[0] += 1));
    // The next round begins with what one leaves.
    assert!(spoilt(1, &|r| r.after.changes[changed] += 10_000));
    assert!(spoilt(1, &|r| r.after.levels[went] -= 1));
    assert!(spoilt(2, &|r| r.before.changes[changed] = 0));
}
