//! Shadows from the sub-pixel shadow map, place by place.

use super::spsm_map::{Coding, Sheet};
use glam::{DVec2, DVec3};
use subpixel_shadows::spsm_code::BorderPattern;

/// A map and how it is asked.
#[derive(Clone, Debug)]
pub struct Query<'a> {
    /// Records, row by row.
    pub records: &'a [[u32; 4]],
    /// How they are read.
    pub coding: &'a Coding,
    /// Texels searched around a place's own.
    pub radius: i32,
    /// And beyond these along the border's tangents, to either side.
    pub stretch: i32,
    /// Whether what no triangle covers is judged by the border that outer edges link; without, it is lit.
    pub recovery: bool,
    /// Depth by which a caster must lie before a receiver, rounding of depths included.
    pub bias: f64,
    /// Rounding of places, texels.
    pub noise: f64,
}

/// A place (texel x, y, depth) on the plane of a pixel's triangle, and whether it is on the triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePoint {
    /// Where it is.
    pub at: DVec3,
    /// Whether the pixel's ray there meets the triangle itself.
    pub own: bool,
}

impl Sheet {
    fn inside(&self, at: DVec2) -> f64 {
        self.edges.iter().map(|e| e.dot(at.extend(1.0))).fold(f64::INFINITY, f64::min)
    }

    fn depth_at(&self, at: DVec2) -> f64 {
        self.depth.dot(at.extend(1.0))
    }

    fn doubt_at(&self, at: DVec2) -> f64 {
        self.doubt.dot(at.abs().extend(1.0))
    }

    /// Both ends of edge `k` inside the square of half side `reach` around `middle`.
    fn piece(&self, k: usize, middle: DVec2, reach: f64) -> Option<[DVec2; 2]> {
        let e = self.edges[k];
        let start = middle - e.truncate() * (e.dot(middle.extend(1.0)) / e.truncate().length_squared());
        let along = DVec2::new(-e.y, e.x);
        let mut range = (-8.0, 8.0);
        let square = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
            .map(|(x, y)| DVec3::new(x, y, reach - x * middle.x - y * middle.y));
        for cut in square.into_iter().chain([self.edges[(k + 1) % 3], self.edges[(k + 2) % 3]]) {
            let (value, rate) = (cut.dot(start.extend(1.0)), cut.truncate().dot(along));
            if rate.abs() < 1e-7 {
                if value < 0.0 {
                    return None;
                }
            } else if rate > 0.0 {
                range.0 = f64::max(range.0, -value / rate);
            } else {
                range.1 = f64::min(range.1, -value / rate);
            }
        }
        (range.0 <= range.1).then(|| [start + along * range.0, start + along * range.1])
    }
}

