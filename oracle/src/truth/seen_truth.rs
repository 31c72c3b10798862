//! Seen truth: whether each sample was given the surface that it sees.
//!
//! Facet truth takes the facet it is given, and scene truth asks for light alone: neither notices a sample that was put on another
//! surface of the same light. Here every sample's ray is sent to the nearest triangle in `f64`, and held against the triangle it was
//! given. The given one is *right* if it is the nearest, or if its plane meets the ray where the nearest does, within the `f64` error
//! bounds: triangles of one plane may stand for each other.
//!
//! **Ties.** Else the sample is *tied*, and either answer may stand, if
//! - the two planes lie so near to each other along the ray that kernels, which have 46 bits, may take them for equal ([`NEARLY_EQUAL`]);
//! - a ray within [`AMBIGUITY`] of a pixel sees the given surface (or nothing, if nothing was given): at one of eight places around the
//!   sample, straight across an edge of what is seen (for nothing), or where the given triangle comes into the square of these; or does not see it there because the plane of another crosses
//!   its own within the square;
//! - the surface that is seen, or that hides the given one as near, ends within [`AMBIGUITY`], and what is seen beyond does not share its edge:
//!   rounding may take the sample off it, to what lies behind; to nothing, if what is seen beyond ends there, too;
//! - or any of these holds for another triangle of the given one's plane: facets of several name one of them;
//! - the given triangle is there within [`AMBIGUITY`] of a pixel, and its plane is seen edge-on within that: it may be at any depth.
//!
//! All other samples that were not given the nearest surface are *wrong*.

use super::beam::Beam;
use super::packet::{Seen, see};
use super::predicate::Plane;
use super::rays::{EDGES, canonical};
use super::{AMBIGUITY, DETERMINANT_ERROR, Tracer, bits};
use glam::{DVec2, DVec3};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, PixelRays};
use subpixel_shadows::{Error, Result};

/// Planes whose distances along a ray differ by no more than this share of what the distances are made of are tied: four times what
/// kernels take for nothing.
pub const NEARLY_EQUAL: f64 = 1.0 / (1u64 << 36) as f64;
/// Share of the near distance within which single precision may take a surface to be nearer or farther.
const NEAR_ROUNDING: f64 = 1.0 / (1u64 << 20) as f64;

/// Share of a distance behind which something else lies: above the `f64` error.
const BEHIND: f64 = 1e-12;

/// How the samples of a pixel compare with what they see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeenResult {
    /// Samples that were given another surface than they see.
    pub wrong: u128,
    /// Samples that were given another one, of which either may stand.
    pub tied: u128,
    /// Samples that were given another one that lies, within the `f64` error bounds, where the nearest does: right, but what the two
    /// see of the light may differ.
    pub stand_in: u128,
}

/// Says what the samples of a view see.
#[derive(Clone, Debug)]
pub struct SeenTruth<'a> {
    tracer: &'a Tracer,
    rays: PixelRays,
    offsets: Vec<DVec2>,
    width: u32,
}

impl<'a> SeenTruth<'a> {
    /// The truth of `tracer`'s mesh seen by `camera`, for an image of `width` × `height` pixels.
    ///
    /// # Errors
    /// [`Error::Scene`] if the camera cannot be used, [`Error::Config`] if the image has no pixels.
    pub fn new(tracer: &'a Tracer, camera: &Camera, samples: &Samples, width: u32, height: u32) -> Result<Self> {
        camera.check()?;
        if width == 0 || height == 0 {
            return Err(Error::Config(format!("an image of {width} x {height} pixels")));
        }
        let offsets = samples.offsets().iter().map(|o| DVec2::new(f64::from(o[0]), f64::from(o[1]))).collect();
        Ok(Self { tracer, rays: camera.rays(width, height), offsets, width })
    }

