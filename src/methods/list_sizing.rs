//! How long the lists of a frame are: a first guess, what a frame left in its counters, and the next guess from that.

mod bands;
mod guess;
mod needs;
mod together;

pub use bands::in_reach;
pub use guess::{first_for, within};
pub use needs::Needs;
pub use together::{Together, Wanted, roomy};

use super::facet_masks::{Capacities, FacetMode, PairVariant, Settings};
use super::output::{Budget, Counts, ListUse};
use crate::stages::SortedPairs;
use crate::stages::facet_classify::{FacetState, Undecided};
use crate::stages::pixel_coverage::Covering;
use crate::stages::pixel_texel_pairs::TALLY_WORDS;
#[cfg(feature = "baselines")]
use crate::status::{Need, StatusHead};
use crate::status::{Status, StatusBand};
use crate::{Error, Result};

/// Most bands a frame may be split into.
pub const MAX_BANDS: u32 = 4096;
/// Most triangles over a place of the map or of a pixel.
pub const MOST_TRIANGLES: u32 = 1 << 20;
/// Triangles by which the lists of a place of the map are longer.
const AT_PLACE: u32 = 4096;
/// Likewise those of a pixel.
const AT_PIXEL: u32 = 512;

/// The lists before anything is known of the scene.
pub fn first(settings: &Settings, budget: Budget) -> Capacities {
    let pixels = settings.pixels();
    let given = budget.start.map(|start| start.clamp(1, u32::MAX as usize));
    let start = given.unwrap_or((pixels * 2).clamp(1 << 12, 1 << 24));
    let all = settings.facets == FacetMode::All;
    let camera = |guess: usize| if all { given.unwrap_or(guess.max(64)) } else { 0 };
    let first = Capacities {
        pixel_pairs: start,
        triangle_pairs: start,
        candidates: start,
        bands: 1,
        views: 1,
        most_at_place: AT_PLACE,
        facets: if all { camera(pixels * 3 / 2) } else { pixels },
        pixel_triangles: camera(pixels * 2),
        complex_pixels: camera(pixels / 4).min(pixels),
        most_at_pixel: AT_PIXEL,
    };
    affordable(settings, budget.bytes, first)
}

/// The pair lists as they are if they take no more than `budget` bytes together, else each as much shorter as makes them fit; a
/// frame that needs more then takes more bands.
fn affordable(settings: &Settings, budget: u64, c: Capacities) -> Capacities {
    let (p, t, n) = of_lists(c);
    let share = budget as f64 / pair_bytes(settings, (p, t, n)).max(1) as f64;
    if share >= 1.0 {
        return c;
    }
    let [pixel_pairs, triangle_pairs, candidates] = [p, t, n].map(|list| ((list as f64 * share) as usize).max(1));
    Capacities { pixel_pairs, triangle_pairs, candidates, ..c }
}

/// The capacities with which nothing is left out, if they are not the ones in use. `needs` are those of a frame with the capacities
/// `now`; the pair lists may take `budget` bytes.
///
/// # Errors
/// [`Error::Memory`] if the lists fit in no way, [`Error::Limit`] for more than [`MOST_TRIANGLES`] over one place or pixel.
pub fn wanted(
    needs: &Needs,
    now: Capacities,
    settings: &Settings,
    limits: &wgpu::Limits,
    budget: u64,
) -> Result<Option<Capacities>> {
    if let Some(wanted) = wanted_of_camera(needs, now, settings, limits)? {
        return Ok(Some(wanted));
    }
    let Needs { pixel_pairs, triangle_pairs, candidates, longest, .. } = *needs;
    let most_at_place = most(longest, AT_PLACE, "triangles over one place of the map")?;
    let fits = pixel_pairs <= now.pixel_pairs as u64
        && triangle_pairs <= now.triangle_pairs as u64
        && candidates <= now.candidates as u64;
    if fits && most_at_place <= now.most_at_place {
        return Ok(None);
    }
    let mut wanted = Capacities { most_at_place: most_at_place.max(now.most_at_place), ..now };
    let binding = largest_binding(limits);
    let lists = |slack: fn(u64) -> u64, shrink: bool| {
        let grown = |need: u64, have: usize| {
            if shrink || need > have as u64 { (need + slack(need)).max(1) } else { have as u64 }
        };
        let (p, t) = (grown(pixel_pairs, now.pixel_pairs), grown(triangle_pairs, now.triangle_pairs));
        (p, t, grown(candidates, now.candidates))
    };
    let bytes_of = |lists: (u64, u64, u64)| pair_bytes(settings, lists);
    let fits = |(p, t, c): (u64, u64, u64)| bytes_of((p, t, c)) <= budget && bound(settings, binding, (p, t, c));
    // An eighth more than was needed if there is room for it; no less than there is, unless another list needs the room.
    let least = lists(|_| 0, true);
    let ways = [lists(|need| need / 8, false), lists(|_| 0, false), lists(|need| need / 8, true)];
    let (p, t, c) = ways.into_iter().find(|&way| fits(way)).unwrap_or(least);
    let bytes = bytes_of((p, t, c));
    if !fits((p, t, c)) {
        if now.bands >= MAX_BANDS {
            return Err(Error::Memory { what: "pair lists".to_owned(), needed: bytes, limit: budget });
        }
        // As many as it takes if the need spreads evenly; then twice as many each time.
        let share = bytes.div_ceil(budget.min(binding).max(1)).next_power_of_two().clamp(2, 64) as u32;
        wanted.bands = (now.bands * share).min(MAX_BANDS);
    } else {
        (wanted.pixel_pairs, wanted.triangle_pairs, wanted.candidates) = (p as usize, t as usize, c as usize);
    }
    Ok(Some(wanted))
}

