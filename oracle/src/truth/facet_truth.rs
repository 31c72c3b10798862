//! Facet truth: the model of Pan 2009 in `f64`.
//!
//! The samples of a facet lie on the plane of its triangle, where their rays meet it. A sample is occluded if the open
//! segment from there to the light crosses another triangle. The own triangle never occludes, nor does one whose
//! corners all lie on the facet's plane (within 2^-40 of the distance they are measured over) or below it, away from
//! the light. A facet whose seen side faces away from the light is dark.
//!
//! **Validity** (section 3.4, figure 7 of the paper). A triangle that crosses or touches the facet's plane, has a part
//! strictly on the light's side of it and meets the plane in a segment whose image crosses the pixel's closed square,
//! makes the samples beyond the segment's line, seen from the pixel centre, invalid. Triangles that only fall away
//! (convex neighbours) mark nothing, and neither does a line through the centre. A facet whose coverage is not full has
//! no validity lines: its coverage already says which samples it represents.
//!
//! **Ambiguity.** Distances on the image to the lines of each shadow and each validity line are exact here, so lines are
//! used rather than probes around each sample: they also notice slivers. A sample that no triangle shadows is ambiguous
//! if it is within [`AMBIGUITY`] of one's shadow. A shadowed sample is not if it lies in one shadow by more than that;
//! else eight places around it are probed, so that the edge shared by two casters, whose shadows together leave no gap,
//! is not counted as an edge; so is one that an alpha-tested triangle's shadow comes near, for the edges of its holes. The two sides
//! of each line within [`AMBIGUITY`] are probed as well, as close to it as `f64` tells: where halves of two sheets are holes, what is
//! left between their edges may be far thinner than the band. A facet that the eye sees edge-on, by the rule for lights (2^-40), is ambiguous, whole. What a triangle does that rises over the facet's plane by no more than 2^-36 of the distance is
//! ambiguous, too: whether it rises at all is left to rounding.

use super::beam::Beam;
use super::predicate::{Cover, FacetPlane, Line, Plane, Shadow};
use super::{AMBIGUITY, Progress, Tracer, bits, full_mask, join_mask, split_mask};
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, PixelRays};
use subpixel_shadows::{Error, Result};

/// Width around a pixel within which candidates are listed, in pixels; above [`AMBIGUITY`].
const REACH: f64 = 1.0 / 64.0;

/// A facet to be judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FacetInput {
    /// Pixel `i + j·width`.
    pub pixel: u32,
    /// The triangle whose plane it lies on.
    pub triangle: u32,
    /// The samples that it represents.
    pub coverage: [u32; 4],
}

/// Truth of a facet. Masks hold only samples of its coverage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FacetResult {
    /// Samples in shadow. All valid ones of a facet that faces away from the light.
    pub occluded: [u32; 4],
    /// Samples whose ray meets the plane in front of the eye and that no validity line cuts off. A facet that faces away
    /// from the light has no validity lines.
    pub valid: [u32; 4],
    /// Samples whose `occluded` could differ within the ambiguity band or the `f64` error bound.
    pub ambiguous_occluded: [u32; 4],
    /// Samples whose `valid` could differ within the ambiguity band or the `f64` error bound.
    pub ambiguous_valid: [u32; 4],
}

impl FacetResult {
    /// Samples of which either answer is ambiguous.
    pub fn ambiguous(&self) -> [u32; 4] {
        split_mask(join_mask(self.ambiguous_occluded) | join_mask(self.ambiguous_valid))
    }
}

/// Judges facets of one view.
#[derive(Clone, Debug)]
pub struct FacetTruth<'a> {
    tracer: &'a Tracer,
    rays: PixelRays,
    /// Homogeneous, world, and relative to the eye.
    light: DVec4,
    local_light: DVec4,
    offsets: Vec<DVec2>,
    width: u32,
    height: u32,
    validity: bool,
}

