//! `polygon-ids`: whose polygon is nearest (Hourcade, Nicolas 1985), one page of calls to stages. A texel keeps the triangle that is nearest at its
//! centre, and a sample is lit where that is of its receiver's surface. Memory is fixed: 8 bytes a texel, and 4 a triangle where no two are one
//! surface, as when they move.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, StageInputs};
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::polygon_ids::{PolygonIds, PolygonMap};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct PolygonMapping {
    /// Texels around a place that are asked.
    reach: f32,
    layers: LightLayers,
    map: Layers,
    /// Every triangle by itself, where the casters have no surfaces of several.
    each: Option<Buffer<u32>>,
    compare: PolygonIds,
    visibility: Buffer<f32>,
}

impl PolygonMapping {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let lookups = settings.polygon_ids.lookups;
        let each = || {
            let names: Vec<u32> = (0..casters.triangles.len() as u32).collect();
            Buffer::from_slice(device, queue, "polygon_ids.each", &names)
        };
        Ok(Self {
            reach: (lookups / 2 + 1) as f32,
            layers: LightLayers::with_triangles(device, settings.alpha_tested),
            map: Layers::without_marks(device, settings.map as usize)?,
            each: casters.surfaces.is_none().then(each).transpose()?,
            compare: PolygonIds::new(device, lookups),
            visibility: Buffer::storage(device, "polygon_ids.visibility", settings.pixels())?,
        })
    }
}

impl FixedMethod for PolygonMapping {
    fn asks(&self) -> AskedViews {
        AskedViews::One(self.reach)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry, casters) = (inputs.frame, inputs.geometry, inputs.casters);
        let blocks = geometry.in_light(casters);
        rec.clear(self.map.nearest_keys.raw());
        for stage in ["light_layers", "light_triangles"] {
            rec.clear(self.map.second_keys.raw());
            self.layers.record(&mut rec.stage(stage), frame, blocks, &self.map);
        }
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &casters.triangles,
            points: &geometry.points,
        };
        // One of the two is there: casters keep their surfaces as long as they are the same.
        if let Some(surfaces) = self.each.as_ref().or(casters.surfaces.as_ref()) {
            let map = PolygonMap { triangle_keys: &self.map.second_keys, surfaces };
            self.compare.record(&mut rec.stage("polygon_ids"), frame, seen, map, &self.visibility);
        }
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_triangles(gpu, &self.map).map(Some)
    }
}
