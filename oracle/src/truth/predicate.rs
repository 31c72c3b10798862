//! Which part of a facet a triangle shadows, as four lines of the image.
//!
//! With the eye at the origin, a pixel ray `r` meets the facet plane `n_f·p = d_f` at `p = r·d_f / (n_f·r)`. A boundary
//! plane `N·p = c` of the triangle's shadow volume is then on the side `sign(N·p − c) = sign(l·r)·sign(d_f)` with
//! `l = d_f·N − c·n_f`: a line of the image, linear in the sample position. No division, no point behind the eye to
//! treat apart, none of the cases of Pan 2009, figure 6.
//!
//! The shadow volume of a triangle has four planes: through the light and each edge, and the triangle's own. The
//! triangle shadows the points strictly beyond its own plane and inside or on the three others.

use super::rays::{EDGES, canonical, normal_of};
use super::{AMBIGUITY, DETERMINANT_ERROR, LightSide, light_side};
use glam::{DVec3, DVec4};
use subpixel_shadows::scene::PixelRays;

/// Heights up to this share of the distance over which they are measured count as 0.
const FLAT: f64 = 1.0 / (1u64 << 40) as f64;
/// Up to this share a height above 0 may also count as 0: kernels, which have 46 bits, take 2^-38 for nothing.
const NEARLY_FLAT: f64 = 16.0 * FLAT;

/// A plane relative to the eye: points `p` with `normal·p = distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Normal, any length.
    pub normal: DVec3,
    /// `normal·p` of its points.
    pub distance: f64,
    /// Length that the error of `normal` is relative to.
    pub size: f64,
    /// Length that the error of `distance` is relative to, times `size`.
    pub reach: f64,
    /// The corners it was made of, relative to the eye.
    pub corners: [DVec3; 3],
}

impl Plane {
    /// The plane of a triangle given relative to the eye; a triangle of no area gives a normal of 0.
    pub fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let (normal, size) = normal_of(a, b, c);
        Self { normal, distance: normal.dot(a), size, reach: a.length(), corners }
    }

    /// Height of a point above the plane times the length of the normal: exactly 0 for a corner, and 0 if it lies
    /// within 2^-40 of the distance to the corner it is measured from.
    pub fn height(&self, point: DVec3) -> f64 {
        if self.corners.contains(&point) {
            return 0.0;
        }
        let from = point - self.corners[0];
        let height = self.normal.dot(from);
        if height.abs() <= FLAT * self.normal.length() * from.length() { 0.0 } else { height }
    }

    /// Whether a point, which is none of the corners, lies so near to the plane that kernels may take its height for 0: within 2^-36
    /// of the distance to the corner it is measured from.
    pub fn is_nearly_on(&self, point: DVec3) -> bool {
        let from = point - self.corners[0];
        self.normal.dot(from).abs() <= NEARLY_FLAT * self.normal.length() * from.length()
    }

    /// The side of the homogeneous `light` (relative to the eye): 1, -1, or 0 if it lies in the plane, within 2^-40 of the sizes of
    /// edges and direction.
    pub fn side_of_light(&self, light: DVec4) -> f64 {
        self.light_side(light).sign
    }

    /// Whether kernels may take the light to be in the plane where [`Plane::side_of_light`] does not, or the other way round.
    pub fn is_light_open(&self, light: DVec4) -> bool {
        self.light_side(light).open
    }

    fn light_side(&self, light: DVec4) -> LightSide {
        let [a, b, c] = self.corners;
        light_side(b - a, c - a, light.truncate() - a * light.w)
    }

    /// Whether the eye lies in the plane, or so near to it that kernels may take it to: by the rule for lights (2^-40).
    pub fn is_eye_open(&self) -> bool {
        let [a, b, c] = self.corners;
        let side = light_side(b - a, c - a, -a);
        side.sign == 0.0 || side.open || self.side_of_eye() == 0.0
    }

    /// The side of the eye: 1, -1, or 0 within the error bound.
    pub fn side_of_eye(&self) -> f64 {
        sign(-self.distance, DETERMINANT_ERROR * self.size * self.reach)
    }
}

