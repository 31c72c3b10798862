//! All samples of one pixel at once.
//!
//! The samples of a pixel share one walk of the hierarchy for what they see and one for each surface they see, for its
//! shadow. The decisions are those of [`super::rays`]; they are evaluated as functions linear in the sample position,
//! and in the surface point for the shadow, so that a triangle is set up once for all samples.

use super::beam::Beam;
use super::rays::{EDGES, Tracer, canonical, group, normal_of};
use super::{DETERMINANT_ERROR, bits, full_mask, light_side};
use glam::{DVec2, DVec3, DVec4};
use subpixel_shadows::scene::PixelRays;

/// The most samples a packet holds.
pub(super) const PACKET: usize = 128;
/// No triangle.
const NONE: u32 = u32::MAX;

/// Surfaces that the samples of a packet see.
pub(super) struct Seen {
    /// Ray directions.
    pub rays: [DVec3; PACKET],
    /// View depth from which on each sees surfaces.
    begin: [f64; PACKET],
    /// View depth of the surface, infinite where there is none.
    pub depth: [f64; PACKET],
    /// Bound of its error.
    pub error: [f64; PACKET],
    /// The nearest triangle of each sample.
    pub triangle: [u32; PACKET],
    /// Samples that see a surface.
    pub seen: u128,
    /// Samples decided by an edge within the error bound.
    pub touching: u128,
}

/// Light on them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Lit {
    pub seen: u128,
    pub lit: u128,
    pub undecided: u128,
}

/// Traces the samples at `corner + offset` (pixels, at most [`PACKET`]) to the nearest surface beyond the near distance.
pub(super) fn see(tracer: &Tracer, rays: &PixelRays, corner: DVec2, offsets: &[DVec2]) -> Seen {
    let count = offsets.len().min(PACKET);
    let offsets = &offsets[..count];
    let mut out = Seen {
        rays: [DVec3::ZERO; PACKET],
        begin: [0.0; PACKET],
        depth: [f64::INFINITY; PACKET],
        error: [0.0; PACKET],
        triangle: [NONE; PACKET],
        seen: 0,
        touching: 0,
    };
    let (mut low, mut high, mut longest) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0f64);
    for (k, o) in offsets.iter().enumerate() {
        let r = rays.direction(corner.x + o.x, corner.y + o.y);
        (low, high, longest) = (low.min(r), high.max(r), longest.max(r.length()));
        (out.rays[k], out.begin[k]) = (r, rays.begin(r));
    }
    let least = offsets.iter().fold(DVec2::INFINITY, |a, &b| a.min(b));
    let most = offsets.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
    let (middle, half) = ((least + most) * 0.5, (most - least) * 0.5);
    let centre = rays.direction(corner.x + middle.x, corner.y + middle.y);
    let (half_x, half_y) = (rays.step_x * half.x, rays.step_y * half.y);
    let beam = Beam::pencil(rays.eye, low, high, rays.near, f64::INFINITY);
    let tree = tracer.tree();
    let all = full_mask(count as u32);
    tree.walk(&beam, |slot, end| {
        let [a, b, c] = tree.corners[slot].map(|c| c.as_dvec3() - rays.eye);
        let corners = [a, b, c];
        // Edge functions of the pixel's rays: normal of the plane through eye and edge, and its error bound.
        let mut edges = [(DVec3::ZERO, 0.0); 3];
        let (mut beside, mut against) = (false, false);
        for (edge, (i, j)) in edges.iter_mut().zip(EDGES) {
            let (lo, hi, flip) = canonical(corners[i], corners[j]);
            let along = hi - lo;
            let normal = lo.cross(along) * flip;
            let bound = DETERMINANT_ERROR * longest * lo.length() * along.length();
            let (m, s) = (normal.dot(centre), normal.dot(half_x).abs() + normal.dot(half_y).abs() + 2.0 * bound);
            beside |= m > s;
            against |= m < -s;
            *edge = (normal, bound);
        }
        if beside && against {
            return end;
        }
        let (normal, size) = normal_of(a, b, c);
        let height = normal.dot(a);
        let along_error = DETERMINANT_ERROR * size * longest;
        let height_error = DETERMINANT_ERROR * size * a.length();
        let triangle = tree.triangles[slot];
        for k in 0..count {
            let r = out.rays[k];
            let (mut positive, mut negative, mut touching) = (false, false, false);
            for (n, bound) in &edges {
                let value = n.dot(r);
                positive |= value > *bound;
                negative |= value < -*bound;
                touching |= value.abs() <= *bound;
            }
            let along = normal.dot(r);
            if (positive && negative) || along.abs() <= along_error {
                continue;
            }
            let t = height / along;
            let nearer = t > out.begin[k] && (t, triangle) < (out.depth[k], out.triangle[k]);
            if nearer && tracer.is_seen(triangle, corners, r * t) {
                out.depth[k] = t;
                out.error[k] = 2.0 * (height_error + t * along_error) / along.abs();
                out.triangle[k] = triangle;
                out.seen |= 1 << k;
                out.touching = out.touching & !(1 << k) | u128::from(touching) << k;
            }
        }
        if out.seen == all { out.depth[..count].iter().fold(0.0, |a: f64, &b| a.max(b)).min(end) } else { end }
    });
    out
}