impl<'a> FacetTruth<'a> {
    /// For facets of `tracer`'s mesh seen by `camera` under `light` in an image of `width` × `height` pixels.
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
        let rays = camera.rays(width, height);
        let light = light.homogeneous();
        let local_light = (light.truncate() - rays.eye * light.w).extend(light.w);
        let offsets = samples.offsets().iter().map(|o| DVec2::new(f64::from(o[0]), f64::from(o[1]))).collect();
        Ok(Self { tracer, rays, light, local_light, offsets, width, height, validity: true })
    }

    /// Leaves the validity lines out, where the coverage masks already say which samples a facet represents: `valid`
    /// then only tells which rays meet the plane. Faster for facets of few samples.
    pub fn without_validity(mut self) -> Self {
        self.validity = false;
        self
    }

    /// Judges every facet, in parallel; results in the order of `facets`. Progress counts facets.
    ///
    /// # Errors
    /// [`Error::Config`] naming the first facet whose pixel or triangle does not exist.
    pub fn judge(&self, facets: &[FacetInput], progress: Progress) -> Result<Vec<FacetResult>> {
        let (pixels, triangles) = (self.width as usize * self.height as usize, self.tracer.triangle_count());
        if let Some((k, f)) =
            facets.iter().enumerate().find(|(_, f)| f.pixel as usize >= pixels || f.triangle as usize >= triangles)
        {
            return Err(Error::Config(format!(
                "facet {k} is of pixel {} of {pixels} and triangle {} of {triangles}",
                f.pixel, f.triangle
            )));
        }
        let done = AtomicUsize::new(0);
        let judge = |part: &[FacetInput]| -> Vec<FacetResult> {
            let results = part.iter().map(|f| Judge::new(self, f).judge()).collect();
            let count = done.fetch_add(part.len(), Ordering::Relaxed) + part.len();
            if let Some(report) = progress {
                report(count, facets.len());
            }
            results
        };
        Ok(facets.par_chunks(512).flat_map_iter(judge).collect())
    }

    /// Judges one facet as if the mesh were its own triangle and `candidates` alone.
    ///
    /// # Panics
    /// If a triangle does not exist.
    pub fn judge_among(&self, facet: &FacetInput, candidates: &[u32]) -> FacetResult {
        Judge::new(self, facet).judge_among(|judge| {
            let place = |&t: &u32| (t, self.tracer.corners(t).map(|c| c - self.rays.eye));
            candidates.iter().filter(|&&t| t != judge.own).map(place).collect()
        })
    }
}

/// One facet being judged.
struct Judge<'a> {
    truth: &'a FacetTruth<'a>,
    own: u32,
    plane: Plane,
    pixel: DVec2,
    /// The asked samples whose rays meet the plane in front of the eye.
    met: u128,
    valid: u128,
    doubt_occluded: u128,
    doubt_valid: u128,
    /// Whether validity lines are looked for: not where the coverage already says which samples are meant.
    validity: bool,
    /// The part of the pixel within which candidates matter.
    low: DVec2,
    high: DVec2,
    /// Distance from the plane's first corner within which its points in the pixel lie.
    around: f64,
    shadows: Vec<Cast>,
}

/// The shadow of a triangle, and where it has holes.
struct Cast {
    shadow: Shadow,
    triangle: u32,
    corners: [DVec3; 3],
    tested: bool,
}

impl<'a> Judge<'a> {
    fn new(truth: &'a FacetTruth<'a>, facet: &FacetInput) -> Self {
        let corners = truth.tracer.corners(facet.triangle).map(|c| c - truth.rays.eye);
        let pixel = DVec2::new(f64::from(facet.pixel % truth.width), f64::from(facet.pixel / truth.width));
        let asked = join_mask(facet.coverage) & full_mask(truth.offsets.len() as u32);
        let mut judge = Self {
            truth,
            own: facet.triangle,
            plane: Plane::new(corners),
            pixel,
            met: 0,
            valid: 0,
            doubt_occluded: 0,
            doubt_valid: 0,
            validity: truth.validity && asked == full_mask(truth.offsets.len() as u32),
            low: DVec2::ZERO,
            high: DVec2::ONE,
            around: f64::INFINITY,
            shadows: Vec::new(),
        };
        let slope = judge.slope(judge.plane.normal);
        for k in bits(asked) {
            let r = judge.ray(truth.offsets[k]);
            judge.met |= u128::from(judge.meets(r)) << k;
            judge.doubt_valid |= u128::from(judge.plane.normal.dot(r).abs() <= slope * AMBIGUITY) << k;
        }
        judge.doubt_occluded = judge.doubt_valid;
        if judge.plane.is_eye_open() {
            judge.doubt_occluded |= asked;
        }
        judge.valid = judge.met;
        if !judge.validity {
            let met = || bits(judge.met).map(|k| truth.offsets[k]);
            (judge.low, judge.high) = (met().fold(DVec2::ONE, DVec2::min), met().fold(DVec2::ZERO, DVec2::max));
        }
        let first = judge.plane.corners[0];
        let reach = |(low, high): (DVec3, DVec3)| (low - first).abs().max((high - first).abs()).length();
        judge.around = judge.patch().map_or(f64::INFINITY, reach);
        judge
    }

