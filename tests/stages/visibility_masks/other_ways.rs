//! Masks from a table, and the two projections of the paper.

use super::*;

/// Of a facet's samples those in the shadow of any caster by the definition of the two projections, and those within the
/// ambiguity band of one of its lines.
fn by_two_steps(world: &World, facet: &reference::FacetAtPixel) -> [u128; 2] {
    let (mut shadowed, mut near) = (0, 0);
    let Some(own) = facet.triangle else { return [0, 0] };
    let corners = |t: u32| world.triangles[t as usize].corners;
    for t in (0..world.triangles.len() as u32).filter(|t| *t != own) {
        let (Some(own), Some(caster)) = (corners(own), corners(t)) else { continue };
        let Some((edges, line)) = two_step(&world.view, facet, own, caster) else { continue };
        for (k, [x, y]) in world.samples.offsets().iter().enumerate() {
            let at = |l: DVec3| (l.x + l.y * (f64::from(*x) - 0.5) + l.z * (f64::from(*y) - 0.5)) / l.y.hypot(l.z);
            let inside = edges.into_iter().chain(line).map(at).fold(f64::INFINITY, f64::min);
            shadowed |= u128::from(inside > 0.0) << k;
            near |= u128::from(inside.abs() <= AMBIGUITY) << k;
        }
    }
    [shadowed, near]
}

/// Masks from a table are those of the exact test but for samples near a line: few of a fine table, more of a coarse one, and
/// most are others where the table's entries are moved.
#[gpu_test]
fn tables_hold_nearly_the_exact_masks() {
    for count in [8, 32, 64, 128] {
        let mut random = Random::new(u64::from(count));
        let mut cases = vec![boxes_case()];
        cases.extend((0..8).map(|_| soup_case(30, 0.4, &mut random)));
        let worlds: Vec<World> = cases.into_iter().map(|case| world(case, [64, 48], samples(count))).collect();
        let exact: Vec<Masks> = worlds.iter().map(|w| evaluate(w, &w.seen(), false).0).collect();
        // Bits that differ, of a facet that some but not all of whose samples are occluded, on average.
        let off = |size: [u32; 2], moved: usize| {
            let stage = VisibilityMasks::new(&gpu().device, count, size);
            let mut table = mask_table(&samples(count), size);
            table.rotate_right(moved);
            let table = upload(gpu(), &table);
            let (mut bits, mut facets) = (0, 0);
            for (world, exact) in worlds.iter().zip(&exact) {
                let (got, _) = evaluate_with(&stage, &table, world, &world.seen(), false);
                assert_eq!(got.len(), exact.len());
                for ((_, [coverage, ours, _]), (state, [_, sure, _])) in got.iter().zip(exact) {
                    let partial =
                        *state == FacetState::Undecided as u32 && sure & coverage != 0 && sure & coverage != *coverage;
                    bits += if partial { ((ours ^ sure) & coverage).count_ones() } else { 0 };
                    facets += u32::from(partial);
                }
            }
            assert!(facets > 100, "{facets} facets in part occluded");
            f64::from(bits) / f64::from(facets)
        };
        let words = samples(count).words() as usize;
        let [fine, coarse] = [off(MaskVariant::TABLE.size(), 0), off([16, 16], 0)];
        let [turned, shifted] = [off([256, 256], 64 * 256 * words), off([256, 256], 64 * words)];
        println!("{count} samples: {fine:.3} bits off, coarse {coarse:.3}, moved {turned:.3} and {shifted:.3}");
        let share = f64::from(count) / 32.0;
        assert!(fine < 0.3 * share.max(1.0), "{count} samples: {fine} bits of a mask are off");
        assert!(coarse > 2.0 * fine && turned > 10.0 * fine && shifted > 10.0 * fine, "{count} samples: not noticed");
    }
}

/// The paper's two projections against their definition in `f64` on benign scenes, and against the truth: what they bound is
/// the same shadow.
#[gpu_test]
fn two_projections_are_as_defined() {
    let two_step = VisibilityMasks::two_step(&gpu().device, 32, [0, 0]);
    let mut random = Random::new(77);
    let mut cases = vec![boxes_case()];
    cases.extend((0..6).map(|_| soup_case(30, 0.4, &mut random)));
    let (mut samples_compared, mut shadowed) = (0, 0);
    for case in cases {
        let world = world(case, [32, 24], samples(32));
        let listed = world.seen();
        let (got, _) = evaluate_by(&two_step, &world, &listed, false);
        let texels = (world.view.map.map_size as usize).pow(2);
        let (marked, splits) = (vec![true; texels], vec![Split::Marked; texels]);
        let around = reference::MapAround {
            triangles: &world.triangles,
            marked: &marked,
            splits: &splits,
            samples: world.samples.offsets(),
            casters: u32::MAX,
        };
        let facets = reference::classify(&world.view, &around, &listed, world.margin(), false);
        let (mut wrong, mut corrupted) = (0, 0);
        for (facet, (state, [coverage, occluded, _])) in facets.iter().zip(&got) {
            if *state != FacetState::Undecided as u32 || facet.open {
                continue;
            }
            let [wanted, near] = by_two_steps(&world, facet);
            let clear = coverage & !near;
            wrong += ((occluded ^ wanted) & clear).count_ones();
            corrupted += ((!occluded ^ wanted) & clear).count_ones();
            samples_compared += clear.count_ones();
            shadowed += (wanted & clear).count_ones();
        }
        assert_eq!(wrong, 0);
        assert!(corrupted > 1000, "flipped masks pass");
        assert_eq!(judge(&world, &listed, &got, false).wrong_occluded, 0, "against the truth");
    }
    assert!(samples_compared > 20_000 && shadowed > 500, "{shadowed} of {samples_compared}");
}
