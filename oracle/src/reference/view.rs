//! The frame in `f64`: camera and light view in the eye-relative, scaled space that all stages work in.

mod cut;

pub use cut::Cut;

use glam::{DVec2, DVec3, DVec4, Vec3};
use subpixel_shadows::light_view::{LightView, unit_scale};
use subpixel_shadows::scene::{Camera, Light, PixelRays};

/// Camera, light and light view; lengths are `(world - eye) * scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The eye, world units.
    pub eye: DVec3,
    /// A power of two.
    pub scale: f64,
    /// Direction towards the light and 0, or its point and 1.
    pub light: DVec4,
    /// Rays of the image.
    pub rays: PixelRays,
    /// Nearest view depth that is seen.
    pub near: f64,
    /// Pixels.
    pub image: [u32; 2],
    /// The light view; its rows take scaled points.
    pub map: LightView,
    /// Triangles of closed bodies that face away from the light are no casters.
    pub cull_back: bool,
}

impl View {
    /// The frame of a camera, a light and its view of a scene between two corners.
    pub fn new(
        camera: &Camera,
        light: &Light,
        map: &LightView,
        bounds: (DVec3, DVec3),
        image: [u32; 2],
        cull_back: bool,
    ) -> Self {
        let rays = camera.rays(image[0], image[1]);
        let scale = unit_scale(rays.eye, bounds);
        let l = light.homogeneous();
        let at = if l.w == 0.0 { l.truncate() } else { (l.truncate() - rays.eye) * scale };
        Self {
            eye: rays.eye,
            scale,
            light: at.extend(l.w),
            rays,
            near: f64::from(camera.near) * scale,
            image,
            map: map.relative_to(rays.eye, scale),
            cull_back,
        }
    }

    /// View depth from which on a ray sees surfaces.
    pub fn near_along(&self, ray: DVec3) -> f64 {
        self.rays.begin(ray) * self.scale
    }

    /// A world position as a point of the frame.
    pub fn point(&self, position: [f32; 3]) -> DVec3 {
        (Vec3::from(position).as_dvec3() - self.eye) * self.scale
    }

    /// Texel x, y and depth of a point, and the divisor; `None` if it is not in front of the light.
    pub fn on_map(&self, point: DVec3) -> Option<DVec4> {
        if self.map.paraboloid.is_some() {
            return self.map.project(point).map(|p| p.extend(1.0));
        }
        let p = point.extend(1.0);
        let w = if self.map.perspective { self.map.w.dot(p) } else { 1.0 };
        let seen = !self.map.perspective || w > self.map.near;
        seen.then(|| (DVec3::new(self.map.u.dot(p), self.map.v.dot(p), self.map.z.dot(p)) / w).extend(w))
    }

    /// Whether all `points` lie beyond one side of the view of a light at a point: then nothing between them is in it.
    pub fn beyond(&self, points: &[DVec3]) -> bool {
        let row = |row: DVec4, p: DVec3| row.dot(p.extend(1.0));
        let size = f64::from(self.map.map_size);
        let sides: [&dyn Fn(DVec3) -> f64; 4] = [
            &|p| row(self.map.u, p),
            &|p| row(self.map.v, p),
            &|p| size * row(self.map.w, p) - row(self.map.u, p),
            &|p| size * row(self.map.w, p) - row(self.map.v, p),
        ];
        self.map.perspective && !points.is_empty() && sides.iter().any(|side| points.iter().all(|&p| side(p) < 0.0))
    }

    /// Image position of a point in front of the eye.
    pub fn on_image(&self, point: DVec3) -> DVec2 {
        let q = point / point.dot(self.rays.forward) - self.rays.corner;
        DVec2::new(
            q.dot(self.rays.step_x) / self.rays.step_x.length_squared(),
            q.dot(self.rays.step_y) / self.rays.step_y.length_squared(),
        )
    }

    /// Positive where the light sees the triangle's front: six times the volume between light and triangle.
    pub fn side(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        (b - a).cross(c - a).dot(self.light.truncate() - a * self.light.w)
    }
}

/// A triangle or any other plane figure as straight lines in a grid of cells: distances and depth at any place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    /// Corners: cell x, y, depth.
    pub corners: [DVec3; 3],
    /// Change of depth for a cell to the right and down; `None` if the triangle has no area there.
    pub slope: Option<DVec2>,
    turn: f64,
}

