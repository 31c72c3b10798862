//! Triangle meshes.

use crate::{Error, Result};
use glam::{DVec3, Vec3};
use serde::Serialize;

/// A triangle soup with shared vertices. Surfaces are two-sided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, world units.
    pub positions: Vec<[f32; 3]>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside where the mesh has an outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A horizontal ground square under a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ground {
    /// Height: the lowest vertex of the scene.
    pub y: f32,
    /// Half the side of the square: 10 scene radii.
    pub half_width: f32,
    /// Its centre, `[x, z]`.
    pub center: [f32; 2],
}

impl Mesh {
    /// The largest number of triangles a mesh may have.
    pub const MAX_TRIANGLES: usize = 1 << 27;

    /// Checks vertices and indices.
    ///
    /// # Errors
    /// [`Error::Mesh`] naming the first vertex that is not finite, the first index out of range, or the number of
    /// triangles if it is above [`Mesh::MAX_TRIANGLES`].
    pub fn check(&self, name: &str) -> Result<()> {
        if self.triangles.len() > Self::MAX_TRIANGLES {
            return Err(Error::mesh(
                name,
                format!("{} triangles, at most {} may be used", self.triangles.len(), Self::MAX_TRIANGLES),
            ));
        }
        for (i, p) in self.positions.iter().enumerate() {
            if !p.iter().all(|c| c.is_finite()) {
                return Err(Error::mesh(name, format!("vertex {i} ({}, {}, {}) is not finite", p[0], p[1], p[2])));
            }
        }
        let n = self.positions.len();
        for (t, tri) in self.triangles.iter().enumerate() {
            if let Some(v) = tri.iter().find(|&&v| v as usize >= n) {
                return Err(Error::mesh(name, format!("triangle {t} uses vertex {v}, the mesh has {n}")));
            }
        }
        Ok(())
    }

    /// Lowest and highest corner of the vertices that triangles use; `None` without triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut vertices = self.triangles.iter().flatten().map(|&v| Vec3::from(self.positions[v as usize]).as_dvec3());
        let first = vertices.next()?;
        Some(vertices.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p))))
    }

    /// The three corners of triangle `t`, in `f64`.
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| Vec3::from(self.positions[v as usize]).as_dvec3())
    }

    /// The ground that fits under this mesh: at the lowest vertex, centred, 10 scene radii half-width.
    pub fn ground_below(&self) -> Option<Ground> {
        let (lo, hi) = self.bounds()?;
        let radius = (hi - lo).length() * 0.5;
        let centre = (lo + hi) * 0.5;
        Some(Ground { y: lo.y as f32, half_width: (10.0 * radius) as f32, center: [centre.x as f32, centre.z as f32] })
    }

    /// Appends the two triangles of `ground`, facing up.
    pub fn add_ground(&mut self, ground: &Ground) {
        let base = self.positions.len() as u32;
        let ([cx, cz], h, y) = (ground.center, ground.half_width, ground.y);
        self.positions.extend([[cx - h, y, cz - h], [cx + h, y, cz - h], [cx + h, y, cz + h], [cx - h, y, cz + h]]);
        self.triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
    }
}