fn sign(value: f64, bound: f64) -> f64 {
    if value > bound {
        1.0
    } else if value < -bound {
        -1.0
    } else {
        0.0
    }
}

/// A line of the image: `value(r) = line·r`, positive on the inner side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Coefficients over ray directions.
    pub line: DVec3,
    /// Error bound of `line·r`, relative to the length of `r`.
    pub error: f64,
    /// Change of `line·r` over [`AMBIGUITY`] pixels across the line.
    pub margin: f64,
}

/// A facet's plane, and how far from its first corner points of it are asked for: lines are as exact as that is near, however far the eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetPlane<'a> {
    /// The plane.
    pub plane: &'a Plane,
    /// The distance; may be infinite.
    pub around: f64,
}

impl Line {
    /// The line where the plane through `point` with a normal `N` (its error relative to `size`) cuts the facet's plane, `orientation` towards
    /// the side where `N·p` is larger.
    ///
    /// With the facet's `n·p = d`, `N = k·n + t` and the height `h = n·(point − corner)` it is `d·t − (t·point + k·h)·n`: where the two planes
    /// nearly coincide `t` is small, and with it what is lost to their distance from the eye.
    fn new(ground: FacetPlane, normal: DVec3, point: DVec3, size: f64, orientation: f64, rays: &PixelRays) -> Self {
        let facet = ground.plane;
        let along = normal.dot(facet.normal) / facet.normal.length_squared();
        // A facet of no area has no lines.
        let along = if along.is_finite() { along } else { 0.0 };
        let rest = normal - facet.normal * along;
        let from = point - facet.corners[0];
        let height = facet.normal.dot(from);
        let line = rest * facet.distance - facet.normal * (rest.dot(point) + along * height);
        let line = line * (orientation * sign(facet.distance, 0.0));
        let reach = facet.reach + point.length();
        // By the points that are asked for, each error turns about a corner; by the eye, about the eye.
        let nearby = 2.0 * size * (ground.around + from.length()) + rest.length() * reach;
        let error = 2.0 * DETERMINANT_ERROR * facet.size * nearby.min(size * reach);
        let slope = line.dot(rays.step_x).hypot(line.dot(rays.step_y));
        Self { line, error, margin: AMBIGUITY * slope }
    }

    /// The rays nearest to `r` on either side of the line, twice its error off it; none if the line is farther than [`AMBIGUITY`].
    pub fn sides(&self, r: DVec3, rays: &PixelRays) -> Option<[DVec3; 2]> {
        let (value, doubt) = (self.line.dot(r), 2.0 * self.error * r.length());
        let (right, down) = (self.line.dot(rays.step_x), self.line.dot(rays.step_y));
        let slope = right * right + down * down;
        let side = |at: f64| r + (rays.step_x * right + rays.step_y * down) * ((at - value) / slope);
        (slope > 0.0 && value.abs() <= self.margin).then(|| [side(-doubt), side(doubt)])
    }

    /// The line where the plane of another triangle cuts the facet's, positive where that plane's normal points.
    pub fn of_plane(ground: FacetPlane, plane: &Plane, rays: &PixelRays) -> Self {
        Self::new(ground, plane.normal, plane.corners[0], plane.size, 1.0, rays)
    }
}

/// How sure it is that a sample lies in a shadow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Farther than the margin outside one of the lines.
    Out,
    /// Within the margin of a line; the flag is the answer.
    Near(bool),
    /// Farther than the margin inside all lines.
    In,
}

/// The shadow of one triangle on one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Three edges, then the triangle's own plane.
    pub lines: [Line; 4],
    /// The light lies in the triangle's plane within the error bound: it casts nothing, and only its own plane counts
    /// as a place of doubt.
    pub edge_on: bool,
}

