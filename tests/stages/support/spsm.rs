//! What the tests of the sub-pixel shadow map share: the map of a scene, made on the GPU, and how its records are read.

use super::POISON;
use super::run;
use super::shadow::{World, uniform};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::spsm_map::Coding;
use oracle::reference::view::Flat;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::spsm_code::SlopeCode;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::seen_texels::{SeenTexels, TexelMarks};
use subpixel_shadows::stages::spsm_map::{SpsmMap, SpsmTexels, depth_of_key};
use subpixel_shadows::stages::spsm_query::{SpsmPixels, SpsmQueryOptions};

/// A map, read back.
pub struct Made {
    pub texels: SpsmTexels,
    pub coding: Coding,
    /// Of each texel complement of the triangle and depth key.
    pub keys: Vec<[u32; 2]>,
    pub records: Vec<[u32; 4]>,
}

/// Rounding of places and depths that the kernels reckon with (see shared/spsm_record).
pub fn noise(world: &World) -> [f64; 2] {
    if world.view.map.paraboloid.is_some() {
        // Directions are off by the rounding of points beside their distance.
        return [3e-5 * f64::from(world.view.map.map_size), 4e-6];
    }
    let (map, depth) = (f64::from(world.frame.map_margin), f64::from(world.frame.depth_margin));
    [1.0 / 1024.0 + (map - 1.0 / 64.0) / 32.0, 1e-6 + depth / 32.0]
}

impl Made {
    /// The map of a scene.
    pub fn new(world: &World, lines: bool) -> Self {
        let size = world.view.map.map_size as usize;
        let texels = SpsmTexels::new(&world.gpu.device, &world.gpu.queue, size, pixels(world), 5);
        Self::in_memory(world, lines, texels.expect("memory"))
    }

    /// Likewise with atomics of 32 bits and a list of so many blocks.
    pub fn with_list(world: &World, lines: bool, blocks: usize) -> Self {
        let size = world.view.map.map_size as usize;
        let texels = SpsmTexels::listing(&world.gpu.device, &world.gpu.queue, size, pixels(world), 5, blocks);
        Self::in_memory(world, lines, texels.expect("memory"))
    }

    /// Likewise, in memory of one's own.
    pub fn in_memory(world: &World, lines: bool, texels: SpsmTexels) -> Self {
        let gpu = world.gpu;
        let size = world.view.map.map_size;
        let frame = uniform(gpu, &world.frame);
        for half in &texels.records {
            half.write(&gpu.queue, &vec![[POISON; 4]; half.len()]);
        }
        let stage = SpsmMap::new(&gpu.device, u32::from(lines), &texels);
        let all = SeenTexels::new(&gpu.device, SpsmQueryOptions::default(), &texels);
        with_blocks(world, |blocks| {
            run(gpu, |s| {
                all.record_all(s, &frame, &texels.marks);
                stage.record(s, &frame, blocks, &texels)
            });
        });
        let total: u32 = world.facts.light_items.read(gpu).expect("readback").iter().sum();
        let keys = texels.keys.read(gpu).expect("readback");
        assert!(total > 0 || keys.iter().all(|&k| k == [0; 2]));
        Self {
            coding: Coding { lines, slopes: SlopeCode::new(5), size },
            keys,
            records: texels.records.iter().flat_map(|half| half.read(gpu).expect("readback")).collect(),
            texels,
        }
    }

    /// The triangle of a texel.
    pub fn triangle(&self, texel: usize) -> Option<u32> {
        (self.keys[texel][0] != 0).then(|| !self.keys[texel][0])
    }

    /// Its conservative depth.
    pub fn depth(&self, texel: usize) -> f64 {
        f64::from(depth_of_key(self.keys[texel][1]))
    }
}

/// Pixels of the world's image.
pub fn pixels(world: &World) -> usize {
    (world.view.image[0] * world.view.image[1]) as usize
}

