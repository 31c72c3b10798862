//! Scene truth: what each sample of the image sees, and whether the light reaches it.
//!
//! Every sample sends a primary ray to the nearest surface beyond the near distance, and from that point of the
//! triangle's plane a shadow ray towards the light. A pixel's truth is the lit share of its samples that see a surface;
//! where none does, visibility is 1. A point whose seen side faces away from the light has visibility 0. A triangle
//! whose plane holds the point within the `f64` error bound does not occlude it.
//!
//! **Ambiguity.** A sample is ambiguous if its whole answer (sees a surface, is lit) is another at one of eight places
//! around it, the corners and side middles of a square of half-width [`AMBIGUITY`], or if an edge within the error
//! bound decided it. The square holds the disc, so every straight edge within [`AMBIGUITY`] of the sample is noticed,
//! and an edge between surfaces of one answer is not. A sliver that passes between the nine places is not noticed.
//! Shadow edges and edges of the camera view need no cases of their own. It is evaluated where it is asked for.

use super::packet::{Lit, PACKET, Seen, see};
use super::{AMBIGUITY, Progress, Tracer, full_mask, join_mask, split_mask};
use crate::reference::pixel_filter;
use glam::{DVec2, DVec4};
use rayon::prelude::*;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use subpixel_shadows::pixel_filter::PixelFilter;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, PixelRays};
use subpixel_shadows::{Error, Result};

/// Samples of a pixel so many that more change nothing.
static OFFSETS: LazyLock<Vec<DVec2>> = LazyLock::new(|| {
    let place = |k: u32, step: f64| (0.5 + f64::from(k) * step).fract();
    let at = |k| DVec2::new(place(k, 0.754_877_666_246_692_7), place(k, 0.569_840_290_998_053_2));
    (0..1024).map(at).collect()
});

/// The truth of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelTruth {
    /// Lit share of the samples that see a surface; 1 where none does.
    pub visibility: f32,
    /// How many samples see a surface.
    pub seen_count: u32,
    /// Samples that see a surface which the light reaches. Bit `k % 32` of word `k / 32` is sample `k`.
    pub lit: [u32; 4],
    /// Samples that see a surface.
    pub seen: [u32; 4],
    /// Samples whose answer an edge within the `f64` error bound decided. [`SceneTruth::mark_ambiguous`] adds those
    /// within the ambiguity band.
    pub ambiguous: [u32; 4],
    /// Whether the pixel centre sees a surface.
    pub centre_hit: bool,
}

/// The truth of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruthImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples a pixel.
    pub samples: u32,
    /// The pixels, row by row from the top.
    pub pixels: Vec<PixelTruth>,
}

impl TruthImage {
    /// Visibility of each pixel, row by row from the top.
    pub fn visibility(&self) -> Vec<f32> {
        self.pixels.iter().map(|p| p.visibility).collect()
    }

    /// Visibility of each pixel by a filter over its samples, which were `samples`, and those around it.
    pub fn filtered(&self, filter: PixelFilter, samples: &Samples) -> Vec<f32> {
        if filter == PixelFilter::Box {
            return self.visibility();
        }
        let [lit, seen]: [Vec<u128>; 2] = [|p: &PixelTruth| p.lit, |p: &PixelTruth| p.seen]
            .map(|mask| self.pixels.iter().map(|p| join_mask(mask(p))).collect());
        let size = [self.width, self.height];
        pixel_filter::visibility(filter, samples, size, &lit, &seen).into_iter().map(|share| share as f32).collect()
    }

    /// Whether each pixel's centre sees a surface.
    pub fn centre_hits(&self) -> Vec<bool> {
        self.pixels.iter().map(|p| p.centre_hit).collect()
    }
}

/// Shares of the samples of an image that are ambiguous.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AmbiguousCount {
    /// Ambiguous samples.
    pub ambiguous: u64,
    /// Samples of the pixels that were examined: those whose neighbourhood is not uniform.
    pub examined: u64,
    /// All samples.
    pub all: u64,
}

impl AmbiguousCount {
    /// Ambiguous share of the samples that were examined: near silhouettes and shadow edges. 0 without any.
    pub fn share(&self) -> f64 {
        if self.examined == 0 { 0.0 } else { self.ambiguous as f64 / self.examined as f64 }
    }
}

/// Evaluates the truth of a view.
#[derive(Clone, Debug)]
pub struct SceneTruth<'a> {
    tracer: &'a Tracer,
    rays: PixelRays,
    light: DVec4,
    offsets: Vec<DVec2>,
    width: u32,
    height: u32,
}

impl<'a> SceneTruth<'a> {
    /// The truth of `tracer`'s mesh seen by `camera` under `light`, for an image of `width` × `height` pixels.
    ///
    /// # Errors
    /// [`Error::Scene`] if the camera or the light cannot be used, [`Error::Config`] if the image has no pixels.
    pub fn new(
        tracer: &'a Tracer,
        camera: &Camera,
        light: &Light,
        samples: &Samples,
        width: u32,
        height: u32,
    ) -> Result<Self> {
        camera.check()?;
        light.check()?;
        if width == 0 || height == 0 {
            return Err(Error::Config(format!("an image of {width} x {height} pixels")));
        }
        let offsets = samples.offsets().iter().map(|o| DVec2::new(f64::from(o[0]), f64::from(o[1]))).collect();
        Ok(Self { tracer, rays: camera.rays(width, height), light: light.homogeneous(), offsets, width, height })
    }

