//! Small meshes that stiff cases are built of.

use glam::DVec3;
use subpixel_shadows::scene::Mesh;

/// The vector `(x, y, z)`.
pub fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Adds triangles over new vertices.
pub fn add(mesh: &mut Mesh, corners: &[DVec3], triangles: &[[u32; 3]]) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(corners.iter().map(|c| <[f32; 3]>::from(c.as_vec3())));
    mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + base)));
}

/// A parallelogram from one corner along two sides, `n` × `n` quads.
pub fn sheet(mesh: &mut Mesh, corner: DVec3, x: DVec3, y: DVec3, n: u32) {
    let place = |i: u32, j: u32| corner + x * (f64::from(i) / f64::from(n)) + y * (f64::from(j) / f64::from(n));
    let corners: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
    let row = n + 1;
    let quads = (0..n).flat_map(|j| (0..n).map(move |i| i + j * row));
    let triangles: Vec<[u32; 3]> = quads.flat_map(|a| [[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]).collect();
    add(mesh, &corners, &triangles);
}

/// A box between two corners, wound outward.
pub fn block(mesh: &mut Mesh, low: DVec3, high: DVec3) {
    let pick = |k: u32| {
        let side = |bit: u32, lo: f64, hi: f64| if k >> bit & 1 == 1 { hi } else { lo };
        at(side(0, low.x, high.x), side(1, low.y, high.y), side(2, low.z, high.z))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    add(mesh, &(0..8).map(pick).collect::<Vec<_>>(), &triangles);
}

/// A ball of `sides` × `rings` quads, closed.
pub fn ball(mesh: &mut Mesh, centre: DVec3, radius: f64, sides: u32, rings: u32) {
    let mut corners = vec![centre + at(0.0, radius, 0.0)];
    for ring in 1..rings {
        let (height, width) = (std::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for side in 0..sides {
            let (s, c) = (std::f64::consts::TAU * f64::from(side) / f64::from(sides)).sin_cos();
            corners.push(centre + at(c * height, width, s * height) * radius);
        }
    }
    corners.push(centre - at(0.0, radius, 0.0));
    let of = |ring: u32, side: u32| 1 + (ring - 1) * sides + side % sides;
    let last = corners.len() as u32 - 1;
    let mut triangles = Vec::new();
    for s in 0..sides {
        triangles.push([0, of(1, s + 1), of(1, s)]);
        triangles.push([last, of(rings - 1, s), of(rings - 1, s + 1)]);
        for r in 1..rings - 1 {
            triangles.push([of(r, s), of(r, s + 1), of(r + 1, s)]);
            triangles.push([of(r, s + 1), of(r + 1, s + 1), of(r + 1, s)]);
        }
    }
    add(mesh, &corners, &triangles);
}

/// Numbers of 0 to 1, the same on every machine (SplitMix64).
pub struct Numbers(pub u64);

impl Numbers {
    /// The next.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A vector in the cube from -1 to 1.
    pub fn vector(&mut self) -> DVec3 {
        at(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}