impl Shadow {
    /// The shadow of the triangle `corners` on a facet from `light`, all relative to the eye.
    pub fn new(ground: FacetPlane, corners: [DVec3; 3], light: DVec4, rays: &PixelRays) -> Self {
        let caster = Plane::new(corners);
        let side = caster.side_of_light(light);
        // The light is on the side `side` of the triangle's plane; shadowed points on the other. The edge planes'
        // normals (b − a) × (L − w·a) are opposite to the triangle's: their inner side has the sign −side as well.
        let inner = -side;
        let own = Line::new(ground, caster.normal, caster.corners[0], caster.size, inner, rays);
        if side == 0.0 {
            let own = Line::of_plane(ground, &caster, rays);
            return Self { lines: [own; 4], edge_on: true };
        }
        let edge = |(i, j): (usize, usize)| {
            let (lo, hi, flip) = canonical(corners[i], corners[j]);
            let (along, to_light) = (hi - lo, light.truncate() - lo * light.w);
            let normal = along.cross(to_light);
            let size = along.length() * to_light.length();
            Line::new(ground, normal, lo, size, inner * flip, rays)
        };
        Self { lines: [edge(EDGES[0]), edge(EDGES[1]), edge(EDGES[2]), own], edge_on: false }
    }

    /// Whether the sample on ray `r`, which must meet the facet in front of the eye, is shadowed.
    pub fn covers(&self, r: DVec3) -> bool {
        if self.edge_on {
            return false;
        }
        let length = r.length();
        let [a, b, c, own] = &self.lines;
        [a, b, c].iter().all(|l| l.line.dot(r) >= -l.error * length) && own.line.dot(r) > own.error * length
    }

    /// Whether it is shadowed whatever the error.
    pub fn surely_covers(&self, r: DVec3) -> bool {
        let length = r.length();
        !self.edge_on && self.lines.iter().all(|l| l.line.dot(r) > l.error * length)
    }

    /// As [`Shadow::covers`], and how far from the lines.
    pub fn cover(&self, r: DVec3) -> Cover {
        let length = r.length();
        if self.edge_on {
            let own = &self.lines[3];
            let far = own.line.dot(r).abs() > own.margin + own.error * length;
            return if far { Cover::Out } else { Cover::Near(false) };
        }
        let mut sure = true;
        for l in &self.lines {
            let value = l.line.dot(r);
            let doubt = l.margin + l.error * length;
            if value < -doubt {
                return Cover::Out;
            }
            sure &= value > doubt;
        }
        if sure { Cover::In } else { Cover::Near(self.covers(r)) }
    }

    /// Whether the shadow comes into the square of half-width [`AMBIGUITY`] pixels around ray `r`: the square, clipped by
    /// each line in turn, is not empty. Unlike [`Shadow::cover`] it is not misled by the lines of a sharp tip, which run
    /// on beyond it. A triangle seen edge-on by the light counts by its line alone.
    pub fn comes_near(&self, r: DVec3, rays: &PixelRays) -> bool {
        if self.edge_on {
            return self.cover(r) != Cover::Out;
        }
        let (x, y) = (rays.step_x * AMBIGUITY, rays.step_y * AMBIGUITY);
        let mut polygon = vec![r - x - y, r + x - y, r + x + y, r - x + y];
        for l in &self.lines {
            let mut left = Vec::with_capacity(8);
            for (k, &p) in polygon.iter().enumerate() {
                let q = polygon[(k + 1) % polygon.len()];
                let value = |r: DVec3| l.line.dot(r) + l.error * r.length();
                let (at, next) = (value(p), value(q));
                if at >= 0.0 {
                    left.push(p);
                }
                if (at < 0.0) != (next < 0.0) {
                    left.push(p + (q - p) * (at / (at - next)));
                }
            }
            polygon = left;
        }
        !polygon.is_empty()
    }

