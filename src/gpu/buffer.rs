//! Typed buffers.

use super::ledger::{Held, Ledger};
use super::scope::caught;
use super::{Gpu, faults};
use crate::{Error, Result};
use bytemuck::Pod;
use std::marker::PhantomData;

/// A buffer of `size` bytes, mapped or not: every buffer of the library is made here, and goes into the open [`Ledger`].
///
/// # Errors
/// [`Error::Gpu`] if the device has no memory for it.
pub fn allocate(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
    mapped_at_creation: bool,
) -> Result<Held> {
    faults::ask(label, size)?;
    let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation };
    let (buffer, error) = caught(device, wgpu::ErrorFilter::OutOfMemory, || device.create_buffer(&descriptor));
    match error {
        None => Ok(Ledger::enter(buffer, label)),
        Some(_) => Err(faults::out_of_memory(label, size)),
    }
}

/// Error of a buffer that is not mapped when it should be.
pub(crate) fn not_mapped(doing: &str, error: &dyn std::error::Error) -> Error {
    let text = error.to_string();
    let words: Vec<_> = text.split_whitespace().collect();
    Error::Gpu(format!("{doing}: was the device lost or destroyed? ({})", words.join(" ")))
}

/// A buffer that holds `content`, as many bytes as a multiple of 4, without the queue.
///
/// # Errors
/// As [`allocate`]; [`Error::Gpu`] if the device is lost.
pub fn filled(device: &wgpu::Device, label: &str, content: &[u8], usage: wgpu::BufferUsages) -> Result<Held> {
    let buffer = allocate(device, label, content.len() as u64, usage, true)?;
    match buffer.get_mapped_range_mut(..) {
        Ok(mut view) => view.copy_from_slice(content),
        Err(e) => return Err(not_mapped(&format!("writing '{label}'"), &e)),
    }
    buffer.unmap();
    Ok(buffer)
}

/// A GPU buffer of `len` elements of `T`. Never empty: a buffer of 0 elements holds one that nobody reads. Its bytes are padded to a
/// multiple of 16, which `arrayLength` in a kernel counts too: what a kernel must not write beyond, and the host must go through, is
/// told to it by a uniform.
/// A clone is another handle of the same memory.
#[derive(Clone, Debug)]
pub struct Buffer<T> {
    raw: Held,
    len: usize,
    label: String,
    element: PhantomData<T>,
}

impl<T: Pod> Buffer<T> {
    /// A storage buffer; wgpu fills it with zeros.
    ///
    /// # Errors
    /// [`Error::Memory`] if it is above the device's limits for a buffer or a binding; [`Error::Gpu`] if the device has
    /// no memory for it.
    pub fn storage(device: &wgpu::Device, label: &str, len: usize) -> Result<Self> {
        use wgpu::BufferUsages as U;
        Self::with_usage(device, label, len, U::STORAGE | U::COPY_SRC | U::COPY_DST)
    }

