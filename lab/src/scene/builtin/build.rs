//! Bricks that the built-in scenes are made of. Each is closed and wound outward unless it says otherwise.

use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::TAU;
use subpixel_shadows::scene::{AlphaTested, Mesh, Roles, TestedTriangle};

/// A mesh in the making.
#[derive(Default)]
pub(super) struct Build {
    pub(super) mesh: Mesh,
    pub(super) alpha: AlphaTested,
    /// Where new parts go: a rotation and a translation.
    place: DAffine3,
}

/// A point.
pub(super) fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Points on a circle around the y axis: `n` of them, from +x towards +z.
pub(super) fn around(n: u32, radius: f64, y: f64) -> impl Iterator<Item = DVec3> {
    (0..n).map(move |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
        at(radius * cos, y, radius * sin)
    })
}

/// The `n` + 1 points that cut the segment from `a` to `b` into `n` parts.
pub(super) fn steps(a: DVec3, b: DVec3, n: u32) -> impl Iterator<Item = DVec3> {
    (0..=n).map(move |k| a.lerp(b, f64::from(k) / f64::from(n)))
}

/// A direction at right angles to `d`, level where that is possible.
fn sideways(d: DVec3) -> DVec3 {
    let level = d.cross(DVec3::Y);
    if level.length() > 1e-3 * d.length() { level.normalize() } else { DVec3::X }
}

impl Build {
    /// Builds with `place` put before the place of now.
    pub(super) fn within(&mut self, place: DAffine3, build: impl FnOnce(&mut Self)) {
        let outer = self.place;
        self.place = outer * place;
        build(self);
        self.place = outer;
    }

    fn vertex(&mut self, p: DVec3) -> u32 {
        self.mesh.positions.push(self.place.transform_point3(p).as_vec3().into());
        self.mesh.positions.len() as u32 - 1
    }

    /// A flat open piece with the corners in counter-clockwise order.
    pub(super) fn polygon(&mut self, corners: &[DVec3]) {
        let ring: Vec<u32> = corners.iter().map(|&c| self.vertex(c)).collect();
        self.cap(ring.iter().copied());
    }

    /// A flat piece of four corners with the holes of a map, which goes so many times into its width and height.
    pub(super) fn card(&mut self, corners: [DVec3; 4], map: u32, times: [f32; 2]) {
        let first = self.mesh.triangles.len() as u32;
        self.polygon(&corners);
        let [u, v] = times;
        for (triangle, uv) in (first..).zip([[[0.0, 0.0], [u, 0.0], [u, v]], [[0.0, 0.0], [u, v], [0.0, v]]]) {
            self.alpha.triangles.push(TestedTriangle { triangle, map, uv, roles: Roles::ALL });
        }
    }

    /// Two triangles at height 0, facing up.
    pub(super) fn plane(&mut self, half: f64) {
        self.polygon(&[at(-half, 0.0, -half), at(-half, 0.0, half), at(half, 0.0, half), at(half, 0.0, -half)]);
    }

