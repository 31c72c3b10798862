//! Alpha-tested triangles: where a map of alpha is below a cutoff there is a hole.

use super::Mesh;
use crate::{Error, Result};
use std::collections::BTreeSet;
use std::ops::Range;

/// How alpha between texel centres is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaFilter {
    /// That of the texel.
    Nearest,
    /// Between the four nearest centres, linearly along both axes.
    #[default]
    Bilinear,
}

/// How a map goes on beyond 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaWrap {
    /// It begins again.
    #[default]
    Repeat,
    /// It is turned around at each end.
    Mirror,
    /// As the outermost texel.
    Clamp,
}

/// A map of alpha, without mip levels: it is asked at each sample's own point.
#[derive(Clone, Debug, PartialEq)]
pub struct AlphaMap {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// Alpha of each texel, 255 for 1, row by row; texture coordinate `(0, 0)` is the corner of the first.
    pub alpha: Vec<u8>,
    /// The triangle is there where alpha is at least this, 0 to 1.
    pub cutoff: f32,
    /// Between texel centres.
    pub filter: AlphaFilter,
    /// Beyond 0 and 1, along both axes.
    pub wrap: [AlphaWrap; 2],
}

impl AlphaMap {
    /// A map without a hole.
    pub fn whole() -> Self {
        let (filter, wrap) = (AlphaFilter::Nearest, [AlphaWrap::Clamp; 2]);
        Self { size: [1, 1], alpha: vec![u8::MAX], cutoff: 0.0, filter, wrap }
    }

    /// Largest side, texels.
    pub const LARGEST: u32 = 8192;

    fn check(&self, k: usize) -> Result<()> {
        let [w, h] = self.size;
        let refuse = |text: String| Err(Error::Config(format!("alpha map {k}: {text}")));
        if w == 0 || h == 0 || w > Self::LARGEST || h > Self::LARGEST {
            return refuse(format!("{w} x {h} texels, sides of 1 to {} are possible", Self::LARGEST));
        }
        let (texels, have) = (w as usize * h as usize, self.alpha.len());
        if have != texels {
            return refuse(format!("{w} x {h} texels, alpha of {have}"));
        }
        if !(0.0..=1.0).contains(&self.cutoff) {
            return refuse(format!("a cutoff of {}, 0 to 1 are possible", self.cutoff));
        }
        Ok(())
    }

    /// Alpha at texture coordinates, 0 to 255.
    pub fn at(&self, uv: [f64; 2]) -> f64 {
        let place = |k: usize, at: f64| match self.filter {
            AlphaFilter::Nearest => (at * f64::from(self.size[k])).floor(),
            AlphaFilter::Bilinear => at * f64::from(self.size[k]) - 0.5,
        };
        let [x, y] = [place(0, uv[0]), place(1, uv[1])];
        let texel = |dx: i64, dy: i64| {
            let [column, row] = [self.wrapped(0, x.floor() as i64 + dx), self.wrapped(1, y.floor() as i64 + dy)];
            f64::from(self.alpha[row * self.size[0] as usize + column])
        };
        match self.filter {
            AlphaFilter::Nearest => texel(0, 0),
            AlphaFilter::Bilinear => {
                let [fx, fy] = [x - x.floor(), y - y.floor()];
                let row = |dy| texel(0, dy) * (1.0 - fx) + texel(1, dy) * fx;
                row(0) * (1.0 - fy) + row(1) * fy
            }
        }
    }

    /// Whether the triangle is there at texture coordinates.
    pub fn is_solid(&self, uv: [f64; 2]) -> bool {
        self.at(uv) >= f64::from(self.threshold())
    }

    /// The least alpha at which it is there, 0 to 255: in single precision, in which the cutoff of a whole number is that number.
    pub fn threshold(&self) -> f32 {
        255.0 * self.cutoff
    }

    fn wrapped(&self, axis: usize, at: i64) -> usize {
        let n = i64::from(self.size[axis]);
        let place = match self.wrap[axis] {
            AlphaWrap::Repeat => at.rem_euclid(n),
            AlphaWrap::Mirror => {
                let turn = at.rem_euclid(2 * n);
                turn.min(2 * n - 1 - turn)
            }
            AlphaWrap::Clamp => at.clamp(0, n - 1),
        };
        place as usize
    }
}

/// Roles of a triangle in lights: lights and triangles are in up to eight layers, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Roles {
    /// Layers of lights in which it shadows others.
    pub casts: u8,
    /// Layers of lights in which others shadow it; in other lights it is lit, whichever way it faces.
    pub receives: u8,
    /// Whether the camera sees it.
    pub seen: bool,
}

