//! Boxes of clusters of triangles and edges whose vertices move.
//!
//! - **Purpose.** [Cluster culling](super::cluster_culling) of casters that move.
//! - **Reads** positions, world units, 16 bytes a vertex: three finite `f32`, and a word that is not read; and which clusters of vertices each
//!   cluster of triangles or edges uses ([`cluster_uses`]), which never changes.
//! - **Writes** a box a cluster, those of triangles first. Each holds the clusters of vertices that it uses: all of its elements, and what has
//!   near numbers.
//! - **Guarantee.** Exact: the least box around these vertices. The same bits on every run.
//! - **Cost.** Two dispatches; 16 bytes a vertex, and some 40 a cluster that is used.

use super::cluster_culling::{CLUSTER, ClusterBox};
use super::holds;
use crate::gpu::kernels::cluster_bounds as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::scene::{Edge, Mesh};
use crate::{Result, shared_struct};
use rayon::prelude::*;

shared_struct! {
    /// Parameters of the kernel.
    "cluster_bounds" => pub struct ClusterBoundsParams {
        /// Vertices.
        pub vertices: u32,
        /// Clusters of triangles and edges.
        pub clusters: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
    }
}

/// Where the list of each cluster of triangles, then of edges, begins, and where the last one ends; and the lists: clusters of vertices in rising
/// order. Elements that hold no edge use none.
pub fn cluster_uses(mesh: &Mesh, edges: &[Edge]) -> Vec<u32> {
    let list = |vertices: &mut dyn Iterator<Item = u32>| {
        let mut used: Vec<u32> = vertices.map(|v| v / CLUSTER as u32).collect();
        used.sort_unstable();
        used.dedup();
        used
    };
    let of_triangles = mesh.triangles.par_chunks(CLUSTER).map(|part| list(&mut part.iter().flatten().copied()));
    let of_edges = edges.par_chunks(CLUSTER).map(|part| {
        let ends = part.iter().filter(|e| e.v0 != e.v1).flat_map(|e| [e.v0, e.v1]);
        list(&mut ends.into_iter())
    });
    let lists: Vec<Vec<u32>> = of_triangles.chain(of_edges).collect();
    let first = lists.len() as u32 + 1;
    let ends = lists.iter().scan(first, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    });
    std::iter::once(first).chain(ends).chain(lists.iter().flatten().copied()).collect()
}

/// Lists of one mesh, and memory for boxes of its vertices. A clone is the same memory.
#[derive(Clone, Debug)]
pub struct ClusterUses {
    /// As [`cluster_uses`] has them.
    pub uses: Buffer<u32>,
    /// Boxes of clusters of vertices.
    pub vertex_boxes: Buffer<ClusterBox>,
}

impl ClusterUses {
    /// Memory for a mesh of so many `vertices`, and its lists.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, uses: &[u32], vertices: usize) -> Result<Self> {
        Ok(Self {
            uses: Buffer::from_slice(device, queue, "cluster_bounds.uses", uses)?,
            vertex_boxes: Buffer::storage(device, "cluster_bounds.vertex_boxes", vertices.div_ceil(CLUSTER))?,
        })
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct ClusterBounds {
    vertices: kernel::OfVerticesProgram,
    users: kernel::OfUsersProgram,
    uniforms: Uniforms,
}

impl ClusterBounds {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            vertices: kernel::OfVerticesProgram::new(device, ()),
            users: kernel::OfUsersProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the `boxes` of all clusters of triangles and edges, by the `positions` of the vertices.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too short, [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        stage: &mut Stage,
        positions: &Buffer<[f32; 4]>,
        of: &ClusterUses,
        boxes: &Buffer<ClusterBox>,
    ) -> Result<()> {
        let (vertices, clusters) = (positions.len(), boxes.len());
        holds("cluster_bounds", "uses", of.uses.len(), clusters + 1)?;
        holds("cluster_bounds", "vertex_boxes", of.vertex_boxes.len(), vertices.div_ceil(CLUSTER))?;
        let params = ClusterBoundsParams {
            vertices: vertices as u32,
            clusters: clusters as u32,
            ..ClusterBoundsParams::default()
        };
        let params = self.uniforms.get(stage.device, &params)?;
        let bindings = kernel::OfVertices {
            params: params.as_uniform(),
            positions: positions.as_read(),
            vertex_boxes: of.vertex_boxes.as_write(),
        };
        stage.run(&self.vertices, bindings, Groups::Items(vertices as u64));
        let bindings = kernel::OfUsers {
            params: params.as_uniform(),
            vertex_boxes: of.vertex_boxes.as_write(),
            uses: of.uses.as_read(),
            boxes: boxes.as_write(),
        };
        stage.run(&self.users, bindings, Groups::Items(clusters as u64));
        Ok(())
    }
}
