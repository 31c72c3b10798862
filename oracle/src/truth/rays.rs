//! Rays against a mesh, decided in `f64`.
//!
//! The hierarchy only lists candidates. Whether a ray meets a triangle is decided by the signs of three determinants,
//! one an edge, each computed from the lesser corner of the edge to the greater one (corners in lexicographic order), so
//! that the triangles on both sides of an edge get values that are exact opposites, even where vertices are duplicated.
//! A determinant within its forward error bound *touches*, and touching counts as inside: no ray slips between two
//! triangles that share an edge or a vertex.

use super::beam::Beam;
use super::hierarchy::Hierarchy;
use super::{DETERMINANT_ERROR, bits, light_side};
use glam::{DVec3, DVec4, Vec3};
use subpixel_shadows::Result;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::scene::{AlphaTested, Mesh, Roles};

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter: the point is `origin + t·direction`.
    pub t: f64,
    /// Bound of the error of `t`.
    pub error: f64,
    /// Index of the triangle.
    pub triangle: u32,
    /// Whether the ray touches an edge of the triangle within the error bound.
    pub touching: bool,
}

/// Whether something lies between a point and the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shade {
    /// A triangle lies strictly between.
    pub occluded: bool,
    /// The answer rests on an edge that is touched within the error bound.
    pub touching: bool,
}

/// A mesh ready for rays.
#[derive(Clone, Debug)]
pub struct Tracer {
    tree: Hierarchy,
    /// Slot of each triangle.
    slots: Vec<u32>,
    /// Alpha-tested triangles, and the place among them of each triangle; none where all are whole.
    alpha: Option<(AlphaTested, Vec<u32>)>,
    /// Layers that the light is in.
    layers: u8,
}

impl Tracer {
    /// Builds the hierarchy. Time `O(n log n)`; about 140 bytes a triangle.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Mesh`] if a vertex is not finite or an index is out of range.
    pub fn new(mesh: &Mesh) -> Result<Self> {
        Self::with_alpha(mesh, &AlphaTested::default())
    }

    /// As [`Tracer::new`], where some triangles have holes, through which rays go.
    ///
    /// # Errors
    /// As [`Tracer::new`] and [`AlphaTested::check`].
    pub fn with_alpha(mesh: &Mesh, alpha: &AlphaTested) -> Result<Self> {
        mesh.check("mesh to trace")?;
        alpha.check(mesh)?;
        let corners: Vec<_> =
            mesh.triangles.iter().map(|t| t.map(|v| Vec3::from(mesh.positions[v as usize]))).collect();
        let tree = Hierarchy::new(&corners);
        let mut slots = vec![0; corners.len()];
        for (slot, &t) in tree.triangles.iter().enumerate() {
            slots[t as usize] = slot as u32;
        }
        let alpha = (!alpha.is_empty()).then(|| (alpha.clone(), alpha.places(mesh.triangles.len())));
        Ok(Self { tree, slots, alpha, layers: u8::MAX })
    }

    /// The same for a light that is in these layers alone: triangles have [`Roles`] in them.
    #[must_use]
    pub fn in_layers(self, layers: u8) -> Self {
        Self { layers, ..self }
    }

    /// Roles of a triangle in lights.
    fn roles(&self, triangle: u32) -> Roles {
        let of = |(alpha, places): &(AlphaTested, Vec<u32>)| {
            alpha.triangles.get(places[triangle as usize] as usize).map(|of| of.roles)
        };
        self.alpha.as_ref().and_then(of).unwrap_or_default()
    }

    /// Whether others shadow a triangle in the light.
    pub(crate) fn receives(&self, triangle: u32) -> bool {
        self.roles(triangle).receives_in(self.layers)
    }

    /// As [`Tracer::is_solid`], of what the eye sees.
    pub(crate) fn is_seen(&self, triangle: u32, corners: [DVec3; 3], point: DVec3) -> bool {
        self.roles(triangle).seen && self.is_solid(triangle, corners, point)
    }