impl Roles {
    /// Everything in every light.
    pub const ALL: Self = Self { casts: u8::MAX, receives: u8::MAX, seen: true };
    /// It is seen and shadowed, and casts nothing.
    pub const RECEIVE_ONLY: Self = Self { casts: 0, ..Self::ALL };
    /// It is seen and casts, and nothing shadows it.
    pub const CAST_ONLY: Self = Self { receives: 0, ..Self::ALL };
    /// It is seen, casts nothing and is lit.
    pub const NEITHER: Self = Self { casts: 0, ..Self::CAST_ONLY };
    /// It casts, and the camera does not see it.
    pub const UNSEEN: Self = Self { seen: false, ..Self::ALL };

    /// Whether it shadows others in a light of these layers.
    pub fn casts_in(&self, layers: u8) -> bool {
        self.casts & layers != 0
    }

    /// Whether others shadow it in a light of these layers.
    pub fn receives_in(&self, layers: u8) -> bool {
        self.receives & layers != 0
    }

    /// The word that kernels read: bits of what it does not.
    fn packed(self) -> u32 {
        u32::from(!self.casts) | u32::from(!self.receives) << 8 | u32::from(!self.seen) << 16
    }
}

impl Default for Roles {
    fn default() -> Self {
        Self::ALL
    }
}

/// A triangle that a map of alpha has holes for, or that does not do everything in every light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestedTriangle {
    /// Number of the triangle.
    pub triangle: u32,
    /// Number of the map.
    pub map: u32,
    /// Texture coordinates of its corners, in the order of its indices.
    pub uv: [[f32; 2]; 3],
    /// Its roles in lights.
    pub roles: Roles,
}

/// The alpha-tested triangles of a mesh, and their maps.
///
/// They cast where they are solid, at each sample's own point, and so are seen where they are. They bound no closed body, hang together with
/// no other triangle, and settle nothing: the texels of the light that they touch are evaluated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AlphaTested {
    /// The maps.
    pub maps: Vec<AlphaMap>,
    /// The triangles, each at most once.
    pub triangles: Vec<TestedTriangle>,
}

impl AlphaTested {
    /// Largest texture coordinate: beyond it, single precision knows few texels apart.
    pub const LARGEST_UV: f32 = 65536.0;

    /// Checks maps and triangles against a mesh.
    ///
    /// # Errors
    /// [`Error::Config`] naming the first map or triangle that cannot be used.
    pub fn check(&self, mesh: &Mesh) -> Result<()> {
        self.maps.iter().enumerate().try_for_each(|(k, map)| map.check(k))?;
        let (maps, triangles) = (self.maps.len(), mesh.triangles.len());
        let mut tested = vec![false; triangles];
        for (k, of) in self.triangles.iter().enumerate() {
            let refuse = |text: String| Err(Error::Config(format!("alpha-tested triangle {k}: {text}")));
            let Some(known) = tested.get_mut(of.triangle as usize) else {
                return refuse(format!("triangle {}, the mesh has {triangles}", of.triangle));
            };
            if std::mem::replace(known, true) {
                return refuse(format!("triangle {} is tested by another, too", of.triangle));
            }
            if of.map as usize >= maps {
                return refuse(format!("map {}, there are {maps}", of.map));
            }
            if let Some(c) = of.uv.iter().flatten().find(|c| c.is_nan() || c.abs() > Self::LARGEST_UV) {
                return refuse(format!("texture coordinate {c}, up to {} are possible", Self::LARGEST_UV));
            }
        }
        Ok(())
    }

    /// Gives a range of triangles these roles: those that are tested already keep their holes, others are listed with a map that has none. Any
    /// triangle with a role of its own costs what a tested one does: nothing is settled by it.
    pub fn set_roles(&mut self, triangles: Range<u32>, roles: Roles) {
        let mut left: BTreeSet<u32> = triangles.collect();
        for of in &mut self.triangles {
            if left.remove(&of.triangle) {
                of.roles = roles;
            }
        }
        if left.is_empty() {
            return;
        }
        let whole = AlphaMap::whole();
        let known = self.maps.iter().position(|map| *map == whole);
        let map = known.unwrap_or(self.maps.len()) as u32;
        if known.is_none() {
            self.maps.push(whole);
        }
        self.triangles.extend(left.iter().map(|&triangle| TestedTriangle { triangle, map, uv: [[0.0; 2]; 3], roles }));
    }

    /// Whether some triangle does not do everything in every light.
    pub fn has_roles(&self) -> bool {
        self.triangles.iter().any(|of| of.roles != Roles::ALL)
    }

