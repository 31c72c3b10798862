//! Methods on the CPU, on all cores, for machines without an adapter: `facet-masks`, the same stages by their definitions in `f64`, and
//! `ray-traced` ([`CpuRays`]).
//!
//! The maps of the first light view are made once, facets in bands of rows with the maps of further views, their pairs in parts that fit
//! memory. How masks are looked up and how pairs are brought together ([`Settings::masks`], [`Settings::pairs`]) are
//! matters of the GPU: here every sample is decided.

mod light_side;
mod primary_hits;
mod rays;
mod shadows;

use crate::reference::facet_classify::FacetState;
use crate::reference::front_layer::Margin;
use crate::reference::pixel_filter;
use crate::reference::resolve::{FacetBits, pixel, seen as seen_samples};
use crate::truth::{FacetTruth, Progress, Tracer, join_mask, split_mask};
use glam::DVec3;
use light_side::{LightSide, join};
pub use rays::CpuRays;
use std::time::Instant;
use subpixel_shadows::methods::PixelFilter;
use subpixel_shadows::methods::debug_views::{DebugMap, DebugViews, PixelClass};
use subpixel_shadows::methods::facet_masks::Settings;
use subpixel_shadows::methods::output::{Counts, ListUse, Output};
use subpixel_shadows::methods::prepared::Prepared;
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::{Error, Result};

/// How far conservative tests reach out: far above the rounding of `f64`, far below anything that costs time.
const MARGIN: Margin = Margin { texels: 1.0 / 1024.0, depth: 1e-7 };

/// Pixels of a band of rows; a row may have more.
const BAND: u32 = 1 << 19;

/// Request of a frame.
#[derive(Clone, Copy, Default)]
pub struct CpuRequest<'a> {
    /// Nothing casts a shadow: facets that face the light are lit, and no caster is tested.
    pub unshadowed: bool,
    /// Keep [`CpuFrame::facets`].
    pub facets: bool,
    /// Keep [`CpuFrame::looks`].
    pub looks: bool,
    /// Takes pixels done, and all.
    pub progress: Progress<'a>,
}

/// A facet and what became of its samples, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CpuFacet {
    /// The pixel.
    pub pixel: u32,
    /// The triangle of the prepared mesh whose plane it is.
    pub triangle: u32,
    /// Its state and its masks.
    pub masks: FacetBits,
}

/// Wall time of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CpuTime {
    /// The stage.
    pub name: &'static str,
    /// Milliseconds, of all bands.
    pub ms: f64,
}

/// A frame.
#[derive(Clone, Debug)]
pub struct CpuFrame {
    /// The picture.
    pub output: Output,
    /// The stages that ran.
    pub stages: Vec<CpuTime>,
    /// The facets of pixels that see something, if they were asked for.
    pub facets: Vec<CpuFacet>,
    /// Looks, if they were asked for.
    pub looks: Option<DebugViews>,
}

/// The stage of [`CpuRays`].
pub const RAYS: &str = "shadow_rays";

/// Why the CPU runs a stage of the plan as no stage of its own, if so. `ran`: the stages that ran.
pub fn merged(stage: &str, ran: &[CpuTime]) -> Option<&'static str> {
    match stage {
        _ if stage != RAYS && ran.iter().any(|t| t.name == RAYS) => {
            Some("CPU engine: rays from the eye find what each sample sees")
        }
        "pixel_triangles" | "pixel_coverage" => Some("CPU engine: sample_surfaces looks at the triangles themselves"),
        "cluster_culling" => Some("CPU engine: every triangle is looked at"),
        "requested_blocks" => Some("CPU engine: the light's maps are made whole"),
        "visibility_refine" => Some("CPU engine: all is decided in f64"),
        _ => None,
    }
}