impl Seen {
    /// The samples of each surface that is seen: triangle and mask, lowest sample first.
    pub fn surfaces(&self) -> impl Iterator<Item = (u32, u128)> + '_ {
        let mut left = self.seen;
        std::iter::from_fn(move || {
            let (triangle, mask) = group(&self.triangle, left)?;
            left &= !mask;
            Some((triangle, mask))
        })
    }

    /// Which of the samples the `light` (homogeneous, world) reaches.
    pub fn light(&self, tracer: &Tracer, rays: &PixelRays, light: DVec4) -> Lit {
        let mut out = Lit { seen: self.seen, lit: 0, undecided: self.touching };
        for (triangle, mask) in self.surfaces() {
            let (occluded, touching) = self.shade(tracer, rays, light, triangle, mask);
            out.lit |= mask & !occluded;
            out.undecided |= touching;
        }
        out
    }

    /// The samples `mask` of one surface that are dark, and those of them that an edge within the error bound decides.
    fn shade(&self, tracer: &Tracer, rays: &PixelRays, light: DVec4, own: u32, mask: u128) -> (u128, u128) {
        if !tracer.receives(own) {
            return (0, 0);
        }
        // Relative to the eye: differences of the f32 corners from the f32 eye are exact or nearly so.
        let l = light.truncate() - rays.eye * light.w;
        let local = l.extend(light.w);
        let [a, b, c] = tracer.corners(own).map(|c| c - rays.eye);
        let normal = normal_of(a, b, c).0;
        let (to_eye, to_light) = (-a, l - a * light.w);
        let side = light_side(b - a, c - a, to_light);
        let doubtful = if side.open { mask } else { 0 };
        if normal.dot(to_eye) * side.sign <= 0.0 {
            return (mask, doubtful);
        }
        let mut points = [DVec3::ZERO; PACKET];
        let (mut low, mut high, mut error) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0f64);
        for k in bits(mask) {
            let p = self.rays[k] * self.depth[k];
            let length = self.rays[k].length();
            (low, high) = (low.min(p), high.max(p));
            error = error.max(length * (self.error[k] + self.depth[k] * f64::EPSILON));
            points[k] = p;
        }
        let middle = (low + high) * 0.5;
        let radius = (high - low).length() * 0.5 + error;
        let pad = DVec3::splat(error);
        let beam = Beam::towards(rays.eye + low - pad, rays.eye + high + pad, light);
        let tree = tracer.tree();
        let (mut dark, mut touched) = (0u128, 0u128);
        tree.walk(&beam, |slot, end| {
            if tree.triangles[slot] == own {
                return end;
            }
            let corners = tree.corners[slot].map(|c| c.as_dvec3() - rays.eye);
            let Some(volume) = Volume::new(corners, l, light.w, middle, radius, error) else { return end };
            for k in bits(mask & !dark) {
                let held = volume.holds(points[k]);
                if held.is_some() && !tracer.is_solid_towards(tree.triangles[slot], corners, points[k], local) {
                    continue;
                }
                match held {
                    Some(false) => dark |= 1 << k,
                    Some(true) => touched |= 1 << k,
                    None => {}
                }
            }
            if dark == mask { -1.0 } else { end }
        });
        (dark | touched, touched & !dark | doubtful)
    }
}

/// The shadow volume of a triangle near some points: inner sides of four planes, each with its error bound there.
struct Volume {
    planes: [(DVec3, DVec3, f64); 4],
}

impl Volume {
    /// `None` if it holds none of the points within `radius` of `middle`.
    fn new(corners: [DVec3; 3], l: DVec3, w: f64, middle: DVec3, radius: f64, error: f64) -> Option<Self> {
        let [a, b, c] = corners;
        let (normal, size) = normal_of(a, b, c);
        let to_light = l - a * w;
        let side = light_side(b - a, c - a, to_light).sign;
        if side == 0.0 {
            return None;
        }
        let inner = -side;
        let reject = |normal: DVec3, at: DVec3, bound: f64| normal.dot(middle - at) + normal.length() * radius < -bound;
        let mut planes = [(DVec3::ZERO, DVec3::ZERO, 0.0); 4];
        let far = (middle - a).length() + radius;
        let bound = DETERMINANT_ERROR * size * far + size * error;
        planes[3] = (normal * inner, a, bound);
        if reject(planes[3].0, a, bound) {
            return None;
        }
        for (plane, (i, j)) in planes.iter_mut().zip(EDGES) {
            let (lo, hi, flip) = canonical(corners[i], corners[j]);
            let (along, to_light) = (hi - lo, l - lo * w);
            let normal = along.cross(to_light) * (flip * inner);
            let size = along.length() * to_light.length();
            let far = (middle - lo).length() + radius;
            let bound = DETERMINANT_ERROR * size * far + size * error;
            if reject(normal, lo, bound) {
                return None;
            }
            *plane = (normal, lo, bound);
        }
        Some(Self { planes })
    }

    /// Whether the volume holds the point; the flag tells whether an edge is touched.
    #[inline]
    fn holds(&self, p: DVec3) -> Option<bool> {
        let value = |k: usize| self.planes[k].0.dot(p - self.planes[k].1);
        let [e0, e1, e2, own] = [0, 1, 2, 3].map(value);
        let [b0, b1, b2, own_bound] = self.planes.map(|p| p.2);
        let inside = e0 >= -b0 && e1 >= -b1 && e2 >= -b2 && own > own_bound;
        inside.then_some(e0 <= b0 || e1 <= b1 || e2 <= b2)
    }
}
