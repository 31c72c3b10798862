//! Candidates: every triangle that shadows or cuts a facet is kept, and a facet settled by one triangle is all dark.
//!
//! The list is no set of its own right: what must hold is that nothing that matters is dropped (the facet truth, and the
//! definition without margins, say what matters) and that little that does not is kept (the definition with twice the
//! margins).

use crate::support::shadow::{
    World, add_triangle, append, camera, folding_gpu, indirect, random_light, random_scene, samples, sheet, soup,
    uniform, unit, vector, with_total,
};
use crate::support::{POISON, Random, gpu, run, sizes_around};
use oracle::reference::candidate_pairs::matters;
use oracle::reference::facet_classify::{FacetAtPixel, MapAround, classify};
use oracle::reference::front_layer::{Margin, Split};
use oracle::reference::pixel_texel_pairs::pairs;
use oracle::reference::triangle_texel_pairs::{TilePair, tile_pairs};
use oracle::reference::view::MapEnds;
use oracle::truth::{FacetInput, FacetTruth, Tracer, full_mask, join_mask, split_mask};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::{Gpu, Profile};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::candidate_pairs::CandidatePairs;
use subpixel_shadows::stages::candidate_pairs::tally::TALLY_LONGEST;
use subpixel_shadows::stages::facet_classify::FacetState;
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, TALLY_WORDS};
use test_support::gpu_test;

/// What the GPU made of the lists: (facet, triangle) rising, the tally, and the facets it settled.
struct Got {
    kept: Vec<[u32; 2]>,
    tally: Vec<u32>,
    settled: Vec<bool>,
    list: Vec<[u32; 2]>,
}

/// Texels a side.
const MAP: usize = 64;

fn world(gpu: &'static Gpu, mesh: &Mesh, random: &mut Random) -> World {
    let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
    let light = random_light(random.below(2) == 0, random);
    let mut world =
        World::new(gpu, mesh, camera(eye, vector(random) * 0.3, 50.0), light, [16, 12], MAP as u32, samples(32));
    world.frame.flags |= 8;
    world
}

/// Culls all triangles against all listed facets, with room for `capacity` of `len` candidates.
fn cull(world: &World, stage: &CandidatePairs, listed: &[(u32, Option<u32>)], capacity: u32, len: usize) -> Got {
    cull_in(1, world, stage, listed, capacity, len)
}

/// As [`cull`], each pair of facet and place being listed `times` times.
fn cull_in(
    times: usize,
    world: &World,
    stage: &CandidatePairs,
    listed: &[(u32, Option<u32>)],
    capacity: u32,
    len: usize,
) -> Got {
    cull_lists(world, stage, listed, (times, 0), capacity, len, |_| {})
}

