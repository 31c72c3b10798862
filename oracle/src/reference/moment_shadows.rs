//! Shadows by mean and variance of the depths in a footprint, or of exponentials of them, or by the series of the comparison.

use super::map_moments;
use glam::{DMat2, DVec2};

/// Way from moments to the share of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MomentBound {
    /// Mean and variance bound it (Chebyshev).
    Variance,
    /// The mean over the receiver's own measure.
    Mean,
    /// As by [`MomentBound::Variance`], in the layer that the receiver is in, and near the layer's end in the next beside.
    Layers,
    /// The Fourier series of the comparison, the last term weakened by `exp` of minus this (Annen et al. 2007, section 4).
    Waves(f64),
    /// All four bound it (Hamburger); the fourth is above that of two depths by this share at the least.
    Four(f64),
}

/// A measure of depth, which grows with it.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// Depth where there is no caster.
    pub far: f64,
    /// 0 for the depth itself; above, `exp(c (d / far - 1))`, below, `-exp(c d / far)`.
    pub exponent: f64,
    /// A layer of depth, and of how many: the depth in it, as far as it reaches, [`LAP`] of its thickness into the next.
    pub layer: Option<[u32; 2]>,
    /// A wave in place of these.
    pub wave: Option<Wave>,
}

/// A wave over depths, by its term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wave {
    /// Its sine.
    Sine(u32),
    /// Its cosine.
    Cosine(u32),
}

/// Frequency of a term of the step's series, over depths from 0 to 1.
fn frequency(term: u32) -> f64 {
    std::f64::consts::PI * f64::from(2 * term + 1)
}

/// Part of its thickness by which a layer reaches into the next.
pub const LAP: f64 = 0.25;

impl Measure {
    /// Place of a depth in the half period of the series: a tenth more than what is there, so that nothing lies a whole half period apart.
    fn wave_share(&self, depth: f64) -> f64 {
        (depth / (1.1 * (self.far - 1.0))).min(1.0)
    }

    /// Of a depth.
    pub fn of(&self, depth: f64) -> f64 {
        if let Some([layer, of]) = self.layer {
            let place = depth * f64::from(of) - f64::from(layer);
            let low = if layer == 0 { f64::NEG_INFINITY } else { -LAP };
            return place.clamp(low, if layer + 1 == of { f64::INFINITY } else { 1.0 + LAP });
        }
        match self.wave {
            Some(Wave::Sine(term)) => return (frequency(term) * self.wave_share(depth)).sin(),
            Some(Wave::Cosine(term)) => return (frequency(term) * self.wave_share(depth)).cos(),
            None => {}
        }
        let (share, c) = (depth / self.far, self.exponent);
        match c {
            0.0 => depth,
            _ if c > 0.0 => (c * (share - 1.0)).exp(),
            _ => -(c * share).exp(),
        }
    }
}

/// Moments of a map, level by level.
#[derive(Clone, Debug)]
pub struct Moments {
    /// Texels a side.
    pub size: u32,
    /// Measure of depth that they are of.
    pub measure: Measure,
    /// Mean, variance, third and fourth central moment of each level's cells, from the texels themselves on.
    pub levels: Vec<Vec<[f64; 4]>>,
}

/// The receiver at a place of the map.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Texels.
    pub at: DVec2,
    /// Depth there.
    pub depth: f64,
    /// Depth per texel to the right and down.
    pub slope: DVec2,
}

impl Receiver {
    /// How much deeper it is at another texel.
    pub fn rise_to(&self, at: DVec2) -> f64 {
        self.slope.dot(at - self.at)
    }
}

/// How moments are asked.
#[derive(Clone, Copy, Debug)]
pub struct MomentQuery {
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Share of light that is taken off.
    pub bleeding: f64,
    /// Most squares along a footprint.
    pub most_probes: f64,
    /// Way from moments to the share.
    pub by: MomentBound,
}

impl Moments {
    /// Of a map of depths, which are the measure's farthest where there is no caster.
    pub fn new(depths: &[Option<f64>], size: u32, measure: Measure) -> Self {
        let all: Vec<f64> = depths.iter().map(|d| measure.of(d.unwrap_or(measure.far))).collect();
        let last = size.max(1).next_power_of_two().trailing_zeros();
        let levels = (0..=last).map(|level| map_moments::moments(&all, size, level)).collect();
        Self { size, measure, levels }
    }

    /// Whether a place lies in the map.
    pub fn holds(&self, at: DVec2) -> bool {
        at.cmpge(DVec2::ZERO).all() && at.max_element() < f64::from(self.size)
    }

