//! Holding a frame against everything there is to hold it against.
//!
//! - *Facet truth*: [`FacetErrors`], the method's own model in `f64`, for the frame and for that of the CPU engine. No sample outside the
//!   band of 1/256 pixel may be wrong.
//! - *Scene truth*, where every sample has its own surface (`--facets all`, or one sample a pixel): of each sample whether it sees a surface,
//!   and whether that is lit, sample by sample. `scene_pixel_match` would not do: it counts within 1/N, so one wrong sample passes and
//!   several ambiguous ones do not. A sample counts as ambiguous if the truth gives our answer, or the other, at one of the places around it
//!   ([`SceneTruth::ambiguous_mask`], and for a sample that is still wrong [`SceneTruth::answers_nearby`], which also finds slivers that
//!   pass between those places), or if facet truth does of the surface that it was given. Where the plan says that nothing is seen, truth
//!   must see nothing.
//! - *Seen truth* ([`SeenErrors`]): no sample (with one facet a pixel: no centre) is given another surface than it sees, but where the two
//!   are tied. What is tied there, or replaces the nearest, does not count in scene truth either.
//! - *The picture*: shares are in `[0, 1]` and those of the masks they come from.
//! - *The plan*: planned and forced pictures have the same bits, but in pixels in which a sample is ambiguous or tied.
//! - *Methods of texels* promise no sample: their pictures are shares, have the same bits in a second frame, and when everything is run.
//!
//! Masks from a table ([`MaskVariant::Table`](subpixel_shadows::mask_table::MaskVariant)) round: their evaluated samples are held against
//! [`TABLE_SHARE`], what is settled is exact as ever, and neither scene truth nor the forced picture is asked.

use super::samples::{SceneWrong, Truths, Wrong, wrong_shares};
use super::{FuzzCase, Shot};
use crate::report::{FacetErrors, FacetSet, Promise, SeenErrors};
use oracle::engine;
use oracle::truth::{FacetTruth, SceneTruth, SeenTruth, Tracer};
use subpixel_shadows::Result;
use subpixel_shadows::methods::{FacetMode, MethodName};
use subpixel_shadows::plan::Extent;

/// Share of a facet's samples that one evaluation by a table may give another answer than an exact one, on average over a frame: four
/// half-planes, of which each has at most 0.1 wrong bits of 32 on average ([`MaskVariant::TABLE`](subpixel_shadows::mask_table::MaskVariant::TABLE)).
pub const TABLE_SHARE: f64 = 4.0 * 0.1 / 32.0;

/// Samples that may be wrong with a table however few are evaluated: an average says nothing of a few.
pub const TABLE_FEW: f64 = 64.0;

/// The faults of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fault {
    /// Samples of the frame against facet truth.
    Facet,
    /// Samples of the frame against seen truth.
    Seen,
    /// Samples of the frame against scene truth.
    Scene,
    /// Samples of the CPU engine against facet truth.
    CpuFacet,
    /// Samples of the CPU engine against seen truth.
    CpuSeen,
    /// Samples of the CPU engine against scene truth.
    CpuScene,
    /// Pixels that another picture has when everything is run.
    Forced,
    /// Pixels whose visibility is no share, or not that of their masks.
    Picture,
    /// Pixels that a second frame has otherwise.
    Again,
    /// Truth or the CPU engine refuses what was rendered.
    Refused,
    /// It panicked.
    Panic,
}

impl Fault {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Facet => "samples wrong against facet truth",
            Self::Seen => "samples that were given another surface than they see",
            Self::Scene => "samples wrong against scene truth",
            Self::CpuFacet => "samples of the CPU engine wrong against facet truth",
            Self::CpuSeen => "samples of the CPU engine that were given another surface than they see",
            Self::CpuScene => "samples of the CPU engine wrong against scene truth",
            Self::Forced => "pixels differ when everything is run",
            Self::Picture => "pixels whose visibility is not that of their masks",
            Self::Again => "pixels differ in a second frame",
            Self::Refused => "refused by truth or the CPU engine, not by the GPU",
            Self::Panic => "panic",
        }
    }
}

/// Counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Samples held against truth, those of both engines and both truths.
    pub compared: u64,
    /// Wrong ones outside the band.
    pub wrong: u64,
    /// Ambiguous ones: within the band.
    pub ambiguous: u64,
    /// Samples whose surface was asked for.
    pub seen: u64,
    /// Those given another surface than the nearest, where either may be right.
    pub tied: u64,
    /// Wrong samples of tables, within their bound.
    pub by_table: u64,
}

/// The judgement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Counts.
    pub figures: Figures,
    /// Faults, how often each occurs, and where it is found first.
    pub faults: Vec<(Fault, u64, String)>,
}

impl Verdict {
    /// Whether it is a failure.
    pub fn fails(&self) -> bool {
        !self.faults.is_empty()
    }

    /// Whether one of its faults is of this kind.
    pub fn has(&self, fault: Fault) -> bool {
        self.faults.iter().any(|(f, ..)| *f == fault)
    }

    fn add(&mut self, fault: Fault, count: u64, at: impl FnOnce() -> String) {
        if count > 0 {
            self.faults.push((fault, count, at()));
        }
    }

    fn facets(&mut self, fault: Fault, errors: &FacetErrors, width: u32, allowed: u64) {
        let exact = errors.facet_wrong_settled + errors.facet_wrong_dark;
        let evaluated = errors.facet_wrong_outside_band - exact;
        let wrong = if evaluated > allowed { errors.facet_wrong_outside_band } else { exact };
        self.figures.compared += errors.facet_samples;
        self.figures.ambiguous += errors.facet_ambiguous;
        self.figures.wrong += wrong;
        self.figures.by_table += errors.facet_wrong_outside_band - wrong;
        self.add(fault, wrong, || {
            let [pixel, sample, triangle] = errors.first_wrong.unwrap_or_default();
            let FacetErrors { facet_wrong_settled: s, facet_wrong_dark: d, .. } = errors;
            let [o, i] = [errors.facet_wrong_occluded, errors.facet_wrong_invalid];
            let at = place(pixel, sample, width);
            format!("settled {s}, dark {d}, occluded {o}, invalid {i}; first: {at}, of triangle {triangle}")
        });
    }

    fn seen(&mut self, fault: Fault, errors: &SeenErrors, width: u32) {
        self.figures.seen += errors.seen_samples;
        self.figures.tied += errors.seen_tied;
        self.figures.wrong += errors.seen_wrong;
        self.add(fault, errors.seen_wrong, || {
            let [pixel, sample, triangle] = errors.first_wrong.unwrap_or_default();
            format!("first: {}, given triangle {triangle}", place(pixel, sample, width))
        });
    }

    fn scene(&mut self, fault: Fault, errors: &SceneWrong, width: u32) {
        self.figures.compared += errors.compared;
        self.figures.ambiguous += errors.in_band;
        self.figures.wrong += errors.wrong;
        self.add(fault, errors.wrong, || match errors.first {
            Some(Wrong { pixel, sample, ours, truth }) => {
                let at = place(pixel, sample, width);
                format!("first: {at}, which is {} and in truth {}", answer(ours), answer(truth))
            }
            None => String::new(),
        });
    }
}

fn answer([seen, lit]: [bool; 2]) -> &'static str {
    match (seen, lit) {
        (false, _) => "empty",
        (true, true) => "lit",
        (true, false) => "dark",
    }
}

fn place(pixel: u32, sample: u32, width: u32) -> String {
    format!("sample {sample} of pixel ({}, {})", pixel % width, pixel / width)
}

