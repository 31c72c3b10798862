//! Visibility of frames before at the same point, mixed with that of this frame.

use glam::{DVec2, DVec3};

/// The image before.
#[derive(Clone, Copy, Debug)]
pub struct ImageBefore<'a> {
    /// The eye.
    pub eye: DVec3,
    /// Directions through the top left corner, and their changes for one pixel to the right and down, of view depth 1.
    pub rays: [DVec3; 3],
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Visibility, view depth and sum of weights of each pixel, row by row; depth 0 where nothing lit was seen.
    pub past: &'a [[f64; 3]],
}

impl ImageBefore<'_> {
    /// Place in pixels, and view depth, of a point.
    pub fn place(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let [corner, x, y] = self.rays;
        // By Cramer's rule.
        let off = point - self.eye;
        let volume = corner.dot(x.cross(y));
        let depth = off.dot(x.cross(y)) / volume;
        let at = DVec2::new(off.dot(y.cross(corner)), off.dot(corner.cross(x))) / volume / depth;
        (depth > 0.0).then_some((at, depth))
    }

    /// Visibility and sum of weights at a place, bilinear over the four pixels around that saw the plane `normal · p = height` within a share `tolerance` of
    /// their depth, and the share of these; `None` where none did.
    pub fn at(&self, place: DVec2, (normal, height): (DVec3, f64), tolerance: f64) -> Option<([f64; 2], f64)> {
        let first = place - 0.5;
        let low = first.floor();
        let [corner, x, y] = self.rays;
        let (mut sum, mut weight) = ([0.0; 2], 0.0);
        for k in 0..4u32 {
            let off = DVec2::new(f64::from(k & 1), f64::from(k >> 1));
            let pixel = low + off;
            let inside =
                pixel.min_element() >= 0.0 && pixel.x < f64::from(self.size[0]) && pixel.y < f64::from(self.size[1]);
            if !inside {
                continue;
            }
            let [was, depth, total] = self.past[(pixel.y * f64::from(self.size[0]) + pixel.x) as usize];
            let middle = pixel + 0.5;
            let ray = corner + x * middle.x + y * middle.y;
            let expected = (height - normal.dot(self.eye)) / normal.dot(ray);
            if depth > 0.0 && (depth - expected).abs() <= tolerance * depth {
                let share = (1.0 - (first - pixel).x.abs()) * (1.0 - (first - pixel).y.abs());
                sum = [sum[0] + share * was, sum[1] + share * total];
                weight += share;
            }
        }
        (weight > 0.0).then(|| (sum.map(|s| s / weight), weight))
    }
}

/// How sure a lookup at a place of a map is: 1 at the centre of a texel, 0 at its sides.
pub fn confidence(texel: DVec2) -> f64 {
    1.0 - 2.0 * (texel - texel.floor() - 0.5).abs().max_element()
}

/// Most that is remembered of a sum of weights.
const MOST: f64 = 4.0;
/// The least weight.
const LEAST: f64 = 1e-6;

/// This frame's visibility mixed into the past's, of which the sum of weights is told, and the sum with its own.
pub fn blended(visibility: f64, past: Option<[f64; 2]>, confidence: f64, power: u32) -> [f64; 2] {
    let weight = confidence.powi(power as i32).max(LEAST);
    let [mean, sum] = past.unwrap_or([visibility, 0.0]);
    [mean + weight / (sum + weight) * (visibility - mean), (sum + weight).min(MOST)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels by two that look down -z from the origin upon a wall, of which one shows something nearer.
    #[test]
    fn pixels_that_saw_another_surface_are_left_out() {
        let past = [[1.0, 2.0, 3.0], [0.0, 2.0, 1.0], [0.5, 1.0, 1.0], [0.0, 0.0, 1.0]];
        let rays = [DVec3::new(-1.0, 1.0, -1.0), DVec3::X, DVec3::NEG_Y];
        let image = ImageBefore { eye: DVec3::ZERO, rays, size: [2, 2], past: &past };
        let wall = (DVec3::Z, -2.0);
        let (place, depth) = image.place(DVec3::new(0.0, 1.0, -2.0)).unwrap();
        assert!((place - DVec2::new(1.0, 0.5)).length() < 1e-12 && (depth - 2.0).abs() < 1e-12);
        assert_eq!(image.at(place, wall, 0.01), Some(([0.5, 2.0], 1.0)));
        assert_eq!(image.at(DVec2::new(1.0, 1.0), wall, 0.01), Some(([0.5, 2.0], 0.5)));
        assert_eq!(image.at(DVec2::new(0.5, 1.5), wall, 0.01), None);
        assert_eq!(image.at(DVec2::new(-3.0, 0.5), wall, 0.01), None);
        assert_eq!(image.place(DVec3::Z), None);
    }

    #[test]
    fn the_surer_the_lookup_the_more_it_counts() {
        assert_eq!(confidence(DVec2::new(3.5, 7.5)), 1.0);
        assert_eq!(confidence(DVec2::new(3.5, 7.25)), 0.5);
        assert_eq!(confidence(DVec2::new(3.0, 7.5)), 0.0);
        assert_eq!(blended(1.0, Some([0.0, 0.75]), 0.5, 2), [0.25, 1.0]);
        assert_eq!(blended(1.0, Some([0.0, 0.0]), 0.5, 2), [1.0, 0.25]);
        assert_eq!(blended(1.0, Some([1.0, 4.0]), 0.5, 2), [1.0, 4.0]);
        assert_eq!(blended(1.0, None, 0.5, 1), [1.0, 0.5]);
    }
}