impl Query<'_> {
    fn sheet(&self, [x, y]: [i32; 2]) -> Option<Sheet> {
        let size = self.coding.size as i32;
        let held = (0..size).contains(&x) && (0..size).contains(&y);
        held.then(|| self.coding.decode(self.records[(y * size + x) as usize], middle([x, y]))).flatten()
    }

    fn step(&self, gap: DVec3) -> f64 {
        let edge = if self.coding.lines { 0.002 } else { f64::from(self.coding.size) / 65_535.0 };
        edge * (gap.x.abs() + gap.y.abs())
    }

    fn bias(&self, slope: DVec2) -> f64 {
        self.bias + (slope.x.abs() + slope.y.abs()) * self.noise
    }

    /// Whether the texel's triangle lies before the receiver through `at` somewhere in the texel, and there before the
    /// farthest corner of the receiver's triangle, at depth `far`.
    pub fn before(&self, texel: [i32; 2], at: DVec3, slope: DVec2, far: f64) -> bool {
        let Some(s) = self.sheet(texel) else { return false };
        let most = -self.bias(slope);
        self.least_gap(&s, around(at, slope, texel)) < most && self.least_gap(&s, DVec3::Z * far) < most
    }

    /// Whether besides the triangle's plane at the place, or all of the triangle in the texel, lies before the place.
    fn before_place(&self, texel: [i32; 2], at: DVec3, slope: DVec2, far: f64) -> bool {
        let Some(s) = self.sheet(texel).filter(|_| self.before(texel, at, slope, far)) else { return false };
        let there = at.truncate() - middle(texel);
        let limit = at.z - self.bias(slope);
        let turned = Sheet { depth: -s.depth, ..s };
        s.depth_at(there) + s.doubt_at(there) < limit
            || 2.0 * s.doubt_at(DVec2::splat(0.5)) - self.least_gap(&turned, DVec3::ZERO) < limit
    }

    /// Least depth of the sheet over its texel less that of the receiver, doubt included.
    fn least_gap(&self, s: &Sheet, receiver: DVec3) -> f64 {
        let gap = s.depth - receiver;
        let value = |p: DVec2| gap.dot(p.extend(1.0)) + s.doubt_at(p) + self.step(gap);
        let half = |g: f64| if g > 0.0 { -0.5 } else { 0.5 };
        let corner = DVec2::new(half(gap.x), half(gap.y));
        if s.inside(corner) >= 0.0 {
            return value(corner);
        }
        let ends = (0..3).filter_map(|k| s.piece(k, DVec2::ZERO, 0.5)).flatten();
        let least = ends.map(value).fold(f64::INFINITY, f64::min);
        let corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]].map(DVec2::from);
        let nearest = corners.into_iter().max_by(|a, b| s.inside(*a).total_cmp(&s.inside(*b)));
        if least.is_finite() { least } else { value(nearest.unwrap_or(corner)) }
    }

    /// Whether one triangle around the middle of the box from `low` to `high` covers all of it, before the receiver.
    pub fn covered(&self, low: DVec2, high: DVec2, at: DVec3, slope: DVec2) -> bool {
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        self.around(texel_of(at.truncate())).any(|texel| {
            let Some(s) = self.sheet(texel) else { return false };
            let there = centre - middle(texel);
            let gap = s.depth - around(at, slope, texel);
            let most = gap.dot(there.extend(1.0))
                + gap.truncate().abs().dot(half)
                + s.doubt.dot((there.abs() + half).extend(1.0))
                + self.step(gap);
            s.inside(there) >= half.max_element() && most < -self.bias(slope)
        })
    }

    fn around(&self, [x, y]: [i32; 2]) -> impl Iterator<Item = [i32; 2]> + use<> {
        let r = self.radius;
        (-r..=r).flat_map(move |dy| (-r..=r).map(move |dx| [x + dx, y + dy]))
    }

    /// Texels beyond the square along the tangent of each border, given as directions towards the light.
    fn along(&self, [x, y]: [i32; 2], towards_lit: &[[i32; 2]]) -> impl Iterator<Item = [i32; 2]> {
        let (near, far) = (self.radius + 1, self.radius + self.stretch);
        let ways = move |out: [i32; 2]| (near..=far).flat_map(move |n| [(n, out), (-n, out)]);
        towards_lit.iter().copied().flat_map(ways).map(move |(n, out)| {
            let size = f64::from(out[0].abs().max(out[1].abs()));
            let rounded = |c: i32| (f64::from(n * c) / size + 0.5).floor() as i32;
            [x + rounded(-out[1]), y + rounded(out[0])]
        })
    }

    /// Whether a place on a receiver of this slope, whose triangle ends at depth `far`, is in shadow. All places of a pixel in one
    /// texel share the border that is found for the `first` of them. Beside the triangle its plane may run below the surface that
    /// is there, into a hollow: what does not lie before it at the pixel's `centre` does not count there.
    pub fn shadowed(&self, place: PlanePoint, first: PlanePoint, centre: DVec3, slope: DVec2, far: f64) -> bool {
        let at = place.at;
        let texel = texel_of(at.truncate());
        let counts = |own: bool, here: [i32; 2]| {
            own || self.sheet(here).is_some_and(|s| {
                let p = centre.truncate() - middle(here);
                let gap = s.depth - around(centre, slope, here);
                centre.z > s.depth_at(p) + self.bias(slope) + s.doubt_at(p) + self.step(gap)
            })
        };
        let before = |here| counts(first.own, here) && self.before_place(here, first.at, slope, far);
        if !before(texel) {
            return false;
        }
        let hit = |here: [i32; 2]| {
            counts(place.own, here)
                && self.sheet(here).is_some_and(|s| {
                    let p = at.truncate() - middle(here);
                    let gap = s.depth - around(at, slope, here);
                    let bias = self.bias(slope) + s.doubt_at(p) + self.step(gap);
                    s.inside(p) >= 0.0 && at.z > s.depth_at(p) + bias
                })
        };
        let offsets = (0..9).map(|k| [k % 3 - 1, k / 3 - 1]);
        let mask = offsets
            .enumerate()
            .fold(0, |mask, (k, [x, y])| mask | u32::from(before([texel[0] + x, texel[1] + y])) << k);
        let pattern = BorderPattern::of(mask);
        let towards = &pattern.towards_lit[..pattern.count as usize];
        let met = self.around(texel).chain(self.along(texel, towards)).any(hit);
        if met || !self.recovery {
            return met;
        }
        if pattern.covered {
            return true;
        }
        let mut pieces: Vec<[DVec2; 2]> = Vec::new();
        for here in self.around(texel) {
            let Some(s) = self.sheet(here) else { continue };
            let [x, y] = [here[0] - texel[0], here[1] - texel[1]];
            let inner = x.abs().max(y.abs()) <= 1;
            if if inner { pattern.kept >> (3 * y + x + 4) & 1 == 0 } else { !before(here) } {
                continue;
            }
            let offset = middle(here) - middle(texel);
            let gap = s.depth - around(at, slope, here);
            for [a, b] in (0..3).filter_map(|k| s.piece(k, -offset, 1.5)) {
                if gap.dot(((a + b) * 0.5).extend(1.0)) < 0.0 {
                    pieces.push([a + offset, b + offset]);
                }
            }
        }
        let place = at.truncate() - middle(texel);
        let open = |d: &[i32; 2]| beyond(&pieces, place, DVec2::new(f64::from(d[0]), f64::from(d[1])).normalize());
        !towards.is_empty() && !towards.iter().any(open)
    }
}