/// As [`cull_in`], with the words of the triangle-texel pairs as `change` leaves them, and as if so many pairs had been listed `before`.
fn cull_lists(
    world: &World,
    stage: &CandidatePairs,
    listed: &[(u32, Option<u32>)],
    (times, before): (usize, u32),
    capacity: u32,
    len: usize,
    change: impl Fn(&mut [u32]),
) -> Got {
    let gpu = world.gpu;
    let facets = world.classify(listed, &[true; MAP * MAP], &[Split::Marked; MAP * MAP]);
    let states = facets.list.read(gpu).expect("readback");
    let undecided = |f: &u32| states[*f as usize].state == FacetState::Undecided as u32;
    let undecided: Vec<u32> = (0..listed.len() as u32).filter(undecided).collect();
    let (once, offsets, mut words) = match stage.places() {
        PairTiles::Texels => in_one_texel(world, &undecided),
        PairTiles::Tiles => in_tiles(world, listed, &undecided),
    };
    change(&mut words);
    let pairs = once.repeat(times);
    let triangles = words.len() / stage.places().words();
    let lists = PairLists::new(&gpu.device, MAP, stage.places(), pairs.len(), triangles, len, false).expect("memory");
    lists.pixel_pairs.write(&gpu.queue, &pairs);
    lists.triangle_pairs.write(&gpu.queue, &words);
    lists.triangle_offsets.write(&gpu.queue, &offsets);
    let mut content = vec![0; TALLY_WORDS];
    (content[0], content[1]) = (pairs.len() as u32, before);
    content.extend(vec![POISON; 2 * len]);
    lists.candidates.write(&gpu.queue, &content);
    let mut frame = world.frame;
    frame.pixel_texel_capacity = pairs.len() as u32;
    frame.triangle_texel_capacity = triangles as u32;
    frame.candidate_capacity = capacity;
    let frame = uniform(gpu, &frame);
    let args = indirect(gpu, pairs.len() as u32);
    if !pairs.is_empty() {
        let indices = &world.casters.triangles;
        run(gpu, |s| {
            stage.record(s, &frame, indices, &world.map_points, &facets, (args.raw(), 0), &lists, triangles as u32)
        });
    }
    let words = lists.candidates.read(gpu).expect("readback");
    let list: Vec<[u32; 2]> = words[TALLY_WORDS..].chunks_exact(2).map(|c| [c[0], c[1]]).collect();
    let mut kept: Vec<_> = list[..(words[1].min(capacity) as usize).min(len)].to_vec();
    kept.sort_unstable();
    let masks = facets.masks.read(gpu).expect("readback");
    let settled =
        (0..listed.len()).map(|f| undecided.contains(&(f as u32)) && masks[3 * f] & !masks[3 * f + 1] == 0).collect();
    Got { kept, tally: words[..TALLY_WORDS].to_vec(), settled, list }
}

/// Pixel-texel pairs, offsets of the places' triangles, and their words.
type Lists = (Vec<[u32; 2]>, Vec<u32>, Vec<u32>);

/// All facets and all triangles in the first texel, wherever they are.
fn in_one_texel(world: &World, undecided: &[u32]) -> Lists {
    let triangles = world.prepared.mesh().triangles.len() as u32;
    let pairs = undecided.iter().map(|&f| [f, 0]).collect();
    (pairs, [vec![0], vec![triangles; MAP * MAP], vec![0]].concat(), (0..triangles).collect())
}

/// Facets and triangles in the tiles that they touch.
fn in_tiles(world: &World, listed: &[(u32, Option<u32>)], undecided: &[u32]) -> Lists {
    let margin = world.margin();
    let mut facets = classified(world, listed, margin);
    // What the GPU knows as undecided is listed, and nothing else.
    for (f, facet) in facets.iter_mut().enumerate() {
        facet.state = if undecided.contains(&(f as u32)) { FacetState::Undecided } else { FacetState::Empty };
    }
    let texels = pairs(&facets, &[Split::Marked; MAP * MAP], MapEnds::of(&world.view.map), margin, false);
    let mut parts = std::collections::BTreeMap::<(u32, usize), u32>::new();
    for (texel, set) in texels.iter().enumerate() {
        let (x, y) = (texel % MAP, texel / MAP);
        for &f in set {
            *parts.entry((f, y / 2 * (MAP / 2) + x / 2)).or_default() |= 1 << (y % 2 * 2 + x % 2);
        }
    }
    let list = parts.into_iter().map(|((f, tile), bits)| [f, (tile as u32) << 4 | bits]).collect();
    let everywhere = vec![Some(f64::INFINITY); MAP * MAP / 4];
    let tiles = tile_pairs(&world.triangles, &everywhere, MapEnds::of(&world.view.map), margin);
    let counts: Vec<u32> = tiles.iter().map(|t| t.len() as u32).collect();
    let code = |p: &TilePair| (p.nearest.max(0.0) as f32).to_bits() >> 16 << 16;
    let words = tiles.iter().flatten().flat_map(|p| [p.cells | code(p), p.triangle]).collect();
    (list, with_total(&counts), words)
}

/// Facets by their definition.
fn classified(world: &World, listed: &[(u32, Option<u32>)], margin: Margin) -> Vec<FacetAtPixel> {
    let around = MapAround {
        triangles: &world.triangles,
        marked: &[true; MAP * MAP],
        splits: &[Split::Marked; MAP * MAP],
        samples: world.samples.offsets(),
        casters: u32::MAX,
    };
    classify(&world.view, &around, listed, margin, false)
}

