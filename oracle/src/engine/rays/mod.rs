//! `ray-traced` on the CPU: a ray from the eye and one to the light for every sample, in single precision, on all cores, as a ray
//! tracer does it (Whitted 1980). What the other methods are timed against where there is no GPU.
//!
//! The tree, its walk and the test of a triangle are those of `obvhs`: a wide tree of quantized boxes (Ylitie, Karras, Laine 2017),
//! Moeller and Trumbore (1997). Nothing is proved: an answer within some 10^-5 of the scene of an edge or a contact may be wrong.
//! [`crate::truth`] is exact.

mod packet;

use crate::truth::{Progress, bits, full_mask, split_mask};
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use packet::{Packet, PacketRay};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use subpixel_shadows::methods::output::Output;
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::scene::{Camera, Light, PixelRays};
use subpixel_shadows::{Error, Result};

/// Half the longest side of the mesh in the units that rays are followed in: `obvhs` drops what is nearer than 10^-4 of them.
const HALF: f64 = 1024.0;

/// Rows and columns of pixels that are followed one after the other.
const TILE: usize = 8;

/// Where a shadow ray begins, relative to the coordinates of its point and the way there: what rounding may have moved that by.
const OFFSET: f32 = 4e-6;

/// From where on a light has no place but a direction, in units of the tree.
const FAR: f64 = 1e12;

/// How far apart the origins of a packet of shadow rays may lie, in such offsets.
const CLOSE: f32 = 1e3;

/// The tree of a mesh, ready for any camera and light.
pub struct CpuRays {
    tree: CwBvh,
    /// Triangles in the order of the leaves, and which of the mesh they are; one may be there several times.
    leaves: Vec<RtTriangle>,
    triangles: Vec<u32>,
    /// World units to those of the tree: subtract, then multiply.
    middle: DVec3,
    scale: f64,
    /// Lowest and highest corner of the mesh, world units.
    bounds: (DVec3, DVec3),
}

impl std::fmt::Debug for CpuRays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CpuRays").field("leaves", &self.triangles.len()).finish_non_exhaustive()
    }
}

/// What the rays of a thread met last, and room for those of a pixel.
#[derive(Default)]
struct Room {
    seen: Option<u32>,
    caster: Option<u32>,
    sights: Packet,
    shadows: Packet,
    /// Samples whose seen side is turned to the light, and their rays to it.
    open: Vec<(u32, PacketRay)>,
}

impl CpuRays {
    /// Builds the tree: time `O(n log n)`, about 120 bytes a triangle.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Mesh`] for a mesh that has not passed its check, [`subpixel_shadows::Error::Config`] for alpha-tested triangles.
    pub fn new(prepared: &Prepared) -> Result<Self> {
        let mesh = prepared.mesh();
        mesh.check("mesh to trace")?;
        if !prepared.alpha().is_empty() {
            return Err(Error::Config(
                "ray-traced on the CPU engine: casters are alpha-tested; on a GPU it takes them".to_owned(),
            ));
        }
        let (low, high) = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let middle = (low + high) * 0.5;
        let size = (high - low).max_element() * 0.5;
        let scale = if size > 0.0 { HALF / size } else { 1.0 };
        let at = |v: u32| ((DVec3::from(mesh.positions[v as usize].map(f64::from)) - middle) * scale).as_vec3a();
        let all: Vec<Triangle> =
            mesh.triangles.iter().map(|t| Triangle { v0: at(t[0]), v1: at(t[1]), v2: at(t[2]) }).collect();
        let tree = match all.is_empty() {
            true => CwBvh::default(),
            false => build_cwbvh_from_tris(&all, BvhBuildParams::slow_build(), &mut Duration::default()),
        };
        let triangles = tree.primitive_indices.clone();
        let leaves = triangles.iter().map(|&t| RtTriangle::from(&all[t as usize])).collect();
        Ok(Self { tree, leaves, triangles, middle, scale, bounds: (low, high) })
    }