    /// A storage buffer that indirect dispatches may also read.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn indirect(device: &wgpu::Device, label: &str, len: usize) -> Result<Self> {
        use wgpu::BufferUsages as U;
        Self::with_usage(device, label, len, U::STORAGE | U::COPY_SRC | U::COPY_DST | U::INDIRECT)
    }

    /// A storage buffer that may be above the device's limit for one binding; it is bound in ranges
    /// ([`Buffer::read_range`]).
    ///
    /// # Errors
    /// As [`Buffer::storage`], with the limit for a buffer alone.
    pub fn banded(device: &wgpu::Device, label: &str, len: usize) -> Result<Self> {
        use wgpu::BufferUsages as U;
        let limit = device.limits().max_buffer_size;
        Self::within(device, label, len, U::STORAGE | U::COPY_SRC | U::COPY_DST, limit)
    }

    /// A uniform buffer.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn uniform(device: &wgpu::Device, label: &str, len: usize) -> Result<Self> {
        use wgpu::BufferUsages as U;
        Self::with_usage(device, label, len, U::UNIFORM | U::COPY_SRC | U::COPY_DST)
    }

    /// A storage buffer that holds `data`.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn from_slice(device: &wgpu::Device, queue: &wgpu::Queue, label: &str, data: &[T]) -> Result<Self> {
        let buffer = Self::storage(device, label, data.len())?;
        buffer.write(queue, data);
        Ok(buffer)
    }

    /// As [`Buffer::from_slice`], with room for `room` further elements behind those that count: kernels may read and write
    /// them, the host does not see them.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn with_room(device: &wgpu::Device, queue: &wgpu::Queue, label: &str, data: &[T], room: usize) -> Result<Self> {
        let buffer = Self::storage_with_room(device, label, data.len(), room)?;
        buffer.write(queue, data);
        Ok(buffer)
    }

    /// A storage buffer of `len` elements with room for `room` further ones behind them.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub(crate) fn storage_with_room(device: &wgpu::Device, label: &str, len: usize, room: usize) -> Result<Self> {
        Ok(Self { len, ..Self::storage(device, label, len + room)? })
    }

    /// A handle of a buffer that holds `len` elements.
    pub(super) fn of(raw: Held, len: usize, label: &str) -> Self {
        Self { raw, len, label: label.to_owned(), element: PhantomData }
    }

    fn with_usage(device: &wgpu::Device, label: &str, len: usize, usage: wgpu::BufferUsages) -> Result<Self> {
        let limits = device.limits();
        let binding = if usage.contains(wgpu::BufferUsages::UNIFORM) {
            limits.max_uniform_buffer_binding_size
        } else {
            limits.max_storage_buffer_binding_size
        };
        Self::within(device, label, len, usage, limits.max_buffer_size.min(binding))
    }

    fn within(device: &wgpu::Device, label: &str, len: usize, usage: wgpu::BufferUsages, limit: u64) -> Result<Self> {
        let bytes = (len.max(1) as u64).saturating_mul(size_of::<T>() as u64);
        let Some(size) = bytes.checked_next_multiple_of(16).filter(|&size| size <= limit) else {
            return Err(Error::Memory { what: label.to_owned(), needed: bytes, limit });
        };
        let raw = allocate(device, label, size, usage, false)?;
        Ok(Self { raw, len, label: label.to_owned(), element: PhantomData })
    }

    /// Writes `data` at the start; what is beyond the end is left out.
    pub fn write(&self, queue: &wgpu::Queue, data: &[T]) {
        let data = &data[..data.len().min(self.len)];
        if !data.is_empty() {
            queue.write_buffer(&self.raw, 0, bytemuck::cast_slice(data));
        }
    }

    /// Writes `data`, the first as element `first`, also into the room behind the elements that count ([`Buffer::with_room`]); nothing where it
    /// does not hold all of it.
    pub(crate) fn write_from(&self, queue: &wgpu::Queue, first: usize, data: &[T]) {
        let size = size_of::<T>() as u64;
        if !data.is_empty() && (first + data.len()) as u64 * size <= self.bytes() {
            queue.write_buffer(&self.raw, first as u64 * size, bytemuck::cast_slice(data));
        }
    }

    /// Reads all elements back, waiting for the GPU.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<T>> {
        self.read_first(gpu, self.len)
    }

    /// Reads the first `count` elements back, waiting for the GPU.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub fn read_first(&self, gpu: &Gpu, count: usize) -> Result<Vec<T>> {
        let count = count.min(self.len);
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = count * size_of::<T>();
        let size = (bytes as u64).next_multiple_of(4);
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = allocate(&gpu.device, "readback", size, usage, false)?;
        let mut encoder = gpu.encoder();
        encoder.copy_buffer_to_buffer(&self.raw, 0, &staging, 0, size);
        gpu.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.wait(None)?;
        let view = staging.get_mapped_range(..).map_err(|e| not_mapped(&format!("reading '{}'", self.label), &e))?;
        let mut out = vec![T::zeroed(); count];
        bytemuck::cast_slice_mut::<T, u8>(&mut out).copy_from_slice(&view[..bytes]);
        Ok(out)
    }

    /// How many elements it holds.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Its size in bytes.
    pub fn bytes(&self) -> u64 {
        self.raw.size()
    }

    /// Its label.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The wgpu buffer.
    pub fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }
}