    /// Whether no triangle is tested.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// For each of so many triangles its place in [`AlphaTested::triangles`], or `u32::MAX`.
    pub fn places(&self, triangles: usize) -> Vec<u32> {
        let mut places = vec![u32::MAX; triangles];
        for (k, of) in (0..).zip(&self.triangles) {
            places[of.triangle as usize] = k;
        }
        places
    }

    /// Whether a tested triangle, by its place, is there at the point that is the sum of its corners by these shares.
    pub fn is_solid(&self, place: u32, shares: [f64; 3]) -> bool {
        let TestedTriangle { map, uv, .. } = &self.triangles[place as usize];
        let along = |k: usize| (0..3).map(|n| shares[n] * f64::from(uv[n][k])).sum();
        self.maps[*map as usize].is_solid([along(0), along(1)])
    }

    /// The same of triangles that were numbered and turned anew: `from` is the triangle that each was of `before`, which is now of `mesh`.
    pub(crate) fn renumbered(&self, before: &Mesh, mesh: &Mesh, from: &[u32]) -> Self {
        let places = self.places(before.triangles.len());
        let of = |(t, &was): (usize, &u32)| {
            let known = self.triangles.get(places[was as usize] as usize)?;
            let (old, new) = (before.corners(was as usize), mesh.corners(t));
            let turned = |n: &usize| (0..3).all(|k| new[k] == old[(k + n) % 3]);
            let turn = (0..3).find(turned).unwrap_or(0);
            let uv = [0, 1, 2].map(|k: usize| known.uv[(k + turn) % 3]);
            Some(TestedTriangle { triangle: t as u32, uv: self.near_zero(known.map, uv), ..*known })
        };
        Self { maps: self.maps.clone(), triangles: from.iter().enumerate().filter_map(of).collect() }
    }

    /// Texture coordinates moved by whole turns of their map.
    fn near_zero(&self, map: u32, uv: [[f32; 2]; 3]) -> [[f32; 2]; 3] {
        let mut moved = uv;
        for axis in 0..2 {
            let least = uv.iter().fold(f32::INFINITY, |least, corner| least.min(corner[axis]));
            let turns = match self.maps[map as usize].wrap[axis] {
                AlphaWrap::Repeat => least.floor(),
                AlphaWrap::Mirror => 2.0 * (0.5 * least).floor(),
                AlphaWrap::Clamp => 0.0,
            };
            moved.iter_mut().for_each(|corner| corner[axis] -= turns);
        }
        moved
    }

    /// Elements behind the triangles that kernels read it from: two a triangle, then of each map one and its texels, sixteen each.
    pub(crate) fn elements(&self) -> usize {
        let of_map = |map: &AlphaMap| 1 + map.alpha.len().div_ceil(16);
        2 * self.triangles.len() + self.maps.iter().map(of_map).sum::<usize>()
    }

