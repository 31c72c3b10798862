//! Definition of which surfaces that cast nothing the samples of a pixel may see, by what pixels around it show.

use super::view::View;
use glam::{DVec2, DVec3};

/// Content of a pixel at its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShownSurface {
    /// Nothing.
    Nothing,
    /// Something at no place.
    Unknown,
    /// A caster at a place in the frame.
    Caster(DVec3),
    /// A surface that casts nothing, at a place in the frame on the plane of three others.
    Receiver(DVec3, [DVec3; 3]),
}

/// Sides of a square of pixels around one, which are numbered row by row.
const SIDE: i64 = 5;
/// The pixel itself.
pub const OWN: u32 = 12;
/// Pixels that one is chosen of.
const MOST: u32 = 8;
/// Share of a depth, of a length, or of a distance in pixels that single precision may be off.
const ROUNDING: f64 = 2e-6;

/// An image of a camera.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverImage<'a> {
    /// The frame.
    pub view: &'a View,
    /// Content of each pixel.
    pub shown: &'a [ShownSurface],
    /// Share of a view depth by which one surface may be before another.
    pub tolerance: f64,
}

/// Result of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Is {
    Sure(bool),
    /// Within rounding.
    Open,
}

/// Pixels that have a receiver to show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChosenReceivers {
    /// A bit for each.
    pub bits: u32,
    /// Rounding to 32 bits may lead to another answer.
    pub open: bool,
}

/// The samples of a pixel that see a receiver if no caster is nearer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReceiverSamples {
    /// Those that surely do.
    pub sure: u128,
    /// Those that may.
    pub possible: u128,
}

