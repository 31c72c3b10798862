//! Stages that ask a map of nearest depths, and how they are judged: pixel by pixel against `f64` on the same map.

use super::shadow::{World, uniform};
use super::spsm::{faces_away, noise, receiver};
use super::{POISON, run};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::{Buffer, Stage};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::light_layers::{Layers, LightLayers};
use subpixel_shadows::stages::paraboloid_casters::{CurvedWork, ParaboloidCasters};
use subpixel_shadows::wgpu;

/// The device of a world, its map's side, and whether some of its casters have holes.
fn parts(world: &World) -> (&wgpu::Device, usize, bool) {
    (&world.gpu.device, world.view.map.map_size as usize, !world.prepared.alpha().is_empty())
}

fn depth_of(key: u32) -> Option<f64> {
    (key != 0).then(|| f64::from(f32::from_bits(!key)))
}

/// Keys of the map of a world in a paraboloid view.
pub fn curved_keys(world: &World) -> Vec<u32> {
    let (device, size, holes) = parts(world);
    let gpu = world.gpu;
    let work = CurvedWork::new(device, &gpu.queue, world.triangles.len(), size as u32).expect("memory");
    let keys = Buffer::<u32>::storage(device, "test.keys", size * size).expect("memory");
    work.rects.write(&gpu.queue, &vec![[POISON; 2]; work.rects.len()]);
    let (frame, points) = (uniform(gpu, &world.frame), world.points());
    let stage = ParaboloidCasters::new(device, holes);
    let mesh = (&world.casters.triangles, &points);
    run(gpu, |s| stage.record(s, &frame, mesh, &work, (&keys, size as u32)).expect("recorded"));
    keys.read(gpu).expect("readback")
}

/// What a stage made of the map of a world.
pub struct OnMap {
    pub depths: Vec<Option<f64>>,
    pub visibility: Vec<f32>,
    pub seen: Vec<Option<u32>>,
}

impl OnMap {
    /// Makes the map, and records what takes it: the frame, what pixels see, the depths, and where visibility goes.
    pub fn of(
        world: &World,
        record: impl Fn(&mut Stage, &Buffer<Frame>, PrimaryHits, &Buffer<u32>, &Buffer<f32>),
    ) -> Self {
        let (device, size, holes) = parts(world);
        let map = Layers::nearest_only(device, size).expect("memory");
        if world.view.map.paraboloid.is_some() {
            let keys = Buffer::from_slice(device, &world.gpu.queue, "test.keys", &curved_keys(world)).expect("memory");
            return Self::asked(world, &keys, record);
        }
        Self::with(world, &LightLayers::nearest_only(device, holes), &map, 1, record)
    }

    /// The same of a map that keeps triangles, complements of which are recorded in place of the depths; and they.
    pub fn of_triangles(
        world: &World,
        record: impl Fn(&mut Stage, &Buffer<Frame>, PrimaryHits, &Buffer<u32>, &Buffer<f32>),
    ) -> (Self, Vec<Option<u32>>) {
        let (device, size, holes) = parts(world);
        let map = Layers::without_marks(device, size).expect("memory");
        let layers = LightLayers::with_triangles(device, holes);
        let on = Self::with(world, &layers, &map, 2, |s, frame, seen, _, to| {
            record(s, frame, seen, &map.second_keys, to);
        });
        let keys = map.second_keys.read(world.gpu).expect("readback");
        (on, keys.into_iter().map(|key| (key != 0).then_some(!key)).collect())
    }

    /// The two nearest depths of each texel.
    pub fn two_depths(world: &World) -> [Vec<Option<f64>>; 2] {
        let (device, size, holes) = parts(world);
        let map = Layers::without_marks(device, size).expect("memory");
        let on = Self::with(world, &LightLayers::without_marks(device, holes), &map, 1, |_, _, _, _, _| {});
        let second = map.second_keys.read(world.gpu).expect("readback");
        [on.depths, second.into_iter().map(depth_of).collect()]
    }

