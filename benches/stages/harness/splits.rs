//! The slices of the frame of [`Setup`](super::geometry::Setup): three, fitted to what is seen, their maps and moments.

use super::geometry::{IMAGE, MAP, Setup};
use std::rc::Rc;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::light_view::{LightView, SeenBox, SplitPlan, Warp, unit_scale};
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::stages::map_moments::MapMoments;
use subpixel_shadows::stages::split_maps::{Maps, SplitMapInputs, SplitMaps, SplitViews};
use subpixel_shadows::{Error, Result};

/// Slices.
pub const VIEWS: usize = 3;

/// The slices, their maps and moments, made once.
pub struct Splits {
    pub setup: Rc<Setup>,
    pub views: Buffer<SplitViews>,
    pub maps: Maps,
    pub moments: Buffer<[f32; 2]>,
    /// Blocks of triangles in all maps.
    pub blocks: usize,
    pub make: SplitMaps,
    pub reduce: MapMoments,
}

impl Splits {
    /// A frame of about `size` triangles; `None` above what [`Setup`] makes.
    pub fn new(gpu: &Gpu, size: usize) -> Result<Option<Self>> {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(None) };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let bounds = setup.prepared.mesh().bounds().ok_or_else(|| Error::Scene("no mesh".to_owned()))?;
        let light = Light::Point { position: [2.0, 4.0, 1.0] };
        let camera = Camera::framing(bounds.0, bounds.1);
        let rays = camera.rays(IMAGE[0], IMAGE[1]);
        let scale = unit_scale(rays.eye, bounds);
        let view = LightView::fit(setup.prepared.mesh(), &light, MAP)?.relative_to(rays.eye, scale);
        let seen = SeenBox::new(&rays, IMAGE, f64::from(camera.near), bounds, scale);
        let plan = SplitPlan { splits: VIEWS as u32, warp: Warp::Fitted, focus: 0.6 };
        let views = Buffer::uniform(device, "bench.splits", 1)?;
        views.write(queue, &[SplitViews::of_view(&view, &seen, &plan)]);
        let maps = Maps::new(device, queue, VIEWS, MAP as usize, setup.casters.triangles.len())?;
        let moments = MapMoments::memory(device, VIEWS, MAP)?;
        let (make, reduce) = (SplitMaps::new(device), MapMoments::new(device));
        let mut made = Self { setup, views, maps, moments, blocks: 0, make, reduce };
        let mut encoder = gpu.encoder();
        {
            let mut rec = Recorder::new(device, &mut encoder, None);
            let mut stage = rec.stage("setup");
            made.record_maps(&mut stage)?;
            made.record_moments(&mut stage)?;
        }
        gpu.submit_and_wait(encoder)?;
        made.blocks = made.maps.items.read(gpu)?.iter().map(|&n| n as usize).sum();
        Ok(Some(made))
    }

    /// Records the maps.
    pub fn record_maps(&self, stage: &mut subpixel_shadows::gpu::Stage) -> Result<()> {
        let setup = &self.setup;
        let mesh = SplitMapInputs {
            triangles: &setup.casters.triangles,
            points: &setup.points,
            light_rects: &setup.facts.light_rects,
        };
        self.make.record(stage, &setup.frame, &self.views, mesh, &self.maps)
    }

    /// Records the moments.
    pub fn record_moments(&self, stage: &mut subpixel_shadows::gpu::Stage) -> Result<()> {
        let frame = &self.setup.frame;
        self.reduce.record(stage, frame, &self.views, &self.maps.keys, &self.moments, VIEWS, MAP);
        Ok(())
    }
}
