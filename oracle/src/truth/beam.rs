//! A bundle of rays as a box that moves and grows, and its test against boxes that cannot miss.

use glam::{DVec3, DVec4};

/// The space that a bundle of rays sweeps: at parameter `t` a box from `low + t·low_step` to `high + t·high_step`, for
/// `t` in `[start, end]`.
///
/// A single ray is a beam of no width. Beams are used to list candidates only, so they may be too wide and never too
/// narrow.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    low: DVec3,
    high: DVec3,
    low_step: DVec3,
    high_step: DVec3,
    low_inverse: DVec3,
    high_inverse: DVec3,
    /// Parameter at which the beam starts, at least 0.
    pub start: f64,
    /// Parameter at which it ends; may be infinite.
    pub end: f64,
}

/// Share of the lengths at hand by which each beam is widened: 2^-44, far above the error bounds of the decisions
/// (2^-49), so that a triangle which a decision calls touched lies in the beam.
const WIDENING: f64 = 1.0 / (1u64 << 44) as f64;

/// Covers the rounding of the two slab parameters that are compared (three operations each, relative 2^-53).
const SLACK: f64 = 1.0 + 1.0 / (1u64 << 49) as f64;

impl Beam {
    fn new(low: DVec3, high: DVec3, low_step: DVec3, high_step: DVec3, start: f64, end: f64) -> Self {
        let place = low.abs().max(high.abs()).max_element() * WIDENING;
        let step = low_step.abs().max(high_step.abs()).max_element() * WIDENING;
        let (low, high) = (low - place, high + place);
        let (low_step, high_step) = (low_step - step, high_step + step);
        Self {
            low,
            high,
            low_step,
            high_step,
            low_inverse: low_step.map(|c| 1.0 / c),
            high_inverse: high_step.map(|c| 1.0 / c),
            start,
            end,
        }
    }

    /// The ray `origin + t·direction` for `t` in `[start, end]`, all lengths in world units.
    pub fn ray(origin: DVec3, direction: DVec3, start: f64, end: f64) -> Self {
        Self::new(origin, origin, direction, direction, start, end)
    }

    /// Rays from one `origin` whose directions lie in the box from `low` to `high`.
    pub fn pencil(origin: DVec3, low: DVec3, high: DVec3, start: f64, end: f64) -> Self {
        Self::new(origin, origin, low, high, start, end)
    }

    /// All segments from points of the box `low` to `high` to the homogeneous `light`: `t = 1` is a light at a
    /// position, and `t` has no end for a direction.
    pub fn towards(low: DVec3, high: DVec3, light: DVec4) -> Self {
        // For a position, p + t(L - p) grows with p for t in [0, 1]: the lowest point stays lowest.
        let l = light.truncate();
        let end = if light.w == 0.0 { f64::INFINITY } else { SLACK };
        Self::new(low, high, l - low * light.w, l - high * light.w, 0.0, end)
    }

    /// The same beam, at `t = 1` wider by `pad` on each side.
    pub fn widened_at_end(&self, pad: DVec3) -> Self {
        Self::new(self.low, self.high, self.low_step - pad, self.high_step + pad, self.start, self.end)
    }

    /// The parameter at which the beam enters the box, or `None` if no part of it does; never misses.
    ///
    /// Each side of the box is one linear inequality in `t`. Its bound is correct to a few roundings whatever the
    /// magnitudes, because the difference is rounded once (after Ize 2013, *Robust BVH ray traversal*). A larger box
    /// is entered whenever one inside it is: every operation is monotone.
    #[inline]
    pub fn enters(&self, low: DVec3, high: DVec3) -> Option<f64> {
        let (mut first, mut last) = (self.start, self.end);
        let mut open = true;
        for axis in 0..3 {
            // low + t·low_step <= box high
            let room = high[axis] - self.low[axis];
            let t = room * self.low_inverse[axis];
            let step = self.low_step[axis];
            if step > 0.0 {
                last = last.min(t);
            } else if step < 0.0 {
                first = first.max(t);
            } else {
                open &= room >= 0.0;
            }
            // high + t·high_step >= box low
            let room = low[axis] - self.high[axis];
            let t = room * self.high_inverse[axis];
            let step = self.high_step[axis];
            if step > 0.0 {
                first = first.max(t);
            } else if step < 0.0 {
                last = last.min(t);
            } else {
                open &= room <= 0.0;
            }
        }
        (open && first <= last * SLACK).then_some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_parallel_rays_are_not_cut_short() {
        // A ray that a clamped reciprocal of the zero components loses.
        let ray = Beam::ray(DVec3::new(1.0 - 1e-6, 0.5, -100.0), DVec3::Z, 0.0, f64::INFINITY);
        assert!(ray.enters(DVec3::ZERO, DVec3::ONE).is_some());
        assert!(ray.enters(DVec3::new(2.0, 0.0, 0.0), DVec3::new(3.0, 1.0, 1.0)).is_none());
        assert!(ray.enters(DVec3::new(0.0, 0.0, -300.0), DVec3::new(1.0, 1.0, -200.0)).is_none());
    }

    #[test]
    fn a_beam_holds_each_of_its_segments() {
        let (low, high) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 0.0, 3.0));
        for light in [DVec4::new(0.5, 4.0, -3.0, 1.0), DVec4::new(0.1, 1.0, 0.3, 0.0)] {
            let beam = Beam::towards(low, high, light);
            for k in 0..1000 {
                let s = |n: f64| (f64::from(k) * n).fract();
                let p = low + (high - low) * DVec3::new(s(0.618), s(0.414), s(0.732));
                let q = p + (light.truncate() - p * light.w) * s(0.236);
                assert!(beam.enters(q, q).is_some(), "{q} of {light}");
            }
            let aside = DVec3::new(0.0, 1.0, 30.0);
            assert!(beam.enters(aside, aside + 1.0).is_none());
        }
    }
}
