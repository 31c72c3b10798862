//! The light view: which part of the scene the light's map covers.

mod casters;
mod clusters;
mod cube;
mod faces;
mod fit;
mod focus;
mod map_tiles;
mod paraboloid;
mod points;
mod seen_box;
mod split_plan;
mod splits;

pub use map_tiles::MapTiles;
pub use paraboloid::OmniMaps;
pub(crate) use points::MeshAndTree;
use seen_box::SeenBox;
pub use split_plan::{PartBy, SplitPlan, Warp};

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// Rows that take a world point `p` to the light view: texel `x = u·(p,1) / w·(p,1)`, likewise `y` and `depth`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightView {
    /// Texels a side.
    pub map_size: u32,
    /// Row of texel `x`.
    pub u: DVec4,
    /// Row of texel `y`.
    pub v: DVec4,
    /// Row of depth: 0 at the nearest caster, 1 at the farthest, growing away from the light.
    pub z: DVec4,
    /// Row of the divisor: `(0,0,0,1)` for a directional light, else the distance along the view's axis; times the divisor of a warp.
    pub w: DVec4,
    /// Points with a smaller divisor are not in front of the light.
    pub near: f64,
    /// Smallest divisor of what the view was fitted to, for a light at a point; else 0.
    pub clear: f64,
    /// Whether there is a divisor other than 1: the light is at a point, or the view is [warped](LightView::slices).
    pub perspective: bool,
    /// Whether the view holds every caster that can shadow something. Where it does not, a receiver outside the map may
    /// be in shadow all the same.
    pub complete: bool,
    /// One of several views: what is proved of a surface counts only where all of it lies in the view.
    pub one_of_several: bool,
    /// Sides of the map (lowest `x`, highest `x`, lowest `y`, highest `y`) beyond which parts of large casters were left out that shadow no surface
    /// there. A facet that represents its whole pixel goes on beyond its surface, where they may shadow or cut it: what crosses such
    /// a side, facets and casters, meets in all texels at it.
    pub ends: [bool; 4],
    /// Whether triangles that turn away from the light are never lit, whatever side of them is seen: the mesh is closed, and the
    /// light outside.
    pub closed: bool,
    /// Whether the light is outside all closed bodies of the mesh: triangles of these that turn away from it add nothing to the
    /// shadow. (A body that runs through itself so that some of its space is inside out counts as any other: what lies in such
    /// space is not shadowed by it.) Fitting leaves it `false`;
    /// [`Settings::light_views`](crate::methods::Settings::light_views) says it.
    pub outside: bool,
    /// Where the light is, of a [paraboloid view](LightView::paraboloids). Of a point `d` away from it, as far as `D`, texel `x` is
    /// `u.w + u·d / (D + w·d)`, likewise `y`, and depth `D` times `z.w`.
    pub paraboloid: Option<DVec3>,
    /// Where the light is, of any other view of a light at a point: there texel rows and divisor are 0.
    pub lamp: Option<DVec3>,
}

/// Share of its width by which a view is wider than a side of a cube or a cone: what lies on an edge of the cube lies well inside both views.
const WIDER: f64 = 1.0 + 1.0 / 64.0;

/// How far conservative tests in a view reach out, so that rounding in `f32` takes nothing from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// In texels.
    pub texels: f64,
    /// In depth.
    pub depth: f64,
}

impl Margins {
    /// The wider of each.
    pub fn or(self, other: Self) -> Self {
        Self { texels: self.texels.max(other.texels), depth: self.depth.max(other.depth) }
    }
}

/// Window of a view of a light at a point: across at distance 1, and along its axis.
struct Window {
    low: DVec3,
    high: DVec3,
    near: f64,
    far: f64,
    /// See [`LightView::clear`].
    clear: f64,
}

/// Receivers that may be in shadow: all outside the view is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Receivers {
    /// The outsides of a closed mesh, with the light outside all of its bodies. See [`LightView::closed`].
    Outsides,
    /// The triangles, from both sides.
    Surfaces,
    /// The triangles, and of their planes what a pixel at their edges sees: for facets that stand for whole pixels, of which
    /// samples off the surface are dropped.
    Planes,
    /// Anything anywhere.
    Anything,
}

impl LightView {
    /// Most texels a side.
    pub const LARGEST_MAP: u32 = 8192;

