//! Light views for slices of what the camera sees: parallel splits (Zhang et al. 2006), each warped so that the map has more texels
//! for what is near the eye (trapezoidal shadow maps: Martin and Tan 2004; light-space perspective shadow maps: Wimmer, Scherzer,
//! Purgathofer 2004), as Oliveira 2009 brings them together (sections 3.2, 3.3 and 4.2).
//!
//! A warp is a projective map of the texels of the whole view. Depth stays that of the whole view (Oliveira, section 3.2.3).

use super::{LightView, PartBy, SeenBox, SplitPlan, Warp, unit_scale};
use crate::scene::Camera;
use glam::{DMat3, DVec2, DVec3, DVec4};

/// The light's view of a slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SplitView {
    /// The part of the scene seen in it.
    seen: SeenBox,

    /// Takes texel `(x, y, 1)` of the whole view to `(x, y, 1) · w` of this one; `w` is 1 where it is least, and more elsewhere.
    warp: DMat3,
    /// Rows that take a point `(p, 1)` to texel x, y (times the third) and the divisor.
    rows: [DVec4; 3],
    /// View depth at which the slice ends; the last has no end.
    end: f64,
    /// View depths that it was made for.
    range: [f64; 2],
}

/// Where the slices of depths `near` to `far` end (Oliveira, section 3.3.1, the practical scheme with `b = 0`), by a
/// [weight](SplitPlan::weight).
fn ends(near: f64, far: f64, splits: u32, weight: f64) -> Vec<f64> {
    let end = |i: u32| {
        let share = f64::from(i) / f64::from(splits);
        weight * near * (far / near).powf(share) + (1.0 - weight) * (near + (far - near) * share)
    };
    (1..=splits).map(|i| if i == splits { far } else { end(i) }).collect()
}

impl LightView {
    /// Share of its depth by which slices overlap where a pixel asks one: as far as most pixels reach along the view.
    pub const OVERLAP: f64 = 1.0 / 32.0;

    /// The views of all slices of what is seen, near to far, whose rows take points of the space of this view's, the space of `seen`.
    /// The last has no end. One slice at the least, [`SplitPlan::MOST`] at most. Each begins before the end of the one in front of it by a
    /// share `overlap` of its depth. `told`: depths that pixels see; with an overlap slices hold these alone.
    pub(super) fn split(
        &self,
        seen: &SeenBox,
        plan: &SplitPlan,
        overlap: f64,
        told: Option<[f64; 2]>,
    ) -> Vec<SplitView> {
        let splits = plan.splits.clamp(1, SplitPlan::MOST);
        let depths = self.seen_depths(seen).filter(|_| plan.warp != Warp::Whole);
        let Some([near, far]) = depths else {
            return vec![split_view(self, seen, DMat3::IDENTITY, f64::INFINITY); splits as usize];
        };
        if plan.by == PartBy::FrustumFaces {
            return self.of_parts(seen.faces(self, overlap), plan, [near, far]);
        }
        // Pixel centres told them: samples see somewhat more.
        let around = |[first, last]: [f64; 2]| {
            [first * (1.0 - LightView::OVERLAP), last * (1.0 + LightView::OVERLAP)].map(|d| d.clamp(near, far))
        };
        let told = told.filter(|_| plan.by == PartBy::SeenDepth).map(around);
        let cut = told.unwrap_or([near, far]);
        let held = if overlap > 0.0 { cut } else { [near, far] };
        let mut from = held[0];
        let mut slices = ends(cut[0], cut[1], splits, plan.weight);
        if let Some(last) = slices.last_mut() {
            *last = held[1];
        }
        let slice = |end: f64| {
            let range = [(from * (1.0 - overlap)).max(held[0]), end];
            from = end;
            SplitView { range, ..self.slice(seen, plan, range, 0.0) }
        };
        let mut views: Vec<SplitView> = slices.into_iter().map(slice).collect();
        if let Some(last) = views.last_mut() {
            last.end = f64::INFINITY;
        }
        views
    }

    /// Between which depths what is seen lies in the view; `None` if nothing does.
    pub(super) fn seen_depths(&self, seen: &SeenBox) -> Option<[f64; 2]> {
        let farthest = seen.box_corners().map(|p| p.dot(seen.forward)).fold(0.0, f64::max) * (1.0 + 1e-9);
        let [near, far] = seen.range(self, seen.near, farthest.max(seen.near))?;
        Some([near, far.max(near)])
    }