    fn see(&self, pixel: u32, offsets: &[DVec2]) -> Seen {
        let corner = DVec2::new(f64::from(pixel % self.width), f64::from(pixel / self.width));
        see(self.tracer, &self.rays, corner, offsets)
    }

    fn trace(&self, pixel: u32, offsets: &[DVec2]) -> Lit {
        self.see(pixel, offsets).light(self.tracer, &self.rays, self.light)
    }

    /// The truth of pixel `i + j·width`.
    pub fn pixel(&self, pixel: u32) -> PixelTruth {
        let Lit { seen, lit, undecided } = self.trace(pixel, &self.offsets);
        let (seen_count, lit_count) = (seen.count_ones(), lit.count_ones());
        PixelTruth {
            visibility: share(lit_count, seen_count),
            seen_count,
            lit: split_mask(lit),
            seen: split_mask(seen),
            ambiguous: split_mask(undecided),
            centre_hit: seen & 1 != 0,
        }
    }

    /// The surfaces that the samples of a pixel see: triangle and coverage mask, each sample in one of them, in the
    /// order of their first samples.
    pub fn surfaces(&self, pixel: u32) -> Vec<(u32, [u32; 4])> {
        self.see(pixel, &self.offsets).surfaces().map(|(t, mask)| (t, split_mask(mask))).collect()
    }

    /// The truth of all pixels, in parallel.
    pub fn image(&self, progress: Progress) -> TruthImage {
        let pixels = self.each_pixel(progress, |pixel| self.pixel(pixel));
        TruthImage { width: self.width, height: self.height, samples: self.offsets.len() as u32, pixels }
    }

    /// Visibility of all pixels at 1024 samples each, low-discrepancy offsets of its own (the additive recurrence R2,
    /// Roberts 2018), and whether any of them sees a surface.
    pub fn converged(&self, progress: Progress) -> Vec<(f32, bool)> {
        self.each_pixel(progress, |pixel| self.converged_pixel(pixel))
    }

    /// As [`SceneTruth::converged`], weighted by a filter over the samples of a pixel and those around it.
    pub fn converged_by(&self, filter: PixelFilter, progress: Progress) -> Vec<(f32, bool)> {
        if filter == PixelFilter::Box {
            return self.converged(progress);
        }
        let around: Vec<[i32; 2]> = filter.pixels().collect();
        // Weights of the lit and of the seen samples of each pixel, for each of the pixels that have it around them.
        let parts = self.each_pixel(progress, |pixel| {
            let mut sums = vec![[0.0; 2]; around.len()];
            let (mut lit, mut seen) = (0, 0);
            for part in OFFSETS.chunks(PACKET) {
                let answer = self.trace(pixel, part);
                lit += answer.lit.count_ones();
                seen += answer.seen.count_ones();
                for (k, offset) in part.iter().enumerate().filter(|(k, _)| answer.seen >> k & 1 != 0) {
                    let open = f64::from((answer.lit >> k & 1) as u8);
                    for (sum, away) in sums.iter_mut().zip(&around) {
                        let weight = filter.weight_at(*away, offset.to_array());
                        *sum = [sum[0] + open * weight, sum[1] + weight];
                    }
                }
            }
            (sums, share(lit, seen), seen > 0)
        });
        let offsets = OFFSETS.iter().map(DVec2::to_array);
        let all: f64 = around.iter().flat_map(|away| offsets.clone().map(|o| filter.weight_at(*away, o))).sum();
        let [width, height] = [self.width as i32, self.height as i32];
        let of = |pixel: i32| {
            let places = around.iter().enumerate().filter_map(|(k, away)| {
                let [x, y] = [pixel % width + away[0], pixel / width + away[1]];
                ((0..width).contains(&x) && (0..height).contains(&y)).then(|| parts[(y * width + x) as usize].0[k])
            });
            let [open, seen] = places.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            let (_, own, sees) = &parts[pixel as usize];
            let hardly = seen <= pixel_filter::HARDLY * all;
            (if hardly { *own } else { (open / seen).clamp(0.0, 1.0) as f32 }, *sees)
        };
        (0..width * height).map(of).collect()
    }

    /// As [`SceneTruth::converged`], of one pixel.
    pub fn converged_pixel(&self, pixel: u32) -> (f32, bool) {
        let (mut lit, mut seen) = (0, 0);
        for part in OFFSETS.chunks(PACKET) {
            let answer = self.trace(pixel, part);
            lit += answer.lit.count_ones();
            seen += answer.seen.count_ones();
        }
        (share(lit, seen), seen > 0)
    }

