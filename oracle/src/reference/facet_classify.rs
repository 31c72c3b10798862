//! The facets of a pixel list, and which of them need no evaluation.

use super::front_layer::{Margin, Split};
use super::summed_area::{rect_sum, table};
use super::triangle_setup::Triangle;
use super::view::{MapEnds, View, cells_touched};
use crate::truth::full_mask;
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;

pub use subpixel_shadows::status::FacetState;

/// The footprint of a pixel on a plane as the light sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Corners in texels, in order around, of those in front of the light.
    pub corners: Vec<DVec2>,
    /// All corners as points of the frame, where some do not lie in front of the light.
    pub points: Vec<DVec3>,
    /// Least depth from the light of what is in front of it.
    pub nearest: f64,
    /// Largest depth from the light.
    pub farthest: f64,
    /// Largest divisor.
    pub ahead: f64,
    /// All of it lies in front of the light.
    pub in_front: bool,
    /// Where those corners lie that are nearer than that, and by how many texels 32 bits may be off there.
    pub blurred: Vec<(DVec2, f64)>,
    /// It is known where all corners lie.
    pub known: bool,
    /// Every ray of the pixel meets the plane in front of the limit.
    pub whole: bool,
    /// Rounding may turn `whole` or `in_front`.
    pub open: bool,
}

impl Outline {
    /// Whether, grown by `margin` texels, it goes on beyond one of the ends of the map.
    pub fn goes_beyond(&self, map: MapEnds, margin: f64) -> bool {
        let (low, high) = self.bounds(1.0);
        map.any() && map.are_passed(low - margin, high + margin)
    }

    /// Lowest and highest corner, those nearer to the light `times` as far off as they may be; infinite where it is not known.
    pub fn bounds(&self, times: f64) -> (DVec2, DVec2) {
        if !self.known {
            return (DVec2::NEG_INFINITY, DVec2::INFINITY);
        }
        let grown = |(low, high): (DVec2, DVec2), &(at, off): &(DVec2, f64)| {
            (low.min(at - times * off), high.max(at + times * off))
        };
        self.blurred.iter().fold(bounds(&self.corners), grown)
    }
}

/// Texels by which the corners of a facet that lies next to the light may be off.
const BLUR: f64 = 4.0;

/// Facet: a surface inside one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetAtPixel {
    /// The pixel.
    pub pixel: u32,
    /// The triangle whose plane it is.
    pub triangle: Option<u32>,
    /// `xyz · point = w` on it, more on the side of the light and the eye.
    pub plane: DVec4,
    /// State.
    pub state: FacetState,
    /// Lit or shadowed by what is known of the texels around it, not because nothing is there.
    pub settled: bool,
    /// Texels its outline may touch: first and last column and row; `None` unless undecided.
    pub rect: Option<[u32; 4]>,
    /// Its outline.
    pub outline: Outline,
    /// Samples it covers.
    pub coverage: u128,
    /// Samples that rounding may take in or out.
    pub open_coverage: u128,
    /// Rounding to 32 bits may lead to another state.
    pub open: bool,
    /// Light or eye are so nearly in its plane that not even 46 bits tell whether it is dark.
    pub open_side: bool,
}

/// Half a pixel and 1/256: samples lie well inside the outline.
const PIXEL_REACH: f64 = 0.5 + SPARE;
/// 1/256 pixel.
const SPARE: f64 = 0.003_906_25;
/// Half an ulp of 1 in 32 bits.
const TINY: f64 = 1.0 / (1u64 << 24) as f64;
/// A facet is edge-on where the determinant of two edges and the direction to light or eye is at most this share of the
/// product of their largest components.
const EDGE_ON: f64 = 1.0 / (1u64 << 40) as f64;

/// Inputs of classification around the facets.
#[derive(Clone, Copy, Debug)]
pub struct MapAround<'a> {
    /// Triangles.
    pub triangles: &'a [Triangle],
    /// The mask: texels whose front layer is not one proved sheet.
    pub marked: &'a [bool],
    /// Split depth or state of each texel.
    pub splits: &'a [Split],
    /// Sample offsets inside a pixel, `[0, 1)²`.
    pub samples: &'a [[f32; 2]],
    /// Triangles from this number on cast nothing: the splits are proved of others.
    pub casters: u32,
}

/// A facet to be classified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The pixel.
    pub pixel: u32,
    /// The triangle whose plane it is; `None` for a pixel that sees none.
    pub triangle: Option<u32>,
    /// The samples that see the triangle, where that is known; `None`: the triangle represents the whole pixel.
    pub seen_by: Option<u128>,
}