    /// The views of parts of what is seen between two depths, those that spread least first: a place that several hold asks the first.
    pub(super) fn of_parts(&self, parts: Vec<SeenBox>, plan: &SplitPlan, [near, far]: [f64; 2]) -> Vec<SplitView> {
        let of_part = |part: SeenBox| {
            let range = part.range(self, near, far)?;
            Some(SplitView { range, end: f64::INFINITY, ..self.slice(&part, plan, range, 0.0) })
        };
        let mut views: Vec<SplitView> = parts.into_iter().filter_map(of_part).collect();
        views.sort_by(|a, b| self.spread(a.warp).total_cmp(&self.spread(b.warp)));
        views
    }

    /// A view of this light for each slice of what a camera sees between two corners of a box, near to far, in world units as this one's
    /// rows are: together they hold every point there that this view holds. Depth along a ray of light still grows, as the divisor of a
    /// warp is the same all along it. Of a light at a point texels lie evenly. Texels are no smaller than single precision tells points apart:
    /// warps are as much weaker as that takes.
    /// Each slice begins before the end of the one in front of it by a share `overlap` of its depth. `depths`: view depths between which pixels
    /// see anything, in world units, for [`PartBy::SeenDepth`]: slices are cut between them. With an overlap, where a pixel asks one view, slices
    /// hold nothing else; without, the first and the last hold all that is nearer and farther, too.
    pub fn slices(
        &self,
        camera: &Camera,
        size: [u32; 2],
        bounds: (DVec3, DVec3),
        plan: &SplitPlan,
        overlap: f64,
        depths: Option<[f32; 2]>,
    ) -> Vec<LightView> {
        self.views_of(camera, size, bounds, plan, |whole, seen, plan, (_, scale)| {
            let depths = depths.map(|depths| depths.map(|depth| f64::from(depth) * scale));
            whole.split(seen, plan, overlap, depths)
        })
    }

    /// The views of parts of what a camera sees, which `parts` makes in a space of an eye and a scale; see [`LightView::slices`].
    pub(super) fn views_of(
        &self,
        camera: &Camera,
        size: [u32; 2],
        bounds: (DVec3, DVec3),
        plan: &SplitPlan,
        parts: impl Fn(&LightView, &SeenBox, &SplitPlan, (DVec3, f64)) -> Vec<SplitView>,
    ) -> Vec<LightView> {
        let rays = camera.rays(size[0], size[1]);
        let scale = unit_scale(rays.eye, bounds);
        let seen = SeenBox::new(&rays, size, f64::from(camera.near), bounds, scale);
        let whole = self.relative_to(rays.eye, scale);
        // A warp bends what a light at a point sees twice: what is near to it would come to lie behind its view.
        let bent = self.perspective && plan.warp != Warp::Whole;
        let plan = SplitPlan { warp: if bent { Warp::Box } else { plan.warp }, ..*plan };
        // Rounding stays a fraction of a texel, and what casts in front.
        let even = if self.perspective { whole.noise_in_texels().even.max(whole.clear / 8.0) } else { 0.1 * scale };
        let by_divisor = whole.noise_in_texels().by_divisor.max(0.25);
        let of_slice = |split: &SplitView| {
            let SplitView { rows: [u, v, w], .. } = split_view(self, &split.seen, split.warp, split.end);
            // Nowhere in the slice is the divisor of the warp less than 1.
            let near = if self.perspective { self.near } else { 0.5 };
            // Without a warp the divisor is that of the whole view.
            let clear = if self.perspective { self.clear } else { 0.0 };
            let slice =
                Self { u, v, w, near, clear, perspective: true, one_of_several: true, ends: [false; 4], ..*self };
            let noise = slice.relative_to(rays.eye, scale).noise_in_texels();
            (slice, (even / noise.even).min(by_divisor / noise.by_divisor).min(1.0))
        };
        // The strongest warp whose texels are large enough, if one of them has such.
        let weaker = |warped: &SplitView| {
            let by = |weaker: f64| match of_slice(&whole.slice(&warped.seen, &plan, warped.range, weaker)) {
                (slice, 1.0) => Some(slice),
                _ => None,
            };
            let (mut low, mut high, mut found) = (0.0, WEAKEST, by(WEAKEST)?);
            for _ in 0..16 {
                let middle = 0.5 * (low + high);
                match by(middle) {
                    Some(slice) => (high, found) = (middle, slice),
                    None => low = middle,
                }
            }
            Some(found)
        };
        let bends = !matches!(plan.warp, Warp::Whole | Warp::Box | Warp::Stable);
        let coarse_enough = |warped: SplitView| match of_slice(&warped) {
            (slice, 1.0) => slice,
            _ => {
                if let Some(slice) = bends.then(|| weaker(&warped)).flatten() {
                    return slice;
                }
                // Where a map without a warp holds more than the slice, no point of it has another divisor.
                let even = || whole.slice(&warped.seen, &SplitPlan { warp: Warp::Box, ..plan }, warped.range, 0.0);
                let (slice, by) = of_slice(&if plan.warp == Warp::Whole { warped } else { even() });
                slice.coarser(by)
            }
        };
        parts(&whole, &seen, &plan, (rays.eye, scale)).into_iter().map(coarse_enough).collect()
    }

