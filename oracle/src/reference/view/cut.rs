//! A triangle that reaches behind the light, in the light view.

use super::super::front_layer::Margin;
use super::View;
use glam::{DVec2, DVec3, DVec4};

/// A triangle that reaches behind the light, as the lines of its edges around what of it lies in front, and as its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Inside where `edge · (x, y, 1)` is not below 0.
    edges: [DVec3; 3],
    /// Depth at a place as `depth · (x, y, 1)`.
    depth: DVec3,
    /// The view's nearest distance by that of the triangle at a place, likewise.
    inverse: DVec3,
    /// How far 32 bits may be off: each edge, the depth, the last, and the determinant by itself.
    doubts: ([f64; 3], f64, f64, f64),
    /// Texels of the view's margin, of which those doubts are.
    unit: f64,
}

/// Share of the nearest distance in a triangle's own up to which it surely holds a texel.
const FRONT: f64 = 0.5;

impl Cut {
    /// Cut of the corners; `None` if the light lies in its plane.
    pub fn new(view: &View, corners: [DVec3; 3]) -> Option<Self> {
        let corners = corners.map(|p| p.extend(1.0));
        let [p, q, r] = corners.map(|p| DVec3::new(view.map.u.dot(p), view.map.v.dot(p), view.map.w.dot(p)));
        let [zp, zq, zr] = corners.map(|p| view.map.z.dot(p));
        let det = p.dot(q.cross(r));
        if !view.map.perspective || det == 0.0 {
            return None;
        }
        let (margins, near, size) = (view.map.margins(), view.map.near, f64::from(view.map.map_size));
        let far = [p, q, r].map(|p| p.x.abs().max(p.y.abs()).max(size * p.z.abs()));
        let both = [0, 1, 2].map(|k| far[k] * far[(k + 1) % 3]);
        let off = 8.0 * margins.texels * near;
        let sum = |row: DVec4| row.truncate().abs().element_sum();
        let share = 4e-6 + 2e-6 * (sum(view.map.u).max(sum(view.map.v)) / size + sum(view.map.w));
        let noise = (off * both.iter().sum::<f64>() + 2.0 * share * far.iter().product::<f64>()) / size;
        let slack = [0, 1, 2].map(|k| off * (far[k] + far[(k + 1) % 3]) + share * both[k]);
        let lines = [p.cross(q), q.cross(r), r.cross(p)];
        let depth = (zp * lines[1] + zq * lines[2] + zr * lines[0]) / det;
        let inverse = near / det * (lines[0] + lines[1] + lines[2]);
        let sure = (det.abs() - noise).max(f64::MIN_POSITIVE);
        let off = (zp.abs() * slack[1] + zq.abs() * slack[2] + zr.abs() * slack[0] + 2.0 * noise) / sure
            + 8.0 * margins.depth
            + 1e-6 * (size * (depth.x.abs() + depth.y.abs()) + depth.z.abs());
        Some(Self {
            edges: lines.map(|e| e * det.signum()),
            depth,
            inverse,
            doubts: (slack, off, near * slack.iter().sum::<f64>() / sure, 4.0 * noise / det.abs()),
            unit: margins.texels,
        })
    }

    /// Whether it may touch the closed square of half side `reach` around `centre`.
    pub fn touches(&self, centre: DVec2, reach: f64) -> bool {
        let beside = |e: &DVec3| e.dot(centre.extend(1.0)) + reach * (e.x.abs() + e.y.abs());
        self.edges.iter().all(|e| beside(e) >= 0.0)
    }

    /// How far `at` lies inside each edge, as [`Flat::inside`](super::Flat::inside).
    pub fn inside(&self, at: DVec2) -> [f64; 3] {
        self.edges.map(|e| e.dot(at.extend(1.0)) / (e.x.abs() + e.y.abs()).max(f64::MIN_POSITIVE))
    }

    /// Depth of its plane at `at`; `None` where it is nearer than the view's nearest distance.
    pub fn depth(&self, at: DVec2) -> Option<f64> {
        let at = at.extend(1.0);
        (self.inverse.dot(at) < 1.0).then(|| self.depth.dot(at))
    }

    /// How far 32 bits may be off in a depth, for `texels` by which its corners may be.
    pub fn depth_doubt(&self, texels: f64) -> f64 {
        texels / self.unit * self.doubts.1 + texels * (self.depth.x.abs() + self.depth.y.abs())
    }

