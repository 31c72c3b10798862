//! Depth comparison with a map of nearest depths, filtered over texels or not.

use glam::{DVec2, DVec3};
use subpixel_shadows::light_view::LightView;

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
    /// Taps around a place in place of the filter, texels; none for the filter.
    pub taps: &'a [DVec2],
    /// The view of the map, where it is a paraboloid one: planes are bent there.
    pub curved: Option<LightView>,
}

/// Cosine and sine of the angle at which a pixel has its taps.
pub fn turn_of([x, y]: [u32; 2]) -> DVec2 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    // Within an eighth of a turn by the tangent of half of it; three bits tell which of the eight.
    let t = (2f64.sqrt() - 1.0) * f64::from(h >> 8) / f64::from(1 << 24);
    let angle = 2.0 * t.atan();
    let (sin, cos) = if h & 1 == 0 { angle.sin_cos() } else { (std::f64::consts::FRAC_PI_2 - angle).sin_cos() };
    DVec2::new(if h & 2 == 0 { cos } else { -cos }, if h & 4 == 0 { sin } else { -sin })
}

impl DepthLookup<'_> {
    fn lit(&self, [x, y]: [i64; 2], depth: f64) -> f64 {
        let size = i64::from(self.size);
        let held = (0..size).contains(&x) && (0..size).contains(&y);
        let nearest = held.then(|| self.depths[(y * size + x) as usize]).flatten();
        f64::from(u8::from(nearest.is_none_or(|d| d >= depth)))
    }

    /// Change of the depth of a receiver with this slope at a place on the way to another.
    fn rise(&self, at: DVec3, slope: DVec2, to: DVec2) -> f64 {
        let Some(view) = self.curved else { return slope.dot(to - at.truncate()) };
        const STEP: f64 = 1e-3;
        let ray = |place: DVec2| view.ray_of_texel(place).normalize();
        let place = at.truncate();
        let apart = at.z / view.z.w;
        let along = |step: DVec2, slope: f64| {
            let turn = (ray(place + step) - ray(place - step)) / (2.0 * STEP);
            ray(place) * (slope / view.z.w) + turn * apart
        };
        let normal = along(DVec2::X * STEP, slope.x).cross(along(DVec2::Y * STEP, slope.y));
        let depth = normal.dot(ray(place) * apart) / normal.dot(ray(to)) * view.z.w;
        if depth > 0.0 { depth - at.z } else { slope.dot(to - place) }
    }

    /// Lit share at a place (texel x, y, depth) of a receiver with this slope (depth per texel).
    pub fn share(&self, at: DVec3, slope: DVec2) -> f64 {
        let depth = at.z - self.constant - self.slope * slope.abs().max_element();
        if !self.taps.is_empty() {
            let lit = self.taps.iter().map(|tap| {
                let texel = (at.truncate() + *tap).floor();
                self.lit([texel.x as i64, texel.y as i64], depth + self.rise(at, slope, texel + 0.5))
            });
            return lit.sum::<f64>() / self.taps.len() as f64;
        }
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
                let away = if self.receiver_plane { self.rise(at, slope, middle) } else { 0.0 };
                weight(x, first.x - low.x) * weight(y, first.y - low.y) * self.lit(tap, depth + away)
            })
            .sum();
        sum / (last * last) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_turns_to_all_sides() {
        let turns: Vec<DVec2> = (0..64).flat_map(|y| (0..64).map(move |x| turn_of([x, y]))).collect();
        assert!(turns.iter().all(|turn| (turn.length() - 1.0).abs() < 1e-12));
        let mean = turns.iter().sum::<DVec2>() / turns.len() as f64;
        assert!(mean.length() < 0.03, "{mean}");
        let mut eighths = [0; 8];
        for turn in &turns {
            eighths[((turn.to_angle() / std::f64::consts::FRAC_PI_4).floor() + 4.0) as usize % 8] += 1;
        }
        assert!(eighths.iter().all(|n| (430..600).contains(n)), "{eighths:?}");
    }

    /// A texel in two is dark: the taps that fall there are.
    #[test]
    fn a_disc_is_the_mean_of_its_taps() {
        let depths: Vec<Option<f64>> = (0..64).map(|k| (k % 2 == 0).then_some(0.25)).collect();
        let taps = [DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0), DVec2::new(-0.6, 0.1)];
        let of = |taps| DepthLookup {
            depths: &depths,
            size: 8,
            kernel: 1,
            constant: 0.0,
            slope: 0.0,
            receiver_plane: true,
            taps,
            curved: None,
        };
        let at = DVec3::new(3.5, 3.5, 0.5);
        assert_eq!(of(&taps[..]).share(at, DVec2::ZERO), 0.5);
        assert_eq!(of(&taps[..1]).share(at, DVec2::ZERO), 1.0);
        // A receiver that comes before the map towards the right.
        assert_eq!(of(&taps[1..2]).share(at, DVec2::new(-0.3, 0.0)), 1.0);
        assert_eq!(of(&taps[1..2]).share(at, DVec2::new(-0.2, 0.0)), 0.0);
    }
}