    /// Holds the samples `asked` of a pixel against what they see. `given` tells the triangle that a sample was given; `None` for
    /// nothing. It must be below [`Tracer::triangle_count`].
    pub fn judge(&self, pixel: u32, asked: u128, given: impl Fn(usize) -> Option<u32>) -> SeenResult {
        let corner = DVec2::new(f64::from(pixel % self.width), f64::from(pixel / self.width));
        // Samples behind the last that is asked for are not traced.
        let offsets = &self.offsets[..self.offsets.len().min(128 - asked.leading_zeros() as usize)];
        let seen = self.see(corner, offsets);
        let other = |k: usize| match given(k) {
            Some(t) => !self.is_met(&seen, k, t),
            None => seen.seen >> k & 1 != 0,
        };
        let mut left = bits(asked).filter(|&k| k < offsets.len() && other(k)).fold(0u128, |mask, k| mask | 1 << k);
        let off = left;
        let stand_in =
            bits(asked & !off & seen.seen).filter(|&k| k < offsets.len() && given(k) != Some(seen.triangle[k]));
        let stand_in = stand_in.fold(0, |mask, k| mask | 1 << k);
        if off == 0 {
            return SeenResult { stand_in, ..SeenResult::default() };
        }
        left &= !seen.touching;
        left = bits(left).filter(|&k| !self.is_tie(&seen, k, given(k))).fold(0, |mask, k| mask | 1 << k);
        for x in [-AMBIGUITY, 0.0, AMBIGUITY] {
            for y in [-AMBIGUITY, 0.0, AMBIGUITY] {
                if left == 0 || (x == 0.0 && y == 0.0) {
                    continue;
                }
                let around = self.see(corner + DVec2::new(x, y), offsets);
                let agrees = |k: usize| match given(k) {
                    Some(t) => self.is_met(&around, k, t),
                    None => around.seen >> k & 1 == 0,
                };
                left = bits(left).filter(|&k| !agrees(k)).fold(0, |mask, k| mask | 1 << k);
            }
        }
        let is_near = |k: usize| match given(k) {
            Some(t) => {
                let at = corner + self.offsets[k];
                let is_behind = || self.is_next(seen.rays[k], seen.depth[k] + 2.0 * seen.error[k], t);
                let is_seen = seen.seen >> k & 1 != 0;
                self.is_seen_near(at, t)
                    || (is_seen && self.ends_near(at, seen.triangle[k], false) && is_behind())
                    || self.is_surface_near(at, t)
            }
            None => self.ends_near(corner + self.offsets[k], seen.triangle[k], true),
        };
        left = bits(left).filter(|&k| !is_near(k)).fold(0, |mask, k| mask | 1 << k);
        SeenResult { wrong: left, tied: off & !left, stand_in }
    }

    fn see(&self, corner: DVec2, offsets: &[DVec2]) -> Seen {
        see(self.tracer, &self.rays, corner, offsets)
    }

    fn plane(&self, triangle: u32) -> Plane {
        Plane::new(self.tracer.corners(triangle).map(|p| p - self.rays.eye))
    }

    /// Whether sample `k` sees triangle `t`, or its plane at the same place.
    fn is_met(&self, seen: &Seen, k: usize, t: u32) -> bool {
        if seen.triangle[k] == t {
            return true;
        }
        if seen.seen >> k & 1 == 0 {
            return false;
        }
        let (plane, ray) = (self.plane(t), seen.rays[k]);
        let along = plane.normal.dot(ray);
        let along_error = DETERMINANT_ERROR * plane.size * ray.length();
        let depth = plane.distance / along;
        let error = 2.0 * (DETERMINANT_ERROR * plane.size * plane.reach + depth.abs() * along_error) / along.abs();
        along.abs() > along_error && (depth - seen.depth[k]).abs() <= error + seen.error[k]
    }

    /// Whether what sample `k` sees and what it was given are too near to each other, or to the near distance, to tell.
    fn is_tie(&self, seen: &Seen, k: usize, given: Option<u32>) -> bool {
        let ray = seen.rays[k];
        let near = self.rays.begin(ray);
        let is_near = |p: &Plane| {
            let along = p.normal.dot(ray);
            let made_of = p.size * (p.reach + near * ray.length());
            near.is_finite()
                && (p.distance - near * along).abs() <= NEAR_ROUNDING * (near * along).abs() + NEARLY_EQUAL * made_of
        };
        let own = (seen.seen >> k & 1 != 0).then(|| self.plane(seen.triangle[k]));
        let theirs = given.map(|t| self.plane(t));
        if own.as_ref().is_some_and(is_near) || theirs.as_ref().is_some_and(is_near) {
            return true;
        }
        let (Some(p), Some(q)) = (own, theirs) else { return false };
        let (over, under) = (p.normal.dot(ray), q.normal.dot(ray));
        let made_of = |plane: &Plane, other: f64| plane.size * plane.reach * other.abs();
        (p.distance * under - q.distance * over).abs() <= NEARLY_EQUAL * (made_of(&p, under) + made_of(&q, over))
    }

