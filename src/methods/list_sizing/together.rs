//! Needs of frames together, of the lists that they use one after the other.

use super::{
    AT_PIXEL, AT_PLACE, Capacities, FacetMode, MOST_TRIANGLES, Needs, Settings, Undecided, ahead, bound, in_reach,
    largest_binding, listed_bytes, of_lists, pair_bytes, wanted,
};

/// As `c`, where a list of which more than seven eighths are needed has room for a quarter more than that, so that a frame which needs
/// a little more than those before is complete. Stays as it is where that does not fit.
pub fn roomy(needs: &Needs, c: Capacities, settings: &Settings, limits: &wgpu::Limits, budget: u64) -> Capacities {
    let room = |need: u64, have: usize| {
        let full = need.saturating_mul(8) > (have as u64).saturating_mul(7);
        if full { (need + need / 4 + 1).min(u64::from(u32::MAX)) as usize } else { have }.max(have)
    };
    let longer = |longest: u32, most: u32, step: u32| {
        let full = u64::from(longest) * 8 > u64::from(most) * 7;
        if full { (most + step).min(MOST_TRIANGLES) } else { most }
    };
    let mut more = Capacities { most_at_place: longer(needs.longest, c.most_at_place, AT_PLACE), ..c };
    if settings.facets == FacetMode::All {
        let [triangles, complex, facets] = needs.camera;
        more.most_at_pixel = longer(needs.longest_pixel, c.most_at_pixel, AT_PIXEL);
        let most = |bytes: usize| largest_binding(limits) as usize / bytes;
        more.pixel_triangles =
            room(triangles, c.pixel_triangles).min(most(listed_bytes(settings))).max(c.pixel_triangles);
        more.complex_pixels = room(complex, c.complex_pixels).min(settings.pixels()).max(c.complex_pixels);
        more.facets = room(facets, c.facets).min(most(size_of::<Undecided>())).max(c.facets);
    }
    let pairs = Capacities {
        pixel_pairs: room(needs.pixel_pairs, c.pixel_pairs),
        triangle_pairs: room(needs.triangle_pairs, c.triangle_pairs),
        candidates: room(needs.candidates, c.candidates),
        ..more
    };
    let lists = of_lists(pairs);
    if pair_bytes(settings, lists) <= budget && bound(settings, largest_binding(limits), lists) { pairs } else { more }
}

/// Largest needs of the frames with the lists in use: frames that take turns get lists that hold each, also where the budget does not hold
/// what each needs most of.
#[derive(Clone, Copy, Debug, Default)]
pub struct Together {
    needs: Needs,
    bands: u32,
    cramped: bool,
}

/// The lists that frames want.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The lists.
    pub capacities: Capacities,
    /// Whether one of the frames is incomplete without: else they have grown nearly full.
    pub must: bool,
}

impl Together {
    /// Lists for all frames so far, of which the last needed `needs` with the capacities `now`; `None` if those hold all with room to
    /// spare, or if none can. `budget`: bytes of the lists of pairs, and how many triangles there are. As [`wanted`], [`ahead`] of it, and [`roomy`].
    pub fn wanted(
        &mut self,
        needs: Needs,
        now: Capacities,
        settings: &Settings,
        limits: &wgpu::Limits,
        (budget, triangles): (u64, usize),
    ) -> Option<Wanted> {
        // What bands of other facets needed says nothing of these.
        let before = if self.bands == now.bands { self.needs } else { Needs::default() };
        (self.needs, self.bands) = (before.or(needs), now.bands);
        let reach = |wanted| in_reach(&self.needs, now, wanted, settings, budget, triangles);
        let wanted = wanted(&self.needs, now, settings, limits, budget).ok()?.map(reach).transpose().ok()?;
        let must = wanted.is_some();
        let wanted = wanted.map_or(now, |wanted| ahead(&self.needs, now, wanted, settings, limits, budget));
        let roomy = if self.cramped { wanted } else { roomy(&self.needs, wanted, settings, limits, budget) };
        (roomy != now).then_some(Wanted { capacities: roomy, must })
    }