    /// The ambiguous samples of a pixel.
    pub fn ambiguous_mask(&self, pixel: u32) -> [u32; 4] {
        let own = self.trace(pixel, &self.offsets);
        let mut mask = own.undecided;
        for x in [-AMBIGUITY, 0.0, AMBIGUITY] {
            for y in [-AMBIGUITY, 0.0, AMBIGUITY] {
                if x != 0.0 || y != 0.0 {
                    let moved: Vec<DVec2> = self.offsets.iter().map(|&o| o + DVec2::new(x, y)).collect();
                    let other = self.trace(pixel, &moved);
                    mask |= (own.seen ^ other.seen) | (own.lit ^ other.lit);
                }
            }
        }
        split_mask(mask)
    }

    /// Whether the answer `[seen, lit]` is that of a place within [`AMBIGUITY`] of a sample along `x` and `y`: looked for on a grid of
    /// 33 × 33, so that slivers are found that pass between the places of [`SceneTruth::ambiguous_mask`]. Costs as much as 1089 samples.
    pub fn answers_nearby(&self, pixel: u32, sample: u32, [seen, lit]: [bool; 2]) -> bool {
        let Some(&at) = self.offsets.get(sample as usize) else { return false };
        let step = |k: i32| f64::from(k) / 16.0 * AMBIGUITY;
        let places: Vec<DVec2> =
            (-16..=16).flat_map(|y| (-16..=16).map(move |x| at + DVec2::new(step(x), step(y)))).collect();
        places.chunks(PACKET).any(|part| {
            let answer = self.trace(pixel, part);
            let wrong = |mask: u128, ours: bool| mask ^ if ours { u128::MAX } else { 0 };
            let full = full_mask(part.len() as u32);
            (wrong(answer.seen, seen) | wrong(answer.lit, lit)) & full != full
        })
    }

    /// Whether one sample of a pixel is ambiguous. For callers that look at few of them: costs as much as the pixel's
    /// whole [`SceneTruth::ambiguous_mask`], nine times the pixel's truth.
    pub fn ambiguous(&self, pixel: u32, sample: u32) -> bool {
        sample < 128 && join_mask(self.ambiguous_mask(pixel)) >> sample & 1 != 0
    }

    /// Fills in the ambiguous mask of each pixel whose neighbourhood of 3 × 3 pixels is not uniform, and counts. Elsewhere
    /// all samples for a pixel around agree, so that only features smaller than the sample distance could be near.
    ///
    /// # Errors
    /// [`Error::Config`] for an image of another size.
    pub fn mark_ambiguous(&self, image: &mut TruthImage, progress: Progress) -> Result<AmbiguousCount> {
        let (ours, theirs) = ([self.width, self.height], [image.width, image.height]);
        if ours != theirs || image.pixels.len() as u64 != u64::from(ours[0]) * u64::from(ours[1]) {
            let ([w, h], [x, y], pixels) = (ours, theirs, image.pixels.len());
            return Err(Error::Config(format!("an image of {x}x{y}, {pixels} pixels, in a truth of {w}x{h}")));
        }
        let full = full_mask(image.samples);
        let state = |p: &PixelTruth| match (join_mask(p.seen), join_mask(p.lit)) {
            (0, _) => Some(0),
            (seen, 0) if seen == full => Some(1),
            (seen, lit) if seen == full && lit == full => Some(2),
            _ => None,
        };
        let (w, h) = (image.width, image.height);
        let states: Vec<Option<u8>> = image.pixels.iter().map(state).collect();
        let masks = self.each_pixel(progress, |pixel| {
            let (i, j) = (pixel % w, pixel / w);
            let here = states[pixel as usize];
            let uniform = here.is_some()
                && (j.saturating_sub(1)..(j + 2).min(h))
                    .all(|y| (i.saturating_sub(1)..(i + 2).min(w)).all(|x| states[(x + y * w) as usize] == here));
            (!uniform).then(|| self.ambiguous_mask(pixel))
        });
        let mut count = AmbiguousCount { all: u64::from(image.samples) * masks.len() as u64, ..Default::default() };
        for (pixel, mask) in image.pixels.iter_mut().zip(masks) {
            if let Some(mask) = mask {
                pixel.ambiguous = mask;
                count.examined += u64::from(image.samples);
            }
            count.ambiguous += u64::from(join_mask(pixel.ambiguous).count_ones());
        }
        Ok(count)
    }

    fn each_pixel<T: Send>(&self, progress: Progress, f: impl Fn(u32) -> T + Sync) -> Vec<T> {
        let done = AtomicUsize::new(0);
        (0..self.height)
            .into_par_iter()
            .flat_map_iter(|j| {
                let row: Vec<T> = (0..self.width).map(|i| f(i + j * self.width)).collect();
                let rows = done.fetch_add(1, Ordering::Relaxed) + 1;
                if let Some(report) = progress {
                    report(rows, self.height as usize);
                }
                row
            })
            .collect()
    }
}

fn share(lit: u32, seen: u32) -> f32 {
    if seen == 0 { 1.0 } else { lit as f32 / seen as f32 }
}