    /// The tracer of a prepared mesh.
    ///
    /// # Errors
    /// As [`Tracer::with_alpha`].
    pub fn of(prepared: &Prepared) -> Result<Self> {
        Self::with_alpha(prepared.mesh(), prepared.alpha())
    }

    /// How many triangles there are.
    pub fn triangle_count(&self) -> usize {
        self.slots.len()
    }

    /// Corners of a triangle, world units, exact.
    ///
    /// # Panics
    /// If `triangle` is not below [`Tracer::triangle_count`].
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.tree.corners[self.slots[triangle as usize] as usize].map(|c| c.as_dvec3())
    }

    /// Whether a triangle may have holes.
    pub fn is_tested(&self, triangle: u32) -> bool {
        self.alpha.as_ref().is_some_and(|(_, places)| places[triangle as usize] != u32::MAX)
    }

    /// Whether a triangle with these corners, all of them and the point moved alike, is there at a point of its plane: of an alpha-tested one, whether
    /// alpha is at least the cutoff.
    pub(crate) fn is_solid(&self, triangle: u32, [a, b, c]: [DVec3; 3], point: DVec3) -> bool {
        let Some((alpha, places)) = &self.alpha else { return true };
        let place = places[triangle as usize];
        if place == u32::MAX {
            return true;
        }
        let (ab, ac, from_a) = (b - a, c - a, point - a);
        let normal = ab.cross(ac);
        let scale = normal.length_squared();
        // Edge-on, and without area, it is met nowhere.
        let shares = [from_a.cross(ac), ab.cross(from_a)].map(|part| normal.dot(part) / scale);
        scale == 0.0 || alpha.is_solid(place, [1.0 - shares[0] - shares[1], shares[0], shares[1]])
    }

    /// The same where the line from a point towards a homogeneous light crosses its plane.
    pub(crate) fn is_solid_towards(&self, triangle: u32, corners: [DVec3; 3], point: DVec3, light: DVec4) -> bool {
        if !self.is_tested(triangle) {
            return true;
        }
        if !self.roles(triangle).casts_in(self.layers) {
            return false;
        }
        let [a, b, c] = corners;
        let (normal, way) = ((b - a).cross(c - a), light.truncate() - point * light.w);
        let along = normal.dot(way);
        along == 0.0 || self.is_solid(triangle, corners, point + way * (normal.dot(a - point) / along))
    }

    /// Lowest and highest corner of the box around all triangles; infinite and turned around without any.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.tree.corners.iter().flatten().map(|c| c.as_dvec3());
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
    }

    pub(crate) fn tree(&self) -> &Hierarchy {
        &self.tree
    }

    /// The nearest triangle that `origin + t·direction` meets with `t > t_min`; of equally near ones that of the lowest
    /// index. A triangle seen edge-on (within the error bound) is not met: its neighbours are.
    pub fn closest(&self, origin: DVec3, direction: DVec3, t_min: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let beam = Beam::ray(origin, direction, t_min.max(0.0), f64::INFINITY);
        self.tree.walk(&beam, |slot, end| {
            let triangle = self.tree.triangles[slot];
            let corners = self.tree.corners[slot].map(|c| c.as_dvec3());
            if let Some(hit) = meet(corners, triangle, origin, direction)
                && hit.t > t_min
                && self.is_seen(triangle, corners, origin + direction * hit.t)
                && best.is_none_or(|b| (hit.t, hit.triangle) < (b.t, b.triangle))
            {
                best = Some(hit);
                return hit.t;
            }
            end
        });
        best
    }

    /// Whether a triangle that `skip` does not name lies strictly between `point` and the homogeneous `light`:
    /// `(direction towards it, 0)` or `(position, 1)`.
    pub fn occluded(&self, point: DVec3, light: DVec4, skip: &dyn Fn(u32) -> bool) -> bool {
        self.shade(point, point.length() * f64::EPSILON, light, skip).occluded
    }

    /// As [`Tracer::occluded`] for a point known within `error` world units, and says whether an edge decides.
    ///
    /// A triangle whose plane holds the point within the error bound does not occlude it: it is a neighbour of the
    /// surface the point lies on, or the same surface. No distance is tuned for that.
    pub fn shade(&self, point: DVec3, error: f64, light: DVec4, skip: &dyn Fn(u32) -> bool) -> Shade {
        let mut shade = Shade::default();
        let ray = ShadowRay::new(point, error, light);
        self.tree.walk(&ray.beam(), |slot, end| {
            let triangle = self.tree.triangles[slot];
            if !skip(triangle) {
                let corners = self.tree.corners[slot].map(|c| c.as_dvec3());
                match ray.crosses(corners) {
                    Crossing::None => {}
                    _ if !self.is_solid_towards(triangle, corners, point, light) => {}
                    Crossing::Touch => shade = Shade { occluded: true, touching: true },
                    Crossing::Inside => {
                        shade = Shade { occluded: true, touching: false };
                        return -1.0;
                    }
                }
            }
            end
        });
        shade
    }

    /// Calls `visit` for every triangle that may come within `radius` of the segment from `from` to `to` (world
    /// units), each once, roughly from near to far. A superset, never fewer.
    pub fn visit_candidates(&self, from: DVec3, to: DVec3, radius: f64, visit: &mut dyn FnMut(u32)) {
        let pad = DVec3::splat(radius);
        self.visit_beam(&Beam::towards(from - pad, from + pad, to.extend(1.0)).widened_at_end(pad), visit);
    }

    /// Calls `visit` for every triangle that may come into the beam, each once, roughly from near to far. A superset,
    /// never fewer.
    pub fn visit_beam(&self, beam: &Beam, visit: &mut dyn FnMut(u32)) {
        self.tree.walk(beam, |slot, end| {
            visit(self.tree.triangles[slot]);
            end
        });
    }
}

