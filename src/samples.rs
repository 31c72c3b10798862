//! Sample patterns: where the samples of a pixel lie.

use crate::{Error, Result};

/// The kind of a sample pattern. Each has a sample at the pixel centre, and that is the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Pattern {
    /// A regular grid that wraps around the pixel.
    Grid,
    /// A rank-1 lattice: a rotated grid, no two samples in one row or column.
    Rotated,
    /// The additive recurrence R2 (Roberts 2018), a low-discrepancy sequence.
    #[default]
    LowDiscrepancy,
}

/// Offsets of the samples inside a pixel, in `[0, 1)²`, `x` right and `y` down; the first is the centre.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct Samples {
    offsets: Vec<[f32; 2]>,
}

impl Samples {
    /// The numbers of samples a pixel may have.
    pub const COUNTS: [u32; 6] = [1, 8, 16, 32, 64, 128];

    /// The pattern of `kind` with `count` samples. Offsets are multiples of 2^-12, so `f32` holds them exactly.
    ///
    /// # Errors
    /// [`Error::Config`] if `count` is not one of [`Samples::COUNTS`].
    pub fn new(kind: Pattern, count: u32) -> Result<Self> {
        if !Self::COUNTS.contains(&count) {
            return Err(Error::Config(format!("{count} samples a pixel; possible are 1, 8, 16, 32, 64 and 128")));
        }
        let n = f64::from(count);
        let at = |k: u32| -> [f64; 2] {
            let k_f = f64::from(k);
            match kind {
                Pattern::Grid => {
                    let columns = 1u32 << (count.ilog2().div_ceil(2));
                    let rows = count / columns;
                    [f64::from(k % columns) / f64::from(columns), f64::from(k / columns) / f64::from(rows)]
                }
                Pattern::Rotated => [k_f / n, k_f * f64::from(lattice_generator(count)) / n],
                Pattern::LowDiscrepancy => [k_f * 0.754_877_666_246_692_7, k_f * 0.569_840_290_998_053_2],
            }
        };
        let place = |v: f64| ((((v + 0.5).fract() * 4096.0).round() % 4096.0) / 4096.0) as f32;
        Self::from_offsets((0..count).map(|k| at(k).map(place)).collect())
    }

    /// A pattern of your own.
    ///
    /// # Errors
    /// [`Error::Config`] if the number is not one of [`Samples::COUNTS`], an offset is outside `[0, 1)`, or the first
    /// is not the pixel centre (the validity mask needs one there: Pan 2009, section 3.4).
    pub fn from_offsets(offsets: Vec<[f32; 2]>) -> Result<Self> {
        if !Self::COUNTS.contains(&(offsets.len() as u32)) {
            return Err(Error::Config(format!(
                "{} samples a pixel; possible are 1, 8, 16, 32, 64 and 128",
                offsets.len()
            )));
        }
        if let Some((k, o)) = offsets.iter().enumerate().find(|(_, o)| !o.iter().all(|c| (0.0..1.0).contains(c))) {
            return Err(Error::Config(format!("sample {k} at ({}, {}) lies outside the pixel", o[0], o[1])));
        }
        if offsets[0] != [0.5, 0.5] {
            return Err(Error::Config(format!(
                "the first sample is at ({}, {}); the validity mask needs it at the pixel centre (0.5, 0.5)",
                offsets[0][0], offsets[0][1]
            )));
        }
        Ok(Self { offsets })
    }

    /// The offsets.
    #[inline]
    pub fn offsets(&self) -> &[[f32; 2]] {
        &self.offsets
    }

    /// How many samples a pixel has.
    #[inline]
    pub fn count(&self) -> u32 {
        self.offsets.len() as u32
    }

    /// How many 32-bit words a mask of one bit per sample takes: 1, 2 or 4. Bit `k % 32` of word `k / 32` is sample `k`.
    #[inline]
    pub fn words(&self) -> u32 {
        self.count().div_ceil(32)
    }
}

/// The generator of the rank-1 lattice of `count` points whose nearest points lie farthest apart.
fn lattice_generator(count: u32) -> u32 {
    let distance = |g: u32| {
        (1..count)
            .map(|k| {
                let wrap = |v: u32| u64::from((v % count).min(count - v % count));
                wrap(k).pow(2) + wrap(k * g).pow(2)
            })
            .min()
            .unwrap_or(0)
    };
    (1..count).filter(|g| g % 2 == 1).max_by_key(|&g| (distance(g), std::cmp::Reverse(g))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_has_distinct_samples_and_one_at_the_centre() {
        for kind in [Pattern::Grid, Pattern::Rotated, Pattern::LowDiscrepancy] {
            for count in Samples::COUNTS {
                let samples = Samples::new(kind, count).unwrap();
                assert_eq!(samples.count(), count);
                assert_eq!(samples.offsets()[0], [0.5, 0.5]);
                let mut seen: Vec<_> = samples.offsets().iter().map(|o| o.map(f32::to_bits)).collect();
                seen.sort_unstable();
                seen.dedup();
                assert_eq!(seen.len(), count as usize, "{kind:?} {count}");
            }
        }
    }

    #[test]
    fn patterns_spread_over_the_pixel() {
        // Each half of the pixel, cut at the centre, holds about half of the samples.
        for kind in [Pattern::Grid, Pattern::Rotated, Pattern::LowDiscrepancy] {
            for count in [8u32, 32, 128] {
                let samples = Samples::new(kind, count).unwrap();
                for axis in 0..2 {
                    let low = samples.offsets().iter().filter(|o| o[axis] < 0.5).count() as f64 / f64::from(count);
                    assert!((low - 0.5).abs() <= 0.13, "{kind:?} {count}: {low}");
                }
            }
        }
    }

    #[test]
    fn refuses_what_cannot_be_used() {
        assert!(Samples::new(Pattern::Grid, 33).is_err());
        assert!(Samples::from_offsets(vec![[0.25, 0.5]]).is_err());
        let mut eight = vec![[0.5, 0.5]; 8];
        eight[3] = [1.0, 0.0];
        assert!(Samples::from_offsets(eight).is_err());
    }
}
