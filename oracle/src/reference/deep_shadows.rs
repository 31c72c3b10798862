//! Shadows by a deep shadow map (Lokovic and Veach 2000): its functions asked bilinearly.

use super::deep_map::{WHOLE, light_of, place_of};
use glam::{DVec2, DVec3};

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct DeepLookup<'a> {
    /// Nodes (place, light) of each texel, row by row.
    pub texels: &'a [Vec<(u32, f64)>],
    /// Texels a side.
    pub side: u32,
    /// Sub-texels a side of a texel.
    pub sub: u32,
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times what its plane rises from a texel's middle to its corner.
    pub slope: f64,
}

impl DeepLookup<'_> {
    /// Share of light at a place (sub-texel x, y, depth) of a receiver with this slope (depth per sub-texel): least and greatest of those that a
    /// doubt of its depth leaves.
    pub fn share(&self, at: DVec3, slope: DVec2, doubt: f64) -> [f64; 2] {
        let width = f64::from(self.sub);
        let depth = at.z - self.constant - self.slope * 0.5 * width * (slope.x.abs() + slope.y.abs());
        let place = at.truncate() / width - 0.5;
        let low = place.floor();
        let part = place - low;
        let mut shares = [0.0; 2];
        for step in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(DVec2::from) {
            let texel = low + step;
            let weights = step * part + (1.0 - step) * (1.0 - part);
            let there = depth + slope.dot((texel + 0.5) * width - at.truncate());
            let inside = texel.cmpge(DVec2::ZERO).all() && texel.cmplt(DVec2::splat(f64::from(self.side))).all();
            let nodes = || &self.texels[(texel.y * f64::from(self.side) + texel.x) as usize];
            let light = |by: f64| if inside { light_of(nodes(), place_of(there + by)) } else { WHOLE };
            for (share, by) in shares.iter_mut().zip([doubt, -doubt]) {
                *share += weights.x * weights.y * light(by) / WHOLE;
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_that_of_four_texels_at_the_receivers_plane() {
        // Dark behind a depth of 0.5 in the left texels of two.
        let dark = vec![(place_of(0.5), WHOLE), (place_of(0.5) + 1, 0.0)];
        let texels = [dark.clone(), Vec::new(), dark, Vec::new()];
        let lookup = DeepLookup { texels: &texels, side: 2, sub: 4, constant: 0.0, slope: 0.0 };
        let share = |x: f64, z: f64, slope| lookup.share(DVec3::new(x, 4.0, z), DVec2::new(slope, 0.0), 0.0)[0];
        assert_eq!([2.0, 3.0, 4.0, 6.0].map(|x| share(x, 0.6, 0.0)), [0.0, 0.25, 0.5, 1.0]);
        assert_eq!([2.0, 4.0].map(|x| share(x, 0.5, 0.0)), [1.0; 2]);
        // The plane is before the step in the middle of the texel, two sub-texels to the left.
        assert_eq!(share(4.0, 0.6, 0.04), 0.5);
        assert_eq!(share(4.0, 0.6, 0.06), 1.0);
        // Half a texel beyond the border is half lit.
        assert_eq!(share(0.0, 0.6, 0.0), 0.5);
        let biased = DeepLookup { slope: 1.0, constant: 0.01, ..lookup };
        let at = DVec3::new(2.0, 2.0, 0.6);
        assert_eq!(biased.share(at, DVec2::new(0.02, 0.02), 0.0), [0.0; 2]);
        assert_eq!(biased.share(at, DVec2::new(0.03, 0.02), 0.0), [1.0; 2]);
        assert_eq!(biased.share(at, DVec2::new(0.03, 0.02), 0.02), [0.0, 1.0]);
    }
}
