//! A frame against scene truth, sample by sample, and its picture against its masks.

use crate::report::FacetSet;
use oracle::truth::{FacetInput, FacetTruth, SceneTruth, SeenTruth, TruthImage, full_mask, join_mask, split_mask};
use subpixel_shadows::methods::FacetMode;
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::Output;
use subpixel_shadows::stages::facet_classify::{Facet, FacetState};

/// The parts of scene truth.
pub(super) struct Truths<'a> {
    pub scene: SceneTruth<'a>,
    pub seen: SeenTruth<'a>,
    pub facets: FacetTruth<'a>,
    pub samples: u32,
}

impl Truths<'_> {
    /// Whether a sample of a pixel with these facets is ambiguous, or tied.
    pub fn is_open(&self, pixel: u32, set: &FacetSet) -> bool {
        join_mask(self.scene.ambiguous_mask(pixel)) != 0 || {
            let given = |k: usize| given(set, pixel, k);
            let seen = self.seen.judge(pixel, full_mask(self.samples), given);
            seen.tied | seen.stand_in != 0
        }
    }

    /// Samples of a pixel whose light on the surface that they were given is ambiguous. Scene truth probes places around a sample, which
    /// slivers of shadow pass between; facet truth asks for the shadows' lines.
    fn open_on_facets(&self, pixel: u32, set: &FacetSet) -> u128 {
        let full = full_mask(self.samples);
        let own = set.facets.iter().enumerate().filter(|(_, facet)| facet.pixel == pixel);
        let inputs: Vec<FacetInput> = own
            .filter(|(_, facet)| facet.state != FacetState::Empty as u32)
            .map(|(f, facet)| FacetInput {
                pixel,
                triangle: facet.triangle,
                coverage: split_mask(set.masks_of(f)[0] & full),
            })
            .collect();
        let judged = self.facets.judge(&inputs, None).unwrap_or_default();
        judged.iter().fold(0, |mask, result| mask | join_mask(result.ambiguous()))
    }
}

/// The triangle that a sample of a pixel was given.
fn given(set: &FacetSet, pixel: u32, sample: usize) -> Option<u32> {
    let own = |facet: &Facet| facet.pixel == pixel && facet.state != FacetState::Empty as u32;
    let covers = |f: usize| set.masks_of(f)[0] >> sample & 1 == 1;
    (0..).zip(&set.facets).find(|(f, facet)| own(facet) && covers(*f)).map(|(_, facet)| facet.triangle)
}

/// Samples of each pixel that its facets cover.
fn covered(set: &FacetSet, pixels: usize) -> Vec<u128> {
    let mut seen = vec![0; pixels];
    for (f, facet) in set.facets.iter().enumerate().filter(|(_, facet)| facet.state != FacetState::Empty as u32) {
        if let Some(seen) = seen.get_mut(facet.pixel as usize) {
            *seen |= set.masks_of(f)[0];
        }
    }
    seen
}

/// Pixels whose visibility is no share, or not that of their masks.
pub(super) fn wrong_shares(plan: &Plan, output: &Output, set: &FacetSet) -> u64 {
    let settings = &plan.settings;
    let full = full_mask(settings.samples.count());
    let whole = plan.extent == Extent::Everything && settings.facets == FacetMode::All;
    let seen = if whole { covered(set, settings.pixels()) } else { Vec::new() };
    let wrong = output.visibility.iter().enumerate().filter(|&(p, v)| {
        let of_masks = seen.get(p).filter(|seen| **seen & full != 0).map(|seen| {
            let lit = lit_of(output, p) & seen & full;
            lit.count_ones() as f32 / (seen & full).count_ones() as f32
        });
        !(0.0..=1.0).contains(v) || of_masks.is_some_and(|share| (share - v).abs() > 1e-6)
    });
    wrong.count() as u64
}

fn lit_of(output: &Output, pixel: usize) -> u128 {
    let words = output.words as usize;
    let mut mask = [0; 4];
    for (to, from) in mask.iter_mut().zip(output.lit.iter().skip(pixel * words).take(words)) {
        *to = *from;
    }
    join_mask(mask)
}

/// A frame with a surface for every sample against scene truth.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SceneWrong {
    pub compared: u64,
    pub wrong: u64,
    pub in_band: u64,
    pub first: Option<Wrong>,
}

/// A wrong sample: whether it sees a surface, and whether that is lit, in the frame and in truth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrong {
    pub pixel: u32,
    pub sample: u32,
    pub ours: [bool; 2],
    pub truth: [bool; 2],
}

impl SceneWrong {
    pub fn of(truth: &Truths, image: &TruthImage, plan: &Plan, output: &Output, set: &FacetSet) -> Self {
        let full = full_mask(image.samples);
        let ours_seen = covered(set, image.pixels.len());
        let mut all = Self { compared: u64::from(image.samples) * image.pixels.len() as u64, ..Self::default() };
        for (p, pixel) in image.pixels.iter().enumerate() {
            let [seen, lit] = [pixel.seen, pixel.lit].map(join_mask);
            let [ours_seen, ours_lit] = match plan.extent {
                Extent::Nothing => [0, 0],
                // One facet stands for all samples: the plan has proved that they see the same.
                Extent::Facing => [seen, if output.visibility[p] == 1.0 { seen } else { 0 }],
                Extent::Everything => [ours_seen[p] & full, lit_of(output, p) & ours_seen[p] & full],
            };
            let wrong = ((ours_seen ^ seen) | (ours_lit ^ lit)) & full;
            if wrong == 0 {
                continue;
            }
            let given = |k: usize| given(set, p as u32, k);
            // Where one facet stands for all samples, it is the plan that gave them their surface.
            let tied = match plan.extent {
                Extent::Everything => {
                    // Facet truth tells whether a surface that stands in for the nearest is lit.
                    let seen = truth.seen.judge(p as u32, wrong, given);
                    seen.tied | seen.stand_in | truth.open_on_facets(p as u32, set)
                }
                _ => 0,
            };
            let doubt = join_mask(truth.scene.ambiguous_mask(p as u32)) | tied;
            for k in (0..image.samples).filter(|k| wrong >> k & 1 == 1) {
                let ours = [ours_seen, ours_lit].map(|mask| mask >> k & 1 == 1);
                if doubt >> k & 1 == 1 || truth.scene.answers_nearby(p as u32, k, ours) {
                    all.in_band += 1;
                } else {
                    all.wrong += 1;
                    let truth = [seen, lit].map(|mask| mask >> k & 1 == 1);
                    all.first = all.first.or(Some(Wrong { pixel: p as u32, sample: k, ours, truth }));
                }
            }
        }
        all
    }
}
