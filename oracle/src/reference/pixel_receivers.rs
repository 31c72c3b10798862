//! Definition of reading what pixels show out of an application's depths or positions.

use super::view::View;
use glam::{DVec2, DVec3};

/// Source of the surfaces' places.
#[derive(Clone, Copy, Debug)]
pub enum PositionSource<'a> {
    /// Depths: at view depth `z`, world units, `(terms[0] z + terms[1]) / (terms[2] z + terms[3])`.
    Depths {
        /// One a pixel.
        values: &'a [f32],
        /// The terms.
        terms: [f32; 4],
        /// The depth of no surface.
        nothing: f32,
    },
    /// World positions; alpha 0 is no surface.
    Positions(&'a [[f32; 4]]),
}

/// Triangle numbers: the texels, the first number, that for no caster, and the casters' number of each triangle.
pub type Ids<'a> = (&'a [u32], u32, u32, &'a [u32]);

/// An application's textures.
#[derive(Clone, Copy, Debug)]
pub struct GbufferTexels<'a> {
    /// Where surfaces are.
    pub places: PositionSource<'a>,
    /// Their normals.
    pub normals: Option<&'a [[f32; 4]]>,
    /// Their triangles.
    pub ids: Option<Ids<'a>>,
    /// How far from a caster's plane its surface may be said to be, in view depths.
    pub tolerance: f64,
    /// Where in a pixel they are given.
    pub at: [f64; 2],
}

/// Content of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelContent {
    /// Nothing.
    Nothing,
    /// A number that names no triangle.
    Unknown,
    /// A place or normal that is none.
    Unusable,
    /// A triangle of the casters.
    Caster(u32),
    /// Something else.
    Plane {
        /// A point of it, world units.
        point: DVec3,
        /// Its normal; any length.
        normal: DVec3,
        /// How far off a unit normal may be that is made with `f32`.
        doubt: f64,
    },
}

/// State of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverPixel {
    /// Its content.
    pub shown: PixelContent,
    /// Rounding to 32 bits may lead to another answer.
    pub open: bool,
}

/// How far beyond an edge, in pixels, a neighbour's triangle still counts.
const NEAR_EDGE: f64 = 1.0 / 32.0;
/// Beyond so many times the casters' distance there are no places.
const FARTHEST: f64 = 1e9;

/// State of each pixel; `seen` is the casters' triangle at each pixel centre, `corners` those of each caster in the frame.
pub fn pixels(
    view: &View,
    corners: &[Option<[DVec3; 3]>],
    seen: &[Option<u32>],
    given: &GbufferTexels,
) -> Vec<ReceiverPixel> {
    (0..seen.len()).map(|pixel| Asked { view, corners, seen, given }.pixel(pixel)).collect()
}

/// Pixels to look for a neighbour on the same surface.
const MOST_STEPS: i64 = 4;

/// A surface relative to the eye, scaled.
type Found = Result<DVec3, PixelContent>;

struct Asked<'a> {
    view: &'a View,
    corners: &'a [Option<[DVec3; 3]>],
    seen: &'a [Option<u32>],
    given: &'a GbufferTexels<'a>,
}