/// Classifies the facets `(pixel, triangle)`, each of which represents its whole pixel. Rectangles reach out by `margin`;
/// nothing is settled without `settle`.
pub fn classify(
    view: &View,
    around: &MapAround,
    listed: &[(u32, Option<u32>)],
    margin: Margin,
    settle: bool,
) -> Vec<FacetAtPixel> {
    let parts: Vec<Part> = listed.iter().map(|&(pixel, triangle)| Part { pixel, triangle, seen_by: None }).collect();
    classify_parts(view, around, &marks_table(around.marked, view.map.map_size), &parts, margin, settle)
}

/// Counts of marked texels: the summed-area table that classification looks rectangles up in.
pub fn marks_table(marked: &[bool], size: u32) -> Vec<u32> {
    let words: Vec<u32> = marked.iter().map(|&m| u32::from(m)).collect();
    table(&words, size as usize)
}

/// As [`classify`], by a table of marks that exists already, and also of facets that stand for some samples of their pixel:
/// these are classified by the part of the pixel that holds the samples, at the point that the first of them sees.
pub fn classify_parts(
    view: &View,
    around: &MapAround,
    sat: &[u32],
    parts: &[Part],
    margin: Margin,
    settle: bool,
) -> Vec<FacetAtPixel> {
    parts.par_iter().map(|&part| one(view, around, sat, part, margin, settle)).collect()
}

/// Extent of a facet in its pixel: one of its samples, and the box around all with 1/256 pixel to spare, as offsets from the pixel centre.
struct Span {
    origin: DVec2,
    low: DVec2,
    high: DVec2,
}

impl Span {
    fn new(samples: &[[f32; 2]], seen_by: Option<u128>) -> Self {
        let whole = DVec2::splat(PIXEL_REACH);
        let offset = |k: usize| DVec2::new(f64::from(samples[k][0]), f64::from(samples[k][1])) - 0.5;
        let mut seen = seen_by.into_iter().flat_map(|mask| (0..samples.len()).filter(move |k| mask >> k & 1 == 1));
        let Some(first) = seen.next() else { return Self { origin: DVec2::ZERO, low: -whole, high: whole } };
        let origin = offset(first);
        let (low, high) = seen.fold((origin, origin), |(lo, hi), k| (lo.min(offset(k)), hi.max(offset(k))));
        Self { origin, low: low - SPARE, high: high + SPARE }
    }
}

fn one(view: &View, around: &MapAround, sat: &[u32], part: Part, margin: Margin, settle: bool) -> FacetAtPixel {
    let Part { pixel, triangle, seen_by } = part;
    let every = full_mask(around.samples.len() as u32);
    let mut facet = FacetAtPixel {
        pixel,
        triangle,
        plane: DVec4::ZERO,
        state: FacetState::Empty,
        settled: false,
        rect: None,
        outline: Outline::default(),
        coverage: seen_by.map_or(every, |mask| mask & every),
        open_coverage: 0,
        open: false,
        open_side: false,
    };
    let found = triangle.and_then(|t| around.triangles.get(t as usize)).and_then(|t| t.corners);
    let Some(corners) = found else { return facet };
    let of_body = triangle.is_some_and(|t| around.triangles[t as usize].of_body);
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let to_light = view.light.truncate() - a * view.light.w;
    let tilt = (b - a).length() * (c - a).length() / normal.length();
    let noise = 8.0 * TINY * (tilt + 4.0) * normal.length();
    let (turn, open) = turn_to(corners, to_light);
    let (turn_to_eye, open_to_eye) = turn_to(corners, -a);
    facet.open_side = open || open_to_eye;
    facet.open = facet.open_side;
    facet.state = FacetState::Dark;
    // Edge-on to either: unlit by definition. Seen from inside a closed body it is in the shadow of the rest.
    if turn * turn_to_eye <= 0.0 || (view.map.closed && turn < 0.0) {
        return facet;
    }
    let normal = normal * turn;
    facet.plane = normal.extend(normal.dot(a));
    facet.open |= facet.plane.w.abs() <= noise * a.length();
    let span = Span::new(around.samples, seen_by);
    let ray = pixel_ray(view, pixel, span.origin);
    let depth = facet.plane.w / normal.dot(ray);
    let far_corner = corners.map(|p| p.dot(view.rays.forward)).into_iter().fold(f64::MIN, f64::max);
    let limit = far_corner.max(depth) * 4.0;
    facet.outline = outline_of(view, pixel, facet.plane, limit, [span.low, span.high]);
    facet.open |= facet.outline.open;
    if seen_by.is_none() && (!facet.outline.whole || facet.outline.open) {
        keep_own_triangle(view, around.samples, corners, &mut facet);
    }
    let size = view.map.map_size;
    let receives = triangle.is_some_and(|t| t >= around.casters);
    let (low, high) = facet.outline.bounds(margin.texels / view.map.margins().texels);
    let reach = if receives { reach_beyond(view, pixel, facet.plane, limit) } else { 1.0 };
    let texels = margin.texels * reach;
    if receives {
        facet.outline.nearest -= margin.depth * (reach + 1.0);
        facet.outline.farthest += margin.depth * reach;
    }
    if receives && view.map.perspective {
        // Nearer to the light than any caster.
        let ahead = facet.outline.ahead - view.map.clear;
        facet.open |= ahead.abs() < 1e-3 * view.map.clear.abs();
        if ahead < 0.0 {
            facet.state = FacetState::Lit;
            return facet;
        }
    }
    if view.beyond(&facet.outline.points) {
        facet.state = FacetState::Lit;
        return facet;
    }
    let rect = if facet.outline.known {
        cells_touched(low - texels, high + texels, [size; 2])
    } else {
        Some([0, 0, size - 1, size - 1])
    };
    let Some(rect) = rect else {
        facet.state = FacetState::Lit;
        return facet;
    };
    facet.state = FacetState::Undecided;
    // Of what is no caster the splits know nothing.
    let hidden = view.cull_back && of_body && turn < 0.0;
    if hidden {
        facet.outline.farthest = f64::INFINITY;
    }
    let inside = low.min_element() >= texels && high.max_element() <= f64::from(size) - texels;
    let whole = inside || !view.map.one_of_several;
    if settle
        && !hidden
        && facet.outline.in_front
        && whole
        && rect_sum(sat, size as usize, rect.map(|v| v as usize)) == 0
    {
        if receives {
            behind_splits(around.splits, size, rect, inside, &mut facet);
        } else {
            settle_unmarked(view, around.splits, ray * depth, &mut facet);
        }
        facet.settled = facet.state != FacetState::Undecided;
    }
    if facet.state == FacetState::Undecided {
        facet.rect = Some(rect);
    }
    facet
}

