//! Maps of slices of what the camera sees: made, and where points of a receiver lie in them.

use super::run;
use super::shadow::{Pipelines, World, uniform};
use subpixel_shadows::glam::{DVec2, DVec3, DVec4};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::light_view::{SeenBox, SplitPlan, SplitView, Warp};
use subpixel_shadows::reference::facet_classify::pixel_ray;
use subpixel_shadows::stages::split_maps::{Maps, SplitMapInputs, SplitMaps, SplitViews};

/// How the texels lie over a slice.
pub const WARPS: [Warp; 5] = [Warp::Whole, Warp::Box, Warp::Trapezoid, Warp::LightSpace, Warp::Fitted];

/// The slices of a world, and their maps.
pub struct OnSplits {
    pub views: Vec<SplitView>,
    pub far: f64,
    pub splits: Buffer<SplitViews>,
    pub maps: Maps,
    pub keys: Vec<u32>,
}

/// A plan with the usual focus.
pub fn plan(splits: u32, warp: Warp) -> SplitPlan {
    SplitPlan { splits, warp, focus: 0.6 }
}

impl OnSplits {
    /// Cuts what is seen and makes the maps.
    pub fn of(world: &World, plan: &SplitPlan) -> Self {
        Self::made(world, plan, true)
    }

    /// The rectangles of the triangles alone.
    pub fn measured(world: &World, plan: &SplitPlan) -> Maps {
        Self::made(world, plan, false).maps
    }

    fn made(world: &World, plan: &SplitPlan, raster: bool) -> Self {
        static MADE: Pipelines<SplitMaps> = Pipelines::new();
        let gpu = world.gpu;
        let (map, view) = (&world.view.map, &world.view);
        let bounds = world.prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let near = f64::from(world.camera.near);
        let seen = SeenBox::new(&view.rays, view.image, near, bounds, view.scale);
        let views = map.split(&seen, plan);
        let far = SplitViews::farthest(map, seen.box_corners());
        let splits = Buffer::uniform(&gpu.device, "test.split_views", 1).expect("memory");
        splits.write(&gpu.queue, &[SplitViews::new(&views, map.map_size, far)]);
        let size = map.map_size as usize;
        let count = world.casters.triangles.len();
        let maps = Maps::new(&gpu.device, &gpu.queue, views.len(), size, count).expect("memory");
        let (frame, points) = (uniform(gpu, &world.frame), world.points());
        let mesh = SplitMapInputs {
            triangles: &world.casters.triangles,
            points: &points,
            light_rects: &world.facts.light_rects,
        };
        let stage = MADE.get(gpu, 0, || SplitMaps::new(&gpu.device));
        run(gpu, |s| match raster {
            true => stage.record(s, &frame, &splits, mesh, &maps),
            false => {
                stage.measure(s, &frame, &splits, mesh, &maps);
                Ok(())
            }
        });
        let keys = maps.keys.read(gpu).expect("readback");
        Self { views, far, splits, maps, keys }
    }

    /// Depths of one of the maps.
    pub fn depths(&self, view: usize) -> Vec<Option<f64>> {
        let texels = self.keys.len() / self.views.len();
        let depth = |&key: &u32| (key != 0).then(|| f64::from(f32::from_bits(!key)));
        self.keys[view * texels..(view + 1) * texels].iter().map(depth).collect()
    }

    /// The slices that a view depth may lie in.
    pub fn slices(&self, depth: f64) -> Vec<usize> {
        let of = |depth: f64| self.views.iter().position(|v| depth < v.end).unwrap_or(self.views.len() - 1);
        let mut found = vec![of(depth * (1.0 - 1e-5)), of(depth * (1.0 + 1e-5))];
        found.dedup();
        found
    }
}

/// By how many texels of a slice's map rounding may move a point.
pub fn rounding(world: &World, split: &SplitView) -> f64 {
    let noise = |row: DVec4| 2f64.powi(-20) * row.abs().element_sum();
    let [x, y, w] = split.rows.map(noise);
    let divisor = if world.view.map.perspective { world.view.map.near } else { 1.0 };
    (x.max(y) + w * f64::from(world.view.map.map_size)) / divisor
}

/// Where the ray through a place of a pixel (offset from its centre) meets the plane of triangle `t`.
pub fn on_plane(world: &World, pixel: u32, t: u32, offset: DVec2) -> Option<DVec3> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a);
    let ray = pixel_ray(&world.view, pixel, offset);
    let depth = normal.dot(a) / normal.dot(ray);
    (depth > 0.0).then_some(ray * depth)
}

/// Texels of a point in a slice's map.
pub fn in_split(split: &SplitView, p: DVec3) -> Option<DVec2> {
    let [x, y, w] = split.rows.map(|row| row.dot(p.extend(1.0)));
    (w > 0.0).then(|| DVec2::new(x, y) / w)
}