    /// These elements, where the first is number `first` of its buffer, which tells where maps lie.
    pub(crate) fn packed(&self, first: u32) -> Vec<[u32; 4]> {
        let mut packed = Vec::with_capacity(self.elements());
        let mut next = first + 2 * self.triangles.len() as u32;
        let mut heads = Vec::with_capacity(self.maps.len());
        for map in &self.maps {
            heads.push(next);
            next += 1 + map.alpha.len().div_ceil(16) as u32;
        }
        for TestedTriangle { map, uv, roles, .. } in &self.triangles {
            let [a, b, c] = uv.map(|corner| corner.map(f32::to_bits));
            packed.extend([[a[0], a[1], b[0], b[1]], [c[0], c[1], heads[*map as usize], roles.packed()]]);
        }
        for map in &self.maps {
            let how = |wrap| match wrap {
                AlphaWrap::Repeat => 0,
                AlphaWrap::Mirror => 1,
                AlphaWrap::Clamp => 2,
            };
            let bilinear = u32::from(map.filter == AlphaFilter::Bilinear);
            let flags = bilinear | how(map.wrap[0]) << 1 | how(map.wrap[1]) << 3;
            packed.push([map.size[0], map.size[1], map.threshold().to_bits(), flags]);
            let four = |bytes: &[u8]| (0..).zip(bytes).fold(0, |word, (k, &alpha)| word | u32::from(alpha) << (8 * k));
            packed.extend(map.alpha.chunks(16).map(|part| {
                let mut words = [0; 4];
                words.iter_mut().zip(part.chunks(4)).for_each(|(word, bytes)| *word = four(bytes));
                words
            }));
        }
        packed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(filter: AlphaFilter, wrap: AlphaWrap) -> AlphaMap {
        AlphaMap { size: [3, 2], alpha: vec![0, 100, 200, 50, 150, 250], cutoff: 0.5, filter, wrap: [wrap; 2] }
    }

    #[test]
    fn alpha_is_that_of_the_texels() {
        let nearest = map(AlphaFilter::Nearest, AlphaWrap::Repeat);
        assert_eq!([0.1, 0.4, 0.9].map(|u| nearest.at([u, 0.2])), [0.0, 100.0, 200.0]);
        assert_eq!([1.1, -0.1, -0.9].map(|u| nearest.at([u, 1.7])), [50.0, 250.0, 50.0]);
        let mirrored = map(AlphaFilter::Nearest, AlphaWrap::Mirror);
        assert_eq!([1.1, -0.1, -0.9, 2.1].map(|u| mirrored.at([u, 0.2])), [200.0, 0.0, 200.0, 0.0]);
        let clamped = map(AlphaFilter::Nearest, AlphaWrap::Clamp);
        assert_eq!([1.9, -7.0].map(|u| clamped.at([u, 9.0])), [250.0, 50.0]);
        let bilinear = map(AlphaFilter::Bilinear, AlphaWrap::Clamp);
        let centre = |x: f64, y: f64| [(x + 0.5) / 3.0, (y + 0.5) / 2.0];
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        near(bilinear.at(centre(1.0, 1.0)), 150.0);
        near(bilinear.at(centre(0.25, 0.0)), 25.0);
        near(bilinear.at(centre(1.5, 0.5)), 175.0);
        let around = map(AlphaFilter::Bilinear, AlphaWrap::Repeat);
        near(around.at(centre(2.5, 0.0)), 100.0);
        assert!(around.is_solid(centre(2.0, 0.0)) && !around.is_solid(centre(0.0, 0.0)));
        let exact = AlphaMap { cutoff: 100.0 / 255.0, ..nearest };
        assert!(exact.is_solid(centre(1.0, 0.0)), "at the cutoff it is there");
    }

    #[test]
    fn what_cannot_be_used_is_an_error() {
        let mesh = Mesh { positions: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 2]; 2] };
        let good = AlphaTested {
            maps: vec![map(AlphaFilter::Nearest, AlphaWrap::Repeat)],
            triangles: vec![TestedTriangle { triangle: 1, map: 0, uv: [[0.0; 2]; 3], roles: Roles::ALL }],
        };
        good.check(&mesh).unwrap();
        let spoilt = |spoil: fn(&mut AlphaTested)| {
            let mut tested = good.clone();
            spoil(&mut tested);
            tested.check(&mesh).unwrap_err().to_string()
        };
        for (told, expected) in [
            (spoilt(|t| t.maps[0].size = [0, 2]), "alpha map 0: 0 x 2 texels"),
            (spoilt(|t| t.maps[0].alpha.truncate(5)), "alpha map 0: 3 x 2 texels, alpha of 5"),
            (spoilt(|t| t.maps[0].cutoff = f32::NAN), "alpha map 0: a cutoff of NaN"),
            (spoilt(|t| t.triangles[0].triangle = 2), "triangle 2, the mesh has 2"),
            (spoilt(|t| t.triangles[0].map = 1), "map 1, there are 1"),
            (spoilt(|t| t.triangles.push(t.triangles[0])), "alpha-tested triangle 1: triangle 1 is tested by another"),
            (spoilt(|t| t.triangles[0].uv[2][0] = f32::INFINITY), "texture coordinate inf"),
        ] {
            assert!(told.contains(expected), "{told}");
        }
    }

    #[test]
    fn renumbered_triangles_keep_their_corners() {
        let mesh = Mesh {
            positions: vec![[5.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 9.0]],
            triangles: vec![[0, 1, 2], [3, 0, 1]],
        };
        let uv = [[7.25, 0.0], [8.0, 0.5], [7.5, -0.25]];
        let tested = AlphaTested {
            maps: vec![map(AlphaFilter::Nearest, AlphaWrap::Repeat)],
            triangles: vec![TestedTriangle { triangle: 0, map: 0, uv, roles: Roles::ALL }],
        };
        let (canonical, from) = mesh.canonical();
        let turned = tested.renumbered(&mesh, &canonical, &from);
        let [of] = turned.triangles[..] else { panic!("{turned:?}") };
        assert_eq!(from[of.triangle as usize], 0);
        for (corner, uv) in canonical.corners(of.triangle as usize).into_iter().zip(of.uv) {
            let was = mesh.corners(0).iter().position(|c| *c == corner).unwrap();
            let [u, v] = tested.triangles[0].uv[was];
            assert_eq!(uv, [u - 7.0, v + 1.0]);
        }
    }
}