/// 1 if the triangle faces where `to` points from its first corner, -1 if it faces away, 0 if it is edge-on; and whether 46
/// bits may tell another.
fn turn_to([a, b, c]: [DVec3; 3], to: DVec3) -> (f64, bool) {
    let side = (b - a).cross(c - a).dot(to);
    let size = [b - a, c - a, to].map(|v| v.abs().max_element()).iter().product::<f64>();
    let least = EDGE_ON * size;
    // NaN is edge-on.
    let turn = if side.abs() > least { side.signum() } else { 0.0 };
    (turn, side != 0.0 && (side.abs() - least).abs() <= least)
}

/// The state of a facet none of whose texels is marked, by what is known at its point at the pixel centre.
fn settle_unmarked(view: &View, splits: &[Split], point: DVec3, facet: &mut FacetAtPixel) {
    let Some(at) = view.on_map(point) else { return };
    let (x, y) = (at.x.floor(), at.y.floor());
    let size = f64::from(view.map.map_size);
    let border = |v: f64| (v - v.round()).abs() < 2e-3;
    facet.open |= border(at.x) || border(at.y);
    if !(x >= 0.0 && y >= 0.0 && x < size && y < size) {
        return;
    }
    facet.state = match splits[(y * size + x) as usize] {
        Split::Marked | Split::Uncovered => FacetState::Lit,
        Split::At(split) => {
            facet.open |= (at.z - split).abs() < 1e-4;
            if at.z < split { FacetState::Lit } else { FacetState::Shadowed }
        }
    };
}

/// Most texels of which the splits are read.
const MOST_SPLITS: u32 = 256;

/// The state of a facet that is no caster's, none of whose texels is marked: lit where none of them has a caster, shadowed
/// where it lies behind the split of each.
fn behind_splits(splits: &[Split], size: u32, [x0, y0, x1, y1]: [u32; 4], inside: bool, facet: &mut FacetAtPixel) {
    if (x1 - x0 + 1) * (y1 - y0 + 1) > MOST_SPLITS {
        return;
    }
    let rows = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (y * size + x) as usize));
    let all: Vec<Split> = rows.map(|t| splits[t]).collect();
    let nearest = facet.outline.nearest;
    if all.iter().all(|s| matches!(s, Split::Uncovered)) {
        facet.state = FacetState::Lit;
    } else if inside && all.iter().all(|s| matches!(s, Split::At(split) if *split < nearest)) {
        facet.state = FacetState::Shadowed;
    }
    facet.open |=
        all.iter().any(|s| matches!(s, Split::At(split) if (split - nearest).abs() < 1e-3 * (1.0 + nearest.abs())));
}

