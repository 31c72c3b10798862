//! Depth comparison with a map of nearest depths, filtered over texels or not.

use glam::{DVec2, DVec3};

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct DepthLookup<'a> {
    /// Nearest depth of each texel, row by row; `None` where there is no caster.
    pub depths: &'a [Option<f64>],
    /// Texels a side.
    pub size: u32,
    /// Texels a side of the filter; 1 for none.
    pub kernel: u32,
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times the steeper slope of the receiver per texel.
    pub slope: f64,
    /// Whether the receiver's depth is taken at each texel of the filter.
    pub receiver_plane: bool,
}

impl DepthLookup<'_> {
    fn lit(&self, [x, y]: [i64; 2], depth: f64) -> f64 {
        let size = i64::from(self.size);
        let held = (0..size).contains(&x) && (0..size).contains(&y);
        let nearest = held.then(|| self.depths[(y * size + x) as usize]).flatten();
        f64::from(u8::from(nearest.is_none_or(|d| d >= depth)))
    }

    /// Lit share at a place (texel x, y, depth) of a receiver with this slope (depth per texel).
    pub fn share(&self, at: DVec3, slope: DVec2) -> f64 {
        let depth = at.z - self.constant - self.slope * slope.abs().max_element();
        let first = at.truncate() - 0.5 * f64::from(self.kernel - 1);
        let low = first.floor();
        let last = i64::from(self.kernel) - 1;
        if last == 0 {
            return self.lit([low.x as i64, low.y as i64], depth);
        }
        let weight = |k: i64, part: f64| match k {
            0 => 1.0 - part,
            k if k == last => part,
            _ => 1.0,
        };
        let taps = (0..=last).flat_map(|y| (0..=last).map(move |x| [x, y]));
        let sum: f64 = taps
            .map(|[x, y]| {
                let tap = [low.x as i64 + x, low.y as i64 + y];
                let middle = DVec2::new(tap[0] as f64 + 0.5, tap[1] as f64 + 0.5);
                let away = if self.receiver_plane { slope.dot(middle - at.truncate()) } else { 0.0 };
                weight(x, first.x - low.x) * weight(y, first.y - low.y) * self.lit(tap, depth + away)
            })
            .sum();
        sum / (last * last) as f64
    }
}
