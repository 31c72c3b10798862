//! Small constant buffers, made once per content.

use crate::Result;
use crate::gpu::Buffer;
use crate::gpu::buffer::filled;
use crate::gpu::layout::Shared;
use crate::gpu::ledger::Held;
use std::sync::{Arc, Mutex, PoisonError};

/// Hands out parameter buffers by content: equal parameters share one buffer, so that recording the same frame again
/// allocates nothing, and a buffer is never rewritten while the GPU may read it.
///
/// The buffers are both `UNIFORM` and `STORAGE`: a kernel that reads a count from "some buffer, some word" can be given
/// its own parameters as that buffer when the host knows the count. A clone shares what was made.
#[derive(Clone, Debug, Default)]
pub struct Uniforms {
    made: Arc<Mutex<Vec<Made>>>,
}

/// A buffer and its content.
type Made = (Vec<u8>, Held);

impl Uniforms {
    /// Most contents that are kept; beyond it the oldest half is forgotten (what is recorded keeps its own).
    pub const KEPT: usize = 256;

    /// A buffer that holds `params`.
    ///
    /// # Errors
    /// As [`filled`].
    pub fn get<T: Shared>(&self, device: &wgpu::Device, params: &T) -> Result<Buffer<T>> {
        let bytes = bytemuck::bytes_of(params);
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, buffer)) = made.iter().find(|(content, _)| content == bytes) {
            return Ok(Buffer::of(buffer.clone(), 1, T::KERNEL));
        }
        if made.len() >= Self::KEPT {
            made.drain(..Self::KEPT / 2);
        }
        let mut content = bytes.to_vec();
        content.resize(bytes.len().next_multiple_of(16), 0);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE;
        let buffer = filled(device, T::KERNEL, &content, usage)?;
        made.push((bytes.to_vec(), buffer.clone()));
        Ok(Buffer::of(buffer, 1, T::KERNEL))
    }
}