    fn is_in_front(&self, point: DVec3) -> bool {
        if self.paraboloid.is_some() {
            return self.project(point).is_some();
        }
        self.w.dot(point.extend(1.0)) > self.near
    }

    /// Texel `x`, `y` and depth of `point`; `None` if it is not in front of the light.
    pub fn project(&self, point: DVec3) -> Option<DVec3> {
        if let Some(at) = self.paraboloid {
            return self.project_paraboloid(at, point);
        }
        let p = point.extend(1.0);
        let w = self.w.dot(p);
        (w > self.near).then(|| DVec3::new(self.u.dot(p), self.v.dot(p), self.z.dot(p)) / w)
    }

    /// Texels along each side for a unit of length across the view's axis, of a light at a point where the divisor is 1. Not of paraboloids.
    pub(crate) fn texels_across(&self) -> DVec2 {
        let axis = self.w.truncate().normalize_or_zero();
        let across = |row: DVec4| (row.truncate() - axis * axis.dot(row.truncate())).length();
        DVec2::new(across(self.u), across(self.v))
    }

    /// The view with its texels moved by shares of one, each within a half to either side; all that it held it holds, in texels larger by one in the
    /// map's side.
    pub fn jittered(&self, [x, y]: [f64; 2]) -> Self {
        let side = f64::from(self.map_size);
        let [middle, by] = [0.5 * side, (side - 1.0).max(1.0) / side];
        let moved = |row: DVec4, off: f64| (row - self.w * middle) * by + self.w * (middle + off);
        Self { u: moved(self.u, x), v: moved(self.v, y), ..*self }
    }

    /// The same rows for points given as `(world - origin) * scale`, which are taken to lie within the unit cube. The
    /// nearest divisor may grow: see [`LightView::noise_in_texels`].
    pub fn relative_to(&self, origin: DVec3, scale: f64) -> Self {
        if let Some(at) = self.paraboloid {
            // Directions are the same, and distances `scale` times as long.
            let paraboloid = Some((at - origin) * scale);
            return Self { z: self.z / scale, near: self.near * scale, clear: self.clear * scale, paraboloid, ..*self };
        }
        let back = DMat4::from_translation(origin) * DMat4::from_scale(DVec3::splat(1.0 / scale));
        let turn = |row: DVec4| back.transpose() * row;
        // The divisor is kept in scaled units, and with it all four rows.
        let unit = if self.perspective { scale } else { 1.0 };
        let mut moved = Self {
            u: turn(self.u) * unit,
            v: turn(self.v) * unit,
            z: turn(self.z) * unit,
            w: turn(self.w) * unit,
            near: self.near * unit,
            clear: self.clear * unit,
            lamp: self.lamp.map(|lamp| (lamp - origin) * scale),
            ..*self
        };
        if self.perspective {
            // Nearer than this, rounding could move a vertex by more than a quarter of a texel.
            moved.near = moved.near.max(4.0 * moved.noise_in_texels().even.max(64.0 * moved.noise_in_depth().even));
        }
        moved
    }

    /// The row as kernels take it, of points seen from the light where that is at a point (`kernels/shared/frame/from_lamp.wgsl`).
    pub fn row_from_lamp(&self, row: DVec4) -> DVec4 {
        row.truncate().extend(row.dot(self.lamp_of_rows().extend(1.0)))
    }

    /// Point from which those rows take points: the light's in `f32`, of a light without a place the origin.
    pub fn lamp_of_rows(&self) -> DVec3 {
        self.lamp.map_or(DVec3::ZERO, |lamp| lamp.as_vec3().as_dvec3())
    }

    /// Nearest divisor for methods whose answers are not exact, in the space of an eye: what lies nearer casts nothing, which is worse than corners that
    /// rounding moves by some texels.
    #[cfg(feature = "baselines")]
    pub(crate) fn nearest_of_maps(&self, eye: DVec3, bounds: (DVec3, DVec3)) -> f32 {
        let scale = unit_scale(eye, bounds);
        let fitted = self.near * if self.perspective { scale } else { 1.0 };
        (self.relative_to(eye, scale).near / 8.0).max(fitted) as f32
    }