/// Corner pairs of the three edges.
pub(crate) const EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// The edge from `a` to `b` in canonical order: the lesser corner, the greater one, and `1` or `-1` if they were
/// swapped.
#[inline]
pub(crate) fn canonical(a: DVec3, b: DVec3) -> (DVec3, DVec3, f64) {
    if a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z <= b.z))) { (a, b, 1.0) } else { (b, a, -1.0) }
}

/// Gathers the signs of the three edges: inside if none contradict.
#[derive(Default)]
struct EdgeSigns {
    positive: bool,
    negative: bool,
    touching: bool,
}

impl EdgeSigns {
    #[inline]
    fn add(&mut self, value: f64, bound: f64) {
        self.positive |= value > bound;
        self.negative |= value < -bound;
        self.touching |= value.abs() <= bound;
    }
}

/// Decides whether a ray meets a triangle, and where on its plane. The corners are world positions.
pub(crate) fn meet(corners: [DVec3; 3], triangle: u32, origin: DVec3, direction: DVec3) -> Option<Hit> {
    let length = direction.length();
    let mut signs = EdgeSigns::default();
    for (i, j) in EDGES {
        let (lo, hi, flip) = canonical(corners[i], corners[j]);
        let (from, edge) = (lo - origin, hi - lo);
        let value = flip * direction.dot(from.cross(edge));
        signs.add(value, DETERMINANT_ERROR * length * from.length() * edge.length());
    }
    if signs.positive && signs.negative {
        return None;
    }
    let [a, b, c] = corners;
    let (normal, size) = normal_of(a, b, c);
    let along = normal.dot(direction);
    let along_error = DETERMINANT_ERROR * size * length;
    if along.abs() <= along_error {
        return None;
    }
    let from = a - origin;
    let t = normal.dot(from) / along;
    let error = 2.0 * (DETERMINANT_ERROR * size * from.length() + t.abs() * along_error) / along.abs();
    Some(Hit { t, error, triangle, touching: signs.touching })
}

/// Normal of a triangle, counter-clockwise, and the product of the two edge lengths it is made of, which its error is
/// relative to.
#[inline]
pub(crate) fn normal_of(a: DVec3, b: DVec3, c: DVec3) -> (DVec3, f64) {
    let (u, v) = (b - a, c - a);
    (u.cross(v), u.length() * v.length())
}