    fn with(
        world: &World,
        layers: &LightLayers,
        map: &Layers,
        runs: u32,
        record: impl Fn(&mut Stage, &Buffer<Frame>, PrimaryHits, &Buffer<u32>, &Buffer<f32>),
    ) -> Self {
        let gpu = world.gpu;
        let (offsets, args, _) = world.items(&world.facts.light_items.read(gpu).expect("readback"));
        let blocks = Blocks {
            triangles: &world.casters.triangles,
            points: &world.map_points,
            rects: &world.facts.light_rects,
            facing: &world.facts.facing,
            offsets: &offsets,
            args: (args.raw(), 0),
        };
        let frame = uniform(gpu, &world.frame);
        for k in 0..runs {
            if k > 0 {
                map.second_keys.write(&gpu.queue, &vec![0; map.second_keys.len()]);
            }
            run(gpu, |s| layers.record(s, &frame, blocks, map));
        }
        Self::asked(world, &map.nearest_keys, record)
    }

    /// The same of a map of these keys.
    fn asked(
        world: &World,
        nearest_keys: &Buffer<u32>,
        record: impl Fn(&mut Stage, &Buffer<Frame>, PrimaryHits, &Buffer<u32>, &Buffer<f32>),
    ) -> Self {
        let gpu = world.gpu;
        let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
        let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
        let id_keys = Buffer::from_slice(&gpu.device, &gpu.queue, "test.ids", &keys).expect("memory");
        let visibility = Buffer::<f32>::storage(&gpu.device, "test.visibility", seen.len()).expect("memory");
        visibility.write(&gpu.queue, &vec![f32::from_bits(POISON); seen.len()]);
        let (frame, offsets, points) = (uniform(gpu, &world.frame), world.sample_offsets(), world.points());
        let triangles = &world.casters.triangles;
        run(gpu, |s| {
            let from = PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles, points: &points };
            record(s, &frame, from, nearest_keys, &visibility);
        });
        Self {
            depths: nearest_keys.read(gpu).expect("readback").into_iter().map(depth_of).collect(),
            visibility: visibility.read(gpu).expect("readback"),
            seen,
        }
    }

    /// Where visibility is not within what `share` gives at each sample's place: least and greatest, of a place, that of the
    /// pixel's first sample, the receiver's slope, and how far place and depth may be off. How many pixels were compared and how
    /// many of them closely.
    pub fn fault(
        &self,
        world: &World,
        share: impl Fn(DVec3, DVec2, DVec2, f64, f64) -> [f64; 2],
    ) -> std::result::Result<[u64; 2], String> {
        let [place, depth] = noise(world);
        self.fault_of_pixels(world, |pixel, t| {
            let (places, slope, _) = receiver(world, pixel, t)?;
            // Depths of the receiver that rounding may give.
            let doubt = depth + 2e-6 + (slope.x.abs() + slope.y.abs()) * place * 2.0;
            let (mut low, mut high, mut seen) = (0.0, 0.0, 0.0);
            let first = places.iter().flatten().next().map_or(DVec2::ZERO, |p| p.truncate());
            for p in places.iter().flatten() {
                let [least, greatest] = share(*p, first, slope, place, doubt);
                (low, high, seen) = (low + least, high + greatest, seen + 1.0);
            }
            (seen > 0.0).then(|| [low / seen - 1e-5, high / seen + 1e-5])
        })
    }

    /// Where visibility is not within what `share` gives of a pixel and the triangle that it sees from the light's side, where it can be told.
    /// How many pixels were compared and how many of them closely.
    pub fn fault_of_pixels(
        &self,
        world: &World,
        share: impl Fn(u32, u32) -> Option<[f64; 2]>,
    ) -> std::result::Result<[u64; 2], String> {
        let (mut compared, mut close) = (0, 0);
        for (pixel, &v) in self.visibility.iter().enumerate() {
            let at = format!("pixel {pixel}, visibility {v}");
            let Some(t) = self.seen[pixel] else {
                if v != 1.0 {
                    return Err(format!("{at}: nothing is seen"));
                }
                continue;
            };
            let Some(dark) = faces_away(world, t) else { continue };
            if dark {
                if v != 0.0 {
                    return Err(format!("{at}: it faces away from the light"));
                }
                continue;
            }
            let Some([low, high]) = share(pixel as u32, t) else { continue };
            compared += 1;
            close += u64::from(high - low < 0.05);
            if !(low..=high).contains(&f64::from(v)) {
                return Err(format!("{at}: {low} to {high} expected"));
            }
        }
        Ok([compared, close])
    }
}
