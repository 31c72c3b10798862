//! The three stages of warped axes, run one after another, and what they left.

use super::pages::BIAS;
use super::shadow::{World, uniform};
use super::spsm::with_blocks;
use super::{POISON, run};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::axis_density::{AxisDensity, AxisTables, DensityRule};
use subpixel_shadows::stages::warped_casters::{WarpedCasters, WarpedTexels};
use subpixel_shadows::stages::warped_query::WarpedQuery;

/// Words that are read back.
pub struct Warped {
    pub rule: DensityRule,
    pub stretch: u32,
    pub seen: Vec<Option<u32>>,
    pub requests: Vec<u32>,
    pub densities: Vec<u32>,
    pub axes: Vec<u32>,
    pub borders: Vec<f32>,
    pub keys: Vec<u32>,
    pub visibility: Vec<f32>,
}

impl Warped {
    /// Runs the stages on a world.
    pub fn new(world: &World, rule: DensityRule, stretch: u32) -> Self {
        let gpu = world.gpu;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let map = world.view.map.map_size;
        let density = AxisDensity::new(device, rule, stretch).expect("a stretch");
        let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
        let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
        let id_keys = Buffer::from_slice(device, queue, "test.ids", &keys).expect("memory");
        let tables = AxisTables::new(device, map).expect("memory");
        for poisoned in [&tables.densities, &tables.axes] {
            poisoned.write(queue, &vec![POISON; poisoned.len()]);
        }
        tables.borders.write(queue, &vec![f32::from_bits(POISON); tables.borders.len()]);
        let holes = !world.prepared.alpha().is_empty();
        let texels = WarpedTexels::new(device, queue, world.triangles.len(), map).expect("memory");
        let visibility = Buffer::<f32>::storage(device, "test.visibility", seen.len()).expect("memory");
        visibility.write(queue, &vec![f32::from_bits(POISON); seen.len()]);
        let (points, frame, offsets) = (world.points(), uniform(gpu, &world.frame), world.sample_offsets());
        let from =
            PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
        let casters = WarpedCasters::new(device, holes);
        let query = WarpedQuery::new(device, BIAS);
        run(gpu, |s| {
            density.record_request(s, &frame, from, &tables);
            density.record_shape(s, &frame, map, &tables)
        });
        with_blocks(world, |blocks| run(gpu, |s| casters.record(s, &frame, blocks, &tables, &texels)));
        run(gpu, |s| query.record(s, &frame, from, (&tables, &texels), &visibility));
        let read = |buffer: &Buffer<u32>| buffer.read(gpu).expect("readback");
        Self {
            rule,
            stretch,
            seen,
            requests: read(&tables.requests),
            densities: read(&tables.densities),
            axes: read(&tables.axes),
            borders: tables.borders.read(gpu).expect("readback"),
            keys: read(&texels.keys),
            visibility: visibility.read(gpu).expect("readback"),
        }
    }

    /// Borders of an axis.
    pub fn borders_of(&self, axis: usize) -> Vec<f64> {
        let across = self.borders.len() / 2;
        self.borders[axis * across..][..across].iter().map(|&border| f64::from(border)).collect()
    }

    /// Nearest depth of each texel.
    pub fn depths(&self) -> Vec<Option<f64>> {
        self.keys.iter().map(|&key| (key != 0).then(|| f64::from(f32::from_bits(!key)))).collect()
    }
}
