//! `spsm`: sub-pixel shadow maps (Lecocq, Marvie, Sourimant, Gautron 2013), one page of calls to stages. Memory is fixed:
//! 24 bytes a texel, and no list beyond that of the uncertain pixels. With [`SpsmSettings::seen_only`] only the texels that
//! pixels ask for are made: first those that pixels fall into, then those around the pixels that these do not settle.
//!
//! [`SpsmSettings::seen_only`]: super::settings::SpsmSettings::seen_only

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, MethodParts, OUTCOME_WORDS, StageInputs, StripOutcome};
use super::output::Counts;
use super::settings::SpsmEncoding;
use crate::Result;
use crate::gpu::{Buffer, Gpu, Recorder};
use crate::stages::PrefixScan;
use crate::stages::PrimaryHits;
use crate::stages::seen_texels::{SeenTexels, TexelMarks};
use crate::stages::spsm_map::{SpsmMap, SpsmTexels};
use crate::stages::spsm_query::{Class, SpsmPixels, SpsmQuery, SpsmQueryOptions};
use crate::status::StatusHead;

/// The method for one image, map and setting.
#[derive(Debug)]
pub struct Spsm {
    seen_texels: SeenTexels,
    map: SpsmMap,
    query: SpsmQuery,
    texels: SpsmTexels,
    pixels: SpsmPixels,
    /// Texels around a place that are searched.
    reach: f32,
    /// Whether frames make all texels.
    all: bool,
}

impl Spsm {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, settings, .. } = parts;
        settings.check()?;
        let words = settings.samples.words();
        let options = SpsmQueryOptions {
            encoding: match settings.spsm.encoding {
                SpsmEncoding::Paper => 0,
                SpsmEncoding::Lines => 1,
            },
            words,
            many: settings.samples.count() > 1,
            radius: settings.spsm.radius,
            stretch: settings.spsm.stretch,
            recovery: settings.spsm.recovery,
            bias: settings.spsm.bias,
        };
        let texels = SpsmTexels::new(device, queue, settings.map as usize, settings.pixels(), settings.spsm.exponent)?;
        Ok(Self {
            seen_texels: SeenTexels::new(device, options, &texels),
            map: SpsmMap::new(device, options.encoding, &texels),
            query: SpsmQuery::new(device, &PrefixScan::new(device), options, &texels),
            texels,
            pixels: SpsmPixels::new(device, queue, settings.pixels(), words as usize)?,
            reach: (settings.spsm.radius + settings.spsm.stretch) as f32,
            all: !settings.spsm.seen_only,
        })
    }

    /// The map.
    pub fn texels(&self) -> &SpsmTexels {
        &self.texels
    }

    /// State of the pixels.
    pub fn pixels(&self) -> &SpsmPixels {
        &self.pixels
    }
}

impl FixedMethod for Spsm {
    fn asks(&self) -> AskedViews {
        AskedViews::One(1.0 + self.reach)
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        rec.clear(self.texels.keys.raw());
        rec.clear(self.texels.marks.words.raw());
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        let Self { seen_texels, map, query, texels, pixels, .. } = self;
        let blocks = geometry.in_light(inputs.casters);
        if self.all {
            let mut stage = rec.stage("spsm_map");
            seen_texels.record_all(&mut stage, frame, &texels.marks);
            map.record(&mut stage, frame, blocks, texels)?;
        } else {
            seen_texels.record(&mut rec.stage("seen_texels"), frame, seen, texels);
            map.record(&mut rec.stage("spsm_map"), frame, blocks, texels)?;
        }
        query.record_classify(&mut rec.stage("spsm_classify"), frame, seen, texels, pixels)?;
        if !self.all {
            let mut stage = rec.stage("spsm_map_around");
            seen_texels.record_around(&mut stage, frame, seen, texels, pixels);
            map.record_last(&mut stage, frame, blocks, texels)?;
        }
        query.record_settle(&mut rec.stage("spsm_settle"), frame, seen, texels, pixels)?;
        texels.marks.take_list(rec, pixels);
        query.record_recover(&mut rec.stage("spsm_recover"), frame, seen, texels, pixels);
        Ok(())
    }

    fn record_outcome(&self, rec: &mut Recorder, to: &Buffer<u32>, at: u64) {
        rec.copy_words(self.texels.marks.words.raw(), TexelMarks::MISSED as u64, to.raw(), at, 1);
    }

    fn outcome(&mut self, words: [u32; OUTCOME_WORDS], _: &StatusHead) -> Result<StripOutcome> {
        let left_out = words[0] != 0;
        self.all |= left_out;
        Ok(StripOutcome { left_out, ..StripOutcome::default() })
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.pixels.visibility
    }

    fn lit(&self) -> Option<&Buffer<u32>> {
        Some(&self.pixels.lit)
    }

    fn classes(&self) -> Option<&Buffer<u32>> {
        Some(&self.pixels.marks)
    }

    fn counts(&self, gpu: &Gpu) -> Result<Option<Counts>> {
        let classes = self.pixels.classes(gpu)?;
        let of = |class: Class| classes.iter().filter(|&&c| c == class as u32).count() as u64;
        Ok(Some(Counts {
            silhouette_pixels: of(Class::Uncertain),
            facets: classes.len() as u64,
            empty_facets: of(Class::Empty),
            dark_facets: of(Class::Dark),
            lit_facets: of(Class::Lit),
            shadowed_facets: of(Class::Shadowed),
            ..Counts::default()
        }))
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_spsm(gpu, self).map(Some)
    }
}
