//! Bind groups that are made once and used again.

use super::program::Compiled;
use std::cell::Cell;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZeroU64;

thread_local! {
    static MADE: Cell<u64> = const { Cell::new(0) };
}

/// How many bind groups this thread has made, on any device.
pub fn bind_groups_here() -> u64 {
    MADE.get()
}

/// Recordings that a bind group is kept for after the last that used it: strips of an image take turns.
const KEPT: u64 = 8;

/// Bind groups of recordings of the same stages over the same buffers. They hold these buffers, so forget them where memory is to be given
/// back.
#[derive(Debug, Default)]
pub struct BindGroups {
    made: HashMap<u64, Vec<Kept>>,
    recording: u64,
}

#[derive(Debug)]
struct Kept {
    pipeline: wgpu::ComputePipeline,
    bound: Vec<(u32, BufferPart)>,
    group: wgpu::BindGroup,
    used: u64,
}

/// A buffer, or the part of it that is bound.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct BufferPart {
    buffer: wgpu::Buffer,
    offset: u64,
    size: Option<NonZeroU64>,
}

impl BindGroups {
    /// Begins a recording, and forgets what the last eight did not use.
    pub fn begin(&mut self) {
        self.recording += 1;
        let oldest = self.recording.saturating_sub(KEPT);
        self.made.retain(|_, kept| {
            kept.retain(|kept| kept.used >= oldest);
            !kept.is_empty()
        });
    }

    /// Forgets all of them.
    pub fn forget(&mut self) {
        self.made.clear();
    }

    /// The bind group of a program with these buffers, made if there is none; with textures, whose views are another each time, a new one.
    pub(super) fn get(
        &mut self,
        device: &wgpu::Device,
        program: &Compiled,
        entries: &[wgpu::BindGroupEntry],
    ) -> wgpu::BindGroup {
        let Some(bound) = entries.iter().map(part).collect::<Option<Vec<_>>>() else {
            return make(device, program, entries);
        };
        let pipeline = program.pipeline();
        let mut hasher = DefaultHasher::new();
        (pipeline, &bound).hash(&mut hasher);
        let kept = self.made.entry(hasher.finish()).or_default();
        if let Some(kept) = kept.iter_mut().find(|kept| kept.pipeline == *pipeline && kept.bound == bound) {
            kept.used = self.recording;
            return kept.group.clone();
        }
        let group = make(device, program, entries);
        kept.push(Kept { pipeline: pipeline.clone(), bound, group: group.clone(), used: self.recording });
        group
    }
}

/// A bind group of its own.
pub(super) fn make(device: &wgpu::Device, program: &Compiled, entries: &[wgpu::BindGroupEntry]) -> wgpu::BindGroup {
    MADE.set(MADE.get() + 1);
    program.bind(device, entries)
}

fn part(entry: &wgpu::BindGroupEntry) -> Option<(u32, BufferPart)> {
    let wgpu::BindingResource::Buffer(binding) = &entry.resource else { return None };
    let wgpu::BufferBinding { buffer, offset, size } = *binding;
    Some((entry.binding, BufferPart { buffer: buffer.clone(), offset, size }))
}