    /// Whether triangle `t` is seen anywhere in the square of half-width [`AMBIGUITY`] around a place of the image: where the square
    /// is cut by the triangle's edges, at the corners of what is left and in its middle; or is there and seen edge-on.
    fn is_seen_near(&self, at: DVec2, t: u32) -> bool {
        let plane = self.plane(t);
        let ray = self.rays.direction(at.x, at.y);
        let (x, y) = (self.rays.step_x * AMBIGUITY, self.rays.step_y * AMBIGUITY);
        let edge_on = plane.normal.dot(ray).abs() <= plane.normal.dot(x).abs() + plane.normal.dot(y).abs();
        if edge_on {
            return [1.0, -1.0].into_iter().any(|turn| !self.within(&plane, turn, [ray, x, y]).is_empty());
        }
        let polygon = self.within(&plane, if plane.distance > 0.0 { 1.0 } else { -1.0 }, [ray, x, y]);
        if polygon.is_empty() {
            return false;
        }
        let middle = polygon.iter().sum::<DVec3>() / polygon.len() as f64;
        let sees = |r: DVec3| {
            let Some(hit) = self.tracer.closest(self.rays.eye, r, self.rays.begin(r)) else { return false };
            // Or the two cross within the square: at a fold the one behind is nowhere seen beside the common edge.
            let other = self.plane(hit.triangle);
            let apart = |r: DVec3| plane.distance / plane.normal.dot(r) - other.distance / other.normal.dot(r);
            let here = apart(r);
            if hit.triangle == t || here.abs() <= (apart(r + x) - here).abs() + (apart(r + y) - here).abs() {
                return true;
            }
            // Or what hides it there ends within the square, as it does.
            let off = [self.rays.step_x, self.rays.step_y].map(|step| (r - ray).dot(step) / step.length_squared());
            self.ends_near(at + DVec2::from(off), hit.triangle, false) && self.is_next(r, hit.t * (1.0 + BEHIND), t)
        };
        sees(middle) || polygon.iter().any(|&p| sees(middle + (p - middle) * 0.999))
    }

    /// Whether another triangle of the plane of `t` is seen as near: `t` may stand for a surface of several.
    fn is_surface_near(&self, at: DVec2, t: u32) -> bool {
        let (plane, ray) = (self.plane(t), self.rays.direction(at.x, at.y));
        let reach = (self.rays.step_x.abs() + self.rays.step_y.abs()) * AMBIGUITY;
        let beam = Beam::pencil(self.rays.eye, ray - reach, ray + reach, self.rays.near, f64::INFINITY);
        let mut found = false;
        let is_on = |p: DVec3| plane.height(p) == 0.0;
        self.tracer.visit_beam(&beam, &mut |other| {
            found |= !found
                && other != t
                && self.plane(other).corners.into_iter().all(is_on)
                && self.is_seen_near(at, other);
        });
        found
    }

    /// Whether triangle `t` is the first that a ray meets behind a distance.
    fn is_next(&self, ray: DVec3, behind: f64, t: u32) -> bool {
        self.tracer.closest(self.rays.eye, ray, behind).is_some_and(|hit| hit.triangle == t)
    }

    /// Whether rounding may take a place of the image where triangle `t` is seen off that: within [`AMBIGUITY`] of it, straight across one
    /// of the triangle's edges, nothing is seen, or a triangle that does not share the edge; with `gap` one that ends within that, too, so that
    /// rounding may take the place off both.
    fn ends_near(&self, at: DVec2, t: u32, gap: bool) -> bool {
        let corners = self.plane(t).corners;
        EDGES.into_iter().any(|(i, j)| {
            let across = self.to_line(at, corners[i], corners[j]) * 1.01;
            if across.length() > AMBIGUITY {
                return false;
            }
            let beyond = self.rays.direction(at.x + across.x, at.y + across.y);
            let Some(hit) = self.tracer.closest(self.rays.eye, beyond, self.rays.begin(beyond)) else { return true };
            let other = self.plane(hit.triangle).corners;
            let is_shared = other.contains(&corners[i]) && other.contains(&corners[j]);
            let ends = |(i, j): (usize, usize)| self.to_line(at, other[i], other[j]).length() <= AMBIGUITY;
            !is_shared && (!gap || EDGES.into_iter().any(ends))
        })
    }

    /// From a place of the image straight to the line through two points, in pixels.
    fn to_line(&self, at: DVec2, p: DVec3, q: DVec3) -> DVec2 {
        let normal = p.cross(q - p);
        let slope = DVec2::new(normal.dot(self.rays.step_x), normal.dot(self.rays.step_y));
        slope * (-normal.dot(self.rays.direction(at.x, at.y)) / slope.length_squared())
    }

