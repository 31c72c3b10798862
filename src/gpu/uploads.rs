//! Contents of small buffers that a frame's own commands write: the queue would write them before all of its submission, so that of two
//! frames in one submission the second would change the first.

use super::buffer::filled;
use super::ledger::Held;
use super::{Buffer, Recorder};
use crate::Result;
use bytemuck::Pod;

/// Contents to be written, each a part of a buffer.
#[derive(Debug, Default)]
pub struct Uploads {
    bytes: Vec<u8>,
    /// Buffer, first word in it, and words.
    copies: Vec<(wgpu::Buffer, u64, u64)>,
}

/// The same in a buffer of the device, from which commands copy it.
pub struct StagedUploads {
    from: Held,
    copies: Vec<(wgpu::Buffer, u64, u64)>,
}

impl Uploads {
    /// Adds the first elements of a buffer, of whole words.
    pub fn write<T: Pod>(&mut self, to: &Buffer<T>, data: &[T]) {
        self.write_at(to, 0, data);
    }

    /// Adds elements of a buffer from the element `first` on, of whole words.
    pub fn write_at<T: Pod>(&mut self, to: &Buffer<T>, first: usize, data: &[T]) {
        let content: &[u8] = bytemuck::cast_slice(data);
        if content.is_empty() {
            return;
        }
        self.bytes.extend_from_slice(content);
        let words = size_of::<T>() as u64 / 4;
        self.copies.push((to.raw().clone(), first as u64 * words, data.len() as u64 * words));
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
        for (to, at, words) in &self.copies {
            rec.copy_words(&self.from, first, to, *at, *words);
            first += words;
        }
    }
}