    /// Bound of the rounding in `f32` of a texel coordinate of points within the unit cube, times the divisor.
    pub fn noise_in_texels(&self) -> Noise {
        let spread = self.spread_at_one();
        let noise = |row| self.row_noise(row, spread);
        noise(self.u).or(noise(self.v)).and(noise(self.w).times(f64::from(self.map_size)))
    }

    /// Likewise of a depth.
    pub fn noise_in_depth(&self) -> Noise {
        let spread = self.spread_at_one();
        self.row_noise(self.z, spread).and(self.row_noise(self.w, spread))
    }

    /// Margins of tests of points within the unit cube.
    pub fn margins(&self) -> Margins {
        // The least divisor makes the most of rounding.
        let divisor = if self.perspective { self.near } else { 1.0 };
        let [texels, depth] = [self.noise_in_texels(), self.noise_in_depth()].map(|n| n.even / divisor + n.by_divisor);
        Margins { texels: 1.0 / 64.0 + texels, depth: 1e-6 + depth }
    }

    /// Lower bound of a caster's divisor within the unit cube, after `f32` rounding.
    pub fn clear_of_rounding(&self) -> f64 {
        if self.perspective { self.clear * (1.0 - 1e-6) - row_noise(self.w) } else { 0.0 }
    }

    /// Rounding of the product of a row and a point of the unit cube, with room to spare. Seen from a light at a point, it is that of the light's own
    /// place, to the next power of two, and more in proportion to the distance from it: in the view that is at most `spread` for a divisor of 1.
    fn row_noise(&self, row: DVec4, spread: DVec3) -> Noise {
        let Some(lamp) = self.lamp else { return Noise { even: row_noise(row), by_divisor: 0.0 } };
        let (own, across) = (self.row_from_lamp(row), row.truncate().abs());
        let place = (2.0 * power_of_two_below(lamp.abs().max_element())).min(1.0);
        Noise {
            even: 2f64.powi(-22) * (across.element_sum() * place + own.w.abs()),
            by_divisor: 3.0 * 2f64.powi(-22) * across.dot(spread),
        }
    }

    /// How far, along each axis, points of the view with a divisor of 1 lie from the light at most, and a quarter more; 0 of a light without a place.
    fn spread_at_one(&self) -> DVec3 {
        if self.lamp.is_none() {
            return DVec3::ZERO;
        }
        let rows = [self.u, self.v, self.w].map(DVec4::truncate);
        let back = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse();
        let size = f64::from(self.map_size);
        let corners = [(0.0, 0.0), (size, 0.0), (0.0, size), (size, size)].map(|(x, y)| back * DVec3::new(x, y, 1.0));
        1.25 * corners.into_iter().fold(DVec3::ZERO, |most, corner| most.max(corner.abs()))
    }
}

/// Rounding in `f32`, times the divisor: of all points alike, and for each unit of the divisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Of all points.
    pub even: f64,
    /// For each unit of the divisor.
    pub by_divisor: f64,
}

impl Noise {
    fn or(self, other: Self) -> Self {
        Self { even: self.even.max(other.even), by_divisor: self.by_divisor.max(other.by_divisor) }
    }

    fn and(self, other: Self) -> Self {
        Self { even: self.even + other.even, by_divisor: self.by_divisor + other.by_divisor }
    }

    fn times(self, by: f64) -> Self {
        Self { even: self.even * by, by_divisor: self.by_divisor * by }
    }
}

/// The power of two that makes points `(world - eye) * scale` of a box about as large as 1.
pub fn unit_scale(eye: DVec3, (lowest, highest): (DVec3, DVec3)) -> f64 {
    let reach = (lowest - eye).abs().max((highest - eye).abs()).max_element();
    // Within what `f32` holds, squares included.
    power_of_two_below(1.0 / reach.clamp(2f64.powi(-60), 2f64.powi(60)))
}

/// Rounding of the product of a row and a point of the unit cube, with room to spare.
fn row_noise(row: DVec4) -> f64 {
    2f64.powi(-20) * (row.truncate().abs().element_sum() + row.w.abs())
}

