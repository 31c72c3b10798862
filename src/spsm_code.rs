//! The tables of `spsm`: the 8-bit slope code of Lecocq 2013, section 3.4, and the tangents of section 4.2, figures 7 and 8.
//! Both are computed here in `f64`, so that no kernel takes an arctangent and CPU and GPU agree on every code.

use std::f64::consts::FRAC_PI_2;

/// Codes in use: 0 to 254. 255 marks an empty texel.
pub const CODES: usize = 255;

/// The slope code for one power.
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeCode {
    /// `thresholds[k]` is the least slope with a code above `k`.
    pub thresholds: [f32; CODES - 1],
    /// Slope of each code.
    pub values: [f32; CODES],
    /// How far a slope of that code may be from its value. Of the two end codes, which have no end, twice their value: a
    /// steeper slope is further off.
    pub bounds: [f32; CODES],
}

impl SlopeCode {
    /// The code `127 (1 + (2/π atan d)^n)`, rounded, for odd `n` (equations 2 to 4). The end codes stand for no finite
    /// slope in the paper; here they decode a quarter of a step before the end.
    pub fn new(n: u32) -> Self {
        let slope_at = |q: f64| {
            let s = (q / 127.0 - 1.0).clamp(-1.0, 1.0);
            (FRAC_PI_2 * s.signum() * s.abs().powf(1.0 / f64::from(n))).tan()
        };
        let value = |k: usize| match k {
            0 => slope_at(0.25),
            127 => 0.0,
            254 => slope_at(253.75),
            _ => slope_at(k as f64),
        };
        let edge = |k: usize| slope_at(k as f64 + 0.5);
        let bound = |k: usize| match k {
            0 | 254 => 2.0 * value(k).abs(),
            _ => (edge(k) - value(k)).max(value(k) - edge(k - 1)) * (1.0 + 1e-6),
        };
        Self {
            thresholds: std::array::from_fn(|k| edge(k) as f32),
            values: std::array::from_fn(|k| value(k) as f32),
            bounds: std::array::from_fn(|k| bound(k) as f32),
        }
    }

    /// The code of a slope.
    pub fn encode(&self, slope: f32) -> u32 {
        self.thresholds.partition_point(|&t| t <= slope) as u32
    }

    /// The table of the kernels: threshold above the code, value, bound.
    pub fn words(&self) -> [[f32; 4]; 256] {
        std::array::from_fn(|k| {
            let k = k.min(CODES - 1);
            [self.thresholds.get(k).copied().unwrap_or(f32::MAX), self.values[k], self.bounds[k], 0.0]
        })
    }
}

/// Shadow border around a texel, from the depth tests of 3 × 3 texels. Bit `3 y + x` of a mask: the texel's triangle lies before
/// the receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BorderPattern {
    /// The mask without texels that no row of neighbours (sharing sides) joins to the middle.
    pub kept: u32,
    /// All nine: an occluder covers the area.
    pub covered: bool,
    /// Directions from the shadow towards the light, one for each run of lit texels around the middle; up to four.
    pub towards_lit: [[i32; 2]; 4],
    /// How many.
    pub count: u32,
}

/// The eight texels around the middle, in order around it.
const RING: [[i32; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]];

fn bit([x, y]: [i32; 2]) -> u32 {
    1 << (3 * (y + 1) + x + 1)
}

impl BorderPattern {
    /// The pattern of a mask; nothing is known where the middle is lit.
    pub fn of(mask: u32) -> Self {
        let middle = bit([0, 0]);
        if mask & middle == 0 {
            return Self::default();
        }
        let mut kept = middle;
        for _ in 0..2 {
            for at in RING {
                let near = [[at[0] - 1, at[1]], [at[0] + 1, at[1]], [at[0], at[1] - 1], [at[0], at[1] + 1]];
                let joined = near.iter().any(|n| n.iter().all(|c| c.abs() <= 1) && kept & bit(*n) != 0);
                if mask & bit(at) != 0 && joined {
                    kept |= bit(at);
                }
            }
        }
        let mut pattern = Self { kept, covered: kept == 511, ..Self::default() };
        let lit = |k: usize| kept & bit(RING[k % 8]) == 0;
        for first in (0..8).filter(|&k| lit(k) && !lit(k + 7)) {
            let run = (first..first + 8).take_while(|&k| lit(k));
            let sum = run.fold([0, 0], |s: [i32; 2], k| [s[0] + RING[k % 8][0], s[1] + RING[k % 8][1]]);
            if sum != [0, 0] {
                pattern.towards_lit[pattern.count as usize] = sum;
                pattern.count += 1;
            }
        }
        pattern
    }