/// How a shadow ray meets a triangle.
enum Crossing {
    None,
    Touch,
    Inside,
}

/// The open segment from a point to the light.
struct ShadowRay {
    point: DVec3,
    error: f64,
    light: DVec4,
    direction: DVec3,
}

impl ShadowRay {
    fn new(point: DVec3, error: f64, light: DVec4) -> Self {
        Self { point, error, light, direction: light.truncate() - point * light.w }
    }

    fn beam(&self) -> Beam {
        let pad = DVec3::splat(self.error);
        Beam::towards(self.point - pad, self.point + pad, self.light)
    }

    fn crosses(&self, corners: [DVec3; 3]) -> Crossing {
        let length = self.direction.length();
        let mut signs = EdgeSigns::default();
        for (i, j) in EDGES {
            let (lo, hi, flip) = canonical(corners[i], corners[j]);
            let (from, edge) = (lo - self.point, hi - lo);
            let value = flip * self.direction.dot(from.cross(edge));
            let (f, e) = (from.length(), edge.length());
            // A shift of the point moves both the direction (of a light at a position) and the corner.
            let shift = self.error * e * (length + self.light.w * f);
            signs.add(value, DETERMINANT_ERROR * length * f * e + shift);
        }
        if signs.positive && signs.negative {
            return Crossing::None;
        }
        let [a, b, c] = corners;
        let (normal, size) = normal_of(a, b, c);
        let from = self.point - a;
        let height = normal.dot(from);
        let to_light = self.light.truncate() - a * self.light.w;
        let between = height * light_side(b - a, c - a, to_light).sign < 0.0
            && height.abs() > DETERMINANT_ERROR * size * from.length() + size * self.error;
        match (between, signs.touching) {
            (false, _) => Crossing::None,
            (true, true) => Crossing::Touch,
            (true, false) => Crossing::Inside,
        }
    }
}

