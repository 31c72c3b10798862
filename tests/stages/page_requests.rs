//! Levels that pixels ask for against their footprints in `f64`, pages against the boxes of these, and exactly: which pages are made of those
//! that are asked for.

use crate::support::pages::{Paged, WEIGHTS, footprint, ten_a_row, thirds_wanted};
use crate::support::shadow::{
    World, above, camera, looked_down_on as world, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::faces_away;
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::page_requests::{
    Asked, EDGE_WEIGHT, THIRDS, cells, chosen, level, levels_around, of_cells, tiles,
};
use oracle::reference::prefix_scan::exclusive;
use oracle::reference::summed_area::table;
use std::collections::BTreeSet;
use subpixel_shadows::glam::{DVec2, UVec2};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::page_requests::{PageRule, PageTree};
use test_support::gpu_test;

/// Whether one of these texels of a map of `size` a side lies in a box that is longer by `grow` on either side.
fn is_marked(texels: &[[u32; 2]], [low, high]: [DVec2; 2], size: f64, grow: f64) -> bool {
    let texel = |p: DVec2| p.clamp(DVec2::ZERO, DVec2::splat(size - 1.0)).floor().as_uvec2();
    let (first, last) = (texel(low - grow), texel(high + grow));
    texels.iter().any(|&at| UVec2::from(at).cmpge(first).all() && UVec2::from(at).cmple(last).all())
}

/// Where the stage departs from its definition; how many pixels' levels were known to one.
fn fault(world: &World, ran: &Paged) -> Result<usize, String> {
    let tree = [ran.tree.base, ran.tree.last];
    let size = f64::from(world.view.map.map_size);
    let asked = ran.asked();
    let mut reached = vec![false; asked.len()];
    let (mut sure, mut endless) = (0, false);
    for (pixel, t) in (0..).zip(&ran.seen) {
        let found = ran.levels[pixel as usize];
        let Some(t) = *t else {
            if found != 0 {
                return Err(format!("pixel {pixel} sees nothing and asks for level {found}"));
            }
            continue;
        };
        let dark = faces_away(world, t);
        if dark == Some(true) {
            if found != 0 {
                return Err(format!("pixel {pixel} is dark and asks for level {found}"));
            }
            continue;
        }
        let Some(([mut coarsest, mut finest], [low, high])) = thirds_wanted(world, pixel, t, ran.finer, tree) else {
            endless = true;
            continue;
        };
        if let Some(edges) = &ran.edges {
            let near = |grow: f64| is_marked(edges, [low, high], size, grow);
            let held = THIRDS * tree[0];
            finest = if near(1.25) { finest } else { finest.min(held) };
            coarsest = if near(0.75) { coarsest } else { coarsest.min(held) };
        }
        sure += usize::from(finest == coarsest && dark == Some(false));
        let open = dark.is_none() && found == 0;
        if !open && !(coarsest..=finest).contains(&found) {
            return Err(format!("pixel {pixel} asks for level {found}, {coarsest} to {finest} expected"));
        }
        let asks = level(found);
        let more = 3 * asks - found;
        let scale = f64::from(asks as i32 - ran.tree.base as i32).exp2();
        let page = f64::from(PageTree::PAGE);
        let end = (size * scale).ceil() - 1.0;
        let beside = high.cmplt(DVec2::ZERO).any() || low.cmpge(DVec2::splat(size)).any();
        let pages = |grow: f64| {
            let at = |p: DVec2| (p.clamp(DVec2::ZERO, DVec2::splat(end)) / page).floor();
            [at(low * scale - grow), at(high * scale + grow)]
        };
        for (k, ((_, place), _)) in asked.iter().enumerate().filter(|(_, a)| a.0.0 == asks && a.1 == more) {
            let place = DVec2::new(f64::from(place[0]), f64::from(place[1]));
            let within = |[low, high]: [DVec2; 2]| place.cmpge(low).all() && place.cmple(high).all();
            reached[k] |= within(pages(1.0));
        }
        if beside || dark.is_none() {
            continue;
        }
        let [first, last] = pages(0.25);
        for y in first.y as u32..=last.y as u32 {
            for x in first.x as u32..=last.x as u32 {
                if !asked.contains(&((asks, [x, y]), more)) {
                    return Err(format!("pixel {pixel} needs page {x} {y} of level {asks}, which is not asked for"));
                }
            }
        }
    }
    if let Some(k) = reached.iter().position(|&reached| !reached && !endless) {
        return Err(format!("{:?} is asked for by no pixel", asked[k]));
    }
    choice_fault(ran, &asked).map_or(Ok(sure), Err)
}

/// Where the pages that are made are not those of the ones that are asked for.
fn choice_fault(ran: &Paged, asked: &[Asked]) -> Option<String> {
    let wanted = chosen(asked, ran.tree.last, ran.budget as usize);
    let made: Vec<_> = ran.made().into_keys().collect();
    if made != wanted.pages.iter().copied().collect::<Vec<_>>() {
        return Some(format!("{made:?} are made, {wanted:?}"));
    }
    let counts = [wanted.pages.len() as u32, wanted.coarser, wanted.asked as u32];
    if ran.counts != counts || made.len() > ran.budget as usize {
        return Some(format!("counts {:?}, {counts:?} expected, {} pages of budget", ran.counts, ran.budget));
    }
    let mut masks = vec![0; ran.tree.nodes()];
    for page in ran.all() {
        masks[ran.tree.node(page.0, page.1)] = levels_around(&wanted.pages, page);
    }
    if ran.masks != masks {
        return Some("levels around nodes".to_owned());
    }
    let nodes = ran.tree.nodes();
    let counted = ran.table[..nodes] == exclusive(&ran.flags).sums && ran.sat == table(&ran.flags, ran.tree.grid()[0]);
    (!counted).then(|| "the tables do not count the pages".to_owned())
}

/// Where pages by cells depart from their definition, by the levels of those by pixels, which are checked by themselves; how many cells are asked for.
fn fault_of_cells(world: &World, by_pixel: &Paged, ran: &Paged, marked: &[[u32; 2]]) -> Result<usize, String> {
    let (tree, side) = (ran.tree, 1u32 << ran.tree.cell_level());
    let scale = f64::from(tree.cell_level() as i32 - tree.base as i32).exp2();
    let (size, page) = (f64::from(world.view.map.map_size), f64::from(PageTree::PAGE));
    let end = DVec2::splat((size * scale).ceil() - 1.0);
    // Cells that the box of a pixel touches at the least and at the most; none if it may see nothing or asks for nothing.
    let touched = |pixel: usize, grow: f64| {
        let [low, high] = footprint(world, pixel as u32, ran.seen[pixel]?)?.1;
        let beside =
            (high + grow / scale).cmplt(DVec2::ZERO).any() || (low - grow / scale).cmpge(DVec2::splat(size)).any();
        let at = |p: DVec2| (p.clamp(DVec2::ZERO, end) / page).floor().as_uvec2().to_array();
        (!beside).then(|| [at(low * scale - grow), at(high * scale + grow)])
    };
    let dark = |pixel: usize| ran.seen[pixel].and_then(|t| faces_away(world, t));
    let (mut least, mut most) = (Vec::new(), Vec::new());
    for pixel in (0..ran.seen.len()).filter(|&pixel| ran.seen[pixel].is_some() && dark(pixel) != Some(true)) {
        let thirds = by_pixel.levels[pixel];
        if dark(pixel) == Some(false) {
            least.extend(touched(pixel, 0.25).map(|cells| (thirds, cells)));
        }
        // One whose box has no end may ask anywhere.
        let anywhere = footprint(world, pixel as u32, ran.seen[pixel].unwrap_or(0)).is_none();
        most.extend(touched(pixel, 1.0).or(anywhere.then_some([[0; 2], [side - 1; 2]])).map(|cells| (thirds, cells)));
    }
    let mut found = ran.cells();
    for (k, ((found, least), most)) in found.iter().zip(cells(least, side)).zip(cells(most, side)).enumerate() {
        if !(least..=most).contains(found) {
            return Err(format!("cell {k} has {found:?}, {least:?} to {most:?} expected"));
        }
    }
    let asked = ran.asked();
    let pages_of =
        |cells: &[Option<u32>]| of_cells(cells, tree.cell_level(), tree.base, world.view.map.map_size, PageTree::PAGE);
    if ran.rule == PageRule::Tiled {
        let edges = |pixel: usize, grow: f64| {
            let [low, high] = footprint(world, pixel as u32, ran.seen[pixel]?)?.1;
            Some(is_marked(marked, [low, high], size, grow))
        };
        let of = |pixel: usize, grow: f64| if edges(pixel, grow) == Some(true) { EDGE_WEIGHT } else { 1 };
        let weigh = |grow: f64, near: f64, sure: bool| {
            let mut weights = vec![0; tree.cells()];
            for pixel in (0..ran.seen.len()).filter(|&p| dark(p) == Some(false) || !sure && dark(p).is_none()) {
                let Some([first, last]) = touched(pixel, grow) else { continue };
                for y in first[1]..=last[1] {
                    (first[0]..=last[0]).for_each(|x| weights[(y * side + x) as usize] += of(pixel, near));
                }
            }
            weights
        };
        let (weights, all) = ran.weights();
        for (k, (least, most)) in weigh(0.25, 0.75, true).into_iter().zip(weigh(1.0, 1.25, false)).enumerate() {
            if !(least..=most).contains(&weights[k]) || all != weights.iter().sum::<u32>() {
                return Err(format!("cell {k} weighs {}, {least} to {most} expected", weights[k]));
            }
        }
        let level = |more: f64| tiles(&found, weights, tree.cell_level(), ran.budget, more);
        let (high, all) = (level(1e-4), asked.iter().copied().collect());
        let pick = |(k, (low, high)): (usize, (Option<u32>, Option<u32>))| {
            let mut alone = vec![None; tree.cells()];
            alone[k] = low;
            // Rounding may make either of them.
            if low != high && pages_of(&alone).is_subset(&all) { low } else { high }
        };
        found = level(-1e-4).into_iter().zip(high).enumerate().map(pick).collect();
    }
    let wanted = pages_of(&found);
    if asked.iter().copied().collect::<BTreeSet<_>>() != wanted {
        return Err(format!("{asked:?} are asked for, {wanted:?} expected"));
    }
    for pixel in (0..ran.seen.len()).filter(|&pixel| dark(pixel) == Some(false)) {
        let Some((least, most)) = touched(pixel, 0.25).zip(touched(pixel, 1.0)) else { continue };
        let finest = |[first, last]: [[u32; 2]; 2]| {
            let row = |y: u32| (first[0]..=last[0]).map(move |x| (y * side + x) as usize);
            (first[1]..=last[1]).flat_map(row).filter_map(|cell| found[cell]).max().unwrap_or(0)
        };
        let (level, range) = (ran.levels[pixel], finest(least)..=finest(most));
        if !range.contains(&level) {
            return Err(format!("pixel {pixel} asks its cells for level {level}, {range:?} expected"));
        }
    }
    if let Some(text) = choice_fault(ran, &asked) {
        return Err(text);
    }
    Ok(found.iter().flatten().count())
}

#[track_caller]
fn check(world: &World, budget: u32, finer: u32) -> Paged {
    let ran = Paged::new(world, budget, finer);
    match fault(world, &ran) {
        Ok(sure) => {
            let seen = ran.levels.iter().filter(|level| **level > 0).count();
            assert!(sure * 4 + 9 >= seen, "of {seen} pixels' levels {sure} are known");
        }
        Err(text) => panic!("{:?}, {} samples, budget {budget}: {text}", world.light, world.samples.count()),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 9, 8), 4, 0);
    assert_eq!(ran.counts, [1, 0, 1], "the coarsest page is always there");
}

