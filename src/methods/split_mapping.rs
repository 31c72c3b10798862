//! Shadow maps fitted to what the camera sees, or filtered by their moments, and both: `variance` (Donnelly, Lauritzen 2006),
//! `trapezoidal` (Martin, Tan 2004), `lispsm` (Wimmer, Scherzer, Purgathofer 2004), `parallel-split` (Zhang et al. 2006), and `remix`
//! (Oliveira 2009), which is warps, splits and moments together.
//! Memory is fixed: 4 bytes a texel and split, of moments 2.7 more, and 18 a triangle and split. Triangles that reach behind a point light cast nothing.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, FrameInputs, MethodParts, StageInputs};
use super::settings::Settings;
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder, Uploads};
use crate::light_view::{SeenBox, SplitPlan, Warp, unit_scale};
use crate::stages::PrimaryHits;
use crate::stages::map_moments::MapMoments;
use crate::stages::split_maps::{Maps, SplitMapInputs, SplitMaps, SplitViews};
use crate::stages::split_shadows::{OfMaps, SplitQuery, SplitShadows};

/// The method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// One even map of the whole light view, by its moments.
    Variance,
    /// One map over a trapezoid around what is seen.
    Trapezoidal,
    /// The same, warped so that the greatest error is least.
    LightSpace,
    /// An even map around what is seen of each slice.
    ParallelSplit,
    /// A warped map of each slice, by its moments.
    Remix,
}

impl Recipe {
    fn plan(self, settings: &Settings) -> SplitPlan {
        let split = &settings.split;
        let (splits, warp) = match self {
            Self::Variance => (1, Warp::Whole),
            Self::Trapezoidal => (1, Warp::Trapezoid),
            Self::LightSpace => (1, Warp::LightSpace),
            Self::ParallelSplit => (split.splits, Warp::Box),
            Self::Remix => (split.splits, split.warp),
        };
        SplitPlan { splits, warp, focus: f64::from(split.focus) }
    }

    fn ask(self, settings: &Settings) -> SplitQuery {
        let (bias, split) = (&settings.shadow_map, &settings.split);
        match self {
            Self::Trapezoidal | Self::LightSpace | Self::ParallelSplit => {
                SplitQuery::Depths { constant: bias.constant, slope: bias.slope }
            }
            Self::Variance | Self::Remix => SplitQuery::Moments {
                constant: bias.constant,
                bleeding: split.bleeding,
                grazing: if self == Self::Remix { split.grazing.to_radians().sin() } else { 0.0 },
            },
        }
    }
}

/// One of the methods for one mesh, image, map and setting.
#[derive(Debug)]
pub struct SplitMapping {
    plan: SplitPlan,
    size: [u32; 2],
    map: u32,
    splits: Buffer<SplitViews>,
    make: SplitMaps,
    maps: Maps,
    reduce: Option<MapMoments>,
    moments: Buffer<[f32; 2]>,
    ask: SplitShadows,
    visibility: Buffer<f32>,
}

impl SplitMapping {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts, recipe: Recipe) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let (plan, ask) = (recipe.plan(settings), recipe.ask(settings));
        let (views, side) = (plan.splits as usize, settings.map);
        let filters = matches!(ask, SplitQuery::Moments { .. });
        Ok(Self {
            plan,
            size: settings.size,
            map: side,
            splits: Buffer::uniform(device, "split_maps.splits", 1)?,
            make: SplitMaps::new(device),
            maps: Maps::new(device, queue, views, side as usize, casters.triangles.len())?,
            reduce: filters.then(|| MapMoments::new(device)),
            moments: MapMoments::memory(device, if filters { views } else { 0 }, side)?,
            ask: SplitShadows::new(device, ask),
            visibility: Buffer::storage(device, "split_shadows.visibility", settings.pixels())?,
        })
    }
}

impl SplitMapping {
    /// Keys of the nearest depths of all maps, one after the other, and their texels a side.
    pub fn maps(&self) -> (&Buffer<u32>, u32) {
        (&self.maps.keys, self.map)
    }
}

impl FixedMethod for SplitMapping {
    fn asks(&self) -> AskedViews {
        AskedViews::Whole
    }

    fn partition(&self, _: &Settings) -> Option<SplitPlan> {
        None
    }

    fn upload(&self, uploads: &mut Uploads, of: FrameInputs) -> Result<()> {
        let FrameInputs { camera, view, bounds, .. } = of;
        let rays = camera.rays(self.size[0], self.size[1]);
        let scale = unit_scale(rays.eye, bounds);
        let seen = SeenBox::new(&rays, self.size, f64::from(camera.near), bounds, scale);
        let view = view.relative_to(rays.eye, scale);
        uploads.write(&self.splits, &[SplitViews::of_view(&view, &seen, &self.plan)]);
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let (triangles, points) = (&inputs.casters.triangles, &geometry.points);
        let keys = &self.maps.keys;
        rec.clear(keys.raw());
        let mesh = SplitMapInputs { triangles, points, light_rects: &geometry.facts.light_rects };
        self.make.record(&mut rec.stage("split_maps"), frame, &self.splits, mesh, &self.maps)?;
        if let Some(reduce) = &self.reduce {
            let (stage, views) = (&mut rec.stage("map_moments"), self.plan.splits as usize);
            reduce.record(stage, frame, &self.splits, keys, &self.moments, views, self.map);
        }
        let seen = PrimaryHits { samples: inputs.samples, id_keys: inputs.id_keys, triangles, points };
        let maps = OfMaps { splits: &self.splits, keys, moments: &self.moments };
        self.ask.record(&mut rec.stage("split_shadows"), frame, seen, maps, &self.visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_split_maps(gpu, self).map(Some)
    }
}
