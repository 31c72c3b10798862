//! A frame held against facet truth.

use glam::{DVec2, DVec3};
use oracle::engine::CpuFacet;
use oracle::truth::facet_truth::FacetResult;
use oracle::truth::{FacetInput, FacetTruth, Progress, SceneTruth, Tracer, bits, full_mask, join_mask, split_mask};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::facet_masks::{FacetMode, Settings};
use subpixel_shadows::methods::strips::Rows;
use subpixel_shadows::scene::{Camera, Light, PixelRays};
use subpixel_shadows::stages::facet_classify::{Facet, FacetState, Facets};
use subpixel_shadows::{Error, Result};

/// The facets of a frame with their masks, read back.
#[derive(Clone, Debug, Default)]
pub struct FacetSet {
    /// Words of a mask.
    pub words: u32,
    /// The facets.
    pub facets: Vec<Facet>,
    /// Coverage, occluded and invalid mask of each facet, `words` words each.
    pub masks: Vec<u32>,
}

/// The facets where a shadow ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boundary {
    /// How many.
    pub facets: u64,
    /// Mean number of their valid samples.
    pub valid_samples: f64,
}

impl FacetSet {
    /// Reads the facets of the frame that was rendered last; none of a method that has none.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Gpu`] if the device fails.
    pub fn read<'f>(gpu: &Gpu, facets: impl Into<Option<&'f Facets>>, words: u32) -> Result<Self> {
        let Some(facets) = facets.into() else { return Ok(Self { words, ..Self::default() }) };
        Ok(Self { words, facets: facets.list.read(gpu)?, masks: facets.masks.read(gpu)? })
    }

    /// The facets of a frame of the CPU engine, with masks of `words` words.
    pub fn of_cpu(facets: &[CpuFacet], words: u32) -> Self {
        let facet = |f: &CpuFacet| Facet {
            pixel: f.pixel,
            triangle: f.triangle,
            state: f.masks.state as u32,
            ..Facet::default()
        };
        let words_of = |f: &CpuFacet| {
            let parts = [f.masks.coverage, f.masks.occluded, f.masks.invalid].map(split_mask);
            parts.into_iter().flat_map(move |part| part.into_iter().take(words as usize))
        };
        Self { words, facets: facets.iter().map(facet).collect(), masks: facets.iter().flat_map(words_of).collect() }
    }

    /// Adds the facets of a strip of rows of an image `width` pixels wide, those of rows that are known already left out.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Gpu`] if the device fails.
    pub fn add<'f>(
        &mut self,
        gpu: &Gpu,
        facets: impl Into<Option<&'f Facets>>,
        words: u32,
        width: u32,
        rows: Rows,
    ) -> Result<()> {
        let strip = Self::read(gpu, facets, words)?;
        let size = 3 * words.max(1) as usize;
        self.words = words;
        for (facet, masks) in strip.facets.iter().zip(strip.masks.chunks(size)) {
            if facet.state != FacetState::Empty as u32 && facet.pixel >= rows.known * width {
                self.facets.push(Facet { pixel: facet.pixel + rows.first * width, ..*facet });
                self.masks.extend_from_slice(masks);
            }
        }
        Ok(())
    }

    /// The facets of which some valid sample is lit and some is not, and their valid samples; `None` without any. Of no other facet is every
    /// sample's validity known: evaluation ends where none is left that is valid and lit.
    pub fn boundary(&self) -> Option<Boundary> {
        let open = (0..).zip(&self.facets).filter(|(_, facet)| facet.state == FacetState::Undecided as u32);
        let valid = open.filter_map(|(f, _)| {
            let [coverage, occluded, invalid] = self.masks_of(f);
            let valid = coverage & !invalid;
            (valid & occluded != 0 && valid & !occluded != 0).then(|| u64::from(valid.count_ones()))
        });
        let (facets, sum) = valid.fold((0, 0), |(facets, sum), valid| (facets + 1, sum + valid));
        (facets > 0).then(|| Boundary { facets, valid_samples: sum as f64 / facets as f64 })
    }

    /// Coverage, occluded and invalid samples of facet `f`.
    pub(crate) fn masks_of(&self, f: usize) -> [u128; 3] {
        let words = self.words as usize;
        [0, 1, 2].map(|kind| {
            let mut mask = [0; 4];
            let from = (3 * f + kind) * words;
            mask[..words].copy_from_slice(&self.masks[from..from + words]);
            join_mask(mask)
        })
    }
}