impl Asked<'_> {
    fn ray(&self, pixel: usize) -> DVec3 {
        let width = self.view.image[0] as usize;
        let [x, y] = self.given.at;
        self.view.rays.direction((pixel % width) as f64 + x, (pixel / width) as f64 + y)
    }

    /// The neighbour of a pixel.
    fn beside(&self, pixel: usize, [dx, dy]: [i64; 2]) -> Option<usize> {
        let [w, h] = self.view.image.map(i64::from);
        let (x, y) = (pixel as i64 % w + dx, pixel as i64 / w + dy);
        (x >= 0 && y >= 0 && x < w && y < h).then_some((y * w + x) as usize)
    }

    fn place(&self, pixel: usize) -> Found {
        let point = match self.given.places {
            PositionSource::Depths { values, terms, nothing } => {
                let value = values[pixel];
                if value == nothing {
                    return Err(PixelContent::Nothing);
                }
                let ([a, b, c, d], v) = (terms.map(f64::from), f64::from(value));
                self.ray(pixel) * ((b - v * d) / (v * c - a)) * self.view.scale
            }
            PositionSource::Positions(texels) => {
                let [x, y, z, alpha] = texels[pixel];
                if alpha == 0.0 {
                    return Err(PixelContent::Nothing);
                }
                if !alpha.is_finite() {
                    return Err(PixelContent::Unusable);
                }
                self.view.point([x, y, z])
            }
        };
        let usable = point.is_finite() && point.dot(self.view.rays.forward) > 0.0;
        if usable && point.abs().max_element() < FARTHEST { Ok(point) } else { Err(PixelContent::Unusable) }
    }

    fn pixel(&self, pixel: usize) -> ReceiverPixel {
        let sure = |shown| ReceiverPixel { shown, open: false };
        if let Some((ids, first, none, numbers)) = self.given.ids
            && ids[pixel] != none
        {
            let named = ids[pixel].checked_sub(first).and_then(|n| numbers.get(n as usize));
            return sure(named.map_or(PixelContent::Unknown, |&t| PixelContent::Caster(t)));
        }
        let point = match self.place(pixel) {
            Ok(point) => point,
            Err(shown) => return sure(shown),
        };
        let mut open = false;
        if self.given.ids.is_none() {
            let (caster, doubt) = self.caster(pixel, point);
            open = doubt;
            if let Some(t) = caster {
                return ReceiverPixel { shown: PixelContent::Caster(t), open };
            }
        }
        let (normal, doubt) = match self.given.normals {
            Some(normals) => {
                let [x, y, z, _] = normals[pixel].map(f64::from);
                (DVec3::new(x, y, z), 1e-6)
            }
            None => self.normal(pixel, point),
        };
        if !normal.is_finite() || normal == DVec3::ZERO {
            return ReceiverPixel { shown: PixelContent::Unusable, open };
        }
        let point = self.view.eye + point / self.view.scale;
        ReceiverPixel { shown: PixelContent::Plane { point, normal, doubt }, open }
    }

    /// Whether a point is on triangle `t` and, seen from the eye, in it, give or take `reach` pixels; and whether that is open.
    fn shows(&self, t: u32, point: DVec3, ray: DVec3, reach: f64) -> (bool, bool) {
        let Some([a, b, c]) = self.corners[t as usize] else { return (false, false) };
        let normal = (b - a).cross(c - a);
        let off = (normal.dot(point - a) / normal.length()).abs() / point.dot(self.view.rays.forward);
        let size = [a, b, c, point].map(|p| p.abs().max_element()).into_iter().fold(0.0, f64::max);
        let tilt = (b - a).length() * (c - a).length() / normal.length();
        let mut open = (off - self.given.tolerance).abs() < 1e-6 * (1.0 + tilt) * (1.0 + size);
        let (mut ahead, mut behind) = (f64::INFINITY, f64::INFINITY);
        for [u, v] in [[a, b], [b, c], [c, a]] {
            let m = u.cross(v);
            let slope = m.dot(self.view.rays.step_x).abs() + m.dot(self.view.rays.step_y).abs();
            ahead = ahead.min(m.dot(ray) / slope);
            behind = behind.min(-m.dot(ray) / slope);
        }
        let inside = ahead.max(behind) + reach;
        open |= inside.abs() < 2e-3;
        open &= off < self.given.tolerance * 1.1 && inside > -0.1;
        // Of a normal that is not a number, neither.
        (off <= self.given.tolerance && inside >= 0.0, open)
    }

    /// Whether a ray is in a triangle ahead of the eye, or at most four times [`NEAR_EDGE`] away.
    fn is_near(&self, t: u32, ray: DVec3) -> bool {
        let Some(corners) = self.corners[t as usize] else { return false };
        let rays = &self.view.rays;
        let depths = corners.map(|p| p.dot(rays.forward));
        if depths.iter().any(|&depth| depth <= 0.0) {
            return false;
        }
        // In pixels, from the ray.
        let across = |p: DVec3, step: DVec3| (p - ray).dot(step) / step.length_squared();
        let [a, b, c] = [0, 1, 2].map(|k| {
            let p = corners[k] / depths[k];
            DVec2::new(across(p, rays.step_x), across(p, rays.step_y))
        });
        let apart = |p: DVec2, q: DVec2| {
            let along = (-p).dot(q - p) / (q - p).length_squared().max(1e-30);
            (p + (q - p) * along.clamp(0.0, 1.0)).length()
        };
        let turns = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
        let inside = turns.iter().all(|&v| v >= 0.0) || turns.iter().all(|&v| v <= 0.0);
        inside || apart(a, b).min(apart(b, c)).min(apart(c, a)) < 4.0 * NEAR_EDGE
    }

    /// The caster on which a surface lies: that at the pixel's centre, else the lowest; and whether that is open.
    fn caster(&self, pixel: usize, point: DVec3) -> (Option<u32>, bool) {
        let mut open = false;
        let own = self.seen[pixel].map(|t| (t, 1.0));
        for (t, reach) in own.into_iter().chain((0..self.corners.len() as u32).map(|t| (t, NEAR_EDGE))) {
            let (shows, doubt) = self.shows(t, point, self.ray(pixel), reach);
            open |= doubt;
            if shows {
                // Beyond the tip of a sliver it goes by the blocks that are looked at.
                open |= reach == NEAR_EDGE && !self.is_near(t, self.ray(pixel));
                return (Some(t), open);
            }
        }
        (None, open)
    }

    /// Whether a pixel shows a caster; and whether that is open.
    fn is_caster(&self, pixel: usize, point: DVec3) -> (bool, bool) {
        match self.given.ids {
            Some((ids, _, none, _)) => (ids[pixel] != none, false),
            None => {
                let (caster, open) = self.caster(pixel, point);
                (caster.is_some(), open)
            }
        }
    }

    /// The normal by neighbours, and how far off it may be with `f32`.
    fn normal(&self, pixel: usize, point: DVec3) -> (DVec3, f64) {
        let depth = |p: DVec3| p.dot(self.view.rays.forward);
        let step = |by: [i64; 2]| {
            let mut open = false;
            for d in 1..=MOST_STEPS {
                let mut to = |d: i64| {
                    let q = self.beside(pixel, by.map(|v| v * d))?;
                    let at = self.place(q).ok()?;
                    let (is_caster, doubt) = self.is_caster(q, at);
                    open |= doubt;
                    (!is_caster).then_some(at - point)
                };
                match (to(d), to(-d)) {
                    (Some(q), Some(r)) => {
                        let (near, far) = (depth(q).abs().min(depth(r).abs()), depth(q).abs().max(depth(r).abs()));
                        open |= far - near < 1e-5 * depth(point);
                        return Some((if depth(q).abs() <= depth(r).abs() { q } else { -r }, open));
                    }
                    (None, None) => {}
                    (q, r) => return q.or(r.map(|r| -r)).map(|q| (q, open)),
                }
            }
            None
        };
        let (Some((a, open_a)), Some((b, open_b))) = (step([1, 0]), step([0, 1])) else {
            return (self.ray(pixel), 1e-5);
        };
        let normal = a.normalize().cross(b.normalize());
        let relative = 2e-6 * (point.length() + 1.0) * (1.0 / a.length() + 1.0 / b.length());
        (normal, if open_a || open_b { f64::INFINITY } else { relative / normal.length() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Lens, Light};

    #[test]
    fn a_caster_a_plane_beside_it_and_what_is_neither() {
        let camera = Camera {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 90.0,
            near: 0.1,
            far: 10.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let bounds = (DVec3::NEG_ONE, DVec3::ONE);
        let map = LightView::around(bounds, &light, 8).expect("a view");
        let view = View::new(&camera, &light, &map, bounds, [4, 1], false);
        let wall = [[-9.0, -9.0, -2.0], [9.0, -9.0, -2.0], [0.0, 9.0, -2.0]].map(|p| Some(view.point(p)));
        let corners = [wall[0].and_then(|a| Some([a, wall[1]?, wall[2]?]))];
        let nan = f32::NAN;
        let values = [2.0, 4.0, 0.0, nan];
        // Depth as it is, nothing at 0.
        let places = PositionSource::Depths { values: &values, terms: [1.0, 0.0, 0.0, 1.0], nothing: 0.0 };
        let given = GbufferTexels { places, normals: None, ids: None, tolerance: 1e-4, at: [0.5; 2] };
        let got = pixels(&view, &corners, &[Some(0); 4], &given);
        assert_eq!(
            (got[0].shown, got[2].shown, got[3].shown),
            (PixelContent::Caster(0), PixelContent::Nothing, PixelContent::Unusable)
        );
        let PixelContent::Plane { point, .. } = got[1].shown else { panic!("{:?}", got[1]) };
        assert!((point.z + 4.0).abs() < 1e-12, "{point}");
        let ids = Some((&[5u32, 7, 6, 9][..], 5, 9, &[0u32][..]));
        let got = pixels(&view, &corners, &[None; 4], &GbufferTexels { ids, ..given });
        assert_eq!((got[0].shown, got[1].shown), (PixelContent::Caster(0), PixelContent::Unknown));
        assert_eq!((got[2].shown, got[3].shown), (PixelContent::Unknown, PixelContent::Unusable));
    }
}
