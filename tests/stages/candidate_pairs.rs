//! Candidates: every triangle that shadows or cuts a facet is kept, and a facet settled by one triangle is all dark.
//!
//! The list is no set of its own right: what must hold is that nothing that matters is dropped (the facet truth, and the
//! definition without margins, say what matters) and that little that does not is kept (the definition with twice the
//! margins).

use crate::support::shadow::{
    World, append, camera, folding_gpu, indirect, random_light, random_scene, samples, uniform, unit, vector,
};
use crate::support::{POISON, Random, gpu, run, sizes_around};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::reference::candidate_pairs::matters;
use subpixel_shadows::reference::facet_classify::{Facet, Surroundings, classify};
use subpixel_shadows::reference::front_layer::{Margin, Split};
use subpixel_shadows::scene::Mesh;
use subpixel_shadows::stages::candidate_pairs::CandidatePairs;
use subpixel_shadows::stages::facet_classify::State;
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, TALLY_WORDS};
use subpixel_shadows::truth::{FacetInput, FacetTruth, Tracer, full_mask, join_mask, split_mask};

/// What the GPU made of one map of one texel: (facet, triangle) rising, the tally, and the facets it settled.
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

/// As [`cull`], each facet being paired with the texel `times` times, as with so many texels of one list.
fn cull_in(
    times: usize,
    world: &World,
    stage: &CandidatePairs,
    listed: &[(u32, Option<u32>)],
    capacity: u32,
    len: usize,
) -> Got {
    let gpu = world.gpu;
    let facets = world.classify(listed, &[true; MAP * MAP], &[Split::Marked; MAP * MAP]);
    let states = facets.list.read(gpu).expect("readback");
    let undecided = |f: &u32| states[*f as usize].state == State::Undecided as u32;
    let once: Vec<[u32; 2]> = (0..listed.len() as u32).filter(undecided).map(|f| [f, 0]).collect();
    let pairs = once.repeat(times);
    let triangles = world.prepared.mesh.triangles.len() as u32;
    let lists = PairLists::new(&gpu.device, MAP, pairs.len(), triangles as usize, len).expect("memory");
    lists.pixel_pairs.write(&gpu.queue, &pairs);
    lists.triangle_pairs.write(&gpu.queue, &(0..triangles).collect::<Vec<_>>());
    // All triangles are in the list of texel 0, and so is every facet.
    lists.triangle_offsets.write(&gpu.queue, &[vec![0], vec![triangles; MAP * MAP], vec![0]].concat());
    let mut content = vec![0; TALLY_WORDS];
    content[0] = pairs.len() as u32;
    content.extend(vec![POISON; 2 * len]);
    lists.candidates.write(&gpu.queue, &content);
    let mut frame = world.frame;
    frame.pixel_texel_capacity = pairs.len() as u32;
    frame.triangle_texel_capacity = triangles;
    frame.candidate_capacity = capacity;
    let frame = uniform(gpu, &frame);
    let args = indirect(gpu, pairs.len() as u32);
    if !pairs.is_empty() {
        let indices = world.casters.triangles.raw();
        run(gpu, |s| stage.record(s, frame.raw(), indices, &world.map_points, &facets, (args.raw(), 0), &lists));
    }
    let words = lists.candidates.read(gpu).expect("readback");
    let list: Vec<[u32; 2]> = words[TALLY_WORDS..].chunks_exact(2).map(|c| [c[0], c[1]]).collect();
    let mut kept: Vec<_> = list[..(words[1].min(capacity) as usize).min(len)].to_vec();
    kept.sort_unstable();
    let masks = facets.masks.read(gpu).expect("readback");
    let settled = (0..listed.len()).map(|f| undecided(&(f as u32)) && masks[3 * f] & !masks[3 * f + 1] == 0).collect();
    Got { kept, tally: words[..TALLY_WORDS].to_vec(), settled, list }
}

