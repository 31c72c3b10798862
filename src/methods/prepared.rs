//! A mesh made ready for the GPU: topology is found once, vertices may move afterwards.

use crate::Result;
use crate::gpu::Buffer;
use crate::scene::Mesh;
use crate::scene::adjacency::{Adjacency, Edge};
use crate::stages::sample_surfaces::SEVERAL;

/// A mesh in canonical order with its edges.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The mesh: vertices welded and sorted, triangles rotated and sorted, so that nothing depends on the file's order.
    pub mesh: Mesh,
    /// Triangle of the given mesh for each triangle here.
    pub given: Vec<u32>,
    /// Its edges.
    pub edges: Vec<Edge>,
    /// Whether every edge joins two consistently wound triangles and every part is turned outward.
    pub closed: bool,
    /// Of each triangle the lowest of its surface: of those that hang together by edges and lie in one plane, exactly.
    pub surfaces: Vec<u32>,
}

impl Prepared {
    /// Prepares `mesh`.
    pub fn new(mesh: &Mesh) -> Self {
        let (mesh, given) = mesh.canonical();
        let adjacency = Adjacency::of(&mesh);
        Self { mesh, given, edges: adjacency.edges, closed: adjacency.closed, surfaces: adjacency.surfaces }
    }

    /// Whether any two triangles are one surface.
    pub fn merges(&self) -> bool {
        (0..).zip(&self.surfaces).any(|(t, &surface)| t != surface)
    }

    /// Uploads it.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<CasterBuffers> {
        self.upload_with_room(device, queue, 0)
    }

    /// As [`Prepared::upload`], with room for `room` triangles with vertices of their own behind those of the mesh.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn upload_with_room(&self, device: &wgpu::Device, queue: &wgpu::Queue, room: usize) -> Result<CasterBuffers> {
        let (positions, triangles) = surfaces(device, queue, &self.mesh, room)?;
        Ok(CasterBuffers {
            positions,
            triangles,
            edges: Buffer::from_slice(device, queue, "casters.edges", &self.edges)?,
            closed: self.closed,
            surfaces: self
                .merges()
                .then(|| Buffer::from_slice(device, queue, "casters.surfaces", &marked(&self.surfaces)))
                .transpose()?,
        })
    }
}

/// Surfaces of triangles, those of more than one marked.
fn marked(surfaces: &[u32]) -> Vec<u32> {
    let mut marked = surfaces.to_vec();
    for (t, &surface) in surfaces.iter().enumerate().filter(|(t, s)| *t as u32 != **s) {
        marked[t] |= SEVERAL;
        marked[surface as usize] |= SEVERAL;
    }
    marked
}

/// Positions and triangles of a mesh, uploaded.
type Surfaces = (Buffer<[f32; 3]>, Buffer<[u32; 3]>);

/// Uploads positions and triangles, with room behind them for `room` triangles with vertices of their own.
///
/// # Errors
/// As [`Buffer::storage`].
pub fn surfaces(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &Mesh, room: usize) -> Result<Surfaces> {
    let positions = Buffer::with_room(device, queue, "casters.positions", &mesh.positions, 3 * room)?;
    let triangles = Buffer::with_room(device, queue, "casters.triangles", &mesh.triangles, room)?;
    Ok((positions, triangles))
}

/// A mesh on the GPU.
#[derive(Debug)]
pub struct CasterBuffers {
    /// Positions, world units.
    pub positions: Buffer<[f32; 3]>,
    /// Vertex indices of each triangle.
    pub triangles: Buffer<[u32; 3]>,
    /// Edges with their two triangles.
    pub edges: Buffer<Edge>,
    /// Whether the mesh is closed.
    pub closed: bool,
    /// Of each triangle the lowest of its surface, with [`SEVERAL`] where that has more than one; none if all have one.
    pub surfaces: Option<Buffer<u32>>,
}
