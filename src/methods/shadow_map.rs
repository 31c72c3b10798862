//! `shadow-map` (Williams 1978), `pcf` (Reeves, Salesin, Cook 1987) and `smsr` (Bondarev 2014): a map of nearest depths, and
//! comparisons for every sample.
//! Memory is fixed: 4 bytes a texel.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, StageInputs};
use super::settings::{Settings, ShadowMapSettings, SmsrSettings, SmsrShape};
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::shadow_map::{self, ShadowMap};
use crate::stages::smsr::{self, Smsr};

/// The method: how the map is queried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuery {
    /// `shadow-map`.
    Nearest,
    /// `pcf`.
    Filtered,
    /// `smsr`.
    Revectorized,
}

#[derive(Debug)]
enum Compare {
    Depths(ShadowMap),
    Borders(Smsr),
}

impl Compare {
    fn new(device: &wgpu::Device, settings: &Settings, ask: MapQuery) -> Self {
        let ShadowMapSettings { kernel, constant, slope } = settings.shadow_map;
        let depths = |options| Self::Depths(ShadowMap::new(device, options));
        match ask {
            MapQuery::Nearest => {
                depths(shadow_map::ShadowMapOptions { kernel: 1, constant, slope, receiver_plane: false })
            }
            MapQuery::Filtered => {
                depths(shadow_map::ShadowMapOptions { kernel, constant, slope: 0.0, receiver_plane: true })
            }
            MapQuery::Revectorized => {
                let SmsrSettings { shape, reach, slope } = settings.smsr;
                let midpoints = shape == SmsrShape::Midpoints;
                Self::Borders(Smsr::new(device, smsr::SmsrOptions { reach, midpoints, constant, slope }))
            }
        }
    }
}

/// One of the methods for one image, map and setting.
#[derive(Debug)]
pub struct ShadowMapping {
    /// Texels around a place that are asked.
    reach: f32,
    layers: LightLayers,
    compare: Compare,
    map: Layers,
    visibility: Buffer<f32>,
}

impl ShadowMapping {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts, ask: MapQuery) -> Result<Self> {
        let MethodParts { device, settings, .. } = parts;
        settings.check()?;
        Ok(Self {
            reach: match ask {
                MapQuery::Nearest => 1.0,
                MapQuery::Filtered => 0.5 * settings.shadow_map.kernel as f32 + 1.0,
                MapQuery::Revectorized => 2.0,
            },
            layers: LightLayers::nearest_only(device),
            compare: Compare::new(device, settings, ask),
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
    fn asks(&self) -> AskedViews {
        AskedViews::One(self.reach)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        rec.clear(self.map.nearest_keys.raw());
        let blocks = geometry.in_light(inputs.casters);
        self.layers.record(&mut rec.stage("light_layers"), frame, blocks, &self.map);
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        let (depths, visibility) = (&self.map.nearest_keys, &self.visibility);
        match &self.compare {
            Compare::Depths(stage) => stage.record(&mut rec.stage("shadow_map"), frame, seen, depths, visibility),
            Compare::Borders(stage) => stage.record(&mut rec.stage("smsr"), frame, seen, depths, visibility),
        }
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_shadow_map(gpu, self).map(Some)
    }
}