/// The lowest triangle of a group of samples, for the packets.
pub(crate) fn group(triangles: &[u32], seen: u128) -> Option<(u32, u128)> {
    let first = triangles[bits(seen).next()?];
    Some((first, bits(seen).filter(|&k| triangles[k] == first).fold(0, |m, k| m | 1 << k)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Mesh {
        Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 3, 2]],
        }
    }

    #[test]
    fn finds_the_nearest_and_leaves_no_gap_on_the_diagonal() {
        let tracer = Tracer::new(&square()).unwrap();
        for k in 0..=1000 {
            let s = f64::from(k) / 1000.0;
            let hit = tracer.closest(DVec3::new(s, 2.0, s), -DVec3::Y, 0.0).unwrap();
            assert_eq!(hit.t, 2.0);
            assert!(hit.touching);
        }
        assert!(tracer.closest(DVec3::new(0.5, 2.0, 0.4), -DVec3::Y, 2.0).is_none());
        assert!(tracer.closest(DVec3::new(0.5, 2.0, 0.4), DVec3::Y, 0.0).is_none());
        assert!(tracer.closest(DVec3::new(-0.5, 0.0, 0.4), DVec3::X, 0.0).is_none(), "edge-on");
    }

    #[test]
    fn occlusion_is_strictly_between() {
        let tracer = Tracer::new(&square()).unwrap();
        let up = DVec4::new(0.0, 1.0, 0.0, 0.0);
        let below = DVec3::new(0.6, -1.0, 0.3);
        assert!(tracer.occluded(below, up, &|_| false));
        assert!(!tracer.occluded(below, up, &|t| t == 0), "skipped");
        assert!(!tracer.occluded(DVec3::new(0.6, 0.0, 0.3), up, &|_| false), "on the surface");
        assert!(!tracer.occluded(DVec3::new(0.6, 1e-300, 0.3), up, &|_| false), "above it");
        assert!(!tracer.occluded(below, -up, &|_| false), "behind");
        let lamp = |y: f64| DVec4::new(0.6, y, 0.3, 1.0);
        assert!(tracer.occluded(below, lamp(1.0), &|_| false));
        assert!(!tracer.occluded(below, lamp(0.0), &|_| false), "light in the plane");
        assert!(!tracer.occluded(below, lamp(-0.5), &|_| false), "light on this side");
    }

    #[test]
    fn candidates_near_a_segment_are_all_listed() {
        let tracer = Tracer::new(&square()).unwrap();
        let listed = |radius: f64| {
            let mut all = Vec::new();
            tracer.visit_candidates(DVec3::new(1.2, 1.0, 0.5), DVec3::new(1.2, -1.0, 0.5), radius, &mut |t| {
                all.push(t);
            });
            all.sort_unstable();
            all
        };
        assert!(listed(0.1).is_empty());
        assert_eq!(listed(0.3), [0, 1]);
    }

    /// The ray against a triangle by Cramer's rule; `None` where the numbers are too near a tie to tell.
    fn cramer([a, b, c]: [DVec3; 3], origin: DVec3, d: DVec3) -> Option<Option<f64>> {
        let (u, v, s) = (b - a, c - a, origin - a);
        let det = u.cross(v).dot(-d);
        let (beta, gamma) = (s.cross(v).dot(-d) / det, u.cross(s).dot(-d) / det);
        let t = u.cross(v).dot(s) / det;
        let least = beta.min(gamma).min(1.0 - beta - gamma).min(t);
        (least.is_finite() && least.abs() > 1e-6).then(|| (least > 0.0).then_some(t))
    }

    #[test]
    fn equals_every_triangle_one_by_one_without_boxes() {
        let mut state = 17u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
        };
        let mut mesh = Mesh::default();
        for k in 0..60u32 {
            let at = [unit(), unit(), unit()];
            for _ in 0..3 {
                mesh.positions.push(at.map(|c| ((c + 0.4 * unit()) * 64.0).round() as f32 / 64.0));
            }
            mesh.triangles.push([3 * k, 3 * k + 1, 3 * k + 2]);
        }
        let tracer = Tracer::new(&mesh).unwrap();
        for case in 0..100_000 {
            let corners = mesh.corners(case % 60);
            let origin = DVec3::new(unit(), unit(), unit()) * 2.0;
            let d = match case % 5 {
                0 => DVec3::new(unit(), unit(), unit()),
                1 => DVec3::AXES[case % 3],
                2 => corners[0] - origin,
                3 => corners[0] + (corners[1] - corners[0]) * unit().abs() - origin,
                _ => (corners[0] + corners[1] + corners[2]) / 3.0 - origin,
            };
            let all = || (0..60).map(|t| (t, mesh.corners(t as usize)));
            let hits = all().filter_map(|(t, c)| meet(c, t, origin, d)).filter(|h| h.t > 0.0);
            let best = hits.min_by(|a, b| (a.t, a.triangle).partial_cmp(&(b.t, b.triangle)).unwrap());
            assert_eq!(tracer.closest(origin, d, 0.0), best, "case {case}");
            for light in [d.extend(0.0), (origin + d).extend(1.0)] {
                let ray = ShadowRay::new(origin, origin.length() * f64::EPSILON, light);
                let any = all().any(|(_, c)| !matches!(ray.crosses(c), Crossing::None));
                assert_eq!(tracer.occluded(origin, light, &|_| false), any, "case {case}");
            }
            for (t, c) in all() {
                if let Some(other) = cramer(c, origin, d) {
                    let hit = meet(c, t, origin, d).filter(|h| h.t > 0.0);
                    assert_eq!(hit.is_some(), other.is_some(), "case {case} triangle {t}");
                    if let (Some(hit), Some(t)) = (hit, other) {
                        assert!((hit.t - t).abs() <= 1e-6 * t, "case {case}");
                    }
                }
            }
        }
    }

    #[test]
    fn refuses_a_broken_mesh() {
        let mut mesh = square();
        mesh.positions[1][2] = f32::NAN;
        assert!(Tracer::new(&mesh).is_err());
        let mut mesh = square();
        mesh.triangles[1][0] = 4;
        assert!(Tracer::new(&mesh).is_err());
    }
}