/// Renders one frame.
///
/// # Errors
/// [`subpixel_shadows::Error::Config`] for impossible settings, [`subpixel_shadows::Error::Scene`] for an impossible camera or light,
/// [`subpixel_shadows::Error::Mesh`] for a mesh that has not passed its check, [`subpixel_shadows::Error::Config`] for triangles with roles of their own.
pub fn render(
    prepared: &Prepared,
    settings: &Settings,
    camera: &Camera,
    light: &Light,
    request: CpuRequest,
) -> Result<CpuFrame> {
    let start = Instant::now();
    settings.check()?;
    camera.check()?;
    if prepared.alpha().has_roles() {
        let text = "the CPU engine: triangles have roles; on a GPU it takes them".to_owned();
        return Err(Error::Config(text));
    }
    let mut clock = Clock::default();
    let mesh = prepared.mesh();
    let size = if request.unshadowed { 1 } else { settings.map };
    let of_light = Settings { map: size, ..settings.clone() };
    let maps = match request.unshadowed {
        true => vec![of_light.light_view(prepared, light)?],
        false => {
            let bounds = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
            let views = of_light.light_views(prepared, light)?;
            of_light.in_slices(views, camera, bounds, (false, false), None, prepared.objects())
        }
    };
    let side = |clock: &mut Clock, map| LightSide::new(clock, prepared, settings, camera, light, map, &request);
    // What the first view tells is kept; further ones, which take as much each, come one at a time.
    let (Some(map), further_maps) = (maps.first(), maps.get(1..).unwrap_or_default()) else {
        return Err(Error::Scene("the light has no view".to_owned()));
    };
    let first_side = side(&mut clock, map);
    let tracer = Tracer::of(prepared)?;
    let truth = FacetTruth::new(&tracer, camera, light, &settings.samples, settings.size[0], settings.size[1])?;
    let validity = settings.keeps_validity();
    let truth = if validity { truth } else { truth.without_validity() };

    let mut frame = CpuFrame {
        output: Output::nothing_seen(settings),
        stages: Vec::new(),
        facets: Vec::new(),
        looks: request.looks.then(|| DebugViews {
            classes: vec![PixelClass::Empty; settings.pixels()],
            map: (!request.unshadowed && maps.len() == 1).then(|| first_side.known.look(size)),
            ..DebugViews::default()
        }),
    };
    frame.output.counts = Counts::default();
    first_side.add_counts(&mut frame.output.counts);
    let mut pairs = shadows::Pairs::default();
    let [width, height] = settings.size;
    let rows = (BAND / width).max(1);
    let mut surfaces = Vec::new();
    let mut first = 0;
    while first < height {
        let band = first..(first + rows).min(height);
        let seen = primary_hits::Seen::new(
            &mut clock,
            &first_side.view,
            (&first_side.triangles, prepared.alpha()),
            settings,
            band.clone(),
        );
        let (done, of_band) = ((first * width) as usize, (band.end - first) as usize * width as usize);
        let mut masks: Vec<(FacetBits, bool)> = Vec::new();
        for k in 0..maps.len() {
            let further = (k > 0).then(|| side(&mut clock, &further_maps[k - 1]));
            if let Some(further) = further.as_ref().filter(|_| first == 0) {
                further.add_counts(&mut frame.output.counts);
            }
            let report = |n: usize, of: usize| {
                if let Some(progress) = request.progress {
                    progress(done + of_band * (k * of + n) / (of.max(1) * maps.len()), settings.pixels());
                }
            };
            let found = further.as_ref().unwrap_or(&first_side).masks(
                &mut clock,
                &mut pairs,
                &seen.parts,
                settings,
                (&truth, validity),
                request.unshadowed,
                Some(&report),
            );
            match k {
                0 => masks = found,
                _ => masks.iter_mut().zip(found).for_each(|(known, further)| join(known, further)),
            }
        }
        clock.time("resolve", || {
            let of = |k: usize| masks[k].0;
            seen.add_to(&mut frame, settings.samples.words() as usize, request.facets, &of);
            if settings.filter != PixelFilter::Box {
                surfaces.extend(seen.of_pixels().map(|range| seen_samples(&range.map(of).collect::<Vec<_>>())));
            }
        });
        first = band.end;
    }
    if settings.filter != PixelFilter::Box {
        clock.time("pixel_filter", || {
            let words = settings.samples.words() as usize;
            let lit: Vec<u128> = frame.output.lit.chunks(words).map(join_words).collect();
            let shares = pixel_filter::visibility(settings.filter, &settings.samples, settings.size, &lit, &surfaces);
            frame.output.visibility = shares.into_iter().map(|share| share as f32).collect();
        });
    }
    frame.output.lists = pairs.lists(&mut frame.output.counts);
    frame.stages = clock.0;
    frame.output.wall_ms = start.elapsed().as_secs_f64() * 1e3;
    Ok(frame)
}

fn join_words(words: &[u32]) -> u128 {
    let mut all = [0; 4];
    all[..words.len()].copy_from_slice(words);
    join_mask(all)
}

/// Wall time of stages.
#[derive(Debug, Default)]
struct Clock(Vec<CpuTime>);

impl Clock {
    fn time<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        match self.0.iter_mut().find(|t| t.name == name) {
            Some(known) => known.ms += ms,
            None => self.0.push(CpuTime { name, ms }),
        }
        done
    }
}

impl primary_hits::Seen {
    /// Writes the band's pixels, masks of `words` words, and keeps its facets if asked to; `of` gives the masks of each.
    fn add_to(&self, frame: &mut CpuFrame, words: usize, keep: bool, of: &dyn Fn(usize) -> FacetBits) {
        let (output, mut masks) = (&mut frame.output, Vec::new());
        for (k, range) in self.of_pixels().enumerate() {
            masks.clear();
            masks.extend(range.clone().map(of));
            let p = self.first_pixel as usize + k;
            let (share, lit) = pixel(&masks);
            output.visibility[p] = share;
            output.lit[p * words..(p + 1) * words].copy_from_slice(&split_mask(lit)[..words]);
            output.triangles[p] = self.centres[k].unwrap_or(u32::MAX);
            for (f, &masks) in range.zip(&masks) {
                let (counts, part) = (&mut output.counts, &self.parts[f]);
                let (count, class) = match masks.state {
                    FacetState::Empty => (&mut counts.empty_facets, PixelClass::Empty),
                    FacetState::Dark => (&mut counts.dark_facets, PixelClass::Dark),
                    FacetState::Lit => (&mut counts.lit_facets, PixelClass::Lit),
                    FacetState::Shadowed => (&mut counts.shadowed_facets, PixelClass::Shadowed),
                    FacetState::Undecided => (&mut counts.silhouette_pixels, PixelClass::Undecided),
                };
                *count += 1;
                if let Some(looks) = &mut frame.looks {
                    looks.classes[p] = looks.classes[p].max(class);
                }
                if let (true, Some(triangle)) = (keep, part.triangle) {
                    frame.facets.push(CpuFacet { pixel: part.pixel, triangle, masks });
                }
            }
        }
        output.counts.facets += self.parts.len() as u64;
        output.counts.complex_pixels += self.complex;
    }
}

/// A list of `needed` elements at most at a time.
fn list(name: &'static str, needed: u64) -> ListUse {
    ListUse { name, needed, capacity: needed, runs: 1 }
}

impl shadows::Known {
    fn look(&self, size: u32) -> DebugMap {
        DebugMap { size, depths: self.depths.clone(), triangles: Vec::new(), marks: self.marked.clone() }
    }
}
