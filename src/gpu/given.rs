//! Elements in a buffer of the application's.

use crate::{Error, Result};

/// Elements at equal distances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GivenElements<'a> {
    /// The buffer in a message, and its elements.
    pub what: [&'static str; 2],
    pub buffer: &'a wgpu::Buffer,
    /// Byte of the first.
    pub offset: u64,
    /// Bytes from one to the next.
    pub stride: u64,
    /// Bytes of one.
    pub each: u64,
}

impl GivenElements<'_> {
    /// Checks that `count` of them can be read on a device with `limits`.
    ///
    /// # Errors
    /// [`Error::Config`] for a wrong usage, stride, offset or size, with the numbers; [`Error::Memory`] if what holds them is above the limit
    /// of one binding.
    pub fn check(&self, count: usize, limits: &wgpu::Limits) -> Result<()> {
        let Self { what: [what, elements], buffer, offset, stride, each } = *self;
        let usage = buffer.usage();
        if !usage.contains(wgpu::BufferUsages::STORAGE) {
            return Err(Error::Config(format!("{what}: its usage {usage:?} lacks STORAGE")));
        }
        if !stride.is_multiple_of(4) || stride < each || !offset.is_multiple_of(4) {
            return Err(Error::Config(format!(
                "{what}: stride {stride} and offset {offset}; multiples of 4 are possible, strides of at least {each}"
            )));
        }
        let size = buffer.size();
        let end =
            (count as u64).saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(offset)?.checked_add(each));
        if count > 0 && end.is_none_or(|end| end > size) {
            return Err(Error::Config(format!(
                "{what}: {size} bytes do not hold {count} {elements} of stride {stride} from offset {offset}"
            )));
        }
        let needed = size - self.first_bound(limits).min(size);
        let limit = limits.max_storage_buffer_binding_size;
        if needed > limit {
            return Err(Error::Memory { what: format!("{what}, from the first of its {elements}"), needed, limit });
        }
        Ok(())
    }

    /// The byte from which the buffer is bound.
    pub fn first_bound(&self, limits: &wgpu::Limits) -> u64 {
        let step = u64::from(limits.min_storage_buffer_offset_alignment.max(4));
        self.offset / step * step
    }
}
