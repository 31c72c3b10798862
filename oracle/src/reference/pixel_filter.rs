//! Visibility weighted over the samples of a pixel and of those around it.

use subpixel_shadows::pixel_filter::PixelFilter;
use subpixel_shadows::samples::Samples;

/// Share of all weight below which what is seen weighs hardly anything.
pub const HARDLY: f64 = 0.125;

/// Visibility of each pixel of an image `size` pixels wide and high, of which samples are lit and which see a surface.
pub fn visibility(filter: PixelFilter, samples: &Samples, size: [u32; 2], lit: &[u128], seen: &[u128]) -> Vec<f64> {
    let [width, height] = size.map(|side| side as i32);
    let all: f64 = filter.pixels().flat_map(|away| weights(filter, samples, away)).sum();
    let share = |x: i32, y: i32| {
        let (mut bright, mut total) = (0.0, 0.0);
        for away in filter.pixels() {
            let [column, row] = [x + away[0], y + away[1]];
            if !(0..width).contains(&column) || !(0..height).contains(&row) {
                continue;
            }
            let pixel = (row * width + column) as usize;
            for (k, weight) in weights(filter, samples, away).enumerate() {
                let has = |mask: u128| mask >> k & 1 != 0;
                total += if has(seen[pixel]) { weight } else { 0.0 };
                bright += if has(seen[pixel] & lit[pixel]) { weight } else { 0.0 };
            }
        }
        if total / all > HARDLY {
            return (bright / total).clamp(0.0, 1.0);
        }
        let own = (y * width + x) as usize;
        match seen[own].count_ones() {
            0 => 1.0,
            count => f64::from((lit[own] & seen[own]).count_ones()) / f64::from(count),
        }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| share(x, y)).collect()
}

fn weights(filter: PixelFilter, samples: &Samples, away: [i32; 2]) -> impl Iterator<Item = f64> + '_ {
    samples.offsets().iter().map(move |offset| filter.weight_at(away, offset.map(f64::from)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::samples::Pattern;

    #[test]
    fn an_edge_is_as_wide_as_the_filter() {
        let samples = Samples::new(Pattern::Grid, 64).unwrap();
        // Lit from the fifth column on.
        let lit: Vec<u128> = (0..9 * 3).map(|k| if k % 9 >= 4 { u128::MAX >> 64 } else { 0 }).collect();
        let seen = vec![u128::MAX >> 64; lit.len()];
        for filter in PixelFilter::ALL {
            let row = visibility(filter, &samples, [9, 3], &lit, &seen)[9..18].to_vec();
            let reach = filter.reach() as usize;
            for (x, v) in row.iter().enumerate() {
                let changed = (4usize.saturating_sub(reach)..4 + reach).contains(&x);
                assert!(changed || *v == f64::from(u8::from(x >= 4)), "{filter:?}: {row:?}");
            }
            assert!(row.windows(2).all(|pair| pair[0] <= pair[1] + 0.1), "{filter:?}: {row:?}");
        }
        let tent = visibility(PixelFilter::Tent, &samples, [9, 3], &lit, &seen);
        // Eight columns of samples a pixel, which begin at its left end.
        assert!((tent[9 + 3] - 0.125).abs() < 0.04 && (tent[9 + 4] - 0.875).abs() < 0.04, "{tent:?}");
    }

    #[test]
    fn what_sees_nothing_counts_nothing() {
        let samples = Samples::new(Pattern::default(), 8).unwrap();
        let (all, none) = (vec![255; 9], vec![0; 9]);
        for filter in PixelFilter::ALL {
            assert_eq!(visibility(filter, &samples, [3, 3], &none, &none), [1.0; 9]);
            assert_eq!(visibility(filter, &samples, [3, 3], &none, &all), [0.0; 9]);
            assert_eq!(visibility(filter, &samples, [3, 3], &all, &all), [1.0; 9]);
            // Where the centre's own samples are the only ones, they alone decide.
            let mut seen = none.clone();
            seen[4] = 255;
            let half: Vec<u128> = vec![0b1111; 9];
            let share = visibility(filter, &samples, [3, 3], &half, &seen)[4];
            assert!((0.3..0.7).contains(&share), "{filter:?}: {share}");
        }
    }
}
