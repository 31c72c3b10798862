//! The casters of a pass on the GPU.

use super::Casters;
use crate::Result;
use crate::gpu::Buffer;
use crate::methods::prepared::{CasterBuffers, MeshBuffers, Prepared};
use crate::scene::Mesh;
use crate::scene::weld::{UNUSED, weld};

/// The casters on the GPU.
pub struct CasterSet {
    /// The mesh in canonical order, of moving casters the pose at rest, and which triangles are of closed bodies: of moving casters
    /// none, for which way they will be turned is not known. The lists that are on the GPU are empty here.
    pub prepared: Prepared,
    pub buffers: CasterBuffers,
    /// The number here of each triangle that was given.
    pub numbers: Buffer<u32>,
    /// Place and source of each vertex of moving casters.
    pub places: Option<Buffer<[u32; 2]>>,
}

impl CasterSet {
    /// Prepares and uploads them.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, casters: &Casters, given: Mesh) -> Result<Self> {
        let mut prepared = Prepared::new(&given)?;
        let moving = matches!(casters, Casters::Moving { .. });
        if !moving {
            prepared.tree(); // now, and not in the first frame
        }
        if moving {
            prepared.bodies.fill(false);
        }
        let mut buffers = prepared.upload(device, queue)?;
        if moving {
            buffers.surfaces = None; // what lies in one plane at rest may not in motion
        }
        let places = match casters {
            Casters::Static { .. } => None,
            Casters::Moving { .. } => Some(Buffer::from_slice(device, queue, "casters.places", &places(&given))?),
        };
        let numbers = Buffer::from_slice(device, queue, "casters.numbers", &numbers(&prepared.given))?;
        (prepared.given, prepared.edges, prepared.surfaces) = Default::default();
        Ok(Self { prepared, buffers, numbers, places })
    }

    /// Uploads casters that stand and are prepared.
    pub fn of_prepared(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared) -> Result<Self> {
        prepared.tree(); // of the original, so that all who use it have it
        let buffers = prepared.upload(device, queue)?;
        let numbers = Buffer::from_slice(device, queue, "casters.numbers", &numbers(&prepared.given))?;
        Ok(Self { prepared: prepared.geometry(), buffers, numbers, places: None })
    }

    /// Uses other memory for positions and triangles from now on.
    pub fn take(&mut self, surfaces: Option<MeshBuffers>) {
        if let Some(surfaces) = surfaces {
            (self.buffers.positions, self.buffers.triangles) = surfaces;
        }
    }
}

/// The number in canonical order of each triangle, where `given` is the triangle of each number.
fn numbers(given: &[u32]) -> Vec<u32> {
    let mut numbers = vec![0; given.len()];
    for (number, &triangle) in (0..).zip(given) {
        numbers[triangle as usize] = number;
    }
    numbers
}

/// Place of each vertex in the canonical mesh, and the first vertex with that place.
fn places(mesh: &Mesh) -> Vec<[u32; 2]> {
    let welded = weld(&mesh.positions, &mesh.triangles);
    let mut first = vec![UNUSED; welded.positions.len()];
    for (v, &place) in (0..).zip(&welded.place) {
        if place != UNUSED && first[place as usize] == UNUSED {
            first[place as usize] = v;
        }
    }
    let of = |&place: &u32| [place, if place == UNUSED { UNUSED } else { first[place as usize] }];
    welded.place.iter().map(of).collect()
}

pub fn checked_mesh(casters: &Casters) -> Result<Mesh> {
    let (positions, triangles) = casters.parts();
    let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
    mesh.check("casters")?;
    Ok(mesh)
}