    /// The table of the kernels: directions as bytes `(x + 8) | (y + 8) << 4`, their number, what is kept, covered.
    pub fn words() -> Vec<[u32; 4]> {
        let pack = |p: &Self| {
            (0..p.count as usize).fold(0, |word, k| {
                let [x, y] = p.towards_lit[k].map(|c| (c + 8) as u32);
                word | (x | y << 4) << (8 * k)
            })
        };
        (0..512).map(Self::of).map(|p| [pack(&p), p.count, p.kept, u32::from(p.covered)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_rise_and_hold_their_bounds() {
        for n in [1, 3, 5, 7, 9] {
            let code = SlopeCode::new(n);
            assert!(code.thresholds.windows(2).all(|w| w[0] < w[1]) && code.values.windows(2).all(|w| w[0] < w[1]));
            let mut last = 0;
            for k in -4_000..4_000 {
                let slope = (f64::from(k) * 0.004).sinh() as f32;
                let c = code.encode(slope);
                assert!(c >= last && c < CODES as u32, "n {n}, slope {slope}: code {c} after {last}");
                last = c;
                let off = (slope - code.values[c as usize]).abs();
                // The end codes have no end: their bound holds to three times their value.
                let value = code.values[c as usize].abs();
                let held = !matches!(c, 0 | 254) || slope.abs() <= 2.9 * value;
                assert!(!held || off <= code.bounds[c as usize], "n {n}, slope {slope}: {off} off");
                assert_eq!(code.encode(code.values[c as usize]), c, "a value has its own code");
            }
            assert!(last > 200, "the range is used");
        }
    }

    /// The dead zone and the last finite code of n = 5.
    #[test]
    fn figures_of_the_fifth_power() {
        let code = SlopeCode::new(5);
        assert!((code.thresholds[127] - 0.571).abs() < 1e-3, "{}", code.thresholds[127]);
        assert!((code.values[253] - 403.0).abs() < 1.0, "{}", code.values[253]);
        assert_eq!((code.encode(f32::INFINITY), code.encode(f32::NEG_INFINITY)), (254, 0));
    }

    #[test]
    fn patterns() {
        let of = |rows: [u32; 3]| BorderPattern::of(rows[0] | rows[1] << 3 | rows[2] << 6);
        // The right column is lit; then all but the middle and what is below and to the left of it; then none; then the
        // middle alone is not.
        assert_eq!((of([3, 3, 3]).count, of([3, 3, 3]).towards_lit[0]), (1, [3, 0]));
        assert_eq!(of([0, 2, 3]).towards_lit[0], [1, -2]);
        assert!(of([7, 7, 7]).covered && of([7, 7, 7]).count == 0);
        assert_eq!(of([0, 2, 0]).count, 0);
        // A column of occluders has two sides; a corner that only touches is left out.
        let column = of([2, 2, 2]);
        assert_eq!((column.count, column.towards_lit[0], column.towards_lit[1]), (2, [3, 0], [-3, 0]));
        assert_eq!(of([4, 2, 2]).kept, 2 << 3 | 2 << 6);
        for mask in 0..512 {
            let p = BorderPattern::of(mask);
            assert!(p.kept & !mask == 0 && p.count <= 4, "{mask}");
            assert!(!p.covered || mask == 511);
            // A mirrored mask has mirrored directions.
            let mirrored = (0..9).fold(0, |m, k| m | (mask >> k & 1) << (k / 3 * 3 + 2 - k % 3));
            let q = BorderPattern::of(mirrored);
            let mut a: Vec<_> = p.towards_lit[..p.count as usize].iter().map(|[x, y]| [-x, *y]).collect();
            let mut b = q.towards_lit[..q.count as usize].to_vec();
            a.sort_unstable();
            b.sort_unstable();
            assert_eq!(a, b, "{mask}");
        }
    }
}
