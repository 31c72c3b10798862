//! `spsm`: sub-pixel shadow maps (Lecocq, Marvie, Sourimant, Gautron 2013), one page of calls to stages. Memory is fixed:
//! 24 bytes a texel, and no list beyond that of the uncertain pixels.

use super::fixed::{FixedMethod, Inputs};
use super::looks::Looks;
use super::render::Counts;
use super::settings::{Settings, SpsmEncoding};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::PrefixScan;
use crate::stages::spsm_map::{SpsmMap, SpsmTexels};
use crate::stages::spsm_query::{Class, Options, Seen, SpsmPixels, SpsmQuery};

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct Spsm {
    map: SpsmMap,
    query: SpsmQuery,
    texels: SpsmTexels,
    pixels: SpsmPixels,
}

impl Spsm {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        settings.check()?;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let words = settings.samples.words();
        let options = Options {
            encoding: match settings.spsm.encoding {
                SpsmEncoding::Paper => 0,
                SpsmEncoding::Lines => 1,
            },
            words,
            many: settings.samples.count() > 1,
            radius: settings.spsm.radius,
            stretch: settings.spsm.stretch,
            bias: settings.spsm.bias,
        };
        let texels = SpsmTexels::new(device, queue, settings.map as usize, settings.spsm.exponent)?;
        Ok(Self {
            map: SpsmMap::new(device, options.encoding, &texels),
            query: SpsmQuery::new(device, &PrefixScan::new(device), options, &texels),
            texels,
            pixels: SpsmPixels::new(device, queue, settings.pixels(), words as usize)?,
        })
    }

    /// The map.
    pub fn texels(&self) -> &SpsmTexels {
        &self.texels
    }

    /// What is known of the pixels.
    pub fn pixels(&self) -> &SpsmPixels {
        &self.pixels
    }
}

impl FixedMethod for Spsm {
    fn prepare(&mut self, _: &Gpu, _: &Camera, _: &Light, _: &LightView, _: &Frame) -> Result<()> {
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: Inputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        rec.clear(self.texels.depth_keys.raw());
        rec.clear(self.texels.id_keys.raw());
        rec.clear(self.texels.won_counts.raw());
        self.map.record(&mut rec.stage("spsm_map"), frame, geometry.in_light(inputs.casters), &self.texels)?;
        let seen = Seen {
            samples: inputs.samples,
            id_keys: &geometry.id_keys,
            triangles: inputs.casters.triangles.raw(),
            points: &geometry.points,
        };
        self.query.record_classify(&mut rec.stage("spsm_classify"), frame, seen, &self.texels, &self.pixels)?;
        self.query.record_recover(&mut rec.stage("spsm_recover"), frame, seen, &self.texels, &self.pixels)
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.pixels.visibility
    }

    fn lit(&self) -> Option<&Buffer<u32>> {
        Some(&self.pixels.lit)
    }

    fn counts(&self, gpu: &Gpu) -> Result<Counts> {
        let classes = self.pixels.classes(gpu)?;
        let of = |class: Class| classes.iter().filter(|&&c| c == class as u32).count() as u64;
        Ok(Counts {
            silhouette_pixels: of(Class::Uncertain),
            facets: classes.len() as u64,
            empty_facets: of(Class::Empty),
            dark_facets: of(Class::Dark),
            lit_facets: of(Class::Lit),
            shadowed_facets: of(Class::Shadowed),
            ..Counts::default()
        })
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<Looks>> {
        Looks::of_spsm(gpu, self).map(Some)
    }
}