/// Pairs that matter and were dropped, settled facets that are not all dark, and pairs kept for nothing.
fn faults(world: &World, listed: &[(u32, Option<u32>)], got: &Got) -> [usize; 3] {
    let by = |margin: Margin| -> Vec<Facet> {
        let around = Surroundings {
            triangles: &world.triangles,
            marked: &[true; MAP * MAP],
            splits: &[Split::Marked; MAP * MAP],
            samples: world.samples.offsets(),
            casters: u32::MAX,
        };
        classify(&world.view, &around, listed, margin, false)
    };
    let exact = by(Margin::default());
    let tracer = Tracer::new(&world.prepared.mesh).expect("a tracer");
    let [w, h] = world.view.image;
    let truth = FacetTruth::new(&tracer, &world.camera, &world.light, &world.samples, w, h).expect("truth");
    let mut faults = [0; 3];
    for (f, facet) in exact.iter().enumerate() {
        let Some(own) = facet.triangle.filter(|_| facet.state == State::Undecided.into_reference() && !facet.open)
        else {
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

trait IntoReference {
    fn into_reference(self) -> subpixel_shadows::reference::facet_classify::State;
}

impl IntoReference for State {
    fn into_reference(self) -> subpixel_shadows::reference::facet_classify::State {
        use subpixel_shadows::reference::facet_classify::State as R;
        [R::Empty, R::Dark, R::Lit, R::Shadowed, R::Undecided][self as usize]
    }
}

fn stage() -> &'static CandidatePairs {
    static STAGE: std::sync::OnceLock<CandidatePairs> = std::sync::OnceLock::new();
    STAGE.get_or_init(|| CandidatePairs::new(&gpu().device, 1))
}

#[track_caller]
fn check(world: &World, stage: &CandidatePairs, listed: &[(u32, Option<u32>)]) -> (usize, usize) {
    let room = listed.len() * world.triangles.len() + 1;
    let got = cull(world, stage, listed, room as u32, room);
    assert_eq!(got.kept.len(), got.tally[1] as usize);
    assert_eq!(faults(world, listed, &got)[..2], [0, 0], "dropped, settled wrongly");
    (got.kept.len(), got.settled.iter().filter(|s| **s).count())
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn empty() {
    let mut random = Random::new(71);
    let world = world(gpu(), &random_scene(0, &mut random), &mut random);
    assert_eq!(check(&world, stage(), &[]), (0, 0));
    assert_eq!(check(&world, stage(), &[(3, None)]), (0, 0));
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn one() {
    let mut random = Random::new(72);
    for kind in 0..4 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let seen: Vec<_> = world.seen().into_iter().filter(|s| s.1.is_some()).take(1).collect();
        check(&world, stage(), &seen);
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn every_size_around_workgroup() {
    let mut random = Random::new(73);
    let world = world(gpu(), &crate::support::shadow::soup(20, 0.6, &mut random), &mut random);
    let any = world.anything(193, &mut random);
    for size in sizes_around(64) {
        check(&world, stage(), &any[..size.min(any.len())]);
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn random_seeded() {
    let mut random = Random::new(74);
    let (mut kept, mut settled) = (0, 0);
    for kind in 0..24 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let (k, s) = check(&world, stage(), &world.seen());
        (kept, settled) = (kept + k, settled + s);
    }
    assert!(kept > 1_000 && settled > 0, "{kept} kept, {settled} settled");
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
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
        check(&world, stage(), &if round % 2 == 0 { world.seen() } else { world.anything(100, &mut random) });
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn overflow_by_one() {
    let mut random = Random::new(76);
    let world = world(gpu(), &crate::support::shadow::soup(40, 0.8, &mut random), &mut random);
    let any = world.anything(60, &mut random);
    let whole = cull(&world, stage(), &any, u32::MAX, 60 * 40);
    let needed = whole.tally[1];
    assert!(needed > 5, "{needed}");
    for capacity in [needed - 1, needed, needed + 1] {
        let got = cull(&world, stage(), &any, capacity, needed as usize + 5);
        assert_eq!(got.tally[1], needed, "the need does not depend on the capacity");
        let (inside, beyond) = got.list.split_at(capacity.min(needed) as usize);
        assert!(inside.iter().all(|p| *p != [POISON; 2]), "capacity {capacity}: a candidate is not written");
        assert!(beyond.iter().all(|p| *p == [POISON; 2]), "capacity {capacity}: written past the end");
    }
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn repetitions_are_left_out_and_nothing_else() {
    let mut random = Random::new(79);
    let (mut once, mut repeated) = (0, 0);
    for kind in 0..8 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let listed = world.seen();
        let single = cull(&world, stage(), &listed, 1 << 20, 1 << 18);
        let mut many = cull_in(6, &world, stage(), &listed, 1 << 20, 1 << 18);
        once += single.kept.len();
        repeated += many.kept.len();
        many.kept.dedup();
        // A facet that one triangle settled may have listed others first, or not.
        let open = |got: &Got| got.kept.iter().filter(|[f, _]| !got.settled[*f as usize]).copied().collect::<Vec<_>>();
        assert!(open(&many) == open(&single), "another set of pairs");
    }
    assert!(once > 1_000 && repeated < once + once / 2, "{once} pairs, with repetitions {repeated}");
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn two_d_dispatch() {
    let mut random = Random::new(77);
    let small = CandidatePairs::new(&folding_gpu().device, 1);
    let world = world(folding_gpu(), &crate::support::shadow::soup(30, 0.8, &mut random), &mut random);
    let any = world.anything(500, &mut random);
    assert!(any.len() > 3 * 64);
    check(&world, &small, &any);
}

#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn detects_corruption() {
    let mut random = Random::new(78);
    let mut seen = 0;
    for kind in 0..4 {
        let world = world(gpu(), &random_scene(kind, &mut random), &mut random);
        let listed = world.seen();
        let mut got = cull(&world, stage(), &listed, 1 << 16, 1 << 16);
        assert_eq!(faults(&world, &listed, &got)[..2], [0, 0]);
        got.kept.clear();
        seen += faults(&world, &listed, &got)[0];
        got.settled.fill(true);
        seen += faults(&world, &listed, &got)[1];
    }
    assert!(seen > 100, "dropping all candidates and settling all facets shows {seen} times");
}