/// The largest power of two that is at most `x`.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, Mesh};

    /// Two triangles over a ground.
    pub(super) fn scene() -> Mesh {
        let mut mesh =
            Mesh { positions: vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 1.0]], triangles: vec![[0, 1, 2]] };
        mesh.positions.push([0.0, 0.0, 0.0]);
        mesh.triangles.push([3, 0, 1]);
        let ground = mesh.ground_below().unwrap();
        mesh.add_ground(&ground);
        mesh
    }

    #[test]
    fn rows_agree_in_every_frame_of_reference() {
        let mesh = scene();
        for light in [Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Point { position: [0.5, 6.0, 0.5] }] {
            let view = LightView::fit(&mesh, &light, 64).unwrap();
            let origin = DVec3::new(3.0, -2.0, 5.0);
            let moved = view.relative_to(origin, 0.125);
            let p = DVec3::new(0.25, 1.5, 0.5);
            let (a, b) = (view.project(p).unwrap(), moved.project((p - origin) * 0.125).unwrap());
            assert!((a - b).length() < 1e-9, "{a} {b}");
        }
    }

    /// In a wide world, 32 bits stay within the margins all through the views of a lamp; 16 do not.
    #[test]
    fn rounding_next_to_a_lamp_is_within_the_margins() {
        let mut mesh = scene();
        let low = mesh.positions.len() as u32;
        mesh.positions.extend([[-300.0, -0.1, -300.0], [300.0, -0.1, -300.0], [0.0, -0.1, 300.0]]);
        mesh.triangles.push([low, low + 1, low + 2]);
        let light = Light::Point { position: [0.3, 0.6, 0.7] };
        let eye = DVec3::new(40.0, 3.0, -60.0);
        let scale = unit_scale(eye, mesh.bounds().unwrap());
        let mut state = 7u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let [mut worst, mut coarse] = [[0.0f64; 2]; 2];
        for view in LightView::cube(&mesh, &light, 1024).unwrap() {
            let v = view.relative_to(eye, scale);
            let (lamp, margins) = (v.lamp.unwrap(), v.margins());
            assert!(margins.texels < 0.3 && v.near < 2.0 * scale, "{margins:?} {}", v.near / scale);
            let (taken_from, size) = (v.lamp_of_rows().as_vec3(), DVec3::splat(1024.0));
            let [right, down, along] = [v.u, v.v, v.w].map(DVec4::truncate);
            let back = DMat3::from_cols(right, down, along).transpose().inverse();
            for _ in 0..4000 {
                let at = DVec3::new(next() * size.x, next() * size.y, 1.0);
                let divisor = v.near * (1.0 / v.near).powf(next());
                let p = lamp + back * at * divisor;
                if p.abs().max_element() > 1.0 {
                    continue;
                }
                let rounded = p.as_vec3();
                let told = |rows: [DVec4; 4], q: glam::Vec3| {
                    let [x, y, z, w] = rows.map(|row| row.as_vec4().dot(q.extend(1.0)));
                    DVec3::new(f64::from(x / w), f64::from(y / w), f64::from(z / w))
                };
                let exact = v.project(p).unwrap_or_else(|| at.truncate().extend(0.0));
                let off = |worst: &mut [f64; 2], told: DVec3| {
                    let off = (told - exact).abs();
                    *worst = [worst[0].max(off.x.max(off.y) / margins.texels), worst[1].max(off.z / margins.depth)];
                };
                let rows = [v.u, v.v, v.z, v.w].map(|row| v.row_from_lamp(row));
                if v.w.dot(p.extend(1.0)) > v.near {
                    let seen = |p: glam::Vec3| told(rows, p - taken_from);
                    off(&mut worst, seen(rounded));
                    off(&mut coarse, seen((rounded * 65536.0).round() / 65536.0));
                }
            }
        }
        assert!(worst.iter().all(|&w| w < 1.0) && worst[0] > 0.01, "{worst:?} of the margins");
        assert!(coarse[0] > 1.0, "{coarse:?} of the margins");
    }

    #[test]
    fn depth_grows_away_from_the_light() {
        for light in [Light::Directional { direction: [0.0, 1.0, 0.1] }, Light::Point { position: [0.5, 6.0, 0.5] }] {
            let view = LightView::fit(&scene(), &light, 64).unwrap();
            let near = view.project(DVec3::new(0.5, 1.5, 0.5)).unwrap().z;
            let far = view.project(DVec3::new(0.5, 0.5, 0.5)).unwrap().z;
            assert!(near < far);
        }
    }
}