/// A frame against facet truth: numeric error alone. Counts are of samples.
///
/// Of a facet that was settled as lit or shadowed the samples on its own triangle (with a facet for every surface: all it covers)
/// are compared: there its plane is a real surface, which is what the proof is about. Of one that was evaluated all covered
/// samples are compared, for validity and, but for those that both drop, for occlusion: a point of the plane that is on no
/// surface may lie beneath the scene, where the light view holds no caster, and does not count; with one facet a pixel, which is
/// followed beyond its triangle, no more does one outside the box around the mesh. Where ours leave none that is
/// valid and open, evaluation may have ended there, and what is asked is
/// whether truth leaves one. Where ours leave all valid and lit, samples that truth drops beneath a neighbour that rises from the facet do not
/// count if it leaves all others lit. Of one that is dark, all.
///
/// With a facet for every surface the band is around the edges of what is seen, too: a wrong sample whose answer in scene
/// truth is another within 1/256 pixel ([`SceneTruth::ambiguous_mask`]) lies in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FacetErrors {
    /// Samples compared.
    pub facet_samples: u64,
    /// Samples that differ and lie farther than 1/256 pixel from every edge: must be 0.
    pub facet_wrong_outside_band: u64,
    /// Samples that differ within the band, where either answer may be given.
    pub facet_wrong_in_band: u64,
    /// Compared samples that lie within the band.
    pub facet_ambiguous: u64,
    /// Wrong ones outside the band, of facets settled as lit or shadowed.
    pub facet_wrong_settled: u64,
    /// Wrong ones outside the band, of facets settled as dark.
    pub facet_wrong_dark: u64,
    /// Wrong ones outside the band, by occlusion of evaluated facets.
    pub facet_wrong_occluded: u64,
    /// Wrong ones outside the band, by validity of evaluated facets.
    pub facet_wrong_invalid: u64,
    /// Samples of settled facets off their own triangle, not compared, whose answer the facet's plane would change.
    pub facet_settled_elsewhere: u64,
    /// The first wrong sample outside the band, in the order of the pixels: pixel, sample, triangle of the facet.
    #[serde(skip)]
    pub first_wrong: Option<[u32; 3]>,
}

impl FacetErrors {
    /// Holds `set` against facet truth, as it was rendered with `settings`.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] if the masks are not of as many words and facets, or the facets not of this image and mesh; as [`FacetTruth::new`].
    pub fn of(
        set: &FacetSet,
        tracer: &Tracer,
        camera: &Camera,
        light: &Light,
        settings: &Settings,
        progress: Progress,
    ) -> Result<Self> {
        let [w, h] = settings.size;
        let (words, facets, masks) = (set.words, set.facets.len(), set.masks.len());
        if words != settings.samples.words() || masks < 3 * words as usize * facets {
            return Err(Error::Config(format!("{masks} words of masks of {words} for {facets} facets")));
        }
        let mut truth = FacetTruth::new(tracer, camera, light, &settings.samples, w, h)?;
        let validity = settings.keeps_validity();
        if !validity {
            truth = truth.without_validity();
        }
        let asked: Vec<usize> =
            (0..set.facets.len()).filter(|&f| set.facets[f].state != FacetState::Empty as u32).collect();
        let inputs: Vec<FacetInput> = asked
            .iter()
            .map(|&f| FacetInput {
                pixel: set.facets[f].pixel,
                triangle: set.facets[f].triangle,
                coverage: split_mask(set.masks_of(f)[0] & full_mask(settings.samples.count())),
            })
            .collect();
        let results = truth.judge(&inputs, progress)?;
        let view = View {
            tracer,
            rays: camera.rays(w, h),
            width: w,
            offsets: settings.samples.offsets().iter().map(|o| DVec2::new(f64::from(o[0]), f64::from(o[1]))).collect(),
            validity,
            bounds: tracer.bounds(),
            surfaces: match settings.facets {
                FacetMode::One => None,
                FacetMode::All => Some(SceneTruth::new(tracer, camera, light, &settings.samples, w, h)?),
            },
        };
        Ok(asked
            .par_iter()
            .zip(&inputs)
            .zip(&results)
            .map(|((&f, input), result)| view.compare(input, set.facets[f].state, set.masks_of(f), result))
            .reduce(Self::default, Self::plus))
    }

    fn plus(self, o: Self) -> Self {
        Self {
            facet_samples: self.facet_samples + o.facet_samples,
            facet_wrong_outside_band: self.facet_wrong_outside_band + o.facet_wrong_outside_band,
            facet_wrong_in_band: self.facet_wrong_in_band + o.facet_wrong_in_band,
            facet_ambiguous: self.facet_ambiguous + o.facet_ambiguous,
            facet_wrong_settled: self.facet_wrong_settled + o.facet_wrong_settled,
            facet_wrong_dark: self.facet_wrong_dark + o.facet_wrong_dark,
            facet_wrong_occluded: self.facet_wrong_occluded + o.facet_wrong_occluded,
            facet_wrong_invalid: self.facet_wrong_invalid + o.facet_wrong_invalid,
            facet_settled_elsewhere: self.facet_settled_elsewhere + o.facet_settled_elsewhere,
            first_wrong: [self.first_wrong, o.first_wrong].into_iter().flatten().min(),
        }
    }
}

/// Inputs of the comparison that the view tells.
struct View<'a> {
    tracer: &'a Tracer,
    rays: PixelRays,
    width: u32,
    offsets: Vec<DVec2>,
    validity: bool,
    /// The box around the mesh.
    bounds: (DVec3, DVec3),
    /// With a facet for every surface: which samples are near the edge of one.
    surfaces: Option<SceneTruth<'a>>,
}