    /// Renders a frame: of each sample the nearest surface beyond the near distance and whether something lies between it and the
    /// light; samples on sides turned away from the light are dark. [`Output::wall_ms`] is set, all else that is counted is 0. The
    /// same input gives the same bits, whatever the number of threads.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] for impossible settings, [`subpixel_shadows::Error::Scene`] for an impossible camera or
    /// light.
    pub fn render(&self, settings: &Settings, camera: &Camera, light: &Light, progress: Progress) -> Result<Output> {
        let start = Instant::now();
        settings.check()?;
        camera.check()?;
        light.check()?;
        let mut output = Output::nothing_seen(settings);
        output.counts = Default::default();
        let [width, height] = settings.size.map(|n| n as usize);
        let words = output.words as usize;
        let view = self.view(settings, camera, light);
        let done = AtomicUsize::new(0);
        let chunk = TILE * width;
        let rows = output.visibility.par_chunks_mut(chunk).zip(output.lit.par_chunks_mut(chunk * words));
        rows.zip(output.triangles.par_chunks_mut(chunk)).enumerate().for_each(|(n, ((shares, lit), centres))| {
            let mut room = Room::default();
            for left in (0..width).step_by(TILE) {
                for row in 0..shares.len() / width {
                    for x in left..(left + TILE).min(width) {
                        let p = row * width + x;
                        let found = self.pixel(&view, [x, n * TILE + row], &mut room);
                        shares[p] = found.share;
                        lit[p * words..(p + 1) * words].copy_from_slice(&split_mask(found.lit)[..words]);
                        centres[p] = found.centre;
                    }
                }
            }
            if let Some(progress) = progress {
                let pixels = done.fetch_add(shares.len(), Ordering::Relaxed) + shares.len();
                progress(pixels, width * height);
            }
        });
        output.wall_ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(output)
    }

    fn view(&self, settings: &Settings, camera: &Camera, light: &Light) -> EyeView {
        let rays = camera.rays(settings.size[0], settings.size[1]);
        let (low, high) = self.bounds;
        let corner = |n: u32| DVec3::select(glam::BVec3::new(n & 1 != 0, n & 2 != 0, n & 4 != 0), low, high);
        let depth = |n: u32| (corner(n) - rays.eye).dot(rays.forward);
        let nearest = (0..8).map(depth).fold(f64::INFINITY, f64::min);
        let l = light.homogeneous();
        let at = l.truncate() - self.middle * l.w;
        // A point so far off is a direction, and more than single precision may hold.
        let light = match l.w == 0.0 || at.length() * self.scale > FAR {
            true => (at.normalize().as_vec3a(), false),
            false => ((at * self.scale).as_vec3a(), true),
        };
        EyeView {
            // A little before the mesh, where nothing is.
            start: f64::from(camera.near).max(nearest - 1.0 / self.scale),
            eye: rays.eye,
            rays,
            offsets: settings.samples.offsets().to_vec(),
            light,
        }
    }

    /// Where a sample's ray, which starts at [`EyeView::start`], begins to see surfaces.
    fn begin(&self, view: &EyeView, at: [usize; 2], offset: [f32; 2]) -> f32 {
        if view.rays.near_plane == DVec3::ZERO {
            return 0.0;
        }
        let [x, y] = [0, 1].map(|axis| at[axis] as f64 + f64::from(offset[axis]));
        let begin = (view.rays.begin(view.rays.direction(x, y)) - view.start) * self.scale;
        begin.clamp(0.0, f64::from(f32::MAX)) as f32
    }

    fn pixel(&self, view: &EyeView, at: [usize; 2], room: &mut Room) -> PixelFound {
        let direction = view.rays.direction(at[0] as f64, at[1] as f64);
        let corner = (view.eye + direction * view.start - self.middle) * self.scale;
        let steps = [view.rays.step_x, view.rays.step_y];
        let sights = Sights {
            corner: [corner, direction].map(|v| v.as_vec3a()),
            steps: [steps.map(|s| (s * view.start * self.scale).as_vec3a()), steps.map(|s| s.as_vec3a())],
        };
        let count = view.offsets.len();
        let (mut seen, mut lit, mut centre) = (0u128, 0u128, u32::MAX);
        if count == 1 {
            let [origin, direction] = sights.of(view.offsets[0]);
            let begin = self.begin(view, at, view.offsets[0]);
            if let Some((slot, t)) = self.closest(&Ray::new(origin, direction, begin, f32::INFINITY), room) {
                centre = self.triangles[slot as usize];
                let ray = self.to_light(view, [origin, direction], slot, t);
                (seen, lit) = (1, u128::from(ray.is_some_and(|ray| self.is_free(ray, room))));
            }
        } else {
            let packet = &mut room.sights;
            packet.clear();
            for &offset in &view.offsets {
                let [origin, direction] = sights.of(offset);
                packet.add(PacketRay {
                    origin,
                    direction,
                    begin: self.begin(view, at, offset),
                    end: f32::INFINITY,
                    own: u32::MAX,
                });
            }
            self.follow(packet, room.seen, false);
            room.seen = packet.met(0).map(|met| met.0).or(room.seen);
            centre = packet.met(0).map_or(u32::MAX, |met| self.triangles[met.0 as usize]);
            room.open.clear();
            for (k, &offset) in view.offsets.iter().enumerate() {
                let Some((slot, t)) = packet.met(k) else { continue };
                seen |= 1 << k;
                let ray = self.to_light(view, sights.of(offset), slot, t);
                room.open.extend(ray.map(|ray| (k as u32, ray)));
            }
            lit = self.free(room);
        }
        match seen.count_ones() {
            0 => PixelFound { share: 1.0, lit: u128::MAX, centre },
            n => PixelFound { share: lit.count_ones() as f32 / n as f32, lit, centre },
        }
    }

