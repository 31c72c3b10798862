//! The lookup table of half-plane masks (Pan 2009, section 3.4, after Eisemann and Décoret 2007).

use crate::samples::Samples;

/// How a half-plane becomes a mask of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum MaskVariant {
    /// Every sample is tested: no error.
    #[default]
    Exact,
    /// The mask of the nearest tabulated half-plane, of this many directions and distances, is looked up.
    Table {
        /// Directions, over the full turn.
        angles: u32,
        /// Distances from the pixel centre, over the pixel's diagonal.
        offsets: u32,
    },
}

impl MaskVariant {
    /// The table that leaves at most 0.1 wrong bits in a mask of 32 on average.
    pub const TABLE: Self = Self::Table { angles: 256, offsets: 256 };

    /// Most directions or distances of a table.
    pub const LARGEST: u32 = 2048;

    /// Directions and distances; 0 and 0 without a table.
    pub fn size(self) -> [u32; 2] {
        match self {
            Self::Exact => [0, 0],
            Self::Table { angles, offsets } => [angles, offsets],
        }
    }
}

/// The tabulated masks, `samples.words()` words each: entry `angle * offsets + offset` holds the samples on the inner side of
/// the line through the middle of its bin. Directions are spaced evenly on a diamond, distances over the pixel's diagonal.
pub fn mask_table(samples: &Samples, [angles, offsets]: [u32; 2]) -> Vec<u32> {
    let words = samples.words() as usize;
    let mut table = Vec::with_capacity(angles as usize * offsets as usize * words);
    for a in 0..angles {
        // Place on the diamond, -1 to 3, as the kernel computes it.
        let turn = (f64::from(a) + 0.5) / f64::from(angles) * 4.0 - 1.0;
        let (x, y) = if turn <= 1.0 { (1.0 - turn.abs(), turn) } else { (-(1.0 - (2.0 - turn).abs()), 2.0 - turn) };
        let length = x.hypot(y);
        let (x, y) = (x / length, y / length);
        for o in 0..offsets {
            let distance = ((f64::from(o) + 0.5) / f64::from(offsets) - 0.5) * std::f64::consts::SQRT_2;
            let mut mask = vec![0u32; words];
            for (k, s) in samples.offsets().iter().enumerate() {
                let inside = x * (f64::from(s[0]) - 0.5) + y * (f64::from(s[1]) - 0.5) >= distance;
                mask[k / 32] |= u32::from(inside) << (k % 32);
            }
            table.extend(mask);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Pattern;

    /// Wrong bits a mask, averaged over half-planes that cross the pixel.
    fn wrong_bits(samples: &Samples, size: [u32; 2]) -> f64 {
        let table = mask_table(samples, size);
        let (mut wrong, mut tried) = (0, 0);
        let steps = 400;
        for i in 0..steps {
            let angle = (f64::from(i) + 0.37) / f64::from(steps) * std::f64::consts::TAU;
            let (y, x) = angle.sin_cos();
            let turn = if x >= 0.0 { y / (x.abs() + y.abs()) } else { 2.0 - y / (x.abs() + y.abs()) } + 1.0;
            for j in 0..steps {
                let distance = ((f64::from(j) + 0.41) / f64::from(steps) - 0.5) * 1.4;
                if distance.abs() > 0.5 * (x.abs() + y.abs()) {
                    continue;
                }
                let a = ((turn * 0.25 * f64::from(size[0])) as u32).min(size[0] - 1);
                let o = ((distance / std::f64::consts::SQRT_2 + 0.5) * f64::from(size[1])) as u32;
                let mask = table[(a * size[1] + o) as usize];
                tried += 1;
                for (k, s) in samples.offsets().iter().enumerate() {
                    let inside = x * (f64::from(s[0]) - 0.5) + y * (f64::from(s[1]) - 0.5) >= distance;
                    wrong += u32::from(inside != (mask >> k & 1 == 1));
                }
            }
        }
        f64::from(wrong) / f64::from(tried)
    }

    #[test]
    fn the_default_table_is_wrong_by_a_tenth_of_a_bit_at_most_and_a_coarse_one_by_more() {
        let samples = Samples::new(Pattern::LowDiscrepancy, 32).unwrap();
        let fine = wrong_bits(&samples, MaskVariant::TABLE.size());
        let coarse = wrong_bits(&samples, [32, 32]);
        println!("wrong bits a mask: {fine:.4} at 256 x 256, {coarse:.4} at 32 x 32");
        assert!(fine <= 0.1, "{fine}");
        assert!(coarse > 2.0 * fine, "{coarse}");
    }
}