/// Pairs that matter and were dropped, settled facets that are not all dark, and pairs kept for nothing.
fn faults(world: &World, listed: &[(u32, Option<u32>)], got: &Got) -> [usize; 3] {
    let exact = classified(world, listed, Margin::default());
    let tracer = Tracer::new(world.prepared.mesh()).expect("a tracer");
    let [w, h] = world.view.image;
    let truth = FacetTruth::new(&tracer, &world.camera, &world.light, &world.samples, w, h).expect("truth");
    let mut faults = [0; 3];
    for (f, facet) in exact.iter().enumerate() {
        let Some(own) = facet.triangle.filter(|_| facet.state == FacetState::Undecided && !facet.open) else {
            continue;
        };
        let input = FacetInput { pixel: facet.pixel, triangle: own, coverage: split_mask(full_mask(32)) };
        for t in (0..world.triangles.len() as u32).filter(|&t| t != own) {
            let kept = got.kept.binary_search(&[f as u32, t]).is_ok();
            let triangle = &world.triangles[t as usize];
            if kept {
                let wide = world.margin();
                let wide = Margin { texels: 4.0 * wide.texels + 1e-3, depth: 4.0 * wide.depth + 1e-3 };
                faults[2] += usize::from(!matters(facet, triangle, wide));
            } else if !got.settled[f] && matters(facet, triangle, Margin::default()) {
                let result = truth.judge_among(&input, &[t]);
                let sure = !join_mask(result.ambiguous());
                let (dark, cut) = (join_mask(result.occluded), !join_mask(result.valid));
                let met = join_mask(truth.clone().without_validity().judge_among(&input, &[]).valid);
                faults[0] += usize::from((dark | cut) & sure & met & facet.coverage != 0);
            }
        }
        if got.settled[f] {
            let all: Vec<u32> = (0..world.triangles.len() as u32).collect();
            let result = truth.clone().without_validity().judge_among(&input, &all);
            let lit = join_mask(result.valid) & !join_mask(result.occluded) & !join_mask(result.ambiguous());
            faults[1] += usize::from(lit & facet.coverage != 0);
        }
    }
    faults
}

/// Whether two triangles of the world run through an edge in opposite directions.
fn share_edge(world: &World, s: u32, t: u32) -> bool {
    let [s, t] = [s, t].map(|k| world.prepared.mesh().triangles[k as usize]);
    (0..3).any(|a| (0..3).any(|b| s[a] == t[(b + 1) % 3] && s[(a + 1) % 3] == t[b]))
}

/// Of facets whose samples all lie on their own triangle a neighbour at an edge that faces the light alike is no candidate; of others,
/// and where the two face it differently, it is.
#[gpu_test]
fn neighbours_at_an_edge() {
    use subpixel_shadows::frame::Frame;
    let mut random = Random::new(79);
    let mut found = [[0usize; 2]; 2];
    for round in 0..12 {
        let mut world = world(gpu(), &random_scene(2, &mut random), &mut random);
        let listed = world.seen();
        for alone in [false, true] {
            world.frame.flags = world.frame.flags & !Frame::CLAMP | if alone { Frame::CLAMP } else { 0 };
            let room = 4 * listed.len() * world.triangles.len() + 1;
            let got = cull(&world, &stages()[round % 2], &listed, room as u32, room);
            for [f, t] in got.kept {
                let Some(own) = listed[f as usize].1 else { continue };
                if share_edge(&world, own, t) {
                    let [a, b] = [own, t].map(|k| world.triangles[k as usize].side);
                    found[usize::from(alone)][usize::from(a * b > 0.0)] += 1;
                }
            }
        }
    }
    let [[apart, alike], [apart_alone, alike_alone]] = found;
    assert!(alike > 200 && alike_alone == 0, "{found:?}");
    assert!(apart > 10 && apart_alone * 10 > apart, "{found:?}");
}