    /// Whether it covers all of a texel, beyond the view's nearest distance, even if all is off by the margin.
    pub fn holds(&self, centre: DVec2, margin: Margin) -> bool {
        let (times, reach, at) = (margin.texels / self.unit, 0.5 + margin.texels, centre.extend(1.0));
        let (slack, _, front, unsure) = self.doubts;
        let spread = |v: DVec3| v.x.abs() + v.y.abs();
        let nearest = self.inverse.dot(at) + reach * spread(self.inverse) + times * front;
        let by = |(e, slack): (&DVec3, f64)| e.dot(at) - reach * spread(*e) - times * slack;
        let beyond = nearest <= if times == 0.0 { 1.0 } else { FRONT };
        times * unsure < 1.0 && beyond && self.edges.iter().zip(slack).map(by).all(|e| e >= 0.0)
    }

    /// Whether its depth at a texel's centre is surely found: it lies as far inside as half of what makes it hold the texel.
    pub fn is_layer(&self, centre: DVec2) -> bool {
        let (at, (slack, _, front, unsure)) = (centre.extend(1.0), self.doubts);
        let spread = |v: DVec3| v.x.abs() + v.y.abs();
        let nearest = self.inverse.dot(at) + 0.6 * spread(self.inverse) + front;
        let by = |(e, slack): (&DVec3, f64)| e.dot(at) - 0.6 * ((0.5 + self.unit) * spread(*e) + slack);
        1.1 * unsure < 1.0 && nearest <= FRONT && self.edges.iter().zip(slack).map(by).all(|e| e >= 0.0)
    }

    /// Least and greatest depth of its plane over the square; anything where 32 bits do not tell.
    pub fn depth_range(&self, centre: DVec2, reach: f64, margin: Margin) -> (f64, f64) {
        let times = margin.texels / self.unit;
        if times * self.doubts.3 >= 1.0 {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let middle = self.depth.dot(centre.extend(1.0));
        let half = reach * (self.depth.x.abs() + self.depth.y.abs()) + times * self.doubts.1 + margin.depth;
        (middle - half, middle + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::view::{Flat, centre};
    use lab::scene::builtin;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::Light;

    /// Corners around the light that differ for every seed, some behind it.
    fn corners(light: DVec3, seed: u32) -> [DVec3; 3] {
        let mut state = seed.wrapping_mul(0x9e37_79b9) | 1;
        let mut next = || {
            (state, _) = state.overflowing_mul(747_796_405);
            state ^= state >> 15;
            f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
        };
        std::array::from_fn(|_| light + DVec3::new(next(), next(), next()) * 3.0)
    }

    /// The lines of a triangle that reaches behind the light hold the texel of every point of it in front, but not all
    /// texels; those of a triangle that lies in front are the triangle's.
    #[test]
    fn lines_hold_what_is_in_front() {
        let mut scene = builtin("spheres").expect("a built-in scene");
        scene.light = Light::Point { position: [0.8, 1.9, 0.9] };
        let views = LightView::cube(&scene.mesh, &scene.light, 16).expect("a cube");
        let bounds = scene.mesh.bounds().expect("a mesh");
        let (mut behind, mut whole, mut hit, mut touched) = (0, 0, 0, 0);
        for view in views.iter().map(|map| View::new(&scene.camera, &scene.light, map, bounds, [8, 8], false)) {
            for seed in 0..300 {
                let corners = corners(view.light.truncate(), seed);
                let cut = Cut::new(&view, corners).expect("not in one plane with the light");
                let texels = || (0..256u32).map(|k| centre(k % 16, k / 16));
                let over = |at: DVec2| cut.touches(at, 0.5);
                if let [Some(a), Some(b), Some(c)] = corners.map(|p| view.on_map(p)) {
                    whole += 1;
                    let flat = Flat::new([a, b, c].map(DVec4::truncate));
                    for at in texels().filter(|&at| flat.touches(at, 0.49)) {
                        assert!(over(at), "{corners:?} touches {at}");
                    }
                    for at in texels().filter(|&at| cut.touches(at, 0.0)) {
                        assert!(flat.touches(at, 0.01), "{corners:?} does not touch {at}");
                    }
                    continue;
                }
                behind += 1;
                touched += texels().filter(|&at| over(at)).count();
                let mut seen = [false; 256];
                for (i, j) in (0..=150).flat_map(|i| (0..=150 - i).map(move |j| (i, j))) {
                    let [u, v] = [i, j].map(|k| f64::from(k) / 150.0);
                    let point = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    let Some(at) = view.on_map(point).filter(|p| p.x.min(p.y) > 0.0 && p.x.max(p.y) < 16.0) else {
                        continue;
                    };
                    let texel = at.truncate().truncate().floor();
                    seen[(texel.y * 16.0 + texel.x) as usize] = true;
                    assert!(over(texel + 0.5), "{corners:?} reaches {texel}");
                }
                hit += seen.iter().filter(|&&s| s).count();
            }
        }
        assert!(behind > 300 && whole > 30 && hit > 5000, "{behind} behind, {whole} in front, {hit} texels hit");
        assert!(touched < 2 * hit, "{touched} texels touched where {hit} are hit");
    }
}