impl Flat {
    /// The triangle of these corners.
    pub fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
        let area = ab.perp_dot(ac);
        let (zb, zc) = (b.z - a.z, c.z - a.z);
        let slope = DVec2::new(zb * ac.y - zc * ab.y, zc * ab.x - zb * ac.x) / area;
        Self { corners, slope: (area != 0.0).then_some(slope), turn: if area < 0.0 { -1.0 } else { 1.0 } }
    }

    /// How far `at` lies inside each edge, in cells measured as |x| + |y| across the edge; negative outside.
    pub fn inside(&self, at: DVec2) -> [f64; 3] {
        std::array::from_fn(|k| {
            let (a, b) = (self.corners[k].truncate(), self.corners[(k + 1) % 3].truncate());
            let (a, b, turn) = if (a.x, a.y) <= (b.x, b.y) { (a, b, self.turn) } else { (b, a, -self.turn) };
            let d = b - a;
            turn * d.perp_dot(at - a) / (d.x.abs() + d.y.abs()).max(f64::MIN_POSITIVE)
        })
    }

    /// Whether rounding to 32 bits may turn it over.
    pub fn is_thin(&self) -> bool {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        let (ab, ac) = (b - a, c - a);
        let size = (ab.x.abs() + ab.y.abs()).max(ac.x.abs() + ac.y.abs());
        let (lo, hi) = self.bounds();
        ab.perp_dot(ac).abs() <= 4e-6 * (lo.abs().max(hi.abs()).max_element() + size) * size
    }

    /// Depth of its plane at `at`, held between the depths of its corners.
    pub fn depth(&self, at: DVec2) -> f64 {
        let (lo, hi) = self.depths();
        let a = self.corners[0];
        self.slope.map_or(a.z, |s| (a.z + s.dot(at - a.truncate())).clamp(lo, hi))
    }

    /// Least and greatest depth of its corners.
    pub fn depths(&self) -> (f64, f64) {
        let [a, b, c] = self.corners.map(|p| p.z);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Lowest and highest corner of its box in the grid.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Whether it touches the closed square of half side `reach` around `centre`: no axis across a side of either parts
    /// them.
    pub fn touches(&self, centre: DVec2, reach: f64) -> bool {
        let (lo, hi) = self.bounds();
        if centre.x + reach < lo.x || centre.y + reach < lo.y || centre.x - reach > hi.x || centre.y - reach > hi.y {
            return false;
        }
        if self.slope.is_some() {
            return self.inside(centre).iter().all(|&e| e >= -reach);
        }
        let apart = |k: usize| {
            let (a, b) = (self.corners[k].truncate(), self.corners[(k + 1) % 3].truncate());
            !segment_touches(a, b, centre, reach)
        };
        !(0..3).all(apart)
    }

    /// Least and greatest depth of its plane over the square, held between the depths of its corners.
    pub fn depth_range(&self, centre: DVec2, reach: f64, margin: f64) -> (f64, f64) {
        let (lo, hi) = self.depths();
        let (lo, hi) = (lo - margin, hi + margin);
        let Some(slope) = self.slope else { return (lo, hi) };
        let a = self.corners[0];
        let middle = a.z + slope.dot(centre - a.truncate());
        let half = reach * (slope.x.abs() + slope.y.abs()) + margin;
        ((middle - half).max(lo), (middle + half).min(hi))
    }
}

/// Whether the segment from `a` to `b` touches the closed square of half side `reach` around `centre`.
pub fn segment_touches(a: DVec2, b: DVec2, centre: DVec2, reach: f64) -> bool {
    let (lo, hi) = (a.min(b), a.max(b));
    let d = b - a;
    centre.x + reach >= lo.x
        && centre.y + reach >= lo.y
        && centre.x - reach <= hi.x
        && centre.y - reach <= hi.y
        && d.perp_dot(centre - a).abs() <= reach * (d.x.abs() + d.y.abs())
}

/// A map and its ends: see [`LightView::ends`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapEnds {
    /// Texels a side.
    pub size: u32,
    /// Sides that are ends: lowest x, highest x, lowest y, highest y.
    pub ends: [bool; 4],
}

