//! Taps of a disc: places that are spread evenly over it, none near another, in no pattern (a Poisson disc).

use glam::DVec2;

/// Most taps of a disc.
pub const MOST_TAPS: u32 = 64;

/// Steps a side of the points by which the disc is shared out among the taps.
const STEPS: i32 = 48;

/// Times that each tap moves to the middle of its share: enough that no two are near each other, too few for a lattice.
const ROUNDS: u32 = 12;

/// So many taps, at least 1, of a disc of radius 1, whose mean is its middle. The same on every machine: no function is asked but the square
/// root.
pub fn taps(count: u32) -> Vec<DVec2> {
    let steps = (-STEPS..STEPS).map(|k| (f64::from(k) + 0.5) / f64::from(STEPS));
    let points = steps.clone().flat_map(|y| steps.clone().map(move |x| DVec2::new(x, y)));
    let points: Vec<DVec2> = points.filter(|p| p.length_squared() < 1.0).collect();
    let mut taps = scattered(count, &points);
    for _ in 0..ROUNDS {
        let mut shares = vec![(DVec2::ZERO, 0.0); taps.len()];
        for &p in &points {
            let nearest = (0..taps.len()).min_by(|&a, &b| away(p, taps[a]).total_cmp(&away(p, taps[b])));
            if let Some(share) = nearest.and_then(|tap| shares.get_mut(tap)) {
                *share = (share.0 + p, share.1 + 1.0);
            }
        }
        for (tap, (sum, points)) in taps.iter_mut().zip(shares) {
            if points > 0.0 {
                *tap = sum / points;
            }
        }
    }
    let mean = taps.iter().sum::<DVec2>() / f64::from(count.max(1));
    taps.into_iter().map(|tap| tap - mean).collect()
}

fn away(p: DVec2, q: DVec2) -> f64 {
    p.distance_squared(q)
}

/// Points one after the other, each the farthest from those before of some (the best candidate: Mitchell 1991).
fn scattered(count: u32, points: &[DVec2]) -> Vec<DVec2> {
    let mut state = 0x2545_f491_u32;
    let mut taps: Vec<DVec2> = Vec::new();
    for k in 0..count {
        let candidates = (0..16 * (k + 1)).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            points[((u64::from(state) * points.len() as u64) >> 32) as usize]
        });
        let gap = |p: DVec2| taps.iter().map(|&tap| away(p, tap)).fold(f64::INFINITY, f64::min);
        taps.extend(candidates.max_by(|&a, &b| gap(a).total_cmp(&gap(b))));
    }
    taps
}

/// Taps as the kernel takes them, two in four numbers: texels from the sample. The rest is 0.
pub type DiscWords = [[f32; 4]; MOST_TAPS as usize / 2];

/// The taps of a disc of some radius.
pub fn disc_words(count: u32, radius: f32) -> DiscWords {
    let mut words = DiscWords::default();
    let places = taps(count.min(MOST_TAPS)).into_iter().map(|tap| (tap * f64::from(radius)).as_vec2());
    for (place, to) in places.zip(words.as_flattened_mut().chunks_exact_mut(2)) {
        to.copy_from_slice(&place.to_array());
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of the two nearest, and the farthest that a point of the disc has to its nearest tap, over the root of the area of a share.
    fn spread(taps: &[DVec2]) -> [f64; 2] {
        let share = (std::f64::consts::PI / taps.len() as f64).sqrt();
        let pairs = taps.iter().enumerate().flat_map(|(k, p)| taps[..k].iter().map(|q| p.distance(*q)));
        let ring = (1..=20).flat_map(|r| (0..64).map(move |k| (r, k)));
        let points =
            ring.map(|(r, k)| DVec2::from_angle(f64::from(k) / 64.0 * std::f64::consts::TAU) * f64::from(r) / 20.0);
        let gaps = points.map(|p| taps.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min));
        [pairs.fold(f64::INFINITY, f64::min) / share, gaps.fold(0.0, f64::max) / share]
    }

    #[test]
    fn taps_are_spread_over_the_disc() {
        for count in [2, 4, 9, 16, 25, 49, 64] {
            let taps = taps(count);
            assert_eq!(taps.len(), count as usize);
            assert!(taps.iter().all(|p| p.length() < 1.0), "{taps:?}");
            assert!(taps.iter().sum::<DVec2>().length() < 1e-9 * f64::from(count));
            let [nearest, gap] = spread(&taps);
            assert!(nearest > 0.65 && gap < 1.2, "{count} taps: {nearest}, {gap}");
            let mut spoilt = taps.clone();
            spoilt[0] = spoilt[1] + DVec2::splat(0.01);
            assert!(spread(&spoilt)[0] < 0.65);
        }
    }

    #[test]
    fn words_hold_the_taps_and_nothing_else() {
        let words = disc_words(3, 2.0);
        let flat = words.as_flattened();
        for (tap, word) in taps(3).iter().zip(flat.chunks_exact(2)) {
            assert_eq!((*tap * 2.0).as_vec2().to_array(), *word);
        }
        assert!(flat[..6].iter().all(|v| *v != 0.0) && flat[6..].iter().all(|v| *v == 0.0), "{words:?}");
    }
}
