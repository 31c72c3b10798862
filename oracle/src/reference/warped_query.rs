//! Depth comparison with a map whose axes are warped.

use glam::{DVec2, DVec3};

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct WarpedLookup<'a> {
    /// Where each texel of either axis begins and the last ends, in texels of the even map.
    pub borders: [&'a [f64]; 2],
    /// Nearest depth of each texel, row by row; `None` where there is no caster.
    pub depths: &'a [Option<f64>],
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times the greater change of the receiver's depth across the texel.
    pub slope: f64,
}

impl WarpedLookup<'_> {
    /// Lit share at a place (texel of the even map x, y, depth) of a receiver with this slope (depth per texel of the even map).
    pub fn share(&self, at: DVec3, slope: DVec2) -> f64 {
        let (mut place, mut across) = ([0; 2], 0.0f64);
        for axis in 0..2 {
            let borders = self.borders[axis];
            let after = borders.partition_point(|border| *border <= at[axis]);
            if after == 0 || after == borders.len() {
                return 1.0;
            }
            place[axis] = after - 1;
            across = across.max(slope[axis].abs() * (borders[after] - borders[after - 1]));
        }
        let Some(nearest) = self.depths[place[1] * (self.borders[0].len() - 1) + place[0]] else { return 1.0 };
        f64::from(u8::from(nearest >= at.z - self.constant - self.slope * across))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_asks_the_texel_it_lies_in() {
        let lookup = WarpedLookup {
            borders: [&[0.0, 3.0, 4.0], &[0.0, 1.0, 4.0]],
            depths: &[Some(0.2), None, Some(0.8), Some(0.4)],
            constant: 0.0,
            slope: 1.0,
        };
        let of = |x, y| lookup.share(DVec3::new(x, y, 0.5), DVec2::ZERO);
        assert_eq!([of(2.9, 0.9), of(3.0, 0.9), of(2.9, 1.0), of(3.5, 3.9)], [0.0, 1.0, 1.0, 0.0]);
        assert_eq!([of(4.0, 2.0), of(-0.1, 2.0), of(2.0, 4.0)], [1.0; 3]);
        let steep = |slope| lookup.share(DVec3::new(3.5, 2.0, 0.5), slope);
        assert_eq!([steep(DVec2::new(0.09, 0.0)), steep(DVec2::new(0.0, -0.04))], [0.0, 1.0]);
    }
}