/// How many times farther than the unit cube, to which margins belong, a facet reaches within its pixel; at least 1.
fn reach_beyond(view: &View, pixel: u32, plane: DVec4, limit: f64) -> f64 {
    let offsets = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec2::new(x, y) * PIXEL_REACH);
    let reach = |offset: DVec2| {
        let ray = pixel_ray(view, pixel, offset);
        let over = plane.truncate().dot(ray);
        let depth = if over < 0.0 { (plane.w / over).min(limit) } else { limit };
        depth * ray.abs().max_element()
    };
    offsets.into_iter().map(reach).fold(1.0, f64::max)
}

fn keep_own_triangle(view: &View, samples: &[[f32; 2]], [a, b, c]: [DVec3; 3], facet: &mut FacetAtPixel) {
    let edges = [a.cross(b), b.cross(c), c.cross(a)];
    let slopes = edges.map(|e| e.dot(view.rays.step_x).hypot(e.dot(view.rays.step_y)));
    let (mut own, mut near) = (1u128, 0u128);
    for (k, o) in samples.iter().enumerate() {
        let ray = pixel_ray(view, facet.pixel, DVec2::new(f64::from(o[0]), f64::from(o[1])) - 0.5);
        let v = edges.map(|e| e.dot(ray));
        let inside = v.iter().all(|&v| v >= 0.0) || v.iter().all(|&v| v <= 0.0);
        own |= u128::from(inside) << k;
        near |= u128::from(v.iter().zip(slopes).any(|(v, s)| v.abs() <= s / 256.0)) << k;
    }
    facet.open_coverage = if facet.outline.open { u128::MAX } else { near };
    if !facet.outline.whole {
        facet.coverage &= own;
    }
}

/// The ray at an offset from a pixel's centre.
pub fn pixel_ray(view: &View, pixel: u32, offset: DVec2) -> DVec3 {
    let (x, y) = (pixel % view.image[0], pixel / view.image[0]);
    view.rays.direction(f64::from(x) + 0.5 + offset.x, f64::from(y) + 0.5 + offset.y)
}

/// The pixel's footprint on `plane` as the light sees it, cut off where view depth exceeds `limit`.
pub fn outline(view: &View, pixel: u32, plane: DVec4, limit: f64) -> Outline {
    outline_of(view, pixel, plane, limit, [-1.0, 1.0].map(|side| DVec2::splat(side * PIXEL_REACH)))
}

/// As [`outline`], of the part of the pixel between two corners, which are offsets from its centre.
fn outline_of(view: &View, pixel: u32, plane: DVec4, limit: f64, [low, high]: [DVec2; 2]) -> Outline {
    let normal = plane.truncate();
    let mut out = Outline {
        nearest: f64::MAX,
        farthest: f64::MIN,
        ahead: f64::MIN,
        in_front: true,
        known: true,
        whole: true,
        ..Outline::default()
    };
    let offsets = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    let rays = offsets.map(|o| pixel_ray(view, pixel, o));
    // A ray meets the plane nearer than the limit where this is not positive.
    let over = |ray: DVec3| normal.dot(ray) - plane.w / limit;
    let mut points = Vec::with_capacity(5);
    let mut add = |point: DVec3| {
        points.push(point);
        out.ahead = out.ahead.max(view.map.w.dot(point.extend(1.0)));
        match view.on_map(point) {
            Some(at) => {
                out.nearest = out.nearest.min(at.z);
                out.corners.push(DVec2::new(at.x, at.y));
                out.farthest = out.farthest.max(at.z);
                out.open |= view.map.perspective && at.w < view.map.near * 1.0001;
            }
            None => {
                out.in_front = false;
                let (p, near) = (point.extend(1.0), view.map.near);
                let w = view.map.w.dot(p);
                let off = 0.25 * near / w;
                out.open |= w > near * 0.9999 || (off / BLUR - 1.0).abs() < 1e-2;
                if view.map.lamp.is_some() && w > 0.0 && off <= BLUR {
                    out.blurred.push((DVec2::new(view.map.u.dot(p), view.map.v.dot(p)) / w, off));
                } else {
                    out.known = false;
                }
            }
        }
    };
    let (mut whole, mut open) = (true, false);
    for k in 0..4 {
        let (ray, next) = (rays[k], rays[(k + 1) % 4]);
        let (at, at_next) = (over(ray), over(next));
        open |= at.abs() <= 16.0 * TINY * normal.length() * ray.length();
        if at <= 0.0 {
            add(ray * (plane.w / normal.dot(ray)));
        } else {
            whole = false;
        }
        if (at <= 0.0) != (at_next <= 0.0) {
            add((ray + (next - ray) * (at / (at - at_next))) * limit);
        }
    }
    out.whole = whole;
    out.open |= open;
    if !out.in_front {
        out.points = points;
    }
    out
}

/// Lowest and highest corner of some places.
pub fn bounds(corners: &[DVec2]) -> (DVec2, DVec2) {
    corners.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)))
}