/// Judges a frame. Needs no GPU.
///
/// # Errors
/// Errors of the truths and the CPU engine, which refuse nothing that was rendered.
pub fn judge(case: &FuzzCase, shot: &Shot) -> Result<Verdict> {
    let Shot { scene, prepared, plan, output, facets, again, forced } = shot;
    let (settings, camera, light) = (&plan.settings, &scene.camera, &scene.light);
    let [width, height] = settings.size;
    let mut verdict = Verdict::default();
    verdict.add(Fault::Picture, wrong_shares(plan, output, facets), String::new);
    if case.how.promise() == Promise::Texels {
        let others = [(Fault::Again, again.as_ref()), (Fault::Forced, forced.as_ref().map(|f| &f.0))];
        for (fault, other) in others.into_iter().filter_map(|(fault, other)| Some((fault, other?))) {
            let pixels = (0..).zip(output.visibility.iter().zip(&other.visibility));
            let differing: Vec<(u32, [f32; 2])> =
                pixels.filter(|(_, (a, b))| a.to_bits() != b.to_bits()).map(|(p, (a, b))| (p, [*a, *b])).collect();
            verdict.add(fault, differing.len() as u64, || {
                let (p, [ours, other]) = differing[0];
                format!("first: pixel ({}, {}), {ours} and {other}", p % width, p / width)
            });
        }
        return Ok(verdict);
    }
    let tracer = Tracer::of(prepared)?;
    let exact = case.how.promise() == Promise::Exact;
    let allowed = match exact {
        true => 0,
        false => {
            let samples = f64::from(settings.samples.count());
            let evaluated = output.counts.visibility_evaluations as f64 * samples;
            (TABLE_FEW + TABLE_SHARE * evaluated) as u64
        }
    };
    let errors = FacetErrors::of(facets, &tracer, camera, light, settings, None)?;
    verdict.facets(Fault::Facet, &errors, width, allowed);
    verdict.seen(Fault::Seen, &SeenErrors::of(facets, &tracer, camera, settings, None)?, width);
    let truth = Truths {
        scene: SceneTruth::new(&tracer, camera, light, &settings.samples, width, height)?,
        seen: SeenTruth::new(&tracer, camera, &settings.samples, width, height)?,
        facets: FacetTruth::new(&tracer, camera, light, &settings.samples, width, height)?.without_validity(),
        samples: settings.samples.count(),
    };
    let each_sample = case.how.settings.facets == FacetMode::All || settings.samples.count() == 1;
    let image = (each_sample || plan.extent == Extent::Nothing).then(|| truth.scene.image(None));
    if let Some(image) = image.as_ref().filter(|_| exact) {
        verdict.scene(Fault::Scene, &SceneWrong::of(&truth, image, plan, output, facets), width);
    }
    if case.how.method == MethodName::FacetMasks && plan.extent != Extent::Nothing {
        let request = engine::CpuRequest {
            unshadowed: plan.extent == Extent::Facing,
            facets: true,
            ..engine::CpuRequest::default()
        };
        let frame = engine::render(prepared, settings, camera, light, request)?;
        let of_cpu = FacetSet::of_cpu(&frame.facets, settings.samples.words());
        let errors = FacetErrors::of(&of_cpu, &tracer, camera, light, settings, None)?;
        verdict.facets(Fault::CpuFacet, &errors, width, 0);
        verdict.seen(Fault::CpuSeen, &SeenErrors::of(&of_cpu, &tracer, camera, settings, None)?, width);
        if let Some(image) = &image {
            verdict.scene(Fault::CpuScene, &SceneWrong::of(&truth, image, plan, &frame.output, &of_cpu), width);
        }
    }
    if let Some((forced, of_forced)) = forced {
        let differs = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
        // Where a surface or an edge may be taken either way, the two may take it each its way.
        let either = |p: u32| truth.is_open(p, facets) || truth.is_open(p, of_forced);
        let pairs = output.visibility.iter().zip(&forced.visibility);
        let other: Vec<u32> =
            (0..).zip(pairs).filter(|(p, pair)| differs(*pair) && !either(*p)).map(|(p, _)| p).collect();
        verdict.add(Fault::Forced, other.len() as u64, || {
            let p = other.first().copied().unwrap_or_default();
            let [ours, other] = [output, forced].map(|o| o.visibility[p as usize]);
            format!("first: pixel ({}, {}), {ours} and {other}", p % width, p / width)
        });
    }
    Ok(verdict)
}
