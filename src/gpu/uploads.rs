//! Contents of small buffers that a frame's own commands write: the queue would write them before all of its submission, so that of two
//! frames in one submission the second would change the first.

use super::buffer::filled;
use super::ledger::Held;
use super::{Buffer, Recorder};
use crate::Result;
use bytemuck::Pod;

/// Contents to be written, each a whole buffer or its beginning.
#[derive(Debug, Default)]
pub struct Uploads {
    bytes: Vec<u8>,
    copies: Vec<(wgpu::Buffer, u64)>,
}

/// The same in a buffer of the device, from which commands copy it.
pub struct StagedUploads {
    from: Held,
    copies: Vec<(wgpu::Buffer, u64)>,
}

impl Uploads {
    /// Adds the first elements of a buffer, of whole words.
    pub fn write<T: Pod>(&mut self, to: &Buffer<T>, data: &[T]) {
        let content: &[u8] = bytemuck::cast_slice(data);
        self.bytes.extend_from_slice(content);
        self.copies.push((to.raw().clone(), content.len() as u64 / 4));
    }

    /// Puts them where commands copy them from.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory.
    pub fn stage(self, device: &wgpu::Device) -> Result<StagedUploads> {
        let from = filled(device, "uploads", &self.bytes, wgpu::BufferUsages::COPY_SRC)?;
        Ok(StagedUploads { from, copies: self.copies })
    }
}

impl StagedUploads {
    /// Records the copies.
    pub fn record(&self, rec: &mut Recorder) {
        let mut first = 0;
        for (to, words) in &self.copies {
            rec.copy_words(&self.from, first, to, 0, *words);
            first += words;
        }
    }
}