/// Where what turns away of closed bodies is no caster, such triangles are left out, no others, and none that cuts a facet.
#[gpu_test]
fn what_turns_away_stays_where_it_cuts() {
    use subpixel_shadows::frame::Frame;
    let mut random = Random::new(80);
    let (mut left_out, mut cutting) = (0, 0);
    for round in 0..64 {
        let mut world = world(gpu(), &random_scene([1, 2][round % 2], &mut random), &mut random);
        let listed = world.seen();
        let exact = classified(&world, &listed, Margin::default());
        let tracer = Tracer::new(world.prepared.mesh()).expect("a tracer");
        let [w, h] = world.view.image;
        let truth = FacetTruth::new(&tracer, &world.camera, &world.light, &world.samples, w, h).expect("truth");
        let room = 4 * listed.len() * world.triangles.len() + 1;
        let [all, few] = [0, Frame::CULL_BACK | Frame::VALIDITY].map(|flags| {
            world.frame.flags |= flags;
            cull(&world, &stages()[round / 2 % 2], &listed, room as u32, room)
        });
        for &[f, t] in &all.kept {
            let Some(own) = exact[f as usize].triangle.filter(|_| !all.settled[f as usize] && !few.settled[f as usize])
            else {
                continue;
            };
            let (of_body, side) = (world.prepared.bodies[t as usize], world.triangles[t as usize].side);
            let coverage = split_mask(full_mask(32));
            let input = FacetInput { pixel: exact[f as usize].pixel, triangle: own, coverage };
            let result = truth.judge_among(&input, &[t]);
            let met = join_mask(truth.clone().without_validity().judge_among(&input, &[]).valid);
            let cuts = !join_mask(result.valid) & !join_mask(result.ambiguous_valid) & met != 0;
            if few.kept.binary_search(&[f, t]).is_err() {
                assert!(of_body && side < 0.0 && !cuts, "round {round}: facet {f}, triangle {t}, side {side}, {cuts}");
                left_out += 1;
            } else if of_body && side < 0.0 {
                cutting += usize::from(cuts);
            }
        }
    }
    assert!(left_out > 1000 && cutting > 20, "{left_out} left out, {cutting} that cut");
}

const PLACES: [PairTiles; 2] = [PairTiles::Texels, PairTiles::Tiles];

/// One for each kind of places.
fn stages() -> &'static [CandidatePairs; 2] {
    static STAGES: std::sync::OnceLock<[CandidatePairs; 2]> = std::sync::OnceLock::new();
    STAGES.get_or_init(|| PLACES.map(|places| CandidatePairs::new(&gpu().device, 1, places, true)))
}

/// As `check`, with pairs that meet by texel and by tile.
#[track_caller]
fn check_both(world: &World, listed: &[(u32, Option<u32>)]) -> (usize, usize) {
    let [texels, tiles] = stages().each_ref().map(|stage| check(world, stage, listed));
    assert!(texels.0 == 0 || tiles.0 > 0, "{} pairs by texel, none by tile", texels.0);
    tiles
}

#[track_caller]
fn check(world: &World, stage: &CandidatePairs, listed: &[(u32, Option<u32>)]) -> (usize, usize) {
    // A pair may be listed again in another place.
    let room = 4 * listed.len() * world.triangles.len() + 1;
    let got = cull(world, stage, listed, room as u32, room);
    assert_eq!(got.kept.len(), got.tally[1] as usize);
    let [dropped, wrong, needless] = faults(world, listed, &got);
    assert_eq!([dropped, wrong], [0, 0], "dropped, settled wrongly");
    // Of slivers rounding may keep one that margins four times as wide do not.
    assert!(100 * needless <= got.kept.len() + 100, "{needless} of {} kept for nothing", got.kept.len());
    (got.kept.len(), got.settled.iter().filter(|s| **s).count())
}