    /// A box from its centre and three half axes at right angles.
    pub(super) fn block(&mut self, centre: DVec3, x: DVec3, y: DVec3, z: DVec3) {
        let z = if DMat3::from_cols(x, y, z).determinant() < 0.0 { -z } else { z };
        let sign = |bit: u32| f64::from(bit) * 2.0 - 1.0;
        let v = [0u32, 1, 2, 3, 4, 5, 6, 7]
            .map(|i| self.vertex(centre + x * sign(i & 1) + y * sign(i >> 1 & 1) + z * sign(i >> 2)));
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            self.mesh.triangles.extend([[v[a], v[b], v[c]], [v[a], v[c], v[d]]]);
        }
    }

    /// A box along the axes between two corners.
    pub(super) fn brick(&mut self, low: DVec3, high: DVec3) {
        let half = (high - low) * 0.5;
        self.block((low + high) * 0.5, DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z);
    }

    /// A straight bar, `width` across level and `height` across upright.
    pub(super) fn beam(&mut self, from: DVec3, to: DVec3, width: f64, height: f64) {
        let along = (to - from) * 0.5;
        let side = sideways(along);
        let up = side.cross(along).normalize();
        self.block((from + to) * 0.5, along, side * (width * 0.5), up * (height * 0.5));
    }

    /// A bar between points along a path, one box from each to the next; every other one is a little thinner, so that
    /// where they overlap their faces do not lie in one plane.
    pub(super) fn rail(&mut self, path: impl Iterator<Item = DVec3>, closed: bool, width: f64, height: f64) {
        let points: Vec<DVec3> = path.collect();
        for (k, w) in points.windows(2).enumerate() {
            let share = if k % 2 == 0 { 1.0 } else { 0.94 };
            self.beam(w[0], w[1], width * share, height * share);
        }
        if let (true, [first, .., last]) = (closed, points.as_slice()) {
            self.beam(*last, *first, width * 0.94, height * 0.94);
        }
    }

    /// A round bar, thicker or thinner at its end.
    pub(super) fn rod(&mut self, from: DVec3, to: DVec3, radius: f64, end_radius: f64, sides: u32) {
        self.tube(&[(from, radius), (to, end_radius)], sides, false);
    }

    /// A tube through points with a radius each, capped at its ends or closed to a ring.
    pub(super) fn tube(&mut self, path: &[(DVec3, f64)], sides: u32, closed: bool) {
        let n = path.len();
        let tangent = |i: usize| {
            let (before, after) =
                if closed { ((i + n - 1) % n, (i + 1) % n) } else { (i.saturating_sub(1), (i + 1).min(n - 1)) };
            (path[after].0 - path[before].0).normalize()
        };
        // The frame is carried along without turning about the path; a ring spreads the turn that is left at the end.
        let mut normals = vec![sideways(tangent(0))];
        for i in 1..n + usize::from(closed) {
            let (t, last) = (tangent(i % n), normals[i - 1]);
            normals.push((last - t * last.dot(t)).normalize());
        }
        let twist = if closed {
            let (first, last, t) = (normals[0], normals[n], tangent(0));
            t.dot(last.cross(first)).atan2(last.dot(first))
        } else {
            0.0
        };
        let rings: Vec<Vec<u32>> = (0..n)
            .map(|i| {
                let (t, normal) = (tangent(i), normals[i]);
                let binormal = t.cross(normal);
                (0..sides)
                    .map(|k| {
                        let turn = TAU * f64::from(k) / f64::from(sides) + twist * i as f64 / n as f64;
                        let (sin, cos) = turn.sin_cos();
                        self.vertex(path[i].0 + (normal * cos + binormal * sin) * path[i].1)
                    })
                    .collect()
            })
            .collect();
        for i in 0..if closed { n } else { n - 1 } {
            self.band(&rings[(i + 1) % n], &rings[i]);
        }
        if !closed {
            self.cap(rings[0].iter().rev().copied());
            self.cap(rings[n - 1].iter().copied());
        }
    }

    /// A surface of revolution about the y axis from points `(radius, y)`, bottom to top. It is closed where the first
    /// and last radius are 0; a profile that goes up outside and down inside makes a vessel.
    pub(super) fn lathe(&mut self, profile: &[(f64, f64)], sides: u32) {
        let rings: Vec<Vec<u32>> = profile
            .iter()
            .map(|&(r, y)| match r {
                0.0 => vec![self.vertex(at(0.0, y, 0.0)); sides as usize],
                _ => around(sides, r, y).map(|p| self.vertex(p)).collect(),
            })
            .collect();
        rings.windows(2).for_each(|w| self.band(&w[0], &w[1]));
    }

    /// A ball with `rings` bands.
    pub(super) fn ball(&mut self, centre: DVec3, radius: f64, sides: u32, rings: u32) {
        let profile: Vec<(f64, f64)> = (0..=rings)
            .map(|k| match k {
                0 => (0.0, -radius),
                k if k == rings => (0.0, radius),
                k => {
                    let (sin, cos) = (TAU * 0.5 * f64::from(k) / f64::from(rings)).sin_cos();
                    (radius * sin, -radius * cos)
                }
            })
            .collect();
        self.within(DAffine3::from_translation(centre), |b| b.lathe(&profile, sides));
    }

    /// The triangles between two rings of equal length; a pole is a ring of one vertex repeated.
    fn band(&mut self, lower: &[u32], upper: &[u32]) {
        for k in 0..lower.len() {
            let next = (k + 1) % lower.len();
            let pieces = [[lower[k], upper[k], lower[next]], [lower[next], upper[k], upper[next]]];
            self.mesh.triangles.extend(pieces.iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }

    fn cap(&mut self, ring: impl Iterator<Item = u32>) {
        let ring: Vec<u32> = ring.collect();
        self.mesh.triangles.extend(ring[1..].windows(2).map(|w| [ring[0], w[0], w[1]]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::scene::Adjacency;

    #[test]
    fn every_brick_is_closed_and_looks_outward() {
        let ring: Vec<(DVec3, f64)> = around(24, 2.0, 0.5).map(|p| (p + DVec3::Y * p.x * p.z, 0.3)).collect();
        type Part<'a> = (&'a str, &'a dyn Fn(&mut Build));
        let parts: [Part; 6] = [
            ("beam", &|b| b.beam(at(0.3, 0.1, -0.2), at(1.0, 2.0, 3.0), 0.1, 0.2)),
            ("upright beam", &|b| b.beam(at(0.0, 0.0, 0.0), at(0.0, 2.0, 0.0), 0.1, 0.2)),
            ("rod", &|b| b.rod(at(0.3, 0.1, -0.2), at(-1.0, 2.0, 3.0), 0.1, 0.05, 7)),
            ("ring", &|b| b.tube(&ring, 9, true)),
            ("ball", &|b| b.ball(at(1.0, 2.0, 3.0), 0.7, 12, 8)),
            ("vessel", &|b| b.lathe(&[(0.0, 0.0), (1.0, 0.0), (1.2, 1.0), (1.0, 1.0), (0.9, 0.1), (0.0, 0.1)], 16)),
        ];
        for (name, part) in parts {
            let mut b = Build::default();
            part(&mut b);
            assert!(Adjacency::of(&b.mesh).closed, "{name}");
        }
    }

    #[test]
    fn planes_face_up() {
        let mut b = Build::default();
        b.plane(2.0);
        for t in 0..2 {
            let [p, q, r] = b.mesh.corners(t);
            assert!((q - p).cross(r - p).y > 0.0);
        }
    }
}
