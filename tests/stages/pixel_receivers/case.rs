//! Textures that an application hands over, in patches of all kinds.

use super::*;

/// Textures that an application hands over, and the casters that it sees.
#[derive(Clone)]
pub struct Case {
    pub depths: Option<(Vec<f32>, [f32; 4], f32)>,
    pub positions: Vec<[f32; 4]>,
    pub normals: Option<Vec<[f32; 4]>>,
    pub ids: Option<(Vec<u32>, u32, u32, Vec<u32>)>,
    pub seen: Vec<Option<u32>>,
    /// Where textures are multisampled.
    pub sample: Option<samples::GivenSample>,
}

impl Case {
    /// Casters as they are seen, parts of them moved, a plane, and nothing, in patches.
    pub fn new(world: &World, random: &mut Random) -> Self {
        Self::new_at(world, random, [0.5; 2])
    }

    /// Likewise, given there in each pixel.
    pub fn new_at(world: &World, random: &mut Random, [x, y]: [f64; 2]) -> Self {
        let seen: Vec<_> = world.seen().into_iter().map(|(_, t)| t).collect();
        let [w, h] = world.view.image;
        let (normal, offset) = (vector(random).normalize(), 2.0 + 3.0 * unit(random));
        let mut depths = Vec::new();
        for pixel in 0..w * h {
            let ray = world.view.rays.direction(f64::from(pixel % w) + x, f64::from(pixel / w) + y);
            let on = |t: u32| {
                let [a, b, c] = world.triangles[t as usize].corners?;
                let n = (b - a).cross(c - a);
                Some(n.dot(a) / n.dot(ray) / world.view.scale)
            };
            let plane = offset / (1.5 + normal.dot(ray));
            let depth = match (pixel % w / 5 + pixel / w / 4) % 4 {
                0 => None,
                1 => Some(plane),
                _ if random.below(40) == 0 => None,
                // One that lies behind or before others.
                2 if random.below(3) == 0 => {
                    let on_ray = |t: &u32| {
                        let Some([a, b, c]) = world.triangles[*t as usize].corners else { return false };
                        let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| p.cross(q).dot(ray));
                        sides.iter().all(|&v| v > 0.0) || sides.iter().all(|&v| v < 0.0)
                    };
                    let all: Vec<u32> = (0..world.triangles.len() as u32).filter(on_ray).collect();
                    all.get(random.below(all.len().max(1) as u32) as usize).copied().and_then(on)
                }
                k => seen[pixel as usize].and_then(on).map(|z| if k == 2 { z } else { z * 1.25 }),
            };
            depths.push(depth.filter(|z| *z > 1e-3 && *z < 1e3));
        }
        let value = |z: f64| ((f64::from(TERMS[0]) * z + f64::from(TERMS[1])) / z) as f32;
        let position = |(pixel, z): (usize, &Option<f64>)| {
            let ray = world.view.rays.direction((pixel % w as usize) as f64 + x, (pixel / w as usize) as f64 + y);
            z.map_or([0.0; 4], |z| (world.view.rays.eye + ray * z).as_vec3().extend(1.0).into())
        };
        Self {
            positions: depths.iter().enumerate().map(position).collect(),
            depths: Some((depths.iter().map(|z| z.map_or(0.0, value)).collect(), TERMS, 0.0)),
            normals: None,
            ids: None,
            seen,
            sample: None,
        }
    }

    pub fn by_position(mut self) -> Self {
        self.depths = None;
        self
    }

    pub fn with_normals(mut self, random: &mut Random) -> Self {
        let normal = |_| (vector(random) * 2.0).as_vec3().extend(0.0).into();
        self.normals = Some((0..self.seen.len()).map(normal).collect());
        self
    }

    /// Numbers from 10 on, none being 3.
    pub fn with_ids(mut self, casters: u32, random: &mut Random) -> Self {
        let numbers: Vec<u32> = (0..casters).rev().collect();
        let of = |t: &Option<u32>| match t {
            Some(t) if random.below(3) > 0 => 10 + casters - 1 - t,
            _ if random.below(30) == 0 => random.below(10),
            _ => 3,
        };
        let texels = self.seen.iter().map(of).collect();
        self.ids = Some((texels, 10, 3, numbers));
        self
    }

    pub fn given(&self) -> GbufferTexels<'_> {
        let places = match &self.depths {
            Some((values, terms, nothing)) => PositionSource::Depths { values, terms: *terms, nothing: *nothing },
            None => PositionSource::Positions(&self.positions),
        };
        let ids: Option<Ids> = self.ids.as_ref().map(|(t, first, none, n)| (&t[..], *first, *none, &n[..]));
        let at = self.sample.map_or([0.5; 2], |sample| sample.at).map(f64::from);
        GbufferTexels { places, normals: self.normals.as_deref(), ids, tolerance: f64::from(TOLERANCE), at }
    }

    pub fn wanted(&self, world: &World) -> Vec<ReceiverPixel> {
        let corners: Vec<_> = world.triangles.iter().map(|t| t.corners).collect();
        pixels(&world.view, &corners, &self.seen, &self.given())
    }
}