impl MapEnds {
    /// Ends of a view.
    pub fn of(view: &LightView) -> Self {
        Self { size: view.map_size, ends: view.ends }
    }

    /// Whether it has any.
    pub fn any(self) -> bool {
        self.ends.contains(&true)
    }

    /// Whether a box, in texels, goes on beyond one of them.
    pub fn are_passed(self, low: DVec2, high: DVec2) -> bool {
        let size = f64::from(self.size);
        let over = [low.x < 0.0, high.x > size, low.y < 0.0, high.y > size];
        over.iter().zip(self.ends).any(|(over, end)| *over && end)
    }

    /// Whether one of `across` cells a side lies at one of them: what goes on beyond meets there.
    pub fn are_at(self, x: u32, y: u32, across: u32) -> bool {
        let at = [x == 0, x + 1 == across, y == 0, y + 1 == across];
        at.iter().zip(self.ends).any(|(at, end)| *at && end)
    }
}

/// First and last cell of `size` whose closed interval touches the interval, if any does.
pub fn cells_touched(low: DVec2, high: DVec2, size: [u32; 2]) -> Option<[u32; 4]> {
    let limit = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    if high.x < 0.0 || high.y < 0.0 || low.x > limit.x || low.y > limit.y || low.x > high.x || low.y > high.y {
        return None;
    }
    let last = limit - DVec2::ONE;
    // A box that begins on a border also touches the cell before it.
    let (a, b) = ((low.ceil() - DVec2::ONE).clamp(DVec2::ZERO, last), high.floor().clamp(DVec2::ZERO, last));
    Some([a.x as u32, a.y as u32, b.x as u32, b.y as u32])
}

/// First and last cell of `size` whose centre lies in the box, if any does.
pub fn centres_within(low: DVec2, high: DVec2, size: [u32; 2]) -> Option<[u32; 4]> {
    let limit = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    let half = DVec2::splat(0.5);
    let (a, b) = ((low - half).ceil().max(DVec2::ZERO), (high - half).floor().min(limit - DVec2::ONE));
    (a.x <= b.x && a.y <= b.y).then_some([a.x as u32, a.y as u32, b.x as u32, b.y as u32])
}

/// How many 8 × 8 blocks, aligned to multiples of 8, a rectangle of cells (both corners included) touches.
pub fn block_count(rect: Option<[u32; 4]>) -> u32 {
    rect.map_or(0, |[x0, y0, x1, y1]| (x1 / 8 - x0 / 8 + 1) * (y1 / 8 - y0 / 8 + 1))
}

/// Calls `visit` for each row of a square of cells in parallel, with the triangles whose box, grown by `reach`, meets
/// the row, and the row's cells; returns all cells.
pub(super) fn by_rows<T: Clone + Default + Send + Sync, F>(
    figures: &[Option<Flat>],
    rows: u32,
    reach: f64,
    visit: F,
) -> Vec<T>
where
    F: Fn(u32, &[u32], &mut [T]) + Sync,
{
    use rayon::prelude::*;
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); rows as usize];
    for (t, figure) in figures.iter().enumerate() {
        let Some((lo, hi)) = figure.as_ref().map(Flat::bounds) else { continue };
        let (first, last) = ((lo.y - reach - 1.0).max(0.0), (hi.y + reach + 1.0).min(f64::from(rows) - 1.0));
        if first <= last {
            (first as usize..=last as usize).for_each(|row| lists[row].push(t as u32));
        }
    }
    // Written where it stays: a map may be most of the memory there is.
    let mut all = vec![T::default(); rows as usize * rows as usize];
    let each = all.par_chunks_mut(rows.max(1) as usize).zip(&lists).enumerate();
    each.for_each(|(row, (cells, list))| visit(row as u32, list, cells));
    all
}

/// The cells of a row, as a range, that a figure's box grown by `reach` meets.
pub(super) fn columns(figure: &Flat, reach: f64, width: u32) -> std::ops::Range<u32> {
    let (lo, hi) = figure.bounds();
    let (first, last) = ((lo.x - reach - 1.0).max(0.0), (hi.x + reach + 2.0).min(f64::from(width)));
    if first < last { first as u32..last as u32 } else { 0..0 }
}

/// Centre of a cell.
pub fn centre(x: u32, y: u32) -> DVec2 {
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}