    /// The view of what is seen between two view depths, whose warp is that of the plan and, by a power of 2, `weaker`.
    fn slice(&self, seen: &SeenBox, plan: &SplitPlan, [from, end]: [f64; 2], weaker: f64) -> SplitView {
        let slack = 1e-6 * end;
        let [from, to] = [(from - slack).max(seen.near), end + slack];
        let part = seen.part(self, from, to);
        let texels: Vec<DVec2> = part.iter().filter_map(|&p| self.project(p)).map(DVec3::truncate).collect();
        if texels.is_empty() {
            return split_view(self, seen, DMat3::IDENTITY, end);
        }
        if plan.warp == Warp::Stable && !self.perspective {
            return split_view(self, seen, onto_texels(self.map_size) * self.over_sphere(seen, [from, to]), end);
        }
        let axis = |share: f64| self.project(seen.axis * (from + (to - from) * share)).map(DVec3::truncate);
        let probes = if plan.warp == Warp::Fitted { seen.probes(self, from, to) } else { Vec::new() };
        let distance = |along: &Along| match plan.warp {
            Warp::Trapezoid => axis(plan.focus).map(|focus| along.by_focus(focus)),
            Warp::LightSpace => along.by_light_space(self, seen.axis, [from, to], |n, f| n + (n * f).sqrt()),
            Warp::Perspective => along.by_light_space(self, seen.axis, [from, to], |n, _| n),
            Warp::Fitted => along.by_probes(&texels, &probes),
            Warp::Whole | Warp::Box | Warp::Stable => None,
        };
        let along = axis(0.0).zip(axis(1.0)).and_then(|(near, far)| Along::new(&texels, near, far));
        // From a row to the next the divisor then changes by at most a tenth, and in all by a factor of at most 11.
        let least = (10.0 / f64::from(self.map_size)).max(0.1);
        let warp = along.and_then(|along| {
            let distance = distance(&along)?.max(least * (along.high - along.low));
            Some(along.trapezoid(&texels, distance * weaker.exp2()))
        });
        let boxed = over_box(&texels);
        let warp = match (plan.warp, warp) {
            (Warp::Fitted, Some(warp)) if coarseness(warp, &probes) > coarseness(boxed, &probes) => boxed,
            (_, warp) => warp.unwrap_or(boxed),
        };
        split_view(self, seen, onto_texels(self.map_size) * warp, end)
    }
}