/// The casters' blocks in the light view, for as long as they are needed.
pub fn with_blocks(world: &World, mut work: impl FnMut(Blocks)) {
    let (offsets, args, _) = world.items(&world.facts.light_items.read(world.gpu).expect("readback"));
    work(Blocks {
        triangles: &world.casters.triangles,
        points: &world.map_points,
        rects: &world.facts.light_rects,
        facing: &world.facts.facing,
        offsets: &offsets,
        args: (args.raw(), 0),
    });
}

/// Copies the list of the uncertain pixels to where the recovery reads it.
pub fn take_list(gpu: &Gpu, marks: &TexelMarks, pixels: &SpsmPixels) {
    let mut encoder = gpu.encoder();
    marks.take_list(&mut Recorder::new(&gpu.device, &mut encoder, None), pixels);
    gpu.submit_and_wait(encoder).expect("a copy");
}

/// Middle of a texel.
pub fn middle(texel: usize, size: u32) -> DVec2 {
    let (x, y) = (texel as u32 % size, texel as u32 / size);
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

/// The box in the light view of a pixel's corners on the plane of triangle `t`, or with one sample that of its centre; `None`
/// where one of them has no place there.
pub fn footprint(world: &World, pixel: u32, t: u32, many: bool) -> Option<[DVec2; 2]> {
    let offsets: &[[f64; 2]] = match many {
        true => &[[0.0, 0.0], [-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]],
        false => &[[0.0, 0.0]],
    };
    let mut reached = [DVec2::MAX, DVec2::MIN];
    for offset in offsets {
        let p = on_plane(world, pixel, t, DVec2::from(*offset))?.truncate();
        reached = [reached[0].min(p), reached[1].max(p)];
    }
    Some(reached)
}

/// The place in the light view of the point of triangle `t`'s plane at an offset from a pixel's centre.
pub fn on_plane(world: &World, pixel: u32, t: u32, offset: DVec2) -> Option<DVec3> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a);
    let ray = pixel_ray(&world.view, pixel, offset);
    let depth = normal.dot(a) / normal.dot(ray);
    (depth > 0.0).then(|| world.view.on_map(ray * depth)).flatten().map(|p| p.truncate())
}

/// Whether triangle `t` turns its other side to the light than to the eye; `None` where that is too close to call.
pub fn faces_away(world: &World, t: u32) -> Option<bool> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let (towards_light, towards_eye) = (world.view.side([a, b, c]), -(b - a).cross(c - a).dot(a));
    let size = (b - a).length() * (c - a).length();
    let clear = towards_light.abs() >= 1e-4 * size && towards_eye.abs() >= 1e-4 * size * a.length();
    clear.then_some(towards_light * towards_eye < 0.0)
}

/// A receiver as the definition takes it: places of the samples in the light view, its slope there, and the depth of its
/// triangle's farthest corner.
pub fn receiver(world: &World, pixel: u32, t: u32) -> Option<(Vec<Option<DVec3>>, DVec2, f64)> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let on_plane = |offset: DVec2| on_plane(world, pixel, t, offset);
    // On a paraboloid it is another at every place.
    let by = if world.view.map.paraboloid.is_some() { 1e-4 } else { 1.0 };
    let around = [[-0.5, -0.5], [0.5, -0.5], [0.0, 0.5]].map(|o| on_plane(DVec2::from(o) * by));
    let [Some(p), Some(q), Some(r)] = around else { return None };
    let slope = Flat::new([p, q, r]).slope?;
    let places = world.samples.offsets().iter().map(|o| on_plane(DVec2::from(o.map(f64::from)) - 0.5)).collect();
    // A corner that is not in front of the light lies as far as can be.
    let far = [a, b, c].map(|p| world.view.on_map(p).map_or(3e38, |p| p.z)).into_iter().fold(f64::MIN, f64::max);
    Some((places, slope.clamp(DVec2::splat(-1000.0), DVec2::splat(1000.0)), far))
}