#[gpu_test]
fn one() {
    let mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    let ran = check(&world(gpu(), &mesh, above(), [1, 1], 63, 1), 64, 0);
    assert_eq!(ran.levels, [0], "a pixel larger than the map");
    let ran = check(&world(gpu(), &mesh, above(), [200, 150], 64, 8), 8192, 2);
    assert!(ran.counts[0] > 20 && ran.counts[1] == 0, "{:?}", ran.counts);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), 9, 1);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, budget) in [1, 7, 60, 1000].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let world = world(gpu(), &mesh, light, [60, 40], [64, 150][k / 2], [1, 32, 8, 128][k]);
            check(&world, budget, k as u32);
        }
    }
}

/// A plane seen almost from its edge, whose footprints have no end, and one that the light almost misses.
#[gpu_test]
fn degenerate() {
    let mesh = sheet(3, 30.0, |_, _| 0.0, |p| p);
    for height in [1e-3, 0.2] {
        let camera = camera(DVec2::new(0.0, height).extend(40.0), Default::default(), 40.0);
        for light in [above(), Light::Directional { direction: [1.0, 0.01, 0.0] }] {
            check(&World::new(gpu(), &mesh, camera, light, [40, 30], 100, samples(8)), 20, 0);
        }
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), 64, 0);
    assert!(ran.levels.iter().all(|&level| level != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    let of = |gpu| check(&world(gpu, &mesh, above(), [24, 24], 24, 8), 64, 1);
    let (a, b) = (of(ten_a_row()), of(gpu()));
    assert!(a.requests == b.requests && a.table == b.table && a.levels == b.levels, "the fold changes the result");
}

/// Pages at silhouettes: pixels away from these ask for texels of the map at the finest.
#[gpu_test]
fn pixels_away_from_edges_ask_for_little() {
    let mut random = Random::new(97);
    let (mut held, mut fine) = (0, 0);
    for (k, map) in [64, 150, 24].into_iter().enumerate() {
        for kind in 0..4 {
            let mesh = random_scene(kind, &mut random);
            let world = world(gpu(), &mesh, random_light(k % 2 == 0, &mut random), [60, 40], map, [1, 32, 8][k]);
            let marked: Vec<[u32; 2]> = (0..map / 4).map(|_| [random.below(map), random.below(map)]).collect();
            let by_pixel = Paged::new(&world, 1000, 2);
            let ran = Paged::marked(PageRule::Edges, &world, 1000, 2, &marked);
            fault(&world, &ran).unwrap_or_else(|e| panic!("map {map}, kind {kind}: {e}"));
            held += by_pixel.levels.iter().zip(&ran.levels).filter(|(all, some)| all > some).count();
            fine += ran.levels.iter().filter(|level| **level > THIRDS * ran.tree.base).count();
            assert!(ran.counts[2] <= by_pixel.counts[2], "{:?}, {:?}", ran.counts, by_pixel.counts);
            let nowhere = Paged::by(PageRule::Edges, &world, 1000, 2);
            assert!(nowhere.levels.iter().all(|level| *level <= THIRDS * ran.tree.base));
        }
    }
    assert!(held > 500 && fine > 500, "{held} pixels held, {fine} not");
    let world = world(gpu(), &random_scene(1, &mut Random::new(89)), above(), [96, 72], 100, 8);
    let marked: Vec<[u32; 2]> = (0..400).map(|_| [random.below(100), random.below(100)]).collect();
    let ran = Paged::marked(PageRule::Edges, &world, 500, 2, &marked);
    assert!(fault(&world, &ran).is_ok());
    // Other silhouettes, none, or all pixels by themselves are told apart.
    for edges in [Some(marked[..200].to_vec()), Some(Vec::new()), None] {
        let off = Paged { edges, ..Paged::marked(PageRule::Edges, &world, 500, 2, &marked) };
        assert!(fault(&world, &off).is_err());
    }
}

/// Pages by cells of the view, with room for them and without, of maps that fill their pages and that do not.
#[gpu_test]
fn cells_are_as_fine_as_their_pixels() {
    let mut random = Random::new(83);
    let mut whole = 0;
    for (k, map) in [64, 150, 1000, 24].into_iter().enumerate() {
        for (kind, budget) in [(0, 4000), (1, 60), (2, 9), (3, 1000)] {
            let mesh = random_scene(kind, &mut random);
            let world = world(gpu(), &mesh, random_light(k % 2 == 0, &mut random), [60, 40], map, [1, 32, 8, 128][k]);
            let by_pixel = Paged::new(&world, budget, 4);
            let ran = Paged::by(PageRule::Fitted, &world, budget, 4);
            let cells =
                fault_of_cells(&world, &by_pixel, &ran, &[]).unwrap_or_else(|e| panic!("map {map}, kind {kind}: {e}"));
            assert!(cells > 0);
            whole += usize::from(ran.counts[2] > by_pixel.counts[2]);
        }
    }
    assert!(whole > 4, "{whole}");
    let world = world(gpu(), &random_scene(1, &mut Random::new(89)), above(), [96, 72], 100, 8);
    let (by_pixel, ran) = (Paged::new(&world, 500, 4), Paged::by(PageRule::Fitted, &world, 500, 4));
    let spoilt = |spoil: &dyn Fn(&mut Paged)| {
        let mut off = Paged::by(PageRule::Fitted, &world, 500, 4);
        assert!(off.requests == ran.requests && off.levels == ran.levels, "another result in a second run");
        spoil(&mut off);
        fault_of_cells(&world, &by_pixel, &off, &[]).is_err()
    };
    let (all, asked) = (ran.requests.len() - 2 * ran.tree.cells(), ran.asked());
    let cell = ran.cells().iter().position(Option::is_some).expect("a cell");
    let bare = ran.cells().iter().position(Option::is_none).expect("a cell that no pixel sees");
    let pixel = ran.levels.iter().position(|&level| level > 6).expect("a pixel");
    assert!(!spoilt(&|_| ()));
    assert!(spoilt(&|r| r.requests[all + cell] += 6));
    assert!(spoilt(&|r| r.requests[all + bare] = 1));
    assert!(spoilt(&|r| r.requests[ran.word(asked[1].0)] &= !(4 >> asked[1].1)));
    assert!(spoilt(&|r| r.levels[pixel] -= 6));
    assert!(spoilt(&|r| r.counts[0] += 1));
}

/// Tiles share the budget by the pixels in them, those near silhouettes before others.
#[gpu_test]
fn tiles_are_as_fine_as_their_share() {
    let mut random = Random::new(101);
    let marks = |map: u32, random: &mut Random| -> Vec<[u32; 2]> {
        (0..map / 2).map(|_| [random.below(map), random.below(map)]).collect()
    };
    let mut coarser = 0;
    for (k, map) in [64, 150, 1000, 24].into_iter().enumerate() {
        for (kind, budget) in [(0, 4000), (1, 60), (2, 9), (3, 1000)] {
            let mesh = random_scene(kind, &mut random);
            let world = world(gpu(), &mesh, random_light(k % 2 == 0, &mut random), [60, 40], map, [1, 32, 8, 128][k]);
            let marked = marks(map, &mut random);
            let (by_pixel, ran) =
                (Paged::new(&world, budget, 4), Paged::marked(PageRule::Tiled, &world, budget, 4, &marked));
            fault_of_cells(&world, &by_pixel, &ran, &marked).unwrap_or_else(|e| panic!("map {map}, kind {kind}: {e}"));
            coarser += usize::from(ran.counts[2] < Paged::by(PageRule::Fitted, &world, budget, 4).counts[2]);
        }
    }
    assert!(coarser > 8, "{coarser}");
    let world = world(gpu(), &random_scene(1, &mut Random::new(89)), above(), [96, 72], 100, 8);
    let marked = marks(100, &mut random);
    let of = || Paged::marked(PageRule::Tiled, &world, 200, 4, &marked);
    let (by_pixel, ran) = (Paged::new(&world, 200, 4), of());
    let spoilt = |spoil: &dyn Fn(&mut Paged)| {
        let mut off = of();
        assert!(off.requests == ran.requests && off.levels == ran.levels, "another result in a second run");
        spoil(&mut off);
        fault_of_cells(&world, &by_pixel, &off, &marked).is_err()
    };
    let heaviest = (0..ran.tree.cells()).max_by_key(|&k| ran.weights().0[k]).expect("cells");
    let weight = ran.requests.len() - ran.tree.cells() + heaviest;
    assert!(!spoilt(&|_| ()));
    assert!(spoilt(&|r| r.requests[weight] *= 2));
    assert!(spoilt(&|r| r.requests[WEIGHTS] += 1));
    assert!(spoilt(&|r| r.budget = 20));
    assert!(fault_of_cells(&world, &by_pixel, &of(), &[]).is_err(), "without silhouettes");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [96, 72], 100, 8);
    let ran = check(&world, 12, 2);
    assert!(ran.counts[1] > 0, "the budget is not felt: {:?}", ran.counts);
    let spoilt = |spoil: &dyn Fn(&mut Paged)| {
        let mut off = Paged::new(&world, 12, 2);
        assert!(off.requests == ran.requests && off.table == ran.table, "another result in a second run");
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let node = |page: (u32, [u32; 2])| ran.tree.node(page.0, page.1);
    let bits = |p: (u32, [u32; 2])| ran.requests[ran.word(p)];
    let (marked, more) = ran.asked()[1];
    let bare = ran.all().find(|&p| p.0 > 0 && bits(p) & 7 == 0).expect("a page");
    assert!(spoilt(&|r| r.requests[ran.word(marked)] &= !(4 >> more)));
    assert!(spoilt(&|r| r.requests[ran.word(bare)] |= 1));
    let open = ran.levels.iter().position(|&level| level > 6).expect("a pixel");
    assert!(spoilt(&|r| r.levels[open] -= 4));
    let made = *ran.made().keys().last().expect("a page");
    assert!(spoilt(&|r| r.flags[node(made)] = 0));
    assert!(spoilt(&|r| r.masks[node(made)] ^= 1));
    assert!(spoilt(&|r| r.table[node(made)] ^= 1));
    assert!(spoilt(&|r| *r.sat.last_mut().expect("a table") += 1));
    assert!(spoilt(&|r| r.counts[1] += 1));
    assert!(spoilt(&|r| r.budget = 4000));
}
