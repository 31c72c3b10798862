//! Parts of the scene's box that the camera sees, convex, and points all over them.

use super::LightView;
use super::casters::clip;
use crate::scene::PixelRays;
use glam::{DVec2, DVec3, DVec4};

/// View frustum of the camera and bounding box of the scene, in the space of the view's rows; the eye is the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenBox {
    /// Rays through the corners of the image, in turn; view depth 1.
    pub corners: [DVec3; 4],
    /// Unit view direction.
    pub forward: DVec3,
    /// The line of view depth 1 about which it lies: the view direction, or the middle of a face of the frustum.
    pub axis: DVec3,
    /// Normals of planes through the eye, to their inside, between which it lies; 0 where there are none.
    pub wedge: [DVec3; 2],
    /// Nearest view depth that is seen.
    pub near: f64,
    /// Lowest and highest corner of the box.
    pub bounds: (DVec3, DVec3),
}

impl SeenBox {
    /// Frustum of an image of this size and the box `bounds` of the world, lengths times `scale`.
    pub fn new(rays: &PixelRays, [w, h]: [u32; 2], near: f64, bounds: (DVec3, DVec3), scale: f64) -> Self {
        Self {
            corners: rays.corners(w, h),
            forward: rays.forward,
            axis: rays.forward,
            wedge: [DVec3::ZERO; 2],
            near: near * scale,
            bounds: ((bounds.0 - rays.eye) * scale, (bounds.1 - rays.eye) * scale),
        }
    }

    /// Corners of the box.
    pub fn box_corners(&self) -> impl Iterator<Item = DVec3> {
        let (lo, hi) = self.bounds;
        (0..8).map(move |k| DVec3::from_array([0, 1, 2].map(|a| if k >> a & 1 == 1 { hi[a] } else { lo[a] })))
    }

    /// Normal, to the inside, of one of the four planes through the eye and a side of the image.
    pub(super) fn side(&self, k: usize) -> DVec3 {
        let normal = self.corners[k].cross(self.corners[(k + 1) % 4]);
        normal * normal.dot(self.corners[(k + 2) % 4]).signum()
    }

    /// Points all over the part between two view depths that lies in `view`, three on each of 64 rays through the image that meet it,
    /// in the far part of what the ray passes, where it is likelier to meet a surface than before it: their texels, and there the
    /// width of a texel of `view` beside that of a pixel, but for a factor.
    pub(super) fn probes(&self, view: &LightView, from: f64, to: f64) -> Vec<(DVec2, f64)> {
        const SIDE: u32 = 8;
        const ALONG: [f64; 3] = [0.6, 0.8, 1.0];
        let share = |k: u32| (f64::from(k) + 0.5) / f64::from(SIDE);
        let [a, b, c, d] = self.corners;
        let ray = |k: u32| a.lerp(b, share(k % SIDE)).lerp(d.lerp(c, share(k % SIDE)), share(k / SIDE));
        let probe = |p: DVec3| {
            let texel = view.project(p)?.truncate();
            let w = if view.perspective { view.w.dot(p.extend(1.0)) } else { 1.0 };
            Some((texel, w / p.dot(self.forward)))
        };
        let on_ray = |k: u32| {
            let (ray, depths) = (ray(k), self.depths_along(ray(k), view, from, to));
            let points = depths.map(|[near, far]| ALONG.map(|share| ray * (near + (far - near) * share)));
            points.into_iter().flatten().filter_map(probe)
        };
        (0..SIDE * SIDE).flat_map(on_ray).collect()
    }

    /// Between which depths a ray, of view depth 1, passes the part between two view depths that lies in `view`; `None` if it does not.
    fn depths_along(&self, ray: DVec3, view: &LightView, from: f64, to: f64) -> Option<[f64; 2]> {
        let side = f64::from(view.map_size);
        let (lo, hi) = self.bounds;
        let (mut near, mut far) = (from, to);
        // Inside where `at + change * depth` is not below 0.
        let mut cut = |at: f64, change: f64| {
            if change > 0.0 {
                near = near.max(-at / change);
            } else if change < 0.0 {
                far = far.min(-at / change);
            } else if at < 0.0 {
                far = f64::NEG_INFINITY;
            }
        };
        for k in 0..3 {
            cut(-lo[k], ray[k]);
            cut(hi[k], -ray[k]);
        }
        for normal in self.wedge {
            cut(0.0, normal.dot(ray));
        }
        let mut row = |row: DVec4, less: f64| cut(row.w - less, row.truncate().dot(ray));
        row(view.u, 0.0);
        row(view.v, 0.0);
        row(view.w * side - view.u, 0.0);
        row(view.w * side - view.v, 0.0);
        if view.perspective {
            row(view.w, view.near * (1.0 + 1e-9));
        }
        (near <= far).then_some([near, far])
    }

    /// Corners of the part between two view depths that lies in `view`.
    pub(super) fn part(&self, view: &LightView, from: f64, to: f64) -> Vec<DVec3> {
        let (lo, hi) = self.bounds;
        let side = f64::from(view.map_size);
        let row = |r: DVec4, p: DVec3| r.dot(p.extend(1.0));
        // Inside where none is below 0. The sides of the image come first, then the depths, the box and the view.
        let inside = |plane: usize, p: DVec3| match plane {
            k @ 0..4 => self.side(k).dot(p),
            4 => p.dot(self.forward) - from,
            5 => to - p.dot(self.forward),
            k @ 6..9 => p[k - 6] - lo[k - 6],
            k @ 9..12 => hi[k - 9] - p[k - 9],
            12 => row(view.u, p),
            13 => row(view.v, p),
            14 => side * row(view.w, p) - row(view.u, p),
            15 => side * row(view.w, p) - row(view.v, p),
            k @ 16..18 => self.wedge[k - 16].dot(p),
            // A little more: these corners are projected.
            _ if view.perspective => row(view.w, p) - view.near * (1.0 + 1e-9),
            _ => 0.0,
        };
        let quad = |k: usize, at: &dyn Fn(usize) -> DVec3| (k, [0, 1, 2, 3].map(at).to_vec());
        let mut faces: Vec<(usize, Vec<DVec3>)> = Vec::new();
        for k in 0..4 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 4]);
            faces.push(quad(k, &|i| [a * from, b * from, b * to, a * to][i]));
        }
        faces.push(quad(4, &|i| self.corners[i] * from));
        faces.push(quad(5, &|i| self.corners[i] * to));
        for axis in 0..3 {
            let (s, t) = ((axis + 1) % 3, (axis + 2) % 3);
            for (own, at) in [(6 + axis, lo[axis]), (9 + axis, hi[axis])] {
                let corner = |i: usize| {
                    let mut p = DVec3::ZERO;
                    p[axis] = at;
                    p[s] = if i == 1 || i == 2 { hi[s] } else { lo[s] };
                    p[t] = if i >= 2 { hi[t] } else { lo[t] };
                    p
                };
                faces.push(quad(own, &corner));
            }
        }
        for (own, face) in &mut faces {
            for plane in (0..19).filter(|p| p != own) {
                clip(face, |p| inside(plane, p));
            }
        }
        faces.into_iter().flat_map(|(_, face)| face).collect()
    }
}
