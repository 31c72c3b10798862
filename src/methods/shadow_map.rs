//! `shadow-map` (Williams 1978) and `pcf` (Reeves, Salesin, Cook 1987): a map of nearest depths, and a comparison a sample.
//! Memory is fixed: 4 bytes a texel. Triangles that reach behind a point light cast nothing.

use super::fixed::{FixedMethod, Inputs};
use super::looks::Looks;
use super::render::Counts;
use super::settings::Settings;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::Seen;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::shadow_map::{Options, ShadowMap};

/// Either method for one image, map and setting.
#[derive(Debug)]
pub struct ShadowMapping {
    layers: LightLayers,
    compare: ShadowMap,
    map: Layers,
    visibility: Buffer<f32>,
}

impl ShadowMapping {
    /// Builds pipelines and memory; `options` say how the map is asked.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(gpu: &Gpu, settings: &Settings, options: Options) -> Result<Self> {
        settings.check()?;
        let device = &gpu.device;
        Ok(Self {
            layers: LightLayers::nearest_only(device),
            compare: ShadowMap::new(device, options),
            map: Layers::nearest_only(device, settings.map as usize)?,
            visibility: Buffer::storage(device, "shadow_map.visibility", settings.pixels())?,
        })
    }

    /// The map: nearest depths alone.
    pub fn map(&self) -> &Layers {
        &self.map
    }
}

impl FixedMethod for ShadowMapping {
    fn prepare(&mut self, _: &Gpu, _: &Camera, _: &Light, _: &LightView, _: &Frame) -> Result<()> {
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: Inputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        rec.clear(self.map.nearest_keys.raw());
        let blocks = geometry.in_light(inputs.casters);
        self.layers.record(&mut rec.stage("light_layers"), frame, blocks, &self.map)?;
        let seen = Seen {
            samples: inputs.samples,
            id_keys: &geometry.id_keys,
            triangles: inputs.casters.triangles.raw(),
            points: &geometry.points,
        };
        self.compare.record(&mut rec.stage("shadow_map"), frame, seen, &self.map.nearest_keys, &self.visibility)
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn lit(&self) -> Option<&Buffer<u32>> {
        None
    }

    fn counts(&self, _: &Gpu) -> Result<Counts> {
        Ok(Counts { facets: self.visibility.len() as u64, ..Counts::default() })
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<Looks>> {
        Looks::of_shadow_map(gpu, self).map(Some)
    }
}
