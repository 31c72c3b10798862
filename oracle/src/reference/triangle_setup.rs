//! Side of the light of each triangle, and which pixels and texels it may touch.

use super::vertex_project::Vertex;
use super::view::{Cut, Flat, MapEnds, View, cells_touched, centres_within};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use subpixel_shadows::scene::AlphaTested;

/// Texels that a triangle may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// None: it is dropped, culled, or behind the light.
    Nowhere,
    /// All of them: it is not surely in front of the light, and nearly in a plane with it.
    Everywhere,
    /// Those it may touch of which a part is not surely in front of the light.
    Cut(Cut),
    /// Those it touches in the light view.
    Flat(Flat),
}

/// A triangle of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Corners; `None` where an index or a number is no good: no triangle at all.
    pub corners: Option<[DVec3; 3]>,
    /// See [`View::side`]; 0 for no triangle.
    pub side: f64,
    /// Box of what is seen of it in the image.
    pub image: Option<(DVec2, DVec2)>,
    /// Where it is in the light view.
    pub map: Reach,
    /// Whether it is of a closed body.
    pub of_body: bool,
    /// Whether it goes on beyond one of the ends of the map ([`LightView::ends`](subpixel_shadows::light_view::LightView::ends)).
    pub beyond: bool,
    /// Place among the [alpha-tested](AlphaTested::triangles) ones.
    pub tested: Option<u32>,
}

impl Triangle {
    /// No triangle.
    pub const DROPPED: Self = Self {
        corners: None,
        side: 0.0,
        image: None,
        map: Reach::Nowhere,
        of_body: false,
        beyond: false,
        tested: None,
    };

    /// Pixels whose centre the box of its image holds: first and last column and row.
    pub fn pixels(&self, size: [u32; 2]) -> Option<[u32; 4]> {
        self.image.and_then(|(lo, hi)| centres_within(lo, hi, size))
    }

    /// Texels that its box, grown by `margin`, touches.
    pub fn texels(&self, size: u32, margin: f64) -> Option<[u32; 4]> {
        match self.map {
            Reach::Nowhere => None,
            Reach::Everywhere | Reach::Cut(_) => Some([0, 0, size - 1, size - 1]),
            // It is in the texels at the ends.
            Reach::Flat(_) if self.beyond => Some([0, 0, size - 1, size - 1]),
            Reach::Flat(flat) => {
                let (lo, hi) = flat.bounds();
                cells_touched(lo - margin, hi + margin, [size; 2])
            }
        }
    }

    /// Its figure in the light view, where it lies in front of the light.
    pub fn flat(&self) -> Option<Flat> {
        match self.map {
            Reach::Flat(flat) => Some(flat),
            _ => None,
        }
    }

    /// Its lines and plane there, where it reaches behind the light.
    pub fn cut(&self) -> Option<Cut> {
        match self.map {
            Reach::Cut(cut) => Some(cut),
            _ => None,
        }
    }
}

/// The side below which rounding of the vertices and of 32-bit arithmetic may turn it.
pub fn side_doubt(view: &View, [a, b, c]: [DVec3; 3]) -> f64 {
    let largest = |v: DVec3| v.abs().max_element();
    let to_light = view.light.truncate() - a * view.light.w;
    let (ab, ac) = (largest(b - a), largest(c - a));
    let reach = largest(a).max(largest(b)).max(largest(c));
    largest(to_light) * (2e-6 * ab * ac + 6e-7 * reach * (ab + ac))
}

/// Sets all triangles up. `bodies` tells those of closed bodies; what it does not reach is of none.
pub fn setup(view: &View, vertices: &[Vertex], triangles: &[[u32; 3]], bodies: &[bool]) -> Vec<Triangle> {
    let of_body = |t: usize| bodies.get(t).is_some_and(|b| *b);
    triangles.par_iter().enumerate().map(|(t, &corners)| one(view, vertices, corners, of_body(t))).collect()
}

/// Says which of them are alpha-tested.
pub fn mark_tested(triangles: &mut [Triangle], alpha: &AlphaTested) {
    for (place, of) in (0..).zip(&alpha.triangles) {
        triangles[of.triangle as usize].tested = Some(place);
    }
}

fn one(view: &View, vertices: &[Vertex], [i, j, k]: [u32; 3], of_body: bool) -> Triangle {
    let vertex = |v: u32| vertices.get(v as usize).copied().unwrap_or_default();
    let all = [vertex(i), vertex(j), vertex(k)];
    let ([Some(a), Some(b), Some(c)], true) = (all.map(|v| v.point), i != j && j != k && k != i) else {
        return Triangle::DROPPED;
    };
    let corners = [a, b, c];
    let side = view.side(corners);
    let ends = MapEnds::of(&view.map);
    let map = match all.map(|v| v.map) {
        _ if view.cull_back && of_body && side < 0.0 => Reach::Nowhere,
        [Some(a), Some(b), Some(c)] => Reach::Flat(Flat::new([a, b, c].map(|p| p.truncate()))),
        _ if all.iter().all(|v| v.behind) || (!ends.any() && view.beyond(&corners)) => Reach::Nowhere,
        _ => Cut::new(view, corners).map_or(Reach::Everywhere, Reach::Cut),
    };
    let beyond = match map {
        Reach::Nowhere => false,
        Reach::Everywhere | Reach::Cut(_) => ends.any(),
        Reach::Flat(flat) => {
            let (low, high) = flat.bounds();
            ends.are_passed(low, high)
        }
    };
    Triangle { corners: Some(corners), side, image: image_box(view, corners), map, of_body, beyond, tested: None }
}

/// Box in the image of the part of a triangle beyond the near plane.
fn image_box(view: &View, corners: [DVec3; 3]) -> Option<(DVec2, DVec2)> {
    let depth = corners.map(|p| p.dot(view.rays.forward) - view.near);
    let mut seen: Vec<DVec2> = Vec::with_capacity(4);
    for k in 0..3 {
        let n = (k + 1) % 3;
        if depth[k] >= 0.0 {
            seen.push(view.on_image(corners[k]));
        }
        if (depth[k] >= 0.0) != (depth[n] >= 0.0) {
            let cut = corners[k].lerp(corners[n], depth[k] / (depth[k] - depth[n]));
            // On the plane by definition, whatever rounding says.
            let cut = cut + view.rays.forward * (view.near - cut.dot(view.rays.forward));
            seen.push(view.on_image(cut));
        }
    }
    let first = *seen.first()?;
    Some(seen.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p))))
}