    /// There is no memory for lists before they must grow.
    pub fn cramp(&mut self) {
        self.cramped = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::list_sizing::first_for;
    use crate::methods::output::Budget;
    use crate::samples::{Pattern, Samples};

    fn settings(facets: FacetMode) -> Settings {
        let samples = Samples::new(Pattern::default(), 32).expect("32 samples");
        Settings { facets, ..Settings::new([96, 72], 64, samples) }
    }

    /// A need that creeps up is met before it is there, in few steps, and never beyond a quarter more.
    #[test]
    fn lists_grow_ahead_of_a_need_that_creeps_up() {
        let limits = wgpu::Limits::default();
        for facets in [FacetMode::One, FacetMode::All] {
            let settings = settings(facets);
            let (mut now, mut together) = (first_for(&settings, Budget::default(), 1000), Together::default());
            let (start, mut steps) = (now, 0);
            for frame in 0..200u64 {
                let grown = |from: usize| from as u64 / 2 + from as u64 * frame / 100;
                let needs = Needs {
                    pixel_pairs: grown(start.pixel_pairs),
                    triangle_pairs: grown(start.triangle_pairs),
                    candidates: grown(start.candidates),
                    longest: 2048 + 40 * frame as u32,
                    camera: [grown(start.pixel_triangles), 700, grown(start.facets)],
                    longest_pixel: 256 + 5 * frame as u32,
                };
                assert!(wanted(&needs, now, &settings, &limits, 1 << 30).expect("they fit").is_none(), "frame {frame}");
                if let Some(more) = together.wanted(needs, now, &settings, &limits, (1 << 30, 1000)) {
                    assert!(!more.must && more.capacities != now, "frame {frame}");
                    let most = [needs.pixel_pairs, needs.triangle_pairs, needs.candidates].map(|n| n + n / 4 + 1);
                    let (p, t, c) = of_lists(more.capacities);
                    let fits = |k: usize, list: u64, had: usize| list <= most[k].max(had as u64);
                    assert!(
                        fits(0, p, now.pixel_pairs) && fits(1, t, now.triangle_pairs) && fits(2, c, now.candidates)
                    );
                    (now, steps) = (more.capacities, steps + 1);
                }
                assert_eq!(
                    together.wanted(needs, now, &settings, &limits, (1 << 30, 1000)),
                    None,
                    "frame {frame}: at rest"
                );
            }
            assert!((3..80).contains(&steps), "{facets:?}: {steps} steps");
        }
    }

    /// Where the budget does not hold more, or there is no memory for it, lists that suffice stay as they are.
    #[test]
    fn lists_that_suffice_stay_where_there_is_no_room() {
        let (settings, limits) = (settings(FacetMode::One), wgpu::Limits::default());
        let now = Capacities { pixel_pairs: 1000, ..first_for(&settings, Budget::default(), 1000) };
        let needs = Needs { pixel_pairs: 990, ..Needs::default() };
        let budget = pair_bytes(&settings, of_lists(now));
        let mut together = Together::default();
        assert_eq!(together.wanted(needs, now, &settings, &limits, (budget, 1000)), None);
        let wanted = together.wanted(needs, now, &settings, &limits, (2 * budget, 1000)).expect("room");
        assert_eq!(wanted, Wanted { capacities: Capacities { pixel_pairs: 1238, ..now }, must: false });
        together.cramp();
        assert_eq!(together.wanted(needs, now, &settings, &limits, (2 * budget, 1000)), None);
        let more = Needs { pixel_pairs: 1001, ..needs };
        assert!(together.wanted(more, now, &settings, &limits, (2 * budget, 1000)).is_some_and(|wanted| wanted.must));
    }
}