/// The texel of a place.
pub fn texel_of(at: DVec2) -> [i32; 2] {
    at.floor().as_ivec2().to_array()
}

fn middle([x, y]: [i32; 2]) -> DVec2 {
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

/// Depth of the receiver around a texel's centre.
fn around(at: DVec3, slope: DVec2, texel: [i32; 2]) -> DVec3 {
    slope.extend(at.z + slope.dot(middle(texel) - at.truncate()))
}

/// Whether `at` lies on the lit side of the border that outer edges link, `out` pointing to that side.
fn beyond(pieces: &[[DVec2; 2]], at: DVec2, out: DVec2) -> bool {
    let along = DVec2::new(-out.y, out.x);
    let t = at.dot(along);
    let (mut top, mut before, mut after) = (None::<f64>, None::<DVec2>, None::<DVec2>);
    for [a, b] in pieces {
        let d = *b - *a;
        if DVec2::new(-d.y, d.x).dot(out) <= 0.0 {
            continue;
        }
        let [p, q] = [a, b].map(|p| DVec2::new(p.dot(along), p.dot(out)));
        let (left, right) = if p.x <= q.x { (p, q) } else { (q, p) };
        if left.x <= t && t <= right.x {
            let share = if right.x - left.x < 1e-6 { 0.5 } else { (t - left.x) / (right.x - left.x) };
            let height = left.y + (right.y - left.y) * share;
            top = Some(top.map_or(height, |h| h.max(height)));
        }
        if right.x <= t && before.is_none_or(|p| right.x > p.x || (right.x == p.x && right.y > p.y)) {
            before = Some(right);
        }
        if left.x >= t && after.is_none_or(|p| left.x < p.x || (left.x == p.x && left.y > p.y)) {
            after = Some(left);
        }
    }
    let linked = before.zip(after).map(|(p, q)| p.y + (q.y - p.y) * ((t - p.x) / (q.x - p.x).max(1e-6)));
    top.or(linked).is_none_or(|height| at.dot(out) > height)
}