    /// Samples whose rays to the light nothing stops. Rays whose origins lie close together are followed as one packet.
    fn free(&self, room: &mut Room) -> u128 {
        let (mut left, mut free) = (full_mask(room.open.len() as u32), 0u128);
        while left != 0 {
            let first = &room.open[left.trailing_zeros() as usize].1;
            let (middle, reach) = (first.origin, CLOSE * first.begin);
            let mut members = 0u128;
            room.shadows.clear();
            for n in bits(left) {
                let ray = room.open[n].1;
                if (ray.origin - middle).abs().max_element() <= reach {
                    members |= 1 << n;
                    room.shadows.add(ray);
                }
            }
            self.follow(&mut room.shadows, room.caster, true);
            for (at, n) in bits(members).enumerate() {
                match room.shadows.met(at) {
                    Some((slot, _)) => room.caster = Some(slot),
                    None => free |= 1 << room.open[n].0,
                }
            }
            left &= !members;
        }
        free
    }

    /// Follows a packet; the leaf `first` is tried first.
    fn follow(&self, packet: &mut Packet, first: Option<u32>, any: bool) {
        if let Some(slot) = first {
            packet.test(&self.leaves[slot as usize], slot, self.triangles[slot as usize], any);
        }
        packet.follow(&self.tree, &self.leaves, &self.triangles, any);
    }

    /// The nearest triangle on a ray, as its place among the leaves, and where; the one met last is tried first.
    fn closest(&self, ray: &Ray, room: &mut Room) -> Option<(u32, f32)> {
        let mut hit = RayHit::none();
        let mut short = *ray;
        if let Some(slot) = room.seen {
            let t = self.leaves[slot as usize].intersect(ray);
            if t < f32::INFINITY {
                (hit.primitive_id, hit.t, short.tmax) = (slot, t, t);
            }
        }
        self.tree.ray_traverse(short, &mut hit, |ray, slot| self.leaves[slot].intersect(ray));
        let met = (hit.t < f32::INFINITY).then_some((hit.primitive_id, hit.t));
        room.seen = met.map(|met| met.0);
        met
    }

    /// The ray to the light from where a leaf is met; `None` if its seen side is turned away.
    fn to_light(&self, view: &EyeView, sight: [Vec3A; 2], slot: u32, t: f32) -> Option<PacketRay> {
        let [origin, direction] = sight;
        let point = origin + direction * t;
        let (at, is_point) = view.light;
        let to_light = if is_point { at - point } else { at };
        let normal = self.leaves[slot as usize].ng;
        if normal.dot(direction) * normal.dot(to_light) >= 0.0 {
            return None;
        }
        let distance = to_light.length();
        let begin = OFFSET * (point.abs().max_element() + t * direction.length());
        let end = if is_point { distance } else { f32::INFINITY };
        Some(PacketRay {
            origin: point,
            direction: to_light / distance,
            begin,
            end,
            own: self.triangles[slot as usize],
        })
    }

    /// Whether nothing stops a ray to the light.
    fn is_free(&self, ray: PacketRay, room: &mut Room) -> bool {
        let PacketRay { origin, direction, begin, end, own } = ray;
        let ray = Ray::new(origin, direction, begin, end);
        let blocks = |slot: usize| match self.triangles[slot] == own {
            true => f32::INFINITY,
            false => self.leaves[slot].intersect(&ray),
        };
        if room.caster.is_some_and(|slot| blocks(slot as usize) < f32::INFINITY) {
            return false;
        }
        let mut caster = None;
        self.tree.ray_traverse_miss(ray, |_, slot| {
            let t = blocks(slot);
            if t < f32::INFINITY {
                caster = Some(slot as u32);
                return f32::NEG_INFINITY;
            }
            t
        });
        room.caster = caster.or(room.caster);
        caster.is_none()
    }
}

/// What all pixels need: rays of samples in world units, from where they begin in view depth on, and the light: its direction, or its place
/// in units of the tree.
struct EyeView {
    rays: PixelRays,
    eye: DVec3,
    start: f64,
    offsets: Vec<[f32; 2]>,
    light: (Vec3A, bool),
}

/// Origins and directions of a pixel's rays in units of the tree: of its corner, and their changes for a pixel to the right and down.
struct Sights {
    corner: [Vec3A; 2],
    steps: [[Vec3A; 2]; 2],
}

impl Sights {
    fn of(&self, offset: [f32; 2]) -> [Vec3A; 2] {
        [0, 1].map(|n| self.corner[n] + self.steps[n][0] * offset[0] + self.steps[n][1] * offset[1])
    }
}

/// A pixel's lit share, lit samples, and the triangle at its centre.
struct PixelFound {
    share: f32,
    lit: u128,
    centre: u32,
}
