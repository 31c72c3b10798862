//! A view whose map is larger than a device can bind, as several views of parts of it.

use super::LightView;
use std::num::NonZeroU32;

/// How a light view's map is cut: into so many parts a side, each with a map of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapTiles {
    across: u32,
    texels: u32,
}

impl MapTiles {
    /// A map of `map` texels a side in `across` parts a side, as far as it has texels.
    pub fn new(map: u32, across: NonZeroU32) -> Self {
        let texels = map.div_ceil(across.get()).max(1);
        Self { across: map.div_ceil(texels).max(1), texels }
    }

    /// As few as fit bindings of `bytes`.
    pub fn that_fit(map: u32, bytes: u64) -> Self {
        let fits = |across: &u32| Self::largest_binding(map.div_ceil(*across)) <= bytes;
        let across = (1..map).find(fits).unwrap_or(map);
        Self::new(map, NonZeroU32::new(across).unwrap_or(NonZeroU32::MIN))
    }

    /// Bytes of the largest buffer of a map of so many texels a side: a word for each texel, and one for each 8 x 8 of them.
    fn largest_binding(texels: u32) -> u64 {
        let words = u64::from(texels).pow(2).saturating_add(u64::from(texels.div_ceil(8)).pow(2) + 2);
        words.saturating_mul(4)
    }

    /// As few as fit what one binding holds by these limits.
    pub fn within(map: u32, limits: &wgpu::Limits) -> Self {
        Self::that_fit(map, limits.max_storage_buffer_binding_size.min(limits.max_buffer_size))
    }

    /// Parts a side.
    pub fn across(self) -> u32 {
        self.across
    }

    /// Texels a side of each part.
    pub fn texels(self) -> u32 {
        self.texels
    }

    /// The views of all parts of `views`, each with a map of [`MapTiles::texels`] a side, whose texels are those of the whole map. The
    /// last of a side may reach beyond it.
    pub fn of(self, views: Vec<LightView>) -> Vec<LightView> {
        if self.across == 1 {
            return views;
        }
        let last = self.across - 1;
        let parts = |view: LightView| {
            // The place of a paraboloid view is told by the fourth of its rows.
            let w = if view.paraboloid.is_some() { glam::DVec4::W } else { view.w };
            let place = move |k: u32| f64::from(k * self.texels) * w;
            let part = move |(x, y)| LightView {
                u: view.u - place(x),
                v: view.v - place(y),
                map_size: self.texels,
                one_of_several: true,
                ends: [
                    view.ends[0] && x == 0,
                    view.ends[1] && x == last,
                    view.ends[2] && y == 0,
                    view.ends[3] && y == last,
                ],
                ..view
            };
            (0..self.across).flat_map(move |y| (0..self.across).map(move |x| (x, y))).map(part)
        };
        views.into_iter().flat_map(parts).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;
    use crate::scene::Light;
    use glam::DVec3;

    #[test]
    fn as_few_parts_as_fit() {
        let parts = |map, bytes| MapTiles::that_fit(map, bytes);
        assert_eq!(parts(8192, 128 << 20), MapTiles { across: 2, texels: 4096 });
        assert_eq!(parts(5744, 128 << 20), MapTiles { across: 1, texels: 5744 });
        assert_eq!(parts(5793, 128 << 20), MapTiles { across: 2, texels: 2897 });
        let whole = MapTiles::largest_binding(512);
        assert_eq!(parts(512, whole), MapTiles { across: 1, texels: 512 });
        assert_eq!(parts(512, whole - 1), MapTiles { across: 2, texels: 256 });
        assert_eq!(parts(u32::MAX, u64::MAX), MapTiles { across: 1, texels: u32::MAX });
        assert_eq!(parts(7, 0), MapTiles { across: 7, texels: 1 });
        assert_eq!(MapTiles::new(10, NonZeroU32::new(7).unwrap()), MapTiles { across: 5, texels: 2 });
        for (map, bytes) in [(8191, 1 << 20), (1, 3), (333, 4000), (8192, 4)] {
            let of = parts(map, bytes);
            assert!(MapTiles::largest_binding(of.texels) <= bytes.max(16), "{of:?} in {bytes}");
            assert!(of.texels * of.across >= map && of.texels * (of.across - 1) < map, "{of:?} of {map}");
        }
    }

    /// A point that lies in the whole map lies in the part of its texel, there.
    #[test]
    fn parts_are_the_whole() {
        let mesh = scene();
        for light in [Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Point { position: [0.5, 6.0, 0.5] }] {
            let whole = LightView::fit(&mesh, &light, 100).unwrap();
            let parts = MapTiles::new(100, NonZeroU32::new(3).unwrap());
            let views = parts.of(vec![whole]);
            assert_eq!((views.len(), parts.texels()), (9, 34));
            assert!(views.iter().all(|v| v.one_of_several && v.map_size == 34));
            let mut met = [false; 9];
            for k in 0..400u32 {
                let p = DVec3::new(f64::from(k % 20), 0.3, f64::from(k / 20)) * 0.1 - DVec3::new(0.5, 0.0, 0.5);
                let Some(at) = whole.project(p).filter(|p| p.x.min(p.y) > 0.0 && p.x.max(p.y) < 100.0) else {
                    continue;
                };
                let [x, y] = [at.x, at.y].map(|v| (v / 34.0) as usize);
                let here = views[3 * y + x].project(p).unwrap();
                let back = here + 34.0 * DVec3::new(x as f64, y as f64, 0.0);
                assert!((back - at).length() < 1e-9, "{at} {here}");
                met[3 * y + x] = true;
            }
            assert!(met.iter().filter(|&&m| m).count() >= 2, "{light:?}: points in {met:?}");
        }
        let one = LightView::fit(&mesh, &Light::Directional { direction: [0.3, 1.0, 0.2] }, 100).unwrap();
        assert_eq!(MapTiles::that_fit(100, 1 << 20).of(vec![one]), vec![one]);
    }
}
