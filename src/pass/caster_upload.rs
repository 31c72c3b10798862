//! Casters that are uploaded once for several passes, piece by piece where a frame must not wait for all of them.

use super::casters::{CasterSet, numbers};
use crate::Result;
use crate::gpu::Buffer;
use crate::methods::Prepared;
use crate::methods::prepared::{CasterBuffers, marked_surfaces, marked_triangles_in, padded};
use crate::scene::Mesh;
use bytemuck::Pod;
use std::ops::Range;
use std::sync::Arc;

/// Casters that stand, on the GPU, for any number of passes of its device ([`Casters::Uploaded`](super::Casters::Uploaded)). A clone is the
/// same memory.
#[derive(Clone, Debug)]
pub struct UploadedCasters {
    pub(super) prepared: Arc<Prepared>,
    pub(super) buffers: CasterBuffers,
    pub(super) numbers: Buffer<u32>,
}

impl UploadedCasters {
    /// The mesh that was prepared.
    pub fn mesh(&self) -> &Mesh {
        self.prepared.mesh()
    }

    /// Position of each vertex of [`Prepared::mesh`], world units, and 0: four `f32` each, a storage buffer.
    pub fn positions(&self) -> &wgpu::Buffer {
        self.buffers.positions.raw()
    }

    /// Vertices of each triangle of [`Prepared::mesh`], and a word of what is known of it: four `u32` each, a storage buffer. That word is one more
    /// than the element of this buffer that tells of an alpha-tested one.
    pub fn triangles(&self) -> &wgpu::Buffer {
        self.buffers.triangles.raw()
    }

    /// Bytes of all its buffers. No pass counts them as its own ([`ShadowPass::memory`](crate::ShadowPass::memory)).
    pub fn bytes(&self) -> u64 {
        let CasterBuffers { positions, triangles, edges, surfaces, clusters } = &self.buffers;
        let of_surfaces = surfaces.as_ref().map_or(0, Buffer::bytes);
        let of_clusters = clusters.as_ref().map_or(0, |clusters| clusters.boxes.bytes());
        positions.bytes() + triangles.bytes() + edges.bytes() + of_surfaces + of_clusters + self.numbers.bytes()
    }

    /// The casters of a pass, in this memory.
    pub(super) fn set(&self) -> CasterSet {
        let Self { prepared, buffers, numbers, .. } = self;
        let (prepared, buffers, numbers) = (prepared.clone(), buffers.clone(), numbers.clone());
        CasterSet { prepared, buffers, numbers, moves: None, parts: None, bounds: None }
    }
}

/// Casters that are being uploaded: [`CasterUpload::advance`] writes the next piece, so that a page, or a game that streams its levels, draws its
/// frames in between.
#[derive(Debug)]
pub struct CasterUpload {
    from: Arc<Prepared>,
    writing: Writing,
}

#[derive(Debug)]
struct Writing {
    queue: wgpu::Queue,
    to: UploadedCasters,
    /// The list whose turn it is, and its element.
    list: List,
    element: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum List {
    Positions,
    Triangles,
    Edges,
    Surfaces,
    Clusters,
    Numbers,
    Done,
}

impl CasterUpload {
    /// Makes the memory of prepared casters; nothing is written yet.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory) and [`Error::Gpu`](crate::Error::Gpu) if memory does not suffice.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, casters: Arc<Prepared>) -> Result<Self> {
        Ok(Self { writing: Writing::new(device, queue, &casters)?, from: casters })
    }

    /// The casters, of which passes can be made at once. A frame needs all of them to be written before it is submitted.
    pub fn casters(&self) -> &UploadedCasters {
        &self.writing.to
    }

    /// Writes the next piece: about `most` bytes, at least an element. Whether all are written: they go with the next submission to the queue.
    pub fn advance(&mut self, most: u64) -> bool {
        self.writing.advance(&self.from, most)
    }

    /// Writes what is left, and hands the casters over.
    pub fn finish(self) -> UploadedCasters {
        self.writing.finish(&self.from)
    }
}

/// Uploads casters that stand and are prepared.
pub fn uploaded(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared) -> Result<UploadedCasters> {
    Ok(Writing::new(device, queue, prepared)?.finish(prepared))
}

impl Writing {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared) -> Result<Self> {
        prepared.tree(); // of the original, so that all who use it have it
        let to = UploadedCasters {
            prepared: Arc::new(prepared.geometry()),
            buffers: CasterBuffers::of(device, prepared)?,
            numbers: Buffer::storage(device, "casters.numbers", prepared.given.len())?,
        };
        Ok(Self { queue: queue.clone(), to, list: List::Positions, element: 0 })
    }

    fn advance(&mut self, prepared: &Prepared, most: u64) -> bool {
        let mut left = most.max(1);
        while left > 0 && self.list != List::Done {
            left = left.saturating_sub(self.write_next(prepared, left));
        }
        self.list == List::Done
    }

    fn finish(mut self, prepared: &Prepared) -> UploadedCasters {
        while !self.advance(prepared, u64::MAX) {}
        self.to
    }

    /// Writes of the list whose turn it is: how many bytes.
    fn write_next(&mut self, prepared: &Prepared, most: u64) -> u64 {
        let to = &self.to.buffers;
        let (queue, first, mesh) = (&self.queue, self.element, prepared.mesh());
        let (next, len, [end, bytes]) = match self.list {
            List::Positions => {
                let piece = |range: Range<usize>| padded(&mesh.positions[range]);
                (List::Triangles, to.positions.len(), write(queue, &to.positions, first, most, piece))
            }
            List::Triangles => {
                let behind = to.triangles.len();
                if first == 0 {
                    to.triangles.write_from(queue, behind, &prepared.alpha.packed(behind as u32));
                }
                let piece = |range: Range<usize>| marked_triangles_in(prepared, behind, range);
                (List::Edges, behind, write(queue, &to.triangles, first, most, piece))
            }
            List::Edges => {
                let piece = |range: Range<usize>| prepared.edges[range].to_vec();
                (List::Surfaces, to.edges.len(), write(queue, &to.edges, first, most, piece))
            }
            List::Surfaces => {
                let to = to.surfaces.as_ref();
                to.iter().for_each(|to| to.write(queue, &marked_surfaces(&prepared.surfaces)));
                (List::Clusters, 0, [0, to.map_or(0, |to| to.bytes() as usize)])
            }
            List::Clusters => {
                let boxes = to.clusters.iter().map(|clusters| &clusters.boxes);
                let written = boxes.inspect(|to| to.write(queue, &prepared.clusters)).map(Buffer::bytes).sum::<u64>();
                (List::Numbers, 0, [0, written as usize])
            }
            List::Numbers => {
                self.to.numbers.write(queue, &numbers(&prepared.given));
                (List::Done, 0, [0, self.to.numbers.bytes() as usize])
            }
            List::Done => return 0,
        };
        (self.list, self.element) = if end < len { (self.list, end) } else { (next, 0) };
        bytes as u64
    }
}

/// Writes elements from `first` on, up to `most` bytes of them: the first that is not written, and the bytes.
fn write<T: Pod>(
    queue: &wgpu::Queue,
    to: &Buffer<T>,
    first: usize,
    most: u64,
    piece: impl Fn(Range<usize>) -> Vec<T>,
) -> [usize; 2] {
    let count = usize::try_from(most / size_of::<T>() as u64).unwrap_or(usize::MAX).max(1);
    let end = first.saturating_add(count).min(to.len());
    to.write_from(queue, first, &piece(first..end));
    [end, (end - first) * size_of::<T>()]
}