    /// The part of the square around a ray inside the triangle's edges, as a polygon of rays; `turn`: 1 if it turns away from the eye.
    fn within(&self, plane: &Plane, turn: f64, [ray, x, y]: [DVec3; 3]) -> Vec<DVec3> {
        let mut polygon = vec![ray - x - y, ray + x - y, ray + x + y, ray - x + y];
        for (i, j) in EDGES {
            let (lo, hi, flip) = canonical(plane.corners[i], plane.corners[j]);
            let normal = lo.cross(hi - lo) * (flip * turn);
            let mut left = Vec::with_capacity(8);
            for (k, &p) in polygon.iter().enumerate() {
                let q = polygon[(k + 1) % polygon.len()];
                let (at, next) = (normal.dot(p), normal.dot(q));
                if at >= 0.0 {
                    left.push(p);
                }
                if (at < 0.0) != (next < 0.0) {
                    left.push(p + (q - p) * (at / (at - next)));
                }
            }
            polygon = left;
        }
        polygon
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::samples::Pattern;
    use subpixel_shadows::scene::{Lens, Mesh};

    const CAMERA: Camera = Camera {
        eye: [0.0, 0.0, 5.0],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 40.0,
        near: 0.1,
        far: 100.0,
        lens: Lens::CENTRED,
        near_plane: None,
    };

    /// Two sheets that face the eye, `gap` apart at x = 0 and `gap + tilt` at x = 1, the nearer one ending at x = 0.5.
    fn sheets(gap: f32, tilt: f32) -> Mesh {
        let z = |x: f32| gap + x * tilt;
        Mesh {
            positions: vec![
                [-9.0, -9.0, 0.0],
                [9.0, -9.0, 0.0],
                [0.0, 9.0, 0.0],
                [0.5, -9.0, z(0.5)],
                [0.5, 9.0, z(0.5)],
                [-9.0, 0.0, z(-9.0)],
            ],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
        }
    }

    /// Wrong and tied samples of the middle row, if each was given `t`.
    fn given(mesh: &Mesh, t: Option<u32>) -> (u32, u32) {
        let tracer = Tracer::new(mesh).unwrap();
        let samples = Samples::new(Pattern::default(), 8).unwrap();
        let truth = SeenTruth::new(&tracer, &CAMERA, &samples, 32, 32).unwrap();
        let results = (16 * 32 + 12..16 * 32 + 20).map(|pixel| truth.judge(pixel, 0xff, |_| t));
        results.fold((0, 0), |(wrong, tied), r| (wrong + r.wrong.count_ones(), tied + r.tied.count_ones()))
    }

    #[test]
    fn what_lies_behind_is_wrong_and_what_is_in_front_right() {
        // The edge at x = 0.5 lies 4.4 pixels right of the middle, beyond these pixels.
        let mesh = sheets(0.01, 0.0);
        assert_eq!(given(&mesh, Some(1)), (0, 0));
        assert_eq!(given(&mesh, Some(0)), (64, 0));
        assert_eq!(given(&mesh, None), (64, 0));
        let nothing = Mesh { triangles: vec![[0, 1, 2]], ..sheets(0.01, 0.0) };
        assert_eq!(given(&nothing, Some(0)), (0, 0));
    }

    #[test]
    fn planes_that_cannot_be_told_apart_are_tied() {
        // 2^-40 apart, at a distance of 5: below what 46 bits tell, and above the error of f64.
        assert_eq!(given(&sheets(2f32.powi(-40), 0.0), Some(0)), (0, 64));
        // 2^-24 apart they can be told.
        assert_eq!(given(&sheets(2f32.powi(-24), 0.0), Some(0)), (64, 0));
        // One plane: each stands for the other.
        assert_eq!(given(&sheets(0.0, 0.0), Some(0)), (0, 0));
        assert_eq!(given(&sheets(0.0, 0.0), Some(1)), (0, 0));
    }

    /// Whether a sample so many bands right of the image's middle, which sees another surface than it was given, is tied; else it is wrong.
    fn is_tied(mesh: &Mesh, given: Option<u32>, bands: f64) -> bool {
        let tracer = Tracer::new(mesh).unwrap();
        let samples = Samples::new(Pattern::default(), 1).unwrap();
        let truth = SeenTruth::new(&tracer, &CAMERA, &samples, 32, 32).unwrap();
        let at = 16.0 + bands * AMBIGUITY;
        let moved = SeenTruth { offsets: vec![DVec2::new(at - at.floor(), 0.5)], ..truth };
        let result = moved.judge(16 * 32 + at.floor() as u32, 1, |_| given);
        assert_eq!(result.wrong + result.tied, 1, "{bands} bands");
        result.tied == 1
    }

    #[test]
    fn a_gap_narrower_than_the_band_is_a_tie() {
        // Two sheets, 0.00005 apart at x = 0: a ninth of the band of 0.00044.
        let mesh = Mesh {
            positions: vec![
                [0.0, -9.0, 0.0],
                [0.0, 9.0, 0.0],
                [9.0, 0.0, 0.0],
                [-5e-5, 9.0, 0.0],
                [-5e-5, -9.0, 0.0],
                [-9.0, 0.0, 0.0],
            ],
            triangles: vec![[0, 2, 1], [3, 5, 4]],
        };
        assert_eq!([-3.0, -0.5, 0.5, 3.0].map(|bands| is_tied(&mesh, None, bands)), [false, true, true, false]);
    }

    #[test]
    fn what_lies_behind_a_gap_is_a_tie_and_behind_a_shared_edge_is_not() {
        // Two sheets that meet at x = 0, by edges of their own or by one of both, before a wall.
        let mesh = |shared: bool| Mesh {
            positions: vec![
                [0.0, -9.0, 0.0],
                [0.0, 9.0, 0.0],
                [9.0, 0.0, 0.0],
                [0.0, 9.5, 0.0],
                [0.0, -9.5, 0.0],
                [-9.0, 0.0, 0.0],
                [-9.0, -9.0, -1.0],
                [9.0, -9.0, -1.0],
                [0.0, 18.0, -1.0],
            ],
            triangles: vec![[0, 2, 1], if shared { [1, 5, 0] } else { [3, 5, 4] }, [6, 7, 8]],
        };
        let tied = |shared| [-3.0, -0.5, 0.5, 3.0].map(|bands| is_tied(&mesh(shared), Some(2), bands));
        assert_eq!((tied(false), tied(true)), ([false, true, true, false], [false; 4]));
    }

    #[test]
    fn what_ends_with_what_hides_it_is_a_tie_at_that_end_alone() {
        // Two sheets that end at x = 0, as the eye sees them, one behind the other, or the farther one at x = -1.
        let mesh = |end: f32| Mesh {
            positions: vec![
                [0.0, -9.0, 0.0],
                [0.0, 9.0, 0.0],
                [-9.0, 0.0, 0.0],
                [end, -9.0, -1.0],
                [end, 9.0, -1.0],
                [-9.0, 0.0, -1.0],
            ],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
        };
        let tied = |end| [-3.0, -0.5, 0.5, 3.0].map(|bands| is_tied(&mesh(end), Some(1), bands));
        assert_eq!((tied(0.0), tied(-1.0)), ([false, true, true, false], [false; 4]));
    }

    #[test]
    fn behind_a_fold_is_a_tie_at_the_fold_alone() {
        // Two sheets from one edge at x = 0 to the right, the second ever farther behind the first.
        let mesh = Mesh {
            positions: vec![[0.0, -9.0, 0.0], [0.0, 9.0, 0.0], [9.0, 0.0, 0.0], [9.0, 0.0, -1.0]],
            triangles: vec![[0, 2, 1], [0, 3, 1]],
        };
        assert_eq!([-2.0, -0.5, 0.5, 3.0].map(|bands| is_tied(&mesh, Some(1), bands)), [false, true, true, false]);
    }

    #[test]
    fn an_edge_within_the_band_is_a_tie() {
        let mesh = sheets(0.01, 0.0);
        let tracer = Tracer::new(&mesh).unwrap();
        let samples = Samples::new(Pattern::default(), 1).unwrap();
        let truth = SeenTruth::new(&tracer, &CAMERA, &samples, 32, 32).unwrap();
        // The place of the image at which the edge is seen, from the middle of a pixel.
        let rays = CAMERA.rays(32, 32);
        let x_of = |x: f64| x / (5.0 - 0.01) / (rays.step_x.length() / rays.direction(16.0, 16.0).length()) + 16.0;
        let edge = x_of(0.5);
        for (off, tied) in [(0.5 * AMBIGUITY, true), (2.0 * AMBIGUITY, false)] {
            // Just inside the nearer sheet, given the other; just outside, given the nearer one.
            for (at, t) in [(edge - off, 0), (edge + off, 1)] {
                let moved = SeenTruth { offsets: vec![DVec2::new(at - at.floor(), 0.5)], ..truth.clone() };
                let result = moved.judge(16 * 32 + at.floor() as u32, 1, |_| Some(t));
                let want = SeenResult { wrong: u128::from(!tied), tied: u128::from(tied), stand_in: 0 };
                assert_eq!(result, want, "{off} pixels off, given {t}");
            }
        }
    }
}