/// Bytes of lists of so many pixel-texel pairs, triangle-texel pairs and candidates, with what it takes to sort them.
fn pair_bytes(settings: &Settings, (p, t, c): (u64, u64, u64)) -> u64 {
    let sorted = match settings.pairs {
        PairVariant::Tiled | PairVariant::Grouped => 0,
        PairVariant::Sorted => {
            t.saturating_mul(SortedPairs::BYTES[0]).saturating_add(p.saturating_mul(SortedPairs::BYTES[1]))
        }
    };
    // Each pair takes two bytes more of what is found once (`PairLists::touched`), each candidate four of doubts and four of cuts.
    let candidate = if settings.keeps_validity() { 16 } else { 12 };
    let [p, t, c] =
        [p.saturating_mul(10), t.saturating_mul(2 + triangle_pair_bytes(settings)), c.saturating_mul(candidate)];
    p.saturating_add(t).saturating_add(c).saturating_add(sorted)
}

fn triangle_pair_bytes(settings: &Settings) -> u64 {
    4 * settings.pairs.places().words() as u64
}

/// The capacities with which the camera's lists hold every surface, if they are not the ones in use. What comes after
/// these lists has seen a part of them only.
fn wanted_of_camera(
    of_frame: &Needs,
    now: Capacities,
    settings: &Settings,
    limits: &wgpu::Limits,
) -> Result<Option<Capacities>> {
    if settings.facets == FacetMode::One {
        return Ok(None);
    }
    let most_at_pixel = most(of_frame.longest_pixel, AT_PIXEL, "triangles over one pixel")?;
    let needs = of_frame.camera;
    let have = [now.pixel_triangles, now.complex_pixels, now.facets];
    let fits = needs.iter().zip(have).all(|(&need, have)| need <= have as u64);
    if fits && most_at_pixel <= now.most_at_pixel {
        return Ok(None);
    }
    let grown = |k: usize| {
        let need = needs[k];
        if need > have[k] as u64 { (need + need / 8) as usize } else { have[k] }
    };
    // No more slack than one binding holds.
    let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) as usize;
    let most_facets = (binding / size_of::<Undecided>()).max(needs[2] as usize);
    let most_listed = (binding / listed_bytes(settings)).max(needs[0] as usize);
    Ok(Some(Capacities {
        pixel_triangles: grown(0).min(most_listed),
        complex_pixels: grown(1).min(settings.pixels()),
        facets: grown(2).min(most_facets),
        most_at_pixel: most_at_pixel.max(now.most_at_pixel),
        ..now
    }))
}

/// Bytes of the widest list of what covers samples, a triangle.
fn listed_bytes(settings: &Settings) -> usize {
    size_of::<Covering>().max(4 * settings.samples.words() as usize)
}

/// Length in steps that holds a longest list.
fn most(longest: u32, step: u32, what: &str) -> Result<u32> {
    if longest > MOST_TRIANGLES {
        let [needed, limit] = [longest, MOST_TRIANGLES].map(u64::from);
        return Err(Error::Limit { what: what.to_owned(), needed, limit });
    }
    Ok(longest.max(1).next_multiple_of(step))
}