/// More triangles over a place than a driver of the CPU takes in one dispatch: those behind are asked, too.
#[gpu_test]
fn longer_than_a_dispatch() {
    let mut random = Random::new(83);
    let world = world(gpu(), &soup(4800, 0.3, &mut random), &mut random);
    let listed: Vec<_> = world.seen().into_iter().filter(|(_, t)| t.is_some()).step_by(5).collect();
    let of = |profile: Profile| {
        let stage = profile.within(|| CandidatePairs::new(&gpu().device, 1, PairTiles::Texels, true));
        check(&world, &stage, &listed);
        cull(&world, &stage, &listed, 1 << 16, 1 << 16)
    };
    let [gpu, software] = Profile::ALL.map(of);
    assert_eq!(software.kept, gpu.kept);
    assert!(software.kept.iter().any(|[_, t]| *t >= 4096), "nothing behind the first of {} pairs", software.kept.len());
    assert_eq!([software.tally[TALLY_LONGEST as usize], gpu.tally[TALLY_LONGEST as usize]], [4800, 0]);
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(71);
    let world = world(gpu(), &random_scene(0, &mut random), &mut random);
    assert_eq!(check_both(&world, &[]), (0, 0));
    assert_eq!(check_both(&world, &[(3, None)]), (0, 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(72);
    for kind in 0..4 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let seen: Vec<_> = world.seen().into_iter().filter(|s| s.1.is_some()).take(1).collect();
        check_both(&world, &seen);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(73);
    let world = world(gpu(), &crate::support::shadow::soup(20, 0.6, &mut random), &mut random);
    let any = world.anything(193, &mut random);
    for size in sizes_around(64) {
        check_both(&world, &any[..size.min(any.len())]);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(74);
    let (mut kept, mut settled) = (0, 0);
    for kind in 0..24 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let (k, s) = check_both(&world, &world.seen());
        (kept, settled) = (kept + k, settled + s);
    }
    assert!(kept > 1_000 && settled > 0, "{kept} kept, {settled} settled");
}

/// Facets and casters much smaller than a cell, a quarter of a texel, meet wherever in their tile they lie.
#[gpu_test]
fn small_things_meet_in_every_cell() {
    let mut random = Random::new(84);
    let mut mesh = sheet(1, 1.0, |_, _| 0.0, |p| p);
    let middle = DVec3::new(0.2, 0.03, 0.25);
    for _ in 0..300 {
        let at = middle + vector(&mut random) * DVec3::new(0.07, 0.02, 0.05);
        let corners = [at, at + vector(&mut random) * 0.006, at + vector(&mut random) * 0.006];
        add_triangle(&mut mesh, corners.map(|c| c.as_vec3().into()));
    }
    let eye = DVec3::new(0.21, 0.3, 0.26);
    let look = camera(eye, DVec3::new(0.2, 0.0, 0.25), 20.0);
    let light = Light::Directional { direction: [0.1, 1.0, 0.05] };
    let mut world = World::new(gpu(), &mesh, look, light, [32, 24], MAP as u32, samples(32));
    world.frame.flags |= 8;
    let (kept, _) = check(&world, &stages()[1], &world.seen());
    assert!(kept > 300, "{kept} pairs");
}

#[gpu_test]
fn degenerate() {
    let mut random = Random::new(75);
    for round in 0..8 {
        let mut mesh = crate::support::shadow::soup(40, 0.8, &mut random);
        for t in 0..40 {
            let [a, b] = [mesh.positions[3 * t], mesh.positions[3 * t + 1]];
            let by = [0.0, 1e-6, 1e-4, 1e-2][t % 4];
            mesh.positions[3 * t + 2] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + by * (k as f32 - 1.0));
        }
        mesh.triangles.push([1, 1, 1]);
        append(&mut mesh, crate::support::shadow::sheet(1, 2.0, |_, _| -0.6, |p| p));
        let world = world(gpu(), &mesh, &mut random);
        check_both(&world, &if round % 2 == 0 { world.seen() } else { world.anything(100, &mut random) });
    }
}

#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(76);
    let world = world(gpu(), &crate::support::shadow::soup(40, 0.8, &mut random), &mut random);
    let any = world.anything(60, &mut random);
    // Which repetitions of a pair are left out is not the same each time; in one texel there are none.
    let stage = &stages()[0];
    let whole = cull(&world, stage, &any, u32::MAX, 60 * 40);
    let needed = whole.tally[1];
    assert!(needed > 5, "{needed}");
    for capacity in [needed - 1, needed, needed + 1] {
        let got = cull(&world, stage, &any, capacity, needed as usize + 5);
        assert_eq!(got.tally[1], needed, "the need does not depend on the capacity");
        let (inside, beyond) = got.list.split_at(capacity.min(needed) as usize);
        assert!(inside.iter().all(|p| *p != [POISON; 2]), "capacity {capacity}: a candidate is not written");
        assert!(beyond.iter().all(|p| *p == [POISON; 2]), "capacity {capacity}: written past the end");
    }
    // More than can be counted is many, not few.
    for before in [u32::MAX - 2, (1 << 31) - 3] {
        let got = cull_lists(&world, stage, &any, (1, before), 5, 5, |_| {});
        assert!(got.tally[1] >= 1 << 31, "{before} and {needed}: {}", got.tally[1]);
    }
    for capacity in [0, 1, 5] {
        let got = cull(&world, &stages()[1], &any, capacity, needed as usize);
        let (inside, beyond) = got.list.split_at(capacity as usize);
        assert!(inside.iter().all(|p| *p != [POISON; 2]), "capacity {capacity}: a candidate is not written");
        assert!(beyond.iter().all(|p| *p == [POISON; 2]), "capacity {capacity}: written past the end");
    }
}

