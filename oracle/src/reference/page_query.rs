//! Depth comparison with pages of a quadtree.

use super::page_casters::PAGE;
use super::page_requests::TreePage;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Pages and how they are asked.
#[derive(Clone, Copy, Debug)]
pub struct PageLookup<'a> {
    /// Nearest depth of each texel of the pages that are made, row by row; `None` where there is no caster.
    pub pages: &'a BTreeMap<TreePage, Vec<Option<f64>>>,
    /// Texels a side of the map.
    pub size: u32,
    /// The level whose texels are the map's.
    pub base: u32,
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times the steeper slope of the receiver per texel of the page.
    pub slope: f64,
}

impl PageLookup<'_> {
    /// Lit share at a place (texel of the map x, y, depth) of a receiver with this slope (depth per texel of the map), asked on a level:
    /// on the finest page there is that is no finer.
    pub fn share(&self, at: DVec3, slope: DVec2, level: u32) -> f64 {
        let side = f64::from(self.size);
        if at.x < 0.0 || at.y < 0.0 || at.x >= side || at.y >= side {
            return 1.0;
        }
        let found = (0..=level).rev().find_map(|level| {
            let scale = f64::from(level as i32 - self.base as i32).exp2();
            let texel = [at.x, at.y].map(|x| (x * scale) as u32);
            let page = self.pages.get(&(level, texel.map(|x| x / PAGE)))?;
            Some((scale, page[(texel[1] % PAGE * PAGE + texel[0] % PAGE) as usize]))
        });
        let Some((scale, Some(nearest))) = found else { return 1.0 };
        let depth = at.z - self.constant - self.slope * slope.abs().max_element() / scale;
        f64::from(u8::from(nearest >= depth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_page_there_is_answers() {
        let full = |depth| vec![Some(depth); (PAGE * PAGE) as usize];
        let pages = BTreeMap::from([((0, [0, 0]), full(0.75)), ((2, [2, 0]), full(0.25))]);
        let lookup = PageLookup { pages: &pages, size: 64, base: 1, constant: 0.0, slope: 0.5 };
        let of = |x: f64, level| lookup.share(DVec3::new(x, 1.0, 0.5), DVec2::ZERO, level);
        assert_eq!([of(33.0, 2), of(31.0, 2), of(33.0, 1), of(-1.0, 2), of(64.0, 2)], [0.0, 1.0, 1.0, 1.0, 1.0]);
        let steep = |level| lookup.share(DVec3::new(33.0, 1.0, 0.31), DVec2::new(0.0, -0.2), level);
        assert_eq!(steep(2), 0.0, "half of the slope");
        let steeper = lookup.share(DVec3::new(33.0, 1.0, 0.31), DVec2::new(0.0, -0.5), 2);
        assert_eq!(steeper, 1.0);
    }
}
