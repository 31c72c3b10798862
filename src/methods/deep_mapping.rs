//! `deep`: Deep Shadow Maps (Lokovic and Veach 2000), one page of calls to stages. A texel keeps the share of light that passes to each depth, of its
//! sub-texels. Memory is fixed: 4 bytes a sub-texel, and 4 a node and 4 a texel; of 4 x 4 sub-texels and seven nodes 96 bytes a texel.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, StageInputs};
use super::output::Counts;
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::deep_map::{DeepMap, DeepMapOptions};
use crate::stages::deep_shadows::DeepShadows;
use crate::stages::light_layers::{Layers, LightLayers};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct DeepMapping {
    /// Sub-texels around a place that are asked.
    reach: f32,
    /// Sub-texels of the map a side.
    size: u32,
    layers: LightLayers,
    map: Layers,
    make: DeepMap,
    deep: Buffer<u32>,
    worst: Buffer<u32>,
    ask: DeepShadows,
    visibility: Buffer<f32>,
}

impl DeepMapping {
    /// Builds pipelines and memory; the settings' map is that of sub-texels.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, settings, .. } = parts;
        settings.check()?;
        let options = DeepMapOptions::from(settings.deep);
        let make = DeepMap::new(device, options);
        Ok(Self {
            reach: 1.5 * options.sub_texels as f32,
            size: settings.map,
            layers: LightLayers::nearest_only(device, settings.alpha_tested),
            map: Layers::nearest_only(device, settings.map as usize)?,
            deep: make.memory(device, settings.map)?,
            worst: DeepMap::worst(device)?,
            make,
            ask: DeepShadows::new(device, options, [settings.shadow_map.constant, settings.shadow_map.slope]),
            visibility: Buffer::storage(device, "deep_shadows.visibility", settings.pixels())?,
        })
    }
}

impl FixedMethod for DeepMapping {
    fn asks(&self) -> AskedViews {
        AskedViews::One(self.reach)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry, casters) = (inputs.frame, inputs.geometry, inputs.casters);
        rec.clear(self.map.nearest_keys.raw());
        if inputs.view[0] == 0 {
            rec.clear(self.worst.raw());
        }
        self.layers.record(&mut rec.stage("light_layers"), frame, geometry.in_light(casters), &self.map);
        let made = (&self.deep, &self.worst);
        self.make.record(&mut rec.stage("deep_map"), frame, &self.map.nearest_keys, made, self.size);
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &casters.triangles,
            points: &geometry.points,
        };
        self.ask.record(&mut rec.stage("deep_shadows"), frame, seen, &self.deep, &self.visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn counts(&self, gpu: &Gpu) -> Result<Option<Counts>> {
        let worst = self.worst.read(gpu)?;
        let of = |k: usize| worst.get(k).map_or(0, |&word| u64::from(word));
        Ok(Some(Counts { deep_error: of(0), deep_raised: of(1), ..Counts::default() }))
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_depths(gpu, &self.map).map(Some)
    }
}