#[gpu_test]
fn repetitions_are_left_out_and_nothing_else() {
    let mut random = Random::new(79);
    for stage in stages() {
        let (mut once, mut repeated) = (0, 0);
        for kind in 0..8 {
            let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
            let listed = world.seen();
            let mut single = cull(&world, stage, &listed, 1 << 20, 1 << 18);
            let mut many = cull_in(6, &world, stage, &listed, 1 << 20, 1 << 18);
            repeated += many.kept.len();
            single.kept.dedup();
            many.kept.dedup();
            once += single.kept.len();
            // A facet that one triangle settled may have listed others first, or not.
            let open =
                |got: &Got| got.kept.iter().filter(|[f, _]| !got.settled[*f as usize]).copied().collect::<Vec<_>>();
            assert!(open(&many) == open(&single), "another set of pairs");
        }
        assert!(once > 1_000 && repeated < once + once / 2, "{once} pairs, with repetitions {repeated}");
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let mut random = Random::new(77);
    let small = PLACES.map(|places| CandidatePairs::new(&folding_gpu().device, 1, places, true));
    let world = world(folding_gpu(), &crate::support::shadow::soup(30, 0.8, &mut random), &mut random);
    let any = world.anything(500, &mut random);
    assert!(any.len() > 3 * 64);
    for stage in &small {
        check(&world, stage, &any);
    }
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(78);
    let (mut seen, mut spoilt, mut needless) = (0, 0, 0);
    for kind in 0..4 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let listed = world.seen();
        for stage in stages() {
            let mut got = cull(&world, stage, &listed, 1 << 16, 1 << 16);
            assert_eq!(faults(&world, &listed, &got)[..2], [0, 0]);
            let triangles = world.triangles.len() as u32;
            got.kept = (0..listed.len() as u32).flat_map(|f| (0..triangles).map(move |t| [f, t])).collect();
            needless += faults(&world, &listed, &got)[2];
            got.kept.clear();
            seen += faults(&world, &listed, &got)[0];
            got.settled.fill(true);
            seen += faults(&world, &listed, &got)[1];
        }
        // Without cells, and behind all, triangles are not looked at.
        let [cells, depths] = [|w: &mut u32| *w &= !0xffff, |w: &mut u32| *w |= 0xffff << 16].map(|change| {
            let got = cull_lists(&world, &stages()[1], &listed, (1, 0), 1 << 16, 1 << 16, |words| {
                words.iter_mut().step_by(2).for_each(change);
            });
            assert!(got.kept.is_empty(), "{} pairs kept", got.kept.len());
            faults(&world, &listed, &got)[0]
        });
        spoilt += cells.min(depths);
    }
    assert!(seen > 100, "dropping all candidates and settling all facets shows {seen} times");
    assert!(needless > 1000, "keeping all pairs shows {needless} times");
    assert!(spoilt > 100, "spoiling the words of tiles shows {spoilt} times");
}