impl View<'_> {
    fn compare(&self, facet: &FacetInput, state: u32, masks: [u128; 3], truth: &FacetResult) -> FacetErrors {
        let coverage = join_mask(facet.coverage);
        let (met, own) = self.met_and_own(facet, coverage);
        // With a facet for every surface all samples that it covers are on that surface.
        let own = if self.surfaces.is_some() { met } else { own };
        let occluded = join_mask(truth.occluded);
        let (doubt, doubt_valid) = (join_mask(truth.ambiguous_occluded), join_mask(truth.ambiguous_valid));
        let count = |mask: u128| u64::from(mask.count_ones());
        let mut e = FacetErrors::default();
        // Which samples are compared for occlusion, what ours are, and which count a fault is put to.
        let closed = state == FacetState::Undecided as u32 && self.validity && (masks[1] | masks[2]) & met == met;
        // What both drop does not count, whether it is in shadow or not.
        let dropped = if self.validity { masks[2] & !join_mask(truth.valid) } else { 0 };
        let open = join_mask(truth.valid) & !occluded;
        // A facet that the light's view does not hold is lit as a whole, also beneath a neighbour that rises from it. Where truth drops what lies
        // there, and leaves no other sample in shadow, the picture is the same.
        let lit = self.validity && (masks[1] | masks[2]) & met == 0 && join_mask(truth.valid) & occluded & met == 0;
        let beneath = if lit { occluded & !join_mask(truth.valid) } else { 0 };
        let (asked, ours) = match state {
            s if s == FacetState::Dark as u32 => (met, met),
            s if s == FacetState::Lit as u32 => (own, 0),
            s if s == FacetState::Shadowed as u32 => (own, own),
            _ if closed => (met & open, met),
            _ => (met & !dropped & !beneath, masks[1] & met),
        };
        let (doubt, compared) = match state {
            s if s != FacetState::Undecided as u32 => (doubt, asked),
            _ if closed => (doubt | doubt_valid, met),
            _ => (doubt, met),
        };
        let wrong = (ours ^ occluded) & asked;
        let doubt = match &self.surfaces {
            Some(scene) if wrong & !doubt != 0 => doubt | join_mask(scene.ambiguous_mask(facet.pixel)),
            _ => doubt,
        };
        let outside = count(wrong & !doubt);
        e.facet_samples = count(compared);
        let mut ambiguous = doubt & compared;
        let mut inside = wrong & doubt;
        let mut surely_wrong = wrong & !doubt;
        match state {
            s if s == FacetState::Dark as u32 => e.facet_wrong_dark = outside,
            s if s == FacetState::Lit as u32 || s == FacetState::Shadowed as u32 => {
                e.facet_wrong_settled = outside;
                let elsewhere = met & !own & join_mask(truth.valid) & !doubt & !doubt_valid;
                let flat = if s == FacetState::Lit as u32 { 0 } else { u128::MAX };
                e.facet_settled_elsewhere = count((flat ^ occluded) & elsewhere);
            }
            _ => {
                e.facet_wrong_occluded = outside;
                if self.validity && !closed {
                    let wrong = (!masks[2] ^ join_mask(truth.valid)) & met & !beneath;
                    e.facet_wrong_invalid = count(wrong & !doubt_valid);
                    inside |= wrong & doubt_valid;
                    surely_wrong |= wrong & !doubt_valid;
                    ambiguous |= doubt_valid & met;
                }
            }
        }
        e.facet_wrong_in_band = count(inside);
        e.facet_ambiguous = count(ambiguous);
        e.facet_wrong_outside_band = outside + e.facet_wrong_invalid;
        e.first_wrong = bits(surely_wrong).next().map(|k| [facet.pixel, k as u32, facet.triangle]);
        e
    }

    /// Covered samples whose rays meet the facet's plane, and those of them that lie on its triangle.
    fn met_and_own(&self, facet: &FacetInput, coverage: u128) -> (u128, u128) {
        let [a, b, c] = self.tracer.corners(facet.triangle).map(|p| p - self.rays.eye);
        let normal = (b - a).cross(c - a);
        let distance = normal.dot(a);
        let corner = DVec2::new(f64::from(facet.pixel % self.width), f64::from(facet.pixel / self.width));
        let edges = [a.cross(b), b.cross(c), c.cross(a)];
        let (mut met, mut own) = (0, 0);
        for k in bits(coverage) {
            let at = corner + self.offsets[k];
            let r = self.rays.direction(at.x, at.y);
            if normal.dot(r) * distance > 0.0 {
                let point = self.rays.eye + r * (distance / normal.dot(r));
                let slack = 1e-9 * (self.bounds.1 - self.bounds.0).length();
                let is_around = (point - point.clamp(self.bounds.0, self.bounds.1)).length() <= slack;
                if self.surfaces.is_none() && !is_around {
                    continue;
                }
                met |= 1 << k;
                let v = DVec3::from_array(edges.map(|e| e.dot(r)));
                if v.min_element() >= 0.0 || v.max_element() <= 0.0 {
                    own |= 1 << k;
                }
            }
        }
        (met, own)
    }
}