    fn bilinear(&self, level: usize, at: DVec2) -> [f64; 4] {
        let side = self.size.div_ceil(1 << level);
        let last = f64::from(side - 1);
        let place = (at / f64::from(1 << level) - 0.5).clamp(DVec2::ZERO, DVec2::splat(last));
        let f = place - place.floor();
        let cell = |dx: u32, dy: u32| {
            let [x, y] = [place.x as u32 + dx, place.y as u32 + dy].map(|c| c.min(side - 1));
            self.levels[level][(y * side + x) as usize]
        };
        mixed(&[
            ((1.0 - f.x) * (1.0 - f.y), cell(0, 0)),
            (f.x * (1.0 - f.y), cell(1, 0)),
            ((1.0 - f.x) * f.y, cell(0, 1)),
            (f.x * f.y, cell(1, 1)),
        ])
    }

    /// Moments of a square of `2^level` texels a side around a place.
    pub fn of_square(&self, level: f64, at: DVec2) -> [f64; 4] {
        let low = level.floor() as usize;
        let high = (low + 1).min(self.levels.len() - 1);
        let f = level - level.floor();
        mixed(&[(1.0 - f, self.bilinear(low, at)), (f, self.bilinear(high, at))])
    }

    /// The place nearest to one that is wanted where cells of the level above are whole all around.
    fn place(&self, wanted: DVec2, level: f64) -> DVec2 {
        let cell = level.ceil().exp2().min(f64::from(self.size));
        let last = ((f64::from(self.size) / cell).floor() - 0.5) * cell;
        wanted.clamp(DVec2::splat(0.5 * cell), DVec2::splat(last))
    }

    /// Share of light in such a square around a texel, before any is taken off.
    fn share(&self, r: &Receiver, wanted: DVec2, level: f64, ask: &MomentQuery) -> f64 {
        let at = self.place(wanted, level);
        let found = self.of_square(level, at);
        let [mean, variance, ..] = found;
        let own = self.measure.of(r.depth + r.rise_to(at) - ask.constant);
        let off = own - mean;
        match ask.by {
            _ if off <= 0.0 => 1.0,
            MomentBound::Four(flattest) => share_of_four(found, off, flattest),
            MomentBound::Mean => mean / own,
            MomentBound::Variance | MomentBound::Layers | MomentBound::Waves(_) => variance / (variance + off * off),
        }
    }

    /// Share of light by the waves of a map, sine and cosine of each term in turns: twice the mean of the step from 0 before the receiver to 1
    /// behind it.
    fn share_of_waves(waves: &[Self], r: &Receiver, wanted: DVec2, level: f64, ask: &MomentQuery) -> f64 {
        let at = waves[0].place(wanted, level);
        let own = waves[0].measure.wave_share(r.depth + r.rise_to(at) - ask.constant);
        let fading = if let MomentBound::Waves(fading) = ask.by { fading } else { 0.0 };
        let terms = waves.len() / 2;
        let term = |k: usize| {
            let [sine, cosine] = [2 * k, 2 * k + 1].map(|n| waves[n].of_square(level, at)[0]);
            let c = frequency(k as u32);
            let weakened = (-fading * ((k + 1) as f64 / terms as f64).powi(2)).exp();
            weakened / c * ((c * own).cos() * sine - (c * own).sin() * cosine)
        };
        (1.0 + 4.0 * (0..terms).map(term).sum::<f64>()).clamp(0.0, 1.0)
    }

    /// Share of light in the footprint of a pixel, the least that any of several `moments` of one map tells; `steps` are the texels that a pixel to
    /// the right and one down take.
    pub fn filtered(moments: &[Self], r: &Receiver, steps: DMat2, ask: &MomentQuery) -> f64 {
        // A plane seen edge-on has no end.
        let steps = DMat2::from_cols_array(&steps.to_cols_array().map(|c| c.clamp(-65536.0, 65536.0)));
        // The footprint's axes, from the eigenvectors of `steps · stepsᵀ`.
        let m = steps * steps.transpose();
        let (a, b, c) = (m.x_axis.x, m.x_axis.y, m.y_axis.y);
        let root = (0.25 * (a - c).powi(2) + b * b).sqrt();
        let long = (0.5 * (a + c) + root).max(1e-12).sqrt();
        let short = steps.determinant().abs() / long;
        let along = if a >= c { DVec2::new(0.5 * (a - c) + root, b) } else { DVec2::new(b, 0.5 * (c - a) + root) };
        let along = along.normalize_or_zero() * long;
        let probes = (long / short.max(1.0)).ceil().clamp(1.0, ask.most_probes);
        let levels = moments.iter().map(|m| m.levels.len()).min().unwrap_or(1);
        let level = short.max(long / probes).max(1.0).log2().min((levels - 1) as f64);
        let probe = |k: u32| {
            let off = along * ((f64::from(k) + 0.5) / probes - 0.5);
            let of = |m: &Self| m.share(r, r.at + off, level, ask);
            let share = match ask.by {
                MomentBound::Layers => {
                    let count = moments.len();
                    let deep = (r.depth + r.rise_to(moments[0].place(r.at + off, level)) - ask.constant) * count as f64;
                    let own = (deep.floor().max(0.0) as usize).min(count - 1);
                    // In steps from the layer's beginning, and from its end.
                    let [from, to] = [deep - own as f64, own as f64 + 1.0 - deep];
                    let beside = |other: usize, near: f64| {
                        let weight = (0.5 - 0.5 * near / LAP).max(0.0);
                        (1.0 - weight) * of(&moments[own]) + weight * of(&moments[other])
                    };
                    match () {
                        () if from >= 0.0 && from < to && own > 0 => beside(own - 1, from),
                        () if to >= 0.0 && to <= from && own + 1 < count => beside(own + 1, to),
                        () => of(&moments[own]),
                    }
                }
                MomentBound::Waves(_) => Self::share_of_waves(moments, r, r.at + off, level, ask),
                _ => moments.iter().map(of).fold(1.0, f64::min),
            };
            (share - ask.bleeding).max(0.0) / (1.0 - ask.bleeding)
        };
        (0..probes as u32).map(probe).sum::<f64>() / probes
    }
}