impl ReceiverImage<'_> {
    /// The pixel that has a number around another, in the image.
    pub fn around(&self, pixel: usize, k: u32) -> Option<usize> {
        let k = i64::from(k);
        self.beside(pixel, [k % SIDE - SIDE / 2, k / SIDE - SIDE / 2])
    }

    fn beside(&self, pixel: usize, [dx, dy]: [i64; 2]) -> Option<usize> {
        let [w, h] = self.view.image.map(i64::from);
        let (x, y) = (pixel as i64 % w + dx, pixel as i64 / w + dy);
        (x >= 0 && y >= 0 && x < w && y < h).then_some((y * w + x) as usize)
    }

    /// The ray at an offset, in pixels, from a pixel's centre.
    fn ray(&self, pixel: usize, offset: DVec2) -> DVec3 {
        let width = self.view.image[0] as usize;
        let at = DVec2::new((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5) + offset;
        self.view.rays.direction(at.x, at.y)
    }

    fn depth(&self, point: DVec3) -> f64 {
        point.dot(self.view.rays.forward)
    }

    /// Whether the plane of three corners runs before a depth on a ray.
    fn runs_before(&self, [a, b, c]: [DVec3; 3], ray: DVec3, depth: f64) -> Is {
        let n = (b - a).cross(c - a);
        let here = n.dot(a) / n.dot(ray);
        let along = (n.dot(ray) / (n.length() * ray.length())).abs();
        let least = (1.0 - self.tolerance) * depth;
        if along < 1e-5 || (here > 0.0 && (here - least).abs() < ROUNDING * (least.min(here) + a.length() / along)) {
            return Is::Open;
        }
        Is::Sure(here > 0.0 && here < least)
    }

    /// The farthest depth over a square around the pixel's centre, half as wide as told, of its receiver, if that holds the square beyond the near
    /// distance.
    pub fn farthest_over(&self, pixel: usize, half: f64) -> Option<f64> {
        let ShownSurface::Receiver(_, [a, b, c]) = self.shown[pixel] else { return None };
        let n = (b - a).cross(c - a);
        let corners =
            [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|o| self.ray(pixel, half * DVec2::from(o)));
        let depths = corners.map(|ray| n.dot(a) / n.dot(ray));
        let inside = |ray: &DVec3| [[a, b], [b, c], [c, a]].iter().all(|[p, q]| p.cross(*q).dot(*ray) * n.dot(a) > 0.0);
        let seen = |k: usize| inside(&corners[k]) && depths[k] > self.view.near_along(corners[k]);
        (0..4).all(seen).then(|| depths.into_iter().fold(0.0, f64::max))
    }

    /// Receivers that a pixel may show; of one that shows a caster those around it.
    pub fn chosen(&self, pixel: usize) -> ChosenReceivers {
        let mut out = ChosenReceivers::default();
        let place = match self.shown[pixel] {
            ShownSurface::Nothing | ShownSurface::Unknown => return out,
            ShownSurface::Receiver(..) => return ChosenReceivers { bits: 1 << OWN, open: false },
            ShownSurface::Caster(place) => place,
        };
        let far = |k: &u32| (*k as i64 % SIDE - 2).abs().max((*k as i64 / SIDE - 2).abs());
        let corner = |k: &u32| (*k as i64 % SIDE - 2).abs() + (*k as i64 / SIDE - 2).abs();
        let all: Vec<u32> = (0..25).filter(|&k| k != OWN).collect();
        let of = |want: i64| all.iter().copied().filter(move |k| far(k) == want);
        let next = of(1).filter(|k| corner(k) == 1).chain(of(1).filter(|k| corner(k) == 2));
        self.choose(&mut out, pixel, place, next.collect());
        if out.bits == 0 {
            self.choose(&mut out, pixel, place, of(2).collect());
        }
        out
    }

    fn choose(&self, out: &mut ChosenReceivers, pixel: usize, place: DVec3, among: Vec<u32>) {
        for k in among {
            let Some(q) = self.around(pixel, k) else { continue };
            let ShownSurface::Receiver(point, corners) = self.shown[q] else { continue };
            if out.bits.count_ones() == MOST {
                continue;
            }
            match self.runs_before(corners, self.ray(pixel, DVec2::ZERO), self.depth(place)) {
                Is::Sure(true) => continue,
                Is::Sure(false) => {}
                Is::Open => out.open = true,
            }
            let mut known = false;
            for j in (0..25).filter(|j| out.bits >> j & 1 == 1) {
                let Some(ShownSurface::Receiver(_, [a, b, c])) = self.around(pixel, j).map(|q| self.shown[q]) else {
                    continue;
                };
                let off = (b - a).cross(c - a).normalize().dot(point - a).abs();
                let most = self.tolerance * self.depth(point);
                known |= off <= most;
                out.open |= (off - most).abs() < ROUNDING * (point.length() + a.length());
            }
            if !known {
                out.bits |= 1 << k;
            }
        }
    }

    /// For each of the chosen pixels, by rising number, the samples at `offsets` (from the pixel's centre) that see its receiver.
    pub fn samples(&self, pixel: usize, bits: u32, offsets: &[DVec2]) -> Vec<(u32, ReceiverSamples)> {
        let chosen: Vec<u32> = (0..25).filter(|k| bits >> k & 1 == 1).collect();
        let mut out: Vec<(u32, ReceiverSamples)> = chosen.iter().map(|&k| (k, ReceiverSamples::default())).collect();
        for (s, &offset) in offsets.iter().enumerate() {
            let step = match (offset.x.abs() >= offset.y.abs(), offset.x > 0.0, offset.y > 0.0) {
                (true, right, _) => [if right { 1 } else { -1 }, 0],
                (false, _, down) => [0, if down { 1 } else { -1 }],
            };
            // The nearest of those that may be, and of those that surely are.
            let mut nearest: Vec<(f64, usize, bool)> = Vec::new();
            for (n, &k) in chosen.iter().enumerate() {
                let Some(ShownSurface::Receiver(_, corners)) = self.around(pixel, k).map(|q| self.shown[q]) else {
                    continue;
                };
                let hidden = if k == OWN { Is::Sure(false) } else { self.is_hidden(pixel, corners, step) };
                if hidden != Is::Sure(true) {
                    let centre = DVec2::new((i64::from(k) % SIDE - 2) as f64, (i64::from(k) / SIDE - 2) as f64);
                    nearest.push(((centre - offset).length_squared(), n, hidden == Is::Sure(false)));
                }
            }
            let least = nearest.iter().map(|c| c.0).fold(f64::INFINITY, f64::min);
            let surest = nearest.iter().filter(|c| c.2).map(|c| c.0).fold(f64::INFINITY, f64::min);
            let first = nearest.iter().find(|c| c.0 == least).map(|c| c.1);
            for &(away, n, open) in &nearest {
                let near = away <= surest * (1.0 + ROUNDING);
                let alone = open
                    && first == Some(n)
                    && nearest.iter().all(|c| c.1 == n || c.0 == away || c.0 > away * (1.0 + ROUNDING));
                let (inside, sure) = self.is_seen(pixel, chosen[n], offset);
                let bit = u128::from(near && inside) << s;
                out[n].1.possible |= bit;
                out[n].1.sure |= if alone && sure { bit } else { 0 };
            }
        }
        out
    }

    /// Whether a receiver runs before what the pixel a step away shows.
    fn is_hidden(&self, pixel: usize, corners: [DVec3; 3], step: [i64; 2]) -> Is {
        let Some(q) = self.beside(pixel, step) else { return Is::Sure(false) };
        let depth = match self.shown[q] {
            ShownSurface::Unknown => return Is::Sure(false),
            ShownSurface::Nothing => 3e38,
            ShownSurface::Caster(place) | ShownSurface::Receiver(place, _) => self.depth(place),
        };
        self.runs_before(corners, self.ray(pixel, DVec2::new(step[0] as f64, step[1] as f64)), depth)
    }

    /// Whether a ray may meet a receiver in its triangle beyond the near distance, and whether it surely does.
    fn is_seen(&self, pixel: usize, k: u32, offset: DVec2) -> (bool, bool) {
        let Some(ShownSurface::Receiver(_, [a, b, c])) = self.around(pixel, k).map(|q| self.shown[q]) else {
            return (false, false);
        };
        let (n, ray) = ((b - a).cross(c - a), self.ray(pixel, offset));
        let edges = [[a, b], [b, c], [c, a]].map(|[p, q]| {
            let m = p.cross(q);
            n.dot(a).signum() * m.dot(ray) / (m.length() * ray.length())
        });
        let inside = edges.into_iter().fold(f64::INFINITY, f64::min);
        let depth = n.dot(a) / n.dot(ray);
        let beyond = depth / self.view.near_along(ray) - 1.0;
        let doubt = ROUNDING * (1.0 + a.length() / (n.dot(a) / n.length()).abs().max(1e-9));
        (inside > -doubt && beyond > -doubt, inside > doubt && beyond > doubt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Lens, Light};

    /// A post before a floor: around it the floor is chosen once, its far edge is not followed into the sky.
    #[test]
    fn a_floor_goes_on_behind_a_post_and_ends_before_the_sky() {
        let camera = Camera {
            eye: [0.0, 1.0, 0.0],
            target: [0.0, 1.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 90.0,
            near: 0.01,
            far: 100.0,
            near_plane: None,
            lens: Lens::CENTRED,
        };
        let bounds = (DVec3::splat(-1.0), DVec3::ONE);
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let map = LightView::around(bounds, &light, 8).unwrap();
        let view = View::new(&camera, &light, &map, bounds, [9, 9], false);
        let floor = [[-20.0, 0.0, 20.0], [20.0, 0.0, 20.0], [0.0, 0.0, -20.0]].map(|p| view.point(p));
        let view = &view;
        fn image<'a>(view: &'a View, shown: &'a [ShownSurface]) -> ReceiverImage<'a> {
            ReceiverImage { view, shown, tolerance: 1e-4 }
        }
        let at = |pixel: usize| {
            let ray: DVec3 = view.rays.direction((pixel % 9) as f64 + 0.5, (pixel / 9) as f64 + 0.5);
            ((floor[1] - floor[0]).cross(floor[2] - floor[0]).dot(floor[0])
                / (floor[1] - floor[0]).cross(floor[2] - floor[0]).dot(ray))
                * ray
        };
        // Of the floor, below the horizon.
        let mut shown: Vec<ShownSurface> = (0..81)
            .map(|p| if p < 45 { ShownSurface::Nothing } else { ShownSurface::Receiver(at(p), floor) })
            .collect();
        (4..81)
            .step_by(9)
            .for_each(|p| shown[p] = ShownSurface::Caster(view.rays.direction(4.5, p as f64 / 9.0) * view.scale));
        let below = 7 * 9 + 4;
        let chosen = image(view, &shown).chosen(below);
        assert_eq!((chosen.bits.count_ones(), chosen.open), (1, false));
        let offsets = [[-0.4, 0.1], [0.4, -0.1], [0.0, 0.3]].map(DVec2::from);
        let seen = image(view, &shown).samples(below, chosen.bits, &offsets);
        assert_eq!(seen[0].1, ReceiverSamples { sure: 7, possible: 7 });
        // At the horizon: the pixels above show the sky, before which the floor does not go on.
        let beside = 4 * 9 + 4;
        assert_eq!(image(view, &shown).chosen(beside).bits.count_ones(), 1);
        // Nothing is chosen for what shows nothing, and a caster behind the floor hides none of it.
        assert_eq!(image(view, &shown).chosen(3).bits, 0);
        shown[below] = ShownSurface::Caster(at(below) * 1.5);
        assert_eq!(image(view, &shown).chosen(below).bits, 0, "the floor runs before what the pixel shows");
    }
}
