//! One part of the casters: prepared, and what its ranges of the buffers hold.

use crate::gpu::Buffer;
use crate::methods::Prepared;
use crate::methods::prepared::{marked_surfaces, marked_triangles, padded};
use crate::pass::casters::{Instances, checked, numbers, places};
use crate::pass::inputs::{CasterPart, PartKind};
use crate::scene::adjacency::Edge;
use crate::scene::{AlphaTested, Mesh};
use crate::stages::sample_surfaces::SEVERAL;
use crate::{Error, Result};
use std::ops::Range;

/// Kinds of ranges of parts: vertices, triangles, edges, and elements that tell of alpha-tested triangles.
pub const KINDS: usize = 4;
pub const VERTICES: usize = 0;
pub const TRIANGLES: usize = 1;
pub const EDGES: usize = 2;
pub const ELEMENTS: usize = 3;

/// A part.
pub struct HeldPart {
    pub prepared: Prepared,
    pub source: PlaceSource,
    pub at: [Range<usize>; KINDS],
    pub has_bodies: bool,
}

/// Source of its places in a frame.
pub enum PlaceSource {
    Standing,
    Vertices(Buffer<[u32; 2]>),
    Transforms { instances: usize, sources: Buffer<[u32; 2]>, vertices: Buffer<[f32; 4]> },
}

/// A part that is prepared, and has no range yet.
pub struct NewPart {
    pub prepared: Prepared,
    pub moves: NewMoves,
}

pub enum NewMoves {
    Not,
    Vertices(Vec<[u32; 2]>),
    Transforms { instances: usize, sources: Vec<[u32; 2]>, vertices: Vec<[f32; 3]> },
}

/// Contents of the ranges of a part.
pub struct Contents {
    pub positions: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 4]>,
    pub edges: Vec<Edge>,
    pub surfaces: Vec<u32>,
    pub numbers: Vec<u32>,
    pub elements: Vec<[u32; 4]>,
}

impl NewPart {
    /// Checks and prepares it: all that the CPU has to do for it.
    ///
    /// # Errors
    /// As [`Mesh::check`] and [`AlphaTested::check`], of the part `name`.
    pub fn new(part: &CasterPart, name: &str) -> Result<Self> {
        let mesh = checked(part.mesh.positions, part.mesh.triangles, name)?;
        let whole = AlphaTested::default();
        let alpha = part.mesh.alpha.unwrap_or(&whole);
        let mut new = match part.kind {
            PartKind::Standing => {
                let prepared = Prepared::with_alpha(&mesh, alpha)?;
                prepared.tree(); // now, and not in a frame
                return Ok(Self { prepared, moves: NewMoves::Not });
            }
            PartKind::Moving => {
                Self { prepared: Prepared::with_alpha(&mesh, alpha)?, moves: NewMoves::Vertices(places(&mesh)) }
            }
            PartKind::Instances(count) => {
                let (instances, triangles) = (count as usize, mesh.triangles.len());
                if instances.saturating_mul(triangles.max(1)) > Mesh::MAX_TRIANGLES {
                    let most = Mesh::MAX_TRIANGLES;
                    return Err(Error::mesh(
                        name,
                        format!("{count} instances of {triangles} triangles, at most {most} triangles may be used"),
                    ));
                }
                let Instances { prepared, sources, vertices } = Instances::new(&[part.mesh], &vec![0; instances])?;
                Self { prepared, moves: NewMoves::Transforms { instances, sources, vertices } }
            }
        };
        // Triangles turned outward, or in one plane, at rest may not be so in motion.
        new.prepared = new.prepared.without_bodies();
        new.prepared.surfaces = (0..new.prepared.mesh().triangles.len() as u32).collect();
        Ok(new)
    }

    /// Whether some triangles are alpha-tested.
    pub fn is_tested(&self) -> bool {
        !self.prepared.alpha().is_empty()
    }

    /// How much it takes of each kind.
    pub fn needs(&self, align: usize) -> [usize; KINDS] {
        let Mesh { positions, triangles } = self.prepared.mesh();
        let elements = self.prepared.alpha().elements();
        [positions.len().next_multiple_of(align), triangles.len(), self.prepared.edges.len(), elements]
    }
}

impl HeldPart {
    pub fn contents(&self, first: usize) -> Contents {
        Contents {
            positions: self.positions(),
            triangles: self.triangles(first),
            edges: self.edges(),
            surfaces: self.surfaces(),
            numbers: self.numbers(),
            elements: self.elements(first),
        }
    }

    pub fn positions(&self) -> Vec<[f32; 4]> {
        padded(&self.prepared.mesh().positions)
    }

    pub fn triangles(&self, first: usize) -> Vec<[u32; 4]> {
        let vertex = self.at[VERTICES].start as u32;
        let moved = |[a, b, c, told]: [u32; 4]| [a + vertex, b + vertex, c + vertex, told];
        marked_triangles(&self.prepared, first + self.at[ELEMENTS].start).into_iter().map(moved).collect()
    }

    pub fn edges(&self) -> Vec<Edge> {
        let (vertex, triangle) = (self.at[VERTICES].start as u32, self.at[TRIANGLES].start as u32);
        self.prepared.edges.iter().map(|e| e.moved(vertex, triangle)).collect()
    }

    pub fn surfaces(&self) -> Vec<u32> {
        let triangle = self.at[TRIANGLES].start as u32;
        let moved = |of: u32| ((of & !SEVERAL) + triangle) | (of & SEVERAL);
        marked_surfaces(&self.prepared.surfaces).into_iter().map(moved).collect()
    }

    pub fn numbers(&self) -> Vec<u32> {
        let triangle = self.at[TRIANGLES].start as u32;
        numbers(&self.prepared.given).into_iter().map(|number| number + triangle).collect()
    }

    pub fn elements(&self, first: usize) -> Vec<[u32; 4]> {
        self.prepared.alpha().packed((first + self.at[ELEMENTS].start) as u32)
    }
}