/// Greatest share that depths with these moments may have at `off` behind their mean and beyond (Peters and Klein 2015, algorithm 3, in
/// deviations from the mean): the linear system of the paper, by its own steps.
fn share_of_four([_, variance, third, fourth]: [f64; 4], off: f64, flattest: f64) -> f64 {
    if variance < 1e-16 {
        return if off <= 0.0 { 1.0 } else { 0.0 };
    }
    let (z, skew) = (off / variance.sqrt(), third / variance.powf(1.5));
    let least = (1.0 + flattest) * (1.0 + skew * skew);
    let kurtosis = (fourth / variance.powi(2)).max(least);
    // Of [1 0 1; 0 1 s; 1 s k] c = (1, z, z²).
    let c2 = (z * z - 1.0 - skew * z) / (kurtosis - 1.0 - skew * skew);
    let (c1, c0) = (z - skew * c2, 1.0 - c2);
    if c2.abs() < 1e-9 {
        // One more depth, at -1/z.
        return if z > 0.0 { 1.0 / (1.0 + z * z) } else { 1.0 };
    }
    let (p, q) = (c1 / c2, c0 / c2);
    let root = (0.25 * p * p - q).max(0.0).sqrt();
    let (low, high) = (-0.5 * p - root, -0.5 * p + root);
    let dark = if z <= low {
        0.0
    } else if z <= high {
        (z * high + 1.0) / ((high - low) * (z - low))
    } else {
        1.0 - (low * high + 1.0) / ((z - low) * (z - high))
    };
    (1.0 - dark).clamp(0.0, 1.0)
}

/// Moments of parts together, by their shares.
fn mixed(parts: &[(f64, [f64; 4])]) -> [f64; 4] {
    let of = |value: &dyn Fn(&[f64; 4]) -> f64| parts.iter().map(|(share, m)| share * value(m)).sum::<f64>();
    let mean = of(&|m| m[0]);
    let off = |m: &[f64; 4]| m[0] - mean;
    [
        mean,
        of(&|m| m[1] + off(m).powi(2)),
        of(&|m| m[2] + 3.0 * off(m) * m[1] + off(m).powi(3)),
        of(&|m| m[3] + 4.0 * off(m) * m[2] + 6.0 * off(m).powi(2) * m[1] + off(m).powi(4)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of every few depths the bound holds, and of three that the receiver is among it is reached.
    #[test]
    fn four_moments_bound_the_share() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        for count in [2, 3, 3, 5, 9].repeat(200) {
            let depths: Vec<(f64, f64)> = (0..count).map(|_| (0.05 + random(), random())).collect();
            let all: f64 = depths.iter().map(|d| d.0).sum();
            let parts: Vec<(f64, [f64; 4])> = depths.iter().map(|d| (d.0 / all, [d.1, 0.0, 0.0, 0.0])).collect();
            let moments = mixed(&parts);
            let receiver = if count == 3 { depths[1].1 } else { random() };
            let lit: f64 = parts.iter().filter(|p| p.1[0] >= receiver).map(|p| p.0).sum();
            let bound = share_of_four(moments, receiver - moments[0], 1e-9);
            assert!(bound >= lit - 1e-4, "{depths:?}, {receiver}: {bound}, {lit}");
            assert!(count != 3 || bound <= lit + 1e-4, "{depths:?}, {receiver}: {bound}, {lit}");
            let [mean, variance, ..] = moments;
            let off = receiver - mean;
            let of_two = if off > 0.0 { variance / (variance + off * off) } else { 1.0 };
            assert!(bound <= of_two + 1e-4, "{depths:?}, {receiver}: two moments bound it closer");
        }
    }
}