impl LightView {
    /// From the square around the sphere that holds what an image sees between two view depths to the unit square. The depths are taken to the next
    /// steps of a fourth root of 2, so that the sphere keeps its size for a while, and its middle to whole texels of the map that this makes.
    fn over_sphere(&self, seen: &SeenBox, [from, to]: [f64; 2]) -> DMat3 {
        let step = |depth: f64, up: f64| ((4.0 * depth.max(1e-9).log2() + up).floor() / 4.0).exp2();
        let [near, far] = [step(from, 0.0), step(to, 1.0)];
        // Corners of the image lie this far from its axis, squared, at view depth 1.
        let wide = seen.corners.iter().map(|c| c.length_squared() - 1.0).fold(0.0, f64::max);
        let middle = (0.5 * (near + far) * (1.0 + wide)).min(far);
        let reach = |depth: f64| (depth - middle).powi(2) + wide * depth * depth;
        let radius = reach(near).max(reach(far)).sqrt();
        let across = onto_texels(self.map_size).x_axis.x.max(1e-9);
        let place = self.project(seen.forward * middle).unwrap_or_default();
        let axis = |row: DVec4, at: f64| {
            // A texel more on each side, for the steps of the middle.
            let side = 2.0 * radius * row.truncate().length() * (1.0 + 2.0 / across);
            let texel = side / across;
            (1.0 / side, (0.5 * side - (at / texel).round() * texel) / side)
        };
        let ((x, left), (y, top)) = (axis(self.u, place.x), axis(self.v, place.y));
        rows(DVec3::new(x, 0.0, left), DVec3::new(0.0, y, top), DVec3::Z)
    }
}

/// The weakest warp that is tried where texels would be too small: by two to this the distance at which its sides meet.
const WEAKEST: f64 = 10.0;

fn split_view(view: &LightView, seen: &SeenBox, warp: DMat3, end: f64) -> SplitView {
    let row = |k: usize| {
        let by = warp.row(k);
        view.u * by.x + view.v * by.y + view.w * by.z
    };
    SplitView { seen: *seen, warp, rows: [row(0), row(1), row(2)], end, range: [0.0, end] }
}

/// The matrix of these rows.
fn rows(x: DVec3, y: DVec3, w: DVec3) -> DMat3 {
    DMat3::from_cols(x, y, w).transpose()
}

/// From the unit square to the texels of a map, but for a border that holds what filters reach.
fn onto_texels(map_size: u32) -> DMat3 {
    let side = f64::from(map_size);
    let border = (side / 8.0).min(1.5);
    let across = side - 2.0 * border;
    rows(DVec3::new(across, 0.0, border), DVec3::new(0.0, across, border), DVec3::Z)
}

/// From the box around these texels to the unit square.
fn over_box(texels: &[DVec2]) -> DMat3 {
    let (lo, hi) = texels.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let by = DVec2::ONE / (hi - lo).max(DVec2::splat(1e-3));
    rows(DVec3::new(by.x, 0.0, -lo.x * by.x), DVec3::new(0.0, by.y, -lo.y * by.y), DVec3::Z)
}

/// The wider sides of texels of a map beside pixels, in the mean over [probes](SeenBox::probes), but for a factor.
fn coarseness(m: DMat3, probes: &[(DVec2, f64)]) -> f64 {
    // In texels of the whole view.
    let width = |texel: DVec2| {
        let q = m * texel.extend(1.0);
        let by = |k: usize, at: f64| (m.row(k) - m.row(2) * at).truncate() / q.z;
        let (x, y) = (by(0, q.x / q.z), by(1, q.y / q.z));
        let (sum, area) = (x.length_squared() + y.length_squared(), x.perp_dot(y));
        let longest = (0.5 * (sum + (sum * sum - 4.0 * area * area).max(0.0).sqrt())).sqrt();
        longest / area.abs()
    };
    probes.iter().map(|&(texel, weight)| width(texel) * weight).sum()
}

/// The texels of what is seen of a slice along the line that the view direction takes on the map.
#[derive(Clone, Copy, Debug)]
struct Along {
    /// Unit direction of the line, from near to far.
    dir: DVec2,
    /// Where across it the line runs.
    across: f64,
    /// The least of the texels along the line: the top line of the trapezoid.
    low: f64,
    /// The greatest: its base line.
    high: f64,
}