    /// Whether some sample within `half_x` and `half_y` of ray `centre` (changes of direction) may lie in the shadow or
    /// its margin.
    pub fn may_reach(&self, centre: DVec3, half_x: DVec3, half_y: DVec3) -> bool {
        let length = centre.length() + half_x.length() + half_y.length();
        // The corners of the square that is probed around a sample are sqrt(2) margins away.
        let doubt = |l: &Line| 1.5 * l.margin + l.error * length + l.line.dot(half_x).abs() + l.line.dot(half_y).abs();
        if self.edge_on {
            let own = &self.lines[3];
            return own.line.dot(centre).abs() <= doubt(own);
        }
        self.lines.iter().all(|l| l.line.dot(centre) >= -doubt(l))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::scene::{Camera, Lens};

    /// A small generator, so that a failing case can be named by its number.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let x = (self.0 >> 33) ^ (self.0 >> 17);
            (x & 0x7fff_ffff) as f64 / f64::from(1u32 << 31) * 2.0 - 1.0
        }

        fn vector(&mut self, size: f64) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * size
        }
    }

    /// Points of it are asked for wherever they are.
    fn far(plane: &Plane) -> FacetPlane<'_> {
        FacetPlane { plane, around: f64::INFINITY }
    }

    fn rays() -> PixelRays {
        let camera = Camera {
            eye: [0.0; 3],
            target: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 60.0,
            near: 0.01,
            far: 100.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        camera.rays(64, 48)
    }

    /// The open segment from `p` to the light against a triangle, by solving for the point (Cramer's rule); `None`
    /// where the numbers are too near a tie to tell.
    fn brute(p: DVec3, light: DVec4, [a, b, c]: [DVec3; 3]) -> Option<bool> {
        let d = light.truncate() - p * light.w;
        let (u, v) = (b - a, c - a);
        let det = u.cross(v).dot(-d);
        let s = p - a;
        let beta = s.cross(v).dot(-d) / det;
        let gamma = u.cross(s).dot(-d) / det;
        let t = u.cross(v).dot(s) / det;
        let end = if light.w == 0.0 { 1.0 } else { 1.0 - t };
        let least = beta.min(gamma).min(1.0 - beta - gamma).min(t).min(end);
        if !least.is_finite() || least.abs() < 1e-7 { None } else { Some(least > 0.0) }
    }

    #[test]
    fn agrees_with_a_segment_against_a_triangle() {
        let rays = rays();
        let mut random = Random(7);
        let (mut tried, mut shadowed) = (0u32, 0u32);
        let mut case = 0u32;
        while tried < 200_000 {
            case += 1;
            // Facet, caster and light anywhere, also behind the eye.
            let facet = Plane::new([random.vector(5.0), random.vector(5.0), random.vector(5.0)]);
            let light = random.vector(6.0).extend(f64::from(case % 2));
            let r = rays.direction(random.unit() * 32.0 + 32.0, random.unit() * 24.0 + 24.0);
            let t = facet.distance / facet.normal.dot(r);
            if t <= 0.0 || !t.is_finite() {
                continue;
            }
            let mut at = random.vector(4.0);
            if case % 4 > 1 {
                // Half of them near the segment, so that many do shadow.
                at = at * 0.2 + r * t + (light.truncate() - r * t * light.w) * random.unit().abs();
            }
            let caster = [at + random.vector(3.0), at + random.vector(3.0), at + random.vector(3.0)];
            let Some(truth) = brute(r * t, light, caster) else { continue };
            let shadow = Shadow::new(far(&facet), caster, light, &rays);
            assert_eq!(shadow.covers(r), truth, "case {case}");
            tried += 1;
            shadowed += u32::from(truth);
        }
        assert!(shadowed > 20_000, "{shadowed} shadowed");
    }

    /// Triangles whose planes differ by 1e-8, four hundred times their size from the eye, and a light along them.
    #[test]
    fn nearly_one_plane_is_told_far_from_the_eye() {
        let mut random = Random(11);
        let eye = DVec3::new(2936.0, -7605.0, 6029.0);
        let rays = Camera {
            eye: [0.0; 3],
            target: eye.as_vec3().into(),
            up: [0.0, 1.0, 0.0],
            vertical_fov_degrees: 0.2,
            near: 1.0,
            far: 1e6,
            lens: Lens::CENTRED,
            near_plane: None,
        }
        .rays(64, 64);
        let flat = |random: &mut Random, tilt: f64| {
            let at = random.vector(20.0);
            eye + DVec3::new(at.x, tilt * (at.x - at.z), at.z)
        };
        let (mut told, mut shadowed, mut by_eye) = (0, 0, 0);
        for case in 0..4000 {
            let facet = Plane::new([0.0; 3].map(|_| flat(&mut random, 0.0)));
            let caster = [0.0; 3].map(|_| flat(&mut random, 1e-8));
            let light = DVec3::new(1.0, 1e-9 * f64::from(case % 7 + 1), random.unit()).extend(0.0);
            let p = flat(&mut random, 0.0);
            // Both by numbers about the place, of which all are small.
            let [near, from] = [caster.map(|c| c - eye), [p - eye; 3]];
            let Some(truth) = brute(from[0], light, near) else { continue };
            let ground = FacetPlane { plane: &facet, around: 60.0 };
            let r = p / p.dot(rays.forward);
            let shadow = Shadow::new(ground, caster, light, &rays);
            let length = r.length();
            if shadow.lines.iter().any(|l| l.line.dot(r).abs() <= l.margin + l.error * length) {
                continue;
            }
            assert_eq!(shadow.covers(r), truth, "case {case}");
            let far = Shadow::new(far(&facet), caster, light, &rays);
            by_eye += u32::from(far.lines.iter().any(|l| l.line.dot(r).abs() <= l.error * length));
            (told, shadowed) = (told + 1, shadowed + u32::from(truth));
        }
        assert!(
            told > 500 && shadowed > 50 && by_eye > 50,
            "{told} told, {shadowed} in shadow, {by_eye} not by the eye"
        );
    }

    #[test]
    fn the_comparison_notices_a_reversed_triangle_plane() {
        let rays = rays();
        let facet = Plane::new([DVec3::new(-5.0, -1.0, 0.0), DVec3::new(5.0, -1.0, 0.0), DVec3::new(0.0, -1.0, -9.0)]);
        let caster = [DVec3::new(-1.0, 0.0, -3.0), DVec3::new(1.0, 0.0, -3.0), DVec3::new(0.0, 0.0, -5.0)];
        let light = DVec4::new(0.0, 1.0, 0.0, 0.0);
        let r = DVec3::new(0.0, -1.0, -4.0);
        let mut shadow = Shadow::new(far(&facet), caster, light, &rays);
        assert!(shadow.covers(r));
        shadow.lines[3].line = -shadow.lines[3].line;
        assert!(!shadow.covers(r));
    }

    #[test]
    fn triangles_that_share_an_edge_leave_no_gap_and_margins_are_pixels() {
        let rays = rays();
        let facet = Plane::new([DVec3::new(-5.0, -1.0, 0.0), DVec3::new(5.0, -1.0, 0.0), DVec3::new(0.0, -1.0, -9.0)]);
        let [a, b, c, d] = [[-1.0, -3.0], [1.1, -3.3], [0.9, -5.7], [-1.3, -5.2]].map(|p| DVec3::new(p[0], 0.3, p[1]));
        for light in [DVec4::new(0.1, 1.0, 0.2, 0.0), DVec4::new(0.4, 3.0, -4.0, 1.0)] {
            let left = Shadow::new(far(&facet), [a, b, c], light, &rays);
            let right = Shadow::new(far(&facet), [a, c, d], light, &rays);
            assert_eq!(left.lines[2].line, -right.lines[0].line, "exact opposites");
            let across = left.lines[2].line;
            let (x, y) = (across.dot(rays.step_x), across.dot(rays.step_y));
            let inwards = (rays.step_x * x + rays.step_y * y) / x.hypot(y);
            for k in 100..900 {
                // A point of the shared edge, thrown onto the facet.
                let q = a + (c - a) * (f64::from(k) / 1000.0);
                let to_light = light.truncate() - q * light.w;
                let r = q - to_light * ((q.y + 1.0) / to_light.y);
                assert!(left.covers(r) || right.covers(r));
                assert!(matches!(left.cover(r), Cover::Near(_)));
                let aside = r / r.dot(rays.forward) + inwards * (1.1 * AMBIGUITY);
                assert_eq!((left.cover(aside), right.cover(aside)), (Cover::In, Cover::Out));
            }
        }
    }

    #[test]
    fn heights_of_corners_and_of_flat_neighbours_are_zero() {
        let corners = [DVec3::new(1e6, 2.0, 3.0), DVec3::new(1e6 + 1.0, 2.1, 3.0), DVec3::new(1e6, 2.3, 4.0)];
        let plane = Plane::new(corners);
        assert_eq!(corners.map(|c| plane.height(c)), [0.0; 3]);
        let flat = corners[0] + (corners[1] - corners[0]) * 0.25 + (corners[2] - corners[0]) * 0.5;
        assert!(plane.height(flat + DVec3::Y * 1e-3) != 0.0);
        let exact = Plane::new([DVec3::ZERO, DVec3::X, DVec3::Z]);
        assert_eq!(exact.height(DVec3::new(5.0, 1e-13, 7.0)), 0.0);
        assert!(exact.height(DVec3::new(5.0, 1e-10, 7.0)) < 0.0);
    }

    #[test]
    fn a_sharp_tip_is_near_where_it_is() {
        let rays = rays();
        let facet = Plane::new([DVec3::new(-5.0, -1.0, 0.0), DVec3::new(5.0, -1.0, 0.0), DVec3::new(0.0, -1.0, -9.0)]);
        let needle = [DVec3::new(-1.0, 0.0, -4.0), DVec3::new(1.0, 0.0, -4.0), DVec3::new(-1.0, 0.0, -4.0001)];
        let shadow = Shadow::new(far(&facet), needle, DVec4::new(0.0, 1.0, 0.0, 0.0), &rays);
        let at = |x: f64, z: f64| DVec3::new(x, -1.0, z) / -z;
        let pixel = 4.0 * rays.step_x.length();
        assert!(shadow.comes_near(at(0.0, -4.0001), &rays) && shadow.comes_near(at(0.99, -4.0), &rays));
        assert!(shadow.comes_near(at(1.0 + 0.9 * AMBIGUITY * pixel, -4.0), &rays));
        let beyond = at(1.0 + 1.1 * AMBIGUITY * pixel, -4.0);
        assert!(!shadow.comes_near(beyond, &rays));
        assert!(matches!(shadow.cover(beyond), Cover::Near(false)), "the lines alone do not tell");
    }

    #[test]
    fn a_light_in_the_plane_of_a_triangle_casts_nothing() {
        let rays = rays();
        let facet = Plane::new([DVec3::new(-5.0, -1.0, 0.0), DVec3::new(5.0, -1.0, 0.0), DVec3::new(0.0, -1.0, -9.0)]);
        let wall = [DVec3::new(0.0, 0.0, -3.0), DVec3::new(0.0, 2.0, -3.0), DVec3::new(0.0, 0.0, -5.0)];
        let shadow = Shadow::new(far(&facet), wall, DVec4::new(0.0, 1.0, 0.3, 0.0), &rays);
        assert!(shadow.edge_on);
        for k in 0..100 {
            assert!(!shadow.covers(rays.direction(32.0, 24.0 + f64::from(k) * 0.2)));
        }
    }
}
