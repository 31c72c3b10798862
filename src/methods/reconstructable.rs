//! `reconstructable`: Reconstructable Geometry Shadow Maps (Dai, Yang, Feng 2008), one page of calls to stages. A texel keeps the triangle that is
//! nearest at its centre, and a sample asks those of the texels around it. Memory is fixed: 8 bytes a texel.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, StageInputs};
use super::settings::ReconstructableSettings;
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::kept_triangles::{KeptTriangles, KeptTrianglesOptions};
use crate::stages::light_layers::{Layers, LightLayers};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct Reconstructable {
    /// Texels around a place that are asked.
    reach: f32,
    layers: LightLayers,
    map: Layers,
    kept: KeptTriangles,
    visibility: Buffer<f32>,
}

impl Reconstructable {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, settings, .. } = parts;
        settings.check()?;
        let ReconstructableSettings { lookups, bias } = settings.reconstructable;
        let (alpha, words) = (settings.alpha_tested, settings.samples.words());
        Ok(Self {
            reach: (lookups / 2 + 1) as f32,
            layers: LightLayers::with_triangles(device, alpha),
            map: Layers::without_marks(device, settings.map as usize)?,
            kept: KeptTriangles::new(device, KeptTrianglesOptions { lookups, bias, words, alpha }),
            visibility: Buffer::storage(device, "kept_triangles.visibility", settings.pixels())?,
        })
    }

    /// The map: nearest depths, and in place of the second depths complements of the triangles.
    pub fn map(&self) -> &Layers {
        &self.map
    }
}

impl FixedMethod for Reconstructable {
    fn asks(&self) -> AskedViews {
        AskedViews::One(self.reach)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let blocks = geometry.in_light(inputs.casters);
        rec.clear(self.map.nearest_keys.raw());
        for stage in ["light_layers", "light_triangles"] {
            rec.clear(self.map.second_keys.raw());
            self.layers.record(&mut rec.stage(stage), frame, blocks, &self.map);
        }
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        let stage = &mut rec.stage("kept_triangles");
        self.kept.record(stage, frame, seen, &self.map.second_keys, &self.visibility);
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_triangles(gpu, &self.map).map(Some)
    }
}