impl Along {
    /// The line from `near` to `far`, where the axis of the camera enters and leaves the slice. `None` where camera and light look
    /// along nearly one line (*duelling frusta*), so that there is no near and far on the map.
    fn new(texels: &[DVec2], near: DVec2, far: DVec2) -> Option<Self> {
        let dir = (far - near).try_normalize()?;
        let range = |d: DVec2| {
            texels.iter().map(|p| d.dot(*p)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)))
        };
        let ((low, high), (left, right)) = (range(dir), range(dir.perp()));
        let wide = (high - low).max(right - left);
        let there = high - low > 1e-3 && near.distance(far) > 0.1 * wide;
        there.then_some(Self { dir, across: dir.perp().dot(near), low, high })
    }

    fn at(&self, texel: DVec2) -> f64 {
        self.dir.dot(texel)
    }

    /// Distance of the centre of projection before the top line by which what lies before `focus` gets 80 % of the rows
    /// (Oliveira, appendix A, with the 80 % line at -0.6).
    fn by_focus(&self, focus: DVec2) -> f64 {
        let length = self.high - self.low;
        let d = (self.at(focus) - self.low).clamp(0.01 * length, 0.799 * length);
        0.2 * length * d / (0.8 * length - d)
    }

    /// Likewise a distance of the slice's ends over the sine of the angle between view and light: that by which the greatest error is least
    /// is `n + sqrt(n f)` (Wimmer et al. 2004, section 4.3), and by `n` alone the centre is the eye. `None` if the eye is not in front of
    /// the light.
    fn by_light_space(
        &self,
        view: &LightView,
        axis: DVec3,
        [near, far]: [f64; 2],
        distance: impl Fn(f64, f64) -> f64,
    ) -> Option<f64> {
        let eye = self.at(view.project(DVec3::ZERO)?.truncate());
        let from_eye = |depth: f64| view.project(axis * depth).map(|p| (self.at(p.truncate()) - eye).max(0.0));
        let (n, f) = (from_eye(near)?, from_eye(far)?);
        // What the view looks along: texels do not change.
        let p = (axis * far).extend(1.0);
        let place = view.project(axis * far)?;
        let change = |row: DVec4, at: f64| (row - view.w * at).truncate() / view.w.dot(p);
        let sight = change(view.u, place.x).cross(change(view.v, place.y)).try_normalize()?;
        // Once for the angle, and once as distances on the map are foreshortened by it already.
        let sine_squared = sight.cross(axis.normalize()).length_squared().max(1e-4);
        let length = self.high - self.low;
        Some((distance(n, f) / sine_squared).min(1e3 * length))
    }

    /// Likewise by which texels are smallest beside pixels, in the mean over probes; `None` without a probe.
    fn by_probes(&self, texels: &[DVec2], probes: &[(DVec2, f64)]) -> Option<f64> {
        let length = self.high - self.low;
        let cost = |log: f64| coarseness(self.trapezoid(texels, length * log.exp()), probes);
        const STEPS: i32 = 20;
        let at = |k: i32| -4.0 + 8.0 * f64::from(k) / f64::from(STEPS);
        let best = (0..=STEPS).map(|k| (cost(at(k)), k)).min_by(|a, b| a.0.total_cmp(&b.0))?.1;
        // Between its neighbours, to where the least lies (golden section): as the camera moves it jumps less than from step to step.
        let (mut low, mut high) = (at((best - 1).max(0)), at((best + 1).min(STEPS)));
        let part = 0.5 * (5f64.sqrt() - 1.0);
        let mut inner = [high - part * (high - low), low + part * (high - low)];
        let mut costs = inner.map(&cost);
        for _ in 0..18 {
            if costs[0] < costs[1] {
                high = inner[1];
                inner = [high - part * (high - low), inner[0]];
                costs = [cost(inner[0]), costs[0]];
            } else {
                low = inner[0];
                inner = [inner[1], low + part * (high - low)];
                costs = [costs[1], cost(inner[1])];
            }
        }
        (!probes.is_empty()).then(|| length * (0.5 * (low + high)).exp())
    }

    /// From the trapezoid around the texels, whose sides meet at `distance` before the top line, to the unit square: the top line to
    /// y = 0, the base line to y = 1.
    fn trapezoid(&self, texels: &[DVec2], distance: f64) -> DMat3 {
        let s = self.dir.extend(distance - self.low);
        let t = self.dir.perp().extend(-self.across);
        let slopes = texels.iter().map(|p| p.extend(1.0)).map(|p| t.dot(p) / s.dot(p));
        let (left, right) = slopes.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
        let width = (right - left).max(1e-9);
        let length = self.high - self.low;
        let w = s / distance;
        let x = (t - s * left) / (width * distance);
        let y = (s - DVec3::Z * distance) * ((distance + length) / (length * distance));
        rows(x, y, w)
    }
}

#[cfg(test)]
mod tests;