    fn ray(&self, offset: DVec2) -> DVec3 {
        self.truth.rays.direction(self.pixel.x + offset.x, self.pixel.y + offset.y)
    }

    /// Change of `normal·r` over one pixel across its line.
    fn slope(&self, normal: DVec3) -> f64 {
        normal.dot(self.truth.rays.step_x).hypot(normal.dot(self.truth.rays.step_y))
    }

    /// Whether the ray meets the facet's plane in front of the eye.
    fn meets(&self, r: DVec3) -> bool {
        let along = self.plane.normal.dot(r);
        self.plane.side_of_eye() != 0.0 && along * self.plane.distance > 0.0
    }

    fn judge(self) -> FacetResult {
        self.judge_among(Self::candidates)
    }

    fn judge_among(mut self, candidates: impl Fn(&Self) -> Vec<(u32, [DVec3; 3])>) -> FacetResult {
        let (eye, light) = (self.plane.side_of_eye(), self.plane.side_of_light(self.truth.local_light));
        if self.plane.is_light_open(self.truth.local_light) {
            self.doubt_occluded |= self.met;
        }
        if !self.truth.tracer.receives(self.own) {
            return self.result(0);
        }
        if self.met == 0 || eye * light <= 0.0 {
            return self.result(self.met);
        }
        let candidates = candidates(&self);
        for &(triangle, corners) in &candidates {
            let heights = corners.map(|c| light * self.plane.height(c));
            let rises = |(&h, &c): (&f64, &DVec3)| h > 0.0 && !self.plane.is_nearly_on(c);
            if heights.iter().zip(&corners).any(rises) {
                self.add_shadow(triangle, corners);
                if self.validity && heights.iter().any(|&h| h <= 0.0) {
                    self.cut(corners, heights);
                }
            } else if heights.iter().any(|&h| h > 0.0) {
                self.add_doubt(corners, heights);
            }
        }
        let occluded = self.occlusion();
        self.result(occluded)
    }

    fn result(&self, occluded: u128) -> FacetResult {
        FacetResult {
            occluded: split_mask(occluded),
            valid: split_mask(self.valid),
            ambiguous_occluded: split_mask(self.doubt_occluded),
            ambiguous_valid: split_mask(self.doubt_valid),
        }
    }

    /// Every other triangle that may shadow or cut the facet within its pixel, relative to the eye.
    fn candidates(&self) -> Vec<(u32, [DVec3; 3])> {
        let truth = self.truth;
        let mut out = Vec::new();
        let mut take = |triangle: u32| {
            if triangle != self.own {
                out.push((triangle, truth.tracer.corners(triangle).map(|c| c - truth.rays.eye)));
            }
        };
        match self.patch() {
            Some((low, high)) => {
                let eye = truth.rays.eye;
                truth.tracer.visit_beam(&Beam::towards(eye + low, eye + high, truth.light), &mut take);
            }
            None => (0..truth.tracer.triangle_count() as u32).for_each(take),
        }
        out
    }

