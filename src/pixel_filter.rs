//! Weights of the samples of a pixel and of those around it.

use crate::samples::Samples;

/// How the samples around a pixel's centre are weighted into its visibility: the filters that renderers take (Pharr, Jakob, Humphreys,
/// *Physically Based Rendering*, section 8.8), where Pan 2009, section 5.1, leaves weighted ones as future work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum PixelFilter {
    /// The pixel's own samples, all alike.
    #[default]
    Box,
    /// Falls evenly to 0 one pixel from the centre along either axis.
    Tent,
    /// A Gaussian of standard deviation 1/2 pixel, less its value at 1.5 pixels, where it ends.
    Gaussian,
    /// Mitchell and Netravali 1988 with B = C = 1/3, over two pixels: sharper, with negative weights beyond the first pixel.
    Mitchell,
}

impl PixelFilter {
    /// All.
    pub const ALL: [Self; 4] = [Self::Box, Self::Tent, Self::Gaussian, Self::Mitchell];

    /// Distance from the centre along an axis beyond which samples count nothing, pixels.
    pub fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
            Self::Mitchell => 2.0,
        }
    }

    /// Pixels to either side whose samples count.
    pub fn reach(self) -> u32 {
        (self.radius() - 0.5).ceil() as u32
    }

    /// Weight of a sample this far from the centre along one axis, pixels; that of a place is the product over both axes.
    pub fn weight(self, distance: f64) -> f64 {
        let d = distance.abs();
        if d >= self.radius() && self != Self::Box {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - d,
            Self::Gaussian => {
                let at = |d: f64| (-2.0 * d * d).exp();
                at(d) - at(self.radius())
            }
            // Equation 8 of the paper with B = C = 1/3.
            Self::Mitchell if d < 1.0 => (21.0 * d * d * d - 36.0 * d * d + 16.0) / 18.0,
            Self::Mitchell => (-7.0 * d * d * d + 36.0 * d * d - 60.0 * d + 32.0) / 18.0,
        }
    }

    /// Weight of a sample at `offset` in the pixel that lies `away` pixels to the right and down.
    pub fn weight_at(self, away: [i32; 2], offset: [f64; 2]) -> f64 {
        let along = |k: usize| self.weight(f64::from(away[k]) + offset[k] - 0.5);
        along(0) * along(1)
    }

    /// Pixels around that count, `[right, down]`, row by row from the top.
    pub fn pixels(self) -> impl Iterator<Item = [i32; 2]> {
        let reach = self.reach() as i32;
        (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |x| [x, y]))
    }

    /// Table that the stage `pixel_filter` reads: for each of [`PixelFilter::pixels`] the weights of 32 samples a mask word, 0 beyond the last
    /// sample, and then the sum of each word's. All together are 1.
    pub fn weights(self, samples: &Samples) -> Vec<f32> {
        let words = samples.words() as usize;
        let of_pixel = |away| samples.offsets().iter().map(move |o| self.weight_at(away, o.map(f64::from)));
        let all: f64 = self.pixels().flat_map(of_pixel).sum();
        self.pixels()
            .flat_map(|away| {
                let mut weights: Vec<f32> = of_pixel(away).map(|weight| (weight / all) as f32).collect();
                weights.resize(32 * words, 0.0);
                let sums: Vec<f32> = weights.chunks(32).map(|word| word.iter().sum()).collect();
                weights.extend(sums);
                weights
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Pattern;

    #[test]
    fn weights_are_those_of_the_papers() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        near(PixelFilter::Mitchell.weight(0.0), 8.0 / 9.0);
        near(PixelFilter::Mitchell.weight(1.0), 1.0 / 18.0);
        near(PixelFilter::Mitchell.weight(-2.0), 0.0);
        assert!(PixelFilter::Mitchell.weight(1.5) < 0.0);
        // One sample a pixel, wherever it lies, is worth 1 in all pixels together.
        for at in [0.0, 0.25, 0.7] {
            for filter in [PixelFilter::Tent, PixelFilter::Mitchell] {
                near((-3..=3).map(|k| filter.weight(f64::from(k) + at)).sum(), 1.0);
            }
        }
        near(PixelFilter::Gaussian.weight(0.5), (-0.5f64).exp() - (-4.5f64).exp());
        assert_eq!(PixelFilter::ALL.map(PixelFilter::reach), [0, 1, 1, 2]);
        for filter in PixelFilter::ALL {
            for step in 0..100 {
                let beyond = f64::from(filter.reach()) + 0.5 + f64::from(step) * 0.01;
                assert!(filter == PixelFilter::Box || filter.weight(beyond) == 0.0, "{filter:?} at {beyond}");
            }
        }
    }

    #[test]
    fn tables_add_up_to_one() {
        for (filter, count) in PixelFilter::ALL.into_iter().flat_map(|f| Samples::COUNTS.map(|c| (f, c))) {
            let samples = Samples::new(Pattern::Rotated, count).unwrap();
            let words = samples.words() as usize;
            let table = filter.weights(&samples);
            assert_eq!(table.len(), (2 * filter.reach() as usize + 1).pow(2) * 33 * words);
            let (mut all, mut sums) = (0.0, 0.0);
            for pixel in table.chunks(33 * words) {
                all += pixel[..32 * words].iter().copied().map(f64::from).sum::<f64>();
                sums += pixel[32 * words..].iter().copied().map(f64::from).sum::<f64>();
                assert!(pixel[count as usize..32 * words].iter().all(|w| *w == 0.0));
            }
            assert!((all - 1.0).abs() < 1e-5 && (sums - 1.0).abs() < 1e-5, "{filter:?} {count}: {all} {sums}");
        }
    }
}