fn largest_binding(limits: &wgpu::Limits) -> u64 {
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// The longest pixel-texel pairs, triangle-texel pairs and candidates that a binding of so many bytes holds.
fn longest_lists(settings: &Settings, binding: u64) -> [u64; 3] {
    [(8, 0), (triangle_pair_bytes(settings), 0), (8, 4 * TALLY_WORDS as u64)]
        .map(|(bytes, head)| binding.saturating_sub(head) / bytes)
}

/// Whether a binding of so many bytes holds each of these lists.
fn bound(settings: &Settings, binding: u64, (p, t, c): (u64, u64, u64)) -> bool {
    [p, t, c].iter().zip(longest_lists(settings, binding)).all(|(&list, most)| list <= most)
}

/// Pixel-texel pairs, triangle-texel pairs and candidates.
fn of_lists(c: Capacities) -> (u64, u64, u64) {
    (c.pixel_pairs as u64, c.triangle_pairs as u64, c.candidates as u64)
}

/// Lists of what the camera sees alone, to begin with.
#[cfg(feature = "baselines")]
pub fn of_surfaces(pixels: usize) -> Capacities {
    Capacities {
        facets: pixels + pixels / 2 + 64,
        pixel_triangles: 2 * pixels + 64,
        complex_pixels: pixels / 2 + 64,
        most_at_pixel: AT_PIXEL,
        ..Capacities::NONE
    }
}

/// Longer lists of what the camera sees, those of facets longer in any case; `None` if they held what the frame needed.
///
/// # Errors
/// [`Error::Limit`] for more triangles over a pixel, or more of all pixels, than can be listed.
#[cfg(feature = "baselines")]
pub fn more_surfaces(head: &StatusHead, now: Capacities) -> Result<Option<Capacities>> {
    let needed = [head.pixel_triangles, head.complex_pixels, head.facets_needed];
    let had = [now.pixel_triangles, now.complex_pixels, now.facets];
    let short = needed.iter().zip(had).any(|(need, had)| need.items() > had as u64);
    if !short && head.longest_pixel <= now.most_at_pixel {
        return Ok(None);
    }
    if needed.iter().any(|need| need.over != 0) {
        let what = "triangles over the samples of all pixels".to_owned();
        return Err(Error::Limit { what, needed: 1 << 32, limit: u64::from(u32::MAX) });
    }
    let longer = |need: Need, had: usize| had.max(need.items() as usize + need.items() as usize / 8 + 64);
    let most_at_pixel = most(head.longest_pixel, AT_PIXEL, "triangles over one pixel")?;
    Ok(Some(Capacities {
        pixel_triangles: longer(needed[0], had[0]),
        complex_pixels: longer(needed[1], had[1]),
        facets: longer(needed[2], had[2]).max(had[2] + 1),
        most_at_pixel: now.most_at_pixel.max(most_at_pixel),
        ..now
    }))
}

/// As `wanted`, with a guess of what the lists after one that was too short would have needed: as many times more as that one
/// did. Stays as it is where that does not fit.
pub fn ahead(
    needs: &Needs,
    now: Capacities,
    wanted: Capacities,
    settings: &Settings,
    limits: &wgpu::Limits,
    budget: u64,
) -> Capacities {
    let share = |needed: u64, had: usize| (needed as f64 / had.max(1) as f64).max(1.0);
    let Needs { pixel_pairs, triangle_pairs, candidates, .. } = *needs;
    let camera = match settings.facets {
        FacetMode::One => 1.0,
        FacetMode::All => {
            let had = [now.pixel_triangles, now.complex_pixels, now.facets];
            needs.camera.into_iter().zip(had).map(|(needed, had)| share(needed, had)).fold(1.0, f64::max)
        }
    };
    // Where pairs were left out, more than their share of candidates was.
    let pairs = share(pixel_pairs, now.pixel_pairs).max(share(triangle_pairs, now.triangle_pairs)).powf(1.5);
    // The facets that were left out are those of crowded pixels, which make more pairs than the others.
    let slack = if camera > 1.0 { 1.5 } else { 1.125 };
    let guess = |needed: u64, times: f64, least: usize| ((needed as f64 * times * slack) as usize).max(least);
    let mut more = Capacities {
        pixel_pairs: guess(pixel_pairs, camera, wanted.pixel_pairs),
        triangle_pairs: guess(triangle_pairs, camera, wanted.triangle_pairs),
        candidates: guess(candidates, camera * pairs, wanted.candidates),
        ..wanted
    };
    if camera * pairs > 1.0 {
        more.candidates = more.candidates.max(2 * more.pixel_pairs);
    }
    let lists = of_lists(more);
    let fits = pair_bytes(settings, lists) <= budget && bound(settings, largest_binding(limits), lists);
    if fits && wanted.bands == now.bands { more } else { wanted }
}

/// The larger of two in each list.
pub fn larger(a: Capacities, b: Capacities) -> Capacities {
    Capacities {
        pixel_pairs: a.pixel_pairs.max(b.pixel_pairs),
        triangle_pairs: a.triangle_pairs.max(b.triangle_pairs),
        candidates: a.candidates.max(b.candidates),
        bands: a.bands.max(b.bands),
        views: a.views,
        most_at_place: a.most_at_place.max(b.most_at_place),
        facets: a.facets.max(b.facets),
        pixel_triangles: a.pixel_triangles.max(b.pixel_triangles),
        complex_pixels: a.complex_pixels.max(b.complex_pixels),
        most_at_pixel: a.most_at_pixel.max(b.most_at_pixel),
    }
}

/// Counts of a frame.
pub fn counts(status: &Status) -> Counts {
    let sum = |of: fn(&StatusBand) -> u32| status.bands.iter().map(|band| u64::from(of(band))).sum::<u64>();
    let head = &status.head;
    let state = |s: FacetState| u64::from(head.facets[s as usize]);
    Counts {
        kept_triangles: u64::from(head.kept_triangles),
        silhouette_edges: u64::from(head.silhouette_edges),
        silhouette_texels: sum(|band| band.marked_texels),
        silhouette_pixels: state(FacetState::Undecided),
        pixel_texel_pairs: sum(|band| band.pixel_pairs.items),
        triangle_texel_pairs: sum(|band| band.triangle_pairs.items),
        candidate_tests: u64::from(head.candidate_tests[0]) | u64::from(head.candidate_tests[1]) << 32,
        visibility_evaluations: sum(|band| band.candidates),
        refined_evaluations: sum(|band| band.doubts),
        facets: FacetState::ALL.iter().map(|&s| state(s)).sum(),
        complex_pixels: u64::from(head.complex_pixels.items),
        empty_facets: state(FacetState::Empty),
        dark_facets: state(FacetState::Dark),
        lit_facets: state(FacetState::Lit),
        shadowed_facets: state(FacetState::Shadowed),
        ..Counts::default()
    }
}

/// How the lists of a frame with the capacities `now` fared, after `runs` runs.
pub fn lists(needs: &Needs, now: Capacities, facets: FacetMode, runs: u32) -> Vec<ListUse> {
    let Needs { pixel_pairs, triangle_pairs, candidates, .. } = *needs;
    let list = |name, needed, capacity: usize| ListUse { name, needed, capacity: capacity as u64, runs };
    let mut lists = vec![
        list("pixel_texel_pairs", pixel_pairs, now.pixel_pairs),
        list("triangle_texel_pairs", triangle_pairs, now.triangle_pairs),
        list("candidate_pairs", candidates, now.candidates),
    ];
    if facets == FacetMode::All {
        let [triangles, complex, facets] = needs.camera;
        lists.push(list("pixel_triangles", triangles, now.pixel_triangles));
        lists.push(list("complex_pixels", complex, now.complex_pixels));
        lists.push(list("facets", facets, now.facets));
    }
    lists
}

/// A guess of the lists of a strip with this share of the rows of that of which `wanted` tells. Facets are as many as pixels, if each
/// has one.
pub fn of_rows(wanted: Capacities, share: f64, facets: FacetMode) -> Capacities {
    let of = |list: usize| (list as f64 * share * 1.25) as usize;
    let of_camera = |list: usize| if facets == FacetMode::All { of(list) } else { 0 };
    Capacities {
        pixel_pairs: of(wanted.pixel_pairs),
        triangle_pairs: of(wanted.triangle_pairs),
        candidates: of(wanted.candidates),
        facets: of_camera(wanted.facets),
        pixel_triangles: of_camera(wanted.pixel_triangles),
        complex_pixels: of_camera(wanted.complex_pixels),
        ..wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{Pattern, Samples};
    use crate::status::StatusHead;

    fn of(pairs: PairVariant) -> Settings {
        let samples = Samples::new(Pattern::default(), 32).expect("32 samples");
        Settings { pairs, facets: FacetMode::One, ..Settings::new([800, 600], 512, samples) }
    }

    fn bytes(settings: &Settings, c: Capacities) -> u64 {
        pair_bytes(settings, (c.pixel_pairs as u64, c.triangle_pairs as u64, c.candidates as u64))
    }

    /// The first lists take no more than the budget either, and with room enough as much as without one.
    #[test]
    fn first_lists_keep_to_the_budget() {
        for pairs in [PairVariant::Tiled, PairVariant::Grouped, PairVariant::Sorted] {
            let settings = of(pairs);
            let ample = first_for(&settings, Budget::default(), 1 << 20);
            assert!(bytes(&settings, ample) > 16 << 20, "{ample:?}");
            for megabytes in [1, 7, 16] {
                let budget = Budget { bytes: megabytes << 20, ..Budget::default() };
                for first in [first(&settings, budget), first_for(&settings, budget, 1 << 20)] {
                    let taken = bytes(&settings, first);
                    assert!(taken <= budget.bytes && 100 * taken > 99 * budget.bytes, "{taken} of {budget:?}");
                }
            }
            let none = first(&settings, Budget { bytes: 0, ..Budget::default() });
            assert_eq!([none.pixel_pairs, none.triangle_pairs, none.candidates], [1; 3]);
        }
    }

    /// Too many triangles over a texel or a pixel are no want of memory.
    #[test]
    fn lists_without_end_are_refused() {
        let limits = wgpu::Limits::default();
        let refused = |facets, status: Status| {
            let settings = Settings { facets, ..of(PairVariant::Tiled) };
            let now = first(&settings, Budget::default());
            wanted(&Needs::of(&status), now, &settings, &limits, 1 << 30)
                .map(|more| more.map(|c| [c.most_at_place, c.most_at_pixel]))
        };
        let longest =
            |longest| Status { bands: vec![StatusBand { longest, ..StatusBand::default() }], ..Status::default() };
        let most = MOST_TRIANGLES;
        assert!(refused(FacetMode::One, longest(most)).is_ok_and(|more| more == Some([most, AT_PIXEL])));
        assert!(
            matches!(refused(FacetMode::One, longest(most + 1)), Err(Error::Limit { needed, limit, .. }) if needed == limit + 1)
        );
        let of_pixel =
            |longest_pixel| Status { head: StatusHead { longest_pixel, ..StatusHead::default() }, bands: Vec::new() };
        assert!(refused(FacetMode::All, of_pixel(most)).is_ok_and(|more| more == Some([AT_PLACE, most])));
        assert!(
            matches!(refused(FacetMode::All, of_pixel(most + 1)), Err(Error::Limit { needed, limit, .. }) if needed == limit + 1)
        );
    }

    /// Two frames that take turns, of which one needs many pairs of facets and the other many of triangles: what holds either alone
    /// does not hold both, so that lists sized for the last one never come to rest.
    #[test]
    fn frames_that_take_turns_come_to_rest() {
        let (settings, limits, budget) = (of(PairVariant::Tiled), wgpu::Limits::default(), 3 << 20);
        let needs = |frame: usize, bands: u32| {
            let of = |pairs: u64| pairs.div_ceil(u64::from(bands));
            let [pixel_pairs, triangle_pairs] = [[200_000, 1_000], [1_000, 200_000]][frame % 2].map(of);
            Needs { pixel_pairs, triangle_pairs, candidates: of(1_000), ..Needs::default() }
        };
        // Frames until both fit, and the bands of it.
        let frames = |together: bool| {
            let mut now = first(&settings, Budget { start: Some(16), bytes: budget });
            let (mut all, mut fitted) = (Together::default(), 0);
            for frame in 0..100 {
                all = if together { all } else { Together::default() };
                match all.wanted(needs(frame, now.bands), now, &settings, &limits, (budget, 1000)) {
                    None => fitted += 1,
                    Some(more) => (now, fitted) = (more.capacities, 0),
                }
                assert!(bytes(&settings, now) <= budget);
                if fitted == 2 {
                    return Some((frame, now.bands));
                }
            }
            None
        };
        assert_eq!(frames(false), None);
        assert!(frames(true).is_some_and(|(frames, bands)| frames < 10 && bands == 2), "{:?}", frames(true));
    }

    /// No start is too large to be counted.
    #[test]
    fn lists_begin_with_what_can_be_counted() {
        for start in [0, 1, usize::MAX] {
            let budget = Budget { start: Some(start), bytes: u64::MAX };
            let first = first(&of(PairVariant::Sorted), budget);
            assert_eq!(first.pixel_pairs, start.clamp(1, u32::MAX as usize));
        }
        assert_eq!(pair_bytes(&of(PairVariant::Sorted), (u64::MAX, 1, 1)), u64::MAX);
    }
}