    fn ground(&self) -> FacetPlane<'_> {
        FacetPlane { plane: &self.plane, around: self.around }
    }

    /// The box of the facet over its part of the pixel, widened; `None` if it reaches the horizon of its plane.
    fn patch(&self) -> Option<(DVec3, DVec3)> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for x in [self.low.x - REACH, self.high.x + REACH] {
            for y in [self.low.y - REACH, self.high.y + REACH] {
                let r = self.ray(DVec2::new(x, y));
                let along = self.plane.normal.dot(r);
                if !self.meets(r) || along.abs() <= self.slope(self.plane.normal) * REACH {
                    return None;
                }
                let p = r * (self.plane.distance / along);
                (low, high) = (low.min(p), high.max(p));
            }
        }
        Some((low, high))
    }

    fn add_shadow(&mut self, triangle: u32, corners: [DVec3; 3]) {
        let truth = self.truth;
        let shadow = Shadow::new(self.ground(), corners, truth.local_light, &truth.rays);
        let (centre, half) = ((self.low + self.high) * 0.5, (self.high - self.low) * 0.5);
        if shadow.may_reach(self.ray(centre), truth.rays.step_x * half.x, truth.rays.step_y * half.y) {
            let tested = truth.tracer.is_tested(triangle);
            self.shadows.push(Cast { shadow, triangle, corners, tested });
        }
    }

    /// Leaves open what a triangle does that may or may not rise over the facet's plane.
    fn add_doubt(&mut self, corners: [DVec3; 3], heights: [f64; 3]) {
        let truth = self.truth;
        let shadow = Shadow::new(self.ground(), corners, truth.local_light, &truth.rays);
        let near = |&k: &usize| shadow.comes_near(self.ray(truth.offsets[k]), &truth.rays);
        self.doubt_occluded |= bits(self.met).filter(near).fold(0, |mask, k| mask | 1 << k);
        if self.validity {
            let valid = self.valid;
            self.cut(corners, heights);
            self.doubt_valid |= valid & !self.valid;
            self.valid = valid;
        }
    }

    fn occlusion(&mut self) -> u128 {
        let mut occluded = 0u128;
        for k in bits(self.met) {
            let r = self.ray(self.truth.offsets[k]);
            let (mut sure, mut inside, mut near) = (false, false, false);
            for cast in &self.shadows {
                match cast.shadow.cover(r) {
                    Cover::Out => {}
                    cover if cast.tested => {
                        // An edge of a hole is no line: it is looked for around the sample.
                        near = true;
                        inside |= cover != Cover::Near(false) && self.is_solid(cast, r);
                    }
                    Cover::Near(yes) => {
                        near = true;
                        inside |= yes;
                    }
                    Cover::In => {
                        sure = true;
                        break;
                    }
                }
            }
            if sure || inside {
                occluded |= 1 << k;
            }
            if !sure && near && self.changes_around(self.truth.offsets[k], inside) {
                self.doubt_occluded |= 1 << k;
            }
        }
        occluded
    }

    /// Whether the answer `inside` of a sample is another within [`AMBIGUITY`] of it.
    fn changes_around(&self, offset: DVec2, inside: bool) -> bool {
        let here = self.ray(offset);
        let covered = |r: DVec3| self.shadows.iter().any(|s| s.shadow.covers(r) && (!s.tested || self.is_solid(s, r)));
        let around = |wanted: bool| {
            [-AMBIGUITY, 0.0, AMBIGUITY].iter().any(|&x| {
                [-AMBIGUITY, 0.0, AMBIGUITY].iter().any(|&y| covered(self.ray(offset + DVec2::new(x, y))) == wanted)
            })
        };
        if !inside {
            let comes_near = |s: &Cast| !s.tested && s.shadow.comes_near(here, &self.truth.rays);
            return self.shadows.iter().any(comes_near) || (self.shadows.iter().any(|s| s.tested) && around(true));
        }
        // The error of a line may be more than the band.
        if !self.shadows.iter().any(|s| s.shadow.surely_covers(here)) {
            return true;
        }
        around(false) || self.beside_lines(here).any(|r| !covered(r))
    }

    /// Rays on both sides of each line that is within [`AMBIGUITY`] of ray `r`, where they are nearest to it and just not on the line.
    fn beside_lines(&self, r: DVec3) -> impl Iterator<Item = DVec3> {
        let rays = &self.truth.rays;
        let near = self.shadows.iter().filter(move |cast| matches!(cast.shadow.cover(r), Cover::Near(_)));
        near.flat_map(|cast| cast.shadow.lines).flat_map(move |line| line.sides(r, rays).into_iter().flatten())
    }

    /// Whether a caster is there between the light and the facet's point on a ray.
    fn is_solid(&self, cast: &Cast, r: DVec3) -> bool {
        let point = r * (self.plane.distance / self.plane.normal.dot(r));
        self.truth.tracer.is_solid_towards(cast.triangle, cast.corners, point, self.truth.local_light)
    }

    /// Takes the samples beyond the line of a triangle that rises through the facet out of the valid ones.
    fn cut(&mut self, corners: [DVec3; 3], heights: [f64; 3]) {
        let segment = crossing(corners, heights);
        let (surely, maybe) = (self.crosses_pixel(segment, -AMBIGUITY), self.crosses_pixel(segment, AMBIGUITY));
        if !maybe {
            return;
        }
        let line = Line::of_plane(self.ground(), &Plane::new(corners), &self.truth.rays);
        let value = |r: DVec3| (line.line.dot(r), line.error * r.length());
        let (centre, centre_error) = value(self.ray(DVec2::splat(0.5)));
        let cuts = self.crosses_pixel(segment, 0.0) && centre.abs() > centre_error;
        // With the centre this near to the line, either side may be the one to go.
        let either = centre.abs() <= centre_error + line.margin;
        for k in bits(self.met) {
            let (at, error) = value(self.ray(self.truth.offsets[k]));
            let beyond = at * centre < 0.0;
            if cuts && beyond {
                self.valid &= !(1 << k);
            }
            if either || at.abs() <= line.margin + error || (beyond && !surely) {
                self.doubt_valid |= 1 << k;
            }
        }
    }

    /// Whether the image of a segment crosses the pixel's closed square grown by `grow` pixels.
    ///
    /// In homogeneous image coordinates `p = depth·(corner + x·step_x + y·step_y)` the four sides are linear in the
    /// point, and points behind the eye fail one of an opposite pair; so the segment is clipped without a division by
    /// depth.
    fn crosses_pixel(&self, segment: [DVec3; 2], grow: f64) -> bool {
        let rays = &self.truth.rays;
        // Rows of the inverse of (corner, step_x, step_y), times its determinant, whose sign is taken out.
        let across = rays.step_x.cross(rays.step_y);
        let sign = across.dot(rays.corner).signum();
        let (depth, x, y) =
            (across * sign, rays.step_y.cross(rays.corner) * sign, rays.corner.cross(rays.step_x) * sign);
        let (i, j) = (self.pixel.x, self.pixel.y);
        let sides = [
            x - depth * (i - grow),
            depth * (i + 1.0 + grow) - x,
            y - depth * (j - grow),
            depth * (j + 1.0 + grow) - y,
        ];
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for side in sides {
            let (from, to) = (side.dot(segment[0]), side.dot(segment[1]));
            if from < 0.0 && to < 0.0 {
                return false;
            }
            if from < 0.0 {
                first = first.max(from / (from - to));
            } else if to < 0.0 {
                last = last.min(from / (from - to));
            }
        }
        first <= last
    }
}

/// The segment in which a triangle with corners at these heights meets height 0; both ends alike where it only touches.
fn crossing(corners: [DVec3; 3], heights: [f64; 3]) -> [DVec3; 2] {
    let mut ends = [None; 2];
    let mut add = |p: DVec3| {
        if ends[0].is_none() {
            ends[0] = Some(p);
        } else {
            ends[1] = Some(p);
        }
    };
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (p, q, h, g) = (corners[i], corners[j], heights[i], heights[j]);
        if h == 0.0 {
            add(p);
        } else if h * g < 0.0 {
            add(p + (q - p) * (h / (h - g)));
        }
    }
    let first = ends[0].unwrap_or(corners[0]);
    [first, ends[1].unwrap_or(first)]
}

#[cfg(test)]
mod tests;
